"""How well conditioned a configuration is: determinant, manipulability, condition, distance to the joint limits."""

from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray
from robomill.kinematics.extent import drawn
from robomill.kinematics.forward import joint_angles
from robomill.kinematics.jacobian import pose_and_jacobian, task_rows
from robomill.robot.model import Robot

NEAR = 0.02  # of the largest |det(J)|: below it a singular configuration is near
ROUNDING = 1e-12  # a |det(J)| below this is none, in m or m^3
SAMPLES = 4096
ROWS = ("v_x", "v_y", "v_z", "omega_x", "omega_y", "omega_z")
FIVE_AXIS_ROWS = ("v_x", "v_y", "v_z", "omega_x'", "omega_y'")


def square_rows(robot: Robot) -> tuple[str, ...]:
    """Names of the Jacobian rows that ``task_matrix`` keeps, so that a determinant can say what it is of.

    Five axes: the milling task (tip and tool axis). Six or more: all six rows. Fewer: the rows in which the arm can
    move, v first; a planar arm of two joints has v_x, v_y, one of three also omega_z.
    """
    if robot.n == 5:
        return FIVE_AXIS_ROWS
    return tuple(ROWS[i] for i in _row_indices(robot))


def has_determinant(robot: Robot) -> bool:
    """Whether the arm's task Jacobian is square: as many independent rows as joints."""
    return len(square_rows(robot)) == robot.n


def determinant_unit(robot: Robot) -> str:
    """The unit of ``determinant`` as a key of ``UNITS``: one power of m for each row of v, less one a sliding joint."""
    powers = sum(row.startswith("v") for row in square_rows(robot)) - int(robot.prismatic[robot.free].sum())
    return {1: "m", 2: "m2", 3: "m3"}.get(powers, "1")


@lru_cache(maxsize=64)
def _row_indices(robot: Robot) -> tuple[int, ...]:
    """The first n rows of J (v before omega) that are independent of each other over random configurations."""
    if robot.n >= 6:
        return tuple(range(6))
    rows = pose_and_jacobian(robot, drawn(robot, 24))[1].transpose(1, 0, 2).reshape(6, -1)
    kept: list[int] = []
    for i in range(6):
        trial = rows[[*kept, i]]
        if len(kept) < robot.n and np.linalg.matrix_rank(trial, tol=1e-9) == len(trial):
            kept.append(i)
    return tuple(kept)


def task_matrix(robot: Robot, theta: ArrayLike) -> FloatArray:
    """The Jacobian (..., r, n) of the arm's own task, rows as named by ``square_rows``; square unless n is 7."""
    return square_matrix(robot, *pose_and_jacobian(robot, theta))


def square_matrix(robot: Robot, T_MT: FloatArray, J: FloatArray) -> FloatArray:
    """As ``task_matrix``, from pose (..., 4, 4) and geometric Jacobian (..., 6, n)."""
    if robot.n == 5:
        return task_rows(T_MT, J)
    return J[..., list(_row_indices(robot)), :]


def determinant(robot: Robot, theta: ArrayLike) -> FloatArray:
    """det(J) (...,) of the arm's task: for five axes of the 5 x 5 task Jacobian, in m^3 (Fig. 4). theta (..., n).

    Six axes: of the 6 x 6 Jacobian, m^3. Planar arms: m^2. Seven axes have no determinant; its size, the
    manipulability, is given instead.
    """
    from robomill.kinematics import kernels

    A = task_matrix(robot, theta)
    det = np.empty(A.shape[:-2])
    kernels.determinant_of(np.ascontiguousarray(A.reshape(-1, *A.shape[-2:])), det.reshape(-1))
    return det


@lru_cache(maxsize=64)
def largest_determinant(robot: Robot) -> float:
    """The largest |det(J)| of the arm: of ``SAMPLES`` configurations drawn within its limits, always the same ones."""
    return float(np.abs(determinant(robot, drawn(robot, SAMPLES))).max())


def near_singular(robot: Robot, det: ArrayLike) -> BoolArray:
    """Where det(J) (...,) is so small that the arm is at a singular configuration or close to one; False for NaN.

    Closer than ``NEAR`` of the largest that this arm has: a rule that knows neither its size nor the unit, nor a grid.
    An arm whose joints can nowhere do its task has nothing but rounding there.
    """
    return np.asarray(np.abs(np.asarray(det, dtype=np.float64)) <= max(NEAR * largest_determinant(robot), ROUNDING))


def singularity_among(robot: Robot, det: ArrayLike) -> Literal["passed", "near", "none"]:
    """What configurations of det(J) (...,) that an arm can go between meet: a singularity is passed where both signs
    are among them."""
    det = np.asarray(det, dtype=np.float64)
    if (det > 0.0).any() and (det < 0.0).any():
        return "passed"
    return "near" if near_singular(robot, det).any() else "none"


def manipulability(robot: Robot, theta: ArrayLike) -> FloatArray:
    """sqrt(det(J J^T)) (...,), Yoshikawa's measure, of the arm's task Jacobian, which is |det(J)|."""
    return np.abs(determinant(robot, theta))


def limit_distance(robot: Robot, theta: ArrayLike) -> FloatArray:
    """(...,) distance of the nearest joint to its limit as a share of its half range: 1 mid-range, 0 at a limit.

    Negative outside the limits.
    """
    theta = joint_angles(robot, theta)
    low, high = robot.limits[:, 0], robot.limits[:, 1]
    half = 0.5 * (high - low)
    return (np.minimum(theta - low, high - theta) / half).min(axis=-1)
