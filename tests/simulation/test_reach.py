"""What is asked before a cut: which points of a plane the arm reaches."""

from __future__ import annotations

import numpy as np

import robomill as rm
from robomill.kinematics.transforms import translation
from robomill.simulation.reach import plane_reach


def test_a_plane_is_reached_where_each_of_its_points_is() -> None:
    robot = rm.load_robot("slavkovic_5r")
    T_MW = translation([0.1, -1.2, -0.2])
    x, y = np.linspace(-2.0, 2.0, 7), np.linspace(-1.5, 1.5, 5)
    found = plane_reach(robot, T_MW, x, y, 0.05)
    alone = [[rm.inverse_kinematics(robot, T_MW @ translation([u, v, 0.05])).reached for u in x] for v in y]
    np.testing.assert_array_equal(found, alone)
    assert found.any()
    assert not found.all()
