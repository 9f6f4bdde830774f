"""The load tests that these tests make: by label, and off every model by as much as is asked."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.fit.models import Model
from robomill.identification.synthesis import three_directions
from tests.identification.synthetic import simulated_tests, true_parameters

ROBOT = rm.load_robot("slavkovic_5r").with_compliance_set("table_3")
THETA = np.random.default_rng(0).uniform(ROBOT.limits[:, 0], ROBOT.limits[:, 1], (30, 5))


def read(**options):
    return simulated_tests(ROBOT, *three_directions(THETA, 250.0), **options).displacement[:, :3]


def test_model_error_bends_each_pose_its_own_way_but_stays_elastic():
    C = np.swapaxes(read(model_error=0.2, seed=4).reshape(30, 3, 3), -1, -2) / 250.0
    np.testing.assert_allclose(C, np.swapaxes(C, -1, -2), atol=1e-12)
    assert (np.linalg.eigvalsh(C)[:, 0] > -1e-12).all()
    exact = rm.cartesian_compliance(ROBOT, THETA)
    small = 1e-4  # (1 + s G / 2) C (1 + s G / 2)^T: of each diagonal term s G_ii C_ii, of standard deviation s C_ii
    off = np.swapaxes(read(model_error=small, seed=4).reshape(30, 3, 3), -1, -2) / 250.0 - exact
    G = np.random.default_rng(4).standard_normal((30, 3, 3))
    order = np.argsort(np.lexsort(THETA.T[::-1]))
    first = 0.5 * small * (G[order] @ exact + exact @ np.swapaxes(G[order], -1, -2))
    np.testing.assert_allclose(off, first, atol=5 * small**2 * np.abs(exact).max())


def test_parameters_by_label():
    model = Model("joints+tool")
    np.testing.assert_array_equal(true_parameters(ROBOT, model, {"tool along": 3e-8}), [*ROBOT.C_theta, 0.0, 3e-8])
    assert not true_parameters(ROBOT, Model("constant")).any()
    with pytest.raises(LoadTestError, match="tool across, tool along"):
        true_parameters(ROBOT, model, {"tool sideways": 1.0})
    np.testing.assert_allclose(read(model=model), read(), atol=1e-18)
    assert not np.allclose(read(model=model, extra={"tool across": 1e-7}), read(), rtol=1e-3)
