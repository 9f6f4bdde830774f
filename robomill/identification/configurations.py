"""Where the arm stood: joints from poses in the world, checked against its limits, and cables aimed at their pulleys.

World coordinates have five numbers, X, Y, Z, A, B, or with C six: R = R_x(A) R_y(B) R_z(C), so C is the turn about the
tool axis that the first five leave open.
"""

from typing import Literal

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.errors import LoadTestError
from robomill.kinematics.decoupled import decoupled
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world, rotation_z, world_from_pose
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.units import format_many, format_percent, format_si, from_si, to_si

SLIPS = {  # by words: a number that was meant in the one unit, and stands under the other
    f"{meant} under a header in {said}": (meant, said)
    for meant, said in (("in", "mm"), ("mm", "in"), ("m", "mm"), ("mm", "m"))
}
OTHER_UNITS = {slip: to_si(1.0, meant) / to_si(1.0, said) for slip, (meant, said) in SLIPS.items()}  # times
SOLVED = frozenset({"turn-about-the-tool", "posture-open", "postures-open", "joints-solved"})
"""Codes of what is said where joints were solved from poses."""
WRITTEN = 4  # decimals of a length as tables have it
LIMIT_SLACK = 1e-5  # rad (m): rounding of a written angle allowed beyond a joint limit


def world_of(T_MT: FloatArray) -> FloatArray:
    """(..., 6) m, rad: X, Y, Z, A, B, C of tool poses (..., 4, 4)."""
    x_M = world_from_pose(T_MT)
    R = np.swapaxes(pose_from_world(x_M)[..., :3, :3], -1, -2) @ T_MT[..., :3, :3]
    return np.concatenate([x_M, np.arctan2(R[..., 1, 0], R[..., 0, 0])[..., None]], axis=-1)


def pose_of(x_M: FloatArray) -> FloatArray:
    """T_MT (..., 4, 4) of world coordinates (..., 5 or 6)."""
    T_MT = pose_from_world(x_M[..., :5])
    if x_M.shape[-1] == 6:
        T_MT[..., :3, :3] = T_MT[..., :3, :3] @ rotation_z(x_M[..., 5])
    return T_MT


def solved(robot: Robot, x_M: FloatArray, rows: IntArray) -> tuple[FloatArray, Finding]:
    """theta (m, n) of world coordinates (m, 5 or 6), and what was taken for granted.

    Raises LoadTestError naming the row whose pose is not reached.
    """
    whole = x_M.shape[1] == 6
    if whole and robot.n < 6:
        raise LoadTestError(
            f"Load tests: {robot.name} has {robot.n} joints, which leave the turn C about the tool no choice; give its "
            "poses as X, Y, Z, A, B or as joints."
        )
    poses, back = np.unique(x_M, axis=0, return_inverse=True)
    found = inverse_kinematics(robot, pose_of(poses), spin="fixed" if whole else "least_motion")
    if not found.reached.all():
        first = int(np.argmin(found.reached[back.ravel()]))
        row, k = int(rows[first]), int(back.ravel()[first])
        place = format_many(poses[k, :3], "mm", 1)
        raise LoadTestError(
            f"Row {row}: the pose X, Y, Z = {place} is not reached ({found.reason(k)}); "
            f"check the coordinates, the tool or the robot's limits{_other_unit(robot, poses, found.reached)}.",
            where=f"row {row}",
        )
    open_ones = _postures(robot, pose_of(poses)) > 1 if whole else np.zeros(len(poses), dtype=bool)
    return found.theta[back.ravel()], _taken(robot, whole, rows[open_ones[back.ravel()]])


def _other_unit(robot: Robot, poses: FloatArray, reached: BoolArray) -> str:
    """What the lengths of poses (k, 5 or 6) may have been meant in, where that would be reached far more often."""
    spin: Literal["fixed", "least_motion"] = "fixed" if poses.shape[1] == 6 else "least_motion"
    for slip, factor in OTHER_UNITS.items():
        said = SLIPS[slip][1]
        written = from_si(poses[:, :3], said)
        if said == "in" and np.abs(written - written.round(WRITTEN)).max() > 1e-6 * np.abs(written).max():
            continue  # a table in inches would hardly have such numbers: they are converted from mm
        scaled = np.concatenate([poses[:, :3] * factor, poses[:, 3:]], axis=1)
        share = inverse_kinematics(robot, pose_of(scaled), spin=spin).reached.mean()
        if share > max(0.5, 2.0 * reached.mean()):
            return f"; read as {slip}, {format_percent(share)} of the poses would be reached"
    return ""


def _postures(robot: Robot, T_MT: FloatArray) -> IntArray:
    """(k,) in how many ways shoulder and elbow may stand within the limits; 1 for arms without named ones."""
    if decoupled(robot) is None:
        return np.ones(len(T_MT), dtype=np.int64)
    sides = [f"{shoulder}, {elbow}" for shoulder in ("front", "back") for elbow in ("elbow up", "elbow down")]
    return sum(inverse_kinematics(robot, T_MT, spin="fixed", branch=side).reached.astype(np.int64) for side in sides)  # type: ignore[return-value]


def _taken(robot: Robot, whole: bool, rows: IntArray) -> Finding:
    """World poses do not say how the arm stood; which way was taken for granted is said."""
    if robot.n >= 6 and not whole:
        text = (
            "Poses as X, Y, Z, A, B leave the turn about the tool axis open: it was taken as near home as the limits "
            "allow; give joints if the robot stood otherwise, since its compliance depends on it."
        )
        return Finding("warning", text, code="turn-about-the-tool")
    if robot.n > 6:
        text = (
            f"A pose leaves an arm of {robot.n} joints a posture to choose: it was taken as near home as the limits "
            "allow; give joints if the robot stood otherwise, since its compliance depends on it."
        )
        return Finding("warning", text, code="posture-open")
    if whole and decoupled(robot) is None:
        text = (
            "A pose lets this arm stand in several ways, and its compliance depends on which: the one found near home "
            "was taken; give joints where it stood otherwise."
        )
        return Finding("warning", text, code="postures-open")
    if len(rows):
        text = (
            f"In {len(rows)} tests (row {rows[0]} is the first) the arm may also have stood with shoulder or elbow "
            "another way than at home, and its compliance depends on it: give joints where it did."
        )
        return Finding("warning", text, int(rows[0]), count=len(rows), code="postures-open", place="")
    names = "X, Y, Z, A, B, C" if whole else "X, Y, Z, A, B"
    text = f"Joints were solved from {names} with shoulder and elbow as at home; give joints if they stood otherwise."
    return Finding("info", text, code="joints-solved")


def sliding_joints(robot: Robot) -> tuple[int, ...]:
    """Numbers, from 1 among the free joints, of those that slide."""
    return tuple(int(i) + 1 for i in np.flatnonzero(robot.chain.prismatic))


def checked(robot: Robot, theta: FloatArray, row: IntArray, sliding: tuple[int, ...] | None = None) -> None:
    """Raises LoadTestError naming row and joint where theta (m, n) is not one of the robot's configurations, or where
    the joints that were given as lengths (``sliding``) are not those that slide."""
    if theta.shape[1] != robot.n:
        raise LoadTestError(
            f"Load tests: {theta.shape[1]} joint columns for a robot of {robot.n} joints; give theta1_deg to "
            f"theta{robot.n}_deg, one column a free joint."
        )
    odd = sorted(set(sliding_joints(robot)).symmetric_difference(sliding)) if sliding is not None else []
    if odd:
        does, unit = ("turns", "deg") if odd[0] in (sliding or ()) else ("slides", "mm")
        raise LoadTestError(f"Load tests, column theta{odd[0]}: this joint {does}; give theta{odd[0]}_{unit}.")
    lower, upper = robot.limits[:, 0], robot.limits[:, 1]
    outside = (theta < lower - LIMIT_SLACK) | (theta > upper + LIMIT_SLACK)
    if not outside.any():
        return
    k, i = (int(v) for v in np.argwhere(outside)[0])
    low, high, found = (format_si(float(v), robot.joint_units[i]) for v in (lower[i], upper[i], theta[k, i]))
    raise LoadTestError(
        f"Row {row[k]}, theta{i + 1}: {found} is outside joint {i + 1}'s limits of {low} to {high}; "
        "check the angle, its sign, or the robot's limits.",
        where=f"row {row[k]}",
    )


def ways(T_MT: FloatArray, point: FloatArray, pulley: FloatArray) -> FloatArray:
    """(m, 3) m from points of the tool (m, 3), in {T}, to the pulleys (m, 3) in {M}."""
    return np.asarray(pulley - T_MT[:, :3, 3] - np.einsum("mij,mj->mi", T_MT[:, :3, :3], point))
