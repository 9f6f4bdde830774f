"""Measured compliance maps to and from the [measured_map] table of a set-up."""

from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.files import TABLE
from robomill.identification.measured_field import MeasuredField
from robomill.io.beside import Beside
from robomill.io.measured.load_tests import read_measured_map
from robomill.io.samples import find_sample
from robomill.io.tables import Table
from robomill.provenance import Provenance
from robomill.robot.model import Robot


def map_from_table(table: Table, robot: Robot, beside: Beside) -> MeasuredField:
    """A map from its ``file`` of measurements (or a sample's name), or from the points and matrices in the table."""
    if table.has("file"):
        sample = find_sample("load tests", table.text("file"))
        data, name = beside.read(table, "file", TABLE) if sample is None else (sample.read_bytes(), sample.name)
        field = read_measured_map(data, robot, name)
    else:
        p = _rows(table, "p", 3, ("m", "mm"))
        C = table.rows("C_m_N", 9, "m/N", len(p)).reshape(-1, 3, 3)
        AB = _rows(table, "tilt", 2, ("rad", "deg"), len(p))
        reach, made = table.number("reach_m", "m", 0.0), _provenance(table)
        given = table.has("stderr_m_N")
        stderr = table.rows("stderr_m_N", 9, "m/N", len(p)).reshape(-1, 3, 3) if given else None
        field = MeasuredField(p, C, AB, reach, made, stderr)  # type: ignore[arg-type]
    table.finish()
    return field


def _rows(table: Table, stem: str, count: int, units: tuple[str, str], many: int | None = None) -> FloatArray:
    """Rows in SI as they are written, or in the unit of people's and older files."""
    unit = next((unit for unit in units if table.has(f"{stem}_{unit}")), units[1])
    return table.rows(f"{stem}_{unit}", count, unit, many)


def _provenance(table: Table) -> Provenance:
    """Of the map; files of older versions say ``source`` and ``synthetic``."""
    if table.has("provenance"):
        return table.provenance("provenance")
    return Provenance("synthetic" if table.flag("synthetic", False) else "measured", table.text("source", ""))


def map_to_table(field: MeasuredField) -> dict[str, Any]:
    """The table that ``map_from_table`` reads back to the same map: in SI, since not every number has one in mm or
    degrees that reads back to it."""
    data: dict[str, Any] = {
        "p_m": field.p.tolist(),
        "C_m_N": field.C.reshape(-1, 9).tolist(),
        "tilt_rad": field.AB.tolist(),
        "reach_m": field.reach,
        "provenance": field.provenance.record(),
    }
    if np.isfinite(field.stderr).all():
        data["stderr_m_N"] = field.stderr.reshape(-1, 9).tolist()
    return data
