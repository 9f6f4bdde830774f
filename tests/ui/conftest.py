"""What the panels of a pose show."""

from __future__ import annotations

import pytest

import robomill as rm
from robomill.compliance.at_pose import PoseReport
from robomill.ui.posed.point import in_hand


@pytest.fixture(scope="session")
def found() -> PoseReport:
    """The paper's arm at a point of its box."""
    return in_hand(rm.load_robot("slavkovic_5r"), (0.2, -1.2, -0.1), 0.0, 0.0).pose
