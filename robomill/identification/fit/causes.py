"""What may be missing from a model: single causes, each asked whether the readings call for it more than chance does.

Links that bend at a joint, a spring of the tool, another load or gauge point, a joint's zero. Each adds columns to the
equations, linear about the fit; an F-test says whether what is left over falls by more than noise would let it, and
poses left out say by how much it helps. Where two causes help alike, these tests cannot tell them apart.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.compliance.components import COLUMN, ROW
from robomill.identification.diagnostics import MANY
from robomill.identification.fit.balance import balanced
from robomill.identification.fit.confidence import half_width
from robomill.identification.fit.crossvalidation import good, headline, relative_by_pose
from robomill.identification.fit.fitting import Fitted
from robomill.identification.fit.folds import folds_of
from robomill.identification.fit.least_squares import bounded_solution, column_scale, solve_triangle, triangle
from robomill.identification.fit.models import Model
from robomill.identification.fit.selection import EXACT
from robomill.identification.fit.suspects import OF_GAUGES, Cause, Inquest, Suspect
from robomill.identification.fit.system import System, build_system, measured_terms
from robomill.identification.fit.treatment import Treatment
from robomill.identification.load_test import LoadTests
from robomill.identification.pull.points import FREED, Point, slopes
from robomill.identification.result import IdentificationResult
from robomill.lazy import cached_property
from robomill.progress import checkpoint
from robomill.robot.model import Robot

MOST = 600  # tests that are looked at; more are thinned evenly
CHANCE = 1e-4  # with which noise alone would call for one cause
STEP = 1e-5  # rad (m), by which a zero is moved for its slope
ROUNDS = 4  # in which a zero or a point is sought
FARTHEST = {"zero": 0.2, "points": 2.0}  # rad and m: what is further off is no zero and no point of a tool
RANK = 1e-9
FEWEST = 10  # readings to spare from which noise is known well enough to test against
SYMMETRIC = np.zeros((9, 6))  # a matrix by its rows from C_xx, C_yy, C_zz, C_xy, C_xz, C_yz
for _k, (_i, _j) in enumerate(zip(ROW, COLUMN, strict=True)):
    SYMMETRIC[[3 * _i + _j, 3 * _j + _i], _k] = 1.0


@dataclass(frozen=True, eq=False)
class _Columns:
    """Weighted columns (e, q + k) of what is fitted already and of the cause (the last k), which may be negative."""

    whole: FloatArray
    signed: BoolArray
    k: int


@dataclass(frozen=True, eq=False)
class Inquiry:
    """The fit that is asked about: the tests with points where they were found, the model, the points that are free.

    system: the readings with their noise; fold (e,) what is left out together.
    """

    robot: Robot
    tests: LoadTests
    choice: Model
    freed: tuple[Point, ...]
    system: System
    fold: IntArray

    @classmethod
    def of(
        cls, robot: Robot, tests: LoadTests, result: IdentificationResult, treatment: Treatment, fitted: Fitted
    ) -> Inquiry:
        """About a fit of ``tests``; rows that robust weights have switched off, and a few outliers, are not asked."""
        choice = result.choice
        index = np.arange(len(tests))[:: -(-len(tests) // MOST)]
        freed, shift = treatment.freed, fitted.found.shift
        kept = np.bincount(fitted.system.test, good(fitted.system, fitted.weights), minlength=len(tests)) > 0
        odd = [each.row for each in result.outliers]
        if len(odd) <= MANY * len(tests):
            kept &= ~np.isin(tests.row, odd)
        table = np.concatenate([tests.tool_poses(robot).reshape(len(tests), -1), tests.wrench, tests.displacement], 1)
        first = np.unique(np.nan_to_num(table), axis=0, return_index=True)[1]
        kept &= np.isin(np.arange(len(tests)), first)  # a copy is no second reading
        index = index[kept[index]]
        tests = tests.select(index)
        for k, point in enumerate(freed):
            tests = _with_point(robot, tests, point, shift[3 * k : 3 * k + 3])
        system = balanced(build_system(robot, tests, choice, freed, treatment.weights == "size"))
        fold = folds_of(treatment.leave_out, tests.pose_index(), tests.theta)
        return cls(robot, tests, choice, freed, system, fold[system.test])

    @cached_property
    def terms(self) -> FloatArray:
        """(e, k, p) terms of the readings at the fit."""
        return measured_terms(self.robot, self.tests, self.choice, self.freed)[0]

    def inquest(self) -> Inquest:
        """Every cause asked, and the readings themselves."""
        about = self._about(self.tests)
        found = [each for cause in self._causes() if (each := self._asked(cause)) is not None]
        before = self._error(about)
        helping = tuple(sorted((each for each in found if each.error < before), key=lambda each: each.error))
        return Inquest(before, helping, self._lack(about), self._growth(about))

    def _causes(self) -> Iterator[Cause]:
        bent = self.choice.bending_joints if self.choice.has("bending") else ()
        for j in self.robot.joint_numbers:
            yield Cause("zero", j)
            if j not in bent:
                yield Cause("bending", j)
                if j != self.robot.joint_numbers[-1]:  # behind it there is no frame for a turned axis
                    yield Cause("bending", j, turned=True)
        if not self.choice.has("tool"):
            yield Cause("tool")
        yield from (Cause(kind) for kind in OF_GAUGES)
        for name, points in FREED.items():
            if points and not set(points) & set(self.freed):
                yield Cause("points", points=name)

    def _asked(self, cause: Cause) -> Suspect | None:
        """The cause with what speaks for it; None where noise would do as well."""
        columns = self._about(self.tests, cause)
        chance = self._chance(columns)
        if not chance < CHANCE:
            return None
        shift, farthest = np.zeros(columns.k), FARTHEST.get(cause.kind)
        if farthest is not None:
            for _ in range(ROUNDS):
                shift = shift + self._free(columns)[-columns.k :]
                if not np.abs(shift).max() < farthest:
                    return None
                columns = self._about(_moved(self.robot, self.tests, cause, shift), cause)
        zero = cause.kind == "zero"
        off, half = (float(shift[0]), self._half(columns)) if zero else (float("nan"), float("nan"))
        return Suspect(cause, columns.k, chance, self._error(columns), off, half)

    def _about(self, tests: LoadTests, cause: Cause | None = None) -> _Columns:
        """The equations with the cause's columns, linear about what fits ``tests`` best."""
        terms = self.terms if tests is self.tests else measured_terms(self.robot, tests, self.choice, self.freed)[0]
        w, signed = 1.0 / self.system.noise, self.system.signed
        x = bounded_solution(terms[:, 0] * w[:, None], self.system.b * w, signed)
        still = np.zeros(3 * len(self.freed))
        told = np.isfinite(column_scale(terms[:, 0]))  # a joint on whose axis the tip lies has a column of rounding
        base = np.concatenate([terms[:, 0] * told, slopes(terms, x, still, self.freed)], axis=1)
        extra = base[:, :0] if cause is None else self._extra(tests, cause, x)
        free = np.ones(len(still), dtype=bool)
        spring = cause is not None and cause.kind in ("bending", "tool")
        every = np.concatenate([signed, free, np.full(extra.shape[1], not spring)])
        return _Columns(np.concatenate([base, extra], axis=1) * w[:, None], every, extra.shape[1])

    def _extra(self, tests: LoadTests, cause: Cause, x: FloatArray) -> FloatArray:
        """(e, k) change of the readings with the cause: with each compliance, coordinate or angle of it."""
        if cause.kind == "points":
            freed = FREED[cause.points]
            return slopes(measured_terms(self.robot, tests, self.choice, freed)[0], x, np.zeros(3 * len(freed)), freed)
        if cause.kind == "zero":
            there, back = (
                measured_terms(self.robot, _moved(self.robot, tests, cause, np.array([s])), self.choice)[0][:, 0] @ x
                for s in (STEP, -STEP)
            )
            return np.asarray((there - back) / (2.0 * STEP))[:, None]
        if cause.kind in OF_GAUGES:
            return self._of_gauges(cause, x)
        springs = Model("joints+bending", (cause.at,), cause.turned) if cause.at else Model("joints+tool")
        return measured_terms(self.robot, tests, springs)[0][:, 0, self.robot.n :]

    def _of_gauges(self, cause: Cause, x: FloatArray) -> FloatArray:
        """(e, 3) what a gauge that is not zeroed, drifts or sticks adds to each component of the displacement."""
        each = (self.system.component[:, None] == np.arange(3)).astype(np.float64)
        if cause.kind == "drift":
            row = self.tests.row - self.tests.row.min()  # of a table's index, which may begin anywhere
            each *= (row / max(float(row.max()), 1.0))[self.system.test][:, None]
            each = np.concatenate([each, (self.system.component[:, None] == np.arange(3))], axis=1)
        elif cause.kind == "play":
            each *= np.sign(self.terms[:, 0] @ x)[:, None]
        return each

    def _chance(self, columns: _Columns) -> float:
        """By an F-test: the chance with which noise alone lets what is left over fall as far as the cause does."""
        from scipy.special import fdtrc

        R, b = self._triangle(columns), self.system.b / self.system.noise
        left, ranks = [], []
        for width in (columns.whole.shape[1] - columns.k, columns.whole.shape[1]):
            z, _, rank, _ = np.linalg.lstsq(R[:, :width], R[:, -1], rcond=RANK)
            left.append(float(np.sum((R[:, :width] @ z - R[:, -1]) ** 2)))
            ranks.append(int(rank))
        more, dof = ranks[1] - ranks[0], len(b) - ranks[1]
        if more <= 0 or dof <= 0 or left[0] <= EXACT**2 * float(b @ b):
            return 1.0
        return float(fdtrc(more, dof, (left[0] - left[1]) / more / max(left[1] / dof, 1e-300)))

    def _left(self, columns: _Columns) -> tuple[FloatArray, int]:
        """Weighted residuals (e,) of the unbounded fit, and how many are to spare."""
        b = self.system.b / self.system.noise
        spare = len(b) - int(np.linalg.matrix_rank(self._triangle(columns)[:, :-1], RANK))
        return columns.whole @ self._free(columns) - b, spare

    def _lack(self, columns: _Columns) -> float:
        """By an F-test against one compliance matrix a pose, which holds whatever the arm is made of."""
        from scipy.special import fdtrc

        left, spare = self._left(columns)
        same = np.array_equal(self.tests.force_point, self.tests.measuring_point)  # then the matrix is symmetric
        pure, free = 0.0, 0
        F = self.tests.wrench[self.system.test, :3]
        along = self.tests.directions[self.system.test, np.minimum(self.system.component, 2)]
        D = (along[:, :, None] * F[:, None, :]).reshape(-1, 9)
        D = D @ SYMMETRIC if same else D
        for pose in np.unique(self.system.pose):
            here = (self.system.pose == pose) & self.system.linear
            w = 1.0 / self.system.noise[here]
            A, b = D[here] * w[:, None], self.system.b[here] * w
            z, _, rank, _ = np.linalg.lstsq(A, b, rcond=RANK)
            pure, free = pure + float(np.sum((A @ z - b) ** 2)), free + int(here.sum()) - int(rank)
        linear = left[self.system.linear]
        spare -= int((~self.system.linear).sum())
        rounded = float(linear @ linear) <= EXACT**2 * float(np.sum((self.system.b / self.system.noise) ** 2))
        if rounded or free < FEWEST or spare <= free or pure <= 0.0 or self.tests.wrench[:, 3:].any():
            return float("nan")
        return float(fdtrc(spare - free, free, (linear @ linear - pure) / (spare - free) / (pure / free)))

    def _growth(self, columns: _Columns) -> float:
        """By the rank correlation of what is left over with the size of the test's displacement."""
        from scipy.special import stdtr

        left, spare = self._left(columns)
        moved = columns.whole @ self._free(columns) * self.system.noise
        size = np.sqrt(np.bincount(self.system.test, np.where(self.system.linear, moved, 0.0) ** 2))[self.system.test]
        if spare < FEWEST or float(left @ left) <= EXACT**2 * float(np.sum((moved / self.system.noise) ** 2)):
            return float("nan")
        if np.ptp(size) == 0.0:
            return float("nan")
        r = float(np.corrcoef(_ranks(np.abs(left)), _ranks(size))[0, 1])
        return float(stdtr(spare - 2, -r * np.sqrt((spare - 2) / max(1.0 - r * r, 1e-12))))

    def _triangle(self, columns: _Columns) -> FloatArray:
        size = np.linalg.norm(columns.whole, axis=0)
        return triangle(columns.whole / np.where(size > 0, size, 1.0), self.system.b / self.system.noise)

    def _free(self, columns: _Columns) -> FloatArray:
        """The unbounded fit."""
        size = np.linalg.norm(columns.whole, axis=0)
        R = self._triangle(columns)
        return np.asarray(np.linalg.lstsq(R[:, :-1], R[:, -1], rcond=RANK)[0]) / np.where(size > 0, size, 1.0)

    def _half(self, columns: _Columns) -> float:
        """Half the 95 % interval of the last coordinate."""
        b = self.system.b / self.system.noise
        fit = solve_triangle(triangle(columns.whole, b), len(b), np.ones_like(columns.signed))
        return float(half_width(fit.stderr[-1], fit.dof))

    def _error(self, columns: _Columns) -> float:
        """Mean relative error on poses left out."""
        b = self.system.b / self.system.noise
        missed = np.full(len(b), np.nan)
        for k in range(int(self.fold.max()) + 1):
            checkpoint()
            out = self.fold == k
            R = triangle(columns.whole[~out], b[~out])
            missed[out] = columns.whole[out] @ bounded_solution(R[:, :-1], R[:, -1], columns.signed) - b[out]
        return headline(relative_by_pose(self.system, missed * self.system.noise))


def _ranks(values: FloatArray) -> FloatArray:
    """(e,) ranks, those of equals shared."""
    _, back, count = np.unique(values, return_inverse=True, return_counts=True)
    return np.asarray((np.cumsum(count) - 0.5 * count)[back.ravel()])


def _moved(robot: Robot, tests: LoadTests, cause: Cause, shift: FloatArray) -> LoadTests:
    """The tests with the cause's points or zero moved by ``shift``."""
    if cause.kind == "points":
        for k, point in enumerate(FREED[cause.points]):
            tests = _with_point(robot, tests, point, shift[3 * k : 3 * k + 3])
        return tests
    assert tests.theta is not None
    turned = tests.theta + shift * (np.array(robot.joint_numbers) == cause.at)
    tests = replace(tests, theta=turned)
    return tests.moved(robot, np.zeros(3)) if tests.aimed.any() else tests


def _with_point(robot: Robot, tests: LoadTests, point: Point, shift: FloatArray) -> LoadTests:
    if point == "force":
        return tests.moved(robot, shift)
    return replace(tests, measuring_point=tests.measuring_point + shift)
