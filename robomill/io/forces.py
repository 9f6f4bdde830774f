"""Measured force from a CSV file: time or path length against newtons. Every refusal names row and column.

The first line names the columns, units included: ``t_s`` or ``s_mm``; ``F_feed_N``, ``F_feed_normal_N``,
``F_axial_N`` (following the path) or ``F_x_N``, ``F_y_N``, ``F_z_N`` (in {M}). Comma, semicolon or tab between
columns; decimal commas with the latter two; lines that start with # are comments.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import Literal, cast

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.force import Frame
from robomill.cutting.measured import FEWEST, Axis, ForceRecord
from robomill.errors import CuttingError
from robomill.units import to_si

AXES: dict[str, tuple[Axis, str]] = {
    "t_s": ("time", "s"),
    "time_s": ("time", "s"),
    "s_mm": ("path", "mm"),
    "s_m": ("path", "m"),
}
COMPONENTS: dict[str, tuple[Frame, int]] = {
    "f_feed_n": ("path", 0),
    "f_feed_normal_n": ("path", 1),
    "f_axial_n": ("path", 2),
    "f_x_n": ("M", 0),
    "f_y_n": ("M", 1),
    "f_z_n": ("M", 2),
}
#: A step this many times the usual one is a gap.
GAP = 5.0
#: Mean sizes of milling forces on a robot; a file beyond them is suspected of another unit (mN, kN).
CREDIBLE_N = (1.0, 20_000.0)


def read_forces(
    path_or_text: str | Path | bytes,
    *,
    on: Literal["tool", "part"] = "tool",
    source: str = "",
    trust_units: bool = False,
) -> ForceRecord:
    """The record of a CSV file, its text (anything with a line break) or its bytes; force ON the tool, SI.

    ``on`` says what the sensor felt: a dynamometer under the part gives the force on the part, which is turned round.
    Components without a column are 0 and noted, columns that are not known are noted. ``trust_units`` accepts sizes
    that look like another unit. Raises CuttingError with row (line of the file) and column.
    """
    text, name = _text(path_or_text, source)
    numbers, rows = _lines(text, name)
    header = rows[0]
    mark = next((c for c in (";", "\t") if c in header), ",")
    columns = [cell.strip().strip('"') for cell in header.split(mark)]
    axis, unit, x_column, frame, chosen, notes = _columns(columns, name)
    data = _numbers(rows[1:], numbers[1:], columns, mark, name, [x_column, *chosen])
    _check_axis(data[:, x_column], numbers[1:], columns[x_column], name)
    F = np.zeros((len(data), 3))
    for column in chosen:
        F[:, COMPONENTS[columns[column].lower()][1]] = data[:, column]
    if not trust_units:
        _check_size(data, chosen, columns, name)
    x = to_si(np.asarray(data[:, x_column]), unit)
    return ForceRecord(x, F if on == "tool" else -F, axis, frame, name, notes)


def _text(given: str | Path | bytes, source: str) -> tuple[str, str]:
    """The text and the name that starts every sentence."""
    name = source or "Force file"
    if isinstance(given, str) and ("\n" in given or not given.strip()):
        return given, name
    if isinstance(given, bytes):
        raw = given
    else:
        name = source or Path(given).name
        try:
            raw = Path(given).read_bytes()
        except OSError as exc:
            raise CuttingError(f"{name}: the file cannot be read ({exc.__class__.__name__}).") from exc
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as exc:
        raise CuttingError(f"{name}: this is not a text file; give a CSV file.") from exc
    return text, name


def _lines(text: str, name: str) -> tuple[list[int], list[str]]:
    """Line numbers and lines that are neither empty nor comments."""
    if "\0" in text:
        raise CuttingError(f"{name}: this is not a text file; give a CSV file.")
    kept = [(i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and not line.startswith("#")]
    if len(kept) < FEWEST + 1:
        raise CuttingError(
            f"{name}: found {max(len(kept) - 1, 0)} rows of numbers; expected a line of column names and at least "
            f"{FEWEST} rows."
        )
    return [i for i, _ in kept], [line for _, line in kept]


def _columns(columns: list[str], name: str) -> tuple[Axis, str, int, Frame, list[int], tuple[str, ...]]:
    """Which column is what: axis, its unit and place, the frame, the force columns, notes."""
    lower = [column.lower() for column in columns]
    for column in lower:
        if lower.count(column) > 1:
            raise CuttingError(f"{name}: the column {column!r} is there twice; keep one.", where=column)
    axes = [i for i, column in enumerate(lower) if column in AXES]
    chosen = [i for i, column in enumerate(lower) if column in COMPONENTS]
    if len(axes) != 1:
        raise CuttingError(
            f"{name}: expected one column of {', '.join(AXES)}, found {', '.join(columns)[:80] or 'nothing'}."
        )
    frames = {COMPONENTS[lower[i]][0] for i in chosen}
    if len(frames) != 1:
        raise CuttingError(
            f"{name}: expected columns of either F_feed_N, F_feed_normal_N, F_axial_N or F_x_N, F_y_N, F_z_N, "
            f"found {', '.join(columns)[:80]}."
        )
    frame = frames.pop()
    axis, unit = AXES[lower[axes[0]]]
    given = {COMPONENTS[lower[i]][1] for i in chosen}
    words = {"path": ("feed", "feed-normal", "axial"), "M": ("x", "y", "z")}[frame]
    notes = [
        f"{name}: no {word} force was recorded; it is taken as 0." for i, word in enumerate(words) if i not in given
    ]
    unused = [column for i, column in enumerate(columns) if i not in chosen and i != axes[0]]
    notes += [f"{name}: the column {column!r} is not used." for column in unused]
    return axis, unit, axes[0], frame, chosen, tuple(notes)


def _numbers(
    rows: list[str], lines: list[int], columns: list[str], mark: str, name: str, needed: list[int]
) -> FloatArray:
    """All rows as numbers (k, columns); the columns not ``needed`` may hold anything (NaN there)."""
    plain = [row.replace(",", ".") for row in rows] if mark != "," else rows
    try:
        picked = np.loadtxt(io.StringIO("\n".join(plain)), delimiter=mark, usecols=needed, ndmin=2, comments=None)
    except (ValueError, IndexError):
        picked = None
    if picked is None or not np.isfinite(picked).all():
        _name_the_cell(plain, lines, columns, mark, name, needed)
    data = np.full((len(rows), len(columns)), np.nan)
    data[:, needed] = cast(FloatArray, picked)
    return data


def _name_the_cell(
    rows: list[str], lines: list[int], columns: list[str], mark: str, name: str, needed: list[int]
) -> None:
    """Refuse the first cell that is not a finite number."""
    for line, row in zip(lines, rows, strict=True):
        cells = row.split(mark)
        for i in needed:
            where = f"{name}, row {line}, column {columns[i]}"
            cell = cells[i].strip() if i < len(cells) else ""
            if not cell:
                raise CuttingError(f"{where}: the cell is empty; expected a number.", where=f"row {line}")
            try:
                number = float(cell)
            except ValueError as exc:
                raise CuttingError(f"{where}: expected a number, found {cell!r:.40}.", where=f"row {line}") from exc
            if not np.isfinite(number):
                raise CuttingError(f"{where}: expected a finite number, found {cell}.", where=f"row {line}")
    raise CuttingError(f"{name}: the numbers cannot be read; expected {len(columns)} columns in every row.")


def _check_axis(x: FloatArray, lines: list[int], column: str, name: str) -> None:
    """Strictly increasing and without gaps."""
    step = np.diff(x)
    for bad, word in ((step == 0.0, "repeats"), (step < 0.0, "is smaller than")):
        if bad.any():
            i = int(np.argmax(bad)) + 1
            raise CuttingError(
                f"{name}, row {lines[i]}, column {column}: {x[i]:g} {word} the value before it ({x[i - 1]:g}); "
                "sort the rows and keep one for each value.",
                where=f"row {lines[i]}",
            )
    usual = float(np.median(step))
    gaps = np.flatnonzero(step > GAP * usual)
    if gaps.size:
        i = int(gaps[0]) + 1
        raise CuttingError(
            f"{name}, row {lines[i]}, column {column}: a gap from {x[i - 1]:g} to {x[i]:g} where rows are usually "
            f"{usual:.3g} apart; cut the record there or fill it.",
            where=f"row {lines[i]}",
        )


def _check_size(data: FloatArray, chosen: list[int], columns: list[str], name: str) -> None:
    """The mean size of the largest component is one that milling has."""
    means = np.mean(np.abs(data[:, chosen]), axis=0)
    largest = int(np.argmax(means))
    low, high = CREDIBLE_N
    if not low <= means[largest] <= high:
        unit = "kN" if means[largest] < low else "mN"
        raise CuttingError(
            f"{name}, column {columns[chosen[largest]]}, all rows: the mean size is {means[largest]:.4g} N, expected "
            f"{low:g} to {high:g} N; is it in {unit}? Give newtons, or say that the unit is right.",
            where=columns[chosen[largest]],
        )
