"""Where the part zero {W} lies in the robot's frame {M}: by numbers, or by three touched points."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pandas as pd
import streamlit as st

from robomill.arrays import FloatArray
from robomill.errors import ToolpathError
from robomill.io.workpiece import part_frame
from robomill.toolpath.part_zero import frame_from_points, points_of_frame
from robomill.ui import inputs, pieces, session
from robomill.units import format_si, from_si, to_si, unit_label

WAY, TOUCH = "part.way", "part.touch"
WAYS = {"numbers": "By numbers", "points": "By three points"}
NAMES = ("zero", "on +x", "on the +y side")
TOUCH_ERROR = 0.1e-3


def part_zero() -> None:
    """The two ways to say where the part lies."""
    st.markdown("**Part zero {W} in the robot's frame {M}**")
    if WAY not in st.session_state:
        st.session_state[WAY] = "numbers"
    way = st.segmented_control(
        "Part zero",
        list(WAYS),
        key=WAY,
        format_func=lambda k: WAYS[k],
        required=True,
        label_visibility="collapsed",
        width="stretch",
    )
    if way == "points":
        _by_points()
    else:
        _by_numbers()


def _by_numbers() -> None:
    unit = session.project().view.length
    left, right = st.columns(2)
    T_MW = session.project().setup.T_MW
    step, digits = (10.0, 2) if unit == "mm" else (1.0, 4)
    for i, (column, axis) in enumerate(zip((left, right, left), "XYZ", strict=True)):
        with column:
            value = float(f"{from_si(float(T_MW[i, 3]), unit):.12g}")
            name = f"zero:{axis}:{unit}"
            kept_number(f"{axis}, {unit_label(unit)}", name, value, step, digits, partial(_move, i, unit))
    with right:
        turn = float(np.round(from_si(np.arctan2(T_MW[1, 0], T_MW[0, 0]), "deg"), 9))
        kept_number("Turn about Z, °", "zero:turn", turn, 5.0, 2, _turn)
    tilt = tilt_of(T_MW)
    if tilt > 1e-6:
        pieces.note(
            f"The part is tilted by {format_si(tilt, 'deg', 3)} against the robot's base, as its three points say; "
            "a turn typed here sets it upright."
        )


def kept_number(label: str, name: str, value: float, step: float, digits: int, write: Callable[[float], None]) -> None:
    """A number box whose own default is the value in force; ``write`` gets what is typed.

    A box that moves to another column while a run is broken off comes up with its default and answers with it. So the
    value is the default, not an entry of the session, and a new value is a new box: nothing can turn into 0.
    """
    waiting = session.store().refused.get(name)
    shown = value if waiting is None else waiting[0]
    key = f"{name}={shown}"

    def take() -> None:
        typed = st.session_state[key]
        inputs.submit(name, typed, lambda: write(float(typed)))

    st.number_input(label, value=shown, key=key, step=step, format=f"%.{digits}f", on_change=take)
    inputs.sentence(name)


def _move(i: int, unit: str, typed: float) -> None:
    T_MW = np.array(session.project().setup.T_MW)
    T_MW[i, 3] = to_si(typed, unit)
    session.change(T_MW=T_MW)


def _turn(degrees: float) -> None:
    session.change(T_MW=part_frame(session.project().setup.T_MW[:3, 3], to_si(degrees, "deg")))


def tilt_of(T_MW: FloatArray) -> float:
    """rad between z_W and z_M."""
    return float(np.arctan2(np.hypot(T_MW[0, 2], T_MW[1, 2]), T_MW[2, 2]))


def _by_points() -> None:
    view = session.project().view
    unit = view.length
    inputs.table(
        f"touch:{unit}",
        lambda: points_frame(session.project().setup.T_MW, unit),
        lambda frame: _take(frame, unit),
        inputs.Sheet(
            columns={axis: st.column_config.NumberColumn(axis, format="%.6g") for axis in "XYZ"}, locked=("point",)
        ),
    )
    touched = st.session_state.get(TOUCH)
    words = f"Tool tip in {{M}} at each point, in {unit_label(unit)}."
    if touched is not None and np.array_equal(touched.T_MW, session.project().setup.T_MW):
        error = touched.tilt(TOUCH_ERROR)
        words += (
            f" Third point at {format_si(touched.angle, 'deg', 1)} to x; if each point is off by "
            f"{format_si(TOUCH_ERROR, 'mm', 1)}, the axes are good to {format_si(error, 'deg', 2)}."
        )
    else:
        words += " Touch the zero, a point far along +x, and one on the side of +y."
    pieces.note(words)


def points_frame(T_MW: FloatArray, unit: str) -> pd.DataFrame:
    """Three points that give the frame in force, in display units."""
    points = np.round(from_si(points_of_frame(T_MW), unit), 6) + 0.0
    return pd.DataFrame({"point": NAMES, **{axis: points[:, i] for i, axis in enumerate("XYZ")}})


def frame_points(frame: pd.DataFrame, unit: str) -> FloatArray:
    """Points (3, 3) m of the table. Raises ToolpathError naming an empty cell."""
    values = np.empty((3, 3))
    for row in range(3):
        for column, axis in enumerate("XYZ"):
            typed = frame[axis].iloc[row]
            if typed is None or pd.isna(typed):
                raise ToolpathError(f"Part zero, {NAMES[row]}: {axis} is missing; type a number.")
            values[row, column] = to_si(float(typed), unit)
    return values


def _take(frame: pd.DataFrame, unit: str) -> None:
    touched = frame_from_points(*frame_points(frame, unit))
    session.change(T_MW=touched.T_MW, from_editor=True)
    st.session_state[TOUCH] = touched
