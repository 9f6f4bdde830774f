"""The paper's second method on the page: a measured map beside the joint model, their difference, the cut by both."""

from __future__ import annotations

import contextlib
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray, digest
from robomill.compliance.cartesian import cartesian_compliance
from robomill.errors import RobomillError
from robomill.identification.measured_field import MeasuredField
from robomill.identification.propagation import uncertain_by_map
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world
from robomill.robot.model import Robot
from robomill.simulation.result import SimulationResult
from robomill.ui import inputs, pieces, session, uncertainty
from robomill.ui.identification.bench import MAP_SAMPLES, Bench, field_of, robot_of, sample_text
from robomill.ui.identification.cut import cut_of
from robomill.ui.identification.inputs import OWN, robot_choice, upload
from robomill.ui.project import View
from robomill.units import NOT_REACHED, format_many, format_percent, format_si, from_si, unit_label
from robomill.viz.deviation import both_figure
from robomill.viz.measured_maps import Level, level_figure
from robomill.workspace.fields import compliance_field
from robomill.workspace.grid import Grid

COMPONENTS = ("C_xx", "C_yy", "C_zz", "C_xy", "C_xz", "C_yz")
CELLS = 41  # cells along the longer side of a drawn level
RIM = 2
TURNED = 1e-3  # rad between the tool of the path and that of the map, from which it is said


def page(bench: Bench, view: View, dark: bool, top: Any) -> None:
    """The whole section: headline (at the ``top``), tiles, inputs, three maps."""
    robot = robot_of(bench)
    field = cut = refusal = None
    sentence = "These measurements do not make a map yet."
    try:
        field = field_of(bench, robot)
    except RobomillError as exc:
        refusal = exc
    if field is not None:
        model = model_at_points(field, robot)
        sentence = title(field, model)
        with contextlib.suppress(RobomillError):
            cut = cut_of(robot)
    with top:
        pieces.headline(f"Measured map · {bench.map_name}", sentence)
    if field is not None:
        pieces.tiles(tiles(field, model, cut, view.length))
    chosen = _inputs(bench, field, view.length)
    if refusal is not None:
        pieces.error(refusal)
    if field is not None:
        for finding in field.findings:
            st.warning(finding.message, icon=":material/visibility:")
        _maps(field, robot, *chosen, view.length, dark)
        _cut(field, cut, view.length, dark)
        _use(field)


def _inputs(bench: Bench, field: MeasuredField | None, unit: str) -> tuple[str, float]:
    samples = {**MAP_SAMPLES, OWN: bench.map_name} if not bench.map_sample else MAP_SAMPLES
    first, second, third = pieces.split([1, 1.1, 1], "map-inputs", gap="large")
    with first:
        inputs.choice(
            "Measured compliances",
            "identification.map.sample",
            samples,
            bench.map_sample or OWN,
            lambda n: None if n == OWN else bench.take_map(sample_text(n), f"{n}.csv", n),
            inputs.LISTED,
        )
        robot_choice(bench)
    with second:
        upload("Your measured map (CSV)", "identification.map.file", bench.take_map, bench.map_revision)
        pieces.note("Compliances at poses, or displacements under forces in three directions at each.")
    with third:
        options = {c: c.replace("_", " ") for c in COMPONENTS}
        component = inputs.pick("Component", "identification.map.component", options, "C_yy", inputs.LISTED)
        z = 0.0
        if field is not None:
            levels = np.unique(np.round(field.p[:, 2], 6))
            texts = {float(v): format_si(float(v), unit, 0 if unit == "mm" else 2) for v in levels}
            nearest = min(texts, key=abs)
            z = inputs.pick("Level Z in {M}", "identification.map.level", texts, nearest, inputs.LISTED)
    return component, z


def title(field: MeasuredField, model: FloatArray) -> str:
    """How far the joint ``model`` (k, 3, 3) m/N in force is from what was measured, at the measured points."""
    gap = gap_at_points(field, model)
    if not np.isfinite(gap).any():
        return "The joint model does not reach any of the measured points."
    mean = float(np.nanmean(gap))
    bias = float(np.nanmean(_sizes(field.C) - _sizes(model)))
    word = "higher" if bias > 0 else "lower"
    far = format_percent(mean)
    return f"Measured and calculated compliances differ by {far} on average; the measured ones are {word}."


def model_at_points(field: MeasuredField, robot: Robot) -> FloatArray:
    """C (k, 3, 3) m/N of the joint model at the measured poses, NaN where not reached."""
    solved = inverse_kinematics(robot, pose_from_world(np.concatenate([field.p, field.AB], axis=1)))
    return cartesian_compliance(robot, solved.theta)


def gap_at_points(field: MeasuredField, model: FloatArray) -> FloatArray:
    """(k,) |C measured - C model| / |C measured|, Frobenius."""
    return _sizes(field.C - model) / _sizes(field.C)


def _sizes(C: FloatArray) -> FloatArray:
    return np.linalg.norm(C, axis=(-1, -2))


def tiles(field: MeasuredField, model: FloatArray, cut: SimulationResult | None, unit: str) -> list[pieces.Tile]:
    """Points, difference to the joint model, symmetry, and the cut by both methods."""
    gap = gap_at_points(field, model)
    lines = field.lines
    shape = " × ".join(str(len(line)) for line in lines) + " grid" if lines is not None else "scattered"
    seen = bool(np.isfinite(gap).any())
    worst = int(np.nanargmax(gap)) if seen else 0
    digits = 0 if unit == "mm" else 1
    where = format_many(field.p[worst], unit, digits, with_unit=False)
    text, note = cut_words(field, cut, unit)
    return [
        pieces.Tile("Measured points", f"{len(field.p)}", f"{shape}, three ways each", kind=field.provenance.kind),
        pieces.Tile(
            "Off the joint model",
            format_percent(np.nanmean(gap), 1) if seen else NOT_REACHED,
            f"most at ({where}) {unit_label(unit)}: {format_percent(gap[worst])}",
        ),
        pieces.Tile("Asymmetry", format_percent(field.asymmetry.mean(), 1), "of |C|, on average"),
        pieces.Tile("The cut by the map", text, note),
    ]


def along_cut(field: MeasuredField, cut: SimulationResult) -> FloatArray:
    """(m, 3) m: deflection along the path by the measured map; NaN where the map does not answer."""
    p = cut.setup.in_base(cut.path.p)
    return field.deflection(p, cut.F)


def cut_words(field: MeasuredField, cut: SimulationResult | None, unit: str) -> tuple[str, str]:
    """Largest deviation at feed by the map, beside the joint model's; why not where there is none."""
    if cut is None or cut.worst < 0:
        return "not computed", "the cut is not reached"
    size = np.linalg.norm(along_cut(field, cut), axis=1)
    size[~cut.judged] = np.nan
    if not np.isfinite(size).any():
        return "not covered", "the cut lies outside the measured region"
    digits = 3 if unit == "mm" else 4
    missing = int((cut.judged & ~np.isfinite(size)).sum())
    beside = f"{format_si(cut.max_deviation, unit, digits)} by the joint model"
    if missing:
        beside += f"; {missing} of {int(cut.judged.sum())} points not covered"
    worst = int(np.nanargmax(size))
    sure = uncertain_by_map(field, cut.setup.in_base(cut.path.p[worst]), cut.F[worst])
    half = float(sure.half_along(sure.delta / np.linalg.norm(sure.delta)))
    if not np.isfinite(half):
        return format_si(float(size[worst]), unit, digits), beside
    return uncertainty.band_text(float(size[worst]), half, unit), f"95 % by the map's own errors; {beside}"


def _maps(field: MeasuredField, robot: Robot, component: str, z: float, unit: str, dark: bool) -> None:
    grid = level_grid(field, z)
    i, j = ("xyz".index(c) for c in component[-2:])
    C = field.compliance(grid.points())[:, :, 0]
    measured = 0.5 * (C[..., i, j] + C[..., j, i])
    model = compliance_field(robot, grid, *(float(v) for v in field.AB.mean(axis=0))).values(component)[:, :, 0]
    here = np.abs(field.p[:, 2] - z) < 1e-6
    x, y, points = (from_si(v, unit) for v in (grid.x, grid.y, field.p[here][:, :2]))
    sizes = [from_si(v, "um/N") for v in (measured, np.where(np.isfinite(measured), model, np.nan), measured - model)]
    both = np.concatenate([sizes[0].ravel(), sizes[1].ravel()])
    if not np.isfinite(both).any():
        pieces.note("Nothing was measured at this level.")
        return
    signed = component[-1] != component[-2]
    top = float(np.nanmax(np.abs(both)))
    limits = (-top, top) if signed else (float(np.nanmin(both)), float(np.nanmax(both)))
    far = float(np.nanmax(np.abs(sizes[2]))) if np.isfinite(sizes[2]).any() else 1.0
    rows = (
        ("Measured", sizes[0], limits, signed),
        ("Joint model", sizes[1], limits, signed),
        ("Measured − joint model", sizes[2], (-far, far), True),
    )
    for k, (column, (name, values, ends, both_ways)) in enumerate(
        zip(pieces.split([1, 1, 1], "maps", gap="small"), rows, strict=True)
    ):
        with column, st.container(border=True):
            title_text = f"C<sub>{component[-2:]}</sub>" if k < 2 else f"ΔC<sub>{component[-2:]}</sub>"
            st.markdown(f"**{name}**")
            dots = points if k != 1 else points[:0]
            pieces.figure(
                level_figure(
                    Level(x, y, values, dots, ends, title_text, unit_label("um/N"), unit_label(unit), both_ways),
                    dark=dark,
                    revision=f"map-{k}",
                ),
                f"ident-map-{k}",
                alt=f"{name} of {component} at this level.",
            )
    with st.container(horizontal=True, vertical_alignment="center", horizontal_alignment="distribute"):
        pieces.note("The first two share one scale. Dots: measured points. Grey: not measured, so not answered.")
        pieces.table_twin(lambda: _columns(grid, sizes, component), "measured-map")


def level_grid(field: MeasuredField, z: float) -> Grid:
    """Cells over the measured rectangle at level z, ``CELLS`` along its longer side, ``RIM`` more around it."""
    low, high = field.p[:, :2].min(axis=0), field.p[:, :2].max(axis=0)
    step = max(float((high - low).max()), 0.1) / (CELLS - 1)
    counts = [int(np.ceil((high[k] - low[k]) / step - 1e-6)) for k in range(2)]
    axes = [low[k] + step * np.arange(-RIM, counts[k] + RIM + 1) for k in range(2)]
    return Grid(axes[0], axes[1], np.array([z]))


def _columns(grid: Grid, sizes: list[FloatArray], component: str) -> dict[str, Any]:
    X, Y = np.meshgrid(grid.x, grid.y, indexing="ij")
    names = ("measured", "joint_model", "difference")
    return {
        "X_mm": from_si(X.ravel(), "mm"),
        "Y_mm": from_si(Y.ravel(), "mm"),
        **{f"{component}_{n}_um_N": v.ravel() for n, v in zip(names, sizes, strict=True)},
    }


def _cut(field: MeasuredField, cut: SimulationResult | None, unit: str, dark: bool) -> None:
    """The project's cut by both methods: along the path, and its worst point."""
    if cut is None or cut.worst < 0:
        return
    mapped = along_cut(field, cut)
    if not np.isfinite(mapped[cut.judged]).any():
        pieces.note("The project's cut lies outside the measured region: the map does not answer there.")
        return
    left, right = pieces.split([1.5, 1], "map-cut")
    blank = np.where(cut.judged, 1.0, np.nan)
    s = from_si(cut.path.s, unit)
    by_map = from_si(np.linalg.norm(mapped, axis=1) * blank, unit)
    by_joints = from_si(cut.deviation * blank, unit)
    with left, st.container(border=True, height="stretch"):
        st.markdown("**The project's cut by both**")
        pieces.figure(
            both_figure(s, by_map, by_joints, unit, dark=dark),
            "ident-both",
            name="cut-by-map",
            table=lambda: {f"station_{unit}": s, f"by_map_{unit}": by_map, f"by_joints_{unit}": by_joints},
            caption="Size of the deviation along the path.",
            alt="Deviation along the path by map and joint model.",
        )
    with right, st.container(border=True, height="stretch"):
        st.markdown(f"**At its worst, line {cut.worst_block}**")
        digits = 3 if unit == "mm" else 4
        rows = [
            (axis.upper(), format_si(float(a), unit, digits, sign=True), format_si(float(b), unit, digits, sign=True))
            for axis, a, b in zip("xyz", mapped[cut.worst], cut.delta[cut.worst], strict=True)
        ]
        head = f"map {pieces.badge(field.provenance.kind)}", f"joints {pieces.badge('computed')}"
        body = "".join(f'<tr><td>{q}</td><td class="n">{a}</td><td class="n">{b}</td></tr>' for q, a, b in rows)
        st.html(
            f'<table class="rm-facts"><tr><th></th><th class="n">{head[0]}</th><th class="n">{head[1]}</th></tr>'
            f"{body}</table>"
        )
        turned = field.turned(cut.setup.in_base(cut.path.p), cut.path.k @ cut.setup.T_MW[:3, :3].T)[cut.judged]
        if turned.max() > TURNED:
            far = format_si(float(turned.max()), "deg", 1)
            pieces.note(f"The path's tool stands up to {far} off the one that was measured, which the map cannot know.")


def _use(field: MeasuredField) -> None:
    """Let the simulation run from the map instead of the joint model, or go back to the joints."""
    setup = session.project().setup
    in_force = setup.measured_map is not None and digest(setup.measured_map) == digest(field)
    st.button(
        "Go back to the joint model" if in_force else "Simulate from this map",
        key="identification.map.use",
        type="secondary" if in_force else "primary",
        on_click=session.change,
        kwargs={"measured_map": None if in_force else field},
        help="The simulation runs from this map now."
        if in_force
        else "Deflections then come from the measured map; the joints' shares are still shown.",
    )
