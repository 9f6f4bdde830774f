"""The geometric Jacobian of the tool tip and the task Jacobian of five-axis milling."""

from __future__ import annotations

from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.kinematics.forward import BLOCK, SMALL, chain_arguments, frame_columns, joint_angles, kernels
from robomill.kinematics.transforms import rotation_x, rotation_y, tilt_from_axis
from robomill.robot.dh import Chain
from robomill.robot.model import Robot


def geometric_jacobian(robot: Robot, theta: ArrayLike) -> FloatArray:
    """J (..., 6, n) in {M}: rows v_x v_y v_z of the tip (m/rad), omega_x omega_y omega_z (rad/rad). Eqs. (8), (9).

    Columns are with respect to the joint coordinate theta_i, so each carries its joint's sign; a prismatic column is
    its axis over zeros. theta (..., n).
    """
    return pose_and_jacobian(robot, theta)[1]


def pose_and_jacobian(robot: Robot, theta: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """(T_MT (..., 4, 4), J (..., 6, n)) in one pass."""
    theta = joint_angles(robot, theta)
    flat = theta.reshape(-1, robot.n)
    m = len(flat)
    compiled = kernels.get(m) if m >= SMALL else None
    if compiled is not None:
        T_MT, J, _ = compiled_pose_jacobian(compiled, robot, flat, None)
        return T_MT.reshape(*theta.shape[:-1], 4, 4), J.reshape(*theta.shape[:-1], 6, robot.n)
    T_MT = np.zeros((m, 4, 4))
    T_MT[:, 3, 3] = 1.0
    J = np.empty((m, 6, robot.n))
    for start in range(0, m, BLOCK):
        block = slice(start, start + BLOCK)
        frames = frame_columns(robot.chain, flat[block].T)
        T_MT[block, :3, :] = frames[-1].transpose(2, 0, 1)
        J[block] = jacobian_columns(robot.chain, frames).transpose(2, 0, 1)
    lead = theta.shape[:-1]
    return T_MT.reshape(*lead, 4, 4), J.reshape(*lead, 6, robot.n)


def pose_jacobian_gram(robot: Robot, theta: ArrayLike, weight: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(T_MT (..., 4, 4), J (..., 6, n), J_v diag(weight) J_v^T (..., 3, 3)) in one pass; weight (n,)."""
    theta = joint_angles(robot, theta)
    flat = theta.reshape(-1, robot.n)
    lead = theta.shape[:-1]
    compiled = kernels.get(len(flat)) if len(flat) >= SMALL else None
    if compiled is not None:
        T_MT, J, G = compiled_pose_jacobian(compiled, robot, flat, weight)
        return T_MT.reshape(*lead, 4, 4), J.reshape(*lead, 6, robot.n), G.reshape(*lead, 3, 3)
    T_MT, J = pose_and_jacobian(robot, theta)
    J_v = J[..., :3, :]
    return T_MT, J, (J_v * weight) @ np.swapaxes(J_v, -1, -2)


def compiled_pose_jacobian(
    compiled: ModuleType, robot: Robot, flat: FloatArray, weight: FloatArray | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(T_MT, J, G) of theta (m, n) by the compiled kernel; G is empty without ``weight``."""
    m, n = flat.shape
    T_MT, J = np.empty((m, 4, 4)), np.empty((m, 6, n))
    G = np.empty((0 if weight is None else m, 3, 3))
    weight = np.ones(n) if weight is None else weight
    compiled.forward_jacobian(np.ascontiguousarray(flat), *chain_arguments(robot.chain), weight, T_MT, J, G)
    return T_MT, J, G


def jacobian_columns(chain: Chain, frames: list[FloatArray]) -> FloatArray:
    """J (6, n, m) from the frames of ``frame_columns``."""
    tip = frames[-1][:, 3]
    J = np.zeros((6, chain.n, tip.shape[1]))
    for i in range(chain.n):
        z = chain.sign[i] * frames[i][:, 2]
        if chain.prismatic[i]:
            J[:3, i] = z
            continue
        r = tip - frames[i][:, 3]
        J[0, i] = z[1] * r[2] - z[2] * r[1]
        J[1, i] = z[2] * r[0] - z[0] * r[2]
        J[2, i] = z[0] * r[1] - z[1] * r[0]
        J[3:, i] = z
    return J


def task_jacobian(robot: Robot, theta: ArrayLike) -> FloatArray:
    """J_task (..., 5, n): rows v_x, v_y, v_z and the angular velocity about x' and y', perpendicular to the tool axis.

    x', y' are the first two axes of R_x(A) R_y(B) at the tool's tilt. At A = B = 0 these are the first five rows of J.
    """
    T_MT, J = pose_and_jacobian(robot, theta)
    return task_rows(T_MT, J)


def task_rows(T_MT: FloatArray, J: FloatArray) -> FloatArray:
    """J_task (..., 5, n) from the pose and the geometric Jacobian."""
    tilt = tilt_axes(T_MT[..., :3, 2])
    return np.concatenate([J[..., :3, :], tilt @ J[..., 3:, :]], axis=-2)


def tilt_axes(k: FloatArray) -> FloatArray:
    """The rows x', y' (..., 2, 3) of R_x(A) R_y(B) for tool axes k (..., 3); NaN in gives NaN out."""
    finite = np.all(np.isfinite(k), axis=-1, keepdims=True)
    tilt = tilt_from_axis(np.where(finite, k, [0.0, 0.0, 1.0]))
    R = rotation_x(tilt[..., 0]) @ rotation_y(tilt[..., 1])
    return np.where(np.expand_dims(finite, -1), np.swapaxes(R, -1, -2)[..., :2, :], np.nan)
