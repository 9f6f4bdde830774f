"""A measured groove profile from a CSV file: station along the groove against centre offset."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from robomill.arrays import FloatArray, frozen
from robomill.errors import SurfaceError
from robomill.io.columns import Layout, read_columns
from robomill.units import format_si, to_si

LENGTHS = ("mm", "um", "m", "in")
LAYOUT = Layout(
    "Profile",
    SurfaceError,
    {"station": LENGTHS, "offset": LENGTHS},
    "station_mm,offset_mm",
    fewest=2,
    aliases=dict.fromkeys(("s", "x", "length", "distance"), "station")
    | dict.fromkeys(("centre_offset", "center_offset", "deviation", "y", "dy"), "offset"),
)
# An offset larger than this was hardly measured on a groove.
CREDIBLE_MM = 20.0


@dataclass(frozen=True, eq=False)
class MeasuredProfile:
    """station (q,) m along the groove, rising; offset (q,) m of its centre, left of the feed positive."""

    name: str
    station: FloatArray
    offset: FloatArray
    findings: tuple[str, ...] = ()


def read_profile(source: str | Path | bytes, *, name: str = "") -> MeasuredProfile:
    """Read a CSV with columns like ``station_mm, offset_mm`` (units mm, um, m or in).

    ``source`` is a path, the text or its bytes.

    Rows may come in any order. Raises SurfaceError with file, row and column for a missing column, text or a gap where
    a number is due, a repeated station, or fewer than two rows.
    """
    table, name = read_columns(source, LAYOUT, name)
    for quantity in LAYOUT.units:
        if quantity not in table:
            raise table.place.refuse(
                f"no column {quantity}_mm found; name the columns with their unit, such as {LAYOUT.example} "
                f"(units: {', '.join(LENGTHS)})."
            )
    station, offset = table.values["station"], table.values["offset"]
    order = np.argsort(station, kind="stable")
    repeated = np.flatnonzero(np.diff(station[order]) <= 0)
    if len(repeated):
        k = int(order[repeated[0] + 1])
        where = format_si(station[k], table.known["station"].unit)
        raise table.refuse(k, "station", f"the station {where} is there twice; keep one.")
    label = name or LAYOUT.subject
    return MeasuredProfile(label, frozen(station[order]), frozen(offset[order]), _findings(label, offset))


def _findings(label: str, offset: FloatArray) -> tuple[str, ...]:
    largest = float(np.abs(offset).max())
    if largest > to_si(CREDIBLE_MM, "mm"):
        shown = format_si(largest, "mm", 1)
        return (f"{label}: an offset of {shown} is far more than a groove can be off; check the unit of the column.",)
    return ()
