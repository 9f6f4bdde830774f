"""A path as a table of points, CSV or Parquet: x, y, z, and where it has them tool axis, feed, spindle, tool.

X_mm,Y_mm,Z_mm,feed_mm_min
0,0,-2,0
50,0,-2,1800

A feed is that of the move that ends at the point; 0 is a rapid. The first point is the start.
"""

import io
import math
from dataclasses import replace
from pathlib import Path, PurePath
from typing import Any

import numpy as np

from robomill.arguments import asked
from robomill.arrays import FloatArray
from robomill.errors import ToolpathError, UnitAskedError
from robomill.extras import needed
from robomill.files import POINTS, check_size, name_of, read_file
from robomill.io.columns import Columns, Layout, frame_columns, read_columns
from robomill.provenance import Finding
from robomill.spelled import one_of, to_give
from robomill.toolpath.path import FEED, MOST_FEED, Toolpath
from robomill.toolpath.source import PointsSource
from robomill.units import format_count, format_many, format_short, from_si, to_si, unit_label
from robomill.wording import listed

SUFFIXES = (".csv", ".parquet")
ASKED = {"mm": "mm/min", "in": "in/min", "cm": "mm/min", "m": "mm/min"}
"""Units that somebody may say of a file that is silent, each with that of its feeds."""
MOST_POINTS, MOST_VALUES = 2_000_000, 20_000_000  # rows, and numbers in all columns: a packed file may be next to none
PLACE, AXIS = ("x", "y", "z"), ("i", "j", "k")
FEEDS = ("mm/min", "mm/s", "in/min", "in/s")
UNITS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(PLACE, tuple(ASKED)),
    **dict.fromkeys(AXIS, ("1",)),
    "feed": FEEDS,
    "spindle": ("1/min",),
    "tool": ("1",),
}
ALIASES = {"k_x": "i", "k_y": "j", "k_z": "k", "f": "feed", "feedrate": "feed", "s": "spindle", "t": "tool"}
EXAMPLE = "X_mm,Y_mm,Z_mm,feed_mm_min"


@asked
def read_points(
    path: str | Path,
    *,
    unit: str = "",
    v_f: float | None = None,
    feed_mm_min: float | None = None,
) -> Toolpath:
    r"""A path from a table of points, CSV or Parquet.

    Parameters
    ----------
    path : str or Path
        The file; of CSV also its text. Headers with units: ``X_mm``, ``x [in]``, ``feed_mm_min``. Columns x, y, z are
        needed; i, j, k (tool axis, out of the part), feed, spindle and tool may be there, in any order.
    unit : str
        Of headers that name none: "mm", "in", "cm" or "m".
    v_f, feed_mm_min : float
        Feed of all moves, in m/s or mm/min, where the table has no column of feeds.

    Returns
    -------
    Toolpath
        In {W}. A feed is that of the move that ends at its point; where it is 0 the move is a rapid.

    Raises
    ------
    UnitAskedError
        A ToolpathError: the headers name no unit, and nobody has said one.
    ToolpathError
        Naming file, row and column.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.read_points("X_mm,Y_mm,Z_mm,feed_mm_min\n0,0,-2,0\n50,0,-2,1800\n")
    <Toolpath 2 points, 50.0 mm at feed within 50.0 x 0.0 x 0.0 mm>
    """
    feed = None
    if v_f is not None or feed_mm_min is not None:
        feed = float(FEED.settled(one_of(FEED, v_f, feed_mm_min, ToolpathError, "Points"), ToolpathError, "Points"))
    if isinstance(path, str) and "\n" in path:
        return _path(*read_columns(path, _layout(unit)), unit, feed)
    return points_from_bytes(read_file(path, POINTS, ToolpathError), name_of(path), unit, feed).path


def points_from_bytes(data: bytes, name: str, unit: str = "", v_f: float | None = None) -> PointsSource:
    """What a person dropped or named, as ``read_points``."""
    check_size(len(data), POINTS, ToolpathError, name)
    if v_f is not None and not 0.0 < v_f <= MOST_FEED:
        found = "no number" if math.isnan(v_f) else format_short(v_f, "mm/min")
        most = format_short(MOST_FEED, "mm/min")
        raise ToolpathError(
            f"{name}: the feed of all moves is {found}; expected more than 0, and at most {most}.", where="feed"
        )
    parquet = data.startswith(b"PAR1") or PurePath(name).suffix.lower() == ".parquet"
    columns, _ = _of_parquet(data, name, _layout(unit)) if parquet else read_columns(data, _layout(unit), name)
    return PointsSource(_path(columns, name, unit, v_f), name)


def _layout(unit: str) -> Layout:
    if unit and unit not in ASKED:
        raise ToolpathError(f"Points: the unit is {unit!r:.20}; expected one of {', '.join(ASKED)}.", where="unit")
    length = unit or "mm"
    silent = {**dict.fromkeys(PLACE, length), "feed": ASKED[length], "spindle": "1/min"}
    return Layout("Points", ToolpathError, UNITS, EXAMPLE, fewest=2, aliases=ALIASES, silent=silent)


def _of_parquet(data: bytes, name: str, layout: Layout) -> tuple[Columns, str]:
    """The columns that hold numbers, of a file whose size is looked at before it is unpacked."""
    with needed("Points as Parquet"):
        import pyarrow
        from pyarrow import parquet
    try:
        file = parquet.ParquetFile(io.BytesIO(data))
        if file.metadata.num_rows > MOST_POINTS:
            found = format_count(file.metadata.num_rows)
            raise ToolpathError(
                f"{name}: found {found} rows, expected {format_count(MOST_POINTS)} at most; split the file."
            )
        numbers = [each.name for each in file.schema_arrow if _is_number(pyarrow, each.type)]
        if len(numbers) * file.metadata.num_rows > MOST_VALUES:
            raise ToolpathError(
                f"{name}: found {format_count(len(numbers))} columns of "
                f"{format_count(file.metadata.num_rows)} numbers, "
                f"expected {format_count(MOST_VALUES)} numbers at most; leave out the columns that no path has."
            )
        frame = file.read(columns=numbers).to_pandas(ignore_metadata=True)
    except ToolpathError:
        raise
    except (pyarrow.ArrowException, OSError, ValueError) as exc:
        raise ToolpathError(
            f"{name}: this is no Parquet file, or one that is damaged ({exc!s:.60}); write the table again."
        ) from None
    try:
        return frame_columns(frame, layout)
    except ToolpathError as exc:
        raise ToolpathError(f"{name}: {exc}", where=exc.where) from None


def _is_number(pyarrow: Any, kind: Any) -> bool:
    return bool(pyarrow.types.is_integer(kind) or pyarrow.types.is_floating(kind))


def _path(columns: Columns, name: str, unit: str, v_f: float | None) -> Toolpath:
    place = name or "Points"
    missing = [axis for axis in PLACE if axis not in columns]
    if missing:
        raise ToolpathError(f"{place}: there is no column of {missing[0]}; expected {', '.join(PLACE)} ({EXAMPLE}).")
    _ask_unit(columns, place, unit)
    given: dict[str, Any] = {"k": _axis(columns, place)} if any(axis in columns for axis in AXIS) else {}
    if "feed" not in columns and v_f is None:
        raise ToolpathError(
            f"{place}: there is no column of feeds; add one (feed_mm_min), or "
            f"{to_give('feed_mm_min', 'say the feed of all moves')}.",
            where="feed",
        )
    if "spindle" in columns:
        given["n_s"] = columns.values["spindle"]
    if "tool" in columns:
        given["tool"] = _tools(columns)
    try:
        path = _from(columns, v_f, given)
    except ToolpathError as exc:
        told = str(exc) if name and str(exc).startswith(name) else f"{place}: {exc}"  # of a cell: with its file
        raise ToolpathError(told, where=exc.where) from None
    if not path.cutting.any():
        raise ToolpathError(f"{place}: no move has a feed, so nothing is cut; give the moves that cut a feed above 0.")
    return path


def _from(columns: Columns, v_f: float | None, given: dict[str, Any]) -> Toolpath:
    p = np.column_stack([columns.values[axis] for axis in PLACE])
    feed = columns.values["feed"] if "feed" in columns else np.full(len(p), v_f)
    for k in np.flatnonzero(feed < 0.0)[:1]:
        raise columns.refuse(int(k), "feed", "found a feed below 0; expected 0 (a rapid) or more.")
    for k in np.flatnonzero(feed > MOST_FEED)[:1]:
        most = format_short(MOST_FEED, "mm/min")
        raise columns.refuse(int(k), "feed", f"found {format_short(feed[k], 'mm/min')}; expected at most {most}.")
    made = Toolpath.from_points(np.zeros((len(p), 3)), np.zeros(len(p)), **given)
    cutting = feed > 0.0
    cutting[:1] = False
    left_out = ", ".join(columns.passed_over)
    found = (Finding("ignored", f"{left_out}: not a column of points, left out", code="column-left-out"),)
    return replace(
        made, p=p, v_f=np.where(cutting, feed, 0.0), cutting=cutting, findings=found * bool(columns.passed_over)
    )


def _ask_unit(columns: Columns, place: str, unit: str) -> None:
    """Raises UnitAskedError where no header names the unit of the points, and nobody else has."""
    plain = {name: columns.known[name].written for name in (*PLACE, "feed") if name in columns}
    silent = {name: said for name, said in plain.items() if said.strip().lower() in {name, *ALIASES}}
    if not silent or unit:
        return
    names, s = ", ".join(silent.values()), "s" * (len(silent) == 1)
    if silent.keys() & set(PLACE):
        size = np.ptp(from_si(np.column_stack([columns.values[axis] for axis in PLACE]), "mm"), axis=0)
        sizes = [f"{format_many(to_si(size, one), 'mm', 1, between=' × ')} in {unit_label(one)}" for one in ASKED]
        names += f" name{s} no unit; the path would be {listed(sizes, 'or')}"
    else:
        names += f" name{s} no unit"
    give = to_give("unit", "say which")
    raise UnitAskedError(f"{place}: {names}: write units into the header ({EXAMPLE}), or {give}.", where="unit")


def _axis(columns: Columns, place: str) -> FloatArray:
    missing = [axis for axis in AXIS if axis not in columns]
    if missing:
        raise ToolpathError(f"{place}: a tool axis needs i, j and k, and {missing[0]} is missing; add it.")
    k = np.column_stack([columns.values[axis] for axis in AXIS])
    for row in np.flatnonzero(np.linalg.norm(k, axis=1) < 1e-9)[:1]:
        raise columns.refuse(int(row), "i", "the tool axis has no length; expected the way out of the part, 0, 0, 1.")
    return k


def _tools(columns: Columns) -> Any:
    tool = columns.values["tool"]
    for row in np.flatnonzero((tool != np.round(tool)) | (tool < 0.0) | (tool > 1e6))[:1]:
        raise columns.refuse(int(row), "tool", "expected the whole number of a tool, 0 where none is said.")
    return tool.astype(np.int64)
