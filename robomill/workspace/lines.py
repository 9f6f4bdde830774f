"""Deviation along straight lines across the workspace under a constant force normal to the feed (Fig. 8)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, as_floats
from robomill.compliance.cartesian import joint_contributions
from robomill.compliance.deflection import deflection
from robomill.errors import WorkspaceError
from robomill.kinematics.inverse import IKResult, inverse_kinematics
from robomill.kinematics.jacobian import geometric_jacobian
from robomill.kinematics.steadiness import hasty_turns, passages
from robomill.kinematics.transforms import pose_from_world
from robomill.paper import SLOT
from robomill.robot.model import Robot
from robomill.units import format_si
from robomill.workspace.grid import PAPER_BOX


@dataclass(frozen=True, eq=False)
class LineDeviation:
    """A line p (m, 3) m with feed (3,), normal (3,) unit vectors and force F (3,) N on the tool, all in {M}.

    delta_joint (m, n, 3) m joint shares of the path deviation (deflected minus commanded), NaN where not reached.
    """

    name: str
    p: FloatArray
    feed: FloatArray
    normal: FloatArray
    F: FloatArray
    ik: IKResult
    delta_joint: FloatArray

    @property
    def reached(self) -> BoolArray:
        """(m,)."""
        return self.ik.reached

    def notes(self) -> list[str]:
        """Where along the line, m from its start, a joint must run or the arm passes a singular configuration."""
        found = [(haste.worst, haste.sentence()) for haste in hasty_turns(self.ik)]
        found += [(passage.at, passage.sentence()) for passage in passages(self.ik)]
        return [f"{self.name or 'line'}, after {_mm(self.s[at])}: {words}" for at, words in sorted(found)]

    @property
    def delta(self) -> FloatArray:
        """(m, 3) m, the sum of the joints' shares."""
        return self.delta_joint.sum(axis=1)

    @property
    def s(self) -> FloatArray:
        """(m,) m along the line."""
        return (self.p - self.p[0]) @ self.feed

    def along_normal(self) -> FloatArray:
        """Joint shares (m, n) m of the deviation normal to the feed."""
        return self.delta_joint @ self.normal


def line_deviation(
    robot: Robot,
    start: ArrayLike,
    end: ArrayLike,
    force: float = SLOT.force,
    points: int = 61,
    name: str = "",
) -> LineDeviation:
    """Deviation along start (3,) to end (3,) m under ``force`` N on the tool, feed-normal: z_T x feed, to its left.

    ``points`` equidistant points, tool upright.
    """
    first = as_floats(start, "Line, start", (3,), error=WorkspaceError)
    last = as_floats(end, "Line, end", (3,), error=WorkspaceError)
    feed = last - first
    length = float(np.linalg.norm(feed))
    if length == 0.0 or points < 2:
        raise WorkspaceError("Line: it needs two different ends and at least two points.")
    feed = feed / length
    normal = np.cross([0.0, 0.0, 1.0], feed)
    if np.linalg.norm(normal) < 1e-9:
        raise WorkspaceError("Line: the feed is along the tool axis, so it has no normal; turn the line.")
    normal /= np.linalg.norm(normal)
    p = first + np.linspace(0.0, length, points)[:, None] * feed
    x_M = np.concatenate([p, np.zeros((points, 2))], axis=1)
    found = inverse_kinematics(robot, pose_from_world(x_M), near="path")
    J_v = geometric_jacobian(robot, found.theta)[:, :3]
    F = force * normal
    delta_joint = deflection(joint_contributions(J_v, robot.C_theta), F)
    return LineDeviation(name, p, feed, normal, F, found, delta_joint)


def border_and_middle_lines(
    robot: Robot,
    lower: ArrayLike = PAPER_BOX[0][:2],
    upper: ArrayLike = PAPER_BOX[1][:2],
    z: float = 0.0,
    force: float = SLOT.force,
    points: int = 61,
) -> list[LineDeviation]:
    """The six lines of Fig. 8: three along X_M and three along Y_M, on the borders and through the middle."""
    low = as_floats(lower, "Plane, lower corner", (2,), error=WorkspaceError)
    high = as_floats(upper, "Plane, upper corner", (2,), error=WorkspaceError)
    middle = 0.5 * (low + high)
    across = [
        line_deviation(robot, [low[0], y, z], [high[0], y, z], force, points, name=f"along X_M at Y_M = {_mm(y)}")
        for y in (low[1], middle[1], high[1])
    ]
    along = [
        line_deviation(robot, [x, low[1], z], [x, high[1], z], force, points, name=f"along Y_M at X_M = {_mm(x)}")
        for x in (low[0], middle[0], high[0])
    ]
    return across + along


def _mm(value: float) -> str:
    return format_si(value, "mm", 0)
