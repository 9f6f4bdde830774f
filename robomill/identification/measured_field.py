"""The paper's second method: compliance matrices measured on a grid, used as they are, eq. (17).

Between the measured points the entries are interpolated linearly (multilinearly on a grid, over a Delaunay mesh
otherwise), which keeps symmetric matrices symmetric and positive ones positive. Outside, or too far from any
measured point, the answer is NaN. The map holds for the tool orientation it was measured at; ``turned`` says how far
another one is from it. ``standard_error`` says how sure the entries are (``map_error``).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, IntArray, as_floats, frozen, made_array
from robomill.errors import LoadTestError
from robomill.frames import Columns
from robomill.identification.load_test import MEASURED, LoadTests
from robomill.identification.map_error import GRID, between_points, errors_of_tests, noise_by_asymmetry, shows_bend
from robomill.kinematics.transforms import axis_from_tilt, world_from_pose
from robomill.lazy import cached_property
from robomill.progress import checkpoint
from robomill.provenance import Finding, Provenance
from robomill.robot.model import Robot
from robomill.units import format_count, format_percent, format_si, from_si
from robomill.values import Tabled
from robomill.vectors import angle_between

ASYMMETRY = 0.15  # |C - C^T| / |C| from which a point is named


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredField(Tabled):
    """Compliance matrices C (k, 3, 3) m/N measured with the tip at p (k, 3) m in {M}, tool orientation AB (k, 2) rad.

    reach (m): points further than this from every measured one are masked; chosen from the spacing unless given.
    stderr (k, 3, 3) m/N: standard error of each entry; judged by the matrices' asymmetry unless given.
    """

    p: FloatArray
    C: FloatArray
    AB: FloatArray = made_array()
    reach: float = 0.0
    provenance: Provenance = MEASURED
    stderr: FloatArray = made_array()

    def __post_init__(self) -> None:
        p = as_floats(self.p, "measured points", (None, 3), error=LoadTestError)
        C = as_floats(self.C, "measured compliances", (len(p), 3, 3), error=LoadTestError)
        if len(p) == 0:
            raise LoadTestError("Measured map: no point in it.")
        rounded = np.round(p / GRID)
        if len(np.unique(rounded, axis=0)) < len(p):
            raise LoadTestError("Measured map: a point is there twice; average its measurements or delete one.")
        object.__setattr__(self, "p", frozen(p))
        object.__setattr__(self, "C", frozen(C))
        object.__setattr__(self, "AB", frozen(np.zeros((len(p), 2)) if self.AB is None else self.AB))
        noise = np.full(C.shape, noise_by_asymmetry(C)) if self.stderr is None else self.stderr
        stderr = as_floats(noise, "standard errors", C.shape, error=LoadTestError, finite=False)
        object.__setattr__(self, "stderr", frozen(stderr))
        if self.reach <= 0.0:
            object.__setattr__(self, "reach", self._spacing())

    @classmethod
    def from_tests(cls, robot: Robot, tests: LoadTests, reach: float = 0.0) -> MeasuredField:
        """One matrix a pose, from three or more independent force directions; several loads are averaged.

        Raises LoadTestError naming the row of a pose loaded in fewer than three directions.
        """
        tests = tests.with_joints(robot) if tests.aimed.any() else tests
        pose = tests.pose_index()
        x_M = tests.x_M[:, :5] if tests.x_M is not None else world_from_pose(tests.tool_poses(robot))
        count = int(pose.max()) + 1
        C, where, spread = np.empty((count, 3, 3)), np.empty((count, 5)), np.empty((count, 3))
        by_size = np.empty((count, 3, 3))
        for k in range(count):
            checkpoint(k / count, "Poses of the map")
            here = np.flatnonzero(pose == k)
            F, moved = tests.wrench[here, :3], tests.vectors[here]
            if np.linalg.matrix_rank(F, tol=1e-6 * np.abs(F).max()) < 3 or not np.isfinite(moved).all():
                raise LoadTestError(
                    f"Row {tests.row[here[0]]}: this pose is not fully measured; a map needs dx, dy, dz under forces "
                    "in three independent directions at every point."
                )
            C[k] = np.linalg.lstsq(F, moved, rcond=None)[0].T
            size = np.abs(F).max()
            spread[k] = np.sqrt(np.diag(np.linalg.inv((F / size).T @ (F / size)))) / size
            by_size[k] = np.sqrt((moved.T / size) ** 2 @ np.linalg.pinv(F / size).T ** 2)
            where[k] = x_M[here[0]]
        stderr = errors_of_tests(C, spread, by_size, tests.noise)
        return cls(where[:, :3], C, where[:, 3:], reach, tests.provenance, stderr)

    def columns(self) -> Columns:
        """One row a measured point, as a file of measured compliances has it."""
        found: Columns = {f"{name}_mm": from_si(self.p[:, i], "mm") for i, name in enumerate("XYZ")}
        found |= {f"{name}_deg": from_si(self.AB[:, i], "deg") for i, name in enumerate("AB")}
        entries = ((f"C{a}{b}_um_N", self.C[:, i, j]) for i, a in enumerate("xyz") for j, b in enumerate("xyz"))
        return found | {name: from_si(values, "um/N") for name, values in entries}

    def _said(self) -> str:
        return f"{format_count(len(self.p), 'measured point')}, {self.provenance.kind}"

    # ---- between the points ----------------------------------------------------------------------------------------
    def compliance(self, p: ArrayLike) -> FloatArray:
        """C (..., 3, 3) m/N with the tip at p (..., 3) m in {M}; NaN outside the measured region."""
        p = as_floats(p, "points", (3,), error=LoadTestError, finite=False)
        return self._within_reach(p, self.C)

    def _within_reach(self, p: FloatArray, values: FloatArray) -> FloatArray:
        """Values (k, 3, 3) of the measured points at p (..., 3); NaN outside the measured region."""
        flat = p.reshape(-1, 3)
        found = self._interpolate(flat, values)
        found[self.distance(flat) > self.reach] = np.nan
        return found.reshape(*p.shape[:-1], 3, 3)

    def standard_error(self, p: ArrayLike) -> FloatArray:
        """(..., 3, 3) m/N standard error of each entry of ``compliance(p)``; NaN where that is NaN or it is not known.

        The measured points' own, as if neighbours erred alike (a gauge that stands askew does not average out), and
        what a straight line between points may miss in the middle of a cell, as bent as the map is. So where neighbours
        err by chance, 95 % bands hold more than 95 % between the points.
        """
        p = as_floats(p, "points", (3,), error=LoadTestError, finite=False)
        return np.sqrt(self._within_reach(p, self.stderr**2) + self._bent**2)

    def covariance(self, p: ArrayLike, F: ArrayLike) -> FloatArray:
        """(..., 3, 3) m^2: covariance of C F at p, eq. (15), the entries' errors taken as independent."""
        variance = np.einsum("...ij,...j->...i", self.standard_error(p) ** 2, np.asarray(F, dtype=np.float64) ** 2)
        return variance[..., None] * np.eye(3)

    def turned(self, p: ArrayLike, k: ArrayLike) -> FloatArray:
        """(...) rad between unit tool axes k (..., 3) at p (..., 3) m in {M} and that of the nearest measured point."""
        measured = axis_from_tilt(*self.AB.T)[self._nearest(p)[1]]
        return angle_between(measured, k)

    def distance(self, p: ArrayLike) -> FloatArray:
        """(...) m to the nearest measured point."""
        return self._nearest(p)[0]

    def beside(self, p: ArrayLike) -> FloatArray:
        """(...) m from the plane (line, point) along the axes that all measured points lie in; 0 where they fill a
        space. The map says nothing of what changes across it."""
        p = as_floats(p, "points", (3,), error=LoadTestError, finite=False)
        across = np.setdiff1d(np.arange(3), self._used)
        return np.linalg.norm(p[..., across] - self.p[0, across], axis=-1)

    def _nearest(self, p: ArrayLike) -> tuple[FloatArray, IntArray]:
        p = as_floats(p, "points", (3,), error=LoadTestError, finite=False)
        far, index = self._tree.query(np.where(np.isfinite(p), p, 1e6))
        return np.asarray(far, dtype=np.float64), np.asarray(index, dtype=np.int64)

    @cached_property
    def _bent(self) -> FloatArray:
        return between_points(self.p[:, self._used], self.C, self.stderr)

    @cached_property
    def _used(self) -> IntArray:
        """The axes along which the points vary."""
        return np.flatnonzero(np.ptp(self.p, axis=0) > GRID)

    def symmetric(self) -> MeasuredField:
        """The same map with (C + C^T) / 2: an elastic arm is symmetric, the rest is error of measurement."""
        return replace(self, C=0.5 * (self.C + np.swapaxes(self.C, -1, -2)))

    # ---- checks ----------------------------------------------------------------------------------------------------
    @cached_property
    def asymmetry(self) -> FloatArray:
        """(k,) |C - C^T| / |C| (Frobenius): zero for an elastic arm measured without error."""
        size = np.linalg.norm(self.C, axis=(1, 2))
        return np.linalg.norm(self.C - np.swapaxes(self.C, 1, 2), axis=(1, 2)) / np.where(size > 0, size, 1.0)

    @cached_property
    def smallest(self) -> FloatArray:
        """(k,) m/N, smallest eigenvalue of the symmetric part: negative where the tip would move against a force."""
        return np.asarray(np.linalg.eigvalsh(0.5 * (self.C + np.swapaxes(self.C, 1, 2)))[:, 0], dtype=np.float64)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What the checks say: points that are not symmetric, not positive, or measured at several orientations."""
        found = []
        crooked, negative = self.asymmetry > ASYMMETRY, self.smallest <= 0.0
        if crooked.any():
            k = int(np.argmax(self.asymmetry))
            worst = f"{format_percent(self.asymmetry[k])} at {_point(self.p[k])}"
            text = (
                f"{int(crooked.sum())} of {len(self.p)} matrices are not symmetric (worst {worst}): an elastic arm's "
                "is, so look for a wrong sign, gauge or axis there."
            )
            found.append(Finding("suspicious", text, count=int(crooked.sum()), code="not-symmetric"))
        if negative.any():
            k = int(np.argmin(self.smallest))
            text = (
                f"{int(negative.sum())} of {len(self.p)} matrices are not positive definite (first to mend: "
                f"{_point(self.p[k])}): there a force would move the tip against itself."
            )
            found.append(Finding("suspicious", text, count=int(negative.sum()), code="not-positive"))
        if len(self._used) and not shows_bend(self.p[:, self._used]):
            text = (
                "No measured point lies between two others along each axis, so how far a straight line between points "
                "misses is not known: 95 % intervals leave it out; measure points in the middle."
            )
            found.append(Finding("warning", text, code="bend-not-seen"))
        if float(np.ptp(self.AB, axis=0).max()) > 1e-6:
            text = (
                "The points were measured at different tool orientations; the map does not interpolate between those."
            )
            found.append(Finding("warning", text, code="orientations"))
        return tuple(found)

    # ---- inside ----------------------------------------------------------------------------------------------------
    @cached_property
    def lines(self) -> tuple[FloatArray, FloatArray, FloatArray] | None:
        """The grid's x, y and z coordinates where the points fill a grid, else None."""
        axes = tuple(np.unique(np.round(self.p[:, i] / GRID)) * GRID for i in range(3))
        axes = tuple(axis if np.ptp(axis) > GRID else axis[:1] for axis in axes)
        return axes if len(axes[0]) * len(axes[1]) * len(axes[2]) == len(self.p) else None  # type: ignore[return-value]

    @cached_property
    def _tree(self) -> Any:
        from scipy.spatial import cKDTree

        return cKDTree(self.p)

    def _spacing(self) -> float:
        """Half the diagonal of the coarsest cell, a little more for rounding: no point of a grid is further off."""
        if len(self.p) == 1:
            return 0.05
        if self.lines is not None:
            gaps = [float(np.diff(line).max()) if len(line) > 1 else 0.1 for line in self.lines]
            return 0.505 * float(np.linalg.norm(gaps))
        return 1.5 * float(self._tree.query(self.p, k=2)[0][:, 1].max())

    def _interpolate(self, p: FloatArray, known: FloatArray) -> FloatArray:
        """(m, 3, 3) from the measured points' ``known`` (k, 3, 3) over the axes that vary; NaN outside them."""
        from scipy.interpolate import LinearNDInterpolator, RegularGridInterpolator

        used = self._used
        if len(used) == 0:
            return np.repeat(known, len(p), axis=0)
        if self.lines is not None:
            axes = [self.lines[i] for i in used]
            order = np.lexsort(np.round(self.p[:, used] / GRID).T[::-1])
            values = known[order].reshape(*(len(axis) for axis in axes), 3, 3)
            ends = np.array([[axis[0], axis[-1]] for axis in axes])
            at = p[:, used]
            near = np.clip(at, ends[:, 0], ends[:, 1])
            at = np.where(np.abs(at - near) <= GRID, near, at)
            call = RegularGridInterpolator(axes, values, bounds_error=False, fill_value=np.nan)
            return np.asarray(call(at), dtype=np.float64)
        try:
            mesh = LinearNDInterpolator(self.p[:, used], known.reshape(-1, 9))
        except Exception as exc:  # Qhull's own error type has no sentence a person could use
            raise LoadTestError("Measured map: the points lie on one line; measure off it too.") from exc
        return np.asarray(mesh(p[:, used])).reshape(-1, 3, 3)


def _point(p: FloatArray) -> str:
    return "(" + ", ".join(format_si(float(v), "mm", 0) for v in p) + ")"
