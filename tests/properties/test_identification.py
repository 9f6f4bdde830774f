"""What must hold for any measurements: invariances of the estimate, and a reader that never breaks."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings, strategies as st

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.fit.estimate import identify
from robomill.identification.load_test import LoadTests
from robomill.io.measured.load_tests import read_load_tests
from tests.identification.synthetic import simulated_tests

ROBOT = rm.load_robot("slavkovic_5r")
HEADER = "theta1_deg,theta2_deg,theta3_deg,theta4_deg,theta5_deg,Fx_N,Fy_N,Fz_N,dx_mm,dy_mm,dz_mm\n"
GOOD = HEADER + "10,-20,30,0,15,0,250,0,0.01,0.5,-0.2\n-10,-30,20,10,25,250,0,0,0.4,0.02,-0.1\n"
quick = settings(max_examples=25, deadline=None)


def some_tests(seed, count=10):
    rng = np.random.default_rng(seed)
    theta = rng.uniform(ROBOT.limits[:, 0], ROBOT.limits[:, 1], (count, 5))
    return simulated_tests(ROBOT, theta, rng.normal(size=(count, 3)) * 200, noise=1e-5, seed=seed)


@quick
@given(seed=st.integers(0, 10**6))
def test_the_order_of_rows_does_not_matter(seed):
    tests = some_tests(seed)
    order = np.random.default_rng(seed).permutation(len(tests))
    one, two = identify(ROBOT, tests), identify(ROBOT, tests.select(order))
    np.testing.assert_allclose(one.C_theta, two.C_theta, rtol=1e-9, atol=1e-16)
    np.testing.assert_allclose(one.stderr, two.stderr, rtol=1e-9)


@quick
@given(seed=st.integers(0, 10**6), load=st.floats(1e-3, 1e3), gauge=st.floats(1e-3, 1e3))
def test_the_estimate_scales_with_load_and_gauge(seed, load, gauge):
    tests = some_tests(seed)
    scaled = LoadTests(tests.wrench * load, tests.displacement * gauge, theta=tests.theta)
    one, two = identify(ROBOT, tests), identify(ROBOT, scaled)
    np.testing.assert_allclose(two.parameters, one.parameters * gauge / load, rtol=1e-8, atol=1e-20 * gauge / load)
    assert abs(two.cv_relative_error - one.cv_relative_error) < 1e-8
    np.testing.assert_allclose(two.condition, one.condition, rtol=1e-8)


@quick
@given(seed=st.integers(0, 10**6), times=st.integers(2, 4))
def test_measuring_everything_again_narrows_the_intervals_as_it_should(seed, times):
    """Copies of the same readings: same estimate; the standard error falls with the degrees of freedom."""
    tests = some_tests(seed)
    more = tests
    for _ in range(times - 1):
        more = more.joined(tests)
    one, two = identify(ROBOT, tests), identify(ROBOT, more)
    np.testing.assert_allclose(two.parameters, one.parameters, rtol=1e-8, atol=1e-16)
    np.testing.assert_allclose(two.stderr, one.stderr * np.sqrt(one.dof / two.dof), rtol=1e-8)


@quick
@given(seed=st.integers(0, 10**6))
def test_intervals_hold_the_estimate_and_are_not_negative(seed):
    result = identify(ROBOT, some_tests(seed, 4), "joints+bending+tool")
    known = np.isfinite(result.parameter_stderr)
    assert (result.parameters >= 0).all()
    assert (result.parameter_ci95[known, 0] <= result.parameters[known]).all()
    assert (result.parameters[known] <= result.parameter_ci95[known, 1]).all()
    assert (result.parameter_ci95[known] >= 0).all()


@settings(max_examples=200, deadline=None)
@given(at=st.integers(0, len(GOOD)), cut=st.integers(0, 12), put=st.text(max_size=6))
def test_the_reader_reads_or_refuses_in_one_sentence(at, cut, put):
    text = GOOD[:at] + put + GOOD[at + cut :] + "\n"
    said = ""
    try:
        assert len(read_load_tests(text)) >= 1
    except LoadTestError as refusal:
        said = str(refusal)
    assert said == "" or said.endswith(".")
