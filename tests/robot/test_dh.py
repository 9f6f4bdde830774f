"""D-H tables as chains: the product of a chain is the product of its table's rows, in both conventions."""

import numpy as np
import pytest

import robomill as rm
from robomill.robot.dh import exact_cos_sin, screw_x, screw_z
from tests.kinematics.oracles import joint_and_tool_frames, pose, screw
from tests.robot.written_otherwise import modified_to_standard, standard_to_modified, with_convention


def product(chain, theta):
    """T_0 times what each joint and the link after it do."""
    T = chain.T_0
    for i, coordinate in enumerate(theta):
        q = chain.sign[i] * coordinate + chain.offset[i]
        T = T @ (screw(2, 0.0, q) if chain.prismatic[i] else screw(2, q, 0.0)) @ chain.E[i]
    return T


def arm(rng, rows, convention, blocked):
    base, tool = screw(0, 0.3, 0.2) @ screw(2, 0.7, 0.1), screw(2, -0.4, 0.3) @ screw(0, 0.9, -0.2)
    return rm.Robot(
        name="any",
        convention=convention,
        alpha=rng.uniform(-2, 2, rows),
        a=rng.uniform(-1, 1, rows),
        d=rng.uniform(-1, 1, rows),
        theta_offset=rng.uniform(-2, 2, rows),
        sign=rng.choice([-1.0, 1.0], rows),
        prismatic=np.arange(rows) % 3 == 1,
        limits_all=np.tile([-3.0, 3.0], (rows, 1)),
        C_theta_all=np.full(rows, 1e-7),
        T_base=base,
        T_tool=tool,
        blocked=blocked,
    )


@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize("held", [(), (0,), (1,), (2, 3), (0, 1), (5,), (4, 5), (0, 2, 4)])
def test_a_chain_is_its_table(convention, held):
    rng = np.random.default_rng(len(held))
    blocked = np.full(6, np.nan)
    blocked[list(held)] = 0.4
    robot = arm(rng, 6, convention, blocked)
    chain = robot.chain
    assert chain.n == robot.n == 6 - len(held)
    for theta in rng.uniform(-2, 2, (5, robot.n)):
        frames, tool = joint_and_tool_frames(robot, theta)
        np.testing.assert_allclose(product(chain, theta), tool, atol=1e-13)
        # One joint after the other: what stands before joint k does not depend on the joints after it.
        moved = theta.copy()
        moved[-1] += 0.5
        np.testing.assert_allclose(product(chain, moved), pose(robot, moved), atol=1e-13)
    assert not chain.T_0.flags.writeable
    assert not chain.E.flags.writeable


@pytest.mark.parametrize("rows", [2, 3, 7])
def test_conversions_keep_the_pose(rows):
    rng = np.random.default_rng(rows)
    robot = arm(rng, rows, "modified", np.full(rows, np.nan))
    for convention in ("standard", "modified"):
        other = with_convention(with_convention(robot, convention), "standard")
        theta = rng.uniform(-1, 1, rows)
        np.testing.assert_allclose(pose(other, theta), pose(robot, theta), atol=1e-13)
    alpha, a, base, tool = modified_to_standard(robot.alpha, robot.a, robot.T_base, robot.T_tool)
    assert (alpha[-1], a[-1]) == (0.0, 0.0)
    alpha, a, base, tool = standard_to_modified(alpha, a, base, tool)
    assert (alpha[0], a[0]) == (0.0, 0.0)
    np.testing.assert_array_equal(alpha[1:], robot.alpha[1:])


@pytest.mark.parametrize("rows", [2, 5, 6])
def test_a_standard_table_with_any_last_link_keeps_its_poses_as_a_modified_one(rows):
    rng = np.random.default_rng(20 + rows)
    robot = arm(rng, rows, "standard", np.full(rows, np.nan))
    alpha, a, base, tool = standard_to_modified(robot.alpha, robot.a, robot.T_base, robot.T_tool)
    other = robot.replace(convention="modified", alpha=alpha, a=a, T_base=base, T_tool=tool)
    for theta in rng.uniform(-2, 2, (5, rows)):
        np.testing.assert_allclose(pose(other, theta), pose(robot, theta), atol=1e-13)


def test_right_angles_are_exact():
    for k in range(-9, 10):
        c, s = exact_cos_sin(k * np.pi / 2)
        assert (c, s) == ([1, 0, -1, 0][k % 4], [0, 1, 0, -1][k % 4])
    for angle in (0.3, -2.0, 1e-9, np.pi / 2 + 1e-9, np.pi / 4, 4.0):
        assert exact_cos_sin(angle) == (np.cos(angle), np.sin(angle))


def test_screws():
    for angle, shift in ((0.3, 0.5), (-2.1, -0.4), (np.pi / 2, 0.0)):
        np.testing.assert_allclose(screw_x(angle, shift), screw(0, angle, shift), atol=1e-16)
        np.testing.assert_allclose(screw_z(angle, shift), screw(2, angle, shift), atol=1e-16)


def test_multiples_of_a_right_angle_are_exact_however_often_it_goes_round():
    """As degrees give them: their rounding grows with the number of turns."""
    pattern = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
    for k in (*range(-40, 41), 1001, -2002, 30_003):
        for angle in (np.radians(90.0 * k), k * (np.pi / 2), np.nextafter(k * np.pi / 2, 0.0)):
            assert exact_cos_sin(float(angle)) == pattern[k % 4]
