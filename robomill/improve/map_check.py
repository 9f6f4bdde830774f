"""Whether the coarse map of places may be trusted: some are simulated in full, and where these are off, more are."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robomill.arrays import FloatArray
from robomill.improve.placed import Place
from robomill.progress import step

AGREES = 0.01  # of its share: by how much the screen may differ from the full simulation
LONG = 2000  # samples of a path beyond which few full runs are made
PROBES, MANY = 8, 64  # places that are looked at, and where one of them is off


def agrees(full: float, mapped: float) -> bool:
    """Whether the share of a full simulation is the one that a map has."""
    return abs(full - mapped) <= AGREES * full


def checked(
    simulated: Callable[[FloatArray], Place], places: FloatArray, share: FloatArray, spacing: FloatArray
) -> dict[int, Place]:
    """Places (k, 4) that were simulated in full, by their number, where the map is off: what passes leave of one
    another, as at corners, is not of first order in how the tip moves. None where the map may be trusted.

    The ``share`` (k,) of the tolerance that the map has (NaN: no place) is mended by them: each place by as much as the
    one nearest to it, in steps ``spacing`` (4,), was off.
    """
    from scipy.spatial import cKDTree

    allowed = np.flatnonzero(np.isfinite(share))
    order = allowed[np.argsort(share[allowed], kind="stable")]
    full: dict[int, Place] = {}

    def look_at(some: list[int], said: str) -> list[int]:
        for k, i in enumerate(some):
            with step(k, len(some), said):
                full[i] = simulated(places[i])
        return [i for i in some if full[i].known]

    few = look_at(_spread(order, PROBES), "The map is checked")
    if all(agrees(full[i].share, share[i]) for i in few):
        return {}
    look_at([i for i in _spread(allowed, MANY) if i not in full], "The map is mended by full simulations")
    known = [i for i in full if full[i].known]
    off = np.array([full[i].share - share[i] for i in known])
    scale = np.where(spacing > 0.0, spacing, 1.0)
    share[allowed] += off[cKDTree(places[known] / scale).query(places[allowed] / scale)[1]]
    return full


def _spread(numbers: np.ndarray, most: int) -> list[int]:
    """So ``most`` of ``numbers``, in even steps with both ends."""
    at = np.linspace(0, len(numbers) - 1, min(most, len(numbers)))
    return [int(i) for i in numbers[np.unique(np.round(at).astype(np.int64))]]
