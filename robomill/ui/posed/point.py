"""The point in hand of the maps and the lesson: which one it is, the pose that is reached there, and its matrix C."""

from dataclasses import dataclass

import numpy as np
import streamlit as st

from robomill.compliance.at_pose import PoseReport, at_pose
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world
from robomill.paper import SLOT, Point
from robomill.robot.model import Robot
from robomill.ui import pieces, session
from robomill.ui.project import MapView
from robomill.units import format_many, format_si, unit_label
from robomill.workspace.fields import ComplianceMap
from robomill.workspace.reach import SLACK, ReachBox


@dataclass(frozen=True, eq=False)
class InHand:
    """A point in {M}, m, and what holds where the tool stands there; ``reason`` says why it does not get there."""

    point: Point
    pose: PoseReport
    reason: str

    def with_robot(self, robot: Robot) -> "InHand":
        """The same with an arm whose joints give otherwise: it stands as it stood."""
        return InHand(self.point, at_pose(robot, self.pose.theta), self.reason)


def in_hand(robot: Robot, point: Point, A: float, B: float) -> InHand:
    """The tool brought to ``point`` at the tilt A, B (rad)."""
    found = inverse_kinematics(robot, pose_from_world([*point, A, B]))
    return InHand(point, at_pose(robot, found.theta), found.reason())


def place(point: Point, unit: str) -> str:
    """``(0, -1300, 0) mm``."""
    return f"({format_many(point, unit, 0, with_unit=False)}) {unit_label(unit)}"


def compliance_matrix(pose: PoseReport) -> None:
    """C at a pose, under its heading."""
    unit = session.project().view.of("um/N")
    st.markdown(f"**Compliance C** in {{M}}, {unit_label(unit)}")
    pieces.matrix([[format_si(v, unit, with_unit=False) for v in row] for row in pose.C], list("XYZ"))


def middle(box: ReachBox) -> Point:
    """The middle of a region, m."""
    x, y, z = (0.5 * (float(low) + float(high)) for low, high in zip(box.lower, box.upper, strict=True))
    return x, y, z


def holds(box: ReachBox, point: Point) -> bool:
    """Whether a region has ``point``."""
    return bool(((box.lower - SLACK <= point) & (point <= box.upper + SLACK)).all())


def default_point(view: MapView, box: ReachBox, known: ComplianceMap, cut: Point | None = None) -> Point:
    """The selected point: as clicked, else the middle of the project's ``cut`` where the region holds it and the arm
    gets there, else the paper's milling test, else the reached cell nearest the middle."""
    if view.point is not None:
        x, y, z = view.point.tolist()
        return x, y, z
    if cut is not None and holds(box, cut) and in_hand(known.robot, cut, view.A, view.B).pose.reached:
        return cut
    if view.region == "paper" and view.A == view.B == 0:
        return SLOT.point
    centre = middle(box)
    if not known.reached.any():
        return centre
    rounded = (round(centre[0], 2) + 0.0, round(centre[1], 2) + 0.0, round(centre[2], 2) + 0.0)
    if in_hand(known.robot, rounded, view.A, view.B).pose.reached:
        return rounded
    points = known.grid.points()[known.reached]
    x, y, z = points[np.linalg.norm(points - centre, axis=-1).argmin()].tolist()
    return x, y, z
