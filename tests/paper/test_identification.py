"""Section 5 of the paper: 81 equations from nine points, Table 3, and the two methods side by side."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import curve_fit

import robomill as rm
from robomill.identification.fit.estimate import identify
from robomill.identification.fit.system import build_system
from robomill.identification.knowledge import Knowledge
from robomill.identification.propagation import uncertain_deflection
from robomill.io.measured.load_tests import read_measured_map
from robomill.io.samples import samples_dir

FILES = samples_dir() / "load_tests"
ROBOT = rm.load_robot("slavkovic_5r")
TABLE_2, TABLE_3 = (ROBOT.with_compliance_set(name).C_theta for name in ("table_2", "table_3"))


@pytest.fixture(scope="module")
def tests():
    return rm.read_load_tests(FILES / "nine_points.csv")


@pytest.fixture(scope="module")
def result(tests):
    return identify(ROBOT, tests)


def test_the_nine_points_make_81_equations(tests, result):
    assert len(np.unique(tests.pose_index())) == 9
    assert result.equations == 81
    p = tests.tool_poses(ROBOT)[:, :3, 3]
    np.testing.assert_allclose(p[:, 2], 0.0, atol=1e-7)  # the plane Z_M = 0
    np.testing.assert_allclose(np.linalg.norm(tests.wrench[:, :3], axis=1), 250.0)


def test_table_3_lies_inside_the_intervals(result):
    assert ((result.ci95[:, 0] <= TABLE_3) & (TABLE_3 <= result.ci95[:, 1])).all(), result.ci95 * 1e7
    assert result.cv_relative_error < 0.02


def test_the_papers_general_curve_fit_comes_to_the_same(tests, result):
    """The paper used Matlab's lsqcurvefit; scipy's trust-region twin gives the same values and covariance, slower."""
    system = build_system(ROBOT, tests, result.choice)
    scale = 1e-7
    found, covariance = curve_fit(
        lambda A, *c: A @ (np.array(c) * scale),
        system.A,
        system.b,
        p0=np.full(5, 10.0),
        bounds=(0, np.inf),
        ftol=1e-14,
        xtol=1e-14,
        gtol=1e-14,
    )
    np.testing.assert_allclose(found * scale, result.C_theta, rtol=1e-6)
    np.testing.assert_allclose(np.sqrt(np.diag(covariance)) * scale, result.stderr, rtol=1e-4)


def test_joint_4_is_known_least_and_the_sentence_says_why(result):
    """With the tool vertical and its tip in the plane of the shoulder, joint 4 moves the tip much as joint 1 does."""
    relative = np.ptp(result.ci95, axis=1) / TABLE_3
    assert result.weakest_joint == 4
    assert relative[3] > 5 * np.delete(relative, 3).max()
    assert abs(result.correlation[0, 3]) > 0.9
    said = result.explain(4)
    assert "joint 1" in said
    assert "% of the measured displacement" in said


def test_values_are_a_little_higher_than_table_2(result):
    """Claim 6: fitted to Cartesian measurements they come out higher than joint by joint."""
    well_known = np.array([0, 1, 2, 4])
    assert (result.C_theta[well_known] > TABLE_2[well_known]).all()


def test_the_first_method_returns_table_2():
    first = identify(ROBOT, rm.read_load_tests(FILES / "one_joint_at_a_time.csv"))
    assert ((first.ci95[:, 0] <= TABLE_2) & (TABLE_2 <= first.ci95[:, 1])).all()


def test_compliances_and_displacements_are_the_same_equations(tests, result):
    """Eq. (17) only divides by the load."""
    again = identify(ROBOT, rm.read_load_tests(FILES / "nine_points_compliances.csv"))
    np.testing.assert_allclose(again.C_theta, result.C_theta, rtol=1e-3)
    one, two = (build_system(ROBOT, t, result.choice) for t in (tests, rm.read_load_tests(FILES / "nine_points.csv")))
    np.testing.assert_array_equal(one.A, two.A)


def test_deviation_at_the_milling_test_with_its_band(result):
    """0.264 mm per 100 N with Table 3 and the assumed lengths, from both methods; the fit adds its own uncertainty."""
    arm = result.applied_to(ROBOT)
    theta = rm.inverse_kinematics(arm, rm.pose_from_world([0, -1.3, 0, 0, 0])).theta
    known = Knowledge.of(result, arm)
    found = uncertain_deflection(arm, theta, [0, 100.0, 0], known.noise_only())
    half = found.half_width()[1]
    assert abs(found.delta[1] - 0.2644e-3) < half
    assert half < 2e-6
    # What is left of each reading (4 um at 250 N) cannot be told from an error of the model: it is in the band.
    honest = uncertain_deflection(arm, theta, [0, 100.0, 0], known)
    assert honest.half_width()[1] == pytest.approx(2.0 * 4e-6 * 100 / 250, rel=0.3)
    measured = read_measured_map(FILES / "grid_45x6.csv", ROBOT).compliance([0, -1.3, 0]) @ [0, 100.0, 0]
    assert measured[1] == pytest.approx(found.delta[1], abs=5e-6)
