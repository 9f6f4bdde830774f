"""The sketch's inputs: ready-made sketches, feeds and heights, the table of shapes, and the way out as G-code."""

from typing import Any

import pandas as pd
import streamlit as st

from robomill.quantities import quantities
from robomill.toolpath.sketch import SHAPES, Sketch
from robomill.toolpath.sketch_presets import PRESETS, preset
from robomill.ui import pieces, session
from robomill.ui.entry import declared, grid, inputs
from robomill.ui.entry.box import NumberBox
from robomill.ui.toolpath.sketch_table import sketch_frame, sketch_from_frame
from robomill.ui.toolpath.sources import put_sketch, sketch_source
from robomill.units import format_si, unit_label

SHAPE, WORD = "toolpath.preset", "toolpath.word"


def sketch_inputs() -> None:
    """Everything about the sketch but the board."""
    _presets()
    _settings()
    _table()
    _export()


def _presets() -> None:
    with st.container(horizontal=True, vertical_alignment="bottom", gap="small"):
        chosen = inputs.pick("Ready-made sketch", SHAPE, PRESETS, "slot", inputs.LISTED)
        word = session.kept(WORD, "ROBOMILL")
        inputs.button("Draw it", "toolpath.draw", "draw", inputs.submit, WORD, word, lambda: _draw(word))
    if chosen == "word":
        inputs.text("Word", WORD, word, _draw, max_chars=40)
    else:
        inputs.sentence(WORD)


def _draw(word: str) -> None:
    session.keep(WORD, word)
    name, cutter = session.kept(SHAPE, "slot"), session.project().setup.cutter
    put_sketch(preset(name, sketch_source().sketch, cutter.diameter, word), f"ready-made: {PRESETS[name]}")


def _settings() -> None:
    st.markdown("**New shapes**")
    left, right = st.columns(2)
    with left:
        _setting("v_f")
        st.caption(f"that is {format_si(sketch_source().sketch.v_f, 'mm/s', 1)}")
    with right:
        _setting("depth")
        inputs.button("For all shapes", "toolpath.all", "done_all", _all, type="tertiary")
    with st.expander("Plunge, clearance, spindle", icon=":material/height:"):
        declared.in_row(("v_plunge", "clearance", "n_s"), _setting)


def _setting(name: str) -> None:
    sketch = sketch_source().sketch
    said, write = quantities(Sketch)[name], lambda new: put_sketch(sketch.replace(**{name: new}))
    declared.draw(said, f"toolpath.{name}", getattr(sketch, name), write)


def _all() -> None:
    sketch = sketch_source().sketch
    same: dict[str, Any] = {"v_f": sketch.v_f, "depth": sketch.depth}
    put_sketch(sketch.replace(elements=tuple(e.replace(**same) for e in sketch.elements)))


def _table() -> None:
    view = session.project().view
    length, feed = view.length, view.feed

    def write(frame: pd.DataFrame) -> None:
        put_sketch(sketch_from_frame(frame, sketch_source().sketch, length), from_editor=True)

    column = st.column_config
    grid.table(
        f"toolpath.shapes:{view.units}",
        lambda: sketch_frame(sketch_source().sketch, length),
        write,
        grid.Sheet(
            numbers={"depth": NumberBox("depth", length), "feed": NumberBox("feed", feed)},
            width={"depth": 68, "feed": 58},
            columns={
                "line": column.NumberColumn("no.", width=38, help="The order of the cuts, and the line in the results"),
                "shape": column.SelectboxColumn("shape", options=list(SHAPES), width=80),
                "points": column.TextColumn(
                    f"points ({unit_label(length)})",
                    width=122,
                    help="x, y; x, y; … · line: start; end · rectangle: two corners · circle: centre; point on it · "
                    "arc: start; on the way; end · polyline and polygon: any number",
                ),
            },
            locked=("line",),
            dynamic=True,
            height=pieces.rows_high(len(sketch_source().sketch.elements) + 1, 330),
        ),
    )
    pieces.note(
        f"Points and depth in {unit_label(length)} from the part zero {{W}} on the top face, feed in "
        f"{unit_label(feed)}. Table and board are the same sketch."
    )


def _export() -> None:
    """The path as a G-code file, in the unit of the screen."""
    if not sketch_source().sketch.elements:
        return
    # Taken now: when the file is asked for, there is no session to ask for its project.
    setup, unit = session.project().setup, session.project().view.length

    def text() -> str:
        from robomill.io.gcode_out import toolpath_to_gcode

        return toolpath_to_gcode(setup.toolpath, units=unit, title=f"sketch, {setup.name}")

    pieces.download("G-code of this sketch", text, pieces.named("sketch.nc"), "toolpath.export")
