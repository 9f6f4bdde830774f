"""The deviation of a cut as it goes with the numbers it is computed from: ten thousand cuts for the price of a hundred.

With u the changes of lengths, part zero and tool, counted in standard deviations, of the compliances c and of what the
force is computed from f,

    delta(u, c, f) = [C(u) + sum_j c_j dC/dc_j(u)] [F + sum_k f_k dF/df_k].

C(u) F is of second order in u, with every product of two of them, from the inverse kinematics at each; the change of
the compliances, in which delta is exactly linear, is carried at first order in u. F is linear in f: exactly so in
components and in coefficients per area and per length, at first order in an exponent. What a gauge reads moves with the
tip as ``screening`` has it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from robomill.arrays import FloatArray
from robomill.improve.screening import Screen, configurations, screen
from robomill.improve.unsure import Unsure, changed
from robomill.kinematics.inverse import IKResult, Spin
from robomill.progress import slices, step
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import compliances, sags, spin_of
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.tools import held

BATCH = 2000  # draws at once
FARTHEST = 32  # draws that lie farthest out: whether the arm reaches there
GEOMETRY = ("lengths", "part", "tool")


@dataclass(frozen=True, eq=False)
class At:
    """What gives, with lengths, part and tool as they are set: ``forces`` (1 + forces, s, 3) N push."""

    unsure: Unsure
    looking: Screen
    spin: Spin
    forces: FloatArray

    def configurations(self, setup: SimulationSetup) -> IKResult:
        """How the arm stands, (1, s, n)."""
        poses = (setup.T_MW @ self.looking.T_WT)[None]
        return configurations(setup, poses, self.spin)

    def of(self, change: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(1 + forces, s, 3) m by all that gives, and (springs, 1 + forces, s, 3) m per change of each compliance."""
        setup, looking = changed(self.unsure, change), self.looking
        path, theta = looking.path, self.configurations(setup).theta[0]
        R_MF = setup.T_MW[:3, :3] @ looking.R_WF
        F = setup.to_base(self.forces) if looking.turns else self.forces
        C_joint, C_spring = compliances(setup, path, theta)
        C = C_joint.sum(axis=-3) + C_spring.sum(axis=-3)
        nominal = np.einsum("sij,fsj->fsi", C, F)
        given = np.concatenate([self._by_springs(setup, theta, each)[:, None] for each in F], axis=1)
        if setup.links is not None and setup.add_sag:
            sag = sags(setup, path, theta, setup.links)
            nominal[0] += sag.sum(axis=-2)
            per = sag / np.where(setup.robot.C_theta > 0.0, setup.robot.C_theta, np.inf)[:, None]
            for column, i in enumerate(self._chosen):
                given[column, 0] += per[:, i] if i < setup.robot.n else 0.0
        return np.einsum("sij,fsi->fsj", R_MF, nominal), np.einsum("sij,cfsi->cfsj", R_MF, given)

    @property
    def _chosen(self) -> list[int]:
        """The parameters of the model that are inputs."""
        return [n for n, i in enumerate(self.unsure.springs) if i >= 0]

    def _by_springs(self, setup: SimulationSetup, theta: FloatArray, F: FloatArray) -> FloatArray:
        """(springs, s, 3) m in {M} per compliance, under F (s, 3) N."""
        D = np.empty((len(theta), 3, len(self.unsure.springs)))
        for tool in held(setup, self.looking.path):
            D[tool.steps] = self.unsure.model.tip_regressor(tool.robot, theta[tool.steps], F[tool.steps])
        return np.moveaxis(D, -1, 0)[self._chosen]


@dataclass(frozen=True, eq=False)
class Expansion:
    """What a cut's deviation is made of.

    at       what gives at s samples; geometry, forces, compliances: which inputs these are
    nominal  (terms, 1 + forces, s, 3) m along feed, left and axial, per product of ``_products``
    given    (1 + geometry, springs, 1 + forces, s, 3) m, per change of a compliance
    missed   (s,) m: one standard deviation of what the model misses there
    ahead    (s, 3) m along feed, left and axial: how far a corrected program sends the tool beside its path
    """

    at: At
    geometry: tuple[int, ...]
    forces: tuple[int, ...]
    compliances: tuple[int, ...]
    nominal: FloatArray
    given: FloatArray
    missed: FloatArray
    ahead: FloatArray

    @property
    def unsure(self) -> Unsure:
        """The inputs."""
        return self.at.unsure

    @property
    def screen(self) -> Screen:
        """What is looked at."""
        return self.at.looking

    @property
    def known(self) -> bool:
        """Whether all that is judged has a number wherever the arm was set."""
        judged = self.screen.judged
        return bool(np.isfinite(self.nominal[:, :, judged]).all() and np.isfinite(self.given[:, :, :, judged]).all())

    def reaches(self, change: FloatArray) -> bool:
        """Whether the arm reaches all that is judged in the draws (k, p) that lie farthest out."""
        u = change[:, self.geometry] / self.unsure.std[list(self.geometry)]
        ends = np.concatenate([u.argmin(axis=0), u.argmax(axis=0)]) if u.shape[1] else np.zeros(0, dtype=np.int64)
        far = np.union1d(np.argsort(-np.linalg.norm(u, axis=1), kind="stable")[:FARTHEST], ends)
        for each in change[far]:
            ik, looking = self.at.configurations(changed(self.unsure, each)), self.screen
            if (~ik.reached[0] & looking.judged).any():
                return False
        return True

    def errors(self, change: FloatArray) -> dict[str, FloatArray]:
        """Largest errors (k,) m of wall, floor, end, feed and tip, with the inputs changed by (k, p)."""
        parts = [self.screen.errors(self.deviations(change[some])) for some in slices(len(change), "Draws", BATCH)]
        return {name: np.concatenate([each[name] for each in parts]) for name in parts[0]}

    def deviations(self, change: FloatArray) -> FloatArray:
        """(k, s, 3) m along feed, left and axial."""
        k, s = len(change), self.nominal.shape[2]
        u = change[:, self.geometry] / self.unsure.std[list(self.geometry)]
        f = np.column_stack([np.ones(k), change[:, self.forces]])
        c = change[:, self.compliances]
        weights = np.einsum("kt,kf->ktf", _products(u), f).reshape(k, -1)
        found = weights @ self.nominal.reshape(-1, s * 3)
        first = np.column_stack([np.ones(k), u])
        weights = np.einsum("kt,kc,kf->ktcf", first, c, f).reshape(k, -1)
        found = (found + weights @ self.given.reshape(-1, s * 3)).reshape(k, s, 3) + self.ahead
        errs = [i for i, each in enumerate(self.unsure.inputs) if each.group == "model"]
        return found + change[:, None, errs] * self.missed[:, None] if errs else found


def _products(u: FloatArray) -> FloatArray:
    """(k, terms): 1, each of u (k, g), its square, and every product of two."""
    pairs = [u[:, i] * u[:, j] for i, j in combinations(range(u.shape[1]), 2)]
    return np.column_stack([np.ones(len(u)), u, u**2, *pairs])


def expand(unsure: Unsure, result: SimulationResult) -> Expansion:
    """About a run without coupling."""
    looking = screen(result)
    geometry, forces = unsure.named(*GEOMETRY), unsure.named("force")
    springs = unsure.named("compliance", "springs")
    every = _forces(unsure, looking, forces)
    at = At(unsure, looking, spin_of(result.ik), every)
    nominal, given = _taylor(at, unsure.std, geometry)
    return Expansion(
        at,
        tuple(geometry),
        tuple(forces),
        tuple(springs),
        nominal,
        given,
        _missed(unsure, result, looking),
        _ahead(result, looking),
    )


def _forces(unsure: Unsure, looking: Screen, inputs: list[int]) -> FloatArray:
    """(1 + forces, s, 3) N as ``looking.F``: as it is, and its derivative by every input of it."""
    found = [looking.F]
    for n, i in enumerate(inputs):
        with step(n, len(inputs), "How the force goes with its numbers"):
            found.append(_derivative(lambda change: _force_of(unsure, looking, change), unsure, i))
    return np.array(found)


def _derivative(force: Callable[[FloatArray], FloatArray], unsure: Unsure, i: int) -> FloatArray:
    """By one input of the force, on both sides of what it is, or on the side where it can be."""
    size = np.zeros(len(unsure.inputs))
    size[i] = min(unsure.inputs[i].std, 0.5 * abs(unsure.inputs[i].value))
    return np.asarray((force(size) - force(-size)) / (2.0 * size[i]))


def _force_of(unsure: Unsure, looking: Screen, change: FloatArray) -> FloatArray:
    F = unsure.run(change).F[looking.at]
    return unsure.setup.to_part(F) if looking.turns else F


def _taylor(at: At, std: FloatArray, geometry: list[int]) -> tuple[FloatArray, FloatArray]:
    """The second order of what gives, and the first of what it gives per compliance, from differences of one standard
    deviation."""
    pairs = list(combinations(range(len(geometry)), 2))
    count, done = 1 + 2 * len(geometry) + len(pairs), 0

    def moved(*by: tuple[int, float]) -> tuple[FloatArray, FloatArray]:
        nonlocal done
        change = np.zeros(len(std))
        for i, sign in by:
            change[geometry[i]] = sign * std[geometry[i]]
        with step(done, count, "How the arm gives with its lengths and the part's place"):
            done += 1
            return at.of(change)

    here, per = moved()
    both = [(moved((i, 1.0)), moved((i, -1.0))) for i in range(len(geometry))]
    first = [0.5 * (plus[0] - minus[0]) for plus, minus in both]
    square = [0.5 * (plus[0] + minus[0]) - here for plus, minus in both]
    mixed = [moved((i, 1.0), (j, 1.0))[0] - both[i][0][0] - both[j][0][0] + here for i, j in pairs]
    given = [per, *(0.5 * (plus[1] - minus[1]) for plus, minus in both)]
    return np.array([here, *first, *square, *mixed]), np.array(given)


def _ahead(result: SimulationResult, looking: Screen) -> FloatArray:
    """(s, 3) m along feed, left and axial; 0 of a program that was not corrected."""
    if result.ahead is None:
        return np.zeros((len(looking.at), 3))
    return np.asarray(np.einsum("sij,si->sj", result.R_MF[looking.at], result.ahead[looking.at]))


def _missed(unsure: Unsure, result: SimulationResult, looking: Screen) -> FloatArray:
    """(s,) m: one standard deviation of what the model misses."""
    known, at = unsure.known, looking.at
    if known is None or known.error is None:
        return np.zeros(len(at))
    load = result.force_size[at]
    return np.where(load > 0.0, np.sqrt(known.error.variance(result.deviation[at], load)), 0.0)
