"""Load tests: what was pushed, where, and how far the tool moved.

Two kinds. ``LoadTests``: a load on the tool and the displacement measured near it, at known poses (any
direction, any size; forces and displacements are *differences* between loaded and preloaded, so gravity and
the arm's own weight cancel). ``JointTests``: one joint loaded at a time, torque against angle (the paper's
Table 2). Everything in SI and in {M}; offsets of the force and measuring points in {T}.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked, asking
from robomill.arrays import BoolArray, FloatArray, IntArray, digest, frozen, made_array
from robomill.errors import LoadTestError
from robomill.frames import Columns
from robomill.identification.array_checks import floats, gauge_directions, given_or, six_columns
from robomill.identification.configurations import checked, sliding_joints, solved, ways
from robomill.kinematics.forward import tool_pose
from robomill.lazy import cached_property
from robomill.provenance import Finding, Provenance
from robomill.quantities import GREATEST
from robomill.robot.model import Robot
from robomill.units import format_count, format_si, from_si
from robomill.values import Tabled

POSE_DIGITS = 9  # configurations equal to 1e-9 rad (m) are one pose
MEASURED = Provenance("measured", "")


class _Rows(Tabled):
    """What both kinds do with their rows: every array of theirs holds one entry a test."""

    row: IntArray
    provenance: Provenance
    protocol: str
    noise: FloatArray

    @cached_property
    def _digest(self) -> str:
        return digest((self._arrays(), self.provenance.kind, self.protocol))  # not where they were read, nor how

    def _about(self) -> dict[str, str]:
        return {"provenance": self.provenance.kind}

    def _rows(self) -> IntArray:
        return self.row

    def _noise(self, unit: str) -> Columns:
        """The standard deviation of one reading, where any is stated."""
        return {f"noise_{unit}": from_si(self.noise, unit)} if np.isfinite(self.noise).any() else {}

    def __len__(self) -> int:
        return len(self.row)

    @asked
    def select(self, chosen: ArrayLike | slice) -> Self:
        """The tests at ``chosen`` (a mask, indices or a slice), in that order."""
        index = np.arange(len(self))[chosen if isinstance(chosen, slice) else np.asarray(chosen)]
        return self._with({name: value[index] for name, value in self._arrays().items()})

    @asked
    def thinned(self, most: int) -> Self:
        """No more than ``most`` of the tests, taken evenly."""
        return self.select(slice(None, None, -(-len(self) // most)))

    @asked
    def without(self, rows: Iterable[int]) -> Self:
        """The tests without those of the named rows."""
        return self.select(~np.isin(self.row, list(rows)))

    def _arrays(self) -> dict[str, Any]:
        values = {each.name: getattr(self, each.name) for each in fields(self)}  # type: ignore[arg-type]
        return {name: value for name, value in values.items() if isinstance(value, np.ndarray)}

    def _with(self, changed: dict[str, Any]) -> Self:
        return replace(self, **changed)  # type: ignore[type-var]


@asking
@dataclass(frozen=True, eq=False, repr=False)
class LoadTests(_Rows):
    """Loads on the tool and the displacements they caused, one entry a test.

    wrench        (m, 6) N, N m     force and moment *differences* on the tool, at the force point, in {M}
    displacement  (m, 6) m, rad     what was measured at the measuring point, in {M}; NaN: not measured
    theta         (m, n) rad        configurations (m where a joint slides), or None when the poses are in the world
    sliding       numbers, from 1, of the joints whose coordinate was given as a length; None: as the robot has it
    x_M           (m, 5 or 6) m, rad  world coordinates X, Y, Z, A, B and perhaps C (``configurations``), or None
    force_point, measuring_point    (m, 3) m, offsets from the tool tip, in {T}
    noise         (m,) m            standard deviation of one measured displacement, NaN: not stated
    row           (m,) int          the row of the file each test came from (1 = first line)
    gauges        (m, 3, 3)         unit vectors in {M} along which displacement[:, :3] is read; None: along x, y, z
    pulley        (m, 3) m          in {M}, where the force is ``aimed`` at it from the force point; NaN: it is measured

    Raises
    ------
    LoadTestError
        Naming the row of what is missing, not finite, or cannot teach anything.

    Examples
    --------
    >>> import robomill as rm
    >>> tests = rm.LoadTests([[0.0, 250.0, 0.0]], [[1e-5, 5.7e-4, -2.6e-4]], x_M=[[0.0, -1.3, 0.0, 0.0, 0.0]])
    >>> tests
    <LoadTests 1 test at 1 pose, up to 250 N and 0.627 mm, measured>
    """

    single: ClassVar[Literal[False]] = False  # not tests of single joints: the tool was loaded

    wrench: FloatArray
    displacement: FloatArray
    theta: FloatArray | None = None
    x_M: FloatArray | None = None
    force_point: FloatArray = made_array()
    measuring_point: FloatArray = made_array()
    noise: FloatArray = made_array()
    row: IntArray = made_array()
    gauges: FloatArray | None = None
    pulley: FloatArray = made_array()
    findings: tuple[Finding, ...] = ()
    provenance: Provenance = MEASURED
    protocol: str = "displacements"
    sliding: tuple[int, ...] | None = None

    def __post_init__(self) -> None:
        wrench = six_columns(self.wrench, "wrench")
        m = len(wrench)
        if m == 0:
            raise LoadTestError("Load tests: no test in it; give at least one loaded pose.")
        row = np.arange(1, m + 1) if self.row is None else np.asarray(self.row)
        if row.shape != (m,):
            raise LoadTestError(f"row: expected {m} row numbers, found an array of shape {row.shape}.")
        displacement = six_columns(self.displacement, "displacement")
        values = {
            "wrench": wrench,
            "displacement": displacement,
            "force_point": given_or(self.force_point, (m, 3), "force_point"),
            "measuring_point": given_or(self.measuring_point, (m, 3), "measuring_point"),
            "noise": given_or(self.noise, (m,), "noise", np.nan),
            "pulley": given_or(self.pulley, (m, 3), "pulley", np.nan),
        }
        if (self.theta is None) == (self.x_M is None):
            raise LoadTestError("Load tests: give the poses either as theta or as x_M, one of the two.")
        name = "theta" if self.theta is not None else "x_M"
        poses = floats(getattr(self, name), name)
        if poses.ndim != 2 or len(poses) != m or (name == "x_M" and poses.shape[1] not in (5, 6)):
            raise LoadTestError(f"{name}: expected one pose for each of the {m} tests, found shape {poses.shape}.")
        values[name] = poses
        if self.gauges is not None:
            values["gauges"] = gauge_directions(self.gauges, displacement, row)
        if displacement.shape != (m, 6):
            raise LoadTestError(f"displacement: expected shape {(m, 6)}, found {displacement.shape}.")
        for key, value in values.items():
            known = np.isnan(value) if key in ("displacement", "noise", "pulley") else np.zeros(value.shape, dtype=bool)
            bad = ~(known | (np.abs(value) <= GREATEST))
            if bad.any():
                where = int(row[np.argwhere(bad)[0][0]])
                what = "a number beyond any measurement" if np.isfinite(value[bad]).all() else "NaN or infinity"
                raise LoadTestError(f"Row {where}, {key}: found {what}, expected numbers.", where=f"row {where}")
            object.__setattr__(self, key, frozen(value))
        object.__setattr__(self, "row", frozen(row, np.int64))
        _refuse_empty(wrench, displacement, row)

    def columns(self) -> Columns:
        """One row a test, as a file of load tests has it: poses, forces, readings, and whatever else is stated."""
        F, M = self.wrench[:, :3], self.wrench[:, 3:]
        if self.aimed.all():
            found = self._poses() | {"load_N": np.linalg.norm(F, axis=1)} | _vector("pulley_", self.pulley, "mm")
        else:
            found = self._poses() | _vector("F", F, "N")
        if M.any():
            found |= _vector("M", M, "N m")
        found |= self._readings()
        if np.isfinite(self.displacement[:, 3:]).any():
            found |= _vector("r", self.displacement[:, 3:], "mrad")
        for name, points in (("FP", self.force_point), ("MP", self.measuring_point)):
            if points.any():
                found |= _vector(name, points, "mm")
        return found | self._noise("um")

    def _poses(self) -> Columns:
        if self.theta is not None:
            slides = self.sliding or ()
            coordinates = ((i, "mm" if i in slides else "deg", q) for i, q in enumerate(self.theta.T, 1))
            return {f"theta{i}_{unit}": from_si(q, unit) for i, unit, q in coordinates}
        assert self.x_M is not None
        units = ("mm",) * 3 + ("deg",) * 3
        return {f"{name}_{unit}": from_si(q, unit) for name, unit, q in zip("XYZABC", units, self.x_M.T, strict=False)}

    def _readings(self) -> Columns:
        if self.gauges is None:
            return _vector("d", self.displacement[:, :3], "mm")
        found: Columns = {}
        for k in np.flatnonzero(np.isfinite(self.displacement[:, :3]).any(axis=0)):
            found |= {f"gauge{k + 1}_{axis}": self.gauges[:, k, i] for i, axis in enumerate("xyz")}
            found[f"reading{k + 1}_mm"] = from_si(self.displacement[:, k], "mm")
        return found

    def _about(self) -> dict[str, str]:
        six = self.x_M is not None and self.x_M.shape[1] == 6
        return super()._about() | ({"frame": "tool", "angles": "robomill"} if six else {})

    def _said(self) -> str:
        force, moved = (np.linalg.norm(np.nan_to_num(v[:, :3]), axis=1).max() for v in (self.wrench, self.displacement))
        poses = format_count(int(self.pose_index().max()) + 1, "pose")
        return (
            f"{format_count(len(self), 'test')} at {poses}, up to {format_si(force, 'N', 0)} and "
            f"{format_si(moved, 'mm')}, {self.provenance.kind}"
        )

    @asked
    def joined(self, other: LoadTests) -> LoadTests:
        """These tests, then ``other``'s, given the same way (poses, gauges). Rows are renumbered."""
        mine, others = self._arrays(), other._arrays()
        if mine.keys() != others.keys():
            raise LoadTestError("Load tests: joints and world poses cannot be joined; call with_joints(robot) first.")
        both: dict[str, Any] = {name: np.concatenate([value, others[name]]) for name, value in mine.items()}
        return self._with({**both, "row": None, "findings": self.findings + other.findings})

    @asked
    def with_joints(self, robot: Robot) -> LoadTests:
        """The same tests with ``theta`` known and checked against the robot's limits, and cables aimed.

        Raises LoadTestError naming the row whose pose cannot be reached or lies outside the limits.
        """
        tests = self
        if self.theta is not None:
            checked(robot, self.theta, self.row, self.sliding)
            sliding = sliding_joints(robot)
            tests = self if sliding == (self.sliding or ()) else replace(self, sliding=sliding)
        elif self.x_M is not None:
            theta, said = solved(robot, self.x_M, self.row)
            tests = replace(self, theta=theta, x_M=None, sliding=sliding_joints(robot), findings=(*self.findings, said))
        return tests.moved(robot, np.zeros(3)) if tests.aimed.any() else tests

    @cached_property
    def aimed(self) -> BoolArray:
        """(m,) rows whose force points from the force point to a pulley, by calculation."""
        return np.asarray(np.isfinite(self.pulley).all(axis=1))

    @asked
    def moved(self, robot: Robot, shift: FloatArray) -> LoadTests:
        """The same with the force point moved by ``shift`` (3,) m in {T}, and cables aimed from there."""
        point, aimed, wrench = self.force_point + shift, self.aimed, np.array(self.wrench)
        way = ways(self.tool_poses(robot), point, self.pulley)[aimed]
        size = np.linalg.norm(wrench[aimed, :3], axis=1) / np.linalg.norm(way, axis=1)
        wrench[aimed, :3] = way * size[:, None]
        return replace(self, wrench=wrench, force_point=point)

    @cached_property
    def vectors(self) -> FloatArray:
        """(m, 3) m, the displacement of the measuring point in {M}; NaN where gauges do not give (all of) it."""
        read = self.displacement[:, :3]
        if self.gauges is None:
            return read
        whole = np.isfinite(read).all(axis=1) & (np.abs(np.linalg.det(self.gauges)) > 1e-3)
        found = np.full(read.shape, np.nan)
        found[whole] = np.linalg.solve(self.gauges[whole], read[whole, :, None])[..., 0]
        return found

    @property
    def components(self) -> tuple[str, ...]:
        """What the three readings of a test are called."""
        return ("x", "y", "z") if self.gauges is None else ("gauge 1", "gauge 2", "gauge 3")

    @cached_property
    def directions(self) -> FloatArray:
        """(m, 3, 3) unit vectors in {M} along which displacement[:, :3] is read."""
        return np.broadcast_to(np.eye(3), (len(self), 3, 3)) if self.gauges is None else self.gauges

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


@asking
@dataclass(frozen=True, eq=False, repr=False)
class JointTests(_Rows):
    """One joint loaded at a time, the joints below it blocked: the paper's Table 2.

    joint (m,) int from 1; torque (m,) N m about the joint's axis; angle (m,) rad by which it turned
    (N and m for a prismatic joint); noise (m,) rad, NaN: not stated; row (m,) of the file.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.JointTests(joint=[1, 2], torque=[300.0, 300.0], angle=[2.1e-4, 3.0e-4])
    <JointTests 2 tests of single joints (1, 2), measured>
    """

    single: ClassVar[Literal[True]] = True
    components: ClassVar[tuple[str, ...]] = ("",)

    joint: IntArray
    torque: FloatArray
    angle: FloatArray
    noise: FloatArray = made_array()
    row: IntArray = made_array()
    findings: tuple[Finding, ...] = ()
    provenance: Provenance = MEASURED
    protocol: str = "one joint at a time"

    def __post_init__(self) -> None:
        m = len(self.joint)
        if m == 0:
            raise LoadTestError("Joint tests: no test in it; give at least one torque and angle.")
        row = np.arange(1, m + 1) if self.row is None else np.asarray(self.row)
        torque, angle = floats(self.torque, "torque"), floats(self.angle, "angle")
        for name, value in (("torque", torque), ("angle", angle)):
            if value.shape != (m,) or not np.isfinite(value).all():
                raise LoadTestError(f"{name}: expected {m} finite numbers, found shape {value.shape} or NaN.")
        if (torque == 0).any():
            where = int(row[np.argmax(torque == 0)])
            raise LoadTestError(f"Row {where}: the torque is zero, so nothing can be learned; delete the row.")
        noise = given_or(self.noise, (m,), "noise", np.nan)
        for name, value in (("torque", torque), ("angle", angle), ("noise", noise)):
            object.__setattr__(self, name, frozen(value))
        object.__setattr__(self, "joint", frozen(self.joint, np.int64))
        object.__setattr__(self, "row", frozen(row, np.int64))

    def columns(self) -> Columns:
        """One row a test, as a file has it; of a joint that slides these are N and mm."""
        found: Columns = {"joint": self.joint, "torque_Nm": self.torque, "angle_mrad": from_si(self.angle, "mrad")}
        return found | self._noise("mrad")

    def _said(self) -> str:
        joints = ", ".join(str(joint) for joint in np.unique(self.joint))
        return f"{format_count(len(self), 'test')} of single joints ({joints}), {self.provenance.kind}"


def _vector(name: str, values: FloatArray, unit: str) -> Columns:
    """A column for each component of values (m, 3): ``F`` in N gives Fx_N, Fy_N, Fz_N."""
    return {f"{name}{axis}_{unit.replace(' ', '')}": from_si(values[:, i], unit) for i, axis in enumerate("xyz")}


def _refuse_empty(wrench: FloatArray, displacement: FloatArray, row: IntArray) -> None:
    for empty, why in (
        (
            ~wrench.any(axis=1),
            "the force is zero, so nothing can be learned from it; enter the force or delete the row",
        ),
        (np.isnan(displacement).all(axis=1), "no displacement was measured; enter it or delete the row"),
    ):
        if empty.any():
            where = f"row {int(row[np.argmax(empty)])}"
            raise LoadTestError(f"{where.capitalize()}: {why}.", where=where)
