"""A measured map beside the joint model: a map that is the model's own times a number has that number's gap."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.identification.map_check import MapCheck
from robomill.identification.measured_field import MeasuredField

ROBOT = rm.load_robot("slavkovic_5r")
X_M = np.array([[0.1, -1.3, 0.0, 0.1, 0.0], [0.4, -1.2, 0.1, 0.0, 0.2], [-0.3, -1.4, 0.0, -0.1, 0.1]])


def model():
    theta = rm.inverse_kinematics(ROBOT, rm.pose_from_world(X_M)).theta
    return rm.cartesian_compliance(ROBOT, theta)


@pytest.mark.parametrize("factors", [(1.0, 1.0, 1.0), (2.0, 2.0, 2.0), (0.5, 0.8, 0.9), (3.0, 0.9, 1.25)])
def test_the_gap_is_the_share_of_the_measured(factors):
    k = np.array(factors)
    C = model() * k[:, None, None]
    found = MapCheck.of(MeasuredField(X_M[:, :3], C, X_M[:, 3:]), ROBOT)
    np.testing.assert_allclose(found.model, model(), rtol=1e-9)
    np.testing.assert_allclose(found.gap, np.abs(k - 1) / k, atol=1e-9)
    assert found.seen
    assert found.mean == pytest.approx(np.mean(np.abs(k - 1) / k), abs=1e-9)
    if len({*factors}) > 1:
        assert found.worst == np.argmax(np.abs(k - 1) / k)
        size = np.sqrt((model() ** 2).sum(axis=(1, 2)))
        assert found.softer == ((k - 1) @ size > 0)


def test_points_that_the_model_does_not_reach_are_left_out():
    far = X_M.copy()
    far[0, 0] = 9.0
    found = MapCheck.of(MeasuredField(far[:, :3], 2.0 * model(), far[:, 3:]), ROBOT)
    assert np.isnan(found.gap).tolist() == [True, False, False]
    assert found.seen
    assert found.mean == pytest.approx(0.5)
    assert found.worst in (1, 2)
    assert found.softer
    far[:, 0] = [8.0, 9.0, 10.0]
    nowhere = MapCheck.of(MeasuredField(far[:, :3], model(), far[:, 3:]), ROBOT)
    assert not nowhere.seen
    assert np.isnan(nowhere.mean)
    assert nowhere.worst == 0
