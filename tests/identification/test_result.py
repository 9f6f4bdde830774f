"""What a result says: read off its own parameters by other means."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import robomill as rm
from robomill.compliance.springs.joint_bending import JointBending
from robomill.compliance.springs.spindle import SpindleSpring
from robomill.errors import LoadTestError
from robomill.identification.load_test import LoadTests
from robomill.identification.record import identification_report
from robomill.identification.synthesis import three_directions
from robomill.provenance import Provenance
from tests.identification.synthetic import simulated_tests

ROBOT = rm.load_robot("slavkovic_5r").with_compliance_set("table_3")
THETA = np.random.default_rng(0).uniform(ROBOT.limits[:, 0], ROBOT.limits[:, 1], (15, 5))
TESTS = simulated_tests(ROBOT, *three_directions(THETA, 250.0), noise=4e-6)
RESULT = rm.identify(ROBOT, TESTS)


def test_joints_are_the_first_parameters():
    rich = rm.identify(ROBOT, TESTS, "joints+tool")
    np.testing.assert_array_equal(rich.C_theta, rich.parameters[:5])
    np.testing.assert_array_equal(rich.stderr, rich.parameter_stderr[:5])
    np.testing.assert_array_equal(rich.ci95, rich.parameter_ci95[:5])
    blind = replace(rich, parameter_stderr=np.where(np.arange(7) == 2, np.inf, rich.parameter_stderr))
    np.testing.assert_array_equal(np.isnan(blind.C_theta), np.arange(5) == 2)
    constant = rm.identify(ROBOT, TESTS, "constant")
    assert np.isnan(constant.C_theta).all()
    assert np.isinf(constant.stderr).all()
    assert constant.ci95.shape == (5, 2)
    assert np.isnan(constant.ci95).all()
    for refused in (lambda: constant.weakest_joint, lambda: constant.applied_to(ROBOT)):
        with pytest.raises(LoadTestError, match="constant model"):
            refused()


def test_the_weakest_joint_has_the_widest_interval_for_its_size():
    relative = RESULT.stderr / RESULT.C_theta
    assert RESULT.weakest_joint == 1 + int(np.argmax(relative))
    held = replace(RESULT, parameters=np.where(np.arange(5) == 1, 0.0, RESULT.parameters))
    assert held.weakest_joint == 2
    assert RESULT.explain(RESULT.weakest_joint) == RESULT.explanations[RESULT.weakest_joint - 1]
    with pytest.raises(LoadTestError, match="Joint 9"):
        RESULT.explain(9)


def test_springs_are_those_of_the_parameters():
    rich = rm.identify(ROBOT, TESTS, "joints+bending+tool")
    values = np.array([*RESULT.C_theta, 1e-7, 0, 0, 2e-7, 3e-8, 4e-8])
    made = replace(rich, parameters=values).springs(ROBOT)
    assert [type(s) for s in made] == [JointBending, JointBending, SpindleSpring]
    assert [(s.joint, s.C_x, s.C_y) for s in made[:2]] == [(2, 1e-7, 0.0), (3, 0.0, 2e-7)]
    assert (made[2].lateral, made[2].axial) == (3e-8, 4e-8)
    for across, along in ((3e-8, 0.0), (0.0, 4e-8)):
        (one,) = replace(rich, parameters=np.array([*RESULT.C_theta, 0, 0, 0, 0, across, along])).springs(ROBOT)
        assert (one.lateral, one.axial) == (across, along)
    assert RESULT.springs(ROBOT) == ()
    with_axis_1_blocked = ROBOT.replace(blocked=np.array([0.0, np.nan, np.nan, np.nan, np.nan]))
    shifted = replace(rich, parameters=values).springs(with_axis_1_blocked)
    assert [s.joint for s in shifted[:2]] == [1, 2], "springs count the free joints, labels the robot's own numbers"


def test_joints_that_were_not_seen_keep_the_robots_own_values():
    soft = ROBOT.replace(C_theta=ROBOT.C_theta * 2)
    blind = replace(RESULT, parameter_stderr=np.where(np.arange(5) == 2, np.inf, RESULT.parameter_stderr))
    arm = blind.applied_to(soft)
    np.testing.assert_array_equal(arm.C_theta, np.where(np.arange(5) == 2, soft.C_theta, RESULT.parameters))
    assert arm.compliance_set == "identified"
    np.testing.assert_array_equal(arm.compliance_sets["identified"], arm.C_theta)
    assert "joint 3 not seen" in arm.provenance["compliance.identified"].source
    assert "not seen" not in RESULT.applied_to(soft).provenance["compliance.identified"].source
    assert set(ROBOT.compliance_sets) < set(arm.compliance_sets)


def test_residuals_are_measured_minus_predicted():
    predicted = np.einsum(
        "mij,mj->mi", rm.cartesian_compliance(RESULT.applied_to(ROBOT), TESTS.theta), TESTS.wrench[:, :3]
    )
    left = TESTS.displacement[:, :3] - predicted
    np.testing.assert_allclose(RESULT.residual, left, atol=1e-15)
    assert RESULT.residual_rms == pytest.approx(np.sqrt(np.mean(left**2)))
    assert RESULT.noise == pytest.approx(np.sqrt((left**2).sum() / (left.size - 5)))
    share = np.linalg.norm(left, axis=1) / np.linalg.norm(TESTS.displacement[:, :3], axis=1)
    np.testing.assert_allclose(RESULT.residual_share, share)
    assert (RESULT.equations, RESULT.dof) == (135, 130)


def test_the_report_is_the_result_in_plain_numbers():
    report = identification_report(RESULT)
    np.testing.assert_array_equal(report["C_theta"], RESULT.C_theta)
    np.testing.assert_array_equal(report["ci95"], RESULT.ci95)
    np.testing.assert_array_equal(report["correlation"], RESULT.correlation)
    assert report["residual_rms_mm"] == pytest.approx(RESULT.residual_rms * 1e3)
    assert report["condition"] == pytest.approx(RESULT.condition[1])
    assert report["condition_before_scaling"] == pytest.approx(RESULT.condition[0])
    down = LoadTests(np.tile([0, 0, -250.0], (15, 1)), TESTS.displacement[2::3, :3], theta=THETA)
    assert identification_report(rm.identify(ROBOT, down))["C_theta"][0] is None


def test_half_an_interval_is_a_share_of_the_value_where_both_are_known():
    values = np.array([2e-7, 0.0, 5e-7, 4e-7, 1e-7])
    ends = np.array([[1e-7, 3e-7], [0.0, 1e-7], [0.0, np.inf], [3e-7, 6e-7], [0.5e-7, 2e-7]])
    stderr = np.where(np.arange(5) == 2, np.inf, 1e-8)
    found = replace(RESULT, parameters=values, parameter_ci95=ends, parameter_stderr=stderr).relative_half
    np.testing.assert_allclose(found, [0.5, np.inf, np.inf, 0.375, 0.75])


def test_springs_found_take_the_place_of_others_and_of_what_was_found_earlier():
    rich = rm.identify(ROBOT, TESTS, "joints+bending+tool")
    found = replace(rich, parameters=np.array([*RESULT.C_theta, 1e-7, 2e-7, 0, 0, 0, 0]))  # bending at joint 2 alone
    by_hand = [JointBending(2, 9e-7, 9e-7, Provenance("user", "typed")), SpindleSpring(1e-8)]
    measured = [JointBending(3, 1e-7, 1e-7, Provenance("measured", "before"))]
    made_up = [JointBending(4, 1e-7, 1e-7, Provenance("synthetic", "before"))]
    given = [*by_hand, *measured, *made_up]
    robot, springs = found.adopted(ROBOT, "mine.csv", ROBOT, given)
    assert [*springs] == [by_hand[1], *measured, *made_up, *found.springs(ROBOT)]
    np.testing.assert_array_equal(robot.C_theta, found.applied_to(ROBOT).C_theta)
    assert robot.provenance["compliance.identified"].kind == "synthetic"  # as the tests are
    real = replace(found, kind="measured").adopted(ROBOT, "mine.csv", ROBOT, ())[0]
    assert real.provenance["compliance.identified"].kind == "computed"
    _, springs = found.adopted(ROBOT, "mine.csv", robot, given)  # once more, beside what was identified
    assert [*springs] == [by_hand[1], *found.springs(ROBOT)]


def test_a_row_of_the_table_is_a_parameter_in_the_unit_that_it_names():
    """1e-7 rad/(N m) of joints, and whatever else springs have; what is not seen is NaN with an infinite error."""
    rich = rm.identify(ROBOT, TESTS, "joints+bending+tool")
    blind = replace(rich, parameter_stderr=np.where(np.arange(11) == 2, np.inf, rich.parameter_stderr))
    table = blind.columns()
    assert len(table["parameter"]) == 11
    factor = {"1e-7 rad/(N m)": 1e7, "um/N": 1e6, "1e-7 m/N": 1e7}
    for n, (unit, value, error) in enumerate(zip(table["unit"], rich.parameters, blind.parameter_stderr, strict=True)):
        shown = [table[name][n] for name in ("value", "stderr", "ci95_low", "ci95_high")]
        true = np.array([value if n != 2 else np.nan, error, *rich.parameter_ci95[n]]) * factor[unit]
        np.testing.assert_allclose(shown, true, rtol=1e-12)
    np.testing.assert_allclose(table["share_percent"], 100.0 * rich.share)
    assert table["unit"][:5].tolist() == ["1e-7 rad/(N m)"] * 5
    assert "not seen" in repr(blind)
    assert "not seen" not in repr(rich)


@pytest.mark.parametrize("name", ["kuka_kr500", "planar_2r"])
def test_compliances_are_given_to_no_arm_of_another_number_of_joints(name):
    with pytest.raises(LoadTestError, match=r"5 joints.*has [26]"):
        RESULT.applied_to(rm.load_robot(name))


def frame_of(poses=((-0.4, -1.5), (0.0, -1.3), (0.4, -1.1), (0.3, -1.5), (-0.3, -1.1))):
    """A table with what ``delta = C F`` gives to the last digit, as somebody tries the library with."""
    rows = []
    for X, Y in poses:
        theta = rm.inverse_kinematics(ROBOT, rm.pose_from_world([X, Y, 0.0, 0.0, 0.0])).theta
        C = rm.cartesian_compliance(ROBOT, theta)
        rows += [[X * 1e3, Y * 1e3, 0, 0, 0, *F, *(C @ F * 1e3)] for F in 250.0 * np.eye(3)]
    names = ["X_mm", "Y_mm", "Z_mm", "A_deg", "B_deg", "Fx_N", "Fy_N", "Fz_N", "dx_mm", "dy_mm", "dz_mm"]
    return pd.DataFrame(rows, columns=names)


def test_readings_that_are_right_to_the_last_digit_leave_no_doubt():
    """What is left over is rounding, of which an F-test made that something was missing from the model."""
    for scale in (1.0, 1e-3, 1e3):
        readings = frame_of()
        readings[["dx_mm", "dy_mm", "dz_mm"]] *= scale
        found = rm.identify(ROBOT, readings)
        np.testing.assert_allclose(found.C_theta, ROBOT.C_theta * scale, rtol=1e-9)
        assert "model-misses" not in {each.code for each in found.findings}
    assert "in doubt" not in repr(rm.identify(ROBOT, frame_of()))


def test_a_row_is_named_once_and_no_farther_off_than_anybody_can_read():
    readings = frame_of()
    readings.loc[4, ["dx_mm", "dy_mm", "dz_mm"]] *= -1.0
    readings = pd.concat([readings, readings.iloc[[2]]], ignore_index=True)
    told = {each.code: each.sentence for each in rm.identify(ROBOT, readings).findings}
    assert told["repeat"].startswith("Row 15 repeats row 2")
    assert "row 4 (more than 1000 times the usual scatter" in told["outliers"]
    assert not told["outliers"].startswith("Line")
