"""Next-best tests: what they promise must come true when they are measured."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.estimate import identify
from robomill.identification.plan import PathLoad, _best, box_candidates, next_best
from robomill.identification.synthesis import simulated_tests
from robomill.io.load_test_sheets import measuring_sheet
from robomill.io.samples import samples_dir

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
    path = PathLoad(theta, np.tile([0.0, 100.0, 0.0], (11, 1)))
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
