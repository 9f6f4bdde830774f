"""Steps of the inquiry into what a model lacks: which causes are asked, of which rows, and its tests written out.

The truth is written out anew: scipy's distributions, numpy's and scipy's least squares on columns in full.
"""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats
from scipy.optimize import nnls

import robomill as rm
from robomill.identification.fit.causes import Inquiry, _moved, _ranks, _with_point
from robomill.identification.fit.fitting import fit_system
from robomill.identification.fit.folds import folds_of
from robomill.identification.fit.models import Model
from robomill.identification.fit.suspects import Cause
from robomill.identification.fit.system import build_system
from robomill.identification.fit.treatment import Treatment
from robomill.identification.load_test import LoadTests
from robomill.identification.synthesis import three_directions
from tests.identification.fit.arms import ROBOT, poses
from tests.identification.synthetic import simulated_tests

SIX = rm.load_robot("kuka_kr270")
JOINTS = Model("joints")


def measured(count=8, noise=1e-5, robot=ROBOT, seed=1):
    return simulated_tests(robot, *three_directions(poses(robot, count), 250.0), noise=noise, seed=seed)


def inquiry(tests, treatment=None, robot=ROBOT, odd=(), weights=None, shift=None):
    """An inquiry about a fit of ``tests``, of which the rows ``odd`` were called outliers."""
    treatment = treatment or Treatment()
    system = build_system(robot, tests, JOINTS, treatment.freed)
    shift = np.zeros(3 * len(treatment.freed)) if shift is None else shift
    fitted = SimpleNamespace(found=SimpleNamespace(shift=shift), system=system, weights=weights)
    result = SimpleNamespace(choice=JOINTS, outliers=[SimpleNamespace(row=row) for row in odd])
    return Inquiry.of(robot, tests, result, treatment, fitted)


def asked(model, freed=(), robot=SIX):
    return list(Inquiry(robot, None, model, freed, None, None)._causes())


def test_every_cause_is_asked_that_the_model_does_not_hold():
    joints = range(1, 7)
    every = {
        *(Cause("zero", j) for j in joints),
        *(Cause("bending", j) for j in joints),
        *(Cause("bending", j, turned=True) for j in range(1, 6)),  # behind the last joint nothing turns
        Cause("tool"),
        *(Cause(kind) for kind in ("offset", "drift", "play")),
        *(Cause("points", points=name) for name in ("force", "gauge", "both")),
    }
    found = asked(JOINTS)
    assert set(found) == every
    assert len(found) == len(every)
    bent = {
        Cause("bending", 2),
        Cause("bending", 3),
        Cause("bending", 2, turned=True),
        Cause("bending", 3, turned=True),
    }
    assert set(asked(Model("joints+bending", (2, 3)))) == every - bent
    assert set(asked(Model("joints+tool"))) == every - {Cause("tool")}


@pytest.mark.parametrize(
    ("freed", "points"), [(("force",), {"gauge"}), (("gauge",), {"force"}), (("force", "gauge"), set())]
)
def test_points_that_are_fitted_are_no_cause(freed, points):
    assert {cause.points for cause in asked(JOINTS, freed) if cause.kind == "points"} == points


def test_of_more_than_six_hundred_rows_every_second_is_asked():
    for count, rows in ((600, range(1, 601)), (603, range(1, 604, 2))):
        tests = measured(count // 3)
        np.testing.assert_array_equal(inquiry(tests).tests.row, rows)


def test_a_few_outliers_and_rows_without_weight_are_not_asked():
    """Of forty rows four are a few, five are too many to be the readings' fault."""
    tests = measured(20).select(np.arange(40))
    for odd in ((3, 9, 17, 40), (3, 9, 17, 39, 40)):
        kept = np.setdiff1d(tests.row, odd if len(odd) == 4 else ())
        np.testing.assert_array_equal(inquiry(tests, odd=odd).tests.row, kept)
    weights = np.ones(120)
    weights[[7, 60, 61]] = 0.0, 0.0, 1e-3  # one reading of row 3, one of row 21
    np.testing.assert_array_equal(inquiry(tests, weights=weights).tests.row, np.setdiff1d(tests.row, [3, 21]))


def test_of_copies_the_first_is_asked():
    """A copy has the same pose, load and reading; a second reading under the same load is none."""
    tests = measured(4)
    again = tests.joined(tests.select([5, 0])).joined(replace(tests.select([2]), displacement=tests.displacement[[3]]))
    np.testing.assert_array_equal(inquiry(again).tests.row, [*range(1, 13), 15])


def test_weights_and_folds_are_those_of_the_treatment():
    tests = measured(30)
    near, size = Treatment(leave_out="neighbours"), Treatment(weights="size")
    for treatment in (Treatment(), near, size):
        found = inquiry(tests, treatment)
        fold = folds_of(treatment.leave_out, tests.pose_index(), tests.theta)
        np.testing.assert_array_equal(found.fold, np.repeat(fold, 3))
        assert (np.ptp(found.system.noise) > 0) == (treatment is size)


def test_points_are_where_they_were_found():
    """The load point by the first three numbers, the gauge point by the next."""
    shift = np.array([0.01, 0.02, -0.03, 0.04, -0.05, 0.06])
    found = inquiry(measured(), Treatment(fit_points="both"), shift=shift).tests
    np.testing.assert_allclose(found.force_point, np.tile(shift[:3], (24, 1)))
    np.testing.assert_allclose(found.measuring_point, np.tile(shift[3:], (24, 1)))


def test_a_cause_moves_its_own_points_or_its_own_joint():
    tests, shift = measured(4), np.array([0.01, 0.02, -0.03, 0.04, -0.05, 0.06])
    both = _moved(ROBOT, tests, Cause("points", points="both"), shift)
    np.testing.assert_allclose(both.force_point, np.tile(shift[:3], (12, 1)))
    np.testing.assert_allclose(both.measuring_point, np.tile(shift[3:], (12, 1)))
    for name in ("force", "gauge"):
        one = _moved(ROBOT, tests, Cause("points", points=name), shift[:3])
        assert (one.force_point.any(), one.measuring_point.any()) == (name == "force", name == "gauge")
        same = _with_point(ROBOT, tests, name, shift[:3])
        np.testing.assert_array_equal(one.force_point + one.measuring_point, same.force_point + same.measuring_point)
    turned = _moved(ROBOT, tests, Cause("zero", 3), np.array([0.02]))
    np.testing.assert_allclose(turned.theta - tests.theta, np.tile([0, 0, 0.02, 0, 0], (12, 1)), atol=1e-15)
    assert turned.wrench is tests.wrench or np.array_equal(turned.wrench, tests.wrench)


def test_ranks_of_equals_are_shared():
    values = np.array([3.0, 1.0, 2.0, 3.0, 1.0, 3.0, 0.5])
    found = _ranks(values)
    np.testing.assert_allclose(found - found.min(), stats.rankdata(values) - 1.0)


@pytest.mark.parametrize("kind", ["offset", "drift", "play"])
def test_what_gauges_add_is_a_column_a_component(kind):
    """Rows 11 to 30 of a file; the drift grows from nothing in the first to one in the last."""
    tests = replace(measured(8).select(np.arange(20)), row=np.arange(11, 31))
    about = inquiry(tests)
    x = np.asarray(ROBOT.C_theta)
    found = about._of_gauges(Cause(kind), x).reshape(20, 3, -1)
    each = {"offset": np.ones(20), "drift": np.arange(20) / 19.0}.get(kind, np.ones(20))
    sign = np.sign(build_system(ROBOT, tests, JOINTS).A @ x).reshape(20, 3) if kind == "play" else np.ones((20, 3))
    np.testing.assert_allclose(found[:, :, :3], (each[:, None] * sign)[:, :, None] * np.eye(3))
    assert found.shape[2] == (6 if kind == "drift" else 3)
    if kind == "drift":
        np.testing.assert_allclose(found[:, :, 3:], np.tile(np.eye(3), (20, 1, 1)))


def test_the_only_row_does_not_drift():
    tests = measured(2)
    about = replace(inquiry(tests), tests=tests.select([0]), system=build_system(ROBOT, tests, JOINTS))
    about = replace(about, system=replace(about.system, test=np.zeros(18, dtype=int)))
    np.testing.assert_array_equal(about._of_gauges(Cause("drift"), ROBOT.C_theta)[:, :3], 0.0)


@pytest.mark.parametrize("joint", [1, 4])
def test_a_zero_changes_the_readings_by_their_slope(joint):
    """Over a thousandth of a radian to either side, read off the forward model."""
    tests = measured()
    about = inquiry(tests)
    there, back = (
        build_system(ROBOT, replace(tests, theta=tests.theta + s * np.eye(5)[joint - 1]), JOINTS).A @ ROBOT.C_theta
        for s in (1e-3, -1e-3)
    )
    found = about._extra(tests, Cause("zero", joint), ROBOT.C_theta)
    assert found.shape == (72, 1)
    np.testing.assert_allclose(found[:, 0], (there - back) / 2e-3, rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize(
    ("cause", "free"),
    [
        (Cause("zero", 2), [True]),
        (Cause("bending", 3), [False] * 2),
        (Cause("tool"), [False] * 2),
        (Cause("offset"), [True] * 3),
        (Cause("points", points="gauge"), [True] * 3),
    ],
)
def test_springs_cannot_be_negative_and_other_numbers_can(cause, free):
    columns = inquiry(measured())._about(measured(), cause)
    assert columns.signed.tolist() == [False] * 5 + free
    assert columns.k == len(free)
    assert columns.whole.shape == (72, 5 + len(free))


def weighted(about):
    """Columns of the joints' springs and readings, each over its noise."""
    w = 1.0 / about.system.noise
    return build_system(ROBOT, about.tests, JOINTS).A * w[:, None], about.system.b * w


def left_over(A, b):
    scale = np.linalg.norm(A, axis=0)
    return float(((A / scale @ np.linalg.lstsq(A / scale, b, rcond=None)[0] - b) ** 2).sum())


@pytest.mark.parametrize(("fit_noise", "offset"), [(1e-5, 1e-5), (3e-5, 0.0)])
def test_the_chance_of_a_cause_is_that_of_an_f_test(fit_noise, offset):
    """Seventy-two readings, five springs, three numbers of a gauge that was not zeroed; noise of three sizes stated."""
    tests = measured(noise=fit_noise)
    tests = replace(tests, displacement=tests.displacement + offset, noise=np.tile([1e-5, 2e-5, 4e-5], 8))
    about = inquiry(tests)
    A, b = weighted(about)
    extra = np.tile(np.eye(3), (24, 1)) / about.system.noise[:, None]
    first, second = left_over(A, b), left_over(np.hstack([A, extra]), b)
    chance = stats.f.sf((first - second) / 3 / (second / 64), 3, 64)
    assert about._chance(about._about(about.tests, Cause("offset"))) == pytest.approx(chance, rel=1e-6)


def test_what_adds_nothing_or_leaves_nothing_to_spare_or_has_nothing_to_explain_is_chance():
    exact = inquiry(measured(noise=0.0))
    assert exact._chance(exact._about(exact.tests, Cause("offset"))) == 1.0
    few = inquiry(measured(3).select(np.arange(0, 8, 4)).joined(measured(3).select([8])))  # nine readings
    assert few._chance(few._about(few.tests, Cause("drift"))) == 1.0
    assert few._chance(few._about(few.tests, Cause("offset"))) < 1.0
    about = inquiry(measured())
    columns = about._about(about.tests, Cause("offset"))
    again = replace(columns, whole=np.hstack([columns.whole[:, :5], columns.whole[:, :3]]))
    assert about._chance(again) == 1.0


@pytest.mark.parametrize("offset", [False, True])
def test_the_error_with_a_cause_is_that_on_poses_left_out(offset):
    """By scipy's fit above zero, of which what may be negative is the difference of two."""
    about = inquiry(measured(noise=5e-5))
    A, b = weighted(about)
    if offset:
        constant = np.tile(np.eye(3), (24, 1)) * 1e-4
        A = np.hstack([A * 1.0, constant, -constant])
    size = np.linalg.norm(A, axis=0)
    missed = np.empty(72)
    for fold in np.unique(about.fold):
        out = about.fold == fold
        missed[out] = A[out] / size @ nnls(A[~out] / size, b[~out])[0] - b[out]
    shares = [
        np.linalg.norm(missed[about.system.pose == pose]) / np.linalg.norm(about.system.b[about.system.pose == pose])
        for pose in range(8)
    ]
    columns = about._about(about.tests, Cause("offset") if offset else None)
    assert about._error(columns) == pytest.approx(np.mean(shares), rel=1e-5)


def test_the_interval_of_a_zero_is_students():
    about = inquiry(measured(noise=2e-5))
    columns = about._about(about.tests, Cause("zero", 2))
    scale = np.linalg.norm(columns.whole, axis=0)
    S, b = columns.whole / scale, about.system.b / about.system.noise
    sigma = np.sqrt(left_over(columns.whole, b) / (72 - 6))
    stderr = sigma * np.sqrt(np.linalg.inv(S.T @ S)[-1, -1]) / scale[-1]
    assert about._half(columns) == pytest.approx(stats.t.ppf(0.975, 66) * stderr, rel=1e-6)


@pytest.mark.parametrize(("zero", "named"), [(0.15, True), (0.25, False)])
def test_a_zero_further_off_than_a_fifth_of_a_radian_is_none(zero, named):
    theta, F = three_directions(0.8 * poses(ROBOT, 8), 250.0)
    tests = simulated_tests(ROBOT, theta, F, noise=1e-7)
    off = replace(tests, theta=theta - zero * np.eye(5)[2])
    found = inquiry(off)._asked(Cause("zero", 3))
    assert (found is not None) == named
    if named:
        assert found.off == pytest.approx(zero, abs=2e-3)
        assert found.error < 0.01


def several_loads(unlike, poses_=3, loads=5, moment=0.0, scatter=1e-5, stated=None):
    """Three poses under five loads each, load and gauge point the same or unlike."""
    rng = np.random.default_rng(2)
    theta = np.repeat(poses(ROBOT, poses_), loads, axis=0)
    wrench = np.concatenate([rng.normal(size=(len(theta), 3)) * 150, np.full((len(theta), 3), moment)], axis=1)
    gauge = np.array([0.05, -0.02, 0.1]) * unlike
    given = {"theta": theta, "measuring_point": gauge}
    exact = JOINTS.terms(ROBOT, LoadTests(wrench, np.ones((len(theta), 3)), **given))[:, :3, 0] @ ROBOT.C_theta
    return LoadTests(wrench, exact + scatter * rng.standard_normal(exact.shape), noise=stated, **given)


@pytest.mark.parametrize(("unlike", "entries"), [(False, 6), (True, 9)])
def test_a_pose_has_a_symmetric_matrix_where_load_and_gauge_point_are_one(unlike, entries):
    tests = several_loads(unlike, stated=np.tile([1e-5, 2e-5, 3e-5], 5))
    about = inquiry(tests)
    pure = 0.0
    for k in range(3):
        F, d = tests.wrench[5 * k : 5 * k + 5, :3], tests.displacement[5 * k : 5 * k + 5, :3].ravel()
        basis = [np.outer(a, c) for a in np.eye(3) for c in np.eye(3)]
        if not unlike:
            basis = [B + B.T for B in basis]
        w = 1.0 / np.repeat(tests.noise[5 * k : 5 * k + 5], 3)
        A = np.array([w * (F @ B.T).ravel() for B in basis]).T
        pure += float(((A @ np.linalg.lstsq(A, w * d, rcond=None)[0] - w * d) ** 2).sum())
    free = 45 - 3 * entries
    chance = stats.f.sf((left_over(*weighted(about)) - pure) / (40 - free) / (pure / free), 40 - free, free)
    assert about._lack(about._about(tests)) == pytest.approx(chance, rel=1e-6)


@pytest.mark.parametrize("stated", [None, 1e-6, 1e3])
def test_what_is_left_of_exact_readings_is_rounding_whatever_noise_is_stated(stated):
    exact = several_loads(False, scatter=0.0, stated=stated)
    about = inquiry(exact)
    columns = about._about(exact)
    assert np.isnan([about._lack(columns), about._growth(columns)]).all()
    assert about._chance(about._about(exact, Cause("offset"))) == 1.0
    hardly = several_loads(False, scatter=1e-11, stated=stated)
    about = inquiry(hardly)
    columns = about._about(hardly)
    assert np.isfinite([about._lack(columns), about._growth(columns)]).all()


def test_a_lack_is_asked_of_forces_alone_and_of_ten_readings_to_spare():
    """Three poses under five and under three loads have 45 and 27 readings for 18 entries, two under four 24 for 12."""
    for told, tests in (
        (True, several_loads(False, loads=5)),
        (False, several_loads(False, loads=5, moment=3.0)),
        (True, several_loads(False, loads=4, poses_=2)),
        (False, several_loads(False, loads=3, poses_=3)),
    ):
        about = inquiry(tests)
        assert np.isfinite(about._lack(about._about(tests))) == told


def test_growth_is_asked_of_ten_readings_to_spare():
    """Fifteen readings, five springs; one reading less is one too few."""
    for told in (True, False):
        tests = measured(5)
        read = tests.displacement[:, :3].copy()
        read[4, 2] = read[4, 2] if told else np.nan
        kept = LoadTests(tests.wrench[:5], read[:5], theta=tests.theta[:5])
        about = inquiry(kept)
        assert np.isfinite(about._growth(about._about(kept))) == told


def test_a_fit_is_asked_about_as_it_is_fitted():
    """Through the fit itself: the inquiry's equations without a cause are those that were solved."""
    tests = measured()
    about = inquiry(tests)
    fit = fit_system(build_system(ROBOT, tests, JOINTS), False)
    np.testing.assert_allclose(about._free(about._about(tests)), fit.found.fit.free, rtol=1e-8)
    left, spare = about._left(about._about(tests))
    assert spare == 67
    A, b = weighted(about)
    assert float(left @ left) == pytest.approx(left_over(A, b), rel=1e-9)
