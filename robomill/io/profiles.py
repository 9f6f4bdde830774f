"""A measured groove profile from a CSV file: station along the groove against centre offset."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from robomill.arrays import FloatArray, frozen
from robomill.errors import SurfaceError
from robomill.units import UNITS, format_value, to_si

STATION_NAMES = ("station", "s", "x", "length", "distance")
OFFSET_NAMES = ("offset", "centre_offset", "center_offset", "deviation", "y", "dy")
LENGTHS = ("mm", "um", "m", "in")


@dataclass(frozen=True, eq=False)
class MeasuredProfile:
    """station (q,) m along the groove, rising; offset (q,) m of its centre, left of the feed positive."""

    name: str
    station: FloatArray
    offset: FloatArray
    findings: tuple[str, ...] = ()


def read_profile(source: str | Path, *, name: str = "") -> MeasuredProfile:
    """Read a CSV with columns like ``station_mm, offset_mm`` (units mm, um, m or in); source is a path or the text.

    Rows may come in any order; lines that start with # are comments. Raises SurfaceError with the line for a
    missing column, text or a gap where a number is due, a repeated station, or fewer than two rows.
    """
    text, label = _text(source, name)
    rows = [
        (n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip() and not line.lstrip().startswith("#")
    ]
    if not rows:
        raise SurfaceError(f"{label}: the file holds no rows; expected columns such as station_mm, offset_mm.")
    delimiter = ";" if ";" in rows[0][1] else ("\t" if "\t" in rows[0][1] else ",")
    table = [(n, next(csv.reader([line], delimiter=delimiter))) for n, line in rows]
    header = [cell.strip().lower() for cell in table[0][1]]
    columns = [_column(header, names, label) for names in (STATION_NAMES, OFFSET_NAMES)]
    values = [[_number(cells, column, n, label) for column, _ in columns] for n, cells in table[1:]]
    if len(values) < 2:
        raise SurfaceError(f"{label}: found {len(values)} measured rows; a profile needs at least two.")
    raw = np.array(values)
    station, offset = (to_si(raw[:, i], columns[i][1]) for i in range(2))
    order = np.argsort(station, kind="stable")
    repeated = np.flatnonzero(np.diff(station[order]) <= 0)
    if len(repeated):
        row = order[repeated[0] + 1]
        where = format_value(float(raw[row, 0]), columns[0][1])
        raise SurfaceError(f"{label}, line {table[row + 1][0]}: the station {where} is there twice; keep one.")
    return MeasuredProfile(label, frozen(station[order]), frozen(offset[order]), _findings(label, offset))


def _text(source: str | Path, name: str) -> tuple[str, str]:
    if isinstance(source, Path) or ("\n" not in source and len(source) < 1000 and Path(source).is_file()):
        path = Path(source)
        try:
            return path.read_text(encoding="utf-8-sig"), name or path.name
        except UnicodeDecodeError as exc:
            raise SurfaceError(f"{path.name}: this is not a text file; expected a CSV table.") from exc
        except OSError as exc:
            raise SurfaceError(f"{path.name}: the file cannot be read ({exc.strerror}).") from exc
    return source.lstrip("\ufeff"), name or "profile"


def _column(header: list[str], names: tuple[str, ...], label: str) -> tuple[int, str]:
    for n, cell in enumerate(header):
        stem, _, unit = cell.rpartition("_")
        if stem in names and unit in LENGTHS:
            return n, unit
    found = ", ".join(header)
    raise SurfaceError(
        f"{label}: no column {names[0]}_mm found among '{found:.80}'; name the columns with their unit, such as"
        f" station_mm and offset_mm (units: {', '.join(LENGTHS)})."
    )


def _number(cells: list[str], column: int, line: int, label: str) -> float:
    cell = cells[column].strip() if column < len(cells) else ""
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        shown = f"'{cell:.30}'" if cell else "an empty cell"
        raise SurfaceError(f"{label}, line {line}: expected a number, found {shown}.", where=f"line {line}")
    return value


def _findings(label: str, offset: FloatArray) -> tuple[str, ...]:
    largest = float(np.abs(offset).max())
    if largest > to_si(20.0, "mm"):
        shown = format_value(largest / UNITS["mm"].factor, "mm", 1)
        return (f"{label}: an offset of {shown} is far more than a groove can be off; check the unit of the column.",)
    return ()
