"""A distribution as a value: probability and its interval against SciPy's, quantiles by sorting, both tables."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import binomtest

from robomill.errors import SetupError
from robomill.improve.draws import Tornado, Uncertainty

N = 40
NAN = float("nan")


def drawn(share: np.ndarray, measure: str = "verdict", **given: object) -> Uncertainty:
    m = len(share)
    rows = {name: np.linspace(0.1e-3, 0.4e-3, m) for name in ("wall", "floor", "tip")} | given
    return Uncertainty(None, measure, (), np.zeros((m, 0)), share, **rows, tornado=None, checked=(0, 0.0), seed=0)


@pytest.mark.parametrize("kept", [0, 1, 17, N - 1, N])
def test_the_interval_of_the_probability_is_the_exact_one(kept: int) -> None:
    share = np.where(np.arange(N) < kept, 1.0, 1.0 + 1e-9)
    if kept < N:
        share[-1] = NAN  # not reached
    found = drawn(share)
    exact = binomtest(kept, N).proportion_ci(0.95, method="exact")
    assert found.interval == pytest.approx((exact.low, exact.high), abs=1e-12)
    assert found.probability == kept / N
    assert found.samples == N


def test_the_error_is_the_larger_of_wall_and_floor_and_the_tips_where_there_is_neither() -> None:
    wall, floor, tip = (np.array(each) for each in ([1.0, NAN, 4.0, NAN], [2.0, 3.0, NAN, NAN], [9.0, 9.0, 9.0, 9.0]))
    given = {"wall": wall, "floor": floor, "tip": tip}
    assert drawn(np.ones(4), **given).error.tolist() == [2.0, 3.0, 4.0, 9.0]
    for name, values in given.items():
        np.testing.assert_array_equal(drawn(np.ones(4), name, **given).error, values)
    some = drawn(np.ones(4), **given)
    assert some.mean == pytest.approx(4.5)
    assert some.std == pytest.approx(np.sqrt((2.5**2 + 1.5**2 + 0.5**2 + 4.5**2) / 3))


@pytest.mark.parametrize("level", [0.0, 0.2, 0.5, 0.95, 1.0])
def test_a_quantile_is_the_first_that_so_many_do_not_exceed(level: float) -> None:
    """Of those that are not reached it is beyond any."""
    share = np.random.default_rng(4).permutation(np.linspace(0.5, 1.5, N))
    share[share > 1.4] = NAN
    found = drawn(share).quantile(level, "share")
    ordered = sorted(np.inf if np.isnan(each) else each for each in share)
    assert found == ordered[int(np.ceil(level * (N - 1) - 1e-9))]
    assert np.isnan(drawn(np.full(3, NAN)).quantile(level, "share"))


@pytest.mark.parametrize("level", [-0.01, 1.01, NAN])
def test_a_level_beyond_nothing_and_all_is_refused(level: float) -> None:
    with pytest.raises(SetupError, match="expected a number from 0 to 1"):
        drawn(np.ones(3)).quantile(level)
    with pytest.raises(SetupError, match="expected error, wall, floor, tip or share"):
        drawn(np.ones(3)).quantile(0.5, "walls")


def test_the_tables_are_in_the_units_of_their_inputs() -> None:
    def number(key: str, unit: str, value: float, std: float) -> SimpleNamespace:
        return SimpleNamespace(
            key=key, unit=unit, value=value, std=std, label=key, provenance=SimpleNamespace(kind="user")
        )

    inputs = number("length", "mm", 0.3, 2e-3), number("turn", "deg", np.pi / 6, np.pi / 180)
    change = np.array([[1e-3, 0.0], [-2e-3, np.pi / 90]])
    size = np.array([0.2e-3, 0.5e-3])
    found = Uncertainty(None, "verdict", inputs, change, np.array([0.5, 2.0]), size, size, size, None, (0, 0.0), 0)  # type: ignore[arg-type]
    table = found.columns()
    np.testing.assert_allclose(table["length"], [301.0, 298.0])
    np.testing.assert_allclose(table["turn"], [30.0, 32.0])
    for name in ("wall_mm", "floor_mm", "tip_mm"):
        np.testing.assert_allclose(table[name], [0.2, 0.5])
    assert table["meets"].tolist() == [True, False]
    bars = Tornado(inputs, np.array([0.1, 0.2]), np.array([0.3, 0.4]), np.array([0.6, 0.2])).columns()  # type: ignore[arg-type]
    np.testing.assert_allclose(bars["value"], [300.0, 30.0])
    np.testing.assert_allclose(bars["std"], [2.0, 1.0])
    assert [bars[name].tolist() for name in ("share_low", "share_high", "variance_part")] == [
        [0.1, 0.2],
        [0.3, 0.4],
        [0.6, 0.2],
    ]


def test_what_a_notebook_shows_of_draws_are_their_numbers() -> None:
    """Three of four keep the tolerance: 75 %, and by the exact interval of SciPy 19.4 to 99.4 %."""
    size, run = np.array([0.1, 0.2, 0.3, 0.4]) * 1e-3, SimpleNamespace(max_deviation=0.25e-3)
    tornado = SimpleNamespace(inputs=[SimpleNamespace(label="Tool length")], part=np.array([0.6]))
    found = drawn(np.array([0.1, 0.2, 0.3, 1.4]), wall=size, floor=0.5 * size, tip=size)
    facts = dict(replace(found, run=run, tornado=tornado)._facts())
    exact = binomtest(3, 4).proportion_ci(0.95, method="exact")
    numbers = {name: [float(each) for each in re.findall(r"[0-9.]+", words)] for name, words in facts.items()}
    assert numbers["As it is"] == [0.25]
    assert numbers["Mean and standard deviation"] == [0.25, 0.129]
    assert numbers["95 % of the draws keep"] == [0.4]
    assert numbers["Tolerance kept"] == pytest.approx([75.0, 100 * exact.low, 100 * exact.high], abs=0.051)
    assert numbers["Draws"] == [4]
    assert facts["Most of it"].startswith("Tool length, 60")
