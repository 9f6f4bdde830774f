"""What a remedy is to make small: the errors that the verdict judges, and how far each goes with the tip."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Literal, get_args

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.errors import SetupError
from robomill.improve.makers import made
from robomill.simulation.judging.gauge import Readings
from robomill.simulation.judging.verdict_words import NO_NUMBER
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup, check_setup
from robomill.toolpath.source import wanted_of
from robomill.values import ReadOnly

Measure = Literal["verdict", "wall", "floor", "tip"]
MEASURES: tuple[Measure, ...] = get_args(Measure)


@dataclass(frozen=True, eq=False)
class Judged(ReadOnly):
    """Errors (q, d) m of a run beside samples (q,) of its path, each with its tolerance (q,) m: signed (d is 1), or the
    size of a vector of d components. They go by ``way`` (q, 2, d, 3) with the feed, feed-normal and axial deviations of
    the samples ``by`` (q, 2) that have made what is read there."""

    sample: IntArray
    error: FloatArray
    by: IntArray
    way: FloatArray
    tolerance: FloatArray

    @property
    def share(self) -> float:
        """The largest of the tolerance; NaN where nothing is judged."""
        return float(self.shares(self.error).max(initial=0.0)) if len(self.sample) else float("nan")

    def shares(self, error: FloatArray) -> FloatArray:
        """(q,) of the tolerance, of errors (q, d) m."""
        return np.asarray(np.linalg.norm(error, axis=1) / self.tolerance)

    def along(self, vectors: FloatArray) -> FloatArray:
        """(q, d, ...) m: how far the errors go by ``vectors`` (m, 3, ...) m along feed, feed-normal and axis, one a
        sample."""
        return np.asarray(np.einsum("qbdk,qbk...->qd...", self.way, vectors[self.by]))


def check_improvable(setup: Any) -> None:
    """Raises SetupError for what is no set-up, and for a program that was corrected: remedies are those of the path
    that was meant."""
    check_setup(setup)
    made_of = wanted_of(setup.source) or getattr(setup.source, "mark", None)
    if made_of is None:
        return
    name = made_of.name
    raise SetupError(f"This program is corrected already: ask this of the program that it was made of, {name}.")


def check_numbered(run: SimulationResult, to: str) -> None:
    """Raises SetupError, with what there is no number ``to``, where not all of a cut is judged: also where the rest is
    out of tolerance already, for that can be mended, and what is not known would then be green."""
    if run.verdict.level in NO_NUMBER or run.not_judged.any() or run.rapids:
        raise SetupError(f"There is no number to {to}: {run.verdict.sentence}")


def check_joints_known(setup: SimulationSetup, to: str) -> None:
    """Raises SetupError, with what was to be done, where a measured map is in force, which knows of no joint."""
    if setup.measured_map is not None:
        text = "The compliance of this set-up is a measured map, in which no joint is known: take the map out "
        raise SetupError(f"{text}([measured_map]) {to}.", where="measured_map")


def judged(result: SimulationResult, measure: Measure = "verdict", tolerance: float | None = None) -> Judged:
    """What ``measure`` judges of a run: "verdict" what its verdict does (walls and floors, ends and the way along the
    feed where they have a tolerance; the tip where no wall and no floor is left), "wall", "floor", or "tip", the size
    of the tip's deviation. ``tolerance`` (m) stands for those of the set-up. Raises SetupError for another name.
    """
    if measure not in MEASURES:
        raise SetupError(f"Measure: found {measure!r:.40}, expected {', '.join(MEASURES)}.", where="measure")
    setup, gauge = result.setup, result.gauge
    limits = setup.limits if tolerance is None else dict.fromkeys(("wall", "floor", "tip"), tolerance)
    parts = []
    if measure in ("verdict", "wall"):
        parts.append(_of(gauge.walls, limits["wall"], result))
    if measure in ("verdict", "floor"):
        parts.append(_of(gauge.floors, limits["floor"], result))
    if measure == "verdict" and setup.feed_tolerance is not None:
        parts += [_of(gauge.ends, setup.feed_tolerance, result), _along(result, setup.feed_tolerance)]
    if any(len(part.sample) for part in parts):
        return Judged(*(np.concatenate([getattr(part, each.name) for part in parts]) for each in fields(Judged)))
    i = np.flatnonzero(result.judged)
    if measure in ("wall", "floor"):
        i = i[:0]
    return _at(i, result.delta_in_cut[i], np.eye(3), limits["tip"])


def _of(found: Readings, tolerance: float, result: SimulationResult) -> Judged:
    told = made(found, result)
    limits = np.full(len(found.sample), tolerance)
    return Judged(found.sample, found.error[:, None], told.by, told.way[:, :, None], limits)


def _along(result: SimulationResult, tolerance: float) -> Judged:
    i = np.flatnonzero(result.judged_along)
    return _at(i, result.delta_in_cut[i, :1], np.array([[1.0, 0.0, 0.0]]), tolerance)


def _at(i: IntArray, error: FloatArray, way: FloatArray, tolerance: float) -> Judged:
    """Of the tip itself at samples i (q,), which go one ``way`` (d, 3)."""
    ways = np.zeros((len(i), 2, *way.shape))
    ways[:, 1] = way
    return Judged(i, error, np.repeat(i[:, None], 2, axis=1), ways, np.full(len(i), tolerance))
