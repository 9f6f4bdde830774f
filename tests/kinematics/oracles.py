"""Kinematics said again in the most naive way: products of 4 x 4 matrices off the D-H table, differences, searches."""

import itertools

import numpy as np


def screw(axis, angle, shift):
    """Turn about and shift along x (0) or z (2)."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    T = np.eye(4)
    T[i, i] = T[j, j] = np.cos(angle)
    T[j, i], T[i, j] = np.sin(angle), -np.sin(angle)
    T[axis, 3] = shift
    return T


def joint_and_tool_frames(robot, theta):
    """Frames of the free joints before they move, then {T}: one D-H row after the other, blocked ones too."""
    T, frames, free = robot.T_base, [], iter(theta)
    for row in range(robot.rows):
        blocked = robot.blocked[row]
        q = robot.sign[row] * (next(free) if np.isnan(blocked) else blocked)
        turn, shift = robot.theta_offset[row], robot.d[row]
        turn, shift = (turn, shift + q) if robot.prismatic[row] else (turn + q, shift)
        link = screw(0, robot.alpha[row], robot.a[row])
        if robot.convention == "modified":
            T = T @ link
        if np.isnan(blocked):
            frames.append(T)
        T = T @ screw(2, turn, shift)
        if robot.convention == "standard":
            T = T @ link
    return frames, T @ robot.T_tool


def pose(robot, theta):
    return joint_and_tool_frames(robot, theta)[1]


def numeric_jacobian(robot, theta, h=1e-6):
    J = np.empty((6, robot.n))
    R = pose(robot, theta)[:3, :3]
    for i in range(robot.n):
        step = h * np.eye(robot.n)[i]
        one, two = pose(robot, theta - step), pose(robot, theta + step)
        W = (two[:3, :3] - one[:3, :3]) @ R.T / (2 * h)
        J[:, i] = [*(two[:3, 3] - one[:3, 3]) / (2 * h), W[2, 1], W[0, 2], W[1, 0]]
    return J


def turns_within(angle, low, high):
    """Every whole turn of an angle that is within the limits."""
    return [angle + 2 * np.pi * k for k in range(-4, 5) if low <= angle + 2 * np.pi * k <= high]


def every_choice(robot, solutions):
    """(branch, configuration) of all solutions (8, n), with all their turns, within the limits."""
    for branch, theta in enumerate(solutions):
        yield from (
            (branch, np.array(turned))
            for turned in itertools.product(
                *(turns_within(angle, low, high) for angle, (low, high) in zip(theta, robot.limits, strict=True))
            )
        )
