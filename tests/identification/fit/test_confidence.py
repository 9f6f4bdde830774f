"""Widths of intervals and weights of strays, against the distributions themselves."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import integrate, stats

from robomill.identification.fit.confidence import BISQUARE, MAD, bisquare, half_width, quantile


@pytest.mark.parametrize("level", [0.5, 0.95, 0.99])
@pytest.mark.parametrize("dof", [1, 4, 60, None])
def test_an_interval_holds_its_share_of_what_is_drawn(dof, level):
    density = stats.norm.pdf if dof is None else stats.t(dof).pdf
    inside, _ = integrate.quad(density, -quantile(dof, level), quantile(dof, level))
    assert inside == pytest.approx(level, abs=1e-8)


def test_where_nothing_is_left_to_judge_by_an_interval_has_no_end():
    assert quantile(0) == quantile(-1) == np.inf
    np.testing.assert_array_equal(half_width([0.0, 2.0], 0), [np.inf, np.inf])
    np.testing.assert_allclose(half_width([0.0, 2.0], 7), [0.0, 2.0 * stats.t.ppf(0.975, 7)])


def test_the_weight_of_a_stray_falls_to_nothing_and_costs_a_twentieth_on_normal_noise():
    """Tukey's psi = u w(u): the variance of a mean by it, E psi^2 / (E psi')^2, is 1 / 0.95 that of the plain mean."""
    u = np.linspace(-12.0, 12.0, 200_001)
    weight, density = bisquare(u), stats.norm.pdf(u)
    assert (weight[np.abs(u) >= BISQUARE] == 0.0).all()
    assert (np.diff(weight[u >= 0.0]) <= 0.0).all()
    assert weight.max() == 1.0
    psi = u * weight
    variance = np.trapezoid(psi**2 * density, u) / np.trapezoid(np.gradient(psi, u) * density, u) ** 2
    assert 1.0 / variance == pytest.approx(0.95, abs=1e-4)
    assert stats.norm.cdf(MAD) - stats.norm.cdf(-MAD) == pytest.approx(0.5)
