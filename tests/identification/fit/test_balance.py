"""Components that scatter unlike: coverage counted over draws of noise, and weights from their definition."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.identification.fit.balance import balanced
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import build_system
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.synthesis import three_directions
from tests.identification.synthetic import simulated_tests

ROBOT = rm.load_robot("slavkovic_5r").with_compliance_set("table_3")
RNG = np.random.default_rng(3)
LOW, HIGH = ROBOT.limits.T
THETA, F = three_directions(RNG.uniform(0.8 * LOW + 0.2 * HIGH, 0.2 * LOW + 0.8 * HIGH, (12, 5)), 300.0)
CLEAN = simulated_tests(ROBOT, THETA, F).displacement[:, :3]
DRAWS = 300


def _system(noise, rng):
    read = CLEAN + np.asarray(noise) * rng.standard_normal(CLEAN.shape)
    return build_system(ROBOT, LoadTests(F, read, theta=THETA), Model())


def _coverage(noise, weigh):
    """(n,) share of draws whose intervals hold the truth."""
    rng = np.random.default_rng(5)
    held = []
    for _ in range(DRAWS):
        system = weigh(_system(noise, rng))
        low, high = system.fit().interval(system.signed).T
        held.append((low <= ROBOT.C_theta) & (ROBOT.C_theta <= high))
    return np.mean(held, axis=0)


@pytest.mark.parametrize(("noisy", "before"), [(0, 0.77), (1, 0.94), (2, 0.83)])
def test_intervals_hold_where_one_gauge_is_ten_times_noisier(noisy, before):
    """With one noise for all they hold a joint of which that gauge tells most in ``before`` of the draws."""
    noise = np.full(3, 5e-6)
    noise[noisy] = 50e-6
    assert _coverage(noise, balanced).min() > 0.90
    assert _coverage(noise, lambda system: system).min() == pytest.approx(before, abs=0.03)


def test_weights_are_the_scatters_and_the_typical_reading_keeps_its_own():
    system = _system([5e-6, 5e-6, 50e-6], np.random.default_rng(0))
    x, y, z = (float(np.unique(balanced(system).noise[system.component == k])[0]) for k in range(3))
    assert z / x == pytest.approx(10.0, rel=0.4)
    assert y / x == pytest.approx(1.0, rel=0.4)
    assert np.mean(np.square([x, y, z])) == pytest.approx(1.0, rel=0.1)


@pytest.mark.parametrize("times", [-1.0, 1e-6, -1e4])
def test_weights_are_the_same_under_other_loads_and_in_other_units(times):
    """Forces and displacements so many times as large, or turned round."""
    read = CLEAN + np.array([5e-6, 5e-6, 50e-6]) * np.random.default_rng(0).standard_normal(CLEAN.shape)
    plain, other = (
        balanced(build_system(ROBOT, LoadTests(k * F, k * read, theta=THETA), Model())).noise for k in (1.0, times)
    )
    assert np.ptp(plain) > 0.0
    np.testing.assert_allclose(other, plain, rtol=1e-6)


@pytest.mark.parametrize("times", [2, 5])
def test_copies_of_rows_make_no_scatter_surer(times):
    """The weights of the rows alone; what differs by chance once differs by chance in copies too."""
    rng = np.random.default_rng(0)
    for noise, weighed in (([5e-6, 5e-6, 50e-6], True), ([8e-6, 8e-6, 10e-6], False)):
        read = CLEAN + np.array(noise) * rng.standard_normal(CLEAN.shape)
        index = rng.permutation(np.tile(np.arange(len(F)), times))
        one, many = (
            balanced(build_system(ROBOT, LoadTests(F[k], read[k], theta=THETA[k]), Model()))
            for k in (np.arange(len(F)), index)
        )
        assert (np.ptp(one.noise) > 0.0) == weighed
        np.testing.assert_allclose(many.noise.reshape(-1, 3), one.noise.reshape(-1, 3)[index])


def test_scatters_that_differ_by_chance_alone_weigh_nothing():
    rng = np.random.default_rng(1)
    assert sum(balanced(system) is not system for system in (_system(np.full(3, 8e-6), rng) for _ in range(100))) <= 2


def test_a_gross_row_and_rounding_are_no_scatter():
    rng = np.random.default_rng(2)
    read = CLEAN + 5e-6 * rng.standard_normal(CLEAN.shape)
    read[4, 2] += 5e-3
    for displacement in (read, CLEAN):
        system = build_system(ROBOT, LoadTests(F, displacement, theta=THETA), Model())
        assert balanced(system) is system


def test_good_rows_of_a_noisy_gauge_are_no_outliers():
    """With one noise for all 20 of 36 rows are called outliers: the noisy gauge's larger errors."""
    rng = np.random.default_rng(4)
    read = CLEAN + np.array([5e-6, 5e-6, 50e-6]) * rng.standard_normal(CLEAN.shape)
    assert rm.identify(ROBOT, LoadTests(F, read, theta=THETA)).outliers == ()
    read[7, 0] += 80e-6
    assert [each.row for each in rm.identify(ROBOT, LoadTests(F, read, theta=THETA)).outliers] == [8]


@pytest.mark.parametrize(("weighed", "held"), [(True, 0.91), (False, 0.56)])
def test_single_joints_that_are_read_ten_times_worse_have_intervals_of_their_own(weighed, held, monkeypatch):
    """One noise for all joints took that of the well read ones for joint 5's."""
    if not weighed:
        monkeypatch.setattr("robomill.identification.fit.estimate.balanced", lambda system, group: system)
    rng = np.random.default_rng(6)
    joint, torque = np.repeat(np.arange(1, 6), 8), np.tile(np.linspace(100.0, 450.0, 8), 5)
    scatter = np.where(joint == 5, 2e-5, 2e-6)
    inside = []
    for _ in range(100):
        angle = ROBOT.C_theta[joint - 1] * torque + scatter * rng.standard_normal(40)
        low, high = rm.identify(ROBOT, JointTests(joint=joint, torque=torque, angle=angle)).ci95.T
        inside.append((low <= ROBOT.C_theta) & (ROBOT.C_theta <= high))
    assert np.mean(inside, axis=0)[4] == pytest.approx(held, abs=0.05)
    assert np.mean(inside, axis=0).min() > held - 0.06
