"""The closed form against its definition: all solutions are found, each meets the pose, the right one is taken."""

import itertools

import numpy as np
import pytest

import robomill as rm
from robomill.kinematics.choice import every
from robomill.kinematics.decoupled import branch_names, decoupled
from robomill.kinematics.transforms import rotation_y, rotation_z, transform
from tests.kinematics.oracles import every_choice, pose

WIDE = {5: np.tile([-3.2, 3.2], (5, 1)), 6: np.tile([-3.2, 3.2], (6, 1))}


def arms():
    robots = [rm.load_robot(name) for name in ("slavkovic_5r", "kuka_kr500", "fanuc_r2000ic")]
    on_a_wall = transform(rotation_y(1.2) @ rotation_z(-0.4), [0.3, -0.7, 1.1])
    on_a_wall = robots[1].replace(T_base=on_a_wall, name="kuka on a wall")
    aside = robots[1].replace(d=robots[1].d + 0.15 * np.eye(6)[1], name="kuka with its arm beside its foot")
    return [*robots, on_a_wall, aside]


@pytest.mark.parametrize("robot", arms(), ids=lambda r: r.name)
def test_every_solution_is_found_and_meets_the_pose(robot):
    theta = np.random.default_rng(1).uniform(-np.pi, np.pi, (300, robot.n))
    T_MT = np.array([pose(robot, t) for t in theta])
    found, sound = every(robot, decoupled(robot), T_MT)
    assert (np.abs(found) <= np.pi).all()
    # The configuration that made the pose is among them.
    off = np.abs(np.angle(np.exp(1j * (found - theta[:, None])))).max(axis=-1)
    assert np.where(sound, off, np.inf).min(axis=1).max() < 1e-6
    for T, solutions, good in zip(T_MT[:60], found, sound, strict=False):
        for one in solutions[good]:
            own = pose(robot, one)
            np.testing.assert_allclose(own[:3, 2:], T[:3, 2:], atol=1e-9)
            if robot.n == 6:
                np.testing.assert_allclose(own, T, atol=1e-9)
        # No solution twice.
        for a, b in itertools.combinations(solutions[good], 2):
            assert np.abs(np.angle(np.exp(1j * (a - b)))).max() > 1e-9
    assert sound.sum(axis=1).max() == 8
    assert set(sound.sum(axis=1)) <= {2, 4, 6, 8}


@pytest.mark.parametrize("robot", arms(), ids=lambda r: r.name)
def test_a_solution_is_sound_where_forward_kinematics_says_so(robot):
    """An arm a little other than the one that was solved: what it misses is found by its own table."""
    theta = robot.home + np.random.default_rng(3).uniform(-0.5, 0.5, (50, robot.n))
    T_MT = np.array([pose(robot, t) for t in theta])
    for longer, seen in ((1e-6, True), (1e-10, False)):
        other = robot.replace(a=robot.a + longer)
        found, sound = every(other, decoupled(robot), T_MT)
        off = [[np.abs(pose(other, t) - T)[:3, 3].max() for t in eight] for eight, T in zip(found, T_MT, strict=True)]
        assert sound.any() != seen
        assert (np.array(off)[sound] < 1e-9).all()
        assert not seen or np.min(off) > 1e-8


@pytest.mark.parametrize("robot", arms(), ids=lambda r: r.name)
def test_branches_are_named_by_what_they_look_like(robot):
    names = branch_names()
    theta = np.random.default_rng(2).uniform(-1, 1, (200, robot.n)) + robot.home
    T_MT = np.array([pose(robot, t) for t in theta])
    found, sound = every(robot, decoupled(robot), T_MT)
    for k in range(200):
        for b in range(0, 8, 2):
            if not sound[k, b : b + 2].all():
                continue
            assert names[b][:-2] == names[b + 1][:-2]
            # The two wrists share shoulder and elbow.
            np.testing.assert_array_equal(found[k, b, :3], found[k, b + 1, :3])
        for b in range(0, 8, 4):
            np.testing.assert_array_equal(found[k, b, 0], found[k, b + 2, 0])
    # At home shoulder and wrist stand as named.
    straight = every(robot, decoupled(robot), pose(robot, robot.home + 0.1)[None])[0][0]
    mine = np.abs(np.angle(np.exp(1j * (straight - robot.home - 0.1)))).max(axis=-1).argmin()
    assert names[mine].startswith("front")
    assert names[mine].endswith("wrist +")


@pytest.mark.parametrize("robot", arms(), ids=lambda r: r.name)
@pytest.mark.parametrize("limits", ["own", "wide", "narrow"])
def test_the_nearest_within_limits_by_brute_force(robot, limits):
    rng = np.random.default_rng(5)
    if limits == "wide":
        robot = robot.replace(limits=np.tile([-7.0, 7.0], (robot.n, 1)))
    if limits == "narrow":
        robot = robot.replace(limits=np.tile([-1.3, 2.0], (robot.n, 1)))
    theta = rng.uniform(-2.5, 2.5, (80, robot.n))
    near = np.clip(rng.uniform(-2.5, 2.5, (80, robot.n)), *robot.limits.T)
    T_MT = np.array([pose(robot, t) for t in theta])
    found, sound = every(robot, decoupled(robot), T_MT)
    result = rm.inverse_kinematics(robot, T_MT, near=near, spin="fixed")
    at_home = rm.inverse_kinematics(robot, T_MT, spin="fixed")
    names = branch_names()
    down = rm.inverse_kinematics(robot, T_MT, near=near, branch="elbow down, wrist -", spin="fixed")
    for k in range(80):
        choices = [(b, t) for b, t in every_choice(robot, found[k]) if sound[k, b]]
        assert result.reached[k] == bool(choices) == at_home.reached[k]
        wanted = [(b, t) for b, t in choices if "elbow down" in names[b] and "wrist -" in names[b]]
        assert down.reached[k] == bool(wanted)
        if not choices:
            assert np.isnan(result.theta[k]).all()
            assert result.branch[k] == ""
            continue
        least = min(((t - near[k]) ** 2).sum() for _, t in choices)
        mine = ((result.theta[k] - near[k]) ** 2).sum()
        if limits != "wide":  # with several turns each joint goes to the turn nearest its goal, or mid-range
            assert mine == pytest.approx(least, abs=1e-9)
        assert any(np.abs(t - result.theta[k]).max() < 1e-9 for _, t in choices)
        # Without a wish: shoulder and elbow as at home where they can be, then the least motion from home.
        posture = min(b // 2 for b, _ in choices)
        first = [t for b, t in choices if b // 2 == posture]
        assert names.index(at_home.branch[k]) // 2 == posture
        if limits != "wide":
            motion = min(((t - robot.home) ** 2).sum() for t in first)
            assert ((at_home.theta[k] - robot.home) ** 2).sum() == pytest.approx(motion, abs=1e-9)
        if wanted:
            assert "elbow down" in down.branch[k]
            assert any(np.abs(t - down.theta[k]).max() < 1e-9 for _, t in wanted)


def test_a_free_spin_is_the_best_of_all_spins():
    robot = rm.load_robot("fanuc_r2000ic")
    T_MT = rm.pose_from_world(
        np.random.default_rng(0).uniform([1.4, -0.5, 0.2, -0.3, -0.3], [2.0, 0.5, 1, 0.3, 0.3], (4, 5))
    )
    free = rm.inverse_kinematics(robot, T_MT)
    angles = np.radians(np.arange(0.0, 360.0, 0.5))
    for k in range(4):
        spun = np.array([T_MT[k] @ transform(rotation_z(a), np.zeros(3)) for a in angles])
        all_of_them = rm.inverse_kinematics(robot, spun, spin="fixed")
        cost = ((all_of_them.theta - robot.home) ** 2).sum(axis=1)
        front_up = np.array([name.startswith("front, elbow up") for name in all_of_them.branch])
        best = np.nanmin(np.where(front_up, cost, np.nan))
        assert ((free.theta[k] - robot.home) ** 2).sum() <= best + 1e-3
        turned = T_MT[k] @ transform(rotation_z(free.spin[k]), np.zeros(3))
        np.testing.assert_allclose(pose(robot, free.theta[k]), turned, atol=1e-8)


def test_a_spindle_on_axis_6_leaves_that_axis_where_it_is():
    robot = rm.load_robot("kuka_kr500")
    T_MT = rm.pose_from_world([[1.6, -0.4, 0.6, 0.1, 0.2], [1.5, 0.3, 0.8, 0.0, 0.1]])
    near = np.full(6, 0.3)
    result = rm.inverse_kinematics(robot, T_MT, near=near)
    np.testing.assert_array_equal(result.theta[:, 5], 0.3)
    for theta, T in zip(result.theta, T_MT, strict=True):
        np.testing.assert_allclose(pose(robot, theta)[:3, 2:], T[:3, 2:], atol=1e-9)
    np.testing.assert_array_equal(rm.inverse_kinematics(robot, T_MT).theta[:, 5], robot.home[5])


def test_singular_poses_have_an_answer():
    """Straight wrist, wrist centre on axis 1, stretched arm: some angles are free, the pose is met all the same."""
    robot = rm.load_robot("kuka_kr500").replace(limits=WIDE[6])
    for theta in (np.zeros(6), [0.3, 0.2, -0.4, 0.5, 0.0, 0.7], [0.3, 0.2, -0.4, 0.5, 1e-9, 0.7]):
        T = pose(robot, np.asarray(theta))
        result = rm.inverse_kinematics(robot, T, spin="fixed")
        assert result.reached
        np.testing.assert_allclose(pose(robot, result.theta), T, atol=1e-9)


def test_a_little_past_a_limit_by_rounding_is_at_the_limit():
    robot = rm.load_robot("slavkovic_5r")
    theta = np.array([0.2, 0.3, 0.4, 0.1, 0.5])
    T = pose(robot, theta)
    limits = np.array(robot.limits)
    limits[1] = [-1.0, 0.3 - 5e-11]
    close = rm.inverse_kinematics(robot.replace(limits=limits), T, near=theta)
    assert close.reached
    assert close.theta[1] == limits[1, 1]
    limits[1] = [-1.0, 0.3 - 1e-6]
    beyond = rm.inverse_kinematics(robot.replace(limits=limits), T, near=theta)
    assert not beyond.reached or abs(beyond.theta[1] - 0.3) > 1e-3
