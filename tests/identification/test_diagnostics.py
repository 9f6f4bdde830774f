"""What a fit says of itself, checked against the numbers it should come from."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import robomill as rm
from robomill.identification import diagnostics
from robomill.identification.fit.least_squares import robust_fit
from robomill.identification.fit.models import Model, Parameter
from robomill.identification.fit.system import System, build_system
from robomill.identification.load_test import LoadTests
from robomill.identification.synthesis import three_directions
from tests.identification.synthetic import simulated_tests

ROBOT = rm.load_robot("slavkovic_5r").with_compliance_set("table_3")
THETA = np.random.default_rng(0).uniform(ROBOT.limits[:, 0], ROBOT.limits[:, 1], (9, 5))


def made(A, b, parameters=None, stated=False, noise=1.0):
    """Equations by hand, one test a row."""
    e, p = A.shape
    names = parameters or tuple(Parameter("joint", i + 1) for i in range(p))
    index = np.arange(e)
    return System(A, b, np.full(e, noise), index, np.zeros_like(index), index, names, stated)


def test_correlation_and_shares_are_their_definitions():
    rng = np.random.default_rng(1)
    root = rng.normal(size=(4, 4))
    covariance = root @ root.T
    drawn = rng.multivariate_normal(np.zeros(4), covariance, 200000)
    np.testing.assert_allclose(diagnostics.correlation(covariance), np.corrcoef(drawn.T), atol=0.01)
    np.testing.assert_allclose(np.diag(diagnostics.correlation(covariance)), 1.0)
    covariance[2] = covariance[:, 2] = np.nan
    assert np.isnan(diagnostics.correlation(covariance)[2]).all()
    A, x = rng.normal(size=(30, 3)), np.array([1.0, 2.0, 3.0])
    system = made(A, A @ x)
    expected = [np.sqrt(np.mean((A[:, i] * x[i]) ** 2) / np.mean((A @ x) ** 2)) for i in range(3)]
    np.testing.assert_allclose(diagnostics.shares(system, x), expected)
    turned = replace(system, component=np.where(np.arange(30) < 10, 3, 0))
    expected = [np.sqrt(np.mean((A[10:, i] * x[i]) ** 2) / np.mean((A[10:] @ x) ** 2)) for i in range(3)]
    np.testing.assert_allclose(diagnostics.shares(turned, x), expected)
    np.testing.assert_array_equal(diagnostics.shares(made(A, 0.0 * A[:, 0]), x), [0, 0, 0])


def test_extra_springs_that_repeat_an_earlier_column_are_its_twins():
    rng = np.random.default_rng(2)
    a, b, c = rng.normal(size=(3, 40))
    kinds = (*(Parameter("joint", i) for i in (1, 2)), *(Parameter("bending", i, "x") for i in (1, 2, 3, 4)))
    A = np.column_stack([a, b, 3.0 * a, c, 1e-3 * a, np.zeros(40)])
    assert diagnostics.twins(made(A, a, kinds)) == {2: 0, 4: 0}
    joints = np.column_stack([a, a, -a, c, b, 2 * c])  # joints never are; an opposite column is another spring
    assert diagnostics.twins(made(joints, a, kinds)) == {5: 3}
    nearly = np.column_stack([a, b, a + 1e-4 * c * np.linalg.norm(a) / np.linalg.norm(c), c, b, a])
    assert diagnostics.twins(made(nearly, a, kinds)) == {4: 1, 5: 0}
    gap = 1.2e-5  # half the square of the gap of two unit columns is 1 - cosine: 7e-11 and 2e-10
    side = c - a * (a @ c) / (a @ a)
    side *= np.linalg.norm(a) / np.linalg.norm(side)
    assert 2 in diagnostics.twins(made(np.column_stack([a, b, a + gap * side, c, 2 * b, b + c]), a, kinds))
    assert 2 not in diagnostics.twins(made(np.column_stack([a, b, a + 2e-5 * side, c, 2 * b, b + c]), a, kinds))
    entries = tuple(Parameter("entry", axis=axis) for axis in ("xx", "yy", "zz", "xy", "xz", "yz"))
    assert diagnostics.twins(made(joints, a, entries)) == {}


def test_outliers_are_beyond_what_chance_allows_once_in_a_hundred_data_sets():
    rng = np.random.default_rng(3)
    A = rng.normal(size=(60, 3))
    b = A @ [1.0, 2.0, 3.0] + 1e-3 * rng.normal(size=60)
    robust = robust_fit(A, b)
    limit = stats.t.isf(0.01 / 120, 57) * robust.scale
    row = np.arange(60) + 100
    for k, factor, told in ((7, 0.9, False), (7, 1.2, True), (20, -1.3, True)):
        spoilt = b.copy()
        spoilt[k] = (b - robust.residual)[k] + factor * limit
        found = diagnostics.outliers(made(A, spoilt), row)
        assert [o.row for o in found] == ([100 + k] if told else [])
        if told:
            assert found[0].residual == pytest.approx(factor * limit, rel=0.1)
            assert found[0].times == pytest.approx(abs(found[0].residual) / robust_fit(A, spoilt).scale)
            same = diagnostics.outliers(made(A * 1e-3, spoilt * 1e-3, noise=1e-3), row)
            assert same[0].residual == pytest.approx(found[0].residual * 1e-3)
            assert same[0].times == pytest.approx(found[0].times)
    assert diagnostics.outliers(made(A[:5], b[:5]), row) == ()
    assert diagnostics.outliers(made(A, np.zeros(60)), row) == ()
    spoilt = b.copy()
    spoilt[[4, 9, 30]] += 0.05, -0.2, 0.1
    assert [o.row for o in diagnostics.outliers(made(A, spoilt), row)] == [109, 130, 104], "worst first"
    shared = made(A, spoilt)
    shared = replace(shared, test=np.arange(60) // 2)
    worst = {o.row: o.times for o in diagnostics.outliers(shared, np.arange(30))}
    assert list(worst) == [4, 15, 2]
    both = spoilt.copy()
    both[8] += 0.1
    found = diagnostics.outliers(replace(made(A, both), test=np.arange(60) // 2), np.arange(30))
    assert found[0].row == 4
    assert found[0].residual == pytest.approx(-0.2, rel=0.05), "the worse of a test's two readings"


def test_an_equation_and_its_noise_in_another_unit_is_as_much_of_an_outlier():
    """Each row multiplied by a number of its own, its noise with it: the same tests, as many times too far off."""
    rng = np.random.default_rng(9)
    A, unit = rng.normal(size=(60, 3)), 10.0 ** rng.uniform(-1.0, 1.0, 60)
    b = A @ [1.0, 2.0, 3.0] + 1e-3 * rng.normal(size=60)
    b[[4, 9]] += 0.05, -0.2
    told = diagnostics.outliers(made(A, b), np.arange(60))
    again = diagnostics.outliers(replace(made(A * unit[:, None], b * unit), noise=unit), np.arange(60))
    assert [o.row for o in told] == [o.row for o in again] == [9, 4]
    for one, other in zip(told, again, strict=True):
        assert other.times == pytest.approx(one.times)
        assert other.residual == pytest.approx(one.residual * unit[one.row])


def test_exactly_three_equations_to_spare_are_enough():
    rng = np.random.default_rng(4)
    A = rng.normal(size=(6, 3))
    b = A @ [1.0, 1, 1] + 1e-9 * rng.normal(size=6)
    b[2] += 1e4
    assert len(diagnostics.outliers(made(A, b), np.arange(6))) >= 1
    assert diagnostics.outliers(made(A[:5], b[:5]), np.arange(6)) == ()


def bound_together(alike, noise, seed=5):
    """Two joints whose columns have the cosine ``alike``, and a third apart; the fit of noisy data."""
    rng = np.random.default_rng(seed)
    Q = np.linalg.qr(rng.normal(size=(50, 3)))[0]
    A = np.column_stack([Q[:, 0], alike * Q[:, 0] + np.sqrt(1 - alike**2) * Q[:, 1], Q[:, 2]])
    system = made(A, A @ [1.0, 1.0, 1.0] + noise * rng.normal(size=50))
    return system, system.fit()


def explained(system, fit, k):
    return diagnostics.sentence(fit, system.parameters, diagnostics.shares(system, fit.x), k)


@pytest.mark.parametrize(("alike", "told"), [(0.5, False), (0.65, False), (0.75, True), (0.95, True)])
def test_joints_are_confused_from_a_correlation_of_seven_tenths(alike, told):
    system, fit = bound_together(alike, 0.02)
    assert diagnostics.confused_with(fit, system.parameters, 0) == (("joint 2",) if told else ())
    assert diagnostics.confused_with(fit, system.parameters, 2) == ()
    named = re.search(r"as joint 2 does \(correlation −?(-?\d\.\d+)\)", explained(system, fit, 0))
    assert named is not None
    assert abs(float(named[1])) == pytest.approx(alike, abs=0.006)  # two unit columns: minus their cosine


def test_the_sentence_says_how_well_how_much_and_why():
    system, fit = bound_together(0.1, 0.02)
    half = stats.t.ppf(0.975, 47) * np.sqrt(np.diag(fit.covariance)) / fit.x
    for k in range(3):
        assert diagnostics.half_share(fit, k) == pytest.approx(half[k])
        said = explained(system, fit, k)
        assert f"Joint {k + 1} is known to ± {100 * half[k]:.0f} %" in said
        share = 100 * diagnostics.shares(system, fit.x)[k]
        assert f"it makes {share:.0f} % of the measured displacement" in said
        assert "correlation" not in said
        assert "longer lever" in said
    few = diagnostics.sentence(fit, system.parameters, np.array([0.0456, 0.5, 0.5]), 0)
    assert "it makes 4.6 % of" in few
    loose, wide = bound_together(0.1, 2.0)
    assert any("cannot be told from a rigid one" in explained(loose, wide, k) for k in range(3))
    system, fit = bound_together(0.999, 1.0)
    assert "cannot be told from joint 2: at these poses both move the tool alike" in explained(system, fit, 0)
    assert np.isinf(diagnostics.half_share(replace(fit, dof=0), 0))
    assert np.isinf(diagnostics.half_share(replace(fit, x=np.zeros(3)), 0))
    one = diagnostics.half_share(replace(fit, dof=1), 2)
    assert one == pytest.approx(stats.t.ppf(0.975, 1) * fit.stderr[2] / fit.x[2])


def test_joints_that_no_equation_tells_apart():
    rng = np.random.default_rng(6)
    a, b = rng.normal(size=(2, 30))
    system = made(np.column_stack([a, 2 * a, b, 0 * a]), a + b + 0.01 * rng.normal(size=30))
    fit = system.fit()
    share = diagnostics.shares(system, fit.x)
    unseen = diagnostics.unseen_joints(fit, system.parameters, share)
    assert [(u.joint, u.confused_with) for u in unseen] == [(1, ("joint 2",)), (2, ("joint 1",)), (4, ())]
    assert "its effect is exactly made up of joint 2" in unseen[0].sentence
    assert "no test makes it yield" in unseen[2].sentence
    (finding,) = diagnostics.fit_findings(system, fit, (), {})
    assert (finding.code, finding.level) == ("not-seen", "warning")
    assert "tell joint 1, joint 2 and joint 4 apart" in finding.message
    lone = made(np.column_stack([a, b, 0 * a]), a + b + 0.01 * rng.normal(size=30))
    (finding,) = diagnostics.fit_findings(lone, lone.fit(), (), {})
    assert "make joint 3 yield" in finding.message


def test_a_joint_whose_interval_reaches_zero_is_not_seen():
    rng = np.random.default_rng(7)
    a, b = np.linalg.qr(rng.normal(size=(40, 2)))[0].T
    noise = rng.normal(size=40)
    noise -= a * (a @ noise) + b * (b @ noise)
    noise *= np.sqrt(38) / np.linalg.norm(noise)  # sigma is one: the half width is the t quantile itself
    t = stats.t.ppf(0.975, 38)
    system = made(np.column_stack([a, b]), 0.98 * t * a + 1.02 * t * b + noise)
    unseen = diagnostics.unseen_joints(system.fit(), system.parameters, np.ones(2))
    assert [u.joint for u in unseen] == [1]


def codes(system, fit, active=(), lumped=None):
    return [(f.code, f.level) for f in diagnostics.fit_findings(system, fit, active, lumped or {})]


def test_findings_of_a_fit():
    system, fit = bound_together(0.1, 0.02)
    assert codes(system, fit) == []
    for limit, told in ((99.0, False), (101.0, True)):
        alike = 1 - 2 / (limit**2 + 1)  # two unit columns: condition sqrt((1 + c) / (1 - c))
        found, close = bound_together(alike, 1e-4)
        assert close.condition[1] == pytest.approx(limit, rel=1e-3)
        assert codes(found, close) == ([("condition", "warning")] if told else [])
    kinds = (Parameter("joint", 1), Parameter("bending", 2, "x"), Parameter("joint", 3))
    mixed = replace(system, parameters=kinds)
    said = codes(mixed, fit, ("joint 1", "bending x at joint 2"), {"bending x at joint 2": "joint 1"})
    assert said == [("held-at-zero", "warning"), ("held-at-zero", "info"), ("lumped", "info")]
    A, b = system.A[:3], system.b[:3]
    for stated in (False, True):
        square = made(A, b, stated=stated)
        assert codes(square, square.fit()) == ([] if stated else [("no-residuals", "warning")])
    four = made(system.A[:4], system.b[:4])
    assert codes(four, four.fit()) == []
    for times, told in ((1.9, False), (2.1, True)):
        noisy = replace(system, noise=np.full(50, fit.sigma / times), stated=True)
        assert noisy.fit().sigma == pytest.approx(times)
        assert codes(noisy, noisy.fit()) == ([("above-stated-noise", "warning")] if told else [])
        assert codes(replace(noisy, stated=False), noisy.fit()) == []
    exact = made(np.vstack([A, A]), np.append(b, b), stated=True)
    assert codes(exact, replace(exact.fit(), dof=0, sigma=3.0)) == []
    assert codes(exact, replace(exact.fit(), dof=1, sigma=3.0)) == [("above-stated-noise", "warning")]


def test_real_tests_give_the_twin_that_geometry_says():
    """Bending of joint 2 about y turns about the axis of joint 1 in this arm."""
    tests = simulated_tests(ROBOT, *three_directions(THETA, 250.0))
    assert isinstance(tests, LoadTests)
    system = build_system(ROBOT, tests, Model("joints+bending"))
    labels = [p.label for p in system.parameters]
    assert {labels[k]: labels[j] for k, j in diagnostics.twins(system).items()} == {"bending y at joint 2": "joint 1"}
