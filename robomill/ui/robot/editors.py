"""The robot page's inputs: which robot, its compliances, D-H table, limits and frames."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pandas as pd
import streamlit as st

from robomill.io.robot.robots import load_robot, robot_titles
from robomill.provenance import TYPED
from robomill.robot.model import USER_SET, Robot
from robomill.robot.sources import block_in_force
from robomill.ui import pieces, session
from robomill.ui.entry import grid, inputs
from robomill.ui.project import Project
from robomill.ui.robot import files, frames, joints, tables
from robomill.ui.serving.menu import file_of
from robomill.units import unit_label

EDITED = "edited"
SPELLINGS = "7.14, 7,14 and 7.14e-7 (in rad/(N m)) are the same."


def editors(project: Project) -> None:
    """Compliances, geometry, limits and frames, each in its own tab."""
    robot = project.setup.robot
    _which_robot(robot)
    files.files(robot)
    compliance, geometry, limits, tool = st.tabs(["Compliance", "D-H table", "Limits", "Base and tool"])
    with compliance:
        _compliances(robot)
    with geometry:
        _geometry(robot, project.view.length)
        joints.joints(robot)
    with limits:
        _limits(robot, project.view.length)
    with tool:
        frames.frames(project)


def _which_robot(robot: Robot) -> None:
    """The robots that come with robomill; one of another file, or one that was edited, stands before them."""
    names = dict(robot_titles())
    current = robot.name
    if robot.name not in names or not tables.same_arm(robot, _known(robot.name)):
        current = EDITED
        names = {EDITED: robot.title or robot.name.replace("_", " "), **names}
        names[EDITED] += " (edited)" if robot.name in names else ""
    inputs.choice("Robot", "robot.name", names, current, _take_robot, inputs.LISTED)


@st.cache_resource(max_entries=64, show_spinner=False)
def _known(name: str) -> Robot:
    return load_robot(name)


def _take_robot(name: str) -> None:
    if name != EDITED:
        files.put(_known(name))


def _compliances(robot: Robot) -> None:
    sets = {name: name.replace("_", " ").capitalize() for name in robot.compliance_sets}
    if robot.compliance_set == USER_SET and sets:
        sets[USER_SET] = "Edited"
    if sets:
        inputs.choice("Compliance set in use", "robot.compliance_set", sets, robot.compliance_set, _take_set)
    units = list(tables.SPOKEN.values())
    columns = {
        name: st.column_config.TextColumn(name.capitalize(), help=hint, alignment="right")
        for name, hint in zip(tables.SPOKEN, (SPELLINGS, "∞: the joint does not give."), strict=True)
    }
    boxes = {name: tables.compliance_boxes(robot, unit) for name, unit in tables.SPOKEN.items()}
    sheet = grid.Sheet(boxes, {"joint": _joints("Joint"), **columns}, linked=True)
    _table("compliance", sheet, tables.compliance_frame, _with(tables.with_compliance))
    slide = [unit_label(box.unit) for box in (boxes[name][int(robot.prismatic.argmax())] for name in tables.SPOKEN)]
    slides = f" ({' and '.join(slide)} where it slides)" if robot.prismatic.any() else ""
    pieces.note(
        f"Compliance in {unit_label(units[0])}, stiffness in {unit_label(units[1])}{slides}: each is one over the "
        f"other, and editing one changes both. 0 and ∞: the joint is rigid."
    )
    _whence(robot)


def _take_set(name: str) -> None:
    if name != USER_SET:
        session.change(robot=session.project().setup.robot.with_compliance_set(name))


def _whence(robot: Robot) -> None:
    """Where the compliances come from; what a file does not hold is asked for."""
    mine, found = robot.compliance_set == USER_SET, robot.provenance.get(block_in_force(robot))
    if mine and found is None:
        found = TYPED
    if found is not None:
        pieces.note(pieces.sourced(found))
    if mine and found is not None and found.kind == "assumed":
        pieces.said("info", "Type what your joints give, or identify it from load tests.", "edit")
        st.page_link(file_of("Identification"), label="Identify from load tests", icon=":material/science:")


def _geometry(robot: Robot, length: str) -> None:
    cells = tables.geometry(length)
    widths = {head: 54 if unit in ("deg", "1") else 64 for head, unit in zip(cells.heads, cells.units, strict=True)}
    sheet = grid.Sheet(cells.boxes(), {"joint": _joints("#", 34 if robot.free.all() else 60)}, width=widths)
    _table(
        "geometry" if length == "mm" else f"geometry:{length}",
        sheet,
        lambda now: tables.geometry_frame(now, length),
        _with(lambda now, frame: tables.with_geometry(now, frame, length)),
    )
    pieces.note("The joint turns by sign · θ + θ₀; one that slides moves along z by sign · θ + d.")
    frames.said(robot, "geometry")
    frames.said(robot, "lengths")


def _limits(robot: Robot, length: str) -> None:
    cells = tables.limits(robot, length)
    slide = unit_label("in" if length == "in" else str(tables.LIMIT.sliding))
    slides = f" ({slide} where it slides)" if robot.prismatic.any() else ""
    heads = {side: f"{side.capitalize()}, {unit_label(tables.LIMIT.unit)}{slides}" for side in tables.LIMIT.axes}
    sheet = grid.Sheet(cells.boxes(), {"joint": _joints("Joint")}, heads)
    _table("limits" if length == "mm" else f"limits:{length}", sheet, tables.limits_frame, _with(tables.with_limits))
    frames.said(robot, "limits")


def _with(change: Callable[[Robot, pd.DataFrame], Robot]) -> Callable[[pd.DataFrame], None]:
    """What puts a table that was edited into the robot."""
    return lambda frame: session.change(robot=change(session.project().setup.robot, frame), from_editor=True)


def _joints(head: str, width: Any = "small") -> Any:
    """The first column, which says the joint."""
    return st.column_config.TextColumn(head, width=width)


def _table(
    name: str, sheet: grid.Sheet, shown: Callable[[Robot], pd.DataFrame], write: Callable[[pd.DataFrame], None]
) -> None:
    """A table with a row a joint, the first column of which says which."""
    own = replace(sheet, where=tables.joint, locked=("joint",))
    grid.table(name, lambda: shown(session.project().setup.robot), write, own)
