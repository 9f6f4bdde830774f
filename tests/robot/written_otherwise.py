"""The same arm written otherwise: its table in the other convention, an axis held."""

from __future__ import annotations

import numpy as np

from robomill.robot.dh import screw_x


def modified_to_standard(
    alpha: np.ndarray, a: np.ndarray, T_base: np.ndarray, T_tool: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(alpha, a, T_base, T_tool) of the standard table with the same poses; theta and d keep their rows.

    A modified row i carries the link *before* joint i, a standard row the link after it: the first link moves into
    the base frame, and the last row becomes (0, 0).
    """
    return np.append(alpha[1:], 0.0), np.append(a[1:], 0.0), T_base @ screw_x(alpha[0], a[0]), T_tool


def standard_to_modified(
    alpha: np.ndarray, a: np.ndarray, T_base: np.ndarray, T_tool: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(alpha, a, T_base, T_tool) of the modified table with the same poses: the last link moves into the tool frame."""
    return np.append(0.0, alpha[:-1]), np.append(0.0, a[:-1]), T_base, screw_x(alpha[-1], a[-1]) @ T_tool


def with_convention(robot, convention):
    """The same poses in the other D-H convention: link constants move into the base or tool frame."""
    if convention == robot.convention:
        return robot
    convert = modified_to_standard if convention == "standard" else standard_to_modified
    alpha, a, T_base, T_tool = convert(robot.alpha, robot.a, robot.T_base, robot.T_tool)
    return robot.replace(convention=convention, alpha=alpha, a=a, T_base=T_base, T_tool=T_tool)


def with_blocked(robot, row, coordinate):
    """Axis ``row`` (1-based) held at ``coordinate``, or freed with None."""
    blocked = np.array(robot.blocked)
    blocked[row - 1] = np.nan if coordinate is None else coordinate
    return robot.replace(blocked=blocked)
