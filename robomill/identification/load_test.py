"""Load tests: what was pushed, where, and how far the tool moved.

Two kinds. ``LoadTests``: a load on the tool and the displacement measured near it, at known poses (any
direction, any size; forces and displacements are *differences* between loaded and preloaded, so gravity and
the arm's own weight cancel). ``JointTests``: one joint loaded at a time, torque against angle (the paper's
Table 2). Everything in SI and in {M}; offsets of the force and measuring points in {T}.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, IntArray, frozen
from robomill.errors import LoadTestError
from robomill.kinematics.forward import tool_pose
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.units import format_si

LIMIT_SLACK = 1e-5  # rad (m): rounding of a written angle allowed beyond a joint limit
POSE_DIGITS = 9  # configurations equal to 1e-9 rad (m) are one pose


@dataclass(frozen=True, eq=False)
class LoadTests:
    """Loads on the tool and the displacements they caused, one entry a test.

    wrench        (m, 6) N, N m     force and moment *differences* on the tool, at the force point, in {M}
    displacement  (m, 6) m, rad     what was measured at the measuring point, in {M}; NaN: not measured
    theta         (m, n) rad        configurations, or None when the poses are given in the world
    x_M           (m, 5) m, rad     world coordinates X, Y, Z, A, B, or None when given as joints
    force_point, measuring_point    (m, 3) m, offsets from the tool tip, in {T}
    noise         (m,) m            standard deviation of one measured displacement, NaN: not stated
    row           (m,) int          the row of the file each test came from (1 = first line)
    synthetic     made by calculation: no measurement of a real robot
    """

    single: ClassVar[Literal[False]] = False  # not tests of single joints: the tool was loaded

    wrench: FloatArray
    displacement: FloatArray
    theta: FloatArray | None = None
    x_M: FloatArray | None = None
    force_point: FloatArray = None  # type: ignore[assignment]
    measuring_point: FloatArray = None  # type: ignore[assignment]
    noise: FloatArray = None  # type: ignore[assignment]
    row: IntArray = None  # type: ignore[assignment]
    findings: tuple[Finding, ...] = ()
    source: str = ""
    synthetic: bool = False
    protocol: str = "displacements"

    def __post_init__(self) -> None:
        wrench = _six(self.wrench, "wrench")
        m = len(wrench)
        if m == 0:
            raise LoadTestError("Load tests: no test in it; give at least one loaded pose.")
        row = np.arange(1, m + 1) if self.row is None else np.asarray(self.row)
        if row.shape != (m,):
            raise LoadTestError(f"row: expected {m} row numbers, found an array of shape {row.shape}.")
        displacement = _six(self.displacement, "displacement")
        fields = {
            "wrench": wrench,
            "displacement": displacement,
            "force_point": _default(self.force_point, m, "force_point"),
            "measuring_point": _default(self.measuring_point, m, "measuring_point"),
            "noise": np.full(m, np.nan) if self.noise is None else np.broadcast_to(self.noise, (m,)),
        }
        if (self.theta is None) == (self.x_M is None):
            raise LoadTestError("Load tests: give the poses either as theta or as x_M, one of the two.")
        name = "theta" if self.theta is not None else "x_M"
        poses = np.asarray(getattr(self, name), dtype=np.float64)
        if poses.ndim != 2 or len(poses) != m or (name == "x_M" and poses.shape[1] != 5):
            raise LoadTestError(f"{name}: expected one pose for each of the {m} tests, found shape {poses.shape}.")
        fields[name] = poses
        if displacement.shape != (m, 6):
            raise LoadTestError(f"displacement: expected shape {(m, 6)}, found {displacement.shape}.")
        for key, value in fields.items():
            bad = ~np.isfinite(value) if key not in ("displacement", "noise") else np.isinf(value)
            if bad.any():
                where = int(row[np.argwhere(bad)[0][0]])
                raise LoadTestError(
                    f"Row {where}, {key}: found NaN or infinity, expected numbers.", where=f"row {where}"
                )
            object.__setattr__(self, key, frozen(value))
        object.__setattr__(self, "row", frozen(row, np.int64))
        _refuse_empty(wrench, displacement, row)

    def __len__(self) -> int:
        return len(self.wrench)

    def without(self, rows: Iterable[int]) -> LoadTests:
        """The tests without those of the named rows."""
        keep = ~np.isin(self.row, list(rows))
        return self.select(keep)

    def select(self, chosen: ArrayLike | slice) -> LoadTests:
        """The tests at ``chosen`` (a mask, indices or a slice), in that order."""
        index = np.arange(len(self))[chosen if isinstance(chosen, slice) else np.asarray(chosen)]
        return self._with({key: None if value is None else value[index] for key, value in self._arrays().items()})

    def joined(self, other: LoadTests) -> LoadTests:
        """These tests, then ``other``'s; both must give their poses the same way. Rows are renumbered."""
        if (self.theta is None) != (other.theta is None):
            raise LoadTestError("Load tests: joints and world poses cannot be joined; call with_joints(robot) first.")
        mine, others = self._arrays(), other._arrays()
        both = {k: None if v is None else np.concatenate([v, others[k]]) for k, v in mine.items()}
        return replace(self._with({**both, "row": None}), findings=self.findings + other.findings)

    def _arrays(self) -> dict[str, Any]:
        names = ("wrench", "displacement", "theta", "x_M", "force_point", "measuring_point", "noise", "row")
        return {name: getattr(self, name) for name in names}

    def _with(self, arrays: dict[str, Any]) -> LoadTests:
        return replace(self, **arrays)

    def with_joints(self, robot: Robot) -> LoadTests:
        """The same tests with ``theta`` known and checked against the robot's limits.

        Raises LoadTestError naming the row whose pose cannot be reached or lies outside the limits.
        """
        if self.theta is not None:
            _check_joints(robot, self.theta, self.row)
            return self
        assert self.x_M is not None
        poses, back = np.unique(self.x_M, axis=0, return_inverse=True)
        solved = inverse_kinematics(robot, pose_from_world(poses))
        if not solved.reached.all():
            first = int(np.argmin(solved.reached[back.ravel()]))
            row, k = int(self.row[first]), int(back.ravel()[first])
            raise LoadTestError(
                f"Row {row}: the pose X, Y, Z = {_mm(poses[k, :3])} is not reached ({solved.reason(k)}); "
                "check the coordinates, the tool or the robot's limits.",
                where=f"row {row}",
            )
        found = (*self.findings, _solved_finding(robot))
        return replace(self, theta=solved.theta[back.ravel()], x_M=None, findings=found)

    def pose_index(self) -> IntArray:
        """(m,) number of the pose of each test: equal configurations share a number, from 0."""
        poses = self.theta if self.theta is not None else self.x_M
        assert poses is not None
        rounded = np.round(poses, POSE_DIGITS) + 0.0
        order = np.lexsort(rounded.T[::-1])
        new = np.any(np.diff(rounded[order], axis=0) != 0, axis=1)
        index = np.empty(len(order), dtype=np.int64)
        index[order] = np.concatenate([[0], np.cumsum(new)])
        return index

    def tool_poses(self, robot: Robot) -> FloatArray:
        """(m, 4, 4) T_MT of each test; the poses must be known as joints."""
        if self.theta is None:
            raise LoadTestError("Load tests: the poses are given in the world; call with_joints(robot) first.")
        return tool_pose(robot, self.theta)


@dataclass(frozen=True, eq=False)
class JointTests:
    """One joint loaded at a time, the joints below it blocked: the paper's Table 2.

    joint (m,) int from 1; torque (m,) N m about the joint's axis; angle (m,) rad by which it turned
    (N and m for a prismatic joint); noise (m,) rad, NaN: not stated; row (m,) of the file.
    """

    single: ClassVar[Literal[True]] = True

    joint: IntArray
    torque: FloatArray
    angle: FloatArray
    noise: FloatArray = None  # type: ignore[assignment]
    row: IntArray = None  # type: ignore[assignment]
    findings: tuple[Finding, ...] = ()
    source: str = ""
    synthetic: bool = False
    protocol: str = "one joint at a time"

    def __post_init__(self) -> None:
        m = len(self.joint)
        if m == 0:
            raise LoadTestError("Joint tests: no test in it; give at least one torque and angle.")
        row = np.arange(1, m + 1) if self.row is None else np.asarray(self.row)
        torque, angle = (np.asarray(v, dtype=np.float64) for v in (self.torque, self.angle))
        for name, value in (("torque", torque), ("angle", angle)):
            if value.shape != (m,) or not np.isfinite(value).all():
                raise LoadTestError(f"{name}: expected {m} finite numbers, found shape {value.shape} or NaN.")
        if (torque == 0).any():
            where = int(row[np.argmax(torque == 0)])
            raise LoadTestError(f"Row {where}: the torque is zero, so nothing can be learned; delete the row.")
        noise = np.full(m, np.nan) if self.noise is None else np.broadcast_to(self.noise, (m,))
        for name, value in (("torque", torque), ("angle", angle), ("noise", noise)):
            object.__setattr__(self, name, frozen(value))
        object.__setattr__(self, "joint", frozen(self.joint, np.int64))
        object.__setattr__(self, "row", frozen(row, np.int64))

    def __len__(self) -> int:
        return len(self.torque)

    def without(self, rows: Iterable[int]) -> JointTests:
        """The tests without those of the named rows."""
        keep = ~np.isin(self.row, list(rows))
        return replace(
            self,
            joint=self.joint[keep],
            torque=self.torque[keep],
            angle=self.angle[keep],
            noise=self.noise[keep],
            row=self.row[keep],
        )


def _six(value: ArrayLike, name: str) -> FloatArray:
    """(m, 3) or (m, 6) as (m, 6): no moment, rotation not measured."""
    array = np.asarray(value, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] not in (3, 6):
        raise LoadTestError(f"{name}: expected shape (m, 3) or (m, 6), found {array.shape}.")
    if array.shape[1] == 6:
        return array
    fill = 0.0 if name == "wrench" else np.nan
    return np.concatenate([array, np.full_like(array, fill)], axis=1)


def _default(value: ArrayLike | None, m: int, name: str) -> FloatArray:
    if value is None:
        return np.zeros((m, 3))
    try:
        return np.broadcast_to(np.asarray(value, dtype=np.float64), (m, 3))
    except ValueError as exc:
        raise LoadTestError(f"{name}: expected shape (3,) or ({m}, 3), found {np.shape(value)}.") from exc


def _refuse_empty(wrench: FloatArray, displacement: FloatArray, row: IntArray) -> None:
    idle = ~wrench.any(axis=1)
    if idle.any():
        where = int(row[np.argmax(idle)])
        raise LoadTestError(
            f"Row {where}: the force is zero, so nothing can be learned from it; enter the force or delete the row.",
            where=f"row {where}",
        )
    blind = np.isnan(displacement).all(axis=1)
    if blind.any():
        where = int(row[np.argmax(blind)])
        raise LoadTestError(
            f"Row {where}: no displacement was measured; enter it or delete the row.", where=f"row {where}"
        )


def _check_joints(robot: Robot, theta: FloatArray, row: IntArray) -> None:
    if theta.shape[1] != robot.n:
        raise LoadTestError(
            f"Load tests: {theta.shape[1]} joint columns for a robot of {robot.n} joints; give theta1_deg to "
            f"theta{robot.n}_deg, one column a free joint."
        )
    lower, upper = robot.limits[:, 0], robot.limits[:, 1]
    outside = (theta < lower - LIMIT_SLACK) | (theta > upper + LIMIT_SLACK)
    if not outside.any():
        return
    k, i = (int(v) for v in np.argwhere(outside)[0])
    unit = "mm" if robot.chain.prismatic[i] else "deg"
    low, high, found = (format_si(float(v), unit) for v in (lower[i], upper[i], theta[k, i]))
    raise LoadTestError(
        f"Row {row[k]}, theta{i + 1}: {found} is outside joint {i + 1}'s limits of {low} to {high}; "
        "check the angle, its sign, or the robot's limits.",
        where=f"row {row[k]}",
    )


def _solved_finding(robot: Robot) -> Finding:
    """World poses do not say how the arm stood; which way was taken for granted is said."""
    if robot.n >= 6:
        text = (
            "Poses as X, Y, Z, A, B leave the turn about the tool axis open: it was taken as near home as the limits "
            "allow; give joints if the robot stood otherwise, since its compliance depends on it."
        )
        return Finding("warning", 0, text, code="turn-about-the-tool")
    text = (
        "Joints were solved from X, Y, Z, A, B with shoulder and elbow as at home; give joints if they stood otherwise."
    )
    return Finding("info", 0, text, code="joints-solved")


def _mm(p: FloatArray) -> str:
    return ", ".join(format_si(float(v), "mm", 1) for v in p)
