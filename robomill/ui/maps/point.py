"""The full report of one pose: the arm with its compliance ellipsoid, joints, Jacobian, C, shares that sum to it."""

from __future__ import annotations

import html
from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go
import streamlit as st

from robomill.arrays import FloatArray, digest
from robomill.compliance.cartesian import full_compliance
from robomill.compliance.deflection import deflection, soft_direction
from robomill.kinematics.dexterity import determinant, limit_distance
from robomill.ui import cached, pieces, shell
from robomill.ui.point import FORCE, PointReport
from robomill.ui.project import Point
from robomill.units import format_number, format_percent, format_si, format_times, format_value, from_si, unit_label
from robomill.viz.arm import ArmScene, arm_figure, displacement_scale
from robomill.viz.ellipsoid import ellipsoid_scale, ellipsoid_traces
from robomill.viz.shares import share_bars
from robomill.workspace.quantities import COMPONENTS, quantity

AXES = "XYZ"


def place(point: Point, unit: str) -> str:
    """``(0, -1300, 0) mm``."""
    digits = 0 if unit == "mm" else 1
    return "(" + ", ".join(format_value(float(from_si(v, unit)), "1", digits) for v in point) + f") {unit_label(unit)}"


def headline(found: PointReport, unit: str) -> str:
    """What a push along Y does there, in one sentence."""
    where = place(found.point, unit)
    if not found.reached:
        return f"The tool does not get to {where}: {found.reason}."
    delta = found.C[:, 1] * FORCE
    digits = 3 if unit == "mm" else 4
    parts_ = [
        f"{format_si(abs(float(v)), unit, digits)} {w}"
        for v, w in zip(delta, ("in X", "in Y", "down" if delta[2] < 0 else "up"), strict=True)
        if abs(v) > 0.02 * np.linalg.norm(delta)
    ]
    size = np.abs(found.C_joint[:, 1, 1])
    most = found.robot.joint_numbers[int(np.argmax(size))]
    moved = ", ".join(parts_[:-1]) + (" and " if len(parts_) > 1 else "") + parts_[-1] if parts_ else "not at all"
    return f"At {where}, 100 N along Y move the tip {moved}; joint {most} gives most."


def show(found: PointReport, old: PointReport, component: str, unit: str) -> None:
    """The report: arm and ellipsoid, shares, C; tables beneath."""
    st.subheader(f"The pose at {place(found.point, unit)}")
    if not found.reached or found.frames is None:
        pieces.note(f"Not reached: {html.escape(found.reason)}. Click a coloured cell of a map.")
        return
    left, right = pieces.split([1, 1.05], "point")
    with left, st.container(border=True, height="stretch"):
        _arm(found, component, unit)
    with right, st.container(border=True, height="stretch"):
        _shares(found, old)
    one, two, three = pieces.split([1, 1.15, 1.6], "point-tables", gap="large")
    with one:
        _joints(found)
    with two:
        _matrix(found, old)
    with three:
        _six(found)


def _arm(found: PointReport, component: str, unit: str) -> None:
    F = np.zeros(3)
    F["xyz".index(component[1])] = FORCE
    delta = deflection(found.C_joint, F).sum(axis=0)
    frames = found.frames
    assert frames is not None
    scene = ArmScene(
        frames=frames,
        force=F,
        displacement=delta,
        force_label=format_si(FORCE, "N", 0),
        displacement_label=format_si(float(np.linalg.norm(delta)), unit, 3),
    )
    dark = shell.dark()

    def draw() -> go.Figure:
        fig = arm_figure(scene, dark=dark, height=430, revision="point-arm", zoom=0.95)
        size = float(np.linalg.norm(np.diff(frames[:, :3, 3], axis=0), axis=1).sum())
        times = ellipsoid_scale(found.C, 0.16 * size)
        tip = frames[-1][:3, 3]
        return fig.add_traces(ellipsoid_traces(found.C, tip, times, dark=dark, width=0.0065 * size, away=delta))

    fig = cached.kept_figure("point-arm", (found.robot.digest(), digest(found.theta), component, unit, dark), draw)
    drawn = format_times(displacement_scale(delta, frames))
    pieces.figure(
        fig,
        "point-arm",
        alt="The arm at this pose with the compliance ellipsoid at the tool tip.",
        caption=f"Yellow: where the tip goes under one force in every direction. Arrows: {component[1].upper()} "
        f"push and displacement, shown {drawn}.",
    )


def _shares(found: PointReport, old: PointReport) -> None:
    st.markdown("**Which joint gives, by component**")
    names = [f"C<sub>{c}</sub>" for c in COMPONENTS]
    shares = from_si(found.shares(), "um/N")
    before = from_si(old.shares().sum(axis=0), "um/N")
    pieces.figure(
        share_bars(names, shares, found.robot.joint_numbers, unit_label("um/N"), dark=shell.dark(), old=before),
        "point-shares",
        table=lambda: share_columns(found),
        alt="Joint shares of each compliance component at this pose.",
        caption="Bars add up to the sum, eq. (13). A grey mark is the sum before the change.",
    )


def share_columns(found: PointReport) -> dict[str, object]:
    """The table twin of the bars."""
    shares = from_si(found.shares(), "um/N")
    columns: dict[str, object] = {"joint": [*map(str, found.robot.joint_numbers), "sum"]}
    for k, c in enumerate(COMPONENTS):
        columns[f"C_{c}_um/N"] = [*shares[:, k], shares[:, k].sum()]
    return columns


def _joints(found: PointReport) -> None:
    robot = found.robot
    st.markdown("**Joints**")
    prismatic = robot.prismatic[robot.free]
    rows = [
        (f"θ{'₀₁₂₃₄₅₆₇₈₉'[number]}", format_si(float(found.theta[i]), "mm" if prismatic[i] else "deg", 2), "")
        for i, number in enumerate(robot.joint_numbers)
    ]
    what = quantity(robot, "det_J")
    det = float(determinant(robot, found.theta))
    rows += [
        ("det(J)", format_si(det, what.unit, 3), ""),
        ("to the limits", format_percent(limit_distance(robot, found.theta)), ""),
    ]
    pieces.facts(rows)


def _matrix(found: PointReport, old: PointReport) -> None:
    st.markdown(f"**Compliance C** in {{M}}, {unit_label('um/N')}")
    pieces.matrix(_numbers(from_si(found.C, "um/N")), list(AXES))
    change = from_si(found.C - old.C, "um/N")
    if np.abs(change).max() > 5e-4:
        pieces.note("Change by the factors:")
        pieces.matrix(_numbers(change, sign=True), list(AXES))
    values, axes = soft_direction(found.C)
    pieces.note("Principal compliances and their directions:")
    shown = [
        [format_si(values[i], "um/N", with_unit=False), *(format_number(v, 2) for v in _forward(axes[:, i]))]
        for i in (2, 1, 0)
    ]
    grid(shown, ["softest", "middle", "stiffest"], [unit_label("um/N"), *AXES])


def _forward(axis: FloatArray) -> FloatArray:
    return axis * np.sign(axis[np.argmax(np.abs(axis))])


def _six(found: PointReport) -> None:
    st.markdown("**Rotations, too: C<sub>X</sub>, eq. (11), and J, eq. (9)**", unsafe_allow_html=True)
    six = full_compliance(found.robot, found.theta)
    shown = np.empty((6, 6))
    shown[:3, :3] = from_si(six[:3, :3], "um/N")
    shown[3:, :3], shown[:3, 3:] = from_si(six[3:, :3], "urad/N"), from_si(six[:3, 3:], "urad/N")
    shown[3:, 3:] = from_si(six[3:, 3:], "urad/(N m)")
    grid(
        _numbers(shown),
        ["δx", "δy", "δz", "φx", "φy", "φz"],
        ["Fx", "Fy", "Fz", "Mx", "My", "Mz"],
    )
    pieces.note("δ per F in µm/N, φ per F and δ per M in µrad/N, φ per M in µrad/(N m).")
    grid(
        _numbers(found.J),
        ["vx", "vy", "vz", "ωx", "ωy", "ωz"],
        [f"J{'₀₁₂₃₄₅₆₇₈₉'[i]}" for i in found.robot.joint_numbers],
    )
    pieces.note("J in m/rad and rad/rad, columns by joint, rows in {M}.")


def grid(rows: Sequence[Sequence[str]], row_names: Sequence[str], column_names: Sequence[str]) -> None:
    """A matrix with named rows and columns that need not be the same."""
    head = "".join(f"<th>{_low(n)}</th>" for n in column_names)
    body = "".join(
        f"<tr><th>{_low(name)}</th>" + "".join(f"<td>{html.escape(v)}</td>" for v in row) + "</tr>"
        for name, row in zip(row_names, rows, strict=True)
    )
    st.html(f'<div style="overflow-x:auto"><table class="rm-matrix"><tr><th></th>{head}</tr>{body}</table></div>')


def _low(name: str) -> str:
    """A one-letter symbol with its index set low; words and units as they are."""
    return f"{html.escape(name[0])}<sub>{html.escape(name[1:])}</sub>" if len(name) == 2 else html.escape(name)


def _numbers(matrix: FloatArray, sign: bool = False) -> list[list[str]]:
    return [[format_number(value, 3, sign) for value in row] for row in matrix]
