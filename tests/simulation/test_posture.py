"""What a run says of an arm with an axis to spare, and of a tool frame that is turned round."""

from __future__ import annotations

import numpy as np
import pytest
from random_arms import seven

import robomill as rm
from robomill.compliance.posture import over_posture
from robomill.io.samples import samples_dir
from robomill.kinematics.transforms import translation
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


@pytest.mark.parametrize(("turn", "said"), [(0.0, False), (np.pi, True)])
def test_a_tool_frame_that_points_away_from_the_flange_is_named(turn, said):
    """KUKA's flange as robot descriptions have it, z out of the arm: with z_T to the spindle the cut is reached."""
    robot = rm.load_robot("kuka_kr500")
    about_x = np.diag([1.0, np.cos(turn), np.cos(turn), 1.0])
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(
        robot=robot.replace(T_tool=robot.T_tool @ about_x), T_MW=translation([1.9, 0.0, 0.9]), engagement=False
    )
    result = rm.simulate(setup)
    assert result.reached.any() != said
    assert ("tool-turned" in [each.code for each in result.notes]) == said
    far = rm.simulate(setup.replace(T_MW=translation([19.0, 0.0, 0.9])))
    assert "tool-turned" not in [each.code for each in far.notes]


def test_a_spin_at_which_nothing_is_reached_is_named_and_not_the_tool_frame():
    """The Fanuc's drill stands across its flange: of 24 spins, each tried by itself, some reach the cut and some do
    not, so its tool frame is right."""
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(
        robot=rm.load_robot("fanuc_r2000ic"), T_MW=translation([1.6, 0.1, 0.5]), engagement=False, step_mm=20.0
    )
    spins = np.radians(np.arange(0.0, 360.0, 15.0))
    reached = [bool(rm.simulate(setup.replace(spin=float(spin))).reached.all()) for spin in spins]
    assert 0 < sum(reached) < len(spins)
    result = rm.simulate(setup.replace(spin=float(spins[reached.index(False)])))
    codes = [each.code for each in result.notes]
    assert not result.reached.any()
    assert "other-spin" in codes
    assert "tool-turned" not in codes
    assert result.verdict.sentence.startswith("No point of the cut can be reached at this spin")
