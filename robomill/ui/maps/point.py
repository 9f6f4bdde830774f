"""The full report of one pose: the arm with its compliance ellipsoid, joints, Jacobian, C, shares that sum to it."""

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport
from robomill.compliance.components import COMPONENTS
from robomill.ui import pieces, session, shell
from robomill.ui.posed import fields
from robomill.ui.posed.arm import arm
from robomill.ui.posed.point import InHand, compliance_matrix, place
from robomill.ui.posed.push import Decided, Moved
from robomill.units import (
    format_many,
    format_number,
    format_percent,
    format_si,
    format_times,
    from_si,
    unit_label,
)
from robomill.viz.arm import ArmScene, displacement_scale
from robomill.viz.shares import share_bars
from robomill.viz.theme import joint_colours
from robomill.wording import lowered

AXES = "XYZ"
ASPECT = 1.1  # of the arm's frame: it is whole in the narrowest column


def headline(found: InHand, moved: Moved, unit: str) -> str:
    """What the push does there, in one sentence."""
    if not found.pose.reached:
        return f"The tool does not get to {place(found.point, unit)}: {found.reason}."
    return moved.sentence(unit)


def lead(found: InHand, moved: Moved, cut: Decided | None, at_cut: bool, unit: str) -> str:
    """Which joints give, and where and by whose force that is."""
    where = f"the selected point {place(found.point, unit)}"
    if at_cut and cut is not None:
        where = f"line {cut.line} of the cut, which decides its verdict: {place(found.point, unit)}"
    elif cut is not None and not moved.push.axis:
        where += f", with the force of the cut at line {cut.line}"
    blame = moved.blame(unit) if found.pose.reached else ""
    return f"{blame} At {where}.".lstrip()


def show(found: InHand, old: PoseReport, moved: Moved, component: str, unit: str) -> None:
    """The arm as it stands there with its ellipsoid, and folded the numbers: joints, C, six by six, Jacobian."""
    st.header(f"At the selected point {place(found.point, unit)}")
    if not found.pose.reached:
        pieces.note(f"Not reached: {found.reason}. Click a coloured cell of a map.")
        return
    _posture_note(found.pose, component)
    left, right = pieces.split([1.3, 1], "point")
    with left, st.container(border=True, height="stretch"):
        _arm(found.pose, moved, unit)
    with right:
        _joints(found.pose)
        _matrix(found.pose, old)
    with st.expander("Full matrices: C with rotations, and the Jacobian"):
        _six(found.pose)


def _posture_note(pose: PoseReport, component: str) -> None:
    """Over what the component ranges where the arm can hold the tool there in many postures."""
    C = pieces.underway(fields.postures, pose.robot, pose.T_MT)
    if C is not None and len(C):
        a, b = ("xyz".index(axis) for axis in component)
        values = np.append(C[:, a, b], pose.C[a, b])  # the one that is shown is one of them
        ends = format_many((values.min(), values.max()), session.project().view.of("um/N"), between=" to ")
        words = f"Over {len(C)} postures that hold the tool here, C_{component} ranges from {ends}."
        pieces.note("What stands here holds for one posture.", pieces.subscripts(words))


def _arm(pose: PoseReport, moved: Moved, unit: str) -> None:
    delta = moved.delta
    scene = ArmScene(
        frames=pose.frames,
        joints=pose.robot.joint_numbers,
        force=moved.push.F,
        displacement=delta if moved.moves else None,
        force_label=moved.push.size,
        displacement_label=format_si(moved.size, unit),
        C=pose.C,
        aspect=ASPECT,
    )
    caption = (
        f"Brown body: where the tip goes under one force in every direction. Blue: {moved.push.words}. Orange: the "
        f"displacement, shown {format_times(displacement_scale(delta, pose.frames))}."
    )
    alt = "The arm at this pose with the compliance ellipsoid at the tip."
    arm(scene, "point-arm", (caption, alt), 440)


def bars(found: InHand, old: PoseReport, unit: str) -> None:
    """Which joint contributes how much to each component at the selected point."""
    pieces.strong("Share of each joint at the selected point")
    where = place(found.point, unit)
    colours = joint_colours(7, shell.dark())
    numbers = found.pose.robot.joint_numbers
    key = (
        f'<span style="white-space:nowrap"><span style="color:{colours[k % 7]}">■</span> joint {number}</span>'
        for k, number in enumerate(numbers)
    )
    st.html(f'<p class="rm-note" style="opacity:1">{" &ensp;".join(key)}</p>')
    if not found.pose.reached:
        pieces.note(f"Not reached: {found.reason}. Click a coloured cell of a map.")
        return
    pose, um = found.pose, session.project().view.of("um/N")
    names = [f"C<sub>{c}</sub>" for c in COMPONENTS]
    before = np.array([from_si(old.component(c), um) for c in COMPONENTS])
    shares = _by_component(pose, um)
    said = ", ".join(f"C_{c} {format_si(pose.component(c), um, 3)}" for c in COMPONENTS)
    pieces.figure(
        share_bars(names, shares, pose.robot.joint_numbers, unit_label(um), dark=shell.dark(), old=before),
        "point-shares",
        table=lambda: share_columns(pose),
        alt=f"Shares of the joints in each compliance component at {where}: {said}.",
        caption="Shares and their sum",
    )


def _by_component(pose: PoseReport, unit: str) -> FloatArray:
    """(n, 6) in ``unit``: each joint's share of each component."""
    return from_si(np.stack([pose.shares(c) for c in COMPONENTS], axis=-1), unit)


def share_columns(pose: PoseReport) -> dict[str, object]:
    """The table twin of the bars."""
    shares = _by_component(pose, "um/N")
    columns: dict[str, object] = {"joint": [*map(str, pose.robot.joint_numbers), "sum"]}
    for k, c in enumerate(COMPONENTS):
        columns[f"C_{c}_um/N"] = [*shares[:, k], shares[:, k].sum()]
    return columns


def _joints(pose: PoseReport) -> None:
    robot = pose.robot
    st.markdown("**Joints**")
    rows = [
        (lowered("θ", number), format_si(float(pose.theta[i]), robot.joint_units[i], 2), "")
        for i, number in enumerate(robot.joint_numbers)
    ]
    rows += [
        ("Distance to singularity, det(J)", format_si(pose.det_J, session.project().view.of(pose.det_J_unit), 3), ""),
        ("Room to joint limits", format_percent(pose.limit_distance), ""),
    ]
    pieces.facts(rows)


def _matrix(pose: PoseReport, old: PoseReport) -> None:
    compliance_matrix(pose)
    um = session.project().view.of("um/N")
    change = from_si(pose.C - old.C, um)
    if np.abs(change).max() > 5e-4:
        pieces.note("Change by the factors:")
        pieces.matrix(_numbers(change, sign=True), list(AXES))
    values, axes = pose.principal
    pieces.note("Principal compliances and their directions:")
    shown = [[format_si(values[i], um, with_unit=False), *(format_number(v, 2) for v in axes[:, i])] for i in (2, 1, 0)]
    pieces.matrix(shown, ["largest", "middle", "smallest"], [unit_label(um), *AXES])


def _six(pose: PoseReport) -> None:
    st.markdown("**Rotations, too: C<sub>X</sub>, eq. (11), and J, eq. (9)**", unsafe_allow_html=True)
    six = pose.C_X
    shown = np.empty((6, 6))
    view = session.project().view
    um, m = view.of("um/N"), view.of("m")
    shown[:3, :3] = from_si(six[:3, :3], um)
    shown[3:, :3], shown[:3, 3:] = from_si(six[3:, :3], "urad/N"), from_si(six[:3, 3:], "urad/N")
    shown[3:, 3:] = from_si(six[3:, 3:], "urad/(N m)")
    pieces.matrix(
        _numbers(shown),
        ["δx", "δy", "δz", "φx", "φy", "φz"],
        ["Fx", "Fy", "Fz", "Mx", "My", "Mz"],
    )
    pieces.note(f"δ per F in {unit_label(um)}, φ per F and δ per M in µrad/N, φ per M in µrad/(N m).")
    pieces.matrix(
        _numbers(np.concatenate([from_si(pose.J[:3], m), pose.J[3:]])),
        ["vx", "vy", "vz", "ωx", "ωy", "ωz"],
        [lowered("J", i) for i in pose.robot.joint_numbers],
    )
    pieces.note(f"J in {unit_label(m)}/rad and rad/rad, columns by joint, rows in {{M}}.")


def _numbers(matrix: FloatArray, sign: bool = False) -> list[list[str]]:
    return [[format_number(value, 3, sign) for value in row] for row in matrix]
