"""Between a design that does not hold and the stiffest joints: halved to where the tolerance is kept."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from robomill.improve import design as module
from robomill.improve.design import _Search

X, LOW = np.array([1.0, 0.8, 1.0]), np.array([0.25, 0.2, 1.0])


@pytest.mark.parametrize("threshold", [0.01, 0.3, 0.5, 0.77, 0.99])
def test_the_first_design_on_the_way_that_keeps_the_tolerance_is_found_to_a_sixty_fourth(
    monkeypatch: pytest.MonkeyPatch, threshold: float
) -> None:
    """By equal factors from x to the stiffest: parts of the way by their logarithms."""

    def part(x: np.ndarray) -> float:
        return float(np.log(x[0] / X[0]) / np.log(LOW[0] / X[0]))

    monkeypatch.setattr(module, "judged", lambda x, measure: SimpleNamespace(share=2.0 - (part(x) > threshold)))
    own = SimpleNamespace(low=LOW, at=lambda x: x, measure="verdict")
    x, run, residual = _Search.on_the_way(own, X, X, 0.5)  # type: ignore[arg-type]
    assert threshold < part(x) <= threshold + 1.0 / 64.0 + 1e-9
    np.testing.assert_allclose(run, x, rtol=1e-12)
    np.testing.assert_allclose(np.log(x / X)[:2] / np.log(LOW / X)[:2], part(x))
    assert np.isnan(residual)


@pytest.mark.parametrize(("stiffest", "taken"), [(1.5, True), (1.9, True), (2.0, False), (2.5, False)])
def test_where_not_even_the_stiffest_keep_it_the_better_of_the_two_is_taken(
    monkeypatch: pytest.MonkeyPatch, stiffest: float, taken: bool
) -> None:
    shares = {"first": 2.0, "stiffest": stiffest}
    monkeypatch.setattr(module, "judged", lambda run, measure: SimpleNamespace(share=shares[run]))
    own = SimpleNamespace(low=LOW, at=lambda x: "stiffest", measure="verdict")
    x, run, residual = _Search.on_the_way(own, X, "first", 0.5)  # type: ignore[arg-type]
    assert (run, residual) == ("stiffest" if taken else "first", 0.5)
    np.testing.assert_array_equal(x, LOW if taken else X)
