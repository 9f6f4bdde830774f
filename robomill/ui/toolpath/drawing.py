"""A drawing on the toolpath page: its layers in a table, what is cut of each, and the sketch that this makes."""

from pathlib import PurePath
from typing import Any

import numpy as np
import pandas as pd
import streamlit as st

from robomill.errors import RobomillError, ToolpathError, UnitAskedError
from robomill.io.drawing.drawings import ASKED, drawing_from_bytes
from robomill.quantities import quantities
from robomill.toolpath.drawing import ORIGINS, SIDES, Drawing, LayerCut
from robomill.toolpath.sketch import Sketch
from robomill.toolpath.source import SketchSource
from robomill.ui import pieces, session
from robomill.ui.entry import declared, grid, inputs
from robomill.ui.entry.box import box_of
from robomill.ui.toolpath.sources import put_dropped
from robomill.units import format_count, format_many, unit_label

FILE, DRAWING, UNIT, ORIGIN, CUTS, OPEN = (
    f"toolpath.drawing.{name}" for name in ("file", "read", "unit", "origin", "cuts", "open")
)
TABLE = "toolpath.drawing.layers"
NUMBERS = ("depth", "step_down", "v_f")
MOST_DRAWN = 20_000  # points of the small picture
ROWS_HIGH = 260
HEADS = {"depth": "depth", "step_down": "step", "v_f": "feed"}
LINE = "#3b93bd"  # seen on light and dark


def take(data: bytes, name: str) -> None:
    """A drawing that somebody brought: it is shown, and cut along when that is asked for. Raises its refusal."""
    _forget()
    session.keep(FILE, (data, name))
    try:
        _keep(drawing_from_bytes(data, name))
    except UnitAskedError as exc:
        session.keep(OPEN, str(exc))
    except ToolpathError:
        _forget()
        raise


def shown() -> bool:
    """Whether a drawing waits to be cut along: its table wants room."""
    return session.kept(DRAWING) is not None


def panel() -> None:
    """The drawing, its layers and what is cut of them; what it does not say is asked for."""
    drawing: Drawing | None = session.kept(DRAWING)
    question: str | None = session.kept(OPEN)
    if drawing is None and question is None:
        return
    with st.container(border=True, key="toolpath-drawing"):
        pieces.strong(f"Drawing {session.kept(FILE)[1]}")
        if question is not None:
            pieces.said("warning", question, "straighten")
        _unit(drawing)
        if drawing is not None:
            _layers(drawing)
        with st.container(horizontal=True, gap="small"):
            if drawing is not None:
                inputs.button("Cut along it", "toolpath.drawing.cut", "content_cut", _cut, type="primary")
            inputs.button("Put it away", "toolpath.drawing.leave", "close", _forget, type="tertiary")


def _unit(drawing: Drawing | None) -> None:
    """Asked for where the file is silent; a DXF may say it wrongly."""
    name = session.kept(FILE)[1]
    if drawing is not None and PurePath(name).suffix.lower() == ".svg" and not session.kept(UNIT):
        return
    current = session.kept(UNIT, "" if drawing is None else drawing.unit)
    units = {unit: unit for unit in ASKED}
    inputs.choice("Unit of the drawing", f"{UNIT}.choice", units, current, _take_unit, inputs.LISTED)


def _layers(drawing: Drawing) -> None:
    unit = session.project().view.length
    low, high = drawing.extents
    st.image(picture(drawing), width="stretch")
    size = format_many(high - low, unit, 1, between=" × ")
    pieces.note(f"{format_count(len(drawing.contours), 'line')} within {size}, drawn in {drawing.unit}.")
    inputs.pick("Part zero", ORIGIN, ORIGINS, "drawing", inputs.LISTED)
    boxes = {name: box_of(said, unit=declared.in_view(said.unit)) for name, said in _said().items()}
    column = st.column_config
    grid.table(
        f"{TABLE}:{unit}",
        lambda: cuts_frame(session.kept(CUTS)),
        lambda frame: session.keep(CUTS, cuts_of(frame)),
        grid.Sheet(
            numbers=boxes,
            heads=HEADS,
            width={"depth": 74, "step_down": 68, "v_f": 70},
            columns={
                "cut": column.CheckboxColumn("cut", width=58),
                "layer": column.TextColumn("layer", width=64),
                "side": column.SelectboxColumn("side", options=list(SIDES), width=68),
            },
            locked=("layer",),
            height=pieces.rows_high(len(drawing.layers), ROWS_HIGH),
        ),
    )
    pieces.note(
        f"Depth and step down in {unit_label(unit)}, feed in {boxes['v_f'].title.rpartition(', ')[2]}. Without a step "
        "each line is cut in one pass; passes are alike, none deeper than the step. Beside a line by the radius of the "
        "cutter in force; inside and outside are climb milling. The tool plunges straight down where a line begins."
    )
    for finding in drawing.findings:
        pieces.note(finding.sentence[:1].upper() + finding.sentence[1:])


def _said() -> dict[str, Any]:
    said = quantities(LayerCut)
    return {name: said[name] for name in NUMBERS}


def _take_unit(unit: str) -> None:
    data, name = session.kept(FILE)
    session.keep(UNIT, unit)
    _keep(drawing_from_bytes(data, name, unit))


def _keep(drawing: Drawing) -> None:
    """What is cut at first: every layer that is on, on its lines, as deep and as fast as new shapes of the sketch."""
    sketch = _base()
    first = {
        layer: (layer not in drawing.hidden, LayerCut(layer, sketch.depth, sketch.v_f)) for layer in drawing.layers
    }
    session.drop(OPEN)
    session.keep(DRAWING, drawing)
    session.keep(CUTS, first)


def _base() -> Sketch:
    """Whose plunge, clearance and spindle hold: the sketch in force, or a new one at the speed of the path so far."""
    setup = session.project().setup
    if setup.source.kind == "sketch":
        return setup.source.sketch
    try:
        speeds = setup.toolpath.n_s
    except RobomillError:
        return Sketch()
    return Sketch(n_s=float(np.nanmax(speeds, initial=0.0)))


def _cut() -> None:
    drawing: Drawing = session.kept(DRAWING)
    cuts = [cut for wanted, cut in session.kept(CUTS).values() if wanted]
    if not cuts:
        raise ToolpathError(f"{drawing.name}: no layer is to be cut; tick one.")
    moved = drawing.moved(session.kept(ORIGIN, "drawing"))
    sketch = moved.sketch(cuts, session.project().setup.cutter.diameter, sketch=_base())
    put_dropped(SketchSource(sketch, PurePath(drawing.name).name))


def _forget() -> None:
    for name in (FILE, DRAWING, UNIT, ORIGIN, CUTS, OPEN):
        session.drop(name)


# ---- between the table on the page and the cuts --------------------------------------------------------------------


def cuts_frame(cuts: dict[str, tuple[bool, LayerCut]]) -> pd.DataFrame:
    """One row a layer, numbers in SI."""
    rows = [(wanted, layer, cut.side, cut.depth, cut.step_down, cut.v_f) for layer, (wanted, cut) in cuts.items()]
    return pd.DataFrame(rows, columns=["cut", "layer", "side", *NUMBERS])


def cuts_of(frame: pd.DataFrame) -> dict[str, tuple[bool, LayerCut]]:
    """The cuts by layer, each with whether it is wanted. Raises ToolpathError naming the layer."""
    found = {}
    for _, row in frame.iterrows():
        given = {name: None if grid.empty(row[name]) else float(row[name]) for name in NUMBERS}
        cut = LayerCut(str(row["layer"]), side=str(row["side"]), **given)  # type: ignore[arg-type]
        found[cut.layer] = bool(row["cut"]), cut
    return found


def picture(drawing: Drawing) -> str:
    """The lines, small, as an SVG of our own."""
    low, high = drawing.extents
    size = np.maximum(high - low, 1e-9)
    scale = 1000.0 / float(size.max())
    chains = [contour.outline() for contour in drawing.contours]
    every = 1 + sum(map(len, chains)) // MOST_DRAWN
    paths = []
    for chain in chains:
        some = chain if every == 1 else np.vstack([chain[:-1:every], chain[-1:]])
        x, y = ((some - [low[0], high[1]]) * [scale, -scale]).T
        paths.append("M" + "L".join(f"{u:.1f} {v:.1f}" for u, v in zip(x, y, strict=True)))
    wide, high_px = (float(value) * scale for value in size)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-10 -10 {wide + 20:.1f} {max(high_px, 1.0) + 20:.1f}">'
        f'<path d="{"".join(paths)}" fill="none" stroke="{LINE}" stroke-width="1.5" '
        'vector-effect="non-scaling-stroke"/></svg>'
    )
