"""Next-best tests: what they promise must come true when they are measured."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.fit.estimate import identify
from robomill.identification.plan import MARGIN, Loads, _best, box_candidates, candidates_around, next_best
from robomill.io.measured.load_test_sheets import measuring_sheet
from robomill.io.samples import samples_dir
from tests.identification.cables import Arm, Rig, as_csv, make
from tests.identification.synthetic import simulated_tests

ROBOT = rm.load_robot("slavkovic_5r").with_compliance_set("table_3")
BOX = np.array([-0.6, -1.6, -0.4]), np.array([0.6, -1.0, 0.1])
TESTS = rm.read_load_tests(samples_dir() / "load_tests" / "nine_points.csv")
RESULT = identify(ROBOT, TESTS)


def joined(plan, seed):
    return TESTS.joined(simulated_tests(ROBOT, plan.theta, plan.F, noise=RESULT.noise, seed=seed))


@pytest.mark.parametrize("joint", [1, 4])
def test_three_more_tests_shrink_the_named_joints_interval_by_a_third(joint):
    plan = next_best(ROBOT, TESTS, RESULT, box_candidates(ROBOT, *BOX), goal=joint)
    assert plan.half_after[joint - 1] < 2 / 3 * plan.half_before[joint - 1]
    measured = identify(ROBOT, joined(plan, 1))  # and when they are really measured:
    width = np.ptp(measured.ci95[joint - 1]) / np.ptp(RESULT.ci95[joint - 1])
    assert width < 2 / 3
    assert f"joint {joint}" in plan.sentence()
    assert plan.rows()[joint - 1]["gain"] > 1 / 3


@pytest.mark.parametrize("joint", [2, 3, 5])
def test_any_joint_gains(joint):
    plan = next_best(ROBOT, TESTS, RESULT, box_candidates(ROBOT, *BOX), goal=joint)
    assert plan.after[joint - 1] < plan.before[joint - 1]


def test_predicted_intervals_come_true():
    plan = next_best(ROBOT, TESTS, RESULT, box_candidates(ROBOT, *BOX), goal="all")
    np.testing.assert_allclose(plan.before, RESULT.stderr, rtol=1e-6)
    after = identify(ROBOT, joined(plan, 3))
    np.testing.assert_allclose(plan.after, after.stderr * RESULT.noise / after.noise, rtol=1e-3)


@pytest.mark.parametrize(("fit", "off"), [("both", (0.15, 0.08)), ("force", (0.15, 0.0))])
def test_a_plan_after_points_were_found_begins_with_what_that_fit_knows(fit, off):
    """The load point is 150 mm, the gauge point 80 mm from where it is stated: intervals before are those of the fit
    that finds them, and not of one that takes them as stated."""
    arm, robot, rig = Arm.of("kuka_kr500"), rm.load_robot("kuka_kr500"), Rig(noise=1e-5)
    made, way = make(arm, rig, 25, seed=2), np.array([0.6, 0.64, -0.48])
    text = as_csv(arm, made, rig.load_point + off[0] * way, rig.gauge_point + off[1] * way)
    tests = rm.read_load_tests(text, robot)
    result = rm.identify(robot, tests, fit_points=fit)
    assert result.points[0].is_off
    plan = next_best(robot, tests, result, count=3)
    seen = np.isfinite(result.parameter_stderr)
    np.testing.assert_allclose(plan.before[seen], result.parameter_stderr[seen], rtol=1e-4)
    assert (plan.after[seen] <= plan.before[seen]).all()
    assert (plan.half_after[seen] < plan.half_before[seen]).all()


def test_poses_keep_to_box_limits_and_tilt():
    plan = next_best(ROBOT, TESTS, RESULT, box_candidates(ROBOT, *BOX, tilt=0.3), count=6)
    assert ((plan.x_M[:, :3] >= BOX[0] - 1e-9) & (plan.x_M[:, :3] <= BOX[1] + 1e-9)).all()
    assert (np.abs(plan.x_M[:, 3:]) <= 0.3 + 1e-9).all()
    assert ((plan.theta >= ROBOT.limits[:, 0]) & (plan.theta <= ROBOT.limits[:, 1])).all()


def test_the_first_pick_has_the_largest_determinant():
    """Brute force: the determinant of the information with each candidate added."""
    candidates = box_candidates(ROBOT, *BOX, poses=40)
    blocks = RESULT.choice.tip_regressor(ROBOT, candidates.theta, candidates.F) / 1e-3
    P = np.diag([3.0, 1.0, 2.0, 5.0, 0.1]) * 1e-3
    information = np.linalg.inv(P)
    brute = [np.linalg.slogdet(information + block.T @ block)[1] for block in blocks]
    assert _best(P, blocks, None, []) == int(np.argmax(brute))
    weight = np.diag([0, 1.0, 0, 0.5, 0])
    left = [np.trace(weight @ np.linalg.inv(information + block.T @ block)) for block in blocks]
    assert _best(P, blocks, weight, []) == int(np.argmin(left))


def test_a_path_is_made_more_certain_than_by_the_general_plan():
    x_M = np.stack([np.linspace(-0.1, 0.1, 11), np.full(11, -1.3), *np.zeros((3, 11))], axis=-1)
    theta = rm.inverse_kinematics(ROBOT, rm.pose_from_world(x_M)).theta
    path = Loads(theta, np.tile([0.0, 100.0, 0.0], (11, 1)))
    candidates = box_candidates(ROBOT, *BOX)
    aimed = next_best(ROBOT, TESTS, RESULT, candidates, goal=path)
    general = next_best(ROBOT, TESTS, RESULT, candidates, goal=4)
    assert aimed.path_after < aimed.path_before

    def spread(plan):
        D = RESULT.choice.tip_regressor(ROBOT, path.theta, path.F)
        cov = identify(ROBOT, joined(plan, 0)).covariance
        return np.einsum("mci,ij,mcj->", D, cov, D) / identify(ROBOT, joined(plan, 0)).noise ** 2

    assert spread(aimed) < spread(general)


def test_an_unseen_joint_becomes_seen():
    theta = TESTS.theta[::3]
    tests = simulated_tests(ROBOT, theta, np.tile([0.0, 0.0, -250.0], (9, 1)), noise=4e-6)
    result = identify(ROBOT, tests)
    assert np.isinf(result.stderr[0])
    plan = next_best(ROBOT, tests, result, box_candidates(ROBOT, *BOX), goal=1)
    assert np.isinf(plan.before[0])
    assert plan.after[0] < 0.2 * ROBOT.C_theta[0]


def test_the_measuring_sheet_can_be_filled_in_and_read():
    plan = next_best(ROBOT, TESTS, RESULT, box_candidates(ROBOT, *BOX))
    sheet = measuring_sheet(plan)
    assert "narrow the interval" in sheet
    rows = [line for line in sheet.splitlines() if not line.startswith("#")]
    assert all(row.endswith(",,,") for row in rows[1:])
    filled = "\n".join([rows[0], *(row[:-2] + "0.5,0.1,0.2" for row in rows[1:])])
    np.testing.assert_allclose(rm.read_load_tests(filled).theta, plan.theta, atol=1e-7)


def test_refusals():
    with pytest.raises(LoadTestError, match="no pose in the box"):
        box_candidates(ROBOT, np.array([5.0, 5, 5]), np.array([6.0, 6, 6]))
    with pytest.raises(LoadTestError, match="upper corner"):
        box_candidates(ROBOT, BOX[1], BOX[0])
    candidates = box_candidates(ROBOT, *BOX, poses=20)
    with pytest.raises(LoadTestError, match="joint 9"):
        next_best(ROBOT, TESTS, RESULT, candidates, goal=9)
    with pytest.raises(LoadTestError, match="goal"):
        next_best(ROBOT, TESTS, RESULT, candidates, goal="best")


# ---- brute force: the information itself, in SI and without scaling ------------------------------------------------
def information(tests, result):
    """The inverse of the covariance that plain least squares gives, one row a reading."""
    J_v = rm.geometric_jacobian(ROBOT, tests.theta)[:, :3]
    A = (J_v * np.einsum("mci,mc->mi", J_v, tests.wrench[:, :3])[:, None, :]).reshape(-1, 5)
    return A.T @ A / result.noise**2


def brute(candidates, result, goodness, count):
    """Greedy choice of the candidates whose added rows make ``goodness`` of the covariance smallest."""
    M, left, picked = information(TESTS, result), list(range(len(candidates.F))), []
    J_v = rm.geometric_jacobian(ROBOT, candidates.theta)[:, :3]
    rows = J_v * np.einsum("mci,mc->mi", J_v, candidates.F)[:, None, :] / result.noise
    scale = np.sqrt(np.diag(M))
    for _ in range(count):
        value = []
        for k in left:
            N = (M + rows[k].T @ rows[k]) / np.outer(scale, scale)
            value.append(goodness(np.linalg.inv(N) / np.outer(scale, scale)))
        best = left.pop(int(np.argmin(value)))
        picked.append(best)
        M = M + rows[best].T @ rows[best]
    P = np.linalg.inv(M / np.outer(scale, scale)) / np.outer(scale, scale)
    return picked, P


PATH_THETA = rm.inverse_kinematics(ROBOT, rm.pose_from_world([[x, -1.3, 0, 0.1, 0] for x in (-0.2, 0.0, 0.2)])).theta
PATH = Loads(PATH_THETA, np.array([[0, 100.0, 0], [20.0, 80.0, -10], [0, 100.0, 30.0]]))


def path_variance(P):
    J_v = rm.geometric_jacobian(ROBOT, PATH.theta)[:, :3]
    D = J_v * np.einsum("mci,mc->mi", J_v, PATH.F)[:, None, :]
    return np.mean([np.trace(d @ P @ d.T) for d in D])


@pytest.mark.parametrize(
    ("goal", "goodness"),
    [
        ("all", lambda P: np.linalg.slogdet(P * 1e14)[1]),
        (2, lambda P: P[1, 1]),
        (4, lambda P: P[3, 3]),
        (PATH, path_variance),
    ],
    ids=["all", "joint 2", "joint 4", "path"],
)
@pytest.mark.parametrize("seed", [1, 2])
def test_plans_are_those_of_brute_force(goal, goodness, seed):
    candidates = box_candidates(ROBOT, *BOX, poses=25, seed=seed)
    plan = next_best(ROBOT, TESTS, RESULT, candidates, goal=goal)
    picked, P = brute(candidates, RESULT, goodness, 3)
    np.testing.assert_array_equal(plan.theta, candidates.theta[picked])
    np.testing.assert_array_equal(plan.F, candidates.F[picked])
    np.testing.assert_allclose(plan.after, np.sqrt(np.diag(P)), rtol=1e-4)
    np.testing.assert_allclose(plan.before, RESULT.stderr, rtol=1e-6)
    np.testing.assert_allclose(plan.half_before, stats.t.ppf(0.975, 76) * RESULT.stderr, rtol=1e-6)
    np.testing.assert_allclose(plan.half_after, stats.t.ppf(0.975, 76 + 9) * np.sqrt(np.diag(P)), rtol=1e-4)
    np.testing.assert_allclose(plan.x_M, rm.world_from_pose(rm.tool_pose(ROBOT, plan.theta)))
    if goal is PATH:
        assert plan.path_after == pytest.approx(np.sqrt(path_variance(P)), rel=1e-4)
        assert plan.path_before == pytest.approx(np.sqrt(path_variance(RESULT.covariance)), rel=1e-6)
        assert plan.goal == "this path's deviation"
    else:
        assert np.isnan(plan.path_before)
        assert np.isnan(plan.path_after)


def test_rows_and_sentence_are_the_gain_of_the_intervals():
    plan = next_best(ROBOT, TESTS, RESULT, box_candidates(ROBOT, *BOX, poses=25), goal=4)
    gain = 1 - plan.half_after / plan.half_before
    assert plan.goal == "joint 4"
    rows = plan.rows()
    np.testing.assert_allclose([row["gain"] for row in rows], gain)
    np.testing.assert_array_equal([row["stderr_after"] for row in rows], plan.after)
    np.testing.assert_array_equal([row["half_before"] for row in rows], plan.half_before)
    best = int(np.argmax(gain))
    promise = f"3 more tests should narrow the interval of joint {best + 1} by {100 * gain[best]:.0f} %."
    assert promise in plan.sentence()
    known = replace(plan, half_before=np.where(np.arange(5) == best, 0.0, plan.half_before))
    assert known.rows()[best]["gain"] == 0.0
    assert f"joint {best + 1} " not in known.sentence()
    unknown = replace(plan, half_before=np.where(np.arange(5) == 1, np.inf, plan.half_before))
    assert "interval of joint 2 by 100 %" in unknown.sentence()
    aimed = replace(plan, path_before=3.2e-6, path_after=1.1e-6)
    assert "from ±3.2 µm to ±1.1 µm (one standard deviation)." in aimed.sentence()
    sheet = plan.as_tests()
    np.testing.assert_array_equal(sheet.wrench[:, :3], plan.F)
    np.testing.assert_array_equal(sheet.theta, plan.theta)
    assert not sheet.displacement[:, :3].any()


def test_candidates_fill_the_box_and_are_loaded_three_ways():
    low, high = np.array([-0.1, -1.4, -0.05]), np.array([0.1, -1.2, 0.05])
    found = box_candidates(ROBOT, low, high)
    assert len(found.F) == 3 * 300, "all of this box is in reach"
    np.testing.assert_array_equal(found.F[:3], 250.0 * np.eye(3))
    x_M = rm.world_from_pose(rm.tool_pose(ROBOT, found.theta))
    for i, (a, b) in enumerate(zip([*low, -np.pi / 6, -np.pi / 6], [*high, np.pi / 6, np.pi / 6], strict=True)):
        assert a - 1e-9 <= x_M[:, i].min() < a + 0.02 * (b - a)
        assert b - 0.02 * (b - a) < x_M[:, i].max() <= b + 1e-9
    assert len(box_candidates(ROBOT, low, low, tilt=0.0, poses=4).F) == 12
    with pytest.raises(LoadTestError, match="upper corner"):
        box_candidates(ROBOT, low, high, tilt=-0.1)


def test_noise_and_what_is_counted_with_another_shape_a_plan():
    stated = replace(TESTS, noise=np.where(np.arange(27) % 2, 2e-6, 8e-6))
    result = identify(ROBOT, stated)
    candidates = box_candidates(ROBOT, *BOX, poses=25)
    plan = next_best(ROBOT, stated, result, candidates, count=1)
    np.testing.assert_allclose(plan.before, result.stderr, rtol=1e-6)
    for bad in (0.0, float("nan")):
        with pytest.raises(LoadTestError, match="noise is not known"):
            next_best(ROBOT, TESTS, replace(RESULT, noise=bad), candidates)
    tilted = rm.read_load_tests(samples_dir() / "load_tests" / "tilted_bending_tool.csv")
    rich = identify(ROBOT, tilted, "joints+bending+tool")
    (lumped,) = rich.lumped
    k = [p.label for p in rich.labels].index(lumped)
    planned = next_best(ROBOT, tilted, rich, candidates, count=2)
    live = np.arange(len(rich.labels)) != k
    assert (planned.after[live] < planned.before[live]).all()
    with pytest.raises(LoadTestError, match="no point of the path"):
        next_best(ROBOT, TESTS, RESULT, candidates, goal=Loads(np.full((2, 5), np.nan), PATH.F[:2]))
    holes = Loads(np.vstack([PATH.theta, np.full((1, 5), np.nan)]), np.vstack([PATH.F, PATH.F[:1]]))
    with_holes, whole = (next_best(ROBOT, TESTS, RESULT, candidates, goal=g) for g in (holes, PATH))
    assert with_holes.path_after == whole.path_after


@pytest.mark.parametrize("tilt", [0.1, np.pi / 6])
def test_candidates_around_the_tests_fill_their_box_and_its_margin(tilt):
    tips = rm.tool_pose(ROBOT, TESTS.with_joints(ROBOT).theta)[:, :3, 3]
    found = candidates_around(ROBOT, TESTS, tilt=tilt, load=40.0)
    x_M = rm.world_from_pose(rm.tool_pose(ROBOT, found.theta))
    low, high = tips.min(axis=0) - MARGIN, tips.max(axis=0) + MARGIN
    assert ((x_M[:, :3] >= low - 1e-9) & (x_M[:, :3] <= high + 1e-9)).all()
    assert (np.abs(x_M[:, 3:]) <= tilt + 1e-9).all()
    assert (x_M[:, :3].min(axis=0) < tips.min(axis=0)).all(), "into the margin"
    assert (x_M[:, :3].max(axis=0) > tips.max(axis=0)).all()
    assert np.abs(x_M[:, 3:]).max() > 0.9 * tilt
    np.testing.assert_allclose(np.linalg.norm(found.F, axis=1), 40.0)


def test_the_usual_candidates_tilt_by_thirty_degrees():
    for found in (candidates_around(ROBOT, TESTS), box_candidates(ROBOT, *BOX)):
        tilts = np.abs(rm.world_from_pose(rm.tool_pose(ROBOT, found.theta))[:, 3:])
        assert np.radians(29.0) < tilts.max() <= np.radians(30.0) + 1e-9
