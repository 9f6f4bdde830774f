"""Scatters of groups and the weights that come of them, in closed form.

Joints loaded one at a time, by one torque: what is left over is each angle's distance from its joint's mean.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.identification.fit.balance import _differ, _distinct, _scatters, balanced
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import build_system
from robomill.identification.load_test import JointTests

ROBOT = rm.load_robot("slavkovic_5r")
SPREAD = {6: [-2.5, -1.5, -0.5, 0.5, 1.5, 2.5], 5: [-2.0, -1.0, 0.0, 1.0, 2.0]}  # readings about their mean, evenly


def single_joints(*scatter):
    """The system of tests, and each one's group: readings (count, step) of a joint stand ``step`` apart."""
    joint = np.concatenate([np.full(count, j) for j, (count, _) in enumerate(scatter, 1)])
    about = np.concatenate([step * np.array(SPREAD[count]) for count, step in scatter])
    system = build_system(ROBOT, JointTests(joint, np.full(len(joint), 300.0), 1e-3 + about), Model())
    return system, joint - 1


def deviation(count, step):
    return step * float(np.std(SPREAD[count], ddof=1))


def test_a_groups_scatter_is_its_standard_deviation_and_its_spare_readings_one_less_than_its_readings():
    system, own = single_joints((6, 1e-6), (5, 3e-6), (6, 4e-6))
    size, spare = _scatters(system, own)
    np.testing.assert_allclose(size, [deviation(6, 1e-6), deviation(5, 3e-6), deviation(6, 4e-6)], rtol=1e-6)
    np.testing.assert_allclose(spare, [5.0, 4.0, 5.0], rtol=1e-9)


def test_two_gross_readings_on_either_side_are_no_scatter():
    """Left out, each with the sixth of a number that it told of its joint."""
    system, own = single_joints((6, 1e-6), (6, 1e-6))
    gross = 1e-3 * np.array([-1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 0, 0])
    size, spare = _scatters(replace(system, b=system.b + gross), own)
    left = np.array(SPREAD[6][1:5]) * 1e-6
    np.testing.assert_allclose(spare, [4 - 4 / 6, 5.0], rtol=1e-6)
    np.testing.assert_allclose(size[0], np.sqrt((left**2).sum() / (4 - 4 / 6)), rtol=1e-4)


@pytest.mark.parametrize(("step", "free"), [(0.6e-12, 0.0), (0.8e-12, 5.0)])
def test_a_scatter_below_a_thousand_millionth_of_the_readings_is_rounding(step, free):
    """The middle distance from the mean is one and a half steps, over 0.6745; readings are of 1e-3."""
    step *= 0.6745
    assert (1.5 * step / 0.6745 > 1e-12) == (free > 0)
    system, own = single_joints((6, 1e-6), (6, step))
    np.testing.assert_allclose(_scatters(system, own)[1], [5.0, free], rtol=1e-6)


@pytest.mark.parametrize("steps", [(1e-6, 2e-5, 3e-6), (2e-5, 1e-6, 3e-6), (1e-6, 3e-6, 2e-5)])
def test_noise_is_the_scatter_over_the_typical_one(steps):
    system, own = single_joints(*((6, step) for step in steps))
    scatter = np.array(steps)
    weight = scatter / np.sqrt(np.mean(scatter**2))
    np.testing.assert_allclose(balanced(system, own).noise, system.noise * weight[own], rtol=1e-6)


def test_the_noisiest_counts_as_a_hundred_times_the_quietest_at_most():
    system, own = single_joints((6, 1e-9), (6, 3e-6), (6, 1e-6))
    x, y, z = (float(balanced(system, own).noise[own == k][0]) for k in range(3))
    assert y / x == pytest.approx(100.0)
    assert y / z == pytest.approx(3.0)


def test_a_group_of_too_few_readings_keeps_its_weight():
    """Five readings leave four to spare: one too few to judge its scatter by. Of two groups nothing is judged then."""
    system, own = single_joints((6, 1e-6), (6, 2e-5), (5, 1e-3))
    noise = balanced(system, own).noise
    assert noise[own == 1][0] / noise[own == 0][0] == pytest.approx(20.0)
    np.testing.assert_array_equal(noise[own == 2], system.noise[own == 2])
    for pair in (((6, 1e-6), (5, 1e-4)), ((5, 1e-6), (5, 1e-4))):
        system, own = single_joints(*pair)
        assert balanced(system, own) is system


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 2, 0)])
def test_the_largest_and_the_smallest_differ_by_four_standard_deviations_of_their_logarithms(order):
    """The logarithm of a scatter of n spare readings has the variance 1 / (2 n)."""
    spare = np.array([8.0, 50.0, 18.0])[list(order)]
    limit = np.exp(4.0 * np.sqrt(1 / 16 + 1 / 36))
    for times, said in ((0.999, False), (1.001, True)):
        assert _differ(np.array([3.0, 4.0, 3.0 * limit * times])[list(order)], spare) == said


def test_equations_that_are_copies_are_taken_once():
    system, own = single_joints((6, 1e-6), (5, 1e-5))
    index = np.random.default_rng(1).permutation(np.tile(np.arange(11), 3))
    many = build_system(ROBOT, JointTests(own[index] + 1, np.full(33, 300.0), np.asarray(system.b)[index]), Model())
    part, group = _distinct(many, own[index])
    assert sorted(zip(part.b.tolist(), group.tolist(), strict=True)) == sorted(
        zip(system.b.tolist(), own.tolist(), strict=True)
    )
    assert (np.diff(part.test) > 0).all(), "in their order"
    np.testing.assert_array_equal(part.A.argmax(axis=1), group)
    same, kept = _distinct(system, own)
    assert same is system
    assert kept is own
