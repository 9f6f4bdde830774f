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
    ``vector`` by which the tip is off, each (2,). NaN where the cut leaves none.

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

    @property
    def max(self) -> float:
        """m: the larger of wall and floor; where no surface is left to measure, that of the tip."""
        return self._larger(0)

    @property
    def largest(self) -> tuple[str, float]:
        """The name of what is largest, and m."""
        return largest(self.wall[0], self.floor[0], self.vector[0])

    @property
    def rms(self) -> float:
        """m: the same of the root mean squares over the length."""
        return self._larger(1)

    def share(self, setup: SimulationSetup) -> float:
        """The largest of the tolerance, each surface by its own; the tip's by that of walls where none is left."""
        limits = setup.limits
        used = np.array([self.wall[0] / limits["wall"], self.floor[0] / limits["floor"]])
        return float(np.nanmax(used) if np.isfinite(used).any() else self.vector[0] / limits["tip"])

    def _larger(self, which: int) -> float:
        surfaces = np.array([self.wall[which], self.floor[which]])
        return float(np.nanmax(surfaces) if np.isfinite(surfaces).any() else self.vector[which])

    def _said(self) -> str:
        return f"{format_si(self.max, 'mm', 4)} at most, {format_si(self.rms, 'mm', 4)} root mean square"


def largest(wall: float, floor: float, tip: float) -> tuple[str, float]:
    """The larger of a wall's and a floor's error, by name and size, m; that of the tip where there is neither."""
    sizes = [(abs(value), name) for name, value in (("wall", wall), ("floor", floor)) if np.isfinite(value)]
    size, name = max(sizes, default=(tip, "tip"))
    return name, size


def graver(one: Errors, other: Errors, setup: SimulationSetup) -> Errors:
    """The errors that use more of the tolerance."""
    return max(one, other, key=lambda errors: errors.share(setup))


def measured(run: SimulationResult) -> Gauge:
    """What a gauge reads on a run, of a long one at ``MEASURED`` of its samples and those that are most off."""
    return run.gauge if int(run.judged.sum()) <= MEASURED else gauge_at(run, MEASURED)


def level_of(run: SimulationResult) -> Level:
    """The verdict's level by what was ``measured`` on a run."""
    return judge(run, measured(run)).level


def errors_of(run: SimulationResult, gauge: Gauge | None = None) -> Errors:
    """What a run leaves, against the path that it is of; ``gauge`` is what was ``measured`` on it, if it was."""
    gauge = measured(run) if gauge is None else gauge
    return Errors(_size(gauge.walls), _size(gauge.floors), np.array([run.max_deviation, run.rms_deviation]))


def _size(found: Readings) -> FloatArray:
    """(2,) m: largest and root mean square over the length; NaN without any."""
    if not len(found.error):
        return np.full(2, np.nan)
    weight = found.length if found.length.sum() > 0.0 else np.ones(len(found.error))
    return np.array([np.abs(found.error).max(), np.sqrt(np.average(found.error**2, weights=weight))])
