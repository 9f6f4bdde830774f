"""Numbers taken along other axes than {M}'s, and robots whose lengths stand in two units, are suspected aloud."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.identification.other_axes import axes_suspicions
from tests.identification.cables import Arm, Rig, as_csv, make

ARM, ROBOT = Arm.of("kuka_kr270"), rm.load_robot("kuka_kr270")
TIP = ARM.T_FT[:3, 3]
RIG = Rig(load_point=TIP, gauge_point=TIP, pulleys=((3.4, -2.2, 1.6), (-1.0, 3.0, 0.2), (2.0, 1.0, 4.0)))
MADE = make(ARM, RIG, 30, seed=2)
TOOL = np.array([ARM.frames(q)[-1][:3, :3] @ ARM.T_FT[:3, :3] for q in MADE.q])
TURN = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1.0]])


def said(robot, F, moved):
    tests = rm.LoadTests(F, moved, theta=MADE.q)
    return {f.code: f.message for f in rm.identify(robot, tests).findings}


def in_tool(vectors):
    return np.array([R.T @ v for R, v in zip(TOOL, vectors, strict=True)])


@pytest.mark.parametrize(
    ("F", "moved", "words"),
    [
        (in_tool(MADE.F), in_tool(MADE.moved), "frame of the tool for forces and displacements"),
        (in_tool(MADE.F), MADE.moved, "frame of the tool for forces alone"),
        (MADE.F, in_tool(MADE.moved), "frame of the tool for displacements alone"),
        (MADE.F @ TURN.T, MADE.moved @ TURN.T, "as -y, x and z for forces and displacements"),
        (MADE.F, MADE.moved[:, [1, 0, 2]], "as y, x and z for displacements"),
        (MADE.F[:, [0, 2, 1]], MADE.moved, "as x, z and y for forces"),
    ],
)
def test_other_axes_are_suspected(F, moved, words):
    assert words in said(ROBOT, F, moved)["axes"]


@pytest.mark.parametrize(
    ("axes", "words"),
    [
        (lambda F, d: (in_tool(F), in_tool(d)), "frame of the tool for forces and displacements"),
        (lambda F, d: (F @ TURN.T, d @ TURN.T), "as -y, x and z for forces and displacements"),
        (lambda F, d: (F, d[:, [1, 0, 2]]), "as y, x and z for displacements"),
        (lambda F, d: (F, d), ""),
    ],
)
def test_strong_bending_hides_no_other_axes(axes, words):
    """Of the joints' springs alone right axes left half of the displacements over, too, and nothing was said."""
    bent = make(ARM, replace(RIG, bending={2: (2e-6, 1e-6), 3: (1e-6, 2e-6)}, noise=20e-6), 30, seed=2)
    F, moved = axes(bent.F, bent.moved)
    found = axes_suspicions(ROBOT, rm.LoadTests(F, moved, theta=bent.q))
    assert [words in each.message for each in found] == [True] * bool(words)


def test_what_is_right_or_noisy_is_not_suspected():
    assert "axes" not in said(ROBOT, MADE.F, MADE.moved)
    for seed in range(10):
        noisy = MADE.moved + 2e-4 * np.random.default_rng(seed).standard_normal(MADE.moved.shape)
        assert "axes" not in said(ROBOT, MADE.F, noisy)


def test_no_other_axes_are_sought_where_a_moment_is_stated():
    """Other axes would turn the moments as well, which no reading of the forces does."""
    moment = np.zeros((30, 3))
    moment[::2, 2] = 1e-3
    assert "axes" not in said(ROBOT, np.hstack([in_tool(MADE.F), moment]), in_tool(MADE.moved))


def test_no_other_axes_are_sought_where_cables_are_aimed() -> None:
    """A force that is calculated from its pulley has the axes that the pulley is told in."""
    pulley = np.where((np.arange(30) % 2 == 0)[:, None], [3.4, -2.2, 1.6], np.nan)
    free = rm.LoadTests(in_tool(MADE.F), in_tool(MADE.moved), theta=MADE.q)
    assert [f.code for f in axes_suspicions(ROBOT, free)] == ["axes"]
    assert axes_suspicions(ROBOT, replace(free, pulley=pulley)) == ()


@pytest.mark.parametrize("name", ["a", "d"])
def test_lengths_of_the_robot_in_metres_beside_millimetres_are_suspected(name):
    odd = ROBOT.replace(**{name: getattr(ROBOT, name) / 1000})
    assert f"Read as m under a header in mm, the robot's lengths {name}" in said(odd, MADE.F, MADE.moved)["length-unit"]
    assert "length-unit" not in said(ROBOT, MADE.F, MADE.moved)


def test_a_frame_said_of_joints_is_not_passed_over():
    text = "# frame: tool\n" + as_csv(ARM, MADE, TIP, TIP)
    found = {f.code: f for f in rm.read_load_tests(text, ROBOT).findings}
    assert found["frame-unused"].level == "suspicious"
    assert "axes of {M}" in found["frame-unused"].message


def test_pounds_under_newtons_and_a_gauge_that_was_not_read_are_suspected():
    assert "pound-force as N?" in said(ROBOT, MADE.F / 4.448, MADE.moved)["unit"]
    assert "unit" not in said(ROBOT, MADE.F, MADE.moved)
    assert said(ROBOT, MADE.F, MADE.moved * [1, 1, 0])["unread"].startswith("dz is zero in every test")


@pytest.mark.parametrize(("count", "suspected"), [(3, False), (4, True), (30, True)])
def test_so_few_tests_say_nothing_of_axes(count: int, suspected: bool) -> None:
    """Six compliances take up most of what three tests read; from four on other axes leave more than they can."""
    tests = rm.LoadTests(in_tool(MADE.F)[:count], in_tool(MADE.moved)[:count], theta=MADE.q[:count])
    assert bool(axes_suspicions(ROBOT, tests)) == suspected
