"""What the map pages look at: region, plane, tilt, quantity, point, what-if factors. One frozen value in the session.

It is kept apart from the project, so that moving a slider is not an edit; it is made anew when another robot comes.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.robot.model import Robot
from robomill.workspace.region import holds_paper_box

KEY = "robomill.maps"
Point = tuple[float, float, float]


@dataclass(frozen=True)
class MapView:
    """SI throughout; None means "as robomill proposes for this robot"."""

    robot: str
    region: str
    lower: Point = (-0.6, -1.6, -0.4)
    upper: Point = (0.6, -1.0, 0.1)
    step: float | None = None
    A: float = 0.0
    B: float = 0.0
    normal: str = "z"
    at: float | None = None
    pair: tuple[float, float] | None = None
    point: Point | None = None
    quantity: str = "det_J"
    picture: str = "plane"
    level: float = 0.5
    sheet: str = "nine"
    component: str = "yy"
    shares: str = "direct"
    common: bool = True
    factors: tuple[float, ...] | None = None
    against: tuple[str, ...] = ()


def identity(robot: Robot) -> str:
    """What makes it another robot for the maps: not its compliances, which are what one plays with."""
    return f"{robot.name}/{robot.n}"


def maps(robot: Robot) -> MapView:
    """The view of this session, for ``robot``."""
    kept = st.session_state.get(KEY)
    if kept is not None and kept.robot == identity(robot):
        return kept  # type: ignore[no-any-return]
    fresh = MapView(identity(robot), "paper" if robot.n == 5 and holds_paper_box(robot) else "largest")
    if kept is not None:
        fresh = dataclasses.replace(fresh, picture=kept.picture, quantity=kept.quantity, sheet=kept.sheet)
    st.session_state[KEY] = fresh
    return fresh


def see(**fields: Any) -> None:
    """Replace fields of the view."""
    st.session_state[KEY] = dataclasses.replace(st.session_state[KEY], **fields)


def factors(view: MapView, robot: Robot) -> FloatArray:
    """(n,) factors on the joints' stiffness; ones where nothing was asked."""
    if view.factors is None or len(view.factors) != robot.n:
        return np.ones(robot.n)
    return np.array(view.factors)
