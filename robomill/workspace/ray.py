"""The way outwards: configurations along a horizontal ray from the base to the very edges of the workspace."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.kinematics.decoupled import decoupled
from robomill.kinematics.dexterity import determinant
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.result import IKResult
from robomill.kinematics.transforms import pose_from_world
from robomill.robot.model import Robot

RADII, FEW_RADII = 121, 41  # looked at; fewer for an arm that is solved numerically
HALVINGS = 24


@dataclass(frozen=True, eq=False)
class Ray:
    """Along the ray, tool vertical: p (m, 3) m in {M}, radius (m,) m from the base axis, theta (m, n), det(J) (m,).

    ``start`` is the index of the point it was drawn through.
    """

    p: FloatArray
    radius: FloatArray
    theta: FloatArray
    det: FloatArray
    start: int


def ray_through(robot: Robot, point: ArrayLike) -> Ray:
    """The ray from the base axis through ``point`` (3,) m, as far as the arm reaches without a gap on either side."""
    point, base = np.asarray(point, dtype=float), np.array(robot.T_base[:2, 3])
    across = point[:2] - base
    size = float(np.linalg.norm(across))
    across = across / size if size > 1e-9 else np.array([0.0, -1.0])
    longest = float(np.abs(robot.a).sum() + np.abs(robot.d).sum()) + size
    count = RADII if decoupled(robot) is not None else FEW_RADII
    radii = np.union1d(np.linspace(0.02, 1.0, count) * longest, [size])

    def solved(r: FloatArray) -> tuple[FloatArray, IKResult]:
        p = np.column_stack([base + r[:, None] * across, np.full(len(r), point[2])])
        return p, inverse_kinematics(robot, pose_from_world(np.column_stack([p, np.zeros((len(p), 2))])))

    reached = solved(radii)[1].reached
    at = int(np.searchsorted(radii, size))
    gaps = np.flatnonzero(~reached)
    first = int(gaps[gaps < at].max(initial=-1)) + 1
    last = int(gaps[gaps > at].min(initial=len(radii))) - 1
    # The edges themselves, by halving between the last point in reach and the first one out of it.
    edges = []
    for inside, outside in ((first, first - 1), (last, last + 1)):
        if 0 <= outside < len(radii):
            low, high = radii[inside], radii[outside]
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if bool(solved(np.array([middle]))[1].reached[0]) else (low, middle)
            edges.append(low)
    run = np.union1d(radii[first : last + 1], edges)
    p, found = solved(run)
    return Ray(p, run, found.theta, determinant(robot, found.theta), int(np.argmin(np.abs(run - size))))
