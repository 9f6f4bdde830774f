"""How sure the deviation of a run is: the deflection along its path with the covariance of what is known."""

from __future__ import annotations

import numpy as np

from robomill.arrays import FloatArray
from robomill.identification.knowledge import Knowledge
from robomill.identification.propagation import Uncertain, uncertain_deflection
from robomill.simulation.result import SimulationResult

LEVEL = 0.95


def deviation_band(result: SimulationResult, known: Knowledge, at: int | None = None) -> Uncertain:
    """The deflection along the path (or at sample ``at``) with its covariance, by linear propagation."""
    chosen = slice(None) if at is None else at
    return uncertain_deflection(result.setup.robot, result.theta[chosen], result.F[chosen], known)


def size_band(result: SimulationResult, band: Uncertain, at: int | None = None) -> FloatArray:
    """Half the 95 % interval (...) m of the deviation's size: of its component along the deviation itself."""
    delta = result.delta if at is None else result.delta[at]
    with np.errstate(invalid="ignore", divide="ignore"):
        along = delta / np.linalg.norm(delta, axis=-1, keepdims=True)
    return band.half_along(along, LEVEL)


def worst_half(result: SimulationResult, known: Knowledge | None) -> float:
    """Half the 95 % interval of the largest deviation at feed, m; NaN where nothing is known of it."""
    if known is None or result.worst < 0:
        return float("nan")
    return float(size_band(result, deviation_band(result, known, result.worst), result.worst))
