"""A configuration of the arm, chosen with sliders and number boxes, and what holds at it."""

from collections.abc import Callable
from functools import partial

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport, at_pose
from robomill.robot.model import Robot
from robomill.simulation.result import SimulationResult
from robomill.ui import inputs, pieces, point, session
from robomill.ui.box import NumberBox
from robomill.ui.project import Project
from robomill.ui.typed import said_below
from robomill.units import format_percent, format_si, from_si, to_si
from robomill.viz.theme import joint_colours


def configuration(project: Project, result: SimulationResult | None) -> FloatArray:
    """(n,) the configuration looked at: the chosen one, or the cut's worst point, or home."""
    robot, chosen = project.setup.robot, project.view.theta
    if chosen is not None and len(chosen) == robot.n:
        return np.clip(chosen, robot.limits[:, 0], robot.limits[:, 1])
    return np.array(result.theta[result.worst] if result is not None and result.worst >= 0 else robot.home)


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


def controls(project: Project, theta: FloatArray, result: SimulationResult | None) -> None:
    """A slider and a number box a joint; both show the same angle."""
    robot = project.setup.robot
    with st.container(horizontal=True, vertical_alignment="center", gap="small"):
        st.markdown("**Joint angles**")
        idle = result is None or result.worst < 0
        inputs.button(
            "At the cut", "pose.cut", "my_location", partial(session.look, theta=None), type="tertiary", disabled=idle
        )
        home = partial(session.look, theta=robot.home)
        inputs.button("Home", "pose.home", "home", home, type="tertiary")
    for i, number in enumerate(robot.joint_numbers):
        with said_below():
            unit = project.view.of(robot.joint_units[i])
            _joint(i, f"θ{'₀₁₂₃₄₅₆₇₈₉'[number]}", theta, unit, robot)


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


def share_bars(pose: PoseReport, dark: bool) -> None:
    """Which joint C_yy comes from at this pose, eqs. (13), (14)."""
    shares = pose.shares("yy")
    total = float(shares.sum()) or 1.0
    st.markdown("**Share of the deflection along Y**")
    each = zip(pose.robot.joint_numbers, shares / total, joint_colours(7, dark))
    pieces.table([(f"joint {n}", pieces.bar(share, colour), format_percent(share)) for n, share, colour in each], "sbn")
