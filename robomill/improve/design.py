"""Which joints to stiffen, and by how much, so that the errors of a cut keep their tolerance at the least cost."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked, made_by
from robomill.arrays import FloatArray, digest, frozen
from robomill.compliance.deflection import shares_along
from robomill.errors import SetupError
from robomill.frames import Columns
from robomill.improve.asked_joints import SETTLED, checked_bounds, checked_weight, words_of_joints
from robomill.improve.judged import Judged, Measure, check_improvable, check_joints_known, check_numbered, judged
from robomill.improve.least_cost import Errors, Least, least_cost, least_share
from robomill.improve.sensitivity import stiffened
from robomill.lazy import cached_property
from robomill.progress import step
from robomill.provenance import Provenance
from robomill.quantities import quantities
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate
from robomill.simulation.setup import SimulationSetup
from robomill.spelled import one_of
from robomill.units import format_count, format_limit, format_percent, format_short, format_si
from robomill.values import Said, Tabled

STIFFEST = 10.0  # times as stiff: the bound where none is given
ROUNDS = 8  # of solving and running the cut with what was found
WITHIN = 1.0 - 1e-4  # of the tolerance is aimed at, so that what is found keeps it
HALVED = 6  # times, where the least cost was not found


@dataclass(frozen=True, eq=False, repr=False)
class Front(Said):
    """What each deviation costs: share (k,) of the tolerance that is used, cost (k,), stiffness_ratio (k, n); by the
    errors as they go with the joints about the cut as it is."""

    share: FloatArray
    cost: FloatArray
    stiffness_ratio: FloatArray

    def _said(self) -> str:
        if not len(self.cost):
            return "no points"
        shares = f"{format_percent(self.share.min())} to {format_percent(self.share.max())} of the tolerance"
        return f"{format_count(len(self.cost), 'point')}, {shares}, cost {self.cost.min():.2f} to {self.cost.max():.2f}"


@made_by("rm.design(setup)")
@dataclass(frozen=True, eq=False, repr=False)
class Design(Tabled):
    """The cheapest stiffer joints that keep a tolerance on a path, or the best there are.

    before, after    the runs of the cut as it is and with the stiffness ratios found; ``after.setup`` is the set-up
    stiffness_ratio  (n,) how many times as stiff each free joint is then
    weight, bounds   (n,) and (n, 2): what doubling a joint costs, and least and most ratio
    measure          what is judged: "verdict", "wall", "floor" or "tip"
    feasible         whether the tolerance is kept; ``reason`` says why not, else ""
    residual         the solver's largest: primal, dual, and how much cheaper any other could be; NaN where the errors
                     go otherwise than the solver was told, and the tolerance is kept but no least cost is proved
    rounds           how often the cut was run with what had been found

    Examples
    --------
    >>> import robomill as rm
    >>> found = rm.design(rm.load_setup("paper_flute"), tolerance_mm=0.2)
    >>> found
    <Design Reference groove (Slavkovic 2013): joint 3 1.25 times as stiff keeps 0.20 mm; cost 0.32>
    """

    before: SimulationResult
    after: SimulationResult
    stiffness_ratio: FloatArray
    weight: FloatArray
    bounds: FloatArray
    measure: Measure
    reason: str
    residual: float
    rounds: int

    @property
    def feasible(self) -> bool:
        """Whether the tolerance can be kept; if not, ``reason`` says why."""
        return not self.reason

    @property
    def setup(self) -> SimulationSetup:
        """The set-up with the stiffer joints."""
        return self.after.setup

    @property
    def C_theta(self) -> FloatArray:
        """(n,) rad/(N m) (m/N of joints that slide) then."""
        return self.setup.robot.C_theta

    @property
    def cost(self) -> float:
        """Sum over the joints of weight times the binary logarithm of the stiffness ratio: 1 is one joint twice as
        stiff where its weight is 1."""
        return float(self.weight @ np.log2(self.stiffness_ratio))

    @property
    def share(self) -> float:
        """Of the tolerance that is used then."""
        return judged(self.after, self.measure).share

    @property
    def sentence(self) -> str:
        """What to stiffen, or why that does not do."""
        if not self.feasible:
            return f"Cannot be met: {self.reason}."
        limit = _limits(self.setup, self.measure)
        some = words_of_joints(self.setup.robot.joint_numbers, self.stiffness_ratio)
        if not some:
            return f"The cut keeps {limit} with the joints as they are."
        return f"{some[0][0].upper()}{some[0][1:]} as stiff keep{'s' * (some[1] == 1)} {limit}."

    @asked
    def front(self, count: int = 25) -> Front:
        """What costs how much, from the cut as it is to the least deviation within the bounds."""
        now = judged(self.before, self.measure)
        errors = linear(self.before, now, np.ones(len(self.weight)))
        low, high = 1.0 / self.bounds[:, 1], 1.0 / self.bounds[:, 0]
        least = least_share(errors, low, high).value
        levels = np.linspace(max(least * (1.0 + 1e-6), 1e-9), max(now.share, least * (1.0 + 1e-6)), count)
        points = [
            (level, least_cost(replace(errors, bound=errors.bound * level), self.weight, low, high)) for level in levels
        ]
        known = [(level, found) for level, found in points if found is not None]
        ratios = np.array([1.0 / found.x for _, found in known]).reshape(-1, len(self.weight))
        return Front(np.array([level for level, _ in known]), np.log2(ratios) @ self.weight, ratios)

    def columns(self) -> Columns:
        """One row a free joint: its number, stiffness ratio, cost, and compliance before and after (SI)."""
        return {
            "joint": np.array(self.setup.robot.joint_numbers),
            "stiffness_ratio": self.stiffness_ratio,
            "cost": self.weight * np.log2(self.stiffness_ratio),
            "C_theta_before": self.before.setup.robot.C_theta,
            "C_theta_after": self.C_theta,
        }

    @cached_property
    def _digest(self) -> str:
        return digest((self.before.digest(), self.after.digest(), self.weight, self.bounds, self.measure))

    def _said(self) -> str:
        words = self.sentence.rstrip(".")
        return f"{self.before.setup.name}: {words[0].lower()}{words[1:]}; cost {format_short(self.cost, '1', 2)}"


@asked
def design(
    setup: SimulationSetup,
    tolerance: float | None = None,
    *,
    tolerance_mm: float | None = None,
    measure: Measure = "verdict",
    bounds: ArrayLike = (1.0, STIFFEST),
    weight: ArrayLike = 1.0,
) -> Design:
    """The least cost of stiffening joints that keeps a tolerance on the path of a set-up.

    Parameters
    ----------
    setup : SimulationSetup
        The cut.
    tolerance, tolerance_mm : float, optional
        Of walls and floors, m or mm; left out: those of the set-up.
    measure : {"verdict", "wall", "floor", "tip"}
        What has to keep it: what the verdict judges, one of its parts, or the size of the tip's deviation.
    bounds : array_like, (2,) or (n, 2)
        Least and most times as stiff, for all free joints or for each; (1, 1) is a joint that stays.
    weight : float or array_like (n,)
        What making a joint twice as stiff costs. The cost is weight times log2 of the stiffness ratio, summed.

    Returns
    -------
    Design
        ``feasible``; the ratios, the cost and the run with them, or with the best that the bounds allow.

    Raises
    ------
    SetupError
        For a cut without a number to improve, a measured map (no joint of which is known), contradictory bounds.

    Notes
    -----
    Errors are linear in the compliances of the joints while force and contact stay (eqs. 12, 16): a convex program with
    a certain optimum. The cut is run with what was found, and solved again about it, until it stays.

    Examples
    --------
    >>> import robomill as rm
    >>> found = rm.design(rm.load_setup("paper_flute"), tolerance_mm=0.2)
    >>> found.feasible, found.stiffness_ratio.round(2).tolist()
    (True, [1.0, 1.0, 1.25, 1.0, 1.0])
    >>> round(found.share, 3)
    1.0
    """
    check_improvable(setup)
    setup = asked_for(setup, tolerance, tolerance_mm)
    n = setup.robot.n
    ratios = checked_bounds(bounds, n)
    weights = checked_weight(weight, n)
    before = simulate(setup)
    _check(before, measure)
    search = _Search(setup, measure, weights, 1.0 / ratios[:, 1], 1.0 / ratios[:, 0])
    x = np.clip(np.ones(n), search.low, search.high)
    result = before if (x == 1.0).all() else search.at(x)
    x, result, residual, rounds = search.settled(x, result)
    if judged(result, measure).share > 1.0:
        x, result, residual = search.on_the_way(x, result, residual)
    reason = _reason(result, judged(result, measure), x, ratios)
    return Design(before, result, frozen(1.0 / x), frozen(weights), frozen(ratios), measure, reason, residual, rounds)


@dataclass(frozen=True, eq=False)
class _Search:
    """For the compliances x (n,) in [low, high], times what they are, that keep the tolerance at the least cost."""

    setup: SimulationSetup
    measure: Measure
    weight: FloatArray
    low: FloatArray
    high: FloatArray

    def at(self, x: FloatArray) -> SimulationResult:
        """The cut with these compliances."""
        setup = self.setup
        return simulate(setup.replace(robot=stiffened(setup.robot, 1.0 / x), provenance=setup.provenance))

    def settled(self, x: FloatArray, result: SimulationResult) -> tuple[FloatArray, SimulationResult, float, int]:
        """Solve about a run, run what was found, and again, until it stays: x, its run, residual, how often."""
        aim, residual = WITHIN, float("nan")
        for rounds in range(ROUNDS):
            with step(rounds, ROUNDS, "Joints that keep the tolerance"):
                now = judged(result, self.measure)
                errors = linear(result, now, x, rounds < ROUNDS // 2)
                errors = replace(errors, bound=errors.bound * aim)
                found = least_cost(errors, self.weight, self.low, self.high)
                best = nearest(errors, self.weight, self.low, self.high) if found is None else found
                residual = best.residual
                stays = bool(np.abs(np.log(best.x / x)).max() < SETTLED)
                if stays and (now.share <= 1.0 or found is None):
                    return x, result, residual, rounds
                if stays:  # what is left is not linear: aim lower by what it is beyond
                    aim *= WITHIN / now.share
                    continue
                x, result = best.x, self.at(best.x)
        return x, result, residual, ROUNDS

    def on_the_way(
        self, x: FloatArray, result: SimulationResult, residual: float
    ) -> tuple[FloatArray, SimulationResult, float]:
        """Where the errors do not go as the solver was told: between x and the stiffest there is, the first that keeps
        the tolerance (no least cost is proved for it: the residual is NaN); else the better of the two."""
        stiffest = self.at(self.low)
        share = judged(stiffest, self.measure).share
        if share > 1.0:
            better = share < judged(result, self.measure).share * (1.0 - SETTLED)
            return (self.low, stiffest, residual) if better else (x, result, residual)
        near, kept, found = 0.0, 1.0, stiffest
        for k in range(HALVED):
            with step(k, HALVED, "Between there and the stiffest joints"):
                middle = 0.5 * (near + kept)
                run = self.at(_between(x, self.low, middle))
                if judged(run, self.measure).share <= 1.0:
                    kept, found = middle, run
                else:
                    near = middle
        return _between(x, self.low, kept), found, float("nan")


def _between(x: FloatArray, end: FloatArray, part: float) -> FloatArray:
    return np.asarray(x ** (1.0 - part) * end**part)


def nearest(errors: Errors, weight: FloatArray, low: FloatArray, high: FloatArray) -> Least:
    """As small as the errors can be within the bounds, at the least cost at which they are."""
    least = least_share(errors, low, high)
    cheap = least_cost(replace(errors, bound=errors.bound * least.value / WITHIN), weight, low, high)
    return least if cheap is None else cheap


def linear(result: SimulationResult, found: Judged, x: FloatArray, rest_goes: bool = True) -> Errors:
    """What is judged of a run as it goes with the joints' compliances, x (n,) times what they were first.

    An error goes as the deviations of those samples do that have made what is read. The rest of it, which none
    explains, goes with the size of its own sample's (``rest_goes``; of the largest, where nothing pushes), so that it
    vanishes where nothing gives; or it stays.
    """
    i, parts = found.sample, result.delta_joint
    if result.sag is not None and result.setup.add_sag:
        parts = parts + result.sag
    given = found.along(np.einsum("mij,mni->mjn", result.R_MF, parts))
    shares = shares_along(parts[i], result.delta[i])
    shares[~shares.any(axis=1)] = shares_along(parts[result.worst], result.delta[result.worst])
    rest = found.error - found.along(result.delta_in_cut)
    given = (given + (rest[..., None] * shares[:, None] if rest_goes else 0.0)) / x
    return Errors(found.error - given @ x, given, found.tolerance)


def _limits(setup: SimulationSetup, measure: Measure) -> str:
    """What has to be kept, in words: one tolerance, or those of walls and floors."""
    wall, floor = setup.limits["wall"], setup.limits["floor"]
    if floor == wall or measure in ("wall", "tip"):
        return format_limit(wall, "mm")
    if measure == "floor":
        return format_limit(floor, "mm")
    return f"{format_limit(wall, 'mm')} on walls and {format_limit(floor, 'mm')} on floors"


def asked_for(setup: SimulationSetup, tolerance: float | None, tolerance_mm: float | None) -> SimulationSetup:
    check_joints_known(setup, "to design joints")
    if tolerance is None and tolerance_mm is None:
        return setup
    declared = quantities(SimulationSetup)["tolerance"]
    asked_for = one_of(declared, tolerance, tolerance_mm, SetupError, "Design")
    said = {**setup.provenance, "tolerance": Provenance("user", "asked for")}
    asked_for = declared.settled(asked_for, SetupError, "Design")
    return setup.replace(tolerance=asked_for, floor_tolerance=None, provenance=said)


def _check(result: SimulationResult, measure: Measure) -> None:
    """Refuse a cut without numbers that a stiffer joint could make better."""
    check_numbered(result, "design for")
    if not len(judged(result, measure).sample):
        raise SetupError(f"The cut leaves no {measure} to judge; take another measure.", where="measure")


def _reason(result: SimulationResult, found: Judged, x: FloatArray, ratios: FloatArray) -> str:
    """Why the tolerance is not kept; "" where it is."""
    verdict = result.verdict
    if verdict.gone:
        return "a wall that should stand is cut away, however stiff the joints are"
    if found.share <= 1.0:
        return ""
    errors = linear(result, found, x)
    q = int(np.argmax(found.shares(found.error)))
    error, tolerance = errors.at(x)[q], float(found.tolerance[q])
    way = error / np.linalg.norm(error)
    each = (way @ errors.given[q]) * x
    rest = float(way @ errors.fixed[q])
    limit = format_limit(tolerance, "mm")
    where = f"{result.path.block_name} {int(result.path.block[found.sample[q]])}"
    most = int(np.argmax(each))
    if rest > tolerance:
        return f"what no joint does alone leaves {format_si(rest, 'mm')} of {limit} ({where})"
    if each[most] > tolerance and x[most] * ratios[most, 1] < 1.0 + SETTLED:
        most_stiff = ratios[most, 1]
        stiff = (
            "and stays as it is" if most_stiff == 1.0 else f"though {format_short(most_stiff, '1', 2)} times as stiff"
        )
        number = result.setup.robot.joint_numbers[most]
        left = format_si(each[most], "mm")
        return f"joint {number} alone leaves {left} of {limit} {stiff} ({where})"
    left = format_si(float(np.linalg.norm(error)), "mm")
    return f"{left} of {limit} are left however stiff the joints are within their bounds ({where})"
