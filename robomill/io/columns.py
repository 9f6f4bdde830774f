"""Columns of numbers from CSV files and pasted cells: one reader for load tests, force records, profiles and maps.

The first line that is neither empty nor a remark (``#``) names the columns with their units: ``Fx_N``, ``Fx [N]`` or
``Fx (N)``. Tabs, semicolons or commas separate; with the first two, decimal commas are understood, where one of them
can be nothing else: a table in which every comma may as well part thousands is refused. Rows are numbered as an editor
or spreadsheet shows them: the first line of the file is row 1.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.errors import RobomillError
from robomill.files import TABLE
from robomill.io.texts import read_text
from robomill.quantities import GREATEST
from robomill.typed_numbers import either_way, plain_number
from robomill.units import format_count, to_si

if TYPE_CHECKING:
    from robomill.frames import DataFrame, Series

MOST_COLUMNS = 300
_SEPARATOR = re.compile(r"\"?sep=([,;\t])\"?", re.IGNORECASE)  # Excel's first line, which names what separates cells
LONGEST_NAME = 100  # characters of a column's name; a longer one is none that is known


@dataclass(frozen=True)
class Layout:
    """What a table may hold: quantities by lower-case name, each with the units (of ``units.UNITS``) it may come in.

    ``aliases`` maps other names of a quantity to the one of ``units``; cells of ``open_cells`` may be empty: NaN.
    ``silent`` are the units of quantities whose header names none.
    """

    subject: str
    error: type[RobomillError]
    units: Mapping[str, Sequence[str]]
    example: str
    fewest: int = 1
    aliases: Mapping[str, str] = field(default_factory=dict)
    open_cells: frozenset[str] = frozenset()
    silent: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Column:
    """A column that is known: its place, what it holds, its unit, and its name as written."""

    at: int
    quantity: str
    unit: str
    written: str


@dataclass(frozen=True)
class Columns:
    """The known columns: ``values`` (m,) in SI by quantity, ``row`` (m,) the number of each row.

    ``passed_over`` are the columns that are not known, ``remarks`` the text of the lines that start with ``#``.
    """

    values: Mapping[str, FloatArray]
    known: Mapping[str, Column]
    row: IntArray
    passed_over: tuple[str, ...]
    remarks: str
    place: Place

    def __contains__(self, quantity: str) -> bool:
        return quantity in self.values

    def written(self, quantity: str) -> str:
        """The quantity's name as the header spells it."""
        return self.known[quantity].written

    def refuse(self, k: int, quantity: str, message: str) -> RobomillError:
        """A refusal of the cell of ``quantity`` in line ``k``, counted from 0."""
        return self.place.refuse(message, int(self.row[k]), self.written(quantity))


@dataclass(frozen=True)
class Place:
    """Which file, and its header's row (0: a DataFrame's columns): what every refusal starts with."""

    name: str
    head: int
    error: type[RobomillError]

    def refuse(self, message: str, row: int | None = None, column: str = "") -> RobomillError:
        """A refusal of a row (the header's, unless another is given) and, if named, a column."""
        head = f"row {self.head}" if self.head else "columns"
        at = (head if row is None else f"row {row}") + (f", column {column}" if column else "")
        where = f"{self.name}, {at}" if self.name else at[0].upper() + at[1:]
        return self.error(f"{where}: {message}", where=at)

    def declared(self, line: str) -> str:
        """How a remark ``key: value`` is declared there, in the imperative."""
        if self.head:
            return f"add a line '# {line}' above the header"
        key, _, value = line.partition(": ")
        return f"set attrs[{key!r}] = {value!r} of the DataFrame"


def read_columns(given: str | Path | bytes, layout: Layout, name: str = "") -> tuple[Columns, str]:
    """The columns of a CSV file, its text or its bytes, and the file's name ("" for a text that has none).

    Raises the layout's error with file, row and column.
    """
    text, name = read_text(given, layout.error, TABLE, name)
    body, remarks = _body(text, layout, name)
    known, passed_over = _known(body.names, layout, body.place)
    if len(body.lines) < layout.fewest:
        found = (
            f"{len(body.lines)} row{'s' * (len(body.lines) > 1)} of numbers"
            if body.lines
            else f"only a header (row {body.place.head}) and nothing below it"
        )
        raise layout.error(f"{name or layout.subject}: found {found}; expected at least {layout.fewest}.")
    values = _numbers(body, list(known.values()), layout.open_cells)
    in_si = {column.quantity: to_si(values[:, i], column.unit) for i, column in enumerate(known.values())}
    return Columns(in_si, known, body.row, passed_over, remarks, body.place), name


def frame_columns(frame: DataFrame, layout: Layout) -> tuple[Columns, str]:
    """The columns of a pandas DataFrame, by the same headers; its ``attrs`` stand for the remarks of a file.

    Rows are numbered by the index where it holds whole numbers, each once, else from 0. Raises the layout's error
    with row and column.
    """
    place = Place("", 0, layout.error)
    named = [str(name) for name in frame.columns]
    if not named:
        raise place.refuse(f"found none; expected columns such as {layout.example}.")
    known, passed_over = _known(named, layout, place)
    if len(frame) < layout.fewest:
        raise layout.error(f"{layout.subject}: found no row in the DataFrame; expected at least {layout.fewest}.")
    row = np.arange(len(frame))
    if frame.index.is_unique and frame.index.dtype.kind in "iu":
        row = frame.index.to_numpy(dtype=np.int64)
    body = _Body([], row, named, ",", place)
    in_si = {
        column.quantity: to_si(_of_series(body, frame.iloc[:, column.at], column, layout), column.unit)
        for column in known.values()
    }
    remarks = "\n".join(f"{key}: {value}" for key, value in frame.attrs.items() if isinstance(value, str))
    return Columns(in_si, known, row, passed_over, remarks, place), ""


def _of_series(body: _Body, series: Series, column: Column, layout: Layout) -> FloatArray:
    """(m,) finite numbers, NaN where an open cell is empty."""
    is_open = column.quantity in layout.open_cells
    if series.dtype.kind in "fiu":
        values = series.to_numpy(dtype=np.float64, na_value=np.nan)
        if (np.abs(values) <= GREATEST).all():
            return values
    texts = ["" if missing else str(cell) for cell, missing in zip(series, series.isna(), strict=True)]
    return np.array([_cell(body, k, column, text, is_open) for k, text in enumerate(texts)])


def read_cells(text: str, layout: Layout, name: str = "") -> list[tuple[str, dict[str, str]]]:
    """The rows of a table that holds words too: where each stands, and its cells by header; empty ones are left out.

    Numbers have points in them, whatever the file wrote. Raises the layout's error for a row of another width.
    """
    body, _ = _body(text, layout, name)
    for k in range(len(body.lines)):
        _check_width(body, k)
    if body.mark != ",":
        _check_commas(body, [Column(at, written, "", written) for at, written in enumerate(body.names)])
    rows = []
    for k, line in enumerate(body.lines):
        cells = (cell.strip() for cell in _cells(line, body.mark))
        if body.mark != ",":
            cells = (cell.replace(",", ".") if _number(cell.replace(",", ".")) is not None else cell for cell in cells)
        at = f"row {body.row[k]}"
        rows.append((f"{name}, {at}" if name else at, {key: cell for key, cell in zip(body.names, cells) if cell}))
    return rows


def append_rows(text: str, more: str, layout: Layout, name: str = "") -> str:
    """``text`` with the rows of the table ``more`` below its own, in the columns and with the separator of ``text``.

    Columns are matched by what they hold. ``name`` is that of ``more``; raises the layout's error for two tables that
    hold different quantities or the same in different units.
    """
    ours, theirs = _body(text, layout, "")[0], _body(more, layout, name)[0]
    known, given = _known(ours.names, layout, ours.place)[0], _known(theirs.names, layout, theirs.place)[0]
    wanted, found = ({(column.quantity, column.unit) for column in table.values()} for table in (known, given))
    if wanted != found:
        raise theirs.place.refuse(
            f"found the columns {', '.join(theirs.names):.80}, expected {', '.join(ours.names):.80} as in the table "
            "that they join; bring both to the same columns and units."
        )
    places = {column.at: given[quantity].at for quantity, column in known.items()}
    rows = []
    for k, line in enumerate(theirs.lines):
        _check_width(theirs, k)
        cells = _cells(line.replace(",", ".") if theirs.mark != "," else line, theirs.mark)
        rows.append(ours.mark.join(cells[places[at]].strip() if at in places else "" for at in range(len(ours.names))))
    return "\n".join([text.rstrip("\r\n"), *rows]) + "\n"


def _body(text: str, layout: Layout, name: str) -> tuple[_Body, str]:
    """What is below the header, and the remarks."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    remarks = "\n".join(line.strip().lstrip("# ") for line in lines if line.lstrip().startswith("#"))
    kept = [(k, line) for k, line in enumerate(lines, 1) if line.strip(" \t,;") and not line.lstrip().startswith("#")]
    said = _SEPARATOR.fullmatch(kept[0][1].strip(" ")) if kept else None
    kept = kept[1:] if said else kept
    if not kept:
        subject = name or layout.subject
        raise layout.error(f"{subject}: the file is empty; give a header ({layout.example}) and the numbers below it.")
    (head, header), below = kept[0], kept[1:]
    mark = said[1] if said else next((mark for mark in "\t;" if mark in header), ",")
    names = [cell.strip()[: LONGEST_NAME + 1] for cell in _cells(header, mark)]
    if len(names) > MOST_COLUMNS:
        raise Place(name, head, layout.error).refuse(
            f"found {format_count(len(names))} columns, expected {MOST_COLUMNS} at most."
        )
    row = np.array([k for k, _ in below])
    return _Body([line for _, line in below], row, names, mark, Place(name, head, layout.error)), remarks


# ---- the header ----------------------------------------------------------------------------------------------------
def spelled(unit: str) -> str:
    """A unit as a column's name ends: "N m" as Nm, "um/N" as um_N."""
    return "" if unit == "1" else unit.replace(" ", "").replace("/", "_")


def _known(names: list[str], layout: Layout, place: Place) -> tuple[dict[str, Column], tuple[str, ...]]:
    """Known columns by quantity, and the names of those passed over."""
    if all(_number(name.replace(",", ".")) is not None for name in names):
        raise place.refuse(f"found numbers, expected a header that names columns and units ({layout.example}).")
    known: dict[str, Column] = {}
    odd: list[tuple[str, str, RobomillError]] = []
    passed_over = []
    for at, written in enumerate(names):
        stem, suffix = _stem_and_unit(written, layout)
        if not stem:
            passed_over += [written] if written else []
            continue
        quantity = layout.aliases.get(stem, stem)
        units = {spelled(unit): unit for unit in layout.units[quantity]}
        unit = units.get(suffix) or {short.lower(): unit for short, unit in units.items()}.get(suffix.lower())
        unit = unit or (None if suffix else layout.silent.get(quantity))
        if unit is None:
            what = f"unit {suffix!r} is not known" if suffix else "the unit is missing"
            good = ", ".join("_".join(filter(None, (written[: len(stem)], short))) for short in units)
            odd.append((quantity, written, place.refuse(f"{what}; write one of {good}.", column=repr(written))))
        elif quantity in known:
            raise place.refuse(f"{known[quantity].written} and {written} are the same quantity twice; keep one.")
        else:
            known[quantity] = Column(at, quantity, unit, written)
    for quantity, written, refusal in odd:
        if quantity not in known:
            raise refusal
        passed_over.append(written)
    if not known:
        found = ", ".join(passed_over)
        raise place.refuse(f"no column is known among {found:.80}; expected a header such as {layout.example}.")
    return known, tuple(passed_over)


def _stem_and_unit(written: str, layout: Layout) -> tuple[str, str]:
    """The longest name that is known and the unit behind it; two empty texts where none is."""
    if len(written) > LONGEST_NAME:
        return "", ""
    plain = written.replace("µ", "u").replace("μ", "u").replace("°", "deg")
    bracketed = re.fullmatch(r"(.*?)[\s_]*[\[(](.*)[\])]", plain)
    if bracketed:
        stem, unit = bracketed[1].strip().lower(), spelled(bracketed[2].strip())
        return (stem, unit) if stem in layout.units or stem in layout.aliases else ("", "")
    words = plain.split("_")
    for n in range(len(words), 0, -1):
        stem = "_".join(words[:n]).lower()
        if stem in layout.units or stem in layout.aliases:
            return stem, "_".join(words[n:])
    return "", ""


# ---- the cells -----------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class _Body:
    """The lines below the header, their numbers in the file, and the header that they follow."""

    lines: list[str]
    row: IntArray
    names: list[str]
    mark: str
    place: Place


def _numbers(body: _Body, wanted: list[Column], open_cells: frozenset[str]) -> FloatArray:
    """(m, wanted) finite numbers, NaN where an open cell is empty.

    The quick reader first; only where it fails is each cell looked at.
    """
    for k, line in enumerate(body.lines):
        if '"' in line or line.count(body.mark) != len(body.names) - 1:
            _check_width(body, k)
    lines = body.lines
    if body.mark != ",":
        _check_commas(body, wanted)
        lines = [line.replace(",", ".") for line in lines]
    places = [column.at for column in wanted]
    try:
        values = np.loadtxt(lines, delimiter=body.mark, usecols=places, ndmin=2, comments=None, quotechar='"')
    except ValueError:
        values = np.array([[math.nan]])
    if (np.abs(values) <= GREATEST).all():
        return values
    rows = [_cells(line, body.mark) for line in body.lines]  # what is refused is quoted as it was written
    return np.array(
        [
            [_cell(body, k, column, cells[column.at], column.quantity in open_cells) for column in wanted]
            for k, cells in enumerate(rows)
        ]
    )


def _check_width(body: _Body, k: int) -> None:
    """As many cells as the header has names; empty ones behind them do not count."""
    cells = _cells(body.lines[k], body.mark)
    counted = f"found {len(cells)} cells, expected {len(body.names)} as in the header"
    if len(cells) < len(body.names):
        raise body.place.refuse(f"{counted}.", int(body.row[k]), body.names[len(cells)])
    if any(cell.strip() for cell in cells[len(body.names) :]):
        cure = "; with decimal commas, separate the columns by semicolons" if body.mark == "," else ""
        raise body.place.refuse(f"{counted}{cure}.", int(body.row[k]))


def _check_commas(body: _Body, wanted: list[Column]) -> None:
    """Refuse the first number that is 1.220 to some and 1220 to others, where no other shows what a comma is here."""
    first: RobomillError | None = None
    for k, line in enumerate(body.lines):
        cells = _cells(line, body.mark) if "," in line else []
        for column in wanted if cells else ():
            found = cells[column.at].strip()
            if "," not in found or _number(found.replace(",", ".")) is None:
                continue
            ways = either_way(found, found)
            if not ways:
                return
            if first is None:
                message = f"found {found!r:.40}, which is {ways}; write the table's numbers in one of these two ways."
                first = body.place.refuse(message, int(body.row[k]), column.written)
    if first is not None:
        raise first


def _cells(line: str, mark: str) -> list[str]:
    if '"' not in line:
        return line.split(mark)
    try:
        return next(csv.reader([line], delimiter=mark), [""])
    except csv.Error:  # a cell that is longer than any
        return line.split(mark)


def _cell(body: _Body, k: int, column: Column, text: str, is_open: bool) -> float:
    found = text.strip()
    number = _number(found.replace(",", ".") if body.mark != "," else found)
    if number is not None and abs(number) <= GREATEST:
        return number
    if not found and is_open:
        return math.nan
    if not found:
        message = "the cell is empty, expected a number; measure it again or delete the row"
    elif number is None:
        message = f"found {found!r:.40}, expected a number; enter a plain one such as 0.125"
    elif math.isfinite(number):
        message = f"found {found!r:.40}, expected no more than {GREATEST:g}; measure it again or delete the row"
    else:
        message = f"found {found!r:.40}, expected a finite number; measure it again or delete the row"
    raise body.place.refuse(f"{message}.", int(body.row[k]), column.written)


def _number(text: str) -> float | None:
    """The number that a cell holds, not finite perhaps; None for anything else."""
    try:
        return plain_number(text)
    except ValueError:
        return None
