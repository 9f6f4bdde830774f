"""A run as columns in display units: the table twin of each figure, and what CSV files and DataFrames hold."""

from collections.abc import Sequence

import numpy as np

from robomill.arrays import FloatArray
from robomill.frames import Columns
from robomill.simulation.judging.gauge import Gauge
from robomill.simulation.judging.seen import Run
from robomill.units import from_si


def path_columns(result: Run, gauge: Gauge) -> Columns:
    """Along the path: where, how far off in {M} and in the axes of the cut, by which joint, under which force; and
    whether a wall beside it is gone that should stand, or gives way.

    Under a measured map there are no joints: their model's shares would not add up to what was measured.
    """
    path = result.path
    columns: Columns = {
        path.block_name: path.block,
        "tool": path.tool,
        "cutting": path.cutting,
        "reached": result.reached,
        "not_judged": result.not_judged,
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
    if result.ahead is not None:
        columns |= _vectors("ahead_{axis}_mm", result.ahead, "mm")
    if result.sag is not None:
        columns |= _vectors("sag_{axis}_mm", result.sag.sum(axis=-2), "mm")
    for name, found in (("gone", gauge.gone), ("thin_wall", gauge.thin)):
        columns[name] = np.isin(np.arange(len(path)), found)
    return columns


def _vectors(name: str, values: FloatArray, unit: str, axes: Sequence[str] = "xyz") -> Columns:
    """A column for each component of values (m, 3), named by its axis."""
    return {name.format(axis=axis): from_si(values[:, i], unit) for i, axis in enumerate(axes)}
