"""The part zero {W} in the robot's frame {M} from touched points."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked
from robomill.arrays import FloatArray, as_floats, frozen
from robomill.errors import ToolpathError
from robomill.quantities import Quantity
from robomill.rigid import transform
from robomill.spelled import refuse_slip
from robomill.units import format_si, to_si

CLOSEST = 1e-3
TOUCHED = Quantity("place", "mm", "array", shape=(3,), name="points", slip=20.0)
SMALLEST_ANGLE = to_si(2.0, "deg")


@dataclass(frozen=True, eq=False)
class TouchedFrame:
    """T_MW (4, 4) from three points, and how well they define it.

    base    m    from the zero to the point on x: the longer, the smaller the error of the axes
    angle   rad  between the x axis and the third point, best a right angle
    lever   m    how far the third point lies from the x axis
    """

    T_MW: FloatArray
    base: float
    angle: float
    lever: float

    @asked
    def tilt(self, error: float) -> float:
        """rad: by how much the axes turn at most when each point is off by ``error`` m."""
        return math.hypot(2.0 * error / self.base, 2.0 * error / self.lever)


@asked
def frame_from_points(zero: ArrayLike, on_x: ArrayLike, in_xy: ArrayLike) -> TouchedFrame:
    """The part frame {W} from three points that were touched.

    Parameters
    ----------
    zero, on_x, in_xy : array_like, (3,)
        m, in {M}: its zero, a point on its +x axis, and one on the +y side of its xy plane.

    Returns
    -------
    TouchedFrame
        With T_MW (4, 4), the pose of {W} in {M}; z_W = x_W x y_W.

    Raises
    ------
    ToolpathError
        For points that are too close, or (almost) on one line.

    Examples
    --------
    >>> import robomill as rm
    >>> touched = rm.frame_from_points([0.0, -1.3, 0.0], [0.1, -1.3, 0.0], [0.0, -1.2, 0.0])
    >>> touched.T_MW[:3, 3].tolist()
    [0.0, -1.3, 0.0]
    """
    names = ("zero", "point on x", "point on the y side")
    o, a, b = (
        as_floats(point, f"Part zero, {name}", (3,), error=ToolpathError, one=True)
        for name, point in zip(names, (zero, on_x, in_xy), strict=True)
    )
    for name, point in zip(names, (o, a, b), strict=True):
        refuse_slip(TOUCHED, point, ToolpathError, f"Part zero, {name}")
    x, side = a - o, b - o
    base, reach = float(np.linalg.norm(x)), float(np.linalg.norm(side))
    for name, distance in ((names[1], base), (names[2], reach)):
        if distance < CLOSEST:
            raise ToolpathError(
                f"Part zero: the {name} is {format_si(distance, 'mm')} from the zero; touch points at least "
                f"{format_si(CLOSEST, 'mm', 0)} apart, better far apart."
            )
    x = x / base
    z = np.cross(x, side)
    lever = float(np.linalg.norm(z))
    angle = math.atan2(lever, float(x @ side))
    if min(angle, math.pi - angle) < SMALLEST_ANGLE:
        raise ToolpathError(
            f"Part zero: the three points are on one line within {format_si(min(angle, math.pi - angle), 'deg')}; "
            "touch the third one well beside the x axis."
        )
    z = z / lever
    T_MW = transform(np.column_stack([x, np.cross(z, x), z]), o)
    return TouchedFrame(frozen(T_MW), base, angle, lever)


def points_of_frame(T_MW: ArrayLike, distance: float = 0.1) -> FloatArray:
    """Three points (3, 3) m in {M} that give the frame back: its zero, ``distance`` m along x, and along y."""
    T = as_floats(T_MW, "part zero T_MW", (4, 4), error=ToolpathError)
    o = T[:3, 3]
    return np.array([o, o + distance * T[:3, 0], o + distance * T[:3, 1]])
