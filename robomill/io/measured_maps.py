"""Measured compliance maps to and from the [measured_map] table of a set-up."""

from typing import Any

import numpy as np

from robomill.files import TABLE
from robomill.identification.measured_field import MeasuredField
from robomill.io.beside import Beside
from robomill.io.load_tests import read_measured_map
from robomill.io.tables import Table, shown
from robomill.provenance import Provenance
from robomill.robot.model import Robot


def map_from_table(table: Table, robot: Robot, beside: Beside) -> MeasuredField:
    """A map from its ``file`` of measurements, or from the points and matrices in the table itself."""
    if table.has("file"):
        data, name = beside.read(table, "file", TABLE)
        field = read_measured_map(data, robot, name)
    else:
        p = table.rows("p_mm", 3, "mm")
        C = table.rows("C_m_N", 9, "m/N", len(p)).reshape(-1, 3, 3)
        AB = table.rows("tilt_deg", 2, "deg", len(p))
        reach, made = table.number("reach_m", "m", 0.0), _provenance(table)
        given = table.has("stderr_m_N")
        stderr = table.rows("stderr_m_N", 9, "m/N", len(p)).reshape(-1, 3, 3) if given else None
        field = MeasuredField(p, C, AB, reach, made, stderr)  # type: ignore[arg-type]
    table.finish()
    return field


def _provenance(table: Table) -> Provenance:
    """Of the map; files of older versions say ``source`` and ``synthetic``."""
    if table.has("provenance"):
        return table.provenance("provenance")
    return Provenance("synthetic" if table.flag("synthetic", False) else "measured", table.text("source", ""))


def map_to_table(field: MeasuredField) -> dict[str, Any]:
    """The table that ``map_from_table`` reads back to the same map."""

    def rows(values: Any, unit: str) -> list[list[float]]:
        return [[shown(v, unit) for v in row] for row in np.asarray(values)]

    data = {
        "p_mm": rows(field.p, "mm"),
        "C_m_N": rows(field.C.reshape(-1, 9), "m/N"),
        "tilt_deg": rows(field.AB, "deg"),
        "reach_m": shown(field.reach, "m"),
        "provenance": {"kind": field.provenance.kind, "source": field.provenance.source},
    }
    if np.isfinite(field.stderr).all():
        data["stderr_m_N"] = rows(field.stderr.reshape(-1, 9), "m/N")
    return data
