"""Joints taken out, put in and moved, and the other convention: poses by multiplying the table's own matrices here."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import RobotError
from robomill.robot.joints import (
    in_other_convention,
    read_in_other_convention,
    with_joints,
    with_new_joint,
)
from robomill.robot.model import Robot
from robomill.robot.table import ASSUMED_COMPLIANCE

SAMPLES = ("slavkovic_5r", "fanuc_r2000ic", "kuka_kr270", "planar_3r")


def rot(axis: str, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    T = np.eye(4)
    T[:3, :3] = {"x": [[1, 0, 0], [0, c, -s], [0, s, c]], "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}[axis]
    return T


def shift(x: float, z: float) -> np.ndarray:
    T = np.eye(4)
    T[0, 3], T[2, 3] = x, z
    return T


def by_hand(robot: Robot, theta: np.ndarray) -> np.ndarray:
    """T_MT by the textbook: standard Rz Tz Rx Tx, Craig's Rx Tx Rz Tz, one row after the other."""
    T = np.array(robot.T_base)
    for i in range(robot.rows):
        turn, slide = robot.theta_offset[i], robot.d[i]
        if robot.prismatic[i]:
            slide = slide + robot.sign[i] * theta[i]
        else:
            turn = turn + robot.sign[i] * theta[i]
        link, joint = rot("x", robot.alpha[i]) @ shift(robot.a[i], 0), rot("z", turn) @ shift(0, slide)
        T = T @ (joint @ link if robot.convention == "standard" else link @ joint)
    return np.asarray(T @ robot.T_tool)


def arm(rng: np.random.Generator, convention: str, n: int) -> Robot:
    """A random arm with sliding joints, signs, offsets and frames."""
    frames = [rot("x", rng.uniform(-3, 3)) @ rot("z", rng.uniform(-3, 3)) @ shift(*rng.uniform(-1, 1, 2)) for _ in "bt"]
    return Robot(
        name="random",
        convention=convention,
        alpha=rng.uniform(-3, 3, n),
        a=rng.uniform(-1, 1, n),
        d=rng.uniform(-1, 1, n),
        theta_offset=rng.uniform(-3, 3, n),
        sign=rng.choice([-1.0, 1.0], n),
        prismatic=rng.random(n) < 0.3,
        limits_all=np.tile([-2.0, 2.0], (n, 1)),
        C_theta_all=rng.uniform(1e-7, 1e-5, n),
        compliance_sets={"first": np.arange(1.0, n + 1) * 1e-7},
        T_base=frames[0],
        T_tool=frames[1],
    )


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_the_other_convention_is_the_same_robot_to_1e_12(convention: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = arm(rng, convention, int(rng.integers(1, 8)))
    other = in_other_convention(robot)
    assert other.convention != robot.convention
    for theta in rng.uniform(-2, 2, (20, robot.n)):
        np.testing.assert_allclose(by_hand(other, theta), by_hand(robot, theta), atol=1e-12)
        np.testing.assert_allclose(rm.tool_pose(other, theta), by_hand(robot, theta), atol=1e-12)
    np.testing.assert_array_equal(other.C_theta, robot.C_theta)
    np.testing.assert_array_equal(other.limits, robot.limits)


@pytest.mark.parametrize("name", SAMPLES)
def test_there_and_back_again_every_pose_stays(name: str) -> None:
    robot = rm.load_robot(name)
    again = in_other_convention(in_other_convention(robot))
    theta = np.random.default_rng(1).uniform(*robot.limits.T, (50, robot.n))
    np.testing.assert_allclose(rm.tool_pose(again, theta), rm.tool_pose(robot, theta), atol=1e-12)
    J = rm.geometric_jacobian(robot, theta)
    np.testing.assert_allclose(rm.geometric_jacobian(again, theta), J, atol=1e-12)


def test_the_same_numbers_read_otherwise_are_another_robot() -> None:
    robot = rm.load_robot("slavkovic_5r")
    other = read_in_other_convention(robot)
    theta = np.full(5, 0.2)
    np.testing.assert_allclose(rm.tool_pose(other, theta), by_hand(other, theta), atol=1e-12)
    np.testing.assert_array_equal(other.alpha, robot.alpha)
    assert np.abs(rm.tool_pose(other, theta) - rm.tool_pose(robot, theta)).max() > 0.1
    assert other.provenance["geometry"].kind == "user"


@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize("slides", [False, True])
def test_a_new_joint_at_zero_leaves_the_tool_where_it_was(convention: str, slides: bool) -> None:
    rng = np.random.default_rng(4)
    robot = arm(rng, convention, 4)
    theta = rng.uniform(-1, 1, 4)
    for at in range(5):
        more = with_new_joint(robot, at, slides)
        assert more.n == 5
        assert more.prismatic[at] == slides
        np.testing.assert_allclose(by_hand(more, np.insert(theta, at, 0.0)), by_hand(robot, theta), atol=1e-12)
        np.testing.assert_array_equal(np.delete(more.C_theta, at), robot.C_theta)
        np.testing.assert_array_equal(np.delete(more.compliance_sets["first"], at), robot.compliance_sets["first"])
        assert more.C_theta[at] == more.compliance_sets["first"][at] == ASSUMED_COMPLIANCE
        for block in ("geometry", "limits", "compliance.first"):
            assert f"joint {at + 1} was added" in more.provenance[block].source
        assert more.provenance["compliance.first"].kind == "assumed"
        np.testing.assert_array_equal(with_joints(more, [i for i in range(5) if i != at]).limits, robot.limits)


def test_what_belongs_to_a_joint_goes_with_it() -> None:
    robot = arm(np.random.default_rng(5), "modified", 5)
    order = [4, 0, 2]
    fewer = with_joints(robot, order)
    for name in ("alpha", "a", "d", "theta_offset", "sign", "prismatic", "limits_all", "C_theta_all"):
        np.testing.assert_array_equal(getattr(fewer, name), getattr(robot, name)[order])
    np.testing.assert_array_equal(fewer.compliance_sets["first"], robot.compliance_sets["first"][order])
    assert fewer.provenance["geometry"].kind == "user"
    assert fewer.provenance["geometry"].source.endswith("; joints were taken out")
    turned = with_joints(robot, [4, 3, 2, 1, 0])
    assert turned.provenance["geometry"].source.endswith("; joints were put in another order")
    same = rm.load_robot("slavkovic_5r")
    assert with_joints(same, range(5)) == same


def test_a_held_axis_stays_held_where_it_goes() -> None:
    robot = rm.load_robot("slavkovic_5r").replace(blocked=[np.nan, 0.3, np.nan, np.nan, np.nan])
    np.testing.assert_array_equal(with_joints(robot, [1, 0, 2, 3, 4]).free, [False, True, True, True, True])
    assert with_new_joint(robot, 0).n == 5


def test_too_few_and_too_many_are_refused_in_a_sentence() -> None:
    robot = rm.load_robot("slavkovic_5r")
    one = with_joints(robot, [2])
    assert one.n == 1
    with pytest.raises(RobotError, match="an arm needs at least one joint; this is the last one"):
        with_joints(one, [])
    with pytest.raises(RobotError, match="has 7 joints already; robomill computes arms of 1 to 7 joints"):
        with_new_joint(with_new_joint(with_new_joint(robot, 0), 0), 0)
