"""Ends of tools cut only as steeply as the tip really sinks."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.conditions import CutConditions
from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.simulation.judging.sinking import clear, sinking, told_to_sink
from robomill.simulation.samples import ways
from robomill.toolpath.path import Toolpath

MILL = Cutter("flat", 8e-3, flutes=3)


def ramp(degrees: float, cutter: Cutter = MILL) -> tuple[CutConditions, Toolpath]:
    """20 mm on the level, then 20 mm down (or up), in steps of 1 mm."""
    x = 1e-3 * np.arange(41)
    z = -1e-3 - np.tan(np.radians(degrees)) * np.maximum(x - 20e-3, 0.0)
    path = Toolpath.from_points(np.column_stack([x, 0.0 * x, z]), 0.03, cutting=np.append(False, np.ones(40, bool)))
    along = ways(path)[:, 2]
    told = CutConditions.steady(0.03, 200.0, 1e-3, along=along, across=np.sqrt(1.0 - along**2), cutting=path.cutting)
    return CutConditions(**{**vars(told), "tooling": Tooling.of(cutter, len(path))}), path


@pytest.mark.parametrize("degrees", [0.2, 0.5, 3.0])
def test_a_ramp_that_the_tip_follows_is_cut_as_it_is_told_once_it_goes_on_for_the_tools_width(degrees):
    told, path = ramp(degrees)
    steep = sinking(told, path, path.p).steep
    assert told_to_sink(told)[21:].all()
    np.testing.assert_allclose(steep[29:], told.sinks[29:], atol=1e-9)
    assert (np.diff(steep[20:]) >= -1e-9).all()  # taken up by and by


@pytest.mark.parametrize("degrees", [0.2, 3.0])
def test_an_end_that_is_told_down_as_its_arm_is_pushed_up_meets_nothing(degrees):
    told, path = ramp(degrees)
    level = path.p * [1.0, 1.0, 0.0] + [0.0, 0.0, -1e-3]
    assert not sinking(told, path, level).steep.any()
    assert not clear(told).sinks.any()


def test_where_a_cut_rises_or_goes_level_or_the_tool_has_no_end_nothing_is_asked():
    for told, path in (ramp(-2.0), ramp(0.0), ramp(2.0, Cutter("ball", 8e-3, flutes=2))):
        assert not told_to_sink(told).any()
        assert sinking(told, path, path.p) is told


def test_half_of_the_slope_taken_back_leaves_the_other_half():
    told, path = ramp(0.4)
    half = path.p * [1.0, 1.0, 0.5] + [0.0, 0.0, -0.5e-3]
    expected = ramp(np.degrees(np.arctan(0.5 * np.tan(np.radians(0.4)))))[0].sinks
    np.testing.assert_allclose(sinking(told, path, half).steep[29:], expected[29:], atol=1e-4)
