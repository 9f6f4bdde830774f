"""Results as columns in display units: the table twin of each figure, and what CSV files hold."""

from __future__ import annotations

import numpy as np

from robomill.arrays import FloatArray
from robomill.simulation.result import SimulationResult
from robomill.units import from_si

Columns = dict[str, FloatArray]


def deviation_columns(result: SimulationResult) -> Columns:
    """Along the path: where, how far off in {M}, by which joint, under which force."""
    path = result.path
    p_M = result.setup.in_base(path.p)
    columns: Columns = {
        "line": path.block.astype(float),
        "cutting": path.cutting.astype(float),
        "reached": result.reached.astype(float),
        "station_mm": from_si(path.s, "mm"),
    }
    for i, axis in enumerate("xyz"):
        columns[f"{axis.upper()}_M_mm"] = from_si(p_M[:, i], "mm")
    for i, axis in enumerate("xyz"):
        columns[f"delta_{axis}_mm"] = from_si(result.delta[:, i], "mm")
    columns["deviation_mm"] = from_si(result.deviation, "mm")
    for i, axis in enumerate("xyz"):
        columns[f"F_{axis}_N"] = result.F[:, i]
    for j, number in enumerate(result.setup.robot.joint_numbers):
        for i, axis in enumerate("xyz"):
            columns[f"joint{number}_{axis}_mm"] = from_si(result.delta_joint[:, j, i], "mm")
    for k, spring in enumerate(result.setup.springs):
        for i, axis in enumerate("xyz"):
            columns[f"{spring.name.replace(' ', '_')}_{axis}_mm"] = from_si(result.delta_spring[:, k, i], "mm")
    return columns


def section_columns(result: SimulationResult) -> Columns:
    """The groove's dimensions at the default stations."""
    sections = result.sections
    names = ("station", "width", "depth", "centre_offset", "floor_error")
    return {f"{name}_mm": from_si(np.array([getattr(s, name) for s in sections]), "mm") for name in names}


def csv_text(columns: Columns) -> str:
    """Columns as CSV; NaN is an empty cell."""
    rows = np.column_stack(list(columns.values()))
    lines = [",".join(columns)]
    lines += [",".join("" if np.isnan(v) else f"{v:.9g}" for v in row) for row in rows]
    return "\n".join(lines) + "\n"
