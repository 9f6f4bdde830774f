"""The exercises' numbers another way: the Jacobian by differences of the pose, the rest from it in plain NumPy."""

from __future__ import annotations

import re

import numpy as np

import robomill as rm
from robomill.learn import Exercise

STEP = 1e-6
SEVEN = rm.Robot.from_dh(
    d_mm=[340, 0, 400, 0, 400, 0, 126],
    alpha_deg=[-90, 90, 90, -90, -90, 90, 0],
    a_mm=[0] * 7,
    limits_deg=(-170, 170),
    k_theta_kNm_per_rad=[90, 80, 60, 50, 30, 20, 10],
)
"""An arm of seven axes, whose stiffnesses differ."""


def numbers(text: str) -> list[float]:
    """The numbers in a text, however its thousands are parted."""
    text = re.sub(r"(?<=\d)[,\s](?=\d{3}(?!\d))", "", text)
    return [float(each.replace("−", "-")) for each in re.findall(r"[−-]?\d+(?:\.\d+)?", text)]


def theta_of(given: Exercise) -> np.ndarray:
    return np.deg2rad(numbers(given.text[given.text.index("(") : given.text.index("°")]))


def axis_of(text: str, before: str) -> int:
    found = re.search(rf"{before} \+?([XYZ])", text)
    assert found, text
    return "XYZ".index(found[1])


def jacobian(robot: rm.Robot, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(J_v, J_omega), each (3, n), by central differences of the pose."""
    v, omega = [], []
    for i in range(robot.n):
        there, back = (rm.tool_pose(robot, theta + sign * STEP * np.eye(robot.n)[i]) for sign in (1, -1))
        v.append((there[:3, 3] - back[:3, 3]) / (2 * STEP))
        turned = (there[:3, :3] - back[:3, :3]) / (2 * STEP) @ rm.tool_pose(robot, theta)[:3, :3].T
        omega.append([turned[2, 1], turned[0, 2], turned[1, 0]])
    return np.array(v).T, np.array(omega).T


def compliance(robot: rm.Robot, theta: np.ndarray, without: int | None = None) -> np.ndarray:
    J = jacobian(robot, theta)[0]
    C_theta = np.array(robot.C_theta)
    if without is not None:
        C_theta[without] = 0.0
    return np.asarray(J @ np.diag(C_theta) @ J.T)
