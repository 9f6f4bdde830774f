"""The displacement enlarged for a picture, the error told truly, the cut as it stands at a sample."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from robomill.cutting.forces.along_path import PathForce
from robomill.cutting.unjudged import Unjudged
from robomill.errors import SurfaceError
from robomill.simulation.enlarged import PICTURE_CELLS, enlarged, so_far, tip_drawn
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate
from robomill.simulation.stations import nearest_feed
from robomill.surface.stock import Stock


def test_exaggeration_moves_the_picture_and_keeps_the_error_true(result: SimulationResult) -> None:
    once, ten = enlarged(result, 1.0), enlarged(result, 10.0)
    j = int(np.argmin(np.abs(ten.drawn.y)))
    i = len(ten.drawn.x) // 2
    assert ten.drawn.z[i, j] - ten.ideal.z[i, j] == pytest.approx(
        10 * (once.drawn.z[i, j] - once.ideal.z[i, j]), rel=1e-4
    )
    assert ten.error[i, j] == pytest.approx(-1.024e-4, abs=1e-6)
    assert once.error[i, j] == pytest.approx(-1.024e-4, abs=1e-6)
    assert np.isnan(ten.error[:, 0]).all(), "untouched material carries no error"


@pytest.mark.parametrize("times", [1.0, 5.0, 50.0])
def test_pictures_keep_the_true_error_of_walls_and_floor(slot: SimulationResult, times: float) -> None:
    shown = enlarged(slot, times)
    i = int(np.argmin(np.abs(shown.drawn.x)))
    sample = nearest_feed(slot, 0.05)
    aside, depth = abs(float(slot.delta[sample, 1])), float(slot.delta[sample, 2])  # the slot runs along X
    error = shown.error[i]
    y = shown.drawn.y
    left_over = (y < 0.001) & (y > -0.004) & (shown.drawn.z[i] >= -1e-9) & (shown.ideal.z[i] < -1e-3)
    assert left_over.any()
    assert error[left_over] == pytest.approx(aside, rel=0.02)
    cut_off = (shown.ideal.z[i] >= -1e-9) & (shown.drawn.z[i] < -1e-3)
    assert error[cut_off] == pytest.approx(-aside, rel=0.02)
    both = (shown.ideal.z[i] < -1e-3) & (shown.drawn.z[i] < -1e-3)
    if times < 20:
        assert error[both] == pytest.approx(depth, rel=0.02)
    assert np.isnan(error[np.isclose(shown.drawn.z[i], 0.0) & np.isclose(shown.ideal.z[i], 0.0)]).all()


def test_the_cut_so_far_grows_to_the_whole(slot: SimulationResult) -> None:
    shown = enlarged(slot, 10.0)
    removed = [so_far(slot, shown, int(k)).drawn.removed_volume for k in np.linspace(0, len(slot.path) - 1, 5)[1:]]
    assert np.all(np.diff(removed) > 0)
    assert removed[-1] == shown.drawn.removed_volume
    start = so_far(slot, shown, 0)
    assert np.isnan(start.error).all()
    assert (start.drawn.z == shown.ideal.z_stock).all()
    middle = so_far(slot, shown, nearest_feed(slot, 0.05))
    ahead = shown.drawn.x > 0.01
    assert np.isnan(middle.error[ahead]).all()
    np.testing.assert_allclose(tip_drawn(slot, shown, nearest_feed(slot, 0.05))[1], 10 * 0.2773e-3, atol=5e-6)
    i = nearest_feed(slot, 0.02)
    tip = tip_drawn(slot, shown, i)
    # Ten times what the tip moves in {W}, whose axes are those of {M} here, from where it was told to be.
    np.testing.assert_allclose((tip - slot.path.p[i]) / 10, slot.delta[i], atol=1e-12)
    assert abs(slot.path.p[i, 0]) > 0.01


def test_a_picture_has_no_more_cells_than_a_screen_needs(result: SimulationResult) -> None:
    shown = enlarged(result, 1.0)
    assert shown.drawn.z.size <= 1.05 * PICTURE_CELLS
    assert shown.drawn.cell >= result.setup.cell


def test_a_floor_whose_enlarged_path_leaves_the_stock_keeps_its_true_error(result: SimulationResult) -> None:
    lifted = simulate(result.setup.replace(force=PathForce(feed_normal=0.0, axial=500.0)))
    sample = nearest_feed(lifted, 0.05)
    up = float(lifted.delta[sample, 2])
    times = 2.2 * 0.002 / up
    shown = enlarged(lifted, times)
    assert (shown.drawn.z == 0.0).all(), "the enlarged path stands above the stock"
    i = int(np.argmin(np.abs(shown.drawn.x - lifted.path.p[sample, 0])))
    middle = np.abs(shown.drawn.y) < 0.003
    assert shown.error[i, middle] == pytest.approx(up, rel=0.02)


def test_a_tool_that_the_picture_lifts_off_the_part_leaves_it_whole(result: SimulationResult) -> None:
    """Ten times the deflection is more than the slot is deep; only the path itself has to meet the stock."""
    up = np.where(result.path.cutting[:, None], [0.0, 0.0, 0.4e-3], 0.0)
    lifted = dataclasses.replace(result, delta=up)
    assert lifted.path.p[lifted.path.cutting, 2].min() > -3.9e-3
    shown = enlarged(lifted, 10.0)
    np.testing.assert_array_equal(shown.drawn.z, shown.drawn.z_stock)
    assert shown.ideal.removed_volume > 0.0
    block, aside = result.setup.stock_block, np.array([0.0, 1.0, 0.0])
    beside = Stock(block.lower + aside, block.upper + aside)
    with pytest.raises(SurfaceError, match="never touches"):
        enlarged(dataclasses.replace(result, setup=result.setup.replace(stock=beside)), 1.0)
    cuts = result.path.cutting
    nothing_known = dataclasses.replace(
        result, setup=result.setup.replace(stock=beside), unjudged=(Unjudged("tool", cuts, "of another tool"),)
    )
    assert enlarged(nothing_known, 1.0).ideal.removed_volume == 0.0


@pytest.mark.parametrize("station", [0.02, 0.05, 0.08])
def test_the_cut_so_far_ends_one_radius_before_the_tip(slot: SimulationResult, station: float) -> None:
    shown, k = enlarged(slot, 10.0), nearest_feed(slot, station)
    tip, made = tip_drawn(slot, shown, k), so_far(slot, shown, k).drawn
    row = int(np.argmin(np.abs(made.y - tip[1])))
    cut = made.x[made.z[:, row] < -1e-6]
    step = float(slot.path.step_length[k + 1])
    assert step > made.cell  # else the sample that comes next could not be told
    assert abs(cut.max() - (tip[0] + slot.setup.cutter.radius)) <= made.cell


def test_a_floor_that_is_cut_too_high_is_told_by_its_height_and_not_by_what_the_tool_goes_aside(
    result: SimulationResult,
) -> None:
    """Lifted along the slot from 0.02 to 0.06 mm, and 0.2 mm aside."""
    path = result.path
    share = np.clip((path.p[:, 0] + 0.05) / 0.1, 0.0, 1.0)
    delta = np.column_stack([0.0 * share, 0.2e-3 + 0.0 * share, 0.02e-3 + 0.04e-3 * share]) * path.cutting[:, None]
    shown = enlarged(dataclasses.replace(result, delta=delta), 20.0)
    assert shown.drawn.cell / 20.0 < 0.02e-3
    for x in (-0.03, 0.0, 0.03):
        i = int(np.argmin(np.abs(shown.drawn.x - x)))
        both = (shown.ideal.z[i] < -0.5e-3) & (shown.drawn.z[i] < -0.5e-3)
        assert both.sum() > 3
        np.testing.assert_allclose(shown.error[i, both], 0.02e-3 + 0.04e-3 * (x + 0.05) / 0.1, atol=3e-6)
