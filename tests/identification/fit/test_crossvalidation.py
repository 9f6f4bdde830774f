"""Poses left out and predicted: against fitting again and again by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import nnls

import robomill as rm
from robomill.identification.fit.crossvalidation import Folded, headline, leave_out, relative_by_pose
from robomill.identification.fit.folds import fold_of_pose
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import build_system
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.synthesis import three_directions
from tests.identification.synthetic import simulated_tests

ROBOT = rm.load_robot("slavkovic_5r").with_compliance_set("table_3")


def cross_validate(system, weights=None, folds=10):
    """(poses,) relative error of each pose, predicted without its fold."""
    fold = fold_of_pose(int(system.pose.max()) + 1, folds)[system.pose]
    folded = Folded(system, fold, weights)
    return relative_by_pose(system, leave_out(folded.count, lambda left: folded).error, weights)


def system_of(poses, noise=3e-5):
    theta = np.random.default_rng(poses).uniform(ROBOT.limits[:, 0], ROBOT.limits[:, 1], (poses, 5))
    return build_system(ROBOT, simulated_tests(ROBOT, *three_directions(theta, 250.0), noise=noise, seed=1), Model())


@pytest.mark.parametrize(("poses", "folds"), [(2, 10), (7, 10), (10, 10), (23, 10), (23, 4), (250, 10)])
def test_folds_are_of_equal_size_and_mix_the_order(poses, folds):
    fold = fold_of_pose(poses, folds)
    sizes = np.bincount(fold)
    assert len(sizes) == min(poses, folds)
    assert np.ptp(sizes) <= 1
    np.testing.assert_array_equal(fold, fold_of_pose(poses, folds))
    assert poses < 20 or (np.diff(fold) < 0).sum() > 5, "neighbouring poses are not one fold"
    np.testing.assert_array_equal(fold_of_pose(23), fold_of_pose(23, 10))


@pytest.mark.parametrize(("poses", "folds"), [(6, 10), (23, 10), (12, 3)])
@pytest.mark.parametrize("weighted", [False, True])
def test_each_pose_is_predicted_without_its_fold(poses, folds, weighted):
    system = system_of(poses)
    e = len(system.b)
    weights = np.random.default_rng(0).uniform(0.2, 1.0, e) if weighted else None
    if weights is not None:
        weights[::7] = 0.0
    w = np.ones(e) if weights is None else weights
    fold = fold_of_pose(poses, folds)[system.pose]
    missed = np.empty(e)
    for k in range(fold.max() + 1):
        rest, root = fold != k, np.sqrt(w) / system.noise
        A = system.A * root[:, None] * 1e6
        missed[~rest] = system.A[~rest] @ nnls(A[rest], (system.b * root * 1e6)[rest])[0] - system.b[~rest]
    # A test of which a reading was switched off as gross is wrong as a whole, and says nothing of the model.
    live = ~np.isin(system.test, system.test[w == 0])
    expected = [
        np.linalg.norm(missed[live & (system.pose == p)]) / np.linalg.norm(system.b[live & (system.pose == p)])
        for p in range(poses)
    ]
    np.testing.assert_allclose(cross_validate(system, weights, folds), expected, rtol=1e-6)
    np.testing.assert_allclose(relative_by_pose(system, missed, weights), expected, rtol=1e-9)


def test_what_only_one_fold_has_seen_cannot_be_predicted_by_the_rest():
    joint = np.array([1, 1, 1, 2, 3, 3, 4, 4, 5, 5])
    tests = JointTests(joint, np.full(10, 100.0), 1e-4 * joint)
    error = cross_validate(build_system(ROBOT, tests, Model()))
    np.testing.assert_array_equal(np.isnan(error), joint == 2)
    np.testing.assert_allclose(error[joint != 2], 0.0, atol=1e-9)
    assert headline(error) == pytest.approx(np.nanmean(error), abs=1e-12)
    assert headline(np.array([0.2, np.nan, 0.4, np.inf])) == pytest.approx(0.3)
    assert np.isnan(headline(np.array([np.nan])))


def test_one_pose_leaves_nothing_to_predict_it_from():
    theta = ROBOT.home[None]
    tests = LoadTests(np.eye(3) * 100, np.ones((3, 3)) * 1e-4, theta=np.repeat(theta, 3, axis=0))
    system = build_system(ROBOT, tests, Model("constant"))
    assert np.isnan(cross_validate(system)).all()
    assert len(cross_validate(system)) == 1


def test_poses_that_did_not_move_and_rotations_do_not_count():
    system = system_of(3)
    b = system.b.copy()
    b[system.pose == 1] = 0.0
    turned = system.component.copy()
    turned[0] = 4
    changed = type(system)(**{**system.__dict__, "b": b, "component": turned})
    error = relative_by_pose(changed, np.ones(len(b)) * 1e-5)
    assert np.isnan(error[1])
    first = (system.pose == system.pose[0]) & (np.arange(len(b)) > 0)
    assert error[system.pose[0]] == pytest.approx(np.sqrt(first.sum()) * 1e-5 / np.linalg.norm(b[first]))
