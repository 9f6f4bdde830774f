"""The estimate against truths that are known: exactness, robustness, what cannot be seen, refusals, the report."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.optimize import nnls

import robomill as rm
from robomill.compliance.spring import extra_contributions
from robomill.compliance.springs.joint_bending import JointBending
from robomill.compliance.springs.spindle import SpindleSpring
from robomill.errors import LoadTestError
from robomill.identification.fit.estimate import identify
from robomill.identification.fit.models import MODELS, Model
from robomill.identification.fit.system import build_system
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.record import identification_report
from robomill.identification.synthesis import three_directions
from robomill.kinematics.forward import joint_frames, tool_pose
from tests.identification.fit.arms import ROBOT, nine_points, poses
from tests.identification.synthetic import simulated_tests, true_parameters

EXTRA = {"tool across": 4e-8, "tool along": 1e-8, "bending x at joint 2": 6e-7, "bending y at joint 3": 8e-7}


# ---- exactness
@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500", "fanuc_r2000ic"])
def test_noise_free_tests_return_the_truth(name):
    robot = rm.load_robot(name)
    tests = simulated_tests(robot, *three_directions(poses(robot, 12), 250.0))
    result = identify(robot, tests)
    seen = np.isfinite(result.C_theta)
    np.testing.assert_allclose(result.C_theta[seen], robot.C_theta[seen], rtol=1e-10)
    assert result.cv_relative_error < 1e-10
    assert result.outliers == ()
    # The KR500 has its tool tip on axis 6: a force there cannot turn that joint.
    assert [u.joint for u in result.unseen_joints] == ([6] if name == "kuka_kr500" else [])


@pytest.mark.parametrize(("count", "spare"), [(2, 0), (3, 3)])
def test_readings_that_are_all_needed_say_nothing_of_their_noise(count, spare):
    """Two rows of three readings for six springs fit exactly, however large the noise is."""
    robot = rm.load_robot("fanuc_r2000ic")
    theta, F = poses(robot, count), 200.0 * np.random.default_rng(1).standard_normal((count, 3))
    result = identify(robot, simulated_tests(robot, theta, F, noise=1e-5))
    assert result.dof == spare
    assert np.isnan(result.noise) == (spare == 0)


@pytest.mark.parametrize("model", [m for m in MODELS if m != "constant"])
def test_noise_free_extra_springs_are_found(model):
    choice = Model(model)
    labels = {p.label for p in choice.parameters(ROBOT)}
    extra = {label: value for label, value in EXTRA.items() if label in labels}
    tests = simulated_tests(ROBOT, *three_directions(poses(ROBOT, 20), 250.0), model=choice, extra=extra)
    result = identify(ROBOT, tests, model)
    truth = true_parameters(ROBOT, choice, extra)
    np.testing.assert_allclose(result.parameters, truth, rtol=1e-9, atol=1e-9 * truth.max())


def test_the_constant_model_returns_its_own_truth():
    C = np.array([[2.0, 0.3, -0.2], [0.3, 2.2, -1.0], [-0.2, -1.0, 3.0]]) * 1e-6
    F = np.eye(3) * 100.0
    tests = LoadTests(F, F @ C, theta=poses(ROBOT, 3))
    result = identify(ROBOT, tests, "constant")
    np.testing.assert_allclose(Model("constant").compliance(ROBOT, np.zeros(5), result.parameters), C, rtol=1e-12)
    assert np.isnan(result.C_theta).all()


def test_regressor_is_what_twisted_joints_do():
    """Oracle: twist each joint by C tau (tau by virtual work, numerically), move the arm, watch the gauge's point."""
    rng = np.random.default_rng(3)
    theta, wrench = poses(ROBOT, 6, 4), rng.normal(size=(6, 6)) * 50
    force_point, gauge = rng.normal(size=(2, 3)) * 0.05
    tests = LoadTests(wrench, np.ones((6, 6)), theta=theta, force_point=force_point, measuring_point=gauge)
    predicted = Model().terms(ROBOT, tests)[:, :, 0] @ ROBOT.C_theta
    step = 1e-6

    def twist(q, point):
        """(6, n) motion of a point fixed in {T}, numerically."""
        columns = []
        for i in range(ROBOT.n):
            e = np.eye(ROBOT.n)[i] * step
            high, low = tool_pose(ROBOT, q + e), tool_pose(ROBOT, q - e)
            v = ((high - low)[:3, 3] + (high - low)[:3, :3] @ point) / (2 * step)
            W = (high - low)[:3, :3] @ tool_pose(ROBOT, q)[:3, :3].T / (2 * step)
            columns.append([*v, W[2, 1], W[0, 2], W[1, 0]])
        return np.array(columns).T

    for k in range(6):
        tau = twist(theta[k], force_point).T @ wrench[k]
        moved = twist(theta[k], gauge) @ (ROBOT.C_theta * tau)
        np.testing.assert_allclose(predicted[k], moved, rtol=1e-6, atol=1e-10)


def test_model_agrees_with_the_springs_of_the_simulation():
    choice = Model("joints+bending+tool")
    theta = poses(ROBOT, 5)
    springs = (JointBending(2, 6e-7, 2e-7), JointBending(3, 1e-7, 8e-7), SpindleSpring(4e-8, 1e-8))
    given = np.concatenate([ROBOT.C_theta, [6e-7, 2e-7, 1e-7, 8e-7, 4e-8, 1e-8]])
    C = rm.cartesian_compliance(ROBOT, theta) + extra_contributions(springs, joint_frames(ROBOT, theta)).sum(axis=-3)
    np.testing.assert_allclose(choice.compliance(ROBOT, theta, given), C, rtol=1e-12, atol=1e-20)


def test_springs_of_a_result_can_be_simulated():
    choice = Model("joints+bending+tool")
    theta = poses(ROBOT, 20)
    tests = simulated_tests(ROBOT, *three_directions(theta, 250.0), model=choice, extra=EXTRA)
    result = identify(ROBOT, tests, choice.name)
    arm = result.applied_to(ROBOT)
    C = rm.cartesian_compliance(arm, theta) + extra_contributions(result.springs(arm), joint_frames(arm, theta)).sum(-3)
    np.testing.assert_allclose(C, choice.compliance(ROBOT, theta, true_parameters(ROBOT, choice, EXTRA)), rtol=1e-7)
    assert arm.compliance_set == "identified"
    assert arm.provenance["compliance.identified"].kind == tests.provenance.kind == "synthetic"


# ---- what cannot be seen
def test_a_joint_no_test_moves_is_named_and_nan():
    theta = nine_points()
    F = np.tile([0.0, 0.0, -250.0], (9, 1))  # vertical force: joint 1 turns about the vertical
    result = identify(ROBOT, simulated_tests(ROBOT, theta, F, noise=1e-7))
    assert np.isnan(result.C_theta[0])
    assert np.isinf(result.stderr[0])
    first = result.unseen_joints[0]
    assert first.joint == 1
    assert first.confused_with == ()
    assert "cannot be seen" in first.sentence
    kept = result.applied_to(ROBOT)
    assert kept.C_theta[0] == ROBOT.C_theta[0]


def test_joints_with_one_effect_are_named_as_confused():
    """Prediction of the measured loads stays right; only the split between the two is lost."""
    robot = rm.load_robot("planar_2r")
    theta = np.array([[0.3, 0.0], [0.8, 0.0]])  # stretched: both joints push the tip along the same line
    F = np.stack([100.0 * np.array([-np.sin(t), np.cos(t), 0.0]) for t in theta[:, 0]])
    result = identify(robot, simulated_tests(robot, theta, F))
    assert [u.joint for u in result.unseen_joints] == [1, 2]
    assert result.unseen_joints[0].confused_with == ("joint 2",)
    assert np.nanmax(np.abs(result.residual)) < 1e-12
    assert identification_report(result)["C_theta"] == [None, None]


def test_a_spring_that_moves_as_a_joint_does_is_counted_with_it():
    """Bending of joint 2 about y turns about the axis of joint 1 in the paper's arm: no test can part the two."""
    extra = {"bending y at joint 2": 3e-7}
    choice = Model("joints+bending")
    tests = simulated_tests(ROBOT, *three_directions(poses(ROBOT, 20), 250.0), model=choice, extra=extra)
    result = identify(ROBOT, tests, "joints+bending")
    assert result.lumped == {"bending y at joint 2": "joint 1"}
    assert result.C_theta[0] == pytest.approx(ROBOT.C_theta[0] + 3e-7, rel=1e-9)
    assert np.isfinite(result.condition.after)


# ---- rows that do not belong
def test_outliers_are_flagged_with_their_row_and_left_out_on_request():
    theta, F = three_directions(poses(ROBOT, 20, 1), 250.0)
    tests = simulated_tests(ROBOT, theta, F, noise=4e-6, seed=3)
    moved = tests.displacement[:, :3].copy()
    moved[[6, 7, 30], 1] += [2e-3, 2e-3, -1e-3]
    bad = LoadTests(F, moved, theta=theta, row=np.arange(60) + 100)
    result = identify(ROBOT, bad)
    flagged = {outlier.row for outlier in result.outliers}
    assert flagged == {106, 107, 130}
    again = identify(ROBOT, bad, exclude=flagged)
    assert again.excluded == (106, 107, 130)
    assert again.outliers == ()
    assert ((again.ci95[:, 0] <= ROBOT.C_theta) & (ROBOT.C_theta <= again.ci95[:, 1])).all()
    robust = identify(ROBOT, bad, robust=True)
    np.testing.assert_allclose(robust.C_theta, again.C_theta, atol=1.0 * again.stderr.max())
    assert robust.cv_relative_error < 2 * again.cv_relative_error  # the gross rows are not held against the model
    assert np.abs(result.C_theta - ROBOT.C_theta).max() > 10 * np.abs(robust.C_theta - ROBOT.C_theta).max()


def test_good_data_have_no_outliers():
    theta, F = three_directions(nine_points(), 250.0)
    alarms = sum(
        bool(identify(ROBOT, simulated_tests(ROBOT, theta, F, noise=4e-6, seed=s)).outliers) for s in range(150)
    )
    assert alarms <= 6  # one data set in a hundred is meant to raise an alarm


# ---- cross-validation
def test_cross_validation_is_leaving_poses_out():
    theta, F = three_directions(nine_points(), 250.0)
    tests = simulated_tests(ROBOT, theta, F, noise=3e-5, seed=1)
    result = identify(ROBOT, tests)
    system = build_system(ROBOT, tests, Model())
    errors = []
    for pose in range(9):
        out = system.pose == pose
        x = nnls(system.A[~out] * 1e6, system.b[~out] * 1e6)[0]
        errors.append(np.linalg.norm(system.A[out] @ x - system.b[out]) / np.linalg.norm(system.b[out]))
    assert result.cv_relative_error == pytest.approx(np.mean(errors))
    assert result.cv_relative_error > result.in_sample_by_pose.mean()


def test_single_joint_tests_are_the_mean_ratio():
    rng = np.random.default_rng(0)
    joint, torque = np.repeat(np.arange(1, 6), 4), np.tile([-200.0, -100.0, 100.0, 300.0], 5)
    angle = ROBOT.C_theta[joint - 1] * torque + 1e-6 * rng.standard_normal(20)
    result = identify(ROBOT, JointTests(joint, torque, angle))
    for i in range(5):
        mine = joint == i + 1
        assert result.C_theta[i] == pytest.approx(angle[mine] @ torque[mine] / (torque[mine] @ torque[mine]))
    assert identification_report(result)["residual_rms_mm"] is None
    with pytest.raises(LoadTestError, match="joints"):
        identify(ROBOT, JointTests(joint, torque, angle), "joints+tool")


# ---- refusals, size, report
@pytest.mark.parametrize(
    ("theta", "F", "model", "words"),
    [
        (np.zeros((1, 5)), np.ones((1, 3)), "joints", "3 measured numbers for 5 unknown"),
        (np.zeros((4, 5)), np.eye(4, 3) + 1, "joints", "one pose"),
        (np.full((4, 5), 3.0), np.ones((4, 3)), "joints", "Row 1, theta1: .* outside joint 1's limits"),
        (np.zeros((4, 4)), np.ones((4, 3)), "joints", "4 joint columns for a robot of 5"),
        (np.zeros((4, 5)), np.ones((4, 3)), "springs", "expected one of joints"),
    ],
)
def test_refusals(theta, F, model, words):
    with pytest.raises(LoadTestError, match=words):
        identify(ROBOT, LoadTests(F, np.ones_like(F) * 1e-4, theta=theta), model)


def test_more_refusals():
    tests = simulated_tests(ROBOT, *three_directions(poses(ROBOT, 4), 250.0))
    with pytest.raises(LoadTestError, match="no such row"):
        identify(ROBOT, tests, exclude=[99])
    with pytest.raises(LoadTestError, match="no test at all"):
        identify(ROBOT, tests, exclude=range(1, 13))
    with pytest.raises(LoadTestError, match="free joints"):
        identify(ROBOT, tests, "joints+bending", bending=(7,))
    with pytest.raises(LoadTestError, match="Row 3: the force is zero"):
        LoadTests(np.array([[1.0, 0, 0], [1, 0, 0], [0, 0, 0]]), np.ones((3, 3)), theta=np.zeros((3, 5)))
    with pytest.raises(LoadTestError, match="NaN"):
        LoadTests(np.array([[np.nan, 0, 0]]), np.ones((1, 3)), theta=np.zeros((1, 5)))


def test_a_pose_that_is_not_reached_is_named():
    x_M = np.array([[0, -1.3, 0, 0, 0], [0, -9.0, 0, 0, 0]])
    with pytest.raises(LoadTestError, match="Row 2: the pose .* is not reached"):
        identify(ROBOT, LoadTests(np.ones((2, 3)), np.ones((2, 3)) * 1e-5, x_M=x_M))


def test_a_hundred_thousand_rows_find_the_arm():
    theta = poses(ROBOT, 100_000)
    F = np.random.default_rng(1).normal(size=(100_000, 3)) * 100
    tests = simulated_tests(ROBOT, theta, F, noise=1e-5)
    np.testing.assert_allclose(identify(ROBOT, tests).C_theta, ROBOT.C_theta, rtol=1e-3)


def test_report_has_the_agreed_keys_and_is_json():
    result = identify(ROBOT, simulated_tests(ROBOT, *three_directions(nine_points(), 250.0), noise=4e-6))
    report = json.loads(json.dumps(identification_report(result), allow_nan=False))
    assert set(report) >= {
        "C_theta",
        "stderr",
        "ci95",
        "correlation",
        "condition",
        "condition_before_scaling",
        "residual_rms_mm",
        "cv_relative_error",
        "outliers",
        "unseen_joints",
        "model",
    }
    assert len(report["C_theta"]) == 5
    assert np.shape(report["ci95"]) == (5, 2)
    assert report["residual_rms_mm"] == pytest.approx(4e-3, rel=0.3)


def test_tests_are_values():
    tests = simulated_tests(ROBOT, *three_directions(poses(ROBOT, 3), 250.0))
    with pytest.raises(ValueError, match="read-only"):
        tests.wrench[0, 0] = 1.0
    assert len(tests.joined(tests)) == 18
    assert len(tests.select(tests.wrench[:, 0] > 0)) == 3
    assert (tests.joined(tests).pose_index()[:9] == tests.joined(tests).pose_index()[9:]).all()


def test_rows_to_leave_out_are_numbers() -> None:
    """A text was taken letter by letter: "2,3" asked for a row named ","."""
    robot = rm.load_robot("slavkovic_5r")
    tests = rm.read_load_tests("nine_points", robot)
    for wrong in ("2,3", 99, [1.5]):
        with pytest.raises(rm.RobomillError, match=r"exclude: found .*, expected numbers of rows, e\.g\. \[2, 3\]"):
            rm.identify(robot, tests, exclude=wrong)
