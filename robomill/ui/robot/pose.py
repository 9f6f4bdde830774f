"""A configuration of the arm, chosen with sliders and number boxes, and what holds at it."""

from collections.abc import Callable
from functools import partial

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport, at_pose
from robomill.robot.model import Robot
from robomill.ui import pieces, session
from robomill.ui.comparing import other
from robomill.ui.entry import inputs
from robomill.ui.entry.box import NumberBox
from robomill.ui.entry.typed import said_below
from robomill.ui.judged.verdict import previous
from robomill.ui.posed import point, push
from robomill.ui.posed.push import Decided, Moved
from robomill.ui.project import Project, View
from robomill.ui.work import cached
from robomill.units import format_many, format_percent, format_si, from_si, to_si
from robomill.viz.arm import ArmScene
from robomill.viz.theme import joint_colours
from robomill.wording import lowered

ASPECT = 1.3  # of the arm's frame; a narrower column shows it smaller


def configuration(project: Project, cut: Decided | None) -> FloatArray:
    """(n,) the configuration looked at: the chosen one, or that where the cut's verdict is decided, or home."""
    robot = project.setup.robot
    theta = _chosen(project)
    if theta is not None:
        return np.clip(theta, robot.limits[:, 0], robot.limits[:, 1])
    return np.array(robot.home) if cut is None else cut.theta


def _chosen(project: Project) -> FloatArray | None:
    theta = project.view.theta
    return theta if theta is not None and len(theta) == project.setup.robot.n else None


def moved(project: Project, now: PoseReport, old: PoseReport | None, cut: Decided | None) -> tuple[Moved, Moved | None]:
    """What the push in force does at the pose, and did before the last change of the robot: at the cut with all that
    gives there, elsewhere by the joints."""
    pushed = push.in_force(project.view, cut)
    by_joints = None if old is None else Moved.at(old, pushed)
    if cut is None or pushed.axis or _chosen(project) is not None:
        return Moved.at(now, pushed), by_joints
    before = previous(cut.result)
    if before is None or len(before.path) != len(cut.result.path):
        return cut.moved, by_joints
    return cut.moved, Decided(before, cut.i).moved


def lead(project: Project, now: Moved, cut: Decided | None, unit: str) -> str:
    """Which joints give, and where and by whose force that is."""
    chosen = _chosen(project) is not None
    if cut is None:
        where = "At these joint angles." if chosen else "At its home position: the cut of this project has no answer."
    elif chosen:
        force = "" if now.push.axis else f", with the force of the cut at line {cut.line}"
        where = f"At these joint angles{force}."
    else:
        where = f"The arm stands at line {cut.line} of the cut, which decides its verdict."
    return f"{now.blame(unit)} {where}".lstrip()


def tip_tile(now: Moved, before: Moved | None, unit: str) -> pieces.Tile:
    """How far the tip is displaced, and along which axes."""
    note = " · ".join(map(" ".join, push.by_axis(now.delta, unit, every=True)))
    value, was, change = format_si(now.size, unit), "", ""
    if before is not None and np.isfinite(before.size):
        was, change = format_si(before.size, unit), format_si(now.size - before.size, unit, sign=True)
    return pieces.Tile("Tip off its path here", value, note, was, change, kind="computed")


def tiles(view: View, now: PoseReport, old: PoseReport | None, tip: tuple[Moved, Moved | None]) -> list[pieces.Tile]:
    """What the push does to the tip here, C_yy, the largest compliance and det(J), now and before the last change."""
    um = view.of("um/N")
    return [
        tip_tile(*tip, view.length),
        pieces.Tile(
            "C_yy at this pose",
            format_si(now.component("yy"), um, 3),
            "direct compliance along Y",
            format_si(old.component("yy"), um, 3) if old else "",
        ),
        pieces.Tile(
            "Largest compliance",
            format_si(now.principal[0][-1], um, 3),
            f"in direction ({format_many(now.principal[1][:, -1], '1', 2)}) of the robot frame",
            format_si(old.principal[0][-1], um, 3) if old else "",
        ),
        pieces.Tile(
            "Distance to singularity, det(J)", det_value(now, view.of), det_words(now), det_value(old, view.of)
        ),
    ]


def tiles_of_b(project: Project) -> list[pieces.Tile]:
    """The same of the project that the one in force is held against: at the joint angles chosen here, or where its own
    cut is decided. Raises its refusal, and ``Underway``."""
    cut = push.decided(other.result(project.setup))
    now = at_pose(project.setup.robot, configuration(project, cut))
    return tiles(project.view, now, None, moved(project, now, None, cut))


def compliance_of_b() -> None:
    """C of that project's arm, where its tile stands."""
    with other.in_force() as project:
        found = None if project is None else cached.held(project.setup)
        if project is None or found is None:
            return
        st.markdown("**B**")
        point.compliance_matrix(at_pose(project.setup.robot, configuration(project, push.decided(found))))


def scene(now: PoseReport, old: PoseReport | None, moved: Moved, unit: str) -> ArmScene:
    """The arm at the pose with what pushes it and where it goes."""
    return ArmScene(
        frames=now.frames,
        joints=now.robot.joint_numbers,
        ghost=ghost(now, old),
        aspect=ASPECT,
        force=moved.push.F,
        displacement=moved.delta if moved.moves else None,
        force_label=moved.push.size,
        displacement_label=format_si(moved.size, unit),
    )


def compared(project: Project, theta: FloatArray) -> tuple[PoseReport, PoseReport | None]:
    """The arm now and, where the last change altered the robot, as it was before it at the same joint angles."""
    robot, before = project.setup.robot, session.before()
    now = at_pose(robot, theta)
    if before is None or before.setup.robot == robot or before.setup.robot.n != robot.n:
        return now, None
    return now, at_pose(before.setup.robot, theta)


def ghost(now: PoseReport, old: PoseReport | None) -> FloatArray | None:
    """Frames of the arm before the last change, where that moved it."""
    if old is None or old.frames.shape != now.frames.shape:
        return None
    return old.frames if np.abs(old.frames - now.frames).max() > 1e-9 else None


def controls(project: Project, theta: FloatArray, cut: Decided | None) -> None:
    """A slider and a number box a joint; both show the same angle."""
    robot = project.setup.robot
    with st.container(horizontal=True, vertical_alignment="center", gap="small"):
        st.markdown("**Joint angles**")
        inputs.button(
            "At the cut",
            "pose.cut",
            "my_location",
            partial(session.look, theta=None),
            type="tertiary",
            disabled=cut is None,
        )
        home = partial(session.look, theta=robot.home)
        inputs.button("Home", "pose.home", "home", home, type="tertiary")
    with st.container(key="pose-joints"):
        _joints(project, theta)


def _joints(project: Project, theta: FloatArray) -> None:
    robot = project.setup.robot
    for i, number in enumerate(robot.joint_numbers):
        with said_below():
            unit = project.view.of(robot.joint_units[i])
            _joint(i, lowered("θ", number), theta, unit, robot)


def _joint(i: int, label: str, theta: FloatArray, unit: str, robot: Robot) -> None:
    # Without the last bits, which would read "-0.00" and refuse a limit typed as it stands.
    low, high = (round(float(from_si(float(v), unit)), 9) for v in robot.limits[i])
    shown = round(float(from_si(float(theta[i]), unit)), 3) + 0.0

    def turn(angle: float) -> None:
        new = np.array(theta)
        new[i] = angle
        session.look(theta=new)

    name, slider, box = st.columns([0.14, 1, 0.5], vertical_alignment="center")
    name.markdown(f"**{label}**")
    with slider:
        step = 0.02 if unit == "in" else 0.5
        span = inputs.Span(low, high, step, "%.1f°" if unit == "deg" else f"%.{1 if unit == 'mm' else 2}f {unit}")
        inputs.slider(label, f"pose.slider.{i}", span, shown, lambda v: turn(to_si(v, unit)), inputs.HIDDEN)
    with box:
        full = float(from_si(float(theta[i]), unit))
        exact = float(theta[i]) if abs(full - round(full, 5)) < 1e-9 else to_si(shown, unit)  # typed, or computed
        inputs.value(f"pose.box.{i}", NumberBox(label, unit, 2, low=low, high=high, hidden=True), exact, turn)


def det_value(pose: PoseReport | None, shown: Callable[[str], str]) -> str:
    """det(J) of the arm's task, or its size, as every page says it, in the unit that is ``shown`` for its own."""
    return "" if pose is None else format_si(pose.det_J, shown(pose.det_J_unit), 3)


def det_words(pose: PoseReport) -> str:
    """What det(J) says in words."""
    if not pose.has_det_J:
        return "√det(J Jᵀ): the Jacobian of this arm is not square; 0 at a singularity"
    return "a singularity is near; it is 0 there" if pose.near_singular else "0 at a singularity"


def compliance_matrix(now: PoseReport, old: PoseReport | None) -> None:
    """C at the pose, and how it changed."""
    point.compliance_matrix(now)
    pieces.note("Rows: where the tip goes. Columns: where you push.")
    if old is not None:
        st.markdown("**Before the last change**")
        point.compliance_matrix(old)


def share_bars(now: Moved, dark: bool) -> None:
    """Which joint gives how much of the displacement, eqs. (13), (14)."""
    st.markdown("**Share of each joint in the displacement**")
    share = now.shares
    top = max(float(np.abs(share).max()), 1e-12)
    each = zip(now.joints, share, joint_colours(7, dark), push.whole(share.tolist()))
    rows = [(f"joint {n}", pieces.bar(abs(part) / top, colour), f"{said} %") for n, part, colour, said in each]
    pieces.table(rows, "sbn")
    rest = 1.0 - float(share.sum())
    if now.moves and abs(rest) > 0.005:
        pieces.note(f"Beside the joints: {format_percent(rest)}.")
