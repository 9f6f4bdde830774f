"""The paper's second method on the page: a measured map beside the joint model, their difference, the cut by both."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray, digest
from robomill.compliance.components import COMPONENTS
from robomill.errors import RobomillError
from robomill.identification.map_check import MapCheck
from robomill.identification.measured_field import MeasuredField
from robomill.robot.model import Robot
from robomill.simulation.result import SimulationResult
from robomill.ui import pieces, session
from robomill.ui.bench import MAP_SAMPLES, OWN, Bench
from robomill.ui.entry import inputs
from robomill.ui.identification.bench import field_of, put_map, put_map_sample, remembered, robot_of
from robomill.ui.identification.inputs import robot_choice, upload
from robomill.ui.judged import uncertainty
from robomill.ui.project import View
from robomill.ui.work import running
from robomill.units import NOT_REACHED, format_many, format_percent, format_si, from_si, unit_label
from robomill.viz.deviation import both_figure
from robomill.viz.maps import Map, MapSheet, Scale
from robomill.viz.measured_maps import level_figure
from robomill.workspace.fields import ComplianceMap, compliance_map
from robomill.workspace.grid import Grid
from robomill.workspace.quantities import one_sign

CELLS = 41  # cells along the longer side of a drawn level
RIM = 2


def page(bench: Bench, view: View, dark: bool, top: Any) -> None:
    """The whole section: headline (at the ``top``), tiles, inputs, three maps."""
    robot = robot_of(bench)
    field = check = refusal = None
    try:
        field = pieces.underway(field_of, bench, robot)
        check = None if field is None else pieces.underway(check_of, bench, field, robot)
    except RobomillError as exc:
        refusal = exc
    with top:
        sentence = "These measurements do not make a map yet." if check is None else title(check)
        pieces.headline(f"Identification · measured map · {bench.map_title}", sentence)
    if field is not None and check is not None:
        cut = CutByBoth.of(field, robot)
        pieces.tiles(tiles(field, check, cut, view.length))
    component, z = _inputs(bench, field, view.length)
    if refusal is not None:
        pieces.error(refusal)
    if field is not None and check is not None:
        for finding in field.findings:
            pieces.said("warning", finding.message, "visibility")
        level = pieces.attempt(level_of, bench, field, robot, z)
        if level is not None:
            _maps(field, level, component, view, dark)
        _cut(field, cut, view.length, dark)
        _use(field)


def _inputs(bench: Bench, field: MeasuredField | None, unit: str) -> tuple[str, float]:
    samples = {**MAP_SAMPLES, OWN: bench.map_name} if bench.map_sample == OWN else MAP_SAMPLES
    first, second, third = pieces.split([1, 1.1, 1], "map-inputs")
    with first:
        inputs.choice(
            "Measured compliances",
            "identification.map.sample",
            samples,
            bench.map_sample,
            put_map_sample,
            inputs.LISTED,
        )
        robot_choice(bench)
    with second:
        upload("Your measured map (CSV)", "identification.map.file", put_map)
        pieces.note("Compliances at poses, or displacements under forces in three directions at each.")
    with third:
        options = {f"C_{c}": f"C_{c}" for c in COMPONENTS}
        component = inputs.pick("Component", "identification.map.component", options, "C_yy", inputs.LISTED)
        z = 0.0
        if field is not None:
            levels = np.unique(np.round(field.p[:, 2], 6))
            texts = {float(v): format_si(float(v), unit, 0) for v in levels}
            nearest = min(texts, key=abs)
            z = inputs.pick("Level Z in the robot frame", "identification.map.level", texts, nearest, inputs.LISTED)
    return component, z


def check_of(bench: Bench, field: MeasuredField, robot: Robot) -> MapCheck:
    """The map against the joint model."""
    key = "check", bench.map_text, robot.digest()
    return remembered(key, partial(MapCheck.of, field, robot), "Comparing the map with the joint model")


@dataclass(frozen=True)
class Level:
    """Both methods over one level of the map: C (nx, ny, 3, 3) m/N as measured, and the joint model's field."""

    measured: FloatArray
    model: ComplianceMap


def level_of(bench: Bench, field: MeasuredField, robot: Robot, z: float) -> Level:
    """The map and the joint model over the measured rectangle at level z."""

    def make() -> Level:
        grid = level_grid(field, z)
        measured = field.symmetric().compliance(grid.points())[:, :, 0]
        return Level(measured, compliance_map(robot, grid, *(float(v) for v in field.AB.mean(axis=0))))

    return remembered(("level", bench.map_text, robot.digest(), z), make, "Maps of this level")


def title(check: MapCheck) -> str:
    """How far the joint model in force is from what was measured, at the measured points."""
    if not check.seen:
        return "The joint model does not reach any of the measured points."
    word, far = "higher" if check.softer else "lower", format_percent(check.mean, 1)
    return f"Measured and calculated compliances differ by {far} on average; the measured ones are {word}."


def tiles(field: MeasuredField, check: MapCheck, cut: CutByBoth, unit: str) -> list[pieces.Tile]:
    """Points, difference to the joint model, symmetry, and the cut by both methods."""
    lines = field.lines
    shape = " × ".join(str(len(line)) for line in lines) + " grid" if lines is not None else "scattered"
    where = format_many(field.p[check.worst], unit, 0, with_unit=False)
    text, note = cut.words(unit)
    return [
        pieces.Tile("Measured points", f"{len(field.p)}", f"{shape}, three ways each", kind=field.provenance.kind),
        pieces.Tile(
            "Off the joint model",
            format_percent(check.mean, 1) if check.seen else NOT_REACHED,
            f"most at ({where}) {unit_label(unit)}: {format_percent(check.gap[check.worst])}",
        ),
        pieces.Tile("Asymmetry", format_percent(field.asymmetry.mean(), 1), "of |C|, on average"),
        pieces.Tile("The cut by the map", text, note),
    ]


@dataclass(frozen=True)
class CutByBoth:
    """The project's cut by the map and by the joint model; None where that cannot be simulated."""

    by_map: SimulationResult | None
    by_joints: SimulationResult | None

    @classmethod
    def of(cls, field: MeasuredField, robot: Robot) -> CutByBoth:
        """Both, as the simulation would have them in force."""
        return cls(_simulated(robot, field), _simulated(robot, None))

    @property
    def covered(self) -> bool:
        """Whether the map says anything of the cut."""
        return self.by_map is not None and self.by_map.worst >= 0

    def words(self, unit: str) -> tuple[str, str]:
        """Largest deviation at feed by the map, beside the joint model's; why not where there is none."""
        if self.by_joints is None or self.by_joints.worst < 0:
            return "not computed", "the cut is not reached"
        if self.by_map is None or not self.covered:
            return "not covered", "the cut lies outside the measured region"
        beside = f"{format_si(self.by_joints.max_deviation, unit)} by the joint model"
        missing = int((self.by_joints.judged & ~np.isfinite(self.by_map.deviation)).sum())
        if missing:
            beside += f"; {missing} of {int(self.by_joints.judged.sum())} points not covered"
        banded = uncertainty.tile_text(self.by_map, unit)
        if banded:
            return banded, f"95 % by the map's own errors; {beside}"
        return format_si(self.by_map.max_deviation, unit), beside


def _simulated(robot: Robot, field: MeasuredField | None) -> SimulationResult | None:
    setup = session.project().setup
    place = "identification.joints" if field is None else "identification.map"
    try:
        other = {} if setup.robot == robot else {"robot": robot}
        return pieces.underway(running.computed, setup.replace(measured_map=field, **other), place)
    except RobomillError:
        return None


def _maps(field: MeasuredField, level: Level, component: str, view: View, dark: bool) -> None:
    grid, unit = level.model.grid, view.of("um/N")
    i, j = ("xyz".index(c) for c in component[-2:])
    measured, model = level.measured[:, :, i, j], level.model.values(component)[:, :, 0]
    here = np.abs(field.p[:, 2] - grid.z[0]) < 1e-6
    points = from_si(field.p[here][:, :2], view.length)
    sizes = [from_si(v, unit) for v in (measured, np.where(np.isfinite(measured), model, np.nan), measured - model)]
    both, pair = sizes[:2], component[-2:]
    if not np.isfinite(both).any():
        pieces.note("Nothing was measured at this level.")
        return
    title, apart = (f"{sign}C<sub>{pair}</sub>, {unit_label(unit)}" for sign in ("", "Δ"))
    scale = Scale(title, float(np.nanmin(both)), float(np.nanmax(both)))
    scale = scale if one_sign(pair) else Scale.signed(title, both)
    rows = (
        ("Measured", sizes[0], points, scale),
        ("Joint model", sizes[1], points[:0], scale),
        ("Measured − joint model", sizes[2], points, Scale.signed(apart, sizes[2:])),
    )
    for k, (column, (name, values, dots, colours)) in enumerate(
        zip(pieces.split([1, 1, 1], "maps", gap="small"), rows, strict=True)
    ):
        panel = Map(name, values, unit=unit_label(unit))
        drawn = MapSheet.over([[panel]], grid, "z", view.length, {"main": colours})
        with column, st.container(border=True):
            pieces.strong(name)
            figure = level_figure(drawn, dots, dark=dark, revision=f"map-{k}")
            pieces.figure(figure, f"ident-map-{k}", alt=f"{name} of {component} at this level.")
    with st.container(horizontal=True, vertical_alignment="center", horizontal_alignment="distribute"):
        pieces.note("The first two share one scale. Dots: measured points. Grey: not measured, so not answered.")
        pieces.table_twin(lambda: _columns(grid, sizes, f"{component}_{{}}_{unit.replace('/', '_')}"), "measured-map")


def level_grid(field: MeasuredField, z: float) -> Grid:
    """Cells over the measured rectangle at level z, ``CELLS`` along its longer side, ``RIM`` more around it."""
    low, high = field.p[:, :2].min(axis=0), field.p[:, :2].max(axis=0)
    step = max(float((high - low).max()), 0.1) / (CELLS - 1)
    counts = [int(np.ceil((high[k] - low[k]) / step - 1e-6)) for k in range(2)]
    axes = [low[k] + step * np.arange(-RIM, counts[k] + RIM + 1) for k in range(2)]
    return Grid(axes[0], axes[1], np.array([z]))


def _columns(grid: Grid, sizes: list[FloatArray], name: str) -> dict[str, Any]:
    X, Y = np.meshgrid(grid.x, grid.y, indexing="ij")
    names = map(name.format, ("measured", "joint_model", "difference"))
    return {
        "X_mm": from_si(X.ravel(), "mm"),
        "Y_mm": from_si(Y.ravel(), "mm"),
        **{n: v.ravel() for n, v in zip(names, sizes, strict=True)},
    }


def _cut(field: MeasuredField, cut: CutByBoth, unit: str, dark: bool) -> None:
    """The project's cut by both methods: along the path, and its worst point."""
    by_map, by_joints = cut.by_map, cut.by_joints
    if by_joints is None or by_joints.worst < 0:
        return
    if by_map is None or not cut.covered:
        pieces.note("The project's cut lies outside the measured region: the map does not answer there.")
        return
    left, right = pieces.split([1.5, 1], "map-cut")
    blank = np.where(by_joints.judged, 1.0, np.nan)
    s, one, other = (from_si(v, unit) for v in (by_map.path.s, by_map.deviation * blank, by_joints.deviation * blank))
    with left, st.container(border=True, height="stretch"):
        st.markdown("**The project's cut by both**")
        pieces.figure(
            both_figure(s, one, other, unit, dark=dark),
            "ident-both",
            name="cut-by-map",
            table=lambda: {f"station_{unit}": s, f"by_map_{unit}": one, f"by_joints_{unit}": other},
            caption="Size of the deviation along the path.",
            alt="Deviation along the path by map and joint model.",
        )
    with right, st.container(border=True, height="stretch"):
        i = by_joints.worst
        st.markdown(f"**At its worst, line {by_joints.worst_block}**")
        head = "", "map " + pieces.badge(field.provenance.kind), "joints " + pieces.badge("computed")
        body = [
            (axis, *(format_si(float(v), unit, sign=True) for v in values))
            for axis, *values in zip("XYZ", by_map.delta[i], by_joints.delta[i], strict=True)
        ]
        pieces.table(body, " nn", head)
        for finding in by_map.notes:
            if finding.code in ("map-axis", "map-tool", "map-plane"):
                pieces.note(finding.sentence)


def _use(field: MeasuredField) -> None:
    """Let the simulation run from the map instead of the joint model, or go back to the joints."""
    setup = session.project().setup
    in_force = setup.measured_map is not None and digest(setup.measured_map) == digest(field)
    label, hint, look = (
        ("Go back to the joint model", "The simulation runs from this map now.", "secondary")
        if in_force
        else (
            "Simulate from this map",
            "Deflections then come from the measured map; the joints' shares are still shown.",
            "primary",
        )
    )
    change = partial(session.change, measured_map=None if in_force else field)
    inputs.button(label, "identification.map.use", "", change, help=hint, type=look)
