"""What both map pages look at: region, tilt, plane and the slider that moves it."""

import contextlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from robomill.arrays import FloatArray
from robomill.compliance.posture import posture_notes
from robomill.errors import WorkspaceError
from robomill.paper import Point
from robomill.quantities import quantities
from robomill.robot.model import Robot
from robomill.ui import pieces, session
from robomill.ui.entry import declared, inputs
from robomill.ui.posed import fields
from robomill.ui.project import MapView
from robomill.units import decimals, format_si, from_si, to_si, unit_label
from robomill.workspace import reach
from robomill.workspace.fields import ComplianceMap


@dataclass(frozen=True, eq=False)
class Region:
    """What a picture of the maps covers: the robot's region ``box`` as ``view`` says, with lengths in ``unit``; the
    point that is ``selected`` is marked."""

    robot: Robot
    view: MapView
    box: reach.ReachBox
    unit: str
    selected: Point | None = None

    @property
    def factors(self) -> FloatArray:
        """(n,) how much stiffer each joint is looked at."""
        return self.view.stiffening(self.robot)

    def at(self) -> tuple[str, float]:
        """(normal, coordinate m) of the plane in force, after its slider was moved."""
        return fields.plane_at(self.robot, session.maps(), self.box)

    def overview(self) -> ComplianceMap:
        """A coarse field over the whole region."""
        return fields.overview(self.robot, self.view, self.box)


def picture(name: str, show: Callable[[Region], None], above: Any = None) -> None:
    """The choice ``name`` between the pictures of a page (in the container ``above``), and what ``show`` makes of the
    region in force."""
    project = session.project()
    with above or contextlib.nullcontext():
        declared.seen(f"maps.{name}", inputs.HIDDEN)
    robot, view = project.setup.robot, session.maps()
    pieces.attempt(lambda: show(Region(robot, view, fields.region(robot, view), project.view.length)))


def controls(robot: Robot, view: MapView) -> None:
    """Region, tilt and plane."""
    region = quantities(MapView)["region"]
    declared.draw(region, "maps.region", view.region, lambda kind: _take_region(kind, robot, view), inputs.LISTED)
    if view.region == "own":
        declared.seen("maps.lower", at=None)
        declared.seen("maps.upper", at=None)
        declared.seen("maps.step", inputs.Look(placeholder="chosen by robomill"))
    if view.region == "cut" and fields.cut_in_reach(robot, view) is None:
        pieces.note("The tool does not get to the cut at this tilt: this is the largest box in reach.")
    declared.in_row(("maps.A", "maps.B"), lambda tilt: declared.seen(tilt, point=None))
    known = fields.normals(robot)
    if len(known) == 1:
        pieces.note(f"This arm moves in one plane: only {next(iter(known.values()))} can be shown.")
    else:
        declared.seen("maps.normal", options=known, at=None)
    for note in posture_notes(robot):
        beside = "the compliance ranges over the others is said at the selected point of the page Compliance."
        pieces.note(note.sentence + (f" How far {beside}" if robot.n > 6 else ""))


def tilt_note(robot: Robot) -> str:
    """What of the tilt counts for this arm."""
    if robot.n < 5:
        return "An arm of fewer than five joints reaches points; the tilt does not count."
    return "A, B turn the tool about X and then Y: k_T = (sin B, −sin A cos B, cos A cos B)."


def slider(region: Region, at: float) -> None:
    """The slider of the server that moves a plane normal to Z through the region, for pictures that are no maps."""
    unit = region.unit
    low, high = (float(from_si(float(v), unit)) for v in (region.box.lower[2], region.box.upper[2]))
    label = f"Z, {unit_label(unit)}"
    if high - low < 1e-9:
        pieces.note(f"{label}: {format_si(at, unit, 1)}; the region has no depth here.")
        return
    step = float(f"{(high - low) / 50:.1g}")
    inputs.slider(
        label,
        f"maps.at.z:{unit}",
        inputs.Span(round(low, 3), round(high, 3), step, f"%.{decimals(unit, 0)}f"),
        round(float(from_si(at, unit)), 3),
        lambda v: session.see(at=to_si(v, unit), normal="z"),
    )


def _take_region(kind: str, robot: Robot, view: MapView) -> None:
    if kind == "own":
        try:
            box = fields.region(robot, view)
        except WorkspaceError:
            session.see(region=kind, at=None)
            return
        session.see(region=kind, at=None, lower=box.lower, upper=box.upper)
    else:
        session.see(region=kind, at=None, point=None)
