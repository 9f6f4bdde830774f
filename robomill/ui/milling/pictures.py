"""Pictures of the machined surface: rendered, beside the ideal one, or turnable; surfaces to take away."""

from collections.abc import Callable
from functools import partial

import numpy as np
import streamlit as st

from robomill.io.meshes import FORMATS, mesh_bytes
from robomill.report.tables import csv_text, deviation_columns
from robomill.simulation.enlarged import so_far, tip_drawn
from robomill.simulation.result import SimulationResult
from robomill.surface.zmap import ZMap
from robomill.ui import cached, declared, inputs, pieces, rendered, session
from robomill.ui.milling import scrubber as linked
from robomill.units import format_si, format_times
from robomill.viz.picture import SurfacePicture
from robomill.viz.posed import posed
from robomill.viz.surfaces import surface_figure
from robomill.viz.views import surface_picture

HOW = {"one": "Rendered", "pair": "Beside the ideal", "turn": "Turnable"}
EXTRAS = {
    "plane": "Section plane",
    "away": "Cut open",
    "ghost": "Ideal as ghost",
    "tool": "Tool",
    "arm": "Arm",
    "so_far": "Cut so far",
}
EXAGGERATIONS = {1.0: "true", 5.0: "× 5", 10.0: "× 10", 20.0: "× 20", 50.0: "× 50"}
VIEW, WITH = "milling.picture.view", "milling.picture.with"
PLACE = "milling.picture"
STANDING = frozenset({"tool", "arm"})
SIZE = (1360, 720)
# s on a desktop of 2024, measured: a picture; a sample's row; a cell of a solid, with its error, and one with a wall.
DRAWING_S, ROW_S, CELL_S, FIELD_S, WALL_S = 1.0, 3e-5, 3e-7, 4e-7, 6e-6


def panel(result: SimulationResult, i: int, dark: bool, height: int = 430) -> None:
    """The picture with its controls."""
    how = _controls()
    view, tolerance, floors = session.project().view, result.setup.tolerance, result.verdict.floor.tolerance

    def turnable() -> None:
        shown = pieces.attempt(cached.pictured, result.setup, view.exaggeration)
        if shown is not None:
            fig = surface_figure(shown, tolerance, view.length, dark=dark, height=height, camera=view.camera)
            pieces.figure(fig, "surface", alt="The machined surface, to be turned with the mouse.")

    if how == "turn":
        turnable()
    else:
        key, make = scene(result, i, dark)
        rendered.picture(PLACE, key, make, "The machined surface coloured by its signed error.", turnable)
    times = (
        "True displacement" if view.exaggeration == 1 else f"Displacement shown {format_times(view.exaggeration, 6)}"
    )
    ends, other = f"± {format_si(tolerance, 'um', 0)}", f"± {format_si(floors, 'um', 0)}"
    ends = f"tolerance, {ends}" if floors == tolerance else f"tolerance of walls, {ends} (floors: {other})"
    pieces.note(
        f"{times}. Colours are the true error, of floors in height and of walls sideways; they end at the {ends}."
    )


def _controls() -> str:
    view = session.project().view
    first, camera, times = pieces.split([2.1, 1.3, 0.9], "picture", gap="small")
    with first:
        how = inputs.pick("View", VIEW, HOW)
    with camera:
        declared.seen("view.camera", inputs.LISTED)
    with times:
        known = view.exaggeration in EXAGGERATIONS
        options = EXAGGERATIONS if known else {**EXAGGERATIONS, view.exaggeration: format_times(view.exaggeration, 6)}
        declared.seen("view.exaggeration", inputs.LISTED, options)
    if how != "turn":
        inputs.several("With", WITH, EXTRAS, _extras(), partial(session.keep, WITH), inputs.HIDDEN)
    return str(how)


def _extras() -> list[str]:
    return list(session.kept(WITH, ["plane"]))


def scene(result: SimulationResult, i: int, dark: bool) -> tuple[tuple[object, ...], Callable[[], SurfacePicture]]:
    """The key of what is drawn, which is all that it depends on, and what makes it (in any thread)."""
    view = session.project().view
    extras = frozenset(_extras())
    pair = session.kept(VIEW, "one") == "pair"
    moves = bool(extras & {"plane", "away", "tool", "arm", "so_far"})
    station = linked.station_m(result)

    def make() -> SurfacePicture:
        shown = cached.pictured(result.setup, view.exaggeration)
        stand = extras & STANDING and i >= 0
        solids = posed(result, i, tip_drawn(result, shown, i), arm="arm" in extras) if stand else ()
        return surface_picture(
            result,
            so_far(result, shown, i) if "so_far" in extras else shown,
            error_unit=view.of("um"),
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
    """Deviation as CSV, picture as PNG, the surface in the formats people ask for."""
    setup = result.setup

    def making(seconds: float) -> pieces.Making:
        return pieces.Making(seconds, lambda: cached.by_result(result))

    with st.container(horizontal=True, gap="small"):
        table = partial(_csv, result)
        long = making(ROW_S * len(result.path))
        pieces.download("Deviation CSV", table, "deviation.csv", "milling.get.deviation", long)
        key, make = scene(result, i, False)
        long = pieces.Making(0.0 if rendered.there(key) else DRAWING_S, lambda: key)
        pieces.download("Picture PNG", partial(rendered.now, PLACE, key, make), "groove.png", "milling.get.png", long)
        for kind in FORMATS:
            solid, long = partial(_mesh, result, kind), making(_mesh_seconds(result, kind))
            pieces.download(f"Surface {kind.upper()}", solid, f"surface.{kind}", f"milling.get.{kind}", long)
    pieces.note(
        f"Surfaces are closed solids in mm, true to size, with cells of {format_si(setup.cell, 'mm', 2)}; "
        "VTP carries the signed error."
    )


def _csv(result: SimulationResult) -> str:
    return csv_text(deviation_columns(result))


def _mesh_seconds(result: SimulationResult, kind: str) -> float:
    """About how long a solid takes to be made and written; no time is known of a surface that is not there yet."""
    surface: ZMap | None = vars(result).get("machined")
    if surface is None:
        return float("inf")
    return surface.z.size * (CELL_S + (FIELD_S if kind == "vtp" else 0.0)) + len(surface.edge.index) * WALL_S


def _mesh(result: SimulationResult, kind: str) -> bytes:
    error = np.asarray(result.error.error) if kind == "vtp" else None
    return mesh_bytes(result.machined, kind, error=error)
