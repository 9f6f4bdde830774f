"""How far the answer moves with the alloy's other coefficients: against runs with each of them in force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.simulation.origin.spread import alloy_spread, peak_force

STATED = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(cell=1e-3, step=4e-3)
PROCESS = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(cell=1e-3, step=4e-3)


@pytest.fixture(scope="module")
def result():
    return rm.simulate(PROCESS.replace(coupling=False))


def test_each_row_is_what_a_run_with_it_says_and_the_one_in_force_comes_first(result):
    spread = alloy_spread(result)
    assert spread.materials[0] == PROCESS.force.material
    assert len(set(spread.titles)) == len(spread.materials) > 2
    np.testing.assert_array_equal(spread.F[0], result.F)
    for row, F, delta, size in zip(spread.materials, spread.F, spread.delta, spread.deviation, strict=True):
        if row.unknown:
            continue
        alone = rm.simulate(result.setup.replace(force=replace(PROCESS.force, material=row)))
        np.testing.assert_allclose(F, alone.F, atol=1e-9)
        np.testing.assert_allclose(delta, alone.delta, atol=1e-15)
        np.testing.assert_allclose(size, alone.deviation, atol=1e-15)


def test_a_row_that_does_not_know_the_axial_force_has_that_of_the_row_in_force(result):
    spread = alloy_spread(result)
    assert True in spread.axial
    assert False in spread.axial
    for row, known, F in zip(spread.materials, spread.axial, spread.F, strict=True):
        alone = rm.simulate(result.setup.replace(force=replace(PROCESS.force, material=row)))
        assert known == np.isfinite(alone.F).all()
        if not known:
            parts = [np.einsum("mij,mi->mj", result.R_MF, each)[:, 2] for each in (F, result.F)]
            np.testing.assert_allclose(parts[0], parts[1], atol=1e-9)


def test_what_the_force_does_not_cause_stays(result):
    rest = np.array([1e-5, -2e-5, 3e-5])
    lifted = replace(result, delta=result.delta + rest)
    moved = alloy_spread(lifted).delta - alloy_spread(result).delta
    np.testing.assert_allclose(moved, np.broadcast_to(rest, moved.shape), atol=1e-15)


def test_a_stated_force_has_neither_rows_nor_a_peak(result):
    stated = rm.simulate(STATED)
    assert alloy_spread(stated) is None
    assert peak_force(stated) is None
    peak, mean = peak_force(result), result.force_components
    cut = result.conditions.engaged
    assert (peak.low[cut] <= mean[cut] + 1e-9).all()
    assert (mean[cut] <= peak.high[cut] + 1e-9).all()
    assert (peak.high[cut] - peak.low[cut]).max() > 1.0
