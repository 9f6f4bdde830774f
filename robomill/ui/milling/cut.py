"""Cutter, stock, tolerance and accuracy of the cut."""

from __future__ import annotations

from typing import Any

import numpy as np
import streamlit as st

from robomill.cutting.tool import Cutter
from robomill.io.meshes import read_stl_stock
from robomill.surface.stock import Stock
from robomill.ui import boxes, inputs, parts, state
from robomill.units import format_count, format_many

KINDS = {"flat": "Flat", "ball": "Ball", "bull": "Bull", "chamfer": "Chamfer"}
HANDS = {"right": "right", "left": "left"}
STOCKS = {"path": "Around the path", "block": "Block", "stl": "From STL"}
STL_UNITS = {"mm": "mm", "in": "inch", "m": "m"}
FILE, PENDING, ODD = "milling.stock.file", "milling.stock.pending", "milling.stock.odd"
MAX_STL_MB = 80


def cutter_inputs() -> None:
    """Kind, size, teeth, helix and lengths."""
    cutter, unit = state.project().setup.cutter, state.project().view.length
    inputs.choice("Kind", "cutter.kind", KINDS, cutter.kind, _switch, label_visibility="collapsed")
    step = 1.0 if unit == "mm" else 0.05
    left, right = st.columns(2)
    with left:
        inputs.number("Diameter", "cutter.diameter", unit, step=step)
    with right:
        inputs.whole("Flutes", "cutter.flutes")
    if cutter.kind == "bull":
        inputs.number("Corner radius", "cutter.corner_radius", unit, step=step / 4)
    if cutter.kind == "chamfer":
        left, right = st.columns(2)
        with left:
            inputs.number("Full tip angle", "cutter.tip_angle", "deg", step=5.0)
        with right:
            inputs.number("Tip diameter", "cutter.tip_diameter", unit, step=step / 4)
    left, right = st.columns(2)
    with left:
        _length("Stick-out", "stick_out", "Free length from the holder; tool bending grows with its cube.")
    with right:
        _length("Flute length", "flute_length", "Deeper cuts are warned of: the shank would rub.")
    left, right = st.columns(2)
    with left:
        inputs.choice(
            "Helix",
            "cutter.helix",
            HANDS,
            cutter.helix,
            lambda v: state.change(cutter=_cutter().replace(helix=v)),
            hint="A right-hand helix on a right-hand cutter pulls the tool towards the part.",
        )
    with right:
        inputs.number("Helix angle", "cutter.helix_angle", "deg", step=5.0, digits=1)


def _cutter() -> Cutter:
    return state.project().setup.cutter


def _length(label: str, field: str, hint: str) -> None:
    unit = state.project().view.length
    boxes.number_box(
        label,
        f"cutter.{field}:{unit}",
        getattr(_cutter(), field),
        unit,
        lambda v: state.change(cutter=_cutter().replace(**{field: v})),
        optional=True,
        step=1.0 if unit == "mm" else 0.05,
        digits=1 if unit == "mm" else 3,
        hint=hint,
    )


def _switch(kind: str) -> None:
    old = _cutter()
    common: dict[str, Any] = {
        name: getattr(old, name)
        for name in ("diameter", "flutes", "helix", "helix_angle", "hand", "flute_length", "stick_out")
    }
    special = {"bull": {"corner_radius": old.diameter / 8}, "chamfer": {"tip_angle": np.pi / 2}}.get(kind, {})
    state.change(cutter=Cutter(kind=kind, **common, **special))  # type: ignore[arg-type]


def stock_inputs() -> None:
    """Around the path, a block, or a solid from an STL file."""
    setup, unit = state.project().setup, state.project().view.length
    stock = setup.stock
    given = "path" if stock is None else "stl" if stock.triangles is not None else "block"
    # Asked for, but no file yet; any change of the project makes an end of the wait.
    current = "stl" if st.session_state.get(PENDING) == setup.digest() else given
    inputs.choice("Stock", "stock.kind", STOCKS, current, _switch_stock, label_visibility="collapsed")
    if current == "stl":
        _stl(stock if given == "stl" else None)
    elif stock is None:
        parts.note(f"{parts.badge('computed')} {_size(setup.stock_block)} around the feed moves")
    else:
        for side, label in (("lower", "from"), ("upper", "to")):
            for i, (column, axis) in enumerate(zip(st.columns(3), "XYZ", strict=True)):
                with column:
                    inputs.number(f"{axis} {label}", f"stock.{side}[{i}]", unit, step=1.0, digits=2)


def _size(stock: Stock) -> str:
    unit = state.project().view.length
    return format_many(stock.upper - stock.lower, unit, 1, " × ")


def _switch_stock(kind: str) -> None:
    st.session_state.pop(PENDING, None)
    setup = state.project().setup
    if kind == "path":
        state.change(stock=None)
    elif kind == "block":
        block = setup.stock_block
        state.change(stock=Stock(np.round(block.lower, 9), np.round(block.upper, 9)))
    elif setup.stock is None or setup.stock.triangles is None:
        st.session_state[PENDING] = setup.digest()


def _stl(stock: Stock | None) -> None:
    inputs.choice(
        "Unit of the file",
        "stock.unit",
        STL_UNITS,
        st.session_state.get("milling.stock.unit", "mm"),
        _unit,
        hint="STL carries no unit.",
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
        parts.note(f"{parts.badge('user')} solid of {format_count(count, 'triangle')}, {_size(stock)}")
    elif not state.store().refused.get("stock:file"):
        parts.note("Until a file is given, the stock stays as it was.")


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
        state.change(stock=stock)
        st.session_state[ODD] = odd
        st.session_state.pop(PENDING, None)

    inputs.attempt("stock:file", None, put)


def judgement_inputs() -> None:
    """Tolerance, and how finely path and surface are computed."""
    unit = state.project().view.length
    small = 0.05 if unit == "mm" else 0.002
    inputs.number("Tolerance", "tolerance", unit, step=small)
    left, right = st.columns(2)
    with left:
        inputs.number("Cell of the surface", "cell", unit, step=small, digits=4)
    with right:
        inputs.number("Step along the path", "step", unit, step=0.5 if unit == "mm" else 0.02)
