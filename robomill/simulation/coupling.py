"""Force and deflection that depend on each other, iterated to a fixed point; what happened is part of the answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.errors import SetupError
from robomill.units import format_si

#: Changes that grow this many times in a row are taken for divergence.
PATIENCE = 3


@dataclass(frozen=True, eq=False)
class FixedPoint:
    """Outcome of ``fixed_point``.

    value        the fixed point, or the one-pass answer where there was none
    one_pass     the answer without coupling, from which the iteration started
    converged    whether the last change was within the tolerance
    iterations   how often ``step`` was evaluated
    changes      largest change of every iteration, in order
    contraction  last change over the one before; below 1 it closes in, NaN if there were fewer than two
    """

    value: FloatArray
    one_pass: FloatArray
    converged: bool
    iterations: int
    changes: tuple[float, ...]
    contraction: float

    @property
    def difference(self) -> float:
        """Largest difference of ``value`` to the one-pass answer (0 if that was kept)."""
        return _largest(self.value - self.one_pass)

    @property
    def sentence(self) -> str:
        """For the result, where the values are lengths in m."""
        count = f"{self.iterations} iteration{'' if self.iterations == 1 else 's'}"
        if self.converged:
            rate = "" if np.isnan(self.contraction) else f", each change {self.contraction:.2g} of the one before"
            return (
                f"Coupling converged after {count}{rate}; "
                f"it differs from one pass by at most {format_si(self.difference, 'um')}."
            )
        if not self.changes or not np.isfinite(self.changes[-1]):
            last = "the answer was lost (not a number)"
        else:
            last = f"the last change was {format_si(self.changes[-1], 'um')}"
            if not np.isnan(self.contraction):
                last += f", {self.contraction:.2g} of the one before"
        return f"Coupling does not converge: after {count} {last}; the one-pass answer is kept."


def fixed_point(
    step: Callable[[FloatArray], FloatArray], start: ArrayLike, tol: float, max_iter: int = 20
) -> FixedPoint:
    """Iterate x <- step(x) from ``start``, the one-pass answer, until no entry changes by more than ``tol``.

    ``step`` takes and gives arrays of one shape; entries that are NaN before and after (unreached) do not count.
    Gives up, keeping ``start``, when the changes grow ``PATIENCE`` times in a row, when a number becomes NaN or
    infinite, or after ``max_iter`` evaluations. Raises SetupError for a tolerance that is not greater than 0 or no
    iteration at all.
    """
    if not (tol > 0.0 and np.isfinite(tol)):
        raise SetupError(f"Coupling: the tolerance is {tol:g}; it must be greater than 0.", where="tolerance")
    if max_iter < 1:
        raise SetupError(f"Coupling: {max_iter} iterations; it takes at least 1.", where="max_iter")
    one_pass = x = np.array(start, dtype=np.float64)
    changes: list[float] = []
    iterations, grown, converged = 0, 0, False
    while iterations < max_iter and not converged and grown < PATIENCE:
        after = np.asarray(step(x), dtype=np.float64)
        iterations += 1
        changes.append(_largest(after - x, where=~(np.isnan(after) & np.isnan(x))))
        x = after
        if not np.isfinite(changes[-1]):
            break
        converged = changes[-1] <= tol
        grown = grown + 1 if len(changes) > 1 and changes[-1] >= changes[-2] else 0
    contraction = changes[-1] / changes[-2] if len(changes) > 1 and changes[-2] > 0.0 else np.nan
    return FixedPoint(x if converged else one_pass, one_pass, converged, iterations, tuple(changes), contraction)


def _largest(change: FloatArray, where: np.ndarray | None = None) -> float:
    """Largest size of the entries; NaN entries count as infinite unless excluded (by ``where``, or all if None)."""
    size = np.abs(change)
    counted = size[where] if where is not None else size[~np.isnan(size)]
    if not counted.size:
        return 0.0
    return float(np.max(np.where(np.isnan(counted), np.inf, counted)))
