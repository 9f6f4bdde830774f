"""Where the tool is: forward kinematics, batched over leading axes."""

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, as_floats
from robomill.errors import KinematicsError
from robomill.robot.model import Robot

# Poses handled at a time where several arrays of them are needed: a block stays in the second-level cache.
BLOCK = 4096


def joint_angles(robot: Robot, theta: ArrayLike) -> FloatArray:
    """``theta`` as (..., n) floats. NaN is allowed (a configuration that is not reached). Raises KinematicsError."""
    return as_floats(
        theta, f"theta of {robot.name!r} (one entry a free joint)", (robot.n,), error=KinematicsError, finite=False
    )


def tool_pose(robot: Robot, theta: ArrayLike) -> FloatArray:
    """T_MT (..., 4, 4) of the configurations theta (..., n) rad (m where prismatic). Eqs. (4), (5), (7)."""
    from robomill.kinematics import kernels

    theta = joint_angles(robot, theta)
    T_MT = np.empty((*theta.shape[:-1], 4, 4))
    kernels.pose_of(rows(theta), robot.chain, T_MT.reshape(-1, 4, 4))
    return T_MT


def joint_frames(robot: Robot, theta: ArrayLike) -> FloatArray:
    """Frames (..., n + 1, 4, 4) in {M}: the frame each joint moves about (its z axis is the joint axis), then {T}."""
    from robomill.kinematics import kernels

    theta = joint_angles(robot, theta)
    frames = np.empty((*theta.shape[:-1], robot.n + 1, 4, 4))
    kernels.frames_of(rows(theta), robot.chain, frames.reshape(-1, robot.n + 1, 4, 4))
    return frames


def rows(theta: FloatArray) -> FloatArray:
    """Configurations (..., n) as kernels take them: (m, n), in order in memory."""
    return np.ascontiguousarray(theta.reshape(-1, theta.shape[-1]))
