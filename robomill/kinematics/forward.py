"""Where the tool is: forward kinematics, batched over leading axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked
from robomill.arrays import BoolArray, FloatArray, as_floats
from robomill.errors import KinematicsError
from robomill.robot.model import Robot, check_robot
from robomill.spelled import beside
from robomill.units import format_short, to_si

# Poses handled at a time where several arrays of them are needed: a block stays in the second-level cache.
BLOCK = 4096
# Turns (strokes, where a joint slides) beyond its limits at which an angle was meant in degrees; numbers of one
# decimal are suspected from one turn on: nobody has such angles in radians. So are all angles where limits are known.
SLIPPED = 5.0


def joint_angles(robot: Robot, theta: ArrayLike) -> FloatArray:
    """``theta`` as (..., n) floats. NaN is allowed (a configuration that is not reached). Raises KinematicsError, also
    for angles that were meant in degrees, and RobotError where ``robot`` is none."""
    check_robot(robot)
    found = as_floats(
        theta, f"theta of {robot.name!r} (one entry a free joint)", (robot.n,), error=KinematicsError, finite=False
    )
    if np.isinf(found).any():
        text = "expected finite numbers, or NaN where it is not known, found inf."
        raise KinematicsError(f"theta of {robot.name!r}: {text}")
    low, high = robot.limits.T
    turn = np.where(robot.chain.prismatic, np.maximum(high - low, 1.0), 2.0 * np.pi)
    for turns in (SLIPPED, 1.0):
        beyond = (found < low - turns * turn) | (found > high + turns * turn)
        if not beyond.any():
            continue
        short = not (np.nan_to_num(10.0 * found).round(9) % 1.0).any()
        if turns == SLIPPED or short or (beyond & _known_limits(robot)).any():
            raise KinematicsError(_slipped(robot, found, beyond))
    return found


def _known_limits(robot: Robot) -> BoolArray:
    """(n,) where somebody has stated limits; half a turn either way is also what joints without limits are given."""
    stated = robot.provenance["limits"].kind != "assumed"
    return np.asarray(stated & ~(np.abs(np.abs(robot.limits) - np.pi) < 1e-9).all(axis=1))


def _slipped(robot: Robot, theta: FloatArray, beyond: BoolArray) -> str:
    """What to say of a coordinate that lies beyond its limits as one in degrees or mm does."""
    joint = int(np.argwhere(beyond)[0][-1])
    value, number = float(theta[beyond][0]), robot.joint_numbers[joint]
    if beside():
        unit = robot.joint_units[joint]
        found, low, high = (format_short(float(each), unit) for each in (value, *robot.limits[joint]))
        return f"theta of {robot.name!r}: joint {number} is at {found}, far beyond its limits of {low} to {high}."
    if robot.chain.prismatic[joint]:
        is_m, meant = f"{value:g} m", f"{value:g} mm are {value * to_si(1.0, 'mm'):g}"
    else:
        is_m, meant = f"{value:g} rad", f"{value:g}° are {to_si(value, 'deg'):.5g} (numpy.deg2rad)"
    return (
        f"theta of {robot.name!r}: joint {number} is at {is_m}, far beyond its limits: theta is in rad (m where a "
        f"joint slides); {meant}. Take whole turns off an angle that is meant so."
    )


@asked
def tool_pose(robot: Robot, theta: ArrayLike) -> FloatArray:
    """Where the tool is: forward kinematics, eqs. (4), (5), (7).

    Parameters
    ----------
    robot : Robot
        The arm, with n free joints.
    theta : array_like, (..., n)
        Joint coordinates, rad (m where a joint slides).

    Returns
    -------
    ndarray, (..., 4, 4)
        T_MT: the pose of the tool frame {T} in the robot's base frame {M}; lengths in m.

    Raises
    ------
    KinematicsError
        Where theta is infinite or has not n entries; NaN (a pose that is not reached) gives NaN.

    Examples
    --------
    >>> import robomill as rm
    >>> T_MT = rm.tool_pose(rm.load_robot("planar_2r"), [0.0, 0.0])
    >>> T_MT[:3, 3].tolist()
    [0.9, 0.0, 0.0]
    """
    from robomill.kinematics import kernels

    theta = joint_angles(robot, theta)
    T_MT = np.empty((*theta.shape[:-1], 4, 4))
    kernels.pose_of(rows(theta), robot.chain, T_MT.reshape(-1, 4, 4))
    return T_MT


@asked
def joint_frames(robot: Robot, theta: ArrayLike) -> FloatArray:
    """Frames of all joints and of the tool, eqs. (4), (5).

    Parameters
    ----------
    robot : Robot
        The arm, with n free joints.
    theta : array_like, (..., n)
        Joint coordinates, rad (m where a joint slides).

    Returns
    -------
    ndarray, (..., n + 1, 4, 4)
        In {M}, m: the frame that each joint moves about (its z axis is the joint's axis), then {T}.

    Raises
    ------
    KinematicsError
        Where theta is infinite or has not n entries; NaN (a pose that is not reached) gives NaN.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.joint_frames(rm.load_robot("planar_2r"), [0.0, 0.0]).shape
    (3, 4, 4)
    """
    from robomill.kinematics import kernels

    theta = joint_angles(robot, theta)
    frames = np.empty((*theta.shape[:-1], robot.n + 1, 4, 4))
    kernels.frames_of(rows(theta), robot.chain, frames.reshape(-1, robot.n + 1, 4, 4))
    return frames


def rows(theta: FloatArray) -> FloatArray:
    """Configurations (..., n) as kernels take them: (m, n), in order in memory."""
    return np.ascontiguousarray(theta.reshape(-1, theta.shape[-1]))
