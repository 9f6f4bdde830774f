"""The machined surface to take away: as a picture that the server renders, as numbers, as a solid."""

from collections.abc import Callable
from functools import partial

import numpy as np
import streamlit as st

from robomill.csv_text import csv_text
from robomill.io.meshes import FEW_TRIANGLES, FORMATS, MOST_TRIANGLES, absent, mesh_bytes
from robomill.simulation.enlarged import so_far, tip_drawn
from robomill.simulation.result import SimulationResult
from robomill.surface.zmap import ZMap
from robomill.ui import pieces, rendered, session
from robomill.ui.entry import inputs
from robomill.ui.milling import live_cut, scrubber as linked
from robomill.ui.work import cached
from robomill.units import format_si
from robomill.viz.rendered import worker
from robomill.viz.rendered.picture import SurfacePicture
from robomill.viz.rendered.posed import posed
from robomill.viz.views import surface_picture

PLACE = "milling.picture"
STANDING = frozenset({"tool", "arm"})
SIZE = (1360, 720)
FULL = "milling.get.full"
# s on a desktop of 2024, measured: a picture; a sample's row; a cell of a solid, with its error, and one with a wall.
DRAWING_S, ROW_S, CELL_S, FIELD_S, WALL_S = 1.0, 3e-5, 3e-7, 4e-7, 6e-6


def rendered_picture(result: SimulationResult, i: int, dark: bool) -> None:
    """The picture that the server draws, as the browser looks at the cut."""
    key, make = scene(result, i, dark)
    alt = "The machined surface coloured by its signed error."
    rendered.picture(PLACE, key, make, alt, lambda: pieces.note("No picture can be drawn here."))


def scene(result: SimulationResult, i: int, dark: bool) -> tuple[tuple[object, ...], Callable[[], SurfacePicture]]:
    """The key of what is drawn, which is all that it depends on, and what makes it (in any thread)."""
    view = session.project().view
    look = live_cut.state()
    extras = frozenset({*look["show"], *(["arm"] if look["view"] == "arm" else [])})
    pair = look["view"] == "pair"
    moves = bool(extras & {"plane", "away", "tool", "arm", "so_far"})
    station = linked.station_m(result)

    def make() -> SurfacePicture:
        shown = cached.pictured(result.setup, view.exaggeration)
        stand = extras & STANDING and i >= 0
        solids = posed(result, i, tip_drawn(result, shown, i), arm="arm" in extras) if stand else ()
        return surface_picture(
            result,
            so_far(result, shown, i) if "so_far" in extras else shown,
            error_unit=view.length,
            camera=view.camera,
            dark=dark,
            station=station if extras & {"plane", "away"} else None,
            at=station,
            size=SIZE,
            layout="pair" if pair else "one",
            cutaway="away" in extras,
            ghost="ghost" in extras,
            solids=solids,
            whole="arm" in extras and bool(solids),
        )

    place = round(station, 6) if moves else None
    key = ("milling", result.setup.digest(), view.exaggeration, place, tuple(sorted(extras)), pair, view.camera)
    return (*key, dark, SIZE, view.units), make


def downloads(result: SimulationResult, i: int) -> None:
    """Deviation as CSV, picture as PNG, the surface in the formats people ask for, thinned unless all of it is."""
    setup, full = result.setup, bool(session.kept(FULL, False))
    most = MOST_TRIANGLES if full else FEW_TRIANGLES

    def making(seconds: float) -> pieces.Making:
        return pieces.Making(seconds, lambda: cached.by_result(result))

    with st.container(horizontal=True, gap="small"):
        table = partial(_csv, result)
        long = making(ROW_S * len(result.path))
        pieces.download("Deviation CSV", table, pieces.named("deviation.csv"), "milling.get.deviation", long)
        key, make = scene(result, i, False)
        refusals = {"png": worker.absent(), "vtp": absent("vtp")}
        long = pieces.Making(0.0 if rendered.there(key) else DRAWING_S, lambda: key)
        png, off = partial(rendered.now, PLACE, key, make), refusals["png"] is not None
        pieces.download("Picture PNG", png, pieces.named("part.png"), "milling.get.png", long, disabled=off)
        for kind in FORMATS:
            solid = partial(_mesh, result, kind, most)
            long = pieces.Making(_mesh_seconds(result, kind), lambda: (cached.by_result(result), most))
            name = pieces.named(f"surface.{kind}")
            off = refusals.get(kind) is not None
            pieces.download(f"Surface {kind.upper()}", solid, name, f"milling.get.{kind}", long, disabled=off)
    for refusal in filter(None, refusals.values()):
        pieces.note(str(refusal))
    unit = session.project().view.length
    every = format_si(max(_spacing(result, most), setup.cell), unit, 2)
    thinned = f", thinned from {format_si(setup.cell, unit, 2)}" if _spacing(result, most) > setup.cell else ""
    inputs.switch("Surfaces with every cell", FULL, full, partial(session.keep, FULL))
    pieces.note(
        f"Surfaces are closed solids in mm, true to size, with each wall in its place and a height every {every}"
        f"{thinned}; VTP carries the signed error."
    )


def _spacing(result: SimulationResult, most: int) -> float:
    """How far apart (m) the heights of a solid of about ``most`` triangles lie."""
    low, high = result.setup.stock_block.lower[:2], result.setup.stock_block.upper[:2]
    return float(np.sqrt(2.0 * np.prod(high - low) / most))


def _csv(result: SimulationResult) -> str:
    return csv_text(result.columns())


def _mesh_seconds(result: SimulationResult, kind: str) -> float:
    """About how long a solid takes to be made and written; no time is known of a surface that is not there yet."""
    surface: ZMap | None = vars(result).get("machined")
    if surface is None:
        return float("inf")
    return surface.z.size * (CELL_S + (FIELD_S if kind == "vtp" else 0.0)) + len(surface.edge.index) * WALL_S


def _mesh(result: SimulationResult, kind: str, most: int) -> bytes:
    error = np.asarray(result.error.error) if kind == "vtp" else None
    return mesh_bytes(result.machined, kind, error=error, max_faces=most)
