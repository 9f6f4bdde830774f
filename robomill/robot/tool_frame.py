"""The direction of a tool on the last frame of an arm: along one of its axes, or turned otherwise."""

from __future__ import annotations

import numpy as np

from robomill.provenance import Provenance
from robomill.robot.model import Robot

TOOL_AXES = ("-z", "+z", "-y", "+y", "-x", "+x")
ALONG = 1e-9  # what the share of an axis lacks of 1 where the tool lies along it


def tool_axis(robot: Robot) -> str:
    """Along which axis of the last frame z_T lies, one of ``TOOL_AXES``; "" where along none."""
    k = robot.T_tool[:3, 2]
    i = int(np.argmax(np.abs(k)))
    return f"{'+' if k[i] > 0 else '-'}{'xyz'[i]}" if abs(abs(k[i]) - 1.0) < ALONG else ""


def with_tool_axis(robot: Robot, axis: str, said: Provenance) -> Robot:
    """``robot`` with z_T along one of ``TOOL_AXES``, the tip where it was; x_T along the axis after it. ``said`` is who
    says so."""
    if axis == tool_axis(robot) or axis not in TOOL_AXES:
        return robot
    i, R = "xyz".index(axis[1]), np.zeros((3, 3))
    R[i, 2], R[(i + 1) % 3, 0] = 1.0 if axis[0] == "+" else -1.0, 1.0
    R[:, 1] = np.cross(R[:, 2], R[:, 0])
    T_tool = np.array(robot.T_tool)
    T_tool[:3, :3] = R
    return robot.replace(T_tool=T_tool, provenance={**robot.provenance, "tool": said})
