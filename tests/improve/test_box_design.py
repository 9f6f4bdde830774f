"""Stiffer joints for a box of the workspace, against brute force: every point solved on its own."""

from itertools import product

import numpy as np
import pytest

import robomill as rm
from robomill.errors import SetupError

F = np.array([60.0, 100.0, -30.0])
LOWER, UPPER = np.array([-0.3, -1.5, -0.1]), np.array([0.3, -1.1, 0.1])


def deviation(robot: rm.Robot, step: float) -> np.ndarray:
    """|C F| (m,) m at every reached point, one after the other, by the compliance at that pose."""
    axes = [np.arange(round((b - a) / step) + 1) * step + a for a, b in zip(LOWER, UPPER, strict=True)]
    found = []
    for x in product(*axes):
        ik = rm.inverse_kinematics(robot, rm.pose_from_world([*x, 0.0, 0.0]))
        if ik.reached:
            found.append(np.linalg.norm(rm.cartesian_compliance(robot, ik.theta) @ F))
    return np.array(found)


@pytest.fixture(scope="module")
def setup() -> rm.SimulationSetup:
    return rm.load_setup("paper_flute")


def test_every_reached_point_keeps_the_tolerance_and_the_worst_one_only_just(setup: rm.SimulationSetup) -> None:
    grid = rm.box_grid(LOWER, UPPER, 0.1)
    found = rm.design_box(setup, grid, F, tolerance_mm=0.2)
    np.testing.assert_allclose(found.before, deviation(setup.robot, 0.1), rtol=1e-9)
    there = deviation(setup.robot.replace(C_theta=found.C_theta), 0.1)
    np.testing.assert_allclose(found.after, there, rtol=1e-9)
    assert found.feasible
    assert found.before.max() > 0.3e-3
    np.testing.assert_allclose(there.max(), 0.2e-3, rtol=1e-6)
    assert found.residual < 1e-6


def test_a_spindle_that_gives_way_adds_what_no_joint_can_take_back(setup: rm.SimulationSetup) -> None:
    """Across the tool, which is upright: so much times the force in the plan."""
    grid, give = rm.box_grid(LOWER, UPPER, 0.2), 0.5e-6
    sprung = setup.replace(springs=(rm.SpindleSpring(lateral_um_N=give * 1e6),))
    found = rm.design_box(sprung, grid, F, tolerance_mm=0.25)
    for robot, sizes in ((setup.robot, found.before), (setup.robot.replace(C_theta=found.C_theta), found.after)):
        expected = []
        for point in found.points:
            theta = rm.inverse_kinematics(robot, pose(point)).theta
            expected.append(np.linalg.norm(rm.cartesian_compliance(robot, theta) @ F + give * F * [1.0, 1.0, 0.0]))
        np.testing.assert_allclose(sizes, expected, rtol=1e-9)
    assert found.worst == int(np.argmax(expected))
    assert max(expected) == pytest.approx(0.25e-3, rel=1e-6)
    table = found.columns()
    np.testing.assert_allclose(np.column_stack([table[f"{axis}_mm"] for axis in "xyz"]), found.points * 1e3)
    np.testing.assert_allclose(table["before_mm"], found.before * 1e3)
    np.testing.assert_allclose(table["after_mm"], found.after * 1e3)


def test_a_thousandth_of_the_force_within_a_thousandth_of_the_tolerance_asks_for_the_same(
    setup: rm.SimulationSetup,
) -> None:
    grid = rm.box_grid(LOWER, UPPER, 0.2)
    large, small = (rm.design_box(setup, grid, s * F, tolerance=s * 0.2e-3) for s in (1.0, 2e-3))
    np.testing.assert_allclose(small.stiffness_ratio, large.stiffness_ratio, rtol=1e-6)


def test_no_cheaper_stiffening_is_found_by_trying_them_all(setup: rm.SimulationSetup) -> None:
    """Joints 3 and 5 alone may be changed: a fine net over both."""
    grid = rm.box_grid(LOWER, UPPER, 0.2)
    bounds = np.ones((5, 2))
    bounds[[2, 4], 1] = 6.0
    found = rm.design_box(setup, grid, [0.0, 100.0, 0.0], tolerance_mm=0.22, bounds=bounds)
    assert found.feasible
    ratios = np.exp(np.linspace(0.0, np.log(6.0), 181))
    stands = [rm.inverse_kinematics(setup.robot, pose(x)).theta for x in found.points]
    J = [rm.geometric_jacobian(setup.robot, theta)[:3] for theta in stands]
    least = np.inf
    for r3, r5 in product(ratios, ratios):
        cost = np.log2(r3) + np.log2(r5)
        if cost < least:
            C = setup.robot.C_theta / np.array([1.0, 1.0, r3, 1.0, r5])
            if max(np.linalg.norm((each * C) @ each.T @ [0.0, 100.0, 0.0]) for each in J) <= 0.22e-3:
                least = cost
    assert found.cost <= least + 1e-9
    assert least - found.cost < 0.03  # the net's own width


def pose(x: np.ndarray) -> np.ndarray:
    return rm.pose_from_world([*x, 0.0, 0.0])


def test_what_cannot_be_met_names_the_place_and_the_joint(setup: rm.SimulationSetup) -> None:
    bounds = np.tile([1.0, 50.0], (5, 1))
    bounds[2] = 1.0
    found = rm.design_box(setup, rm.box_grid(LOWER, UPPER, 0.2), F, tolerance_mm=0.05, bounds=bounds)
    assert not found.feasible
    assert "by joint 3" in found.reason
    assert found.after.max() > 0.05e-3
    lone = rm.design_box(setup, rm.box_grid(LOWER, UPPER, 0.2), F, tolerance_mm=1.0)
    assert lone.cost == 0.0
    assert "as they are" in lone.sentence


@pytest.mark.parametrize(
    ("lower", "force", "bounds", "words"),
    [
        ([5.0, 5.0, 5.0], F, (1.0, 4.0), "none of its 1 point is reached"),
        ([0.0, -1.3, 0.0], [0.0, 0.0, 0.0], (1.0, 4.0), "Force: found 0 N"),
        ([0.0, -1.3, 0.0], F, (4.0, 1.0), "the smaller one first"),
    ],
)
def test_what_cannot_be_asked_is_refused(
    setup: rm.SimulationSetup, lower: list[float], force: list[float], bounds: tuple[float, float], words: str
) -> None:
    with pytest.raises(SetupError, match=words):
        rm.design_box(setup, rm.box_grid(lower, lower, 0.1), force, bounds=bounds)
