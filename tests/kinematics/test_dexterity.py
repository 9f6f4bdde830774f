"""Determinant, manipulability, condition, limits: against closed forms and each other."""

import numpy as np
import pytest

import robomill as rm
from robomill.kinematics import dexterity
from robomill.kinematics.transforms import axis_from_tilt, invert, tilt_from_axis


def test_planar_2r_determinant_is_l1_l2_sin_theta_2():
    robot = rm.load_robot("planar_2r")
    theta = np.random.default_rng(0).uniform(-2, 2, (50, 2))
    np.testing.assert_allclose(dexterity.determinant(robot, theta), 0.5 * 0.4 * np.sin(theta[:, 1]), atol=1e-15)
    assert dexterity.square_rows(robot) == ("v_x", "v_y")
    assert dexterity.square_rows(rm.load_robot("planar_3r")) == ("v_x", "v_y", "omega_z")


@pytest.mark.parametrize("size", [0.01, 1.0, 30.0])
def test_near_a_singular_configuration_by_the_arms_own_measure(size):
    robot = rm.load_robot("planar_2r")
    robot = robot.replace(a=size * robot.a, limits=np.tile([-3.0, 3.0], (2, 1)))  # |sin theta_2| comes up to 1
    theta = np.column_stack([np.zeros(9), [-3.0, -2.0, -0.03, -0.005, 0.0, 0.015, 0.05, 1.0, 3.0]])
    near = dexterity.near_singular(robot, dexterity.determinant(robot, theta))
    assert near.tolist() == (np.abs(np.sin(theta[:, 1])) < 0.02).tolist()
    assert not dexterity.near_singular(robot, np.nan)
    assert dexterity.largest_determinant(robot) == pytest.approx(0.2 * size**2, rel=1e-3)


@pytest.mark.parametrize(
    ("bends", "met"),
    [((0.5, 1.0, 2.5), "none"), ((-0.5, -1.0), "none"), ((0.01, 1.0), "near"), ((-1.0, 2.0), "passed")],
)
def test_an_arm_that_bends_to_both_sides_passes_its_stretched_configuration(bends, met):
    robot = rm.load_robot("planar_2r")
    theta = np.column_stack([np.linspace(-1.0, 1.0, len(bends)), bends])
    assert dexterity.singularity_among(robot, dexterity.determinant(robot, theta)) == met


def test_five_axis_rows_are_those_of_the_paper_at_a_vertical_tool():
    robot = rm.load_robot("slavkovic_5r")
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0.2, -1.3, 0.0, 0, 0])).theta
    np.testing.assert_allclose(rm.task_jacobian(robot, theta), rm.geometric_jacobian(robot, theta)[:5], atol=1e-14)


@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500", "planar_3r"])
def test_measures_are_those_of_the_square_jacobian(name):
    robot = rm.load_robot(name)
    theta = np.random.default_rng(1).uniform(robot.limits[:, 0], robot.limits[:, 1], (4, 25, robot.n))
    J = rm.geometric_jacobian(robot, theta)
    if robot.n == 5:
        task = np.empty((4, 25, 5, 5))
        for at in np.ndindex(4, 25):
            R = rm.tool_pose(robot, theta[at])[:3, :3]
            k = R[:, 2]
            A, B = np.arctan2(-k[1], k[2]), np.arcsin(k[0])
            x = np.array([np.cos(B), np.sin(A) * np.sin(B), -np.cos(A) * np.sin(B)])
            task[at] = np.vstack([J[at][:3], x @ J[at][3:], np.cross(k, x) @ J[at][3:]])
    else:
        task = J if robot.n == 6 else J[..., [0, 1, 5], :]
    np.testing.assert_allclose(dexterity.determinant(robot, theta), np.linalg.det(task), atol=1e-12)
    gram = task @ np.swapaxes(task, -1, -2)
    # A root of a determinant of squares: half the digits.
    np.testing.assert_allclose(dexterity.manipulability(robot, theta) ** 2, np.linalg.det(gram), atol=1e-11)


def test_six_axes_are_asked_for_all_six_rows_even_where_they_move_in_a_plane_only():
    zero, limits = np.zeros(6), np.tile([-2.0, 2.0], (6, 1))
    flat = rm.Robot("flat", "standard", zero, np.full(6, 0.2), zero, zero, limits, np.full(6, 1e-7))
    assert dexterity.square_rows(flat) == dexterity.ROWS
    assert dexterity.determinant_unit(flat) == "m3"
    assert dexterity.determinant(flat, np.full(6, 0.3)) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("kinds", ["rr", "rp", "rrp", "rrrp", "rrprr", "rrrrrr"])
def test_the_unit_of_the_determinant_is_how_it_grows_with_the_arm(kinds):
    """Twice the arm (its slides twice as far out): det(J) is 2^p times itself, p the power of m in its unit."""
    n = len(kinds)
    rng = np.random.default_rng(3)
    slides = np.array([kind == "p" for kind in kinds])
    alpha = np.zeros(n) if n < 4 else rng.uniform(-1.5, 1.5, n)
    alpha[0] = np.pi / 2 if kinds == "rp" else alpha[0]  # a polar arm: the slide goes outwards
    a, d, limits, zero = rng.uniform(0.2, 1, n), np.zeros(n), np.tile([-2.0, 2.0], (n, 1)), np.zeros(n)
    soft = np.full(n, 1e-7)
    one, two = (rm.Robot("r", "standard", alpha, s * a, d, zero, limits, soft, prismatic=slides) for s in (1, 2))
    theta = rng.uniform(0.3, 0.8, n)
    small = dexterity.determinant(one, theta)
    large = dexterity.determinant(two, np.where(slides, 2 * theta, theta))
    assert abs(small) > 1e-6
    power = {"1": 0, "m": 1, "m2": 2, "m3": 3}[dexterity.determinant_unit(one)]
    assert large / small == pytest.approx(2.0**power)
    assert dexterity.has_determinant(one)


def test_seven_axes_have_no_determinant():
    zero, limits = np.zeros(7), np.tile([-2.0, 2.0], (7, 1))
    arm = rm.Robot("seven", "standard", np.full(7, 1.0), np.full(7, 0.2), zero, zero, limits, np.full(7, 1e-7))
    assert not dexterity.has_determinant(arm)


def test_singular_configurations_show():
    straight = [0.3, 0.0]
    robot = rm.load_robot("planar_2r")
    assert dexterity.determinant(robot, straight) == pytest.approx(0, abs=1e-15)


def test_limit_distance():
    robot = rm.load_robot("planar_2r")
    middle = robot.limits.mean(axis=1)
    assert dexterity.limit_distance(robot, middle) == 1.0
    assert dexterity.limit_distance(robot, robot.limits[:, 1]) == pytest.approx(0, abs=1e-15)
    assert dexterity.limit_distance(robot, robot.limits[:, 1] + 0.1) < 0


def test_world_coordinates_round_trip():
    rng = np.random.default_rng(2)
    x_M = rng.uniform([-1, -1, -1, -3, -1.5], [1, 1, 1, 3, 1.5], (100, 5))
    T_MT = rm.pose_from_world(x_M)
    np.testing.assert_allclose(rm.world_from_pose(T_MT), x_M, atol=1e-12)
    np.testing.assert_allclose(T_MT[:, :3, 2], axis_from_tilt(x_M[:, 3], x_M[:, 4]), atol=1e-15)
    np.testing.assert_allclose(T_MT @ invert(T_MT), np.broadcast_to(np.eye(4), (100, 4, 4)), atol=1e-14)
    # Along X_M the tilt A is undetermined: 0 is given.
    np.testing.assert_allclose(tilt_from_axis([1.0, 0.0, 0.0]), [0.0, np.pi / 2])


def test_what_is_not_reached_is_nan_in_every_law():
    robot = rm.load_robot("slavkovic_5r")
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([[0, -1.3, 0, 0, 0], [0, -9, 0, 0, 0]])).theta
    laws = (
        rm.cartesian_compliance,
        dexterity.determinant,
        dexterity.manipulability,
        dexterity.limit_distance,
    )
    for law in laws:
        values = law(robot, theta)
        assert np.isfinite(values[0]).all(), law.__name__
        assert np.isnan(values[1]).all(), law.__name__
