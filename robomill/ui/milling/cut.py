"""Cutter, stock, tolerance and accuracy of the cut."""

from __future__ import annotations

from typing import Any

import numpy as np
import streamlit as st

from robomill.cutting.tool import SHAPES
from robomill.io.meshes import read_stl_stock
from robomill.surface.stock import Stock
from robomill.ui import inputs, pieces, session
from robomill.ui.milling.numbers import box
from robomill.units import format_count, format_many

STOCKS = {"path": "Around the path", "block": "Block", "stl": "From STL"}
STL_UNITS = {"mm": "mm", "in": "inch", "m": "m"}
FILE, PENDING, ODD = "milling.stock.file", "milling.stock.pending", "milling.stock.odd"
MAX_STL_MB = 80


def cutter_inputs() -> None:
    """Kind, size, teeth, helix and lengths."""
    cutter = session.project().setup.cutter
    kinds = {kind: shape.short for kind, shape in SHAPES.items()}
    inputs.choice("Kind", "cutter.kind", kinds, cutter.kind, _switch, inputs.HIDDEN)
    _rows(["diameter", "flutes"], list(cutter.shape.needs), ["stick_out", "flute_length"], ["helix", "helix_angle"])


def _rows(*rows: list[str]) -> None:
    for names in filter(None, rows):
        for column, name in zip(st.columns(len(names)), names, strict=True):
            with column:
                box(f"cutter.{name}")


def _switch(kind: Any) -> None:
    session.change(cutter=session.project().setup.cutter.reshaped(kind))


def stock_inputs() -> None:
    """Around the path, a block, or a solid from an STL file."""
    setup = session.project().setup
    stock = setup.stock
    given = "path" if stock is None else "stl" if stock.triangles is not None else "block"
    # Asked for, but no file yet; any change of the project makes an end of the wait.
    current = "stl" if st.session_state.get(PENDING) == setup.digest() else given
    inputs.choice("Stock", "stock.kind", STOCKS, current, _switch_stock, inputs.HIDDEN)
    if current == "stl":
        _stl(stock if given == "stl" else None)
    elif stock is None:
        pieces.note(f"{pieces.badge('computed')} {_size(setup.stock_block)} around the feed moves")
    else:
        box("stock.lower")
        box("stock.upper")


def _size(stock: Stock) -> str:
    unit = session.project().view.length
    return format_many(stock.upper - stock.lower, unit, 1, " × ")


def _switch_stock(kind: str) -> None:
    st.session_state.pop(PENDING, None)
    setup = session.project().setup
    if kind == "path":
        session.change(stock=None)
    elif kind == "block":
        block = setup.stock_block
        session.change(stock=Stock(np.round(block.lower, 9), np.round(block.upper, 9)))
    elif setup.stock is None or setup.stock.triangles is None:
        st.session_state[PENDING] = setup.digest()


def _stl(stock: Stock | None) -> None:
    inputs.choice(
        "Unit of the file",
        "stock.unit",
        STL_UNITS,
        st.session_state.get("milling.stock.unit", "mm"),
        _unit,
        inputs.Look(hint="STL carries no unit."),
    )
    key = "stock:file"
    st.file_uploader(
        "Stock as a closed solid (.stl), placed in {W}",
        key=key,
        max_upload_size=MAX_STL_MB,
        on_change=lambda: _take(st.session_state.get(key)),
    )
    inputs.sentence("stock:file")
    for words in st.session_state.get(ODD, ()) if stock is not None else ():
        st.warning(words, icon=":material/straighten:")
    if stock is not None:
        count = 0 if stock.triangles is None else len(stock.triangles)
        pieces.note(f"{pieces.badge('user')} solid of {format_count(count, 'triangle')}, {_size(stock)}")
    elif not session.store().refused.get("stock:file"):
        pieces.note("Until a file is given, the stock stays as it was.")


def _unit(unit: str) -> None:
    st.session_state["milling.stock.unit"] = unit
    if FILE in st.session_state:
        _read()


def _take(file: Any) -> None:
    if file is None:
        inputs.accept("stock:file")
        return
    st.session_state[FILE] = (file.name, file.getvalue())
    _read()


def _read() -> None:
    name, data = st.session_state[FILE]

    def put() -> None:
        stock, odd = read_stl_stock(data, unit=st.session_state.get("milling.stock.unit", "mm"), name=name)
        session.change(stock=stock)
        st.session_state[ODD] = odd
        st.session_state.pop(PENDING, None)

    inputs.submit("stock:file", None, put)


def judgement_inputs() -> None:
    """Tolerance, and how finely path and surface are computed."""
    box("tolerance")
    left, right = st.columns(2)
    with left:
        box("cell")
    with right:
        box("step")
