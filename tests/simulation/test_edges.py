"""Where no wall can stand along the side of a stock: pockets in blocks as wide as they, against what is left."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import robomill as rm
from robomill.simulation.edges import AT_EDGE, edge_notes
from robomill.surface.stock import Stock
from robomill.toolpath.source import GCodeSource
from tests.simulation.judging.pushed_runs import SETUP

MILL = rm.Cutter("flat", diameter_mm=8, flutes=3)
HALF = np.array([26e-3, 16e-3])  # of the pocket's contour: with the cutter's radius 60 x 40 mm are cut
LINES = "\n".join(
    ["G21 G90 S12000 M3", "G0 X-26 Y-16 Z5", "G1 Z-2 F300", "G1 X26 F900", "Y16", "X-26", "Y-16", "G0 Z5"]
)


def pocket(width: float, length: float = 0.11, cutter: rm.Cutter = MILL) -> rm.SimulationSetup:
    """The contour of a pocket in a block of a width and length (m)."""
    corner = np.array([0.5 * length, 0.5 * width])
    stock = Stock(np.array([*-corner, -0.01]), np.array([*corner, 0.0]))
    return SETUP.replace(source=GCodeSource(LINES), cutter=cutter, stock=stock)


def left_beside(setup: rm.SimulationSetup) -> float:
    """m: the thickness of the wall that stands along X, by polygons: what the block has beyond what is cut."""
    block = shapely.box(*setup.stock_block.lower[:2], *setup.stock_block.upper[:2])
    ring = shapely.LinearRing(HALF * [[-1, -1], [1, -1], [1, 1], [-1, 1]])
    cut = ring.buffer(setup.cutter.radius, quad_segs=200)
    beside = block.difference(cut.union(shapely.Polygon(ring))).intersection(shapely.box(-0.01, 0.0, 0.01, 1.0))
    return float(beside.bounds[3] - beside.bounds[1]) if not beside.is_empty else 0.0


@pytest.mark.parametrize("width", [0.04, 0.04 + 1.9 * AT_EDGE, 0.0405, 0.044, 0.06])
def test_a_pocket_as_wide_as_its_block_has_no_walls_along_it(width: float) -> None:
    setup = pocket(width)
    found = edge_notes(setup, setup.toolpath)
    assert bool(found) == (left_beside(setup) <= AT_EDGE)
    for each in found:
        assert each.level == "warning"
        assert "2 sides" in each.message
        assert f"{2e3 * HALF[0]:.1f} mm" in each.message.replace("\u00a0", " ")
        assert each.line in (4, 6)


def test_the_run_says_so_and_reads_no_wall_there() -> None:
    """The ring leaves an island, whose walls are read in both; in the larger block the outer walls are read, too."""
    count = {}
    for width in (0.04, 0.06):
        result = rm.simulate(pocket(width))
        assert ("no-wall-at-edge" in {each.code for each in result.notes}) == (width == 0.04)
        at = result.gauge.walls.sample
        middle = np.isin(result.path.block[at], (4, 6)) & (np.abs(result.path.p[at, 0]) < 0.015)
        count[width] = int(middle.sum())
    assert count[0.06] == 2 * count[0.04] > 0


def test_all_four_sides_a_smaller_cutter_and_a_block_around_the_path() -> None:
    tight = pocket(0.04, 0.06)
    assert "4 sides" in edge_notes(tight, tight.toolpath)[0].message
    assert not edge_notes(pocket(0.04, cutter=MILL.replace(diameter=6e-3)), tight.toolpath)
    assert not edge_notes(tight.replace(stock=None), tight.toolpath)


@pytest.mark.parametrize(
    "lines",
    [
        ("G0 X-60 Y0 Z5", "G0 Z-2", "G1 X60 F900"),  # a groove through both ends
        ("G0 X-60 Y20 Z5", "G0 Z-2", "G1 X60 F900"),  # half the cutter over the side: a step
        ("G0 X-60 Y24 Z5", "G0 Z-2", "G1 X60 F900"),  # past the block from outside
        ("G0 X0 Y16 Z5", "G0 Z-2", "G1 X10 F900"),  # short
        ("G0 X-30 Y16 Z5", "G0 Z2", "G1 X30 F900"),  # above it
        ("G0 X-30 Y16 Z5", "G0 Z-2", "G0 X30", "G1 Y0 F900"),  # a rapid
    ],
)
def test_cuts_that_go_out_over_a_side_or_hardly_along_it_are_not_warned_of(lines: tuple[str, ...]) -> None:
    setup = pocket(0.04).replace(source=GCodeSource("\n".join(["G21 G90 S12000 M3", *lines, "M2"])))
    assert edge_notes(setup, setup.toolpath) == ()


@pytest.mark.parametrize(("begin", "end"), [(-60, 60), (60, -60), (-55, 55), (-57.5, 10), (10, -57.5), (-20, 57.5)])
@pytest.mark.parametrize("step", [1.0, 2.5, 5.0])
def test_no_more_of_a_way_is_said_than_goes_beside_the_block(begin: float, end: float, step: float) -> None:
    """From beyond one corner, or past the other, in steps that stop on the edge itself or run over it."""
    x = np.linspace(begin, end, round(abs(end - begin) / step) + 1)
    p = np.column_stack([x, np.full(len(x), 16.0), np.full(len(x), -2.0)])
    path = rm.Toolpath.from_points(p_mm=p, feed_mm_min=[0.0, *[900.0] * (len(x) - 1)])
    (found,) = edge_notes(pocket(0.04), path)
    beside = min(max(begin, end), 55.0) - max(min(begin, end), -55.0)
    assert f"for up to {beside:.1f} mm" in found.message.replace("\u00a0", " ")


def test_a_way_past_the_corner_and_back_is_two_ways_along_the_side() -> None:
    x = np.concatenate([np.arange(-20.0, 71.0, 5.0), np.arange(65.0, -31.0, -5.0)])
    p = np.column_stack([x, np.full(len(x), 16.0), np.full(len(x), -2.0)])
    path = rm.Toolpath.from_points(p_mm=p, feed_mm_min=[0.0, *[900.0] * (len(x) - 1)])
    (found,) = edge_notes(pocket(0.04), path)
    assert f"for up to {55.0 + 30.0:.1f} mm" in found.message.replace("\u00a0", " ")


@pytest.mark.parametrize("begin", [(-51, -10), (51, -10), (-10, -16), (-10, 16)])
def test_each_side_is_looked_at(begin: tuple[int, int]) -> None:
    """One cut along each of the four, 20 mm long."""
    along = np.array([0.0, 20.0] if abs(begin[0]) == 51 else [20.0, 0.0])
    path = rm.Toolpath.from_points(p_mm=[[*begin, -2.0], [*(begin + along), -2.0]], feed_mm_min=900)
    (found,) = edge_notes(pocket(0.04), path)
    assert "1 side of the stock, for up to 20.0 mm" in found.message.replace("\u00a0", " ")
