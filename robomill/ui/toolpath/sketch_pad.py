"""The sketch pad: a drawing board in the browser that writes the project's sketch.

While a shape is being drawn it lives in the browser; every finished step is sent here and becomes one change of the
project, so that undo, the table and saved files see the same sketch. The pad is overwritten only when its ``rev``
changes: after undo, a preset, or an edit of the table.
"""

from dataclasses import dataclass
from typing import Any

import streamlit as st

from robomill.arrays import digest
from robomill.toolpath.sketch import Sketch
from robomill.toolpath.source import SketchSource
from robomill.ui import session
from robomill.ui.component import component
from robomill.ui.entry import inputs
from robomill.ui.project import Project
from robomill.ui.toolpath.sketch_table import in_unit, pad_elements, sketch_from_pad
from robomill.ui.toolpath.sources import put_sketch
from robomill.units import UNITS

KEY = "toolpath.pad"
MEMORY = "toolpath.pad-memory"
HEIGHT = 430


_component = component("robomill_sketch_pad", __file__)


@dataclass
class PadMemory:
    """What the browser knows: ``rev`` counts overwrites, ``known`` is the digest of the shapes it has."""

    rev: int = 0
    known: str = ""


def sketch_pad(sketch: Sketch, cutter: float, reach: dict[str, Any] | None, height: int = HEIGHT) -> None:
    """The drawing board for ``sketch``. ``cutter`` (m) is its diameter; ``reach`` hatches what the arm cannot reach.

    ``reach``: x, y, dx, dy of a grid in display units and runs [row, from, to) of cells out of reach.
    """
    view, held = session.project().view, session.store()
    memory = _memory()
    shown = _fingerprint(sketch, view.length)
    if shown != memory.known:
        memory.rev, memory.known = memory.rev + 1, shown
    data = {
        "rev": memory.rev,
        "unit": UNITS[view.length].label,
        "height": height,
        "elements": pad_elements(sketch, view.length, view.feed),
        "grid": in_unit(sketch.grid, view.length),
        "depth": in_unit(sketch.depth, view.length),
        "feed": in_unit(sketch.v_f, view.feed),
        "cutter": in_unit(cutter, view.length),
        "reach": reach,
        "undo": _leads_to_a_sketch(held.past),
        "redo": _leads_to_a_sketch(held.future),
    }
    _component(key=KEY, data=data, on_sketch_change=_take, on_history_change=_history)
    inputs.sentence(KEY)


def _memory() -> PadMemory:
    memory: PadMemory = session.kept(MEMORY) or PadMemory()
    session.keep(MEMORY, memory)
    return memory


def _take() -> None:
    # The component's own state, here and in ``_history``: Streamlit puts there what the browser sends.
    sent = st.session_state[KEY].get("sketch")
    memory = _memory()
    source = session.project().setup.source
    # What was drawn on a board that has been overwritten since is not merged into the new one.
    if not sent or sent.get("rev") != memory.rev or source.kind != "sketch":
        return
    inputs.submit(KEY, None, lambda: _write(dict(sent), source, memory))
    if KEY in session.store().refused:
        memory.known = ""


def _write(sent: dict[str, Any], source: SketchSource, memory: PadMemory) -> None:
    view = session.project().view
    new = sketch_from_pad(sent, source.sketch, view.length, view.feed)
    put_sketch(new)
    memory.known = _fingerprint(new, view.length)


def _history() -> None:
    asked, held = st.session_state[KEY].get("history"), session.store()
    if not asked:
        return
    back = asked.get("way") == "undo"
    if _leads_to_a_sketch(held.past if back else held.future):
        (session.undo if back else session.redo)()


def _leads_to_a_sketch(steps: list[Project]) -> bool:
    """The board's own undo stays with the sketch; the one in the sidebar goes on."""
    return bool(steps) and steps[-1].setup.source.kind == "sketch"


def _fingerprint(sketch: Sketch, unit: str) -> str:
    return digest((sketch.elements, unit))
