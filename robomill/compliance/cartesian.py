"""Cartesian compliance of the tool tip and each joint's share of it, eqs. (11)-(14)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked
from robomill.arrays import FloatArray, as_floats
from robomill.errors import KinematicsError
from robomill.kinematics.forward import rows
from robomill.kinematics.jacobian import geometric_jacobian, pose_and_jacobian
from robomill.robot.model import Robot


@asked
def joint_contributions(J_v: ArrayLike, C_theta: ArrayLike) -> FloatArray:
    """What each joint gives to the compliance of the tip: C_theta,i J_i J_i^T, eqs. (13), (14).

    Parameters
    ----------
    J_v : array_like, (..., 3, n)
        Linear rows of the geometric Jacobian, m/rad.
    C_theta : array_like, (..., n)
        Compliances of the joints, rad/(N m) (m/N where a joint slides).

    Returns
    -------
    ndarray, (..., n, 3, 3)
        C_joint, m/N, in {M}; summed over the joints it is the compliance C.

    Raises
    ------
    KinematicsError
        Where the shapes do not match.

    Examples
    --------
    >>> import robomill as rm
    >>> robot = rm.load_robot("planar_2r")
    >>> J_v = rm.geometric_jacobian(robot, [0.0, 0.0])[:3]
    >>> rm.joint_contributions(J_v, robot.C_theta).shape
    (2, 3, 3)
    """
    if isinstance(J_v, Robot):
        raise KinematicsError(
            "J_v: found a Robot, expected the linear rows of its Jacobian; of a robot and a configuration "
            "rm.at_pose(robot, theta).C_joint gives the joints' shares."
        )
    J_v = as_floats(J_v, "J_v", (3, None), error=KinematicsError, finite=False)
    return _shares(J_v, as_floats(C_theta, "C_theta", (J_v.shape[-1],), error=KinematicsError))


def _shares(J: FloatArray, C_theta: FloatArray) -> FloatArray:
    """(..., n, r, r) of all rows of J (..., r, n)."""
    from robomill.kinematics import kernels

    lead, (r, n) = np.broadcast_shapes(J.shape[:-2], C_theta.shape[:-1]), J.shape[-2:]
    C_joint = np.empty((*lead, n, r, r))
    if C_theta.ndim > 1:
        C_theta = np.broadcast_to(C_theta, (*lead, n))
    J = np.ascontiguousarray(np.broadcast_to(J, (*lead, r, n)).reshape(-1, r, n))
    kernels.shares_of(J, rows(C_theta), C_joint.reshape(-1, n, r, r))
    return C_joint


@asked
def cartesian_compliance(robot: Robot, theta: ArrayLike) -> FloatArray:
    """How much the tip gives: the translational block of J C_theta J^T, eqs. (11), (12).

    Parameters
    ----------
    robot : Robot
        The arm, with n free joints.
    theta : array_like, (..., n)
        Joint coordinates, rad (m where a joint slides).

    Returns
    -------
    ndarray, (..., 3, 3)
        C in {M}, m/N: a force F on the tool moves the tip by C F.

    Raises
    ------
    KinematicsError
        Where theta is infinite or has not n entries; NaN (a pose that is not reached) gives NaN.

    Examples
    --------
    >>> import robomill as rm
    >>> robot = rm.load_robot("slavkovic_5r")
    >>> theta = rm.inverse_kinematics(robot, rm.pose_from_world([0.0, -1.3, 0.0, 0.0, 0.0])).theta
    >>> C = rm.cartesian_compliance(robot, theta)
    >>> [round(1e6 * float(C[i, j]), 3) for i, j in ((0, 0), (1, 1), (2, 2), (1, 2))]
    [1.281, 2.295, 2.422, -1.024]
    """
    return pose_jacobian_compliance(robot, theta)[2]


def pose_jacobian_compliance(robot: Robot, theta: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(T_MT (..., 4, 4), J (..., 6, n), C (..., 3, 3) m/N) in one pass over theta (..., n)."""
    from robomill.kinematics import kernels

    T_MT, J = pose_and_jacobian(robot, theta)
    C = np.empty((*J.shape[:-2], 3, 3))
    kernels.compliance_of(J.reshape(-1, 6, robot.n), robot.C_theta, C.reshape(-1, 3, 3))
    return T_MT, J, C


def full_compliance(robot: Robot, theta: ArrayLike) -> FloatArray:
    """C_X (..., 6, 6) = J C_theta J^T in {M}: m/N, rad/N and 1/N, rad/(N m) in its four blocks. Eq. (11).

    It maps the wrench (force on the tool, moment about the tip) to (tip displacement, small rotation).
    """
    return _shares(geometric_jacobian(robot, theta), robot.C_theta).sum(axis=-3)
