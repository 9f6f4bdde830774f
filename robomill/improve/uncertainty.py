"""How sure a cut's deviation is: its distribution, how probably it keeps its tolerance, what to measure next."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arguments import asked
from robomill.arrays import FloatArray, frozen, of_kind
from robomill.errors import RobomillError, SetupError
from robomill.identification.fit.confidence import quantile
from robomill.identification.knowledge import Knowledge
from robomill.identification.result import IdentificationResult
from robomill.improve.draws import Tornado, Uncertainty
from robomill.improve.expansion import Expansion, expand
from robomill.improve.judged import MEASURES, Measure, check_joints_known, check_numbered
from robomill.improve.placed import errors_of
from robomill.improve.screening import share_of
from robomill.improve.unsure import Spread, Unsure, unsure_of
from robomill.progress import step
from robomill.provenance import Finding
from robomill.simulation.origin.doubts import OTHERS, known_notes
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate
from robomill.simulation.setup import SimulationSetup, check_setup
from robomill.units import format_percent

MANY, FULL, MOST = 10_000, 200, 1_000_000  # draws: usual, usual where each is a run in full, and most
CHECKED = 6  # draws that are run in full, too: those with the largest errors, and
DECIDING = 3  # those nearest to the tolerance, which decide how probably it is kept
AGREES = 0.02  # of the tolerance: by how much these may differ
DOUBTED, PROBES = 0.01, 24  # where they differ by more, so many others are run, too, spread over the shares
NAMES = ("wall", "floor", "end", "feed", "tip")
DIFFERS, REDRAWN, IN_FULL = "draws-differ", "draws-again", "draws-in-full"
Errors = dict[str, FloatArray]


@asked
def uncertainty(
    setup: SimulationSetup,
    spread: Spread | None = None,
    *,
    known: Knowledge | IdentificationResult | None = None,
    measure: Measure = "verdict",
    samples: int | None = None,
    seed: int = 0,
) -> Uncertainty:
    """How sure the deviation of a cut is, by Monte Carlo over what is not known exactly.

    Parameters
    ----------
    setup : SimulationSetup
        The cut.
    spread : Spread, optional
        One standard deviation of compliances, force, D-H lengths, part zero and tool; what is left out is assumed.
    known : Knowledge or IdentificationResult, optional
        How sure the compliances are, with their covariance and the model's own error; instead of ``spread.compliance``.
        Left out: ``setup.known``, unless ``spread.compliance`` is stated.
    measure : {"verdict", "wall", "floor", "tip"}
        What is judged: what the verdict does, one of its parts, or the size of the tip's deviation.
    samples : int, optional
        How many draws: 10 000, or 200 where force and deflection are coupled and each is a run in full.
    seed : int
        Of the draws; the same seed gives the same numbers.

    Returns
    -------
    Uncertainty
        The draws, the probability that the tolerance is kept with its own interval, and the tornado: what each input
        does alone, and so what to measure next.

    Raises
    ------
    SetupError
        For a cut without a number, a compliance that is a measured map, and where everything is known exactly.

    Notes
    -----
    Inputs are normal; compliances and coefficients that would change their sign are drawn again. Each draw is the cut
    run with those numbers, the joints solved anew. Exact in compliances, force components and coefficients per area or
    length; of second order in lengths and places, first in exponents; what a gauge reads moves with the tip. The draws
    with the largest errors, and those nearest to the tolerance, are run in full besides, and more where these differ
    (``checked``). What a length or the tool's length changes of where the tool stands, rather than of how much it
    gives, is taken up when the part is set up, and is not in it.

    Examples
    --------
    >>> import robomill as rm
    >>> found = rm.uncertainty(rm.load_setup("paper_flute"), rm.Spread(compliance=0.1, force=0.05))
    >>> found
    <Uncertainty Reference groove (Slavkovic 2013): 0.265 mm in 95 % of the draws, tolerance kept in 99.97 %>
    """
    check_setup(setup)
    asked_for = Spread() if spread is None else spread
    of_kind(asked_for, Spread, "spread", "rm.Spread(compliance=0.1, force=0.05)", SetupError)
    _check(setup, measure, samples, seed)
    if isinstance(known, IdentificationResult):
        known = Knowledge.of(known, setup.robot, "identified")
    elif known is None and asked_for.compliance is None:
        known = setup.known
    run = simulate(setup)
    check_numbered(run, "be sure of")
    unsure = unsure_of(setup, asked_for, known)
    wanted = samples or (FULL if setup.coupling else MANY)
    change, again = unsure.drawn(wanted, int(seed))
    expansion = _expansion(unsure, run, change)
    change = change if expansion is not None or samples else change[:FULL]
    work = _Work(unsure, run, measure, expansion)
    errors = work.errors(change, "Draws")
    share = share_of(measure, setup, errors)
    checked = work.checked(change, errors, share)
    return Uncertainty(
        run=run,
        measure=measure,
        inputs=unsure.inputs,
        change=frozen(change),
        share=frozen(share),
        wall=frozen(errors["wall"]),
        floor=frozen(errors["floor"]),
        tip=frozen(errors["tip"]),
        tornado=work.tornado(float(np.nanvar(share))),
        checked=checked[:2],
        seed=int(seed),
        findings=_findings(unsure, expansion, checked, again / wanted),
    )


def _expansion(unsure: Unsure, run: SimulationResult, change: FloatArray) -> Expansion | None:
    """What draws are computed with; None where each has to be run in full: coupled, or not reached in some."""
    found = None if unsure.setup.coupling else expand(unsure, run)
    if found is not None and found.known and found.reaches(change):
        return found
    if unsure.named("springs", "model"):
        raise SetupError(
            "The draws of this cut are runs in full, which know nothing of errors of the model or of springs that "
            "bend: give known.noise_only() of the joints' model, or uncouple the cut."
        )
    return None


def _check(setup: SimulationSetup, measure: str, samples: Any, seed: Any) -> None:
    check_joints_known(setup, "to draw compliances")
    if measure not in MEASURES:
        raise SetupError(f"Measure: found {measure!r:.40}, expected {', '.join(MEASURES)}.", where="measure")
    for name, value, most in (("samples", samples, MOST), ("seed", seed, 2**63)):
        whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
        least = 2 if name == "samples" else 0
        if (value is not None or name == "seed") and not (whole and least <= value <= most):
            raise SetupError(
                f"Uncertainty, {name}: found {value!r:.40}, expected a whole number from {least} to {most}.", where=name
            )


@dataclass(frozen=True, eq=False)
class _Work:
    """What changed inputs do: as the expansion has it, or run in full where there is none."""

    unsure: Unsure
    run: SimulationResult
    measure: Measure
    expansion: Expansion | None

    def errors(self, change: FloatArray, stage: str) -> Errors:
        """(k,) m each, with the inputs changed by (k, p)."""
        if self.expansion is not None:
            return self.expansion.errors(change)
        return self._runs(change, stage)

    def _runs(self, change: FloatArray, stage: str) -> Errors:
        """The same of a run for each."""
        found = []
        for i, each in enumerate(change):
            with step(i, len(change), stage):
                found.append(self._in_full(each))
        return {name: np.array([each[name] for each in found]) for name in NAMES}

    def _in_full(self, change: FloatArray) -> dict[str, float]:
        """The errors of one run; NaN where it is not reached or refused, as a part that lies too far off is."""
        nothing = dict.fromkeys(NAMES, float("nan"))
        try:
            found = self.unsure.run(change)
            return nothing if found.missed.any() else errors_of(found)
        except RobomillError:
            return nothing

    def checked(self, change: FloatArray, errors: Errors, share: FloatArray) -> tuple[int, float, float]:
        """Draws run in full, by how much of its tolerance an error differs at most from what was said of it, and by how
        much the share of the tolerance that is used does."""
        if self.expansion is None:
            return 0, 0.0, 0.0
        names = ("wall", "floor", "tip") if self.measure == "verdict" else (self.measure,)
        ends = [int(np.argmax(np.nan_to_num(errors[name]))) for name in names]
        near = np.argsort(np.abs(np.nan_to_num(share) - 1.0), kind="stable")[:DECIDING]
        worst = np.argsort(-np.nan_to_num(share), kind="stable")[:CHECKED]
        first = list(dict.fromkeys([*ends, *near, *worst]))[:CHECKED]
        off = self._off(change[first], names)
        if max(off) <= DOUBTED:
            return len(first), *off
        order = np.argsort(np.nan_to_num(share), kind="stable")
        more = [int(i) for i in order[:: max(len(order) // PROBES, 1)] if i not in first]
        also = self._off(change[more], names)
        return len(first) + len(more), max(off[0], also[0]), max(off[1], also[1])

    def _off(self, change: FloatArray, names: tuple[str, ...]) -> tuple[float, float]:
        """By how much of its tolerance an error of draws (k, p) that are run in full differs at most from what the
        expansion says of it, and by how much the share that is used does."""
        assert self.expansion is not None
        told = np.array(change)
        told[:, self.unsure.named("springs", "model")] = 0.0  # which no set-up says
        said, found, setup = self.expansion.errors(told), self._runs(told, "Draws in full"), self.unsure.setup
        known = [name for name in names if np.isfinite(said[name]).all()]
        differ = [np.abs(found[name] - said[name]) / setup.limits[name] for name in known]
        used = np.abs(share_of(self.measure, setup, found) - share_of(self.measure, setup, said))
        return float(np.nan_to_num(differ, nan=np.inf).max()), float(np.nan_to_num(used, nan=np.inf).max())

    def tornado(self, variance: float) -> Tornado:
        """Each input alone at the ends of its 95 % interval; its part of the variance by three points."""
        inputs, far = self.unsure.inputs, quantile(None)
        alone = np.array([self.unsure.alone(i) for i in range(len(inputs))])
        ends = np.concatenate([-far * alone, far * alone, np.zeros((1, len(inputs)))])
        share = share_of(self.measure, self.unsure.setup, self.errors(ends, "Each input alone"))
        low, high, here = share[: len(inputs)], share[len(inputs) : -1], share[-1]
        weight = 0.5 / far**2
        mean = weight * ((low - here) + (high - here))
        own = weight * ((low - here) ** 2 + (high - here) ** 2) - mean**2
        part = own / variance if variance > 0.0 else np.zeros(len(inputs))
        order = np.argsort(-np.nan_to_num(part, nan=np.inf), kind="stable")
        chosen = tuple(inputs[i] for i in order)
        return Tornado(chosen, frozen(low[order]), frozen(high[order]), frozen(part[order]))


def _findings(
    unsure: Unsure, expansion: Expansion | None, checked: tuple[int, float, float], again: float
) -> tuple[Finding, ...]:
    """What a reader of the numbers must know."""
    said = []
    if expansion is None:
        text = (
            "Every draw is a run in full: force and deflection are coupled, or the path is not reached in some of them."
        )
        said.append(Finding("info", text, code=IN_FULL))
    if checked[1] > AGREES:
        how, used = (format_percent(off) if np.isfinite(off) else "all" for off in checked[1:])
        text = (
            f"Of {checked[0]} draws that were run in full, too, an error of wall, floor or tip differs by up to {how} "
            f"of its tolerance, and what is used of the tolerance by up to {used}: the spread is too wide to be "
            "expanded, or what a gauge reads does not go with the tip there."
        )
        said.append(Finding("warning", text, code=DIFFERS))
    if again > AGREES:
        text = (
            f"{format_percent(again)} of the draws were drawn again, since a compliance or a coefficient would have "
            "changed its sign: what they stand for is not normal."
        )
        said.append(Finding("warning", text, code=REDRAWN))
    known, robot = unsure.known, unsure.setup.robot
    if known is not None and not np.allclose(known.parameters[: robot.n], robot.C_theta, rtol=0.01, atol=0.0):
        text = "How sure the compliances are was found for others than are in force here."
        said.append(Finding("warning", text, code=OTHERS))
    return (*said, *(known_notes(unsure.setup) if known is None else ()))
