"""The prediction of the first lesson as an arrow: drawn in the browser, judged by its angle to where the tip goes."""

from __future__ import annotations

import math

import streamlit as st

from robomill.arrays import FloatArray
from robomill.learn.push import FORCE, AsidePush
from robomill.ui import session
from robomill.ui.component import component
from robomill.units import format_si

KEY, DRAWN, REV = "learn.arrow", "learn.drawn", "learn.arrow-rev"
ALONE = 10.0  # degrees from the push within which an arrow says that the tip goes nowhere else

_component = component("robomill_arrow", __file__)


def plane(push: AsidePush) -> tuple[int, int]:
    """The axes of the board, to the right and up: those of the push and of where it leads aside; Z points up."""
    return (push.aside, push.along) if push.along == 2 else (push.along, push.aside)


def angle(push: AsidePush, vector: FloatArray) -> float:
    """Degrees on the board of the direction of a vector (3,)."""
    right, up = plane(push)
    return math.degrees(math.atan2(float(vector[up]), float(vector[right])))


def answer(push: AsidePush, degrees: float) -> str:
    """Which of the answers of the push an arrow gives."""
    right, _ = plane(push)
    turned = math.radians(degrees)
    along, aside = (math.cos, math.sin) if push.along == right else (math.sin, math.cos)
    if along(turned) > 0.0 and abs(math.degrees(math.asin(aside(turned)))) < ALONE:
        return "alone"
    return f"{'+' if aside(turned) > 0.0 else '-'}{push.aside}"


def apart(one: float, other: float) -> float:
    """Degrees between two directions, 0 to 180."""
    return abs((one - other + 180.0) % 360.0 - 180.0)


def words(push: AsidePush, delta: FloatArray) -> str:
    """How far the arrow in force is from where the tip goes; "" where none is drawn."""
    drawn = session.kept(DRAWN)
    if drawn is None:
        return ""
    return f"Your arrow points {format_si(math.radians(apart(drawn, angle(push, delta))), 'deg', 0)} beside it."


def board(push: AsidePush, delta: FloatArray | None) -> None:
    """The board, with the arrow of the displacement where that is told. A new arrow is kept as the answer it gives."""
    right, up = plane(push)
    _component(
        key=KEY,
        data={
            "rev": session.kept(REV, 0),
            "drawn": session.kept(DRAWN),
            "push": angle(push, push.force),
            "truth": None if delta is None else angle(push, delta),
            "right": f"+{'XYZ'[right]}",
            "up": f"+{'XYZ'[up]}",
            "force": format_si(FORCE, "N", 0),
        },
        on_arrow_change=_take,
    )


def _take() -> None:
    sent = st.session_state[KEY].get("arrow")
    if not sent or sent.get("rev") != session.kept(REV, 0):
        return
    degrees = sent.get("degrees")
    if isinstance(degrees, int | float) and math.isfinite(degrees):
        session.keep(DRAWN, float(degrees))


def forget() -> None:
    """Take the arrow off the board: another answer was chosen."""
    if session.drop(DRAWN) is not None:
        session.keep(REV, session.kept(REV, 0) + 1)
