"""The geometric Jacobian of the tool tip and the task Jacobian of five-axis milling."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked
from robomill.arrays import BoolArray, FloatArray
from robomill.kinematics.forward import joint_angles, rows
from robomill.kinematics.transforms import rotation_x, rotation_y, tilt_from_axis
from robomill.robot.model import Robot


@asked
def geometric_jacobian(robot: Robot, theta: ArrayLike) -> FloatArray:
    """The geometric Jacobian of the tool tip, eqs. (8), (9).

    Parameters
    ----------
    robot : Robot
        The arm, with n free joints.
    theta : array_like, (..., n)
        Joint coordinates, rad (m where a joint slides).

    Returns
    -------
    ndarray, (..., 6, n)
        J in {M}: rows v_x, v_y, v_z of the tip (m/rad), omega_x, omega_y, omega_z (rad/rad). Each column is with
        respect to theta_i and carries its joint's sign; that of a sliding joint is its axis over zeros.

    Raises
    ------
    KinematicsError
        Where theta is infinite or has not n entries; NaN (a pose that is not reached) gives NaN.

    Examples
    --------
    >>> import robomill as rm
    >>> J = rm.geometric_jacobian(rm.load_robot("planar_2r"), [0.0, 0.0])
    >>> J[:2].tolist()
    [[0.0, 0.0], [0.9, 0.4]]
    """
    return pose_and_jacobian(robot, theta)[1]


def pose_and_jacobian(robot: Robot, theta: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """(T_MT (..., 4, 4), J (..., 6, n)) in one pass."""
    from robomill.kinematics import kernels

    theta = joint_angles(robot, theta)
    lead = theta.shape[:-1]
    T_MT, J = np.empty((*lead, 4, 4)), np.empty((*lead, 6, robot.n))
    kernels.jacobian_of(rows(theta), robot.chain, T_MT.reshape(-1, 4, 4), J.reshape(-1, 6, robot.n))
    return T_MT, J


def twists(axis: FloatArray, reach: FloatArray, slides: BoolArray | bool = False) -> FloatArray:
    """(..., 6) how points move: rows v (m) and omega (rad) by a unit turn about ``axis`` (..., 3) at ``reach`` from it.

    reach (..., 3) m; by a unit shift along it where it ``slides`` (...). Eqs. (8), (9).
    """
    from robomill.kinematics import kernels

    lead = np.broadcast_shapes(axis.shape[:-1], reach.shape[:-1], np.shape(slides))
    axis, reach = (rows(np.broadcast_to(each, (*lead, 3))) for each in (axis, reach))
    found = np.empty((*lead, 6))
    kernels.twists_of(axis, reach, np.broadcast_to(slides, lead).flatten(), found.reshape(-1, 6))
    return found


@asked
def task_jacobian(robot: Robot, theta: ArrayLike) -> FloatArray:
    """The Jacobian of what a five-axis task asks: the tip, and the direction of the tool axis.

    Parameters
    ----------
    robot : Robot
        The arm, with n free joints.
    theta : array_like, (..., n)
        Joint coordinates, rad (m where a joint slides).

    Returns
    -------
    ndarray, (..., 5, n)
        J_task: rows v_x, v_y, v_z (m/rad) and the angular velocity (rad/rad) about x' and y', the first two axes of
        R_x(A) R_y(B) at the tool's tilt. At A = B = 0 these are the first five rows of J, eqs. (8), (9).

    Raises
    ------
    KinematicsError
        Where theta is infinite or has not n entries; NaN (a pose that is not reached) gives NaN.

    Examples
    --------
    >>> import robomill as rm
    >>> robot = rm.load_robot("slavkovic_5r")
    >>> rm.task_jacobian(robot, robot.home).shape
    (5, 5)
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
