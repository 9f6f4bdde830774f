"""Lines of pull: what the forces alone say of the load point, before any stiffness.

A cable runs from the load point to a pulley that stands still in {M}, so the line of every force, through its load
point, meets that pulley. With the load point fixed in the tool at p_k + R_k s, unit forces u_k and pulleys q_g the gaps

    (I - u_k u_k^T) (q_g - p_k - R_k s)

are linear in the shift s and the pulleys: one least-squares problem, robust to rows that cannot be. Lines that are
parallel (dead weights, pushes along axes) meet nowhere and say nothing.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray, frozen
from robomill.identification.fit.confidence import BISQUARE, bisquare
from robomill.identification.load_test import LoadTests
from robomill.robot.model import Robot

Says = Literal["met", "apart", "parallel", "too-few", "held-loosely", "aimed"]
FEWEST = 8  # rows, at four poses: less leaves nothing to check
SHARING = 4  # rows that a pulley must have
POSES = 4
PARALLEL = 0.005  # rad: directions nearer than this are one
MOST_PULLEYS = 3
ROUNDS = 60
TRIALS = 400  # draws of rows from which the first guess is made
MOST = 2000  # rows that are looked at; more are thinned evenly
MEDIAN = 1.1774100225154747  # median length of two standard normals
HELD = 1e-10  # squared metre of gap a metre moved, a row: a direction that costs less is not held
FLOOR = 1e-3  # m: a gap below this is none
ALARM = 0.01  # chance that any row of good data is called suspect
LOOSE = 0.5  # m, half interval of the load point, or share of the way to the pulley, from which it counts as not held
APART = 0.05  # typical gap over the way to the pulley from which the lines do not meet at all
NEAR = 0.03  # the same of one row from which it is not drawn to that pulley in the first guess


@dataclass(frozen=True, eq=False)
class LinesOfPull:
    """What the lines say. m rows, g pulleys, lengths m.

    says: "met"; "apart" (they meet nowhere); "parallel", "too-few", "held-loosely", "aimed" (at a stated pulley, by
    calculation): nothing can be said, and why.
    pulley (g, 3) in {M}; which (m,) pulley of each row; gap (m,) of each line from its pulley with the load point that
    makes them meet best, gap_stated (m,) with the stated one, both NaN where there is no pulley; shift (3,) of the load
    point in {T}, covariance (3, 3), None where these poses do not hold it (then the stated one is used);
    suspects: rows that cannot be; pushes: rows whose force points away from their pulley; dof of the gaps.
    """

    says: Says
    row: IntArray
    pulley: FloatArray
    which: IntArray
    gap: FloatArray
    gap_stated: FloatArray
    shift: FloatArray | None = None
    covariance: FloatArray | None = None
    suspects: tuple[int, ...] = ()
    pushes: tuple[int, ...] = ()
    dof: int = 0


class _Lines:
    """The rows' lines: unit forces u, points p (m, 3) in {M} for the stated load point, tool axes R (m, 3, 3)."""

    def __init__(self, robot: Robot, tests: LoadTests) -> None:
        T = tests.tool_poses(robot)
        F, M = tests.wrench[:, :3], tests.wrench[:, 3:]
        size = np.linalg.norm(F, axis=1)
        self.u = F / size[:, None]
        self.R = T[:, :3, :3]
        point = T[:, :3, 3] + np.einsum("mij,mj->mi", self.R, tests.force_point)
        self.p = point + np.cross(F, M) / (size**2)[:, None]  # the wrench's own line, where there is a moment too
        self.across = np.eye(3) - self.u[:, :, None] * self.u[:, None, :]

    def fit(self, which: IntArray, weight: FloatArray, free: bool) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Shift (3,), pulleys (g, 3) and the covariance of both per unit variance, for weights (m,) of the rows."""
        m, g = len(self.u), int(which.max()) + 1
        A = np.zeros((m, 3, 3 + 3 * g))
        if free:
            A[:, :, :3] = -self.across @ self.R
        for k in range(g):
            A[which == k, :, 3 + 3 * k : 6 + 3 * k] = self.across[which == k]
        b = np.einsum("mij,mj->mi", self.across, self.p)
        root = np.sqrt(weight)
        used = slice(0 if free else 3, None)
        N = (A * root[:, None, None]).reshape(3 * m, -1)[:, used]
        values, vectors = np.linalg.eigh(N.T @ N)
        kept = values > HELD * m
        inverse = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
        z = inverse @ (N.T @ (b * root[:, None]).ravel())
        covariance = np.full((3 + 3 * g, 3 + 3 * g), np.inf)
        if kept.all():
            covariance[used, used] = inverse
        whole = z if free else np.concatenate([np.zeros(3), z])
        return whole[:3], whole[3:].reshape(g, 3), covariance

    def gaps(self, shift: FloatArray, pulley: FloatArray) -> FloatArray:
        """(m, g) m from each line to each pulley."""
        to = pulley[None] - (self.p + np.einsum("mij,j->mi", self.R, shift))[:, None]
        return np.asarray(np.linalg.norm(np.einsum("mij,mgj->mgi", self.across, to), axis=-1))

    def ways(self, shift: FloatArray, pulley: FloatArray, which: IntArray) -> FloatArray:
        """(m,) m along the force from the load point to the pulley; negative where the force points away from it."""
        to = pulley[which] - self.p - np.einsum("mij,j->mi", self.R, shift)
        return np.asarray(np.einsum("mi,mi->m", self.u, to))

    def settled(self, which: IntArray, free: bool) -> tuple[FloatArray, IntArray, float]:
        """Gaps (m,), pulley of each row and typical size of a gap, after a robust fit in which rows choose pulleys."""
        m, g = len(self.u), int(which.max()) + 1
        spare = np.sqrt(2.0 * m / max(2 * m - 3 * g - 3 * free, 1))
        weight, gap, scale = np.ones(m), np.zeros(m), 0.0
        for k in range(ROUNDS):
            shift, pulley, _ = self.fit(which, weight, free)
            gaps = self.gaps(shift, pulley)
            chosen = gaps.argmin(axis=1)
            if np.bincount(chosen, minlength=g).min() >= SHARING:
                which = chosen
            gap = gaps[np.arange(m), which]
            scale = max(float(np.median(gap)) / MEDIAN * spare, 1e-9)
            old, u = weight, gap / scale
            first = 1.0 / np.maximum(u, 0.1)
            weight = first if k < ROUNDS // 2 else bisquare(u)
            if k > ROUNDS // 2 and float(np.abs(weight - old).max()) < 1e-6:
                break
        return gap, which, scale

    def guess(self, free: bool) -> IntArray:
        """(m,) pulley of each row, found pulley by pulley: draws of a few rows, the one that most others agree with."""
        m = len(self.u)
        rng = np.random.default_rng(0)
        which = np.full(m, -1)
        shift: FloatArray | None = None if free else np.zeros(3)
        for k in range(MOST_PULLEYS):
            left = np.flatnonzero(which < 0)
            if len(left) < SHARING:
                break
            near, found = self._drawn(left, shift, rng)
            if near.sum() < SHARING:
                break
            which[left[near]] = k
            shift = found if shift is None else shift
        which[which < 0] = 0
        return which

    def _drawn(
        self, left: IntArray, shift: FloatArray | None, rng: np.random.Generator
    ) -> tuple[BoolArray, FloatArray]:
        """Which of the rows ``left`` agree best on a pulley, and the shift with which they do (given or found)."""
        need = 4 if shift is None else 2
        draws = np.array([rng.choice(left, need, replace=False) for _ in range(TRIALS)])
        P, R, p = self.across, self.R, self.p
        b = np.einsum("tdij,tdj->tdi", P[draws], p[draws] if shift is None else p[draws] + R[draws] @ shift)
        A = np.concatenate([P[draws], -P[draws] @ R[draws]], axis=-1) if shift is None else P[draws]
        z = np.einsum("tij,tj->ti", np.linalg.pinv(A.reshape(TRIALS, 3 * need, -1), rcond=1e-8), b.reshape(TRIALS, -1))
        moved = z[:, 3:] if shift is None else np.broadcast_to(shift, (TRIALS, 3))
        to = z[:, None, :3] - p[left] - np.einsum("mij,tj->tmi", R[left], moved)
        gap = np.linalg.norm(np.einsum("mij,tmj->tmi", P[left], to), axis=-1)
        share = gap / np.maximum(np.linalg.norm(to, axis=-1), 0.1)
        best = int(np.argmin(np.minimum(share, NEAR).sum(axis=1)))
        return share[best] < NEAR, moved[best]


def lines_of_pull(robot: Robot, tests: LoadTests) -> LinesOfPull:
    """Where the force lines meet, and the load point with which they meet best. The tests' joints must be known."""
    tests = tests.select(~tests.aimed) if not tests.aimed.all() else tests
    tests = tests.thinned(MOST)
    m = len(tests)
    unknown = np.full(m, np.nan)
    nothing = LinesOfPull("parallel", tests.row, np.empty((0, 3)), np.full(m, -1), unknown, unknown)
    if tests.aimed.any():
        return replace(nothing, says="aimed")
    if m < FEWEST or int(tests.pose_index().max()) + 1 < POSES:
        return replace(nothing, says="too-few")
    lines = _Lines(robot, tests)
    if _parallel(lines.u):
        return nothing
    free = _held(lines, np.zeros(m, dtype=np.int64))
    which = _grouped(lines, free)
    if free and not _held(lines, which):
        free, which = False, _grouped(lines, False)
    gap, which, scale = lines.settled(which, free)
    shift, pulley, _ = lines.fit(which, (gap < BISQUARE * scale).astype(np.float64), free)
    far = np.abs(lines.ways(shift, pulley, which)) / np.linalg.norm(tests.wrench[:, :3], axis=1)
    return _judged(lines, nothing, which, free, _good(gap, scale, far))


def _good(gap: FloatArray, scale: float, far: FloatArray) -> BoolArray:
    """(m,) rows whose gap chance allows; that of a small force from ``far`` (m/N) may be larger than others'."""
    loose = np.maximum(1.0, far / float(np.median(far)))
    return gap <= np.maximum(scale * loose * np.sqrt(2.0 * np.log(len(gap) / ALARM)), FLOOR)


def _judged(lines: _Lines, nothing: LinesOfPull, which: IntArray, free: bool, good: BoolArray) -> LinesOfPull:
    """The least-squares fit of the good rows, and what it is worth."""
    every, weight = np.arange(len(which)), good.astype(np.float64)
    shift, pulley, unit = lines.fit(which, weight, free)
    gap = lines.gaps(shift, pulley)[every, which]
    way = lines.ways(shift, pulley, which)
    dof = 2 * int(good.sum()) - len(unit) + (0 if free else 3)
    variance = float((gap[good] ** 2).sum() / dof) if dof > 0 else np.inf
    apart = float(np.median(gap)) > APART * float(np.median(np.abs(way))) or (~good).mean() > 1 / 3
    if not apart and _loose(pulley, unit * variance, way, which):
        return replace(nothing, says="held-loosely")
    stated = lines.gaps(np.zeros(3), lines.fit(which, weight, False)[1])[every, which]
    held = free and not apart and bool(np.isfinite(unit[:3, :3]).all())
    return LinesOfPull(
        "apart" if apart else "met",
        nothing.row,
        frozen(pulley),
        frozen(which, np.int64),
        frozen(gap),
        frozen(stated),
        frozen(shift) if held else None,
        frozen(unit[:3, :3] * variance) if held else None,
        () if apart else tuple(int(r) for r in nothing.row[~good]),
        () if apart else tuple(int(r) for r in nothing.row[good & (way < 0)]),
        dof,
    )


def _parallel(u: FloatArray) -> bool:
    """Whether most rows share their direction (either way) with others at other places: nothing meets."""
    alike = np.abs(u @ u.T) > np.cos(PARALLEL)
    return bool((alike.sum(axis=1) >= 3).mean() > 0.7)


def _held(lines: _Lines, which: IntArray) -> bool:
    """Whether the postures differ enough to tell the load point from the pulley."""
    _, _, unit = lines.fit(which, np.ones(len(which)), True)
    return bool(np.isfinite(unit).all() and np.sqrt(np.diag(unit)[:3].max()) * FLOOR * 2.0 < LOOSE)


def _grouped(lines: _Lines, free: bool) -> IntArray:
    """(m,) pulley of each row: one if that will do for most, else as many as the first guess found."""
    one = np.zeros(len(lines.u), dtype=np.int64)
    guessed = lines.guess(free)
    if guessed.max() == 0:
        return one
    (gap, _, scale), (other, which, less) = lines.settled(one, free), lines.settled(guessed, free)
    strays = [int((g > BISQUARE * s).sum()) for g, s in ((gap, scale), (other, less))]
    better = less < scale / 3.0 or (strays[0] - strays[1] >= SHARING and less < 2.0 * scale)
    return which if better else one


def _loose(pulley: FloatArray, covariance: FloatArray, way: FloatArray, which: IntArray) -> bool:
    """Whether a pulley might as well stand at infinity: the lines are parallel within their gaps."""
    for k in range(len(pulley)):
        own = covariance[3 + 3 * k : 6 + 3 * k, 3 + 3 * k : 6 + 3 * k]
        if not np.isfinite(own).all():
            return True
        if 2.0 * np.sqrt(np.linalg.eigvalsh(own)[-1]) > LOOSE * float(np.median(np.abs(way[which == k]))):
            return True
    return False
