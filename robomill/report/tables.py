"""Results as columns in display units: the table twin of each figure, and what CSV files hold."""

from collections.abc import Sequence

import numpy as np

from robomill.arrays import FloatArray
from robomill.progress import slices
from robomill.simulation.result import SimulationResult
from robomill.units import from_si

Columns = dict[str, FloatArray]
MEASURED = ("station", "width", "depth", "centre_offset", "floor_error")  # of each section of the groove


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


def section_columns(result: SimulationResult) -> Columns:
    """The groove's dimensions at the default stations."""
    sections = result.sections
    return {f"{name}_mm": from_si(np.array([getattr(s, name) for s in sections]), "mm") for name in MEASURED}


def csv_text(columns: Columns) -> str:
    """Columns as CSV; NaN is an empty cell."""
    rows = np.column_stack(list(columns.values()))
    lines = [",".join(columns)]
    for some in slices(len(rows), "Rows"):
        lines += [",".join("" if np.isnan(v) else f"{v:.9g}" for v in row) for row in rows[some]]
    return "\n".join(lines) + "\n"
