"""A configuration of the arm, chosen with sliders and number boxes, and what holds at it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.compliance.cartesian import cartesian_compliance
from robomill.kinematics.dexterity import determinant
from robomill.kinematics.forward import joint_frames, tool_pose
from robomill.robot.model import Robot
from robomill.simulation.result import SimulationResult
from robomill.ui import inputs, session
from robomill.ui.project import Project
from robomill.ui.robot.tables import slides
from robomill.units import format_si, from_si, to_si


@dataclass(frozen=True, eq=False)
class PoseNumbers:
    """The arm at one configuration: frames (n+1, 4, 4), C (3, 3) m/N, det(J) m^3 (NaN where J is not square)."""

    frames: FloatArray
    C: FloatArray
    det: float
    moved: bool = False


def pose_numbers(robot: Robot, theta: FloatArray, moved: bool = False) -> PoseNumbers:
    """Everything the robot page says about one configuration."""
    det = float(determinant(robot, theta)) if robot.n == 5 else float("nan")
    return PoseNumbers(joint_frames(robot, theta), cartesian_compliance(robot, theta), det, moved)


def pose_now(project: Project, result: SimulationResult | None) -> FloatArray:
    """(n,) the configuration looked at: the chosen one, or the cut's worst point, or home."""
    robot, chosen = project.setup.robot, project.view.theta
    if chosen is not None and len(chosen) == robot.n:
        return np.clip(np.array(chosen), robot.limits[:, 0], robot.limits[:, 1])
    return at_cut(result) if result is not None and result.worst >= 0 else np.array(robot.home)


def at_cut(result: SimulationResult) -> FloatArray:
    """(n,) the configuration at the worst point of the cut."""
    return np.array(result.theta[result.worst])


def poses_compared(project: Project, theta: FloatArray) -> tuple[PoseNumbers, PoseNumbers | None]:
    """The numbers now and, where the last change altered the robot, those before it at the same joint angles."""
    robot, before = project.setup.robot, session.before()
    now = pose_numbers(robot, theta)
    if before is None or before.setup.robot == robot or before.setup.robot.n != robot.n:
        return now, None
    old = pose_numbers(before.setup.robot, theta)
    moved = bool(np.abs(old.frames - now.frames).max() > 1e-9)
    return now, PoseNumbers(old.frames, old.C, old.det, moved)


def pose_sliders(project: Project, theta: FloatArray, result: SimulationResult | None) -> None:
    """A slider and a number box a joint; both show the same angle."""
    robot = project.setup.robot
    with st.container(horizontal=True, vertical_alignment="center", gap="small"):
        st.markdown("**Joint angles**")
        st.button(
            "At the cut",
            on_click=lambda: session.look(theta=None),
            type="tertiary",
            key="pose:cut",
            icon=":material/my_location:",
            disabled=result is None or result.worst < 0,
        )
        st.button(
            "Home",
            on_click=lambda: session.look(theta=tuple(robot.home.tolist())),
            type="tertiary",
            key="pose:home",
            icon=":material/home:",
        )
    prismatic = slides(robot)[robot.free]
    for i, number in enumerate(robot.joint_numbers):
        _joint(i, f"θ{'₀₁₂₃₄₅₆₇₈₉'[number]}", theta, "mm" if prismatic[i] else "deg", robot)


def _joint(i: int, label: str, theta: FloatArray, unit: str, robot: Robot) -> None:
    low, high = (float(from_si(float(v), unit)) for v in robot.limits[i])
    shown = round(float(from_si(float(theta[i]), unit)), 3)
    keys = (f"pose:slider:{i}", f"pose:box:{i}")

    def take(key: str) -> None:
        new = np.array(theta)
        new[i] = to_si(float(st.session_state[key]), unit)
        session.look(theta=tuple(new.tolist()))

    for key in keys:
        inputs.seed(key, min(max(shown, low), high))
    name, slider, box = st.columns([0.14, 1, 0.5], vertical_alignment="center")
    name.markdown(f"**{label}**")
    slider.slider(
        label,
        low,
        high,
        key=keys[0],
        step=0.5,
        format="%.1f°" if unit == "deg" else "%.1f mm",
        label_visibility="collapsed",
        on_change=take,
        args=(keys[0],),
    )
    box.number_input(
        label,
        low,
        high,
        key=keys[1],
        step=1.0,
        format="%.2f",
        label_visibility="collapsed",
        on_change=take,
        args=(keys[1],),
    )


def tip_words(robot: Robot, theta: FloatArray, unit: str) -> str:
    """Where the tool tip is, in {M}."""
    p = tool_pose(robot, theta)[:3, 3]
    return f"Tip at ({', '.join(format_si(float(v), unit, 1).partition(' ')[0] for v in p)}) {unit} in {{M}}"
