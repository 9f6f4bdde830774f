"""Kinematics in the most naive way: the rows of a Denavit-Hartenberg table multiplied out."""

from __future__ import annotations

import math

import numpy as np

from robomill.robot.model import Robot


def screw(robot: Robot, row: int, q: float) -> np.ndarray:
    """A row of a D-H table, eq. (4), written out."""
    t, al = robot.sign[row] * q + robot.theta_offset[row], robot.alpha[row]
    turn = np.array(
        [[math.cos(t), -math.sin(t), 0, 0], [math.sin(t), math.cos(t), 0, 0], [0, 0, 1, robot.d[row]], [0, 0, 0, 1]]
    )
    link = np.array(
        [[1, 0, 0, robot.a[row]], [0, math.cos(al), -math.sin(al), 0], [0, math.sin(al), math.cos(al), 0], [0, 0, 0, 1]]
    )
    return turn @ link


def frames(robot: Robot, theta: np.ndarray) -> list[np.ndarray]:
    """The frame after each row, by multiplying the table's rows."""
    frames = [np.array(robot.T_base)]
    for row in range(robot.rows):
        frames.append(frames[-1] @ screw(robot, row, float(theta[row])))
    return frames[1:]


def tip(robot: Robot, theta: np.ndarray) -> np.ndarray:
    """The tip by multiplying the table's rows."""
    return (frames(robot, theta)[-1] @ robot.T_tool)[:3, 3]


def configurations(robot: Robot, count: int) -> np.ndarray:
    low, high = 0.8 * robot.limits.T
    return np.random.default_rng(2013).uniform(low, high, (count, robot.n))
