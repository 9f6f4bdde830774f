"""The milling page's inputs, its surface pictures and its downloads."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.cutting.force import ConstantForce, PathForce
from robomill.cutting.tool import Cutter
from robomill.errors import RobomillError
from robomill.report.tables import csv_text, deviation_columns
from robomill.simulation.result import SimulationResult
from robomill.surface.stock import Stock
from robomill.ui import cache, inputs, parts, render, state
from robomill.units import format_si, from_si
from robomill.viz.scene import CAMERAS
from robomill.viz.surfaces import surface_figure
from robomill.viz.views import surface_picture

FORCES = {"path": "Follows the path", "constant": "Fixed in {M}"}
KINDS = {"flat": "Flat", "ball": "Ball", "bull": "Bull", "chamfer": "Chamfer"}
EXAGGERATIONS = {1.0: "true", 5.0: "× 5", 10.0: "× 10", 20.0: "× 20"}


def inputs_column(project: state.Project) -> None:
    """Force, cutter, stock, tolerance."""
    setup, unit = project.setup, project.view.length
    _force()
    st.markdown("**Cutter**")
    _cutter(setup.cutter, unit)
    st.markdown("**Stock** in {W}")
    _stock(unit)
    st.markdown("**Judgement and accuracy**")
    left, right = st.columns(2)
    with left:
        inputs.number("Tolerance", "tolerance", unit, step=0.05 if unit == "mm" else 0.002)
        inputs.number("Cell", "cell", unit, step=0.05 if unit == "mm" else 0.002)
    with right:
        inputs.number("Step", "step", unit, step=0.5 if unit == "mm" else 0.02)


def _force() -> None:
    force = state.project().setup.force
    kind = "path" if isinstance(force, PathForce) else "constant" if isinstance(force, ConstantForce) else "other"
    options = FORCES if kind != "other" else {**FORCES, "other": type(force).__name__}
    provenance = state.project().setup.provenance.get("force", force.provenance)
    st.markdown("**Force on the tool**")
    inputs.choice("Force on the tool", "force.kind", options, kind, _switch_force, label_visibility="collapsed")
    fields: tuple[tuple[str, str], ...] = ()
    if isinstance(force, PathForce):
        fields = (("Feed", "force.feed"), ("Feed-normal", "force.feed_normal"), ("Axial", "force.axial"))
    elif isinstance(force, ConstantForce):
        fields = tuple((f"F {a}", f"force.vector_M[{i}]") for i, a in enumerate("XYZ"))
    for column, (label, path) in zip(st.columns(3), fields, strict=False):
        with column:
            inputs.number(label, path, "N", step=10.0, digits=1)
    words = "Feed-normal is the left of the feed. " if isinstance(force, PathForce) else ""
    parts.note(f"{parts.badge(provenance.kind)} {words}{provenance.source}")


def _switch_force(kind: str) -> None:
    setup = state.project().setup
    result = cache.result(setup)
    F = result.F[result.worst] if result.worst >= 0 else np.array([0.0, 100.0, 0.0])
    if kind == "constant":
        state.change(force=ConstantForce(np.round(F, 6) + 0.0))
    elif kind == "path":
        state.change(force=PathForce(feed_normal=round(float(np.linalg.norm(F)), 6)))


def _cutter(cutter: Cutter, unit: str) -> None:
    inputs.choice("Kind", "cutter.kind", KINDS, cutter.kind, _switch_cutter, label_visibility="collapsed")
    step = 1.0 if unit == "mm" else 0.05
    left, right = st.columns(2)
    with left:
        inputs.number("Diameter", "cutter.diameter", unit, step=step)
    with right:
        inputs.whole("Flutes", "cutter.flutes")
    if cutter.kind == "bull":
        inputs.number("Corner radius", "cutter.corner_radius", unit, step=step / 4)
    if cutter.kind == "chamfer":
        inputs.number("Full tip angle", "cutter.tip_angle", "deg", step=5.0)


def _switch_cutter(kind: str) -> None:
    old = state.project().setup.cutter
    common: dict[str, Any] = {
        "diameter": old.diameter, "flutes": old.flutes, "helix": old.helix, "helix_angle": old.helix_angle,
        "hand": old.hand, "flute_length": old.flute_length, "stick_out": old.stick_out,
    }  # fmt: skip
    special = {"bull": {"corner_radius": old.diameter / 8}, "chamfer": {"tip_angle": np.pi / 2}}.get(kind, {})
    state.change(cutter=Cutter(kind=kind, **common, **special))  # type: ignore[arg-type]


def _stock(unit: str) -> None:
    setup = state.project().setup
    own = setup.stock is not None
    inputs.choice(
        "Stock", "stock.kind", {True: "Given block", False: "Around the path"}, own, _switch_stock,
        label_visibility="collapsed",
    )  # fmt: skip
    block = setup.stock_block
    if not own:
        size = " × ".join(format_si(float(v), unit, 1).partition(" ")[0] for v in block.upper - block.lower)
        parts.note(f"{parts.badge('computed')} {size} {unit} around the feed moves")
        return
    for side, label in (("lower", "from"), ("upper", "to")):
        for i, (column, axis) in enumerate(zip(st.columns(3), "XYZ", strict=True)):
            with column:
                inputs.number(f"{axis} {label}", f"stock.{side}[{i}]", unit, step=1.0, digits=2)


def _switch_stock(own: bool) -> None:
    block = state.project().setup.stock_block
    state.change(stock=Stock(np.round(block.lower, 9), np.round(block.upper, 9)) if own else None)


def surface(result: SimulationResult, view: state.View, station: float, dark: bool) -> None:
    """The machined surface, rendered, or turnable."""
    left, middle, right = st.columns([1.1, 1.5, 1.1], vertical_alignment="bottom")
    with left:
        how = st.segmented_control(
            "View", ["Rendered", "Turnable"], default="Rendered", key="surface:how", required=True, width="stretch"
        )
    with middle:
        inputs.choice(
            "Camera", "view.camera", CAMERAS, view.camera, lambda c: state.look(camera=c), horizontal=False
        )  # fmt: skip
    with right:
        options = EXAGGERATIONS if view.exaggeration in EXAGGERATIONS else {
            **EXAGGERATIONS, view.exaggeration: f"× {view.exaggeration:g}"}  # fmt: skip
        inputs.choice(
            "Exaggeration", "view.exaggeration", options, view.exaggeration,
            lambda v: state.look(exaggeration=float(v)), horizontal=False,
        )  # fmt: skip
    shown = parts.attempt(cache.pictured, result.setup, view.exaggeration)
    if shown is None:
        return
    png = _rendered(result, view, station, dark) if how == "Rendered" else None
    if png is not None:
        st.image(png, width="stretch", alt="The machined surface coloured by its signed error.")
    else:
        unit = view.length
        parts.figure(
            surface_figure(
                from_si(shown.drawn.x, unit), from_si(shown.drawn.y, unit), from_si(shown.drawn.z, unit),
                from_si(shown.error, "um"), float(from_si(result.setup.tolerance, "um")), dark=dark, height=520,
                unit=unit,
            ), "surface", alt="The machined surface, to be turned with the mouse.",
        )  # fmt: skip
    parts.note(
        f"Displacement shown × {view.exaggeration:g}; colours are true distances from the ideal groove and "
        f"end at the tolerance, ± {format_si(result.setup.tolerance, 'um', 0)}."
    )


def _rendered(result: SimulationResult, view: state.View, station: float, dark: bool) -> bytes | None:
    shown = cache.pictured(result.setup, view.exaggeration)
    camera: Any = view.camera
    scene = surface_picture(result, shown, camera=camera, dark=dark, station=station, size=(1360, 800))
    return render.picture((result.setup.digest(), view.exaggeration, round(station, 6), "milling"), scene)


def station_slider(view: state.View, length: float, unit: str) -> None:
    """Where along the cut the section lies."""
    top = max(float(from_si(length, unit)), 1e-9)
    inputs.slider(
        f"Station, {unit} of cut", "view.station", 0.0, round(top, 3), round(view.station * top, 3),
        lambda v: state.look(station=min(max(v / top, 0.0), 1.0)), step=round(top / 200, 4) or 0.001, form="%.2f",
    )  # fmt: skip


def share_axis(view: state.View) -> str:
    """Component whose shares are shown."""
    title, pick = st.columns([1, 1.3], vertical_alignment="center")
    title.markdown("**Which joint gives**")
    with pick:
        inputs.choice(
            "Shares of", "view.share_axis", {a: f"in {a.upper()}" for a in "xyz"}, view.share_axis,
            lambda a: state.look(share_axis=a), label_visibility="collapsed",
        )  # fmt: skip
    return state.project().view.share_axis


def shares(result: SimulationResult, column: int) -> FloatArray:
    """(m, n + springs) m: shares of one component, joints first."""
    return np.concatenate([result.delta_joint[:, :, column], result.delta_spring[:, :, column]], axis=1)


def at_feed(result: SimulationResult, values: FloatArray) -> FloatArray:
    """``values`` (m, k) with NaN where nothing is cut, so that lines break there."""
    return np.where(result.path.cutting[:, None], values, np.nan)


def share_names(result: SimulationResult) -> list[str]:
    """Names of the columns of ``shares``."""
    return [f"joint {i}" for i in result.setup.robot.joint_numbers] + [s.name for s in result.setup.springs]


def downloads(result: SimulationResult, view: state.View, station: float) -> None:
    """Deviation as CSV, surface as STL, picture as PNG."""
    with st.container(horizontal=True, gap="small"):
        parts.download("Deviation CSV", lambda: csv_text(deviation_columns(result)), "deviation.csv", "text/csv",
                       key="get:deviation")  # fmt: skip
        parts.download("Surface STL", lambda: surface_stl(result), "surface.stl", "model/stl", key="get:stl")
        parts.download("Picture PNG", _or_empty(lambda: _rendered(result, view, station, False)), "groove.png",
                       "image/png", key="get:png")  # fmt: skip


def surface_stl(result: SimulationResult) -> bytes:
    """The machined part as a binary STL in mm."""
    from robomill.io.meshes import mesh_bytes

    return mesh_bytes(result.machined, "stl")


def _or_empty(make: Callable[[], bytes | None]) -> Callable[[], bytes]:
    def made() -> bytes:
        try:
            return make() or b""
        except RobomillError:
            return b""

    return made
