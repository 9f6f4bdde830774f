"""Cutter, stock, tolerance and accuracy of the cut."""

from functools import partial

import numpy as np

from robomill.errors import RobomillError
from robomill.io.meshes import UNITS_OF_STL, read_stl_stock
from robomill.simulation.setup import SimulationSetup
from robomill.surface.stock import Stock
from robomill.ui import pieces, session
from robomill.ui.entry import declared, inputs
from robomill.ui.work import running
from robomill.units import format_count, format_many, format_short

STOCKS = {"path": "Around the path", "block": "Block", "stl": "From a solid"}
FILE, UNIT = "milling.stock.file", "milling.stock.unit"
PENDING, ODD = "milling.stock.pending", "milling.stock.odd"
MAX_STL_MB = 80


def cutter_inputs() -> None:
    """Kind, size, teeth, helix and lengths."""
    cutter = session.project().setup.cutter
    declared.field("cutter.kind", lambda kind: session.change(cutter=cutter.reshaped(kind)), inputs.HIDDEN)
    for names in (("diameter", "flutes"), cutter.family.needs, ("stick_out", "flute_length"), ("helix", "helix_angle")):
        if names:
            declared.in_row([f"cutter.{name}" for name in names], declared.field)


def cutter_words() -> str:
    """The cutter in short: its diameter and its teeth."""
    cutter = session.project().setup.cutter
    return f"{format_short(cutter.diameter, session.project().view.length)}, {format_count(cutter.flutes, 'flute')}"


def stock_words() -> str:
    """The size of the stock."""
    stock = session.project().setup.stock
    return _around(session.project().setup) if stock is None else _size(stock)


def stock_inputs() -> None:
    """Around the path, a block, or a solid from a file."""
    setup = session.project().setup
    stock = setup.stock
    given = "path" if stock is None else "stl" if stock.triangles is not None else "block"
    # Asked for, but no file yet; any change of the project makes an end of the wait.
    current = "stl" if session.kept(PENDING) == setup.digest() else given
    inputs.choice("Stock", "milling.stock", STOCKS, current, _switch_stock, inputs.HIDDEN)
    if current == "stl":
        _stl(stock if given == "stl" else None)
    elif stock is None:
        pieces.note(pieces.badge("computed"), f"{_around(setup)} around the feed moves")
    else:
        declared.field("stock.lower")
        declared.field("stock.upper")


def _size(stock: Stock) -> str:
    unit = session.project().view.length
    return format_many(stock.upper - stock.lower, unit, 1, " × ")


def _around(setup: SimulationSetup) -> str:
    """The size of the stock around the path; "" while the path is refused, which the page says."""
    try:
        running.wait_for_path(setup)
        return _size(setup.stock_block)
    except RobomillError:
        return ""


def _switch_stock(kind: str) -> None:
    session.drop(PENDING)
    setup = session.project().setup
    if kind == "path":
        session.change(stock=None)
    elif kind == "block":
        running.wait_for_path(setup)
        block = setup.stock_block
        session.change(stock=Stock(np.round(block.lower, 9), np.round(block.upper, 9)))
    elif setup.stock is None or setup.stock.triangles is None:
        session.keep(PENDING, setup.digest())


def _stl(stock: Stock | None) -> None:
    look = inputs.Look(hint="STL, OBJ and PLY carry no unit; a 3MF says its own, which holds.")
    take = partial(inputs.reread, FILE, _take, UNIT)
    inputs.choice("Unit of the file", UNIT, UNITS_OF_STL, session.kept(UNIT, "mm"), take, look)
    inputs.upload("Stock as a closed solid (.stl, .obj, .ply, .3mf), placed in {W}", FILE, _take, most_MB=MAX_STL_MB)
    if stock is not None and stock.triangles is not None:
        for finding in session.kept(ODD, ()):
            pieces.said("warning", finding.sentence, "straighten")
        solid = format_count(len(stock.triangles), "triangle")
        pieces.note(pieces.badge("user"), f"solid of {solid}, {_size(stock)}")
    elif FILE not in session.store().refused:
        pieces.note("Until a file is given, the stock stays as it was.")


def _take(data: bytes, name: str) -> None:
    """Read the file in the unit as it stands; it is kept, to be read again in another."""
    session.keep(FILE, (data, name))
    stock, odd = read_stl_stock(data, unit=session.kept(UNIT, "mm"), name=name)
    session.change(stock=stock)
    session.keep(ODD, odd)
    session.drop(PENDING)


def judgement_inputs() -> None:
    """Tolerance, and how finely path and surface are computed."""
    declared.field("tolerance")
    declared.in_row(("floor_tolerance", "feed_tolerance"), declared.field)
    declared.in_row(("cell", "step"), declared.field)
