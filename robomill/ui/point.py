"""What the maps and the lesson say of one point: the pose that is reached there, and which point is in hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.cartesian import joint_contributions
from robomill.kinematics.forward import joint_frames
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.jacobian import geometric_jacobian
from robomill.kinematics.transforms import pose_from_world
from robomill.robot.model import Robot
from robomill.ui.project import MapView, Point
from robomill.workspace.fields import ComplianceField
from robomill.workspace.quantities import COMPONENTS
from robomill.workspace.reach import Box

FORCE = 100.0  # N, the paper's static force


@dataclass(frozen=True, eq=False)
class PointReport:
    """What holds at a pose; arrays NaN and ``reason`` filled where it is not reached."""

    robot: Robot
    point: Point
    reached: bool
    reason: str
    theta: FloatArray
    J: FloatArray
    C_joint: FloatArray
    frames: FloatArray | None

    @property
    def C(self) -> FloatArray:
        """(3, 3) m/N."""
        return self.C_joint.sum(axis=0)

    def component(self, name: str) -> float:
        """C_ab in m/N."""
        return float(self.C["xyz".index(name[0]), "xyz".index(name[1])])

    def shares(self, names: Sequence[str] = COMPONENTS) -> FloatArray:
        """(n, k) m/N: the joints' shares of the components."""
        return np.stack([self.C_joint[:, "xyz".index(c[0]), "xyz".index(c[1])] for c in names], axis=-1)


def report(robot: Robot, point: Point, A: float, B: float) -> PointReport:
    """Solve one pose and everything that follows from it."""
    found = inverse_kinematics(robot, pose_from_world([*point, A, B]))
    reached = bool(found.reached)
    J = geometric_jacobian(robot, found.theta)
    C_joint = joint_contributions(J[:3], robot.C_theta)
    frames = joint_frames(robot, found.theta) if reached else None
    return PointReport(robot, point, reached, found.reason(), found.theta, J, C_joint, frames)


def default_point(view: MapView, box: Box, known: ComplianceField) -> Point:
    """The point in hand: as clicked, else the paper's milling test, else the reached cell nearest the middle."""
    if view.point is not None:
        return view.point
    if view.region == "paper" and view.A == view.B == 0:
        return (0.0, -1.3, 0.0)
    middle = 0.5 * (np.asarray(box.lower) + box.upper)
    if not known.reached.any():
        return tuple(map(float, middle))  # type: ignore[return-value]
    rounded = tuple(float(v) for v in np.round(middle, 2) + 0.0)
    if bool(inverse_kinematics(known.robot, pose_from_world([*rounded, view.A, view.B])).reached):
        return rounded  # type: ignore[return-value]
    points = known.grid.points()[known.reached]
    return tuple(map(float, points[np.linalg.norm(points - middle, axis=-1).argmin()]))  # type: ignore[return-value]
