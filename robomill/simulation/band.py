"""How sure the deviation of a run is: the deflection along its path with the covariance of what is known."""

from dataclasses import fields, replace
from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.identification.fit.confidence import LEVEL
from robomill.identification.knowledge import Knowledge
from robomill.identification.measured_field import MeasuredField
from robomill.identification.propagation import Uncertain, uncertain_by_map, uncertain_deflection
from robomill.simulation.result import SimulationResult
from robomill.simulation.tools import held


def deviation_band(result: SimulationResult, known: Knowledge, at: int | None = None) -> Uncertain:
    """The deflection along the path (or at sample ``at``) with its covariance, by linear propagation.

    Where a measured map is in force it is the map's own uncertainty, not that of the joints' compliances.
    """
    chosen = slice(None) if at is None else at
    setup = result.setup
    if setup.measured_map is not None:
        return _band_of_map(result, setup.measured_map, chosen, known.F)
    tools = list(held(setup, result.path))
    if at is not None:
        tools = [tool for tool in tools if tool.steps[at]]
    if len(tools) == 1:
        return uncertain_deflection(tools[0].robot, result.theta[chosen], result.F[chosen], known)
    parts = [(tool.steps, uncertain_deflection(tool.robot, result.theta, result.F, known)) for tool in tools]
    return _joined(parts)


def _band_of_map(
    result: SimulationResult, field: MeasuredField, chosen: slice | int, force: FloatArray | None = None
) -> Uncertain:
    return uncertain_by_map(field, result.setup.in_base(result.path.p[chosen]), result.F[chosen], force)


def _joined(parts: list[tuple[BoolArray, Uncertain]]) -> Uncertain:
    """At each step what its own tool's part says."""
    whole = parts[0][1]
    arrays = [each.name for each in fields(whole) if isinstance(getattr(whole, each.name), np.ndarray)]
    values: dict[str, Any] = {name: np.array(getattr(whole, name)) for name in arrays}
    for steps, part in parts[1:]:
        for name in arrays:
            values[name][steps] = getattr(part, name)[steps]
    return replace(whole, **values)


def size_band(result: SimulationResult, band: Uncertain, at: int | None = None) -> FloatArray:
    """Half the 95 % interval (...) m of the deviation's size: of its component along the deviation itself."""
    delta = result.delta if at is None else result.delta[at]
    with np.errstate(invalid="ignore", divide="ignore"):
        along = delta / np.linalg.norm(delta, axis=-1, keepdims=True)
    return band.half_along(along, LEVEL)


def worst_half(result: SimulationResult, known: Knowledge | None) -> float:
    """Half the 95 % interval of the largest deviation at feed, m; NaN where nothing is known of it."""
    i, field = result.worst, result.setup.measured_map
    if i >= 0 and known is not None:
        return float(size_band(result, deviation_band(result, known, i), i))
    if i >= 0 and field is not None:
        return float(size_band(result, _band_of_map(result, field, i), i))
    return float("nan")
