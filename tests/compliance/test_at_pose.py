"""What holds at a pose: every number found another way, by products of matrices and numeric derivatives."""

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.at_pose import at_pose
from robomill.compliance.deflection import deflection
from robomill.errors import KinematicsError

NAMES = ("slavkovic_5r", "kuka_kr500", "planar_2r", "planar_3r")


def turned(axis, angle):
    """Rodrigues' rotation."""
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


@pytest.mark.parametrize("name", NAMES)
def test_numbers_by_numeric_derivatives(name):
    robot = rm.load_robot(name)
    theta = np.random.default_rng(3).uniform(0.2, 0.6, robot.n) * robot.limits[:, 1]
    here = at_pose(robot, theta)
    assert here.reached
    np.testing.assert_allclose(here.T_MT, rm.tool_pose(robot, theta), atol=1e-15)
    J, h = np.empty((6, robot.n)), 1e-6
    for i in range(robot.n):
        step = h * np.eye(robot.n)[i]
        one, two = rm.tool_pose(robot, theta - step), rm.tool_pose(robot, theta + step)
        W = (two[:3, :3] - one[:3, :3]) @ here.T_MT[:3, :3].T / (2 * h)
        J[:, i] = [*(two[:3, 3] - one[:3, 3]) / (2 * h), W[2, 1], W[0, 2], W[1, 0]]
    np.testing.assert_allclose(here.J, J, atol=1e-8)
    C_theta = np.diag(robot.C_theta)
    np.testing.assert_allclose(here.C_X, J @ C_theta @ J.T, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(here.C, (J @ C_theta @ J.T)[:3, :3], rtol=1e-6, atol=1e-12)
    # A force by hand: each joint turned by what its torque makes it give.
    F = np.array([30.0, -20.0, 50.0])
    np.testing.assert_allclose(here.delta(F), (J @ (robot.C_theta * (J[:3].T @ F)))[:3], rtol=1e-6, atol=1e-10)
    for i in range(robot.n):
        tip, axis = here.T_MT[:3, 3], here.frames[i][:3, 2]
        torque = J[:3, i] @ F
        angle = robot.chain.sign[i] * robot.C_theta[i] * torque
        moved = turned(axis, angle) @ (tip - here.frames[i][:3, 3]) + here.frames[i][:3, 3] - tip
        np.testing.assert_allclose(deflection(here.C_joint, F)[i], moved, rtol=2e-3, atol=1e-9)
    task = {5: J[:5], 6: J, 2: J[:2], 3: J[[0, 1, 5]]}[robot.n]
    if name == "slavkovic_5r":
        k = here.T_MT[:3, 2]
        B = np.arctan2(k[0], np.hypot(k[1], k[2]))
        A = np.arctan2(-k[1], k[2])
        across = turned([1, 0, 0], A) @ turned([0, 1, 0], B)[:, :2]
        task = np.vstack([J[:3], across.T @ J[3:]])
    assert here.det_J == pytest.approx(np.linalg.det(task), rel=1e-6, abs=1e-9)
    assert here.manipulability == pytest.approx(abs(np.linalg.det(task)), rel=1e-6, abs=1e-7)
    assert here.det_J_unit == {2: "m2", 3: "m2"}.get(robot.n, "m3")
    low, high = robot.limits.T
    room = [min(t - a, b - t) / ((b - a) / 2) for t, a, b in zip(theta, low, high, strict=True)]
    assert here.limit_distance == pytest.approx(min(room))


@pytest.mark.parametrize("name", NAMES)
def test_components_shares_and_axes(name):
    robot = rm.load_robot(name)
    theta = np.random.default_rng(4).uniform(0.2, 0.6, robot.n) * robot.limits[:, 1]
    here = at_pose(robot, theta)
    for a, b in ("xx", "yy", "zz", "xy", "xz", "yz", "zy"):
        unit_a, unit_b = np.eye(3)["xyz".index(a)], np.eye(3)["xyz".index(b)]
        # Push along b, look along a.
        assert here.component(a + b) == pytest.approx(
            float(deflection(here.C_joint, unit_b).sum(axis=0) @ unit_a), abs=1e-18
        )
        shares = deflection(here.C_joint, unit_b) @ unit_a
        np.testing.assert_allclose(here.shares(a + b), shares, atol=1e-18)
    values, axes = here.principal
    assert (np.diff(values) >= 0).all()
    for value, axis in zip(values, axes.T, strict=True):
        np.testing.assert_allclose(here.C @ axis, value * axis, atol=1e-16)
        assert np.linalg.norm(axis) == pytest.approx(1.0)
        assert max(axis, key=abs) > 0
    push = np.random.default_rng(0).normal(size=(500, 3))
    push /= np.linalg.norm(push, axis=1)[:, None]
    along = np.einsum("mi,ij,mj->m", push, here.C, push)
    assert values[0] - 1e-15 <= along.min()
    assert along.max() <= values[2] + 1e-15


def test_a_pose_that_is_not_reached_is_nan_throughout():
    robot = rm.load_robot("slavkovic_5r")
    here = at_pose(robot, rm.inverse_kinematics(robot, rm.pose_from_world([0, -9, 0, 0, 0])).theta)
    assert not here.reached
    for value in (here.frames, here.J, here.C_joint, here.C, here.C_X, here.det_J, here.manipulability):
        assert np.isnan(value).all()
    assert [value.shape for value in here.principal] == [(3,), (3, 3)]
    for value in (here.limit_distance, *here.principal, deflection(here.C_joint, [1, 0, 0])):
        assert np.isnan(value).all()


@pytest.mark.parametrize("theta", [[0.0] * 4, np.zeros((2, 5)), "text"])
def test_what_is_not_one_configuration_is_refused(theta):
    with pytest.raises(KinematicsError, match="theta of 'slavkovic_5r'"):
        at_pose(rm.load_robot("slavkovic_5r"), theta)


@pytest.mark.parametrize("name", ["x", "xw", "xyz", ""])
def test_unknown_components_are_refused(name):
    with pytest.raises(KinematicsError, match="two of x, y, z"):
        at_pose(rm.load_robot("planar_2r"), [0.1, 0.2]).component(name)


@pytest.mark.parametrize("unknown", [[0], [2], [0, 4], range(5)])
def test_one_joint_that_is_not_known_leaves_nothing_known(unknown):
    robot = rm.load_robot("slavkovic_5r")
    theta = np.full(5, 0.3)
    theta[list(unknown)] = np.nan
    here = at_pose(robot, theta)
    assert not here.reached
    for value in (
        here.frames,
        here.T_MT,
        here.J,
        here.C_joint,
        here.C,
        here.C_X,
        *here.principal,
        here.delta([1, 2, 3]),
    ):
        assert np.isnan(value).all()


def test_a_report_of_a_pose_shows_the_tip_and_what_it_gives_where_it_is_reached():
    """Its facts are the numbers found by products of matrices, in mm and um/N; none where nothing is known."""
    robot = rm.load_robot("slavkovic_5r")
    theta = np.array([0.2, -0.3, 0.4, 0.1, 0.5])
    facts = dict(at_pose(robot, theta)._facts())
    tip, C = rm.tool_pose(robot, theta)[:3, 3], rm.cartesian_compliance(robot, theta)
    assert next(iter(facts)) == "Robot"
    shown = [float(part.replace("\u2212", "-").split()[0]) for part in facts["Tip in {M}"].split(",")]
    np.testing.assert_allclose(shown, tip * 1e3, atol=0.0051)
    for i, c in enumerate("xyz"):
        assert float(facts[f"C_{c}{c}"].split()[0]) == pytest.approx(C[i, i] * 1e6, abs=5.1e-4)
    assert len(facts) == 5
    assert [name for name, _ in at_pose(robot, theta * np.nan)._facts()] == ["Robot"]
