"""Fixed points: contractions with a known answer, divergence said and the one pass kept."""

import numpy as np
import pytest

from robomill.errors import SetupError
from robomill.simulation.coupling import fixed_point

GOAL = np.array([1.0, -2.0, 0.5])


@pytest.mark.parametrize("q", [0.0, 0.1, 0.5, -0.6, 0.9])
def test_contraction_reaches_its_fixed_point(q):
    result = fixed_point(lambda x: GOAL + q * (x - GOAL), np.zeros(3), tol=1e-9, max_iter=300)
    assert result.converged
    np.testing.assert_allclose(result.value, GOAL, atol=1.01e-9 * max(abs(q) / (1 - abs(q)), 1e-3))
    assert not result.one_pass.any()
    assert result.difference == pytest.approx(2.0, abs=1e-7)
    if q:
        assert result.contraction == pytest.approx(abs(q), rel=1e-3)
        # The k-th change is 2 (1 - q) |q|^(k-1).
        expected = 1 + np.log(1e-9 / (2 * (1 - q))) / np.log(abs(q))
        assert result.iterations == pytest.approx(expected, abs=1.01)


def test_order_of_a_smooth_contraction_and_its_message():
    result = fixed_point(lambda x: 0.2e-3 * np.cos(x * 1e3), np.zeros((4, 3)), tol=1e-12)
    assert result.converged
    np.testing.assert_allclose(result.value, 0.2e-3 * np.cos(result.value * 1e3), atol=1e-12)
    assert result.sentence.startswith(f"Coupling converged after {result.iterations} iterations, each change 0.03")
    assert "differs from one pass by at most" in result.sentence


@pytest.mark.parametrize("q", [-1.0, 1.3, -2.0])
def test_divergence_is_said_and_the_one_pass_kept(q):
    result = fixed_point(lambda x: GOAL + q * (x - GOAL), np.zeros(3), tol=1e-9, max_iter=50)
    assert not result.converged
    np.testing.assert_array_equal(result.value, result.one_pass)
    assert result.iterations <= 6
    assert result.difference == 0.0
    assert "does not converge" in result.sentence
    assert "the one-pass answer is kept" in result.sentence


def test_slow_convergence_stops_at_the_limit():
    result = fixed_point(lambda x: GOAL + 0.99 * (x - GOAL), np.zeros(3), tol=1e-9, max_iter=7)
    assert (result.converged, result.iterations, len(result.changes)) == (False, 7, 7)
    assert "0.99 of the one before" in result.sentence


def test_numbers_lost_on_the_way():
    calls = []

    def breaks(x):
        calls.append(x)
        return np.full(3, np.nan) if len(calls) == 3 else GOAL * len(calls)

    result = fixed_point(breaks, np.zeros(3), tol=1e-9)
    assert not result.converged
    np.testing.assert_array_equal(result.value, 0.0)
    assert "not a number" in result.sentence


def test_unreached_steps_do_not_count():
    def step(x):
        y = GOAL + 0.1 * (x - GOAL)
        y[1] = np.nan
        return y

    result = fixed_point(step, [0.0, np.nan, 0.0], tol=1e-9)
    assert result.converged
    np.testing.assert_allclose(result.value[[0, 2]], GOAL[[0, 2]], atol=1e-9)
    assert np.isnan(result.value[1])
    assert np.isfinite(result.difference)


def test_no_coupling_at_all_takes_one_iteration():
    result = fixed_point(lambda x: GOAL, GOAL, tol=1e-9)
    assert (result.converged, result.iterations, result.difference) == (True, 1, 0.0)
    assert result.sentence == "Coupling converged after 1 iteration; it differs from one pass by at most 0.0 µm."


def test_refusals():
    with pytest.raises(SetupError, match="tolerance is 0; it must be greater than 0"):
        fixed_point(lambda x: x, 0.0, tol=0.0)
    with pytest.raises(SetupError, match="0 iterations; it takes at least 1"):
        fixed_point(lambda x: x, 0.0, tol=1.0, max_iter=0)
