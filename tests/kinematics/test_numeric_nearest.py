"""``near`` of arms with an offset wrist: no known solution of the pose, on any branch or turn, is nearer.

The arm is the simulator's of ``cables.py``; solutions are known because poses are made from them, and by Newton's
method on the simulator's frames from many starts.
"""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from tests.identification.cables import as_robot, ur_like

ARM = ur_like()
ARM.limits[:] = np.radians([-360.0, 360.0])
ROBOT = as_robot(ARM, "ur_like")


def tool(q):
    return ARM.frames(q)[-1] @ ARM.T_FT


def gap(T, goal):
    R = goal[:3, :3] @ T[:3, :3].T
    return np.concatenate([goal[:3, 3] - T[:3, 3], [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]])


def newton(goal, q):
    """A solution near q by numeric derivatives, None where there is none."""
    for _ in range(25):
        e = gap(tool(q), goal)
        if np.abs(e).max() < 1e-9:
            return q if np.trace(goal[:3, :3] @ tool(q)[:3, :3].T) > 0 else None
        slopes = np.array([(gap(tool(q + 1e-6 * u), goal) - e) / 1e-6 for u in np.eye(6)]).T
        step = np.linalg.lstsq(slopes, -e, rcond=1e-4)[0]
        q = q + step * min(1.0, 0.5 / np.abs(step).max())
    return None


def way(q, near):
    """The least joint motion to q, over whole turns within the limits."""
    turned = q[:, None] + 2 * np.pi * np.arange(-3, 4)
    inside = np.abs(turned) <= np.radians(360.0) + 1e-9
    return float(np.linalg.norm(np.where(inside, np.abs(turned - near[:, None]), np.inf).min(axis=1)))


@pytest.mark.parametrize("seed", range(6))
def test_no_known_solution_is_nearer(seed):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, 6)
    near = np.clip(q + rng.uniform(-2.0, 2.0, 6) + 2 * np.pi * rng.integers(-1, 2, 6), *np.radians([-360.0, 360.0]))
    starts = [q, near, *rng.uniform(-np.pi, np.pi, (6, 6))]
    known = [found for start in starts if (found := newton(tool(q), start)) is not None]
    told = rm.inverse_kinematics(ROBOT, tool(q), near=near, spin="fixed")
    assert told.reached
    assert np.linalg.norm(told.theta - near) <= min(way(each, near) for each in known) + 1e-6
