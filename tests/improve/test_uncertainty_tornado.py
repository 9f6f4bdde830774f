"""What each input alone does, against distributions of three points written out."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import norm

from robomill.arrays import FloatArray
from robomill.improve.uncertainty import _Work

INPUTS = tuple(SimpleNamespace(key=key) for key in ("one", "two", "three"))
ALONE = np.array([[2.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.25]])  # the second moves along with the first


def share(u: FloatArray) -> FloatArray:
    """Of the tolerance, by changes (k, 3): bent, and not alike on its two sides."""
    one, two, three = u.T
    bent = 0.004 * two**2 + np.where(three > 0.0, 0.4, 0.9) * three**2
    return np.asarray(0.5 + 0.03 * one + 0.02 * two + bent)


@pytest.mark.parametrize("variance", [0.02, 0.0])
def test_an_inputs_part_is_the_variance_of_three_points_and_the_largest_comes_first(variance: float) -> None:
    """Their mean and variance are those of the normal distribution: 1.96 deviations either way, each as likely as
    gives the variance 1, and none in between."""
    asked: list[FloatArray] = []

    def errors(change: FloatArray, stage: str) -> dict[str, FloatArray]:
        asked.append(change)
        return dict.fromkeys(("wall", "floor", "feed", "end"), np.full(len(change), np.nan)) | {"tip": share(change)}

    work = SimpleNamespace(
        unsure=SimpleNamespace(
            inputs=INPUTS,
            alone=lambda i: ALONE[i],
            setup=SimpleNamespace(limits={"tip": 1.0}, tolerance=1.0, feed_tolerance=None),
        ),
        measure="tip",
        errors=errors,
    )
    found = _Work.tornado(work, variance)  # type: ignore[arg-type]
    far = norm.ppf(0.975)
    likely = np.array([0.5, 2.0 * far**2 / 2.0 - 1.0, 0.5]) / far**2
    assert likely.sum() == pytest.approx(1.0)
    expected = {}
    for each, way in zip(INPUTS, ALONE, strict=True):
        low, here, high = share(np.outer([-far, 0.0, far], way))
        mean = likely @ [low, here, high]
        own = likely @ (np.array([low, here, high]) - mean) ** 2
        expected[each.key] = (low, high, own / variance if variance else 0.0)
    order = sorted(expected, key=lambda key: -expected[key][2])
    assert [each.key for each in found.inputs] == order
    for n, key in enumerate(order):
        assert (found.low[n], found.high[n], found.part[n]) == pytest.approx(expected[key], rel=1e-9)
    (changes,) = asked
    assert len(changes) == 7
