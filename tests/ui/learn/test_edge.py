"""The ray to the edge of the workspace, by the triangle of the stretched arm."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.compliance.at_pose import PoseReport
from robomill.ui.learn.edge import _ray


def test_the_ray_ends_at_a_singularity(found: PoseReport) -> None:
    way = _ray.__wrapped__("key", found.robot, np.array([0.0, -1.3, 0.0]))
    assert way.radius[way.start] == pytest.approx(1.3)
    assert (np.diff(way.radius) > 0).all()
    assert way.det[-1] < 1e-3 * way.det.max()
    stretched = np.sqrt((1.22 + 1.1) ** 2 - 0.3**2)  # the arm straight, the tool hanging a_5 below the wrist
    assert way.radius[-1] == pytest.approx(stretched, abs=1e-6)
