"""Measured force from a CSV file: time or path length against force. Every refusal names row and column.

Columns, units included: ``t_s`` or ``s_mm``; ``F_feed_N``, ``F_feed_normal_N``, ``F_axial_N`` (following the path) or
``F_x_N``, ``F_y_N``, ``F_z_N`` (in {M}, or in the part's axes where the sensor turns with the part: ``turns_with``).
"""

from pathlib import Path
from typing import Literal

import numpy as np

from robomill.arguments import asked
from robomill.cutting.forces.measured import FEWEST, Axis, ForceRecord, RecordFrame
from robomill.errors import CuttingError
from robomill.io.columns import Columns, Layout, read_columns
from robomill.units import from_si

AXES: dict[str, Axis] = {"t": "time", "s": "path"}
COMPONENTS: dict[RecordFrame, tuple[str, str, str]] = {
    "path": ("f_feed", "f_feed_normal", "f_axial"),
    "M": ("f_x", "f_y", "f_z"),
}
LAYOUT = Layout(
    "Force file",
    CuttingError,
    {"t": ("s", "min"), "s": ("mm", "m")} | {name: ("N", "kN") for names in COMPONENTS.values() for name in names},
    "t_s,F_feed_N,F_feed_normal_N,F_axial_N",
    fewest=FEWEST,
    aliases={"time": "t"},
)
# A step this many times the usual one is a gap.
GAP = 5.0
# Mean sizes of milling forces on a robot, N; a file beyond them is suspected of another unit (mN, kN).
CREDIBLE_N = (1.0, 20_000.0)


@asked
def read_forces(
    path_or_text: str | Path | bytes,
    *,
    on: Literal["tool", "part"] = "tool",
    turns_with: Literal["robot", "part"] = "robot",
    source: str = "",
    trust_units: bool = False,
) -> ForceRecord:
    r"""A record of measured forces from CSV: force ON the tool over time or path length.

    Parameters
    ----------
    path_or_text : str, Path or bytes
        A file, its text (anything with a line break) or its bytes.
    on : str
        What the sensor felt: the "tool", or the "part" (a dynamometer below it), whose force is turned round.
    turns_with : str
        Whose axes x, y and z are: the "robot"'s base, or the "part"'s, on which the sensor sits.
    source : str
        Where the record comes from, in words.
    trust_units : bool
        Accept sizes that look like another unit.

    Returns
    -------
    ForceRecord
        In SI. Components without a column are 0 and noted, and so are columns that are not known.

    Raises
    ------
    CuttingError
        With file, row and column.

    Examples
    --------
    >>> import robomill as rm
    >>> rows = "0,10,20,-5\n0.1,12,21,-5\n0.2,11,20,-5\n0.3,10,20,-5\n"
    >>> record = rm.read_forces("t_s,F_feed_N,F_feed_normal_N,F_axial_N\n" + rows)
    >>> record.F[0].tolist()
    [10.0, 20.0, -5.0]
    """
    table, name = read_columns(path_or_text, LAYOUT, source)
    name = name or LAYOUT.subject
    axis, frame = _kind(table)
    _check_axis(table, axis)
    present = [component for component in COMPONENTS[frame] if component in table]
    if not trust_units:
        _check_size(table, present)
    nothing = np.zeros(len(table.row))
    F = np.stack([table.values.get(component, nothing) for component in COMPONENTS[frame]], axis=1)
    absent = [component[2:].replace("_", "-") for component in COMPONENTS[frame] if component not in table]
    notes = [f"{name}: no {word} force was recorded; it is taken as 0." for word in absent]
    notes += [f"{name}: the column {column!r} is not used." for column in table.passed_over]
    if frame == "M" and turns_with == "part":
        frame = "W"
    return ForceRecord(table.values[axis], F if on == "tool" else -F, AXES[axis], frame, name, tuple(notes))


def _kind(table: Columns) -> tuple[str, RecordFrame]:
    """The quantity that the rows go along, and the frame of the force."""
    header = ", ".join((*(column.written for column in table.known.values()), *table.passed_over))[:80]
    axes = [axis for axis in AXES if axis in table]
    if len(axes) != 1:
        raise table.place.refuse(f"expected one column of t_s, time_s, s_mm, s_m, found {header}.")
    frames = [frame for frame, names in COMPONENTS.items() if any(name in table for name in names)]
    if len(frames) != 1:
        raise table.place.refuse(
            f"expected columns of either F_feed_N, F_feed_normal_N, F_axial_N or F_x_N, F_y_N, F_z_N, found {header}."
        )
    return axes[0], frames[0]


def _check_axis(table: Columns, axis: str) -> None:
    """Strictly increasing and without gaps."""
    x = from_si(table.values[axis], table.known[axis].unit)
    step = np.diff(x)
    for bad, word in ((step == 0.0, "repeats"), (step < 0.0, "is smaller than")):
        if bad.any():
            k = int(np.argmax(bad)) + 1
            raise table.refuse(
                k,
                axis,
                f"{x[k]:g} {word} the value before it ({x[k - 1]:g}); sort the rows and keep one of each.",
            )
    usual = float(np.median(step))
    gaps = np.flatnonzero(step > GAP * usual)
    if gaps.size:
        k = int(gaps[0]) + 1
        raise table.refuse(
            k,
            axis,
            f"a gap from {x[k - 1]:g} to {x[k]:g} where rows are usually {usual:.3g} apart; cut the record there or "
            "fill it.",
        )


def _check_size(table: Columns, present: list[str]) -> None:
    """The mean size of the largest component is one that milling has."""
    mean, largest = max((float(np.mean(np.abs(table.values[component]))), component) for component in present)
    low, high = CREDIBLE_N
    if not low <= mean <= high:
        unit = "kN" if mean < low else "mN"
        raise table.place.refuse(
            f"the mean size of all rows is {mean:.4g} N, expected {low:g} to {high:g} N; is it in {unit}? "
            "Give newtons, or say that the unit is right.",
            column=table.written(largest),
        )
