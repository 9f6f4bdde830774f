"""Results as columns in display units: the table twin of each figure, and what CSV files hold."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from robomill.arrays import FloatArray
from robomill.progress import slices
from robomill.report.settled import settled
from robomill.simulation.result import SimulationResult
from robomill.units import from_si

Columns = dict[str, FloatArray]
# Of each section: what is told of it whatever its kind, and in which unit.
MEASURED = {
    **dict.fromkeys(("station", "width", "depth", "centre_offset", "floor_error"), "mm"),
    **dict.fromkeys(("wall_left_error", "wall_right_error"), "mm"),
    **dict.fromkeys(("wall_left_angle", "wall_right_angle"), "deg"),
    **dict.fromkeys(("wall_left_straightness", "wall_right_straightness", "flatness"), "mm"),
    "floor_tilt": "deg",
    **dict.fromkeys(("error_mean", "error_max", "error_rms"), "mm"),
    "slope": "deg",
}


def deviation_columns(result: SimulationResult) -> Columns:
    """Along the path: where, how far off in {M} and in the axes of the cut, by which joint, under which force; and
    whether a wall beside it is gone that should stand, or gives way.

    Under a measured map there are no joints: their model's shares would not add up to what was measured.
    """
    path = result.path
    columns: Columns = {
        "line": path.block.astype(float),
        "tool": path.tool.astype(float),
        "cutting": path.cutting.astype(float),
        "reached": result.reached.astype(float),
        "not_judged": result.not_judged.astype(float),
        "station_mm": from_si(path.s, "mm"),
    }
    columns |= _vectors("{axis}_M_mm", result.setup.in_base(path.p), "mm", "XYZ")
    columns |= _vectors("delta_{axis}_mm", result.delta, "mm")
    columns["deviation_mm"] = from_si(result.deviation, "mm")
    columns |= _vectors("{axis}_mm", result.delta_in_cut, "mm", ("feed", "wall", "floor"))
    columns |= _vectors("F_{axis}_N", result.F, "N")
    if result.setup.measured_map is None:
        for j, number in enumerate(result.setup.robot.joint_numbers):
            columns |= _vectors(f"joint{number}_{{axis}}_mm", result.delta_joint[:, j], "mm")
        for k, spring in enumerate(result.setup.springs):
            columns |= _vectors(f"{spring.name.replace(' ', '_')}_{{axis}}_mm", result.delta_spring[:, k], "mm")
    if result.sag is not None:
        columns |= _vectors("sag_{axis}_mm", result.sag.sum(axis=-2), "mm")
    for name, found in (("gone", result.gauge.gone), ("thin_wall", result.gauge.thin)):
        columns[name] = np.isin(np.arange(len(path)), found).astype(float)
    return columns


def _vectors(name: str, values: FloatArray, unit: str, axes: Sequence[str] = "xyz") -> Columns:
    """A column for each component of values (m, 3), named by its axis."""
    return {name.format(axis=axis): from_si(values[:, i], unit) for i, axis in enumerate(axes)}


def section_columns(result: SimulationResult) -> dict[str, FloatArray | NDArray[np.str_]]:
    """What the default stations are and what is measured there; NaN where a kind has no such measure."""
    sections = result.sections
    numbers = {
        f"{name}_{unit}": from_si(np.array([getattr(s, name) for s in sections]), unit)
        for name, unit in MEASURED.items()
    }
    return {"station_mm": numbers.pop("station_mm"), "kind": np.array([s.kind for s in sections]), **numbers}


def csv_text(columns: Mapping[str, FloatArray | NDArray[np.str_]]) -> str:
    """Columns as CSV, those of numbers ``settled``; NaN is an empty cell."""
    shown = [settled(column) if column.dtype.kind == "f" else column for column in columns.values()]
    lines = [",".join(columns)]
    for some in slices(min(map(len, shown), default=0), "Rows"):
        cells = [[_cell(v) for v in column[some].tolist()] for column in shown]
        lines += [",".join(row) for row in zip(*cells, strict=True)]
    return "\n".join(lines) + "\n"


def _cell(value: float | str) -> str:
    if isinstance(value, str):
        return value
    return "" if math.isnan(value) else f"{value:.9g}"
