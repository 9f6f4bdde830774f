"""Robot files: one is opened (TOML, or URDF with a choice of its tip), and the project's robot is saved."""

import re
from dataclasses import dataclass
from typing import cast

import streamlit as st

from robomill.io.robot.robots import is_urdf, read_robot
from robomill.io.robot.urdf import Tips, read_urdf, tips_of_urdf
from robomill.io.robot.urdf_writer import robot_to_urdf
from robomill.io.robot.writer import robot_to_toml
from robomill.robot.model import Robot
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.units import format_many

KEPT = "robot.urdf"
MOST_MB = 10
SUFFIX = ".robot"


@dataclass(frozen=True)
class Opened:
    """A URDF file that was opened, and the link taken as its tip; "" while none is chosen."""

    data: bytes
    name: str
    tip: str = ""


def put(robot: Robot) -> None:
    """Another robot into the project; the pose looked at is then the cut's again."""
    session.change(robot=robot)
    session.look(theta=None)


def files(robot: Robot) -> None:
    """Open and save, and what the URDF file that is open says."""
    with st.container(horizontal=True, gap="small"):
        with st.popover("Open robot", icon=":material/folder_open:", width="stretch", key="robot.open"):
            inputs.upload(
                "A robot file (.toml or .urdf)", "robot.file", _take, most_MB=MOST_MB, fresh=session.store().revision
            )
        with st.popover("Save robot", icon=":material/save:", width="stretch", key="robot.save"):
            _save(robot)
    opened = cast("Opened | None", session.kept(KEPT))
    if opened is not None and (not opened.tip or _came_from(robot, opened)):
        _chain(opened)


def _take(data: bytes, name: str) -> None:
    """Read a file; a URDF with several arms in it waits for its tip."""
    if not is_urdf(name):
        session.drop(KEPT)
        put(read_robot(data, name))
        return
    tips = tips_of_urdf(data, name)
    if tips.only is None and len(tips.chains) > 1:
        session.keep(KEPT, Opened(data, name))
        return
    found = read_urdf(data, where=name)
    session.keep(KEPT, Opened(data, name, tips.only or ""))
    put(found)


def _came_from(robot: Robot, opened: Opened) -> bool:
    return robot.provenance["geometry"].source.startswith(f"URDF file {opened.name}")


def _chain(opened: Opened) -> None:
    """The choice of the tip, and the joints that lead there."""
    tips = tips_of_urdf(opened.data, opened.name)
    with st.container(border=True):
        if not opened.tip:
            ends = ", ".join(tips.ends)
            pieces.said("info", f"{opened.name} has several ends ({ends:.200}): choose the link that holds the tool.")
        names = {link: f"{link} ({_count(tips, link)})" for link in (*tips.ends, *_inner(tips))}
        if not opened.tip:
            names = {"": "choose a link", **names}
        inputs.choice("Tip link", "robot.tip_link", names, opened.tip, _take_tip, inputs.LISTED)
        if opened.tip:
            _came_with(opened, tips)


def _inner(tips: Tips) -> list[str]:
    return [link for link in tips.chains if link not in tips.ends]


def _count(tips: Tips, link: str) -> str:
    moving = sum(joint.type != "fixed" for joint in tips.chains[link])
    return f"{moving} joint{'s' * (moving != 1)}"


def _take_tip(link: str) -> None:
    opened = cast(Opened, session.kept(KEPT))
    if link:
        found = read_urdf(opened.data, tip=link, where=opened.name)
        session.keep(KEPT, Opened(opened.data, opened.name, link))
        put(found)


def _came_with(opened: Opened, tips: Tips) -> None:
    """The joints of the chain, and what the file does not say."""
    chain = tips.chains[opened.tip]
    moving = [joint for joint in chain if joint.type != "fixed"]
    length = session.project().view.length
    rows = []
    for i, joint in enumerate(moving, 1):
        unit = length if joint.type == "prismatic" else "deg"
        limits = "turns on" if joint.limits is None else format_many(joint.limits, unit, 1, between=" to ")
        rows.append((f"{i} {joint.name} {'slides' if joint.type == 'prismatic' else 'turns'}", limits))
    pieces.table(rows, "qn", ("Joint", "Limits"))
    folded = len(chain) - len(moving)
    fixed = f" {folded} fixed joint{'s are' if folded != 1 else ' is'} part of the links." if folded else ""
    pieces.note(
        f"From {opened.name}: axes, zeros, senses and limits.{fixed} A URDF holds no stiffness: the compliances are "
        f"assumed until you type yours."
    )


def _save(robot: Robot) -> None:
    inputs.text("Name of the robot", "robot.title", robot.title or robot.name, _rename, max_chars=80)
    stem = re.sub(r"[^A-Za-z0-9]+", "-", robot.title or robot.name).strip("-").lower() or "robot"
    with st.container(horizontal=True, gap="small"):
        pieces.download("Robot file", lambda: robot_to_toml(robot), f"{stem}{SUFFIX}.toml", "robot.toml")
        pieces.download("URDF", lambda: robot_to_urdf(robot), f"{stem}.urdf", "robot.save_urdf")
    pieces.note("The robot file holds everything. A URDF holds axes, limits and frames, and no compliances.")


def _rename(title: str) -> None:
    robot = session.project().setup.robot
    session.change(label="robot.title", robot=robot.replace(title=title.strip()))
