"""What is said of a line: where its joints run, where the arm passes a singular configuration."""

import numpy as np

import robomill as rm
from robomill.workspace.lines import border_and_middle_lines, line_deviation


def test_a_line_through_a_singular_wrist_is_smooth_and_says_so():
    line = line_deviation(rm.load_robot("slavkovic_5r"), [-0.656, -0.339, -0.974], [-0.840, -1.094, -0.888], name="it")
    (note,) = line.notes()
    assert note.startswith("it, after 4")  # at 491 of 782 mm, to a step of 13 mm
    assert "singular" in note


def test_the_papers_lines_say_nothing():
    assert not [note for line in border_and_middle_lines(rm.load_robot("slavkovic_5r")) for note in line.notes()]


def test_the_force_of_the_lines_is_that_of_the_papers_slot() -> None:
    """Fig. 8 and Sec. 5.2 say 100 N each: the lines unasked are those of a hundred times the lines of 1 N."""
    robot = rm.load_robot("slavkovic_5r")
    unasked, one = (lines[4] for lines in (border_and_middle_lines(robot), border_and_middle_lines(robot, force=1.0)))
    np.testing.assert_allclose(unasked.delta_joint, 100.0 * one.delta_joint, rtol=1e-12, atol=0.0)


def test_the_force_of_a_line_pushes_to_its_left_and_moves_the_tool_by_what_it_gives() -> None:
    robot, turn = rm.load_robot("slavkovic_5r"), 0.6
    start = np.array([-0.1, -1.3, 0.0])
    line = line_deviation(robot, start, start + 0.1 * np.array([np.cos(turn), np.sin(turn), 0.0]), force=80.0, points=4)
    pushed = 80.0 * np.array([-np.sin(turn), np.cos(turn), 0.0])
    np.testing.assert_allclose(line.F, pushed, atol=1e-12)
    C = rm.cartesian_compliance(robot, line.ik.theta)
    np.testing.assert_allclose(line.delta_joint.sum(axis=-2), C @ pushed, rtol=1e-9)
