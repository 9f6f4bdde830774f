"""A table of points as the path; what its header does not say, the unit or the feed, is asked for."""

from typing import Any

import streamlit as st

from robomill.errors import ToolpathError
from robomill.io.point_tables import ASKED, points_from_bytes
from robomill.toolpath.path import FEED
from robomill.ui import pieces, session
from robomill.ui.entry import declared, inputs
from robomill.ui.entry.box import box_of
from robomill.ui.toolpath.sources import put_dropped
from robomill.units import unit_label

FILE, UNIT, FEEDS, OPEN = (f"toolpath.points.{name}" for name in ("file", "unit", "feed", "open"))
NOT_SAID = "as the header says"


def take(data: bytes, name: str) -> None:
    """Points that somebody brought: the path, or a question. Raises the refusal of what no answer can mend."""
    _forget()
    try:
        put_dropped(points_from_bytes(data, name))
    except ToolpathError as exc:
        if exc.where not in ("unit", "feed"):
            raise
        session.keep(FILE, (data, name))
        session.keep(OPEN, str(exc))


def panel() -> None:
    """What is asked of a table that does not say all."""
    question: str | None = session.kept(OPEN)
    if question is None:
        return
    with st.container(border=True, key="toolpath-points"):
        pieces.said("warning", question, "straighten")
        units = {"": NOT_SAID, **{unit: unit_label(unit) for unit in ASKED}}
        inputs.pick("Unit of the points", UNIT, units, "")
        box = box_of(FEED, label="Feed of all moves", unit=declared.in_view(FEED.unit), optional=True)
        inputs.value(FEEDS, box, session.kept(FEEDS), _keep_feed)
        with st.container(horizontal=True, gap="small"):
            inputs.button("Take the points", "toolpath.points.take", "check", _answer, type="primary")
            inputs.button("Leave them", "toolpath.points.leave", "close", _forget, type="tertiary")


def _keep_feed(v_f: float | None) -> None:
    session.keep(FEEDS, v_f)


def _answer() -> None:
    data, name = session.kept(FILE)
    put_dropped(points_from_bytes(data, name, session.kept(UNIT, ""), session.kept(FEEDS)))
    _forget()


def _forget() -> None:
    names: tuple[Any, ...] = (FILE, UNIT, FEEDS, OPEN)
    for name in names:
        session.drop(name)
