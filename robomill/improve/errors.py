"""What a gauge finds on the part that a run leaves: its largest errors, and their root mean squares."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray
from robomill.simulation.judging.gauge import Gauge, Readings, gauge as gauge_at
from robomill.simulation.judging.verdict import judge
from robomill.simulation.judging.verdict_words import Level
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.units import format_si
from robomill.values import Value

MEASURED = 6000  # samples: of longer programs no more are measured, and those that are most off


@dataclass(frozen=True, eq=False, repr=False)
class Errors(Value):
    """What a gauge finds on the part, m: largest and root mean square of ``wall`` and ``floor`` errors and of the
    ``vector`` by which the tip is off, each (2,); ``feed`` is the largest along the feed, ends of cuts among it. NaN
    where the cut leaves none.

    Examples
    --------
    >>> import robomill as rm
    >>> found = rm.compensate(rm.load_setup("paper_flute"))
    >>> round(found.before.max * 1e3, 2), found.after.max < 0.01 * found.before.max
    (0.23, True)
    """

    wall: FloatArray
    floor: FloatArray
    vector: FloatArray
    feed: float = float("nan")

    @property
    def max(self) -> float:
        """m: the larger of wall and floor; where no surface is left to measure, that of the tip."""
        return self._larger(0)

    @property
    def rms(self) -> float:
        """m: the same of the root mean squares over the length."""
        return self._larger(1)

    def decides(self, setup: SimulationSetup) -> tuple[str, float]:
        """The name of what uses most of its tolerance, and m."""
        return deciding(setup, self.wall[0], self.floor[0], self.feed, self.vector[0])

    def share(self, setup: SimulationSetup) -> float:
        """The largest of the tolerance, as the verdict has it."""
        name, size = self.decides(setup)
        return float(size / setup.limits[name])

    def _larger(self, which: int) -> float:
        surfaces = np.array([self.wall[which], self.floor[which]])
        return float(np.nanmax(surfaces) if np.isfinite(surfaces).any() else self.vector[which])

    def _said(self) -> str:
        return f"{format_si(self.max, 'mm', 4)} at most, {format_si(self.rms, 'mm', 4)} root mean square"


def deciding(setup: SimulationSetup, wall: float, floor: float, feed: float, tip: float) -> tuple[str, float]:
    """Which error, m, uses most of its own tolerance, by name and size: a wall's, a floor's, and along the feed where
    that has one; the tip's where there is no wall and no floor, and nothing is known of the feed that has one."""
    found = {"wall": abs(wall), "floor": abs(floor)}
    if setup.feed_tolerance is not None:
        found["feed"] = abs(feed)
    known = {name: float(size) for name, size in found.items() if np.isfinite(size)}
    name = max(known, key=lambda each: known[each] / setup.limits[each], default="tip")
    return name, known.get(name, float(tip))


def graver(one: Errors, other: Errors, setup: SimulationSetup) -> Errors:
    """The errors that use more of the tolerance."""
    return max(one, other, key=lambda errors: errors.share(setup))


def is_measured_whole(run: SimulationResult) -> bool:
    """Whether a gauge reads every sample of a run, which is not so long."""
    return int(run.judged.sum()) <= MEASURED


def measured(run: SimulationResult) -> Gauge:
    """What a gauge reads on a run, of a long one at ``MEASURED`` of its samples and those that are most off."""
    return run.gauge if is_measured_whole(run) else gauge_at(run, MEASURED)


def level_of(run: SimulationResult) -> Level:
    """The verdict's level by what was ``measured`` on a run."""
    return run.verdict.level if is_measured_whole(run) else judge(run, measured(run)).level


def errors_of(run: SimulationResult, gauge: Gauge | None = None) -> Errors:
    """What a run leaves, against the path that it is of; ``gauge`` is what was ``measured`` on it, if it was."""
    gauge = measured(run) if gauge is None else gauge
    vector = np.array([run.max_deviation, run.rms_deviation])
    along = np.concatenate([run.delta_in_cut[run.judged_along, 0], gauge.ends.error])
    feed = float(np.abs(along).max()) if len(along) else float("nan")
    return Errors(_size(gauge.walls), _size(gauge.floors), vector, feed)


def _size(found: Readings) -> FloatArray:
    """(2,) m: largest and root mean square over the length; NaN without any."""
    if not len(found.error):
        return np.full(2, np.nan)
    weight = found.length if found.length.sum() > 0.0 else np.ones(len(found.error))
    return np.array([np.abs(found.error).max(), np.sqrt(np.average(found.error**2, weights=weight))])
