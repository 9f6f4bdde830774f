"""Which points of its parameters a study has: a full grid, a Latin hypercube, or Sobol's sequence."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal, get_args

import numpy as np
from scipy import stats

from robomill.arrays import FloatArray
from robomill.errors import StudyError
from robomill.units import format_count

Kind = Literal["grid", "latin_hypercube", "sobol"]
KINDS: tuple[Kind, ...] = get_args(Kind)
MOST = 10_000_000  # points
TAIL = 1e-9  # of a distribution, that nothing is drawn from
# Of each distribution what it is stated by.
DISTRIBUTIONS = {
    "normal": ("mean", "std"),
    "uniform": ("low", "high"),
    "triangular": ("low", "mode", "high"),
    "lognormal": ("median", "factor"),
}


@dataclass(frozen=True)
class Parameter:
    """A number of a set-up by its ``key``, and what it takes: ``values`` (a list), a range from ``low`` to ``high`` (by
    equal ratios where ``log``), or a ``distribution`` with its numbers ``stated``; ``steps`` of it are on a grid."""

    key: str
    values: tuple[Any, ...] = ()
    low: float = math.nan
    high: float = math.nan
    steps: int = 0
    log: bool = False
    distribution: str = ""
    stated: tuple[float, ...] = ()

    def at(self, u: FloatArray) -> list[Any]:
        """What it is at shares ``u`` (k,) of its range, its list, or its distribution."""
        if self.values:
            return [self.values[min(int(each * len(self.values)), len(self.values) - 1)] for each in u]
        if self.distribution:
            return [float(value) for value in self._quantiles(np.clip(u, TAIL, 1.0 - TAIL))]
        if self.log:
            return [float(value) for value in self.low * (self.high / self.low) ** u]
        return [float(value) for value in self.low + (self.high - self.low) * u]

    def _quantiles(self, u: FloatArray) -> FloatArray:
        if self.distribution == "normal":
            mean, std = self.stated
            return np.asarray(stats.norm.ppf(u, mean, std))
        if self.distribution == "lognormal":
            median, factor = self.stated
            return np.asarray(median * factor ** stats.norm.ppf(u))
        if self.distribution == "triangular":
            low, mode, high = self.stated
            return np.asarray(stats.triang.ppf(u, (mode - low) / (high - low), low, high - low))
        low, high = self.stated
        return np.asarray(low + (high - low) * u)

    def levels(self) -> list[Any]:
        """What it takes on a grid: of a distribution the middles of parts of equal probability."""
        if self.values:
            return list(self.values)
        if self.distribution:
            return self.at((np.arange(self.steps) + 0.5) / self.steps)
        ends = self.at(np.linspace(0.0, 1.0, self.steps))
        return [*ends[:-1], self.high] if self.steps > 1 else ends

    @property
    def tried(self) -> list[Any]:
        """Some values by which its key is checked."""
        return list(self.values) if self.values else self.at(np.array([0.5, 0.0, 1.0]))


def points(parameters: tuple[Parameter, ...], kind: Kind, count: int, seed: int) -> list[list[Any]]:
    """The points, each with one value a parameter. Raises StudyError for more than there may be."""
    if kind == "grid":
        levels = [each.levels() for each in parameters]
        if math.prod(map(len, levels)) > MOST:
            raise StudyError(
                f"Study: the grid has {format_count(math.prod(map(len, levels)))} points, expected at most "
                f"{format_count(MOST)}."
            )
        return [list(point) for point in product(*levels)]
    rng = np.random.default_rng(seed)
    if kind == "sobol":
        sampler: Any = stats.qmc.Sobol(len(parameters), rng=rng)
        u = sampler.random_base2(max(count - 1, 0).bit_length())[:count]
    else:
        u = stats.qmc.LatinHypercube(len(parameters), rng=rng).random(count)
    columns = [each.at(u[:, i]) for i, each in enumerate(parameters)]
    return [list(point) for point in zip(*columns, strict=True)]
