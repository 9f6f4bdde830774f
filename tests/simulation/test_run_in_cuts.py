"""The force of a whole run against brute force, in cuts of every kind; 5 % of its size is the bar."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import qmc

import robomill as rm
from tests.simulation.cuts import CASES, MM, CutCase


@pytest.mark.parametrize(
    ("case", "step"), [pytest.param(case, step, id=f"{case.name}, {step} mm") for case in CASES for step in case.steps]
)
def test_force_of_a_cut(case: CutCase, step: float) -> None:
    assert case.off(step) < 0.05


@pytest.mark.parametrize("case", [case for case in CASES if case.holes], ids=lambda case: case.name)
def test_volume_removed_from_stock_with_voids(case: CutCase) -> None:
    """Points strewn over the block: those of the stock that the move sweeps."""
    low, high = np.array([case.low, case.high]) * MM
    x = low + qmc.Sobol(3, rng=1).random_base2(17) * (high - low)
    _, move = case.before(1)
    swept = np.mean(case.block()(x) & move.sweeps(x)) * np.prod(high - low)
    assert rm.simulate(case.setup(1.0)).ideal.removed_volume == pytest.approx(swept, rel=0.02)
