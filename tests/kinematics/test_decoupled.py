"""The closed form's structure: branches are named after the arm as it stands at home, whatever its signs."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.kinematics.choice import every
from robomill.kinematics.decoupled import decoupled, shortfall
from robomill.kinematics.forward import joint_frames
from tests.kinematics.oracles import screw
from tests.robot.written_otherwise import with_blocked


@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500", "fanuc_r2000ic"])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("at", [0.7, -0.7, 0.0])
def test_the_arm_at_home_stands_in_front_with_its_wrist_plus(name, sign, at):
    robot = rm.load_robot(name)
    turned, limits = robot.sign.copy(), robot.limits.copy()
    turned[4], limits[4] = sign * turned[4], [at - 0.5, at + 0.5]  # without zero: home is the middle
    robot = robot.replace(sign=turned, limits=limits)
    assert robot.home[4] == pytest.approx(at)
    past = robot.home.copy()
    past[4] += 0.05 if at == 0.0 else 0.0  # a straight wrist is told by what lies a little past it
    there = rm.inverse_kinematics(robot, rm.tool_pose(robot, past), near=past, spin="fixed")
    np.testing.assert_allclose(there.theta, past, atol=1e-8)
    assert "front" in there.branch
    assert "wrist +" in there.branch


@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500", "fanuc_r2000ic"])
def test_front_is_where_the_wrist_stands_at_home_however_long_the_tool_is(name):
    """Tools of up to six metres, whose tip may lie behind axis 1 while the wrist is in front; any home and base."""
    robot, rng = rm.load_robot(name), np.random.default_rng(9)
    behind = 0
    for _ in range(40):
        T_tool = np.array(robot.T_tool)
        if robot.n == 5:
            T_tool[:3, 3] += T_tool[:3, 2] * rng.uniform(-6, 6)
        else:
            T_tool[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            T_tool[:3, 2] = np.cross(T_tool[:3, 0], T_tool[:3, 1])
            T_tool[:3, 3] = rng.uniform(-4, 4, 3)
        home = rng.uniform(*robot.limits.T)
        home[4] = rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 2.9)
        # Without zero between them home is the middle of the limits.
        room = np.abs(home)[:, None] * [-0.5, 0.5]
        T_base = screw(0, rng.uniform(-3, 3), 0.0) @ screw(2, rng.uniform(-3, 3), 0.0)
        T_base[:3, 3] = rng.uniform(-5, 5, 3)
        arm = robot.replace(T_base=T_base, T_tool=T_tool, limits=home[:, None] + room)
        np.testing.assert_allclose(arm.home, home)
        frames = joint_frames(arm, home)
        k, p, tip = frames[:-1, :3, 2], frames[:-1, :3, 3], frames[-1, :3, 3]
        ways = [np.cross(k[1], k[0]) @ (at - p[0]) for at in (crossing(p[3], k[3], p[4], k[4]), tip)]
        behind += ways[0] * ways[1] < 0.0
        there = rm.inverse_kinematics(arm, frames[-1], near=home, spin="fixed")
        np.testing.assert_allclose(there.theta, home, atol=1e-6)
        assert there.branch.startswith("front")
        assert there.branch.endswith("wrist +")
    assert 0 < behind < 40


def test_structures_recognised_from_the_table():
    assert decoupled(rm.load_robot("slavkovic_5r")).n == 5
    assert decoupled(rm.load_robot("kuka_kr500")).spindle_on_last_axis
    assert not decoupled(rm.load_robot("fanuc_r2000ic")).spindle_on_last_axis
    assert decoupled(rm.load_robot("planar_3r")) is None
    assert decoupled(rm.load_robot("slavkovic_5r").replace(prismatic=[True, *[False] * 4])) is None
    # The paper's machine: a six-axis robot with axis 6 blocked.
    assert decoupled(with_blocked(rm.load_robot("kuka_kr500"), 6, 0.0)).n == 5


@pytest.mark.parametrize("hangs", [False, True])
@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500", "fanuc_r2000ic"])
def test_an_elbow_that_is_up_stands_higher_than_one_that_is_down(name, hangs):
    """At poses that an arm on the floor, or one that hangs from the ceiling, meets both ways, from the front."""
    robot = rm.load_robot(name)
    robot = robot.replace(limits=np.tile([-np.pi, np.pi], (robot.n, 1)))
    if hangs:
        robot = robot.replace(T_base=np.diag([1.0, -1.0, -1.0, 1.0]) @ robot.T_base)
    theta = rm.load_robot(name).home + np.random.default_rng(6).uniform(-0.3, 0.3, (40, robot.n))
    T_MT = rm.tool_pose(robot, theta)
    up, down = (rm.inverse_kinematics(robot, T_MT, branch=f"front, elbow {b}", spin="fixed") for b in ("up", "down"))
    both = up.reached & down.reached
    assert both.sum() > 20
    height = [joint_frames(robot, each.theta[both])[:, 2, 2, 3] for each in (up, down)]
    assert (height[0] > height[1]).all()


@pytest.mark.parametrize("gone", [("a", 1), ("d", 3)])
def test_without_an_upper_arm_or_a_forearm_there_is_no_closed_form(gone):
    """The elbow stands on the shoulder, or the wrist on the elbow: the arm is solved all the same."""
    robot, (name, row) = rm.load_robot("slavkovic_5r"), gone
    lengths = np.array(getattr(robot, name))
    assert abs(lengths[row]) > 1.0
    lengths[row] = 0.0
    folded = robot.replace(**{name: lengths})
    assert decoupled(folded) is None
    theta = folded.home + np.random.default_rng(1).uniform(-0.2, 0.2, (5, 5))
    found = rm.inverse_kinematics(folded, rm.tool_pose(folded, theta), near=theta)
    assert found.reached.all()
    np.testing.assert_allclose(rm.tool_pose(folded, found.theta), rm.tool_pose(folded, theta), atol=1e-8)


def test_the_spindle_is_on_the_last_axis_where_a_turn_about_it_leaves_axis_and_tip():
    """Six axes, the tool along the last one and its tip on it."""
    arm = rm.load_robot("kuka_kr500")
    aside, tilted = np.array(arm.T_tool), np.array(arm.T_tool)
    aside[:3, 3] += 0.01 * aside[:3, 0]
    c, s = np.cos(0.1), np.sin(0.1)
    tilted[:3, :3] = tilted[:3, :3] @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    for T_tool in (arm.T_tool, aside, tilted):
        robot = arm.replace(T_tool=T_tool)
        turned = robot.home + np.array([0, 0, 0, 0, 0, 0.4])
        before, after = rm.tool_pose(robot, np.array([robot.home, turned]))
        kept = np.allclose(before[:3, 2:], after[:3, 2:], atol=1e-9)
        found = decoupled(robot)
        assert found is not None
        assert found.spindle_on_last_axis == kept
    assert not decoupled(rm.load_robot("slavkovic_5r")).spindle_on_last_axis


def crossing(p, k, q, m):
    """The point nearest to two lines, by least squares."""
    beside = np.eye(3) - np.array([np.outer(k, k), np.outer(m, m)])
    return np.linalg.lstsq(np.concatenate(beside), np.concatenate([beside[0] @ p, beside[1] @ q]), rcond=None)[0]


@pytest.mark.parametrize(("name", "aside"), [("slavkovic_5r", 0.0), ("kuka_kr500", 0.3), ("fanuc_r2000ic", -0.4)])
def test_how_much_is_missing_to_a_place_is_measured_on_the_arm(name, aside):
    """Lengths between the axes as they stand at some configuration; the wrist centre has to come between the circles
    about the shoulder, in front or behind, in the plane of the arm."""
    robot = rm.load_robot(name)
    d = robot.d.copy()
    d[1], d[3] = d[1] + aside, d[3] * (1.0 if aside == 0.0 else 0.5)  # beside axis 1, with a short forearm
    robot = robot.replace(d=d)
    rng = np.random.default_rng(4)
    frames = joint_frames(robot, rng.uniform(0.2, 0.9, robot.n))
    k, p = frames[:-1, :3, 2], frames[:-1, :3, 3]
    tip, R = frames[-1, :3, 3], frames[-1, :3, :3]
    centre = crossing(p[3], k[3], p[4], k[4])
    y, z = k[1], k[0]
    out = np.cross(y, z)

    def flat(v):
        return np.array([v @ out, v @ z])

    shoulder, h = p[1] - p[0], y @ (centre - p[0])
    upper, lower = np.hypot(*flat(p[2] - p[1])), np.hypot(*flat(centre - p[2]))
    told = {"": 0, "beyond": 0, "inside": 0, "close": 0}
    for turn in range(200):
        side, size = rng.normal(size=3), (upper + lower) * rng.uniform(0.0, 1.4)
        at = p[0] + z * (z @ shoulder) + size * side / np.linalg.norm(side)
        if turn % 4 == 0:  # near the axis
            at -= (1.0 - rng.uniform(0.0, 0.3)) * (at - p[0] - z * (z @ (at - p[0])))
        if turn % 8 == 1:  # near the shoulder
            at = p[1] + y * (y @ (centre - p[1])) + 0.9 * abs(upper - lower) * side / np.linalg.norm(side)
        T = np.eye(4)
        T[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        T[:3, 2] = np.cross(T[:3, 0], T[:3, 1])
        T[:3, 3] = at + T[:3, :3] @ R.T @ (tip - centre)
        words = shortfall(decoupled(robot), T)
        rho, height = np.hypot(*np.cross(z, at - p[0])[:2]), z @ (at - p[1])
        if rho < abs(h):
            wanted, missing = "inside", abs(h) - rho
        else:
            reach = np.hypot(np.sqrt(rho**2 - h**2) * np.array([1.0, -1.0]) - out @ shoulder, height)
            over, under = reach.min() - upper - lower, abs(upper - lower) - reach.max()
            wanted, missing = ("beyond", over) if over > 0 else ("close", under) if under > 0 else ("", 0.0)
        told[wanted] += 1
        assert wanted in words
        assert bool(words) == bool(wanted)
        if words:
            number, unit = words.split()[:2]
            size = float(number) * {"m": 1.0, "mm": 1e-3}[unit]
            assert (unit == "m") == (missing >= 0.01)
            assert size == pytest.approx(missing, rel=0.05, abs=0.0051 if unit == "m" else 0.0)
        _, sound = every(robot, decoupled(robot), T[None])
        assert sound.any() == (not words)
    assert min(told["beyond"], told[""], told["close" if aside == 0.0 else "inside"]) >= 5, told


def stands_apart(robot):
    """Whether axes, as they lie at some configuration, are those of an arm whose wrist turns about one point."""
    frames = joint_frames(robot, np.random.default_rng(8).uniform(0.2, 0.9, robot.n))
    k, p, tip = frames[:-1, :3, 2], frames[:-1, :3, 3], frames[-1]
    centre = crossing(p[3], k[3], p[4], k[4])

    def off(point, i):
        return np.linalg.norm(np.cross(point - p[i], k[i]))

    angles = [k[0] @ k[1], np.linalg.norm(np.cross(k[1], k[2])), k[3] @ k[4]]
    ways = [off(centre, 3), off(centre, 4)]
    ways.append(off(centre, 5) if robot.n == 6 else np.linalg.norm(np.cross(tip[:3, 3] - centre, tip[:3, 2])))
    return np.abs([*angles, *ways]).max() < 1e-7


@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500", "fanuc_r2000ic"])
@pytest.mark.parametrize("length", ["alpha", "a", "d"])
def test_an_arm_whose_axes_stand_a_little_otherwise_has_no_closed_form_and_still_reaches(name, length):
    robot = rm.load_robot(name)
    told = set()
    for row in range(robot.n):
        table = np.array(getattr(robot, length))
        table[row] += 1e-3
        arm = robot.replace(**{length: table})
        closed = decoupled(arm) is not None
        assert closed == stands_apart(arm), row
        told.add(closed)
        theta = arm.home + 0.1
        found = rm.inverse_kinematics(arm, rm.tool_pose(arm, theta), near=theta, spin="fixed")
        np.testing.assert_allclose(found.theta, theta, atol=1e-6)
    assert told == {True, False}
