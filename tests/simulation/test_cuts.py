"""The force of a whole run against brute force, in cuts of every kind; 5 % of its size is the bar."""

from __future__ import annotations

import pytest

from tests.simulation.cuts import CASES, CutCase


@pytest.mark.parametrize(
    ("case", "step"), [pytest.param(case, step, id=f"{case.name}, {step} mm") for case in CASES for step in case.steps]
)
def test_force_of_a_cut(case: CutCase, step: float) -> None:
    assert case.off(step) < 0.05
