"""How readings move with the tip: by loops over each of them, and as what is known of the steps that made them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from robomill.arrays import FloatArray, IntArray
from robomill.improve.surfaces import Surfaces, surfaces
from robomill.simulation.judging.gauge import Readings
from tests.improve.test_makers import N, passes, reading

LEFT = np.array([0.0, 1.0, 0.0])


def together(*parts: Readings) -> Readings:
    names = Readings.__dataclass_fields__
    return Readings(*(np.concatenate([getattr(each, name) for each in parts]) for name in names))


def off(run: SimpleNamespace, at: IntArray, delta: FloatArray) -> FloatArray:
    """(1, s, 3) m: displacements (m, 3) m in {M} as a screen has them at some samples."""
    return np.einsum("mij,mj->mi", run.R_MF, delta)[None, at]


@pytest.mark.parametrize("seed", range(4))
def test_the_largest_reading_and_that_of_each_sample_by_loops(seed: int) -> None:
    rng, s, q, k = np.random.default_rng(seed), 6, 9, 3
    at, by, toward = rng.integers(0, s - 1, q), rng.integers(0, s, (q, 2)), rng.normal(size=(q, 2, 3))
    toward[::2, 0] = 0.0
    low = rng.normal(size=q)
    high = low + rng.uniform(0.0, 1.0, q)
    low[:3] = high[:3] = np.nan
    d = rng.normal(size=(k, s, 3))
    largest, each = np.zeros(k), np.zeros((k, s))
    for draw in range(k):
        for n in range(q):
            own = sum(float(toward[n, b] @ d[draw, by[n, b]]) for b in (0, 1))
            size = max(own, 0.0) if np.isnan(low[n]) else max(abs(own + low[n]), abs(own + high[n]))
            largest[draw] = max(largest[draw], size)
            each[draw, at[n]] = max(each[draw, at[n]], size)
    some = Surfaces(at, by, toward, low, high)
    np.testing.assert_allclose(some.largest(d), largest, rtol=1e-12)
    np.testing.assert_allclose(some.by_sample(d), each, rtol=1e-12)
    none = Surfaces(at[:0], by[:0], toward[:0], low[:0], high[:0])
    assert np.isnan(none.largest(d)).all()
    assert not none.by_sample(d).any()


def test_readings_of_a_sample_move_with_it_and_keep_what_they_were_more() -> None:
    """Two that go alike are one with a lowest and a highest; one beside a sample that is not looked at is left out."""
    run, at = passes(4), np.array([3, 7, N + 5, N + 6, 2 * N + 4])
    more = {3: (0.0,), N + 6: (-1e-6, 1.5e-6, 0.5e-6), 2 * N + 4: (1e-6,), 9: (0.0,)}
    parts = [reading(run, i, LEFT, float(run.delta[i] @ LEFT) + each) for i, rests in more.items() for each in rests]
    found = surfaces(together(*parts), run, at)
    moved = run.delta + np.random.default_rng(7).normal(size=run.delta.shape) * 0.2e-3
    expected = [max((abs(moved[i] @ LEFT + each) for each in more.get(i, ())), default=0.0) for i in at.tolist()]
    np.testing.assert_allclose(found.by_sample(off(run, at, moved))[0], expected, atol=1e-12)
    assert found.largest(off(run, at, moved))[0] == pytest.approx(max(expected))


@pytest.mark.parametrize("still", [False, True])
def test_what_no_step_explains_grows_as_what_pushes_there_does(still: bool) -> None:
    """With the deviation of its own sample, or the largest one, where the tool stands still there."""
    run, at = passes(3), np.array([2, 8, 30])
    run.delta = np.abs(run.delta) * [0.0, -1.0, 0.0] - 0.05e-3 * LEFT
    if still:
        run.delta[8] = 0.0
    run.delta_in_cut = np.einsum("mij,mj->mi", run.R_MF, run.delta)
    run.worst = 30
    found = surfaces(reading(run, 8, LEFT, 0.7e-3), run, at)
    for times in (1.0, 0.5, 3.0):
        assert found.largest(off(run, at, times * run.delta))[0] == pytest.approx(times * 0.7e-3)
    alone = run.delta.copy()
    alone[30 if still else 8] *= 2.0
    assert found.largest(off(run, at, alone))[0] == pytest.approx(1.4e-3)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_where_another_pass_made_the_surface_the_sample_counts_as_far_as_it_goes_deeper(sign: float) -> None:
    run, i, step = passes(3), 8, 2 * N - 9
    run.delta = -sign * np.abs(run.delta) * LEFT - 0.05e-3 * sign * LEFT
    run.delta[step - 1 : step + 1] = np.outer([0.1e-3, 0.3e-3], sign * LEFT)
    run.delta[step + 1 : 2 * N] = 0.4e-3 * sign * LEFT
    run.delta_in_cut = np.einsum("mij,mj->mi", run.R_MF, run.delta)
    one = reading(run, i, LEFT, 0.2e-3 * sign)
    own = replace(one, own=run.delta[[i]] @ LEFT)
    at = np.array([i, step - 1, step])
    found = surfaces(own, run, at)
    assert found.largest(off(run, at, run.delta))[0] == pytest.approx(0.2e-3)
    for deeper, expected in ((0.5e-3, 0.5e-3), (0.15e-3, 0.2e-3), (-0.5e-3, 0.2e-3)):
        moved = run.delta.copy()
        moved[i] = deeper * sign * LEFT
        assert found.largest(off(run, at, moved))[0] == pytest.approx(expected)
