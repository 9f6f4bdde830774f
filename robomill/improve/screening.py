"""What a cut would be elsewhere, at a thousand places at once: the arm's half of a run, batched.

Where the part lies changes how the arm stands, and so its compliance; path, conditions and force in the cut's own axes
stay. So one run is made in full, and every reading of its gauge is moved as the tip moves beside it: exact for the tip,
of first order for what a gauge reads. What is called best is simulated in full afterwards.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.compliance.deflection import displacement
from robomill.improve.judged import MEASURES, Measure
from robomill.improve.makers import made, only
from robomill.improve.surfaces import Surfaces, surfaces
from robomill.kinematics.choice import spins
from robomill.kinematics.decoupled import decoupled
from robomill.kinematics.dexterity import determinant, largest_determinant, limit_distance
from robomill.kinematics.inverse import LEAST_MOTION, IKResult, Spin, inverse_kinematics
from robomill.kinematics.spin import LEAST_DEVIATION, spin_matters
from robomill.lazy import cached_property
from robomill.progress import checkpoint
from robomill.simulation.judging.gauge import Readings
from robomill.simulation.mapped import total_compliance
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import compliances, sags, tool_frames
from robomill.simulation.samples import chosen
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.tools import farther
from robomill.toolpath.path import Toolpath

Asked = Measure | Literal["feed"]
ASKED: tuple[Asked, ...] = (*MEASURES, "feed")
"""What a place may be asked for: what a remedy is judged by, or the deviation along the feed."""
MOST_SAMPLES, SLOW_SAMPLES = 400, 48  # of a path that are looked at everywhere; of arms that search for each pose
BATCH = 20_000  # configurations at once
SECTORS = 8


class Standing(NamedTuple):
    """How the arm stands along paths (k,): samples missed, room to the joint limits as a share of the half range, and
    the smallest |det(J)| as a share of the arm's largest, negative where det(J) changes its sign on the way."""

    missed: IntArray
    room: FloatArray
    det: FloatArray


def standing(ik: IKResult) -> Standing:
    """Of configurations (..., m, n), the m samples of each path."""
    robot = ik.robot
    missed = (~ik.reached).sum(axis=-1)
    det = determinant(robot, ik.theta)
    share = np.abs(det).min(axis=-1) / largest_determinant(robot)
    if robot.n <= 6:
        share = np.where((det[..., 1:] * det[..., :-1] < 0.0).any(axis=-1), -share, share)
    return Standing(missed, limit_distance(robot, ik.theta).min(axis=-1), share)


class Screened(NamedTuple):
    """At k places: how the arm stands, and the errors (k,) m of ``wall``, ``floor``, ``end``, ``feed`` and ``vector``;
    NaN where a sample has no number."""

    standing: Standing
    errors: dict[str, FloatArray]

    def share(self, measure: Asked, setup: SimulationSetup) -> FloatArray:
        """(k,) share of its tolerance that is used by what is asked for."""
        return share_of(measure, setup, self.errors)


def share_of(measure: Asked, setup: SimulationSetup, errors: dict[str, FloatArray]) -> FloatArray:
    """(k,) share of its tolerance that errors (k,) m use, as the verdict has it; NaN where nothing is known."""
    limits = setup.limits
    if measure != "verdict":
        return np.asarray(errors[measure] / limits[measure])
    deciding = ("wall", "floor") if setup.feed_tolerance is None else ("wall", "floor", "feed", "end")
    every = np.array([errors[name] / limits[name] for name in deciding])
    there = np.isfinite(every).any(axis=0)
    largest = np.fmax.reduce(every)
    return np.where(there, largest, errors["tip"] / limits["tip"])  # nothing is left to be measured


@dataclass(frozen=True, eq=False)
class Screen:
    """What does not depend on where the part lies, at s samples of a path.

    setup     as it is; its T_MW is not used          path (s samples), at: their numbers on the whole path
    T_WT      (s, 4, 4) the tool in {W}                R_WF (s, 3, 3) the axes of the cut in {W}
    F         (s, 3) N in {W} where the force ``turns`` with the part, else in {M}
    judged    (s,) samples that count
    reference the run that it was made from
    """

    setup: SimulationSetup
    path: Toolpath
    at: IntArray
    T_WT: FloatArray
    R_WF: FloatArray
    F: FloatArray
    turns: bool
    judged: BoolArray
    reference: SimulationResult

    @cached_property
    def surfaces(self) -> dict[str, Surfaces]:
        """What a gauge reads of each kind."""
        return {name: surfaces(read, self.reference, self.at) for name, read in _read(self.reference).items()}

    def over(self, T_MW: FloatArray) -> Screened:
        """Of parts that lie at T_MW (k, 4, 4)."""
        found = []
        for begin, end in self._batches(len(T_MW)):
            checkpoint(begin / len(T_MW), "Places tried")
            found.append(self._best_spin(T_MW[begin:end]))
        stands = Standing(*(np.concatenate(parts) for parts in zip(*(each.standing for each in found), strict=True)))
        return Screened(stands, {n: np.concatenate([each.errors[n] for each in found]) for n in found[0].errors})

    def _batches(self, count: int) -> Iterator[tuple[int, int]]:
        size = max(BATCH // len(self.at), 1)
        return ((begin, min(begin + size, count)) for begin in range(0, count, size))

    def _best_spin(self, T_MW: FloatArray) -> Screened:
        setup = self.setup
        if setup.spin != LEAST_DEVIATION or not spin_matters(setup.robot):
            return self._with(T_MW, setup.spin if isinstance(setup.spin, float) else LEAST_MOTION)
        angles = spins().tolist()
        every = [self._with(T_MW, angle) for angle in angles]
        rank = np.array([np.where(e.standing.missed > 0, np.inf, np.nan_to_num(e.errors["tip"])) for e in every])
        best, k = rank.argmin(axis=0), np.arange(len(T_MW))
        stands = Standing(*(np.array([e.standing[i] for e in every])[best, k] for i in range(3)))
        return Screened(stands, {n: np.array([e.errors[n] for e in every])[best, k] for n in every[0].errors})

    def _with(self, T_MW: FloatArray, spin: Spin) -> Screened:
        ik = configurations(self.setup, T_MW[:, None] @ self.T_WT, spin)
        return Screened(standing(ik), self.errors(self.in_cut(T_MW, ik.theta)))

    def in_cut(self, T_MW: FloatArray, theta: FloatArray) -> FloatArray:
        """Deviations (k, s, 3) m along feed, left and axial of parts at T_MW (k, 4, 4), the arm at theta (k, s, n)."""
        R_MF = T_MW[:, None, :3, :3] @ self.R_WF
        F = np.einsum("kij,sj->ksi", T_MW[:, :3, :3], self.F) if self.turns else self.F
        return np.asarray(np.einsum("ksij,ksi->ksj", R_MF, self._delta(T_MW, theta, F)))

    def _delta(self, T_MW: FloatArray, theta: FloatArray, F: FloatArray) -> FloatArray:
        """(k, s, 3) m in {M}."""
        setup = self.setup
        C_joint, C_spring = compliances(setup, self.path, theta)
        if setup.measured_map is None:
            C = C_joint.sum(axis=-3) + C_spring.sum(axis=-3)
        else:
            moved = (setup.replace(T_MW=T) for T in T_MW)
            C = np.array([total_compliance(m, self.path, J, S) for m, J, S in zip(moved, C_joint, C_spring)])
        delta = displacement(C, np.broadcast_to(F, C.shape[:-1]))
        if setup.links is not None and setup.add_sag:
            delta = delta + sags(setup, self.path, theta, setup.links).sum(axis=-2)
        return delta

    def errors(self, d: FloatArray) -> dict[str, FloatArray]:
        """Largest errors (k,) m of deviations d (k, s, 3) m along feed, left and axial; NaN where one has none."""
        found = {name: surface.largest(d) for name, surface in self.surfaces.items()}
        judged = d[:, self.judged]
        return found | {"feed": np.abs(judged[..., 0]).max(axis=-1), "tip": np.linalg.norm(judged, axis=-1).max(-1)}

    def shares(self, measure: Asked, d: FloatArray) -> FloatArray:
        """(k, s) share of its tolerance that each sample uses by its own readings, with deviations d (k, s, 3) m; NaN
        where there is no deviation, 0 where the sample leaves nothing that is judged."""
        found = {name: surface.by_sample(d) for name, surface in self.surfaces.items()}
        found["feed"] = np.where(self.judged, np.abs(d[..., 0]), 0.0)
        found["tip"] = np.where(self.judged, np.linalg.norm(d, axis=-1), 0.0)
        return np.where(np.isnan(d).any(axis=-1), np.nan, share_of(measure, self.setup, found))


def configurations(setup: SimulationSetup, T_MT: FloatArray, spin: Spin = LEAST_MOTION) -> IKResult:
    """How the arm stands along paths T_MT (k, s, 4, 4), as in runs along them."""
    return inverse_kinematics(setup.robot, T_MT, near="path", spin=spin)


def screen(result: SimulationResult, also: IntArray | None = None, most: int | None = None) -> Screen:
    """From a run without coupling all of whose samples are reached; samples ``also`` are looked at in any case, and
    about ``most`` of them (None: as many as a thousand places can afford)."""
    setup, path = result.setup, result.path
    searched = spin_matters(setup.robot) and not isinstance(setup.spin, float)
    quick = decoupled(setup.robot) is not None and not searched
    most = most or (MOST_SAMPLES if quick else SLOW_SAMPLES)
    at = _few(result, most, np.zeros(0, dtype=np.int64) if also is None else also)
    keep = np.zeros(len(path), dtype=bool)
    keep[at] = True
    turns = setup.force.frame == "path" or setup.force.turns_with_part
    return Screen(
        setup=uncoupled(setup),
        path=chosen(path, keep),
        at=at,
        T_WT=tool_frames(path.p[at], path.k[at], farther(setup, path)[at]),
        R_WF=setup.T_MW[:3, :3].T @ result.R_MF[at],
        F=setup.to_part(result.F[at]) if turns else result.F[at],
        turns=turns,
        judged=result.judged[at],
        reference=result,
    )


def uncoupled(setup: SimulationSetup) -> SimulationSetup:
    """The set-up without the coupling of force and deflection."""
    return setup.replace(coupling=False) if setup.coupling else setup


def _read(result: SimulationResult) -> dict[str, Readings]:
    return {"wall": result.gauge.walls, "floor": result.gauge.floors, "end": result.gauge.ends}


def _few(result: SimulationResult, most: int, also: IntArray) -> IntArray:
    """Samples of a path: all where there are few, else some all along it, the ends of its extent, the largest readings
    in every direction of the feed with what has made them, and the first of every tool."""
    path, m = result.path, len(result.path)
    if m <= most:
        return np.arange(m)
    way = np.arctan2(result.R_MF[:, 1, 0], result.R_MF[:, 0, 0])
    sector = np.floor((way + np.pi) / (2.0 * np.pi) * SECTORS).astype(np.int64) % SECTORS
    turn = 2.0 * np.pi / SECTORS * np.arange(SECTORS)
    outward = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(SECTORS)])
    sides = path.p @ np.vstack([outward, [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]).T
    kept = [np.linspace(0, m - 1, most * 3 // 4).astype(np.int64), np.argmax(sides, axis=0), also]
    kept.append(np.unique(path.tool, return_index=True)[1])
    kept += [np.array([int(np.argmax(path.cutting & (path.tool == n)))]) for n in np.unique(path.tool)]
    for read in _read(result).values():
        for error in (read.error, -read.error):
            for each in range(SECTORS):
                some = np.flatnonzero(sector[read.sample] == each)
                most_of = some[[np.argmax(error[some])]] if len(some) else some
                kept += [read.sample[most_of], made(only(read, most_of), result).by.ravel()]
    return np.unique(np.concatenate(kept))
