"""Where the tool is: forward kinematics, batched over leading axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, as_floats
from robomill.errors import KinematicsError
from robomill.kinematics.compiled import Kernels
from robomill.robot.dh import Chain
from robomill.robot.model import Robot

# Configurations handled at a time: the columns of a block stay in the second-level cache.
BLOCK = 4096
SMALL = 32  # below this many, NumPy is as quick as a compiled call
kernels = Kernels("robomill.kinematics.kernels")


def joint_angles(robot: Robot, theta: ArrayLike) -> FloatArray:
    """``theta`` as (..., n) floats. NaN is allowed (a configuration that is not reached). Raises KinematicsError."""
    return as_floats(
        theta, f"theta of {robot.name!r} (one entry a free joint)", (robot.n,), error=KinematicsError, finite=False
    )


def tool_pose(robot: Robot, theta: ArrayLike) -> FloatArray:
    """T_MT (..., 4, 4) of the configurations theta (..., n) rad (m where prismatic). Eqs. (4), (5), (7)."""
    theta = joint_angles(robot, theta)
    flat = theta.reshape(-1, robot.n)
    compiled = kernels.get(len(flat)) if len(flat) >= SMALL else None
    if compiled is not None:
        T_MT = np.empty((len(flat), 4, 4))
        compiled.forward(np.ascontiguousarray(flat), *chain_arguments(robot.chain), T_MT)
        return T_MT.reshape(*theta.shape[:-1], 4, 4)
    T_MT = np.zeros((len(flat), 4, 4))
    T_MT[:, 3, 3] = 1.0
    for start in range(0, len(flat), BLOCK):
        *_, last = frame_columns(robot.chain, flat[start : start + BLOCK].T)
        T_MT[start : start + BLOCK, :3, :] = last.transpose(2, 0, 1)
    return T_MT.reshape(*theta.shape[:-1], 4, 4)


def joint_frames(robot: Robot, theta: ArrayLike) -> FloatArray:
    """Frames (..., n + 1, 4, 4) in {M}: the frame each joint moves about (its z axis is the joint axis), then {T}."""
    theta = joint_angles(robot, theta)
    flat = theta.reshape(-1, robot.n)
    frames = np.zeros((len(flat), robot.n + 1, 4, 4))
    frames[..., 3, 3] = 1.0
    for start in range(0, len(flat), BLOCK):
        columns = frame_columns(robot.chain, flat[start : start + BLOCK].T)
        for i, frame in enumerate(columns):
            frames[start : start + BLOCK, i, :3, :] = frame.transpose(2, 0, 1)
    return frames.reshape(*theta.shape[:-1], robot.n + 1, 4, 4)


def chain_arguments(chain: Chain) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, BoolArray]:
    """A chain as the compiled kernels take it."""
    return chain.T_0, chain.E, chain.sign, chain.offset, chain.prismatic


def frame_columns(chain: Chain, theta: FloatArray) -> list[FloatArray]:
    """Frames (3, 4, m) before each of the n joints and of the tool, for theta (n, m): one column a configuration."""
    m = theta.shape[1]
    frame = np.empty((3, 4, m))
    frame[...] = chain.T_0[:3, :, None]
    frames = [frame]
    for i in range(chain.n):
        q = chain.sign[i] * theta[i] + chain.offset[i]
        moved = frame.copy()
        if chain.prismatic[i]:
            moved[:, 3] += q * frame[:, 2]
        else:
            c, s = np.cos(q), np.sin(q)
            moved[:, 0] = c * frame[:, 0] + s * frame[:, 1]
            moved[:, 1] = c * frame[:, 1] - s * frame[:, 0]
        frame = _times_constant(moved, chain.E[i])
        frames.append(frame)
    return frames


def _times_constant(frame: FloatArray, E: FloatArray) -> FloatArray:
    """frame (3, 4, m) @ E (4, 4), skipping the zeros that D-H tables are full of."""
    result = np.empty_like(frame)
    for j in range(4):
        terms = [frame[:, k] if E[k, j] == 1.0 else E[k, j] * frame[:, k] for k in range(4) if E[k, j] != 0.0]
        total = terms[0]
        for term in terms[1:]:
            total = total + term
        result[:, j] = total
    return result
