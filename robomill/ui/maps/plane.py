"""What both map pages look at: region, tilt, plane and the slider that moves it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import streamlit as st

from robomill.arrays import FloatArray
from robomill.errors import WorkspaceError
from robomill.paper import Point
from robomill.robot.model import Robot
from robomill.ui import fields, inputs, pieces, session
from robomill.ui.box import NumberBox
from robomill.ui.project import MapView
from robomill.units import UNITS, decimals, format_si, from_si, to_si, unit_label
from robomill.workspace import reach
from robomill.workspace.fields import ComplianceField
from robomill.workspace.grid import Grid

REGIONS = {
    "paper": "The paper's box",
    "largest": "Largest box in reach",
    "reach": "Everything in reach",
    "own": "My own numbers",
}


@dataclass(frozen=True, eq=False)
class Region:
    """What a picture of the maps covers: the robot's region ``box`` as ``view`` says, with lengths in ``unit``."""

    robot: Robot
    view: MapView
    box: reach.Box
    unit: str

    @property
    def factors(self) -> FloatArray:
        """(n,) how much stiffer each joint is looked at."""
        return self.view.stiffening(self.robot)

    def at(self) -> tuple[str, float]:
        """(normal, coordinate m) of the plane in force, after its slider was moved."""
        return fields.plane_at(self.robot, session.maps(), self.box)

    def grid(self, normal: str, at: float) -> Grid:
        """The cells of a plane."""
        return fields.plane(self.robot, self.view, self.box, normal, at)

    def field(self, grid: Grid) -> ComplianceField:
        """Everything over ``grid`` at the tilt in force."""
        return fields.field(self.robot, grid, self.view.A, self.view.B)

    def overview(self) -> ComplianceField:
        """A coarse field over the whole region."""
        return fields.overview(self.robot, self.view, self.box)


def picture(name: str, pictures: Mapping[str, str], show: Callable[[Region], None]) -> None:
    """The choice ``name`` between the ``pictures`` of a page, and what ``show`` makes of the region in force."""
    project = session.project()
    inputs.seen("Picture", f"maps.{name}", pictures, inputs.HIDDEN)
    robot, view = project.setup.robot, session.maps()
    pieces.attempt(lambda: show(Region(robot, view, fields.region(robot, view), project.view.length)))


def controls(robot: Robot, view: MapView, unit: str) -> None:
    """Region, tilt and plane."""
    inputs.choice(
        "Region", "maps.region", REGIONS, view.region, lambda kind: _take_region(kind, robot, view), inputs.LISTED
    )
    if view.region == "own":
        _corners(view, unit)
    left, right = st.columns(2)
    with left:
        inputs.value("maps.A", _box("Tilt A", "deg", 5.0), view.A, lambda v: session.see(A=v, point=None))
    with right:
        inputs.value("maps.B", _box("Tilt B", "deg", 5.0), view.B, lambda v: session.see(B=v, point=None))
    known = fields.normals(robot)
    if len(known) == 1:
        pieces.note(f"This arm moves in one plane: only {next(iter(known.values()))} can be shown.")
    else:
        inputs.seen("Plane", "maps.normal", known, at=None)
    if robot.n > 6:
        pieces.note(
            f"This arm has {robot.n} axes and holds a place in many postures: a map shows one of them. How far the "
            "compliance ranges over the others is said at the point in hand of the page Compliance."
        )


def tilt_note(robot: Robot) -> str:
    """What of the tilt counts for this arm."""
    if robot.n < 5:
        return "An arm of fewer than five joints reaches points; the tilt does not count."
    return "A, B turn the tool about X and then Y: k_T = (sin B, −sin A cos B, cos A cos B)."


def slider(region: Region, normal: str, at: float) -> None:
    """The slider that moves the plane through the region."""
    i, unit = "xyz".index(normal), region.unit
    low, high = (float(from_si(float(v), unit)) for v in (region.box.lower[i], region.box.upper[i]))
    name = f"{normal.upper()}ₘ, {unit_label(unit)}"
    if high - low < 1e-9:
        pieces.note(f"{name}: {format_si(at, unit, 1)}; the region has no depth here.")
        return
    step = float(f"{(high - low) / 50:.1g}")
    inputs.slider(
        name,
        f"maps.at.{normal}:{unit}",
        inputs.Span(round(low, 3), round(high, 3), step, f"%.{decimals(unit, 0)}f"),
        round(float(from_si(at, unit)), 3),
        lambda v: session.see(at=to_si(v, unit), normal=normal),
    )


def title(normal: str, at: float, unit: str) -> str:
    """``Z_M = 0 mm`` as people read it."""
    return f"{normal.upper()}<sub>M</sub> = {format_si(at, unit, 0)}"


def axes(normal: str, unit: str) -> tuple[str, str]:
    """Titles across and upwards."""
    u, v = (a for a in "xyz" if a != normal)
    return tuple(f"{a.upper()}<sub>M</sub>, {unit_label(unit)}" for a in (u, v))  # type: ignore[return-value]


def _take_region(kind: str, robot: Robot, view: MapView) -> None:
    if kind == "own":
        try:
            box = fields.region(robot, view)
        except WorkspaceError:
            session.see(region=kind, at=None)
            return
        session.see(region=kind, at=None, lower=tuple(map(float, box.lower)), upper=tuple(map(float, box.upper)))
    else:
        session.see(region=kind, at=None, point=None)


def _corners(view: MapView, unit: str) -> None:
    for name, side in (("from", "lower"), ("to", "upper")):
        place_boxes(side, [f"{axis} {name}" for axis in "XYZ"], getattr(view, side), unit, at=None)
    inputs.value("maps.step", _box("Step (0 lets robomill choose)", unit, 5.0), view.step or 0.0, _put_step)


def _box(label: str, unit: str, step: float) -> NumberBox:
    return NumberBox(label, unit, step, min(UNITS[unit].digits, 2))


def place_boxes(name: str, labels: Sequence[str], current: Point, unit: str, **more: Any) -> None:
    """Three boxes for the place ``name`` of the map view, m; fields ``more`` change with it."""

    def put(i: int, value_SI: float) -> None:
        session.see(**{name: (*current[:i], value_SI, *current[i + 1 :]), **more})

    for i, (label, column) in enumerate(zip(labels, st.columns(3), strict=True)):
        with column:
            box = _box(label, unit, 50.0 if unit == "mm" else 1.0)
            inputs.value(f"maps.{name}.{i}", box, current[i], partial(put, i))


def _put_step(step: float) -> None:
    if step < 0:
        raise WorkspaceError("Step: found a number below zero; type 0 to let robomill choose, or a spacing above 0.")
    session.see(step=step or None)
