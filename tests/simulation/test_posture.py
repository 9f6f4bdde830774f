"""What a run says of an arm with an axis to spare."""

from __future__ import annotations

import numpy as np
from random_arms import seven

import robomill as rm
from robomill.compliance.posture import over_posture
from robomill.simulation.posture import posture_notes


def test_a_run_says_that_one_posture_of_many_was_taken():
    robot, F = seven(), np.array([20.0, 100.0, -30.0])
    T_MT = rm.pose_from_world([0.45, 0.1, 0.25, 0, 0])
    (note,) = posture_notes(robot, T_MT, F)
    size = np.linalg.norm(over_posture(robot, T_MT) @ F, axis=1) * 1e3
    assert f"{size.min():.3f} to {size.max():.3f} mm" in note.message
    assert "7 axes" in note.message
    assert posture_notes(rm.load_robot("kuka_kr500"), T_MT, F) == ()
    assert posture_notes(robot, T_MT, np.array([np.nan, 0, 0])) == ()
    assert posture_notes(robot, rm.pose_from_world([9.0, 0, 0, 0, 0]), F) == ()
