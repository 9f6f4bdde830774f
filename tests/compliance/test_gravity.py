"""Sag under gravity: torques against the derivative of potential energy, sag against forward kinematics."""

import numpy as np
import pytest

from robomill.compliance.gravity import GRAVITY, LinkMasses, gravity_sag, gravity_torques
from robomill.errors import RobotError
from robomill.io.robot.robots import load_robot
from robomill.kinematics.forward import joint_frames, tool_pose
from tests.robot.written_otherwise import with_blocked

ROBOT = load_robot("slavkovic_5r")
RNG = np.random.default_rng(4)
THETA = RNG.uniform(-0.6, 0.6, (5, ROBOT.n))
LINKS = LinkMasses([300.0, 250.0, 150.0, 80.0, 60.0], RNG.uniform(-0.3, 0.3, (5, 3)))


def potential(theta):
    """-sum of m g . r over the links, by forward kinematics."""
    after = joint_frames(ROBOT, theta)[..., 1:, :, :]
    points = np.concatenate([LINKS.centre, np.ones((ROBOT.n, 1))], axis=1)
    heights = np.einsum("...lij,lj->...li", after, points)[..., :3] @ GRAVITY
    return -(heights * LINKS.mass).sum(-1)


def test_torques_are_minus_the_slope_of_potential_energy():
    step = 1e-5
    slope = np.stack(
        [(potential(THETA + step * e) - potential(THETA - step * e)) / (2 * step) for e in np.eye(ROBOT.n)], axis=-1
    )
    np.testing.assert_allclose(gravity_torques(ROBOT, THETA, LINKS), -slope, rtol=1e-6, atol=1e-4)


def test_sag_by_forward_kinematics_with_a_quadratic_remainder():
    remainders = []
    for scale in (1.0, 2.0):
        soft = ROBOT.replace(C_theta=scale * ROBOT.C_theta)
        twist = soft.C_theta * gravity_torques(soft, THETA, LINKS)
        moved = tool_pose(soft, THETA + twist)[:, :3, 3] - tool_pose(soft, THETA)[:, :3, 3]
        sag = gravity_sag(soft, THETA, LINKS)
        assert sag.shape == (5, ROBOT.n, 3)
        remainders.append(np.linalg.norm(moved - sag.sum(-2)))
        assert remainders[-1] < 0.02 * np.linalg.norm(moved)
    assert np.log2(remainders[1] / remainders[0]) == pytest.approx(2.0, abs=0.1)


def test_horizontal_arm_by_hand():
    """Two equal links of 0.5 m lying along x with a mass in the middle of each: moments by lever arms."""
    planar = load_robot("planar_2r")
    length = [float(np.linalg.norm(step)) for step in np.diff(joint_frames(planar, [0.0, 0.0])[:, :3, 3], axis=0)]
    # The planar arm moves about z, so let gravity pull along -y.
    links = LinkMasses([4.0, 2.0], [[-length[0] / 2, 0, 0], [-length[1] / 2, 0, 0]])
    tau = gravity_torques(planar, [0.0, 0.0], links, [0.0, -10.0, 0.0])
    second = -10 * 2.0 * length[1] / 2
    first = -10 * (4.0 * length[0] / 2 + 2.0 * (length[0] + length[1] / 2))
    np.testing.assert_allclose(tau, [first, second], rtol=1e-12)


def test_one_link_mass_is_not_taken_for_the_tip():
    # A single free joint: the mass point and the tip are both one point a joint.
    single = ROBOT
    for row in (2, 3, 4, 5):
        single = with_blocked(single, row, 0.1)
    links = LinkMasses([10.0], [[0.1, 0.2, -0.3]])
    theta = np.array([[0.3]])
    step = 1e-6

    def fall(angle):
        T = tool_pose(single, angle)[0]
        return -10.0 * (np.array(GRAVITY) @ (T[:3, :3] @ links.centre[0] + T[:3, 3]))

    slope = (fall(theta + step) - fall(theta - step)) / (2 * step)
    assert gravity_torques(single, theta, links)[0, 0] == pytest.approx(-slope, abs=1e-6)


@pytest.mark.parametrize("longer", [-0.08, 0.0, 0.15])
def test_what_the_last_joint_carries_stays_where_a_longer_tool_ends_elsewhere(longer):
    """A tool sticks out against z_T: its tip goes that way, and no weight moves, so no joint feels any of it."""
    shift = np.eye(4)
    shift[2, 3] = -longer
    other = ROBOT.replace(T_tool=ROBOT.T_tool @ shift)
    tips = tool_pose(ROBOT, THETA)
    lower = tips[:, :3, 3] - longer * tips[:, :3, 2]
    np.testing.assert_allclose(tool_pose(other, THETA)[:, :3, 3], lower, atol=1e-12)
    behind = LINKS.behind(longer)
    torques = gravity_torques(ROBOT, THETA, LINKS)
    np.testing.assert_allclose(gravity_torques(other, THETA, behind), torques, rtol=1e-10, atol=1e-9)
    assert (behind is LINKS) == (longer == 0.0)
    np.testing.assert_array_equal(behind.centre[:-1], LINKS.centre[:-1])


def test_refusals():
    with pytest.raises(RobotError, match="found 2, expected 5"):
        gravity_sag(ROBOT, THETA, LinkMasses([1.0, 1.0], np.zeros((2, 3))))
    with pytest.raises(RobotError, match="Weight of the arm, Mass: found −1 kg; expected 0 kg to 20\u202f000 kg"):
        LinkMasses([-1.0], np.zeros((1, 3)))
    with pytest.raises(RobotError, match="found 2 masses and 1 centres of mass"):
        LinkMasses([1.0, 2.0], np.zeros((1, 3)))


def test_weight_pulls_down_by_what_a_kilogram_weighs():
    """Along -z of {M}: an arm stretched out sinks; a mass on one link loads its joint by m g times its level arm."""
    sag = gravity_sag(ROBOT, np.zeros(5), LinkMasses(LINKS.mass, np.zeros((5, 3)))).sum(axis=0)
    assert sag[2] < -10 * np.abs(sag[0])
    mass = np.array([0.0, 0.0, 0.0, 0.0, 7.0])
    for theta in THETA:
        frames = joint_frames(ROBOT, theta)
        axis, arm = frames[1, :3, 2], frames[-1, :3, 3] - frames[1, :3, 3]
        torque = ROBOT.chain.sign[1] * axis @ np.cross(arm, [0.0, 0.0, -7.0 * 9.80665])
        found = gravity_torques(ROBOT, theta, LinkMasses(mass, np.zeros((5, 3))))
        assert found[1] == pytest.approx(torque, rel=1e-9)
