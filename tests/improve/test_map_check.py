"""The coarse map of places against a run at each of them."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.improve.map_check import AGREES, MANY, checked
from robomill.improve.placed import Place

WAY = "G21 G90\nS10000 M3\nG0 X-50 Y-40 Z10\nG0 Z-2\nG1 X50 F1500\nG1 Y20\nG1 X-50\nG0 Z20\nM2\n"


def cornered() -> rm.SimulationSetup:
    cutter = rm.Cutter("flat", diameter_mm=10, flutes=3)
    return rm.SimulationSetup(
        robot=rm.load_robot("slavkovic_5r"),
        source=rm.GCodeSource(WAY),
        part_zero_mm=(0, -1250, 2),
        cutter=cutter,
        force=rm.process_force("al7075_t6_carbide_ref190", cutter),
        stock=rm.Stock(lower_mm=(-60, -60, -10), upper_mm=(60, 40, 0)),
        engagement=True,
        tolerance_mm=0.2,
        step_mm=4,
    )


def test_the_best_place_of_a_path_with_corners_is_the_best_of_runs_at_each() -> None:
    """Where the tip swings the other way round a corner, the next pass cleans up what it left, or does not."""
    setup = cornered()
    found = rm.place(setup, x_mm=(-400, 400), y_mm=(-1500, -1000), candidates=20)
    at = np.stack(np.meshgrid(found.axes[0], found.axes[1], indexing="ij"), axis=-1).reshape(-1, 2)
    shares = found.share.reshape(-1)
    full = np.array([rm.simulate(setup.replace(part_zero=(*xy, 2e-3))).verdict.share for xy in at])
    known = np.isfinite(shares)
    np.testing.assert_allclose(shares[known], full[known], rtol=1e-9)
    assert found.best.share <= full[known].min() + 1e-9
    assert found.worst.share == pytest.approx(full[known].max(), rel=1e-9)


def test_a_map_that_holds_is_left_alone_and_one_that_does_not_is_mended_by_the_nearest() -> None:
    places = np.column_stack([np.arange(300.0), np.zeros(300), np.zeros(300), np.zeros(300)])
    truth, asked = 1.0 + 1e-3 * places[:, 0], []

    def simulated(at: np.ndarray) -> Place:
        asked.append(at[0])
        return Place(at[:3], 0.0, float(1.0 + 1e-3 * at[0]), 0.1, 0.1, 0.1, 0.1, "ok", "", 0.5, 0.5)

    share = truth * (1.0 + 0.5 * AGREES)
    before = share.copy()
    assert checked(simulated, places, share, np.array([1.0, 0, 0, 0])) == {}
    np.testing.assert_array_equal(share, before)
    assert len(asked) < 10
    share = np.where(np.arange(300) % 7 == 3, np.nan, truth + np.linspace(0.5, 0.0, 300))
    found = checked(simulated, places, share, np.array([1.0, 0, 0, 0]))
    allowed = np.isfinite(share)
    assert MANY <= len(found) <= MANY + 8
    assert not any(np.isnan(share[i]) for i in found)
    for i in found:
        assert share[i] == pytest.approx(truth[i])
    np.testing.assert_allclose(share[allowed], truth[allowed], atol=0.5 / 299 * 6)
