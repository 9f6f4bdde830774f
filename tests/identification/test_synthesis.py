"""Made-up readings: exact without noise, with the noise that was asked for, rounded as a gauge rounds."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.identification.synthesis import simulated_tests, three_directions

ROBOT = rm.load_robot("slavkovic_5r").with_compliance_set("table_3")
THETA = np.random.default_rng(0).uniform(ROBOT.limits[:, 0], ROBOT.limits[:, 1], (30, 5))
F_3 = np.tile(np.eye(3) * 250.0, (30, 1))


def read(**options):
    return simulated_tests(ROBOT, *three_directions(THETA, 250.0), **options).displacement[:, :3]


def test_three_directions():
    theta, F = three_directions(THETA, 250.0)
    np.testing.assert_array_equal(F, F_3)
    np.testing.assert_array_equal(theta[::3], THETA)
    np.testing.assert_array_equal(theta[2::3], THETA)


def test_without_noise_they_are_c_times_f():
    expected = np.swapaxes(rm.cartesian_compliance(ROBOT, THETA), -1, -2).reshape(-1, 3) * 250.0
    np.testing.assert_allclose(read(), expected, rtol=1e-12, atol=1e-18)
    np.testing.assert_array_equal(read(), read(seed=3))
    tests = simulated_tests(ROBOT, *three_directions(THETA, 250.0))
    assert tests.provenance.kind == "synthetic"
    assert np.isnan(tests.noise).all()


def test_noise_has_its_size_and_its_seed():
    off = read(noise=4e-6, seed=1) - read()
    assert off.std() == pytest.approx(4e-6, rel=0.15)
    assert abs(off.mean()) < 1e-6
    np.testing.assert_array_equal(read(noise=4e-6), read(noise=4e-6, seed=0))
    assert not np.array_equal(read(noise=4e-6, seed=1), read(noise=4e-6, seed=2))


def test_a_gauge_rounds_to_its_resolution():
    steps = read(resolution=1e-6) / 1e-6
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
    gap = read(resolution=1e-6) - read()
    assert np.abs(gap).max() <= 0.5000001e-6
    assert np.abs(gap).max() > 0.4e-6
