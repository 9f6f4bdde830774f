"""Where the part zero {W} lies in the robot's frame {M}: by numbers, or by three touched points."""

import math

import numpy as np
import pandas as pd
import streamlit as st

from robomill.arrays import FloatArray
from robomill.errors import ToolpathError
from robomill.kinematics.transforms import transform
from robomill.simulation.given import PART_TURN, PART_ZERO, part_frame
from robomill.toolpath.part_zero import frame_from_points, points_of_frame
from robomill.ui import pieces, session
from robomill.ui.entry import declared, grid, inputs
from robomill.ui.entry.cells import Cells
from robomill.units import format_si, unit_label
from robomill.vectors import angle_between

TOUCHED, TURNED = "toolpath.touched", "toolpath.turned"
SAME = 1e-9  # rad
WAYS = {"numbers": "By numbers", "points": "By three points"}
NAMES = ("zero", "on +x", "on the +y side")
TOUCH_ERROR = 0.1e-3


def part_zero() -> None:
    """The two ways to say where the part lies."""
    st.markdown("**Part zero {W} in the robot's frame {M}**")
    if inputs.pick("Part zero", "toolpath.way", WAYS, look=inputs.HIDDEN) == "points":
        _by_points()
    else:
        _by_numbers()


def _by_numbers() -> None:
    T_MW = session.project().setup.T_MW
    with st.container(key="toolpath-zero"):
        declared.draw(PART_ZERO, "toolpath.zero", T_MW[:3, 3], _put)
    turn = float(np.round(np.arctan2(T_MW[1, 0], T_MW[0, 0]), 12))
    declared.draw(PART_TURN, "toolpath.turn", turn, _turn)
    typed = session.kept(TURNED, turn)
    if abs(typed - turn) > SAME and abs(math.remainder(typed - turn, math.tau)) < SAME:
        pieces.note(f"A turn by {format_si(typed, 'deg')} is one by {format_si(turn, 'deg')}.")
    tilt = tilt_of(T_MW)
    if tilt > 1e-6:
        pieces.note(
            f"The part is tilted by {format_si(tilt, 'deg', 3)} against the robot's base, as its three points say; "
            "a turn typed here sets it upright."
        )


def _put(zero: FloatArray) -> None:
    session.change(label="toolpath.zero", T_MW=transform(session.project().setup.T_MW[:3, :3], zero))


def _turn(angle: float) -> None:
    session.keep(TURNED, angle)
    session.change(T_MW=part_frame(session.project().setup.T_MW[:3, 3], angle))


def tilt_of(T_MW: FloatArray) -> float:
    """rad between z_W and z_M."""
    return float(angle_between(T_MW[:3, 2], [0.0, 0.0, 1.0]))


def _by_points() -> None:
    unit = session.project().view.length
    sheet = grid.Sheet(_cells(unit).boxes(), where=_where, locked=("point",))
    grid.table(f"toolpath.points:{unit}", lambda: points_frame(session.project().setup.T_MW), _take, sheet)
    touched = session.kept(TOUCHED)
    words = f"Tool tip in {{M}} at each point, in {unit_label(unit)}."
    if touched is not None and np.array_equal(touched.T_MW, session.project().setup.T_MW):
        error = touched.tilt(TOUCH_ERROR)
        words += (
            f" Third point at {format_si(touched.angle, 'deg', 1)} to x; if each point is off by "
            f"{format_si(TOUCH_ERROR, unit, 1)}, the axes are good to {format_si(error, 'deg', 2)}."
        )
    else:
        words += " Touch the zero, a point far along +x, and one on the side of +y."
    pieces.note(words)


def points_frame(T_MW: FloatArray) -> pd.DataFrame:
    """Three points that give the frame in force."""
    return _cells().frame(points_of_frame(T_MW), point=NAMES)


def frame_points(frame: pd.DataFrame) -> FloatArray:
    """Points (3, 3) m of the table. Raises ToolpathError naming an empty cell."""
    return _cells().read(frame, _where)


def _cells(unit: str = "mm") -> Cells:
    return Cells("XYZ", unit, ToolpathError)


def _where(row: int) -> str:
    return f"Part zero, {NAMES[row]}"


def _take(frame: pd.DataFrame) -> None:
    touched = frame_from_points(*frame_points(frame))
    session.change(T_MW=touched.T_MW, from_editor=True)
    session.keep(TOUCHED, touched)
