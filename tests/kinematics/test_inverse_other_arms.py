"""Arms that are not milling robots: SCARA, gantry, arms without closed form, empty batches."""

import numpy as np
import pytest

import robomill as rm
from robomill.kinematics import dexterity
from robomill.kinematics.choice import turn
from robomill.workspace.fields import compliance_map
from robomill.workspace.grid import box_grid
from tests.kinematics.oracles import pose

SCARA = {
    "name": "scara",
    "convention": "standard",
    "alpha": [0, np.pi, 0, 0],
    "a": [0.4, 0.3, 0, 0],
    "d": [0.4, 0, 0, 0.05],
    "theta_offset": [0] * 4,
    "prismatic": [0, 0, 1, 0],
    "limits_all": [[-2.5, 2.5], [-2.5, 2.5], [0, 0.3], [-3, 3]],
    "C_theta_all": [1e-6, 1e-6, 1e-9, 1e-6],
}


def test_scara():
    robot = rm.Robot(**SCARA)
    assert dexterity.square_rows(robot) == ("v_x", "v_y", "v_z", "omega_z")
    theta = np.random.default_rng(0).uniform(robot.limits[:, 0], robot.limits[:, 1], (300, 4))
    T_MT = rm.tool_pose(robot, theta)
    result = rm.inverse_kinematics(robot, T_MT)
    assert result.reached.all()
    np.testing.assert_allclose(rm.tool_pose(robot, result.theta)[:, :3, 3], T_MT[:, :3, 3], atol=1e-9)
    field = compliance_map(robot, box_grid([-0.6, -0.6, 0.1], [0.6, 0.6, 0.3], 0.3))
    # Only the slide gives in Z, by its compliance in m/N.
    np.testing.assert_allclose(field.values("C_zz")[field.reached], 1e-9)


def test_no_whole_turn_within_limits_is_nearer():
    """All turns tried one by one, for limits of a part of a turn to several; goals lie inside and beyond them."""
    rng = np.random.default_rng(3)
    for _ in range(40):
        low = rng.uniform(-14.0, 0.0, 4)
        limits = np.stack([low, low + rng.uniform(0.5, 16.0, 4)], axis=1)
        limits[2] = 0.0, 0.3
        robot = rm.Robot(**{**SCARA, "limits_all": limits})
        theta, near = rng.uniform(-np.pi, np.pi, (7, 4)), rng.uniform(-16.0, 16.0, (7, 4))
        found = turn(robot, theta, near)
        np.testing.assert_array_equal(found[:, 2], theta[:, 2])  # it slides
        for i, j in np.ndindex(7, 4):
            tried = theta[i, j] + 2.0 * np.pi * np.arange(-6, 7)
            inside = tried[(limits[j, 0] <= tried) & (tried <= limits[j, 1])]
            some, goal = (inside, near[i, j]) if inside.size else (tried, limits[j].mean())
            assert j == 2 or abs(found[i, j] - some[np.argmin(np.abs(some - goal))]) < 1e-12
        np.testing.assert_array_equal(turn(robot, theta, near[0])[0], found[0])


def test_gantry():
    robot = rm.Robot(
        name="gantry",
        convention="modified",
        alpha=[0, np.pi / 2, np.pi / 2],
        a=[0] * 3,
        d=[0] * 3,
        theta_offset=[0, np.pi / 2, np.pi / 2],
        prismatic=[1, 1, 1],
        limits_all=[[0, 1]] * 3,
        C_theta_all=[1e-9] * 3,
    )
    theta = [0.2, 0.3, 0.4]
    np.testing.assert_allclose(rm.inverse_kinematics(robot, rm.tool_pose(robot, theta)).theta, theta, atol=1e-9)
    assert abs(dexterity.determinant(robot, theta)) == pytest.approx(1.0)
    np.testing.assert_allclose(rm.cartesian_compliance(robot, theta), 1e-9 * np.eye(3), atol=1e-22)


def test_empty_batches():
    robot = rm.load_robot("slavkovic_5r")
    assert rm.tool_pose(robot, np.empty((0, 5))).shape == (0, 4, 4)
    assert rm.geometric_jacobian(robot, np.empty((2, 0, 5))).shape == (2, 0, 6, 5)
    for near in (None, "path"):
        assert rm.inverse_kinematics(robot, np.empty((0, 4, 4)), near=near).theta.shape == (0, 5)


@pytest.mark.parametrize("lead", [(40,), (2, 20)])
def test_an_arm_without_closed_form_follows_each_path_from_pose_to_pose(lead):
    robot = rm.load_robot("planar_3r")
    s = np.linspace(0, 1, np.prod(lead)).reshape(lead)
    theta = np.stack([0.2 + 0.5 * s, 0.6 - 0.3 * s, 0.3 + 0.2 * s], axis=-1)
    T_MT = rm.tool_pose(robot, theta)
    result = rm.inverse_kinematics(robot, T_MT, near="path")
    assert result.reached.all()
    assert result.branch_names == ("numerical",)
    np.testing.assert_allclose(rm.tool_pose(robot, result.theta)[..., :3, 3], T_MT[..., :3, 3], atol=1e-9)
    assert np.abs(np.diff(result.theta, axis=-2)).max() < 0.1
    if len(lead) > 1:  # each run begins anew, whatever went before it
        alone = [rm.inverse_kinematics(robot, run, near="path").theta for run in T_MT]
        np.testing.assert_allclose(result.theta, alone, atol=1e-9)
    # A pose out of reach in the middle is left out; the path goes on from where it was.
    broken = T_MT.copy()
    broken[..., 5, :3, 3] *= 20.0
    bridged = rm.inverse_kinematics(robot, broken, near="path")
    assert bridged.reached.sum() == bridged.reached.size - np.prod(lead[:-1], dtype=int)
    assert np.isnan(bridged.theta[..., 5, :]).all()
    after = np.delete(bridged.theta, 5, axis=-2)
    assert np.abs(np.diff(after, axis=-2)).max() < 0.2


@pytest.mark.parametrize("name", ["planar_2r", "planar_3r"])
@pytest.mark.parametrize(("off", "reached"), [(1e-10, True), (-9e-10, True), (1.1e-9, False), (-1e-6, False)])
@pytest.mark.parametrize("near", [None, "path"])
def test_what_forward_kinematics_meets_to_a_nanometre_is_reached(name, off, reached, near):
    """A planar arm asked for tips beside its plane: it stays as far away as they lie from it."""
    robot = rm.load_robot(name)
    theta = np.linspace(0.3, 0.6, 4)[:, None] * np.ones(robot.n)
    T_MT = np.array([pose(robot, each) for each in theta])
    T_MT[1::2, 2, 3] += off
    found = rm.inverse_kinematics(robot, T_MT, near=near)
    assert found.reached.tolist() == [True, reached, True, reached]
    np.testing.assert_allclose(found.residual[1::2], abs(off), atol=5e-12)
    for wanted, one in zip(T_MT[found.reached], found.theta[found.reached], strict=True):
        assert np.linalg.norm((pose(robot, one) - wanted)[:3, 3]) < 1e-9
