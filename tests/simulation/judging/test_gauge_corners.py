"""Walls where passes meet, against polygons of what is cut; walls that should stand and do not.

The truth is drawn by another library: every point of the outline that is left, cut too deep, is as far off as it stands
from the outline that was told; every point of the outline that was told, where metal stays, as far as from the one that
is left. The ends of cuts are left out (they are judged along the feed).
"""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree

from robomill.report.simulation_record import judged_record
from robomill.simulation.result import SimulationResult
from robomill.surface.stock import Stock
from tests.simulation.judging.pushed_runs import BLOCK, R, pushed, run

SLOT = ["G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F1800", "G0 Z5"]
PARTS = {
    "slots that meet": [*SLOT, "G0 X0 Y30", "G0 Z-2", "G1 Y1.7"],
    "a square crossing": [*SLOT, "G0 X0 Y-30", "G0 Z-2", "G1 Y30"],
    "an obtuse crossing": [*SLOT, "G0 X-17.32 Y-30", "G0 Z-2", "G1 X17.32 Y30"],
    "an acute crossing": [*SLOT, "G0 X-45 Y-25.98", "G0 Z-2", "G1 X45 Y25.98"],
    "a sharp crossing": [*SLOT, "G0 X-40 Y-10.718", "G0 Z-2", "G1 X40 Y10.718"],
    "a slot into a circle": ["G0 X40 Y0 Z5", "G0 Z-2", "G1 X10 F1200", "G3 X10 Y0 I-10 J0"],
    "a slot into a circle and out": ["G0 X40 Y0 Z5", "G0 Z-2", "G1 X10 F1200", "G3 X10 Y0 I-10 J0", "G1 X40"],
    "a slot that ends in another's wall": [
        *["G0 X-40 Y-10 Z5", "G0 Z-2", "G1 X40 F1200", "G0 Z5", "G0 X-40 Y-3", "G0 Z-2", "G1 X40", "G0 Z5"],
        *["G0 X0 Y30", "G0 Z-2", "G1 Y-6"],
    ],
    "a pocket with an island": [
        *["G0 X-40 Y-10 Z5", "G0 Z-2", "G1 X10 F1200", "G1 Y10", "G1 X-10", "G1 Y-10", "G1 X-15 Y-15", "G1 X15"],
        *["G1 Y15", "G1 X-15", "G1 Y-40"],
    ],
    "corners to and fro": [
        *["G0 X-40 Y-10 Z5", "G0 Z-2", "G1 X-10 F900"],
        *["G1 X0 Y10", "G1 X10 Y-10", "G1 X20 Y10", "G1 X40"],
    ],
    "straight and round": ["G0 X-10 Y-30 Z5", "G0 Z-2", "G1 Y10 F1200", "G2 X-10 Y-10 J-10", "G1 Y-30"],
    "two depths": [*SLOT, "G0 X0 Y-30", "G0 Z-1", "G1 Y30"],
}


def covered(result: SimulationResult, tips) -> shapely.Geometry:
    """What the cutter covers a little above the floors, seen from above."""
    on = np.flatnonzero(result.removes)
    lines = [shapely.LineString(tips[i - 1 : i + 1, :2]) for i in on]
    found = shapely.union_all(shapely.buffer(lines, R, quad_segs=100))
    shapely.prepare(found)
    return found


def outline(shape: shapely.Geometry):
    """Points of an outline, a fiftieth of a millimetre apart."""
    rings = [ring for each in shapely.get_parts(shape) for ring in (each.exterior, *each.interiors)]
    places = [shapely.line_interpolate_point(ring, np.arange(0.0, ring.length, 20e-6)) for ring in rings]
    return shapely.get_coordinates(np.concatenate(places))


def worst_wall(result: SimulationResult) -> float:
    told, left = covered(result, result.path.p), covered(result, result.p_machined)
    stock = shapely.box(*BLOCK.lower[:2], *BLOCK.upper[:2]).buffer(-0.6e-3)
    cut = result.path.cutting
    ends = np.flatnonzero(cut & ~(np.append(False, cut[:-1]) & np.append(cut[1:], False)))

    def far(points, others, within) -> float:
        kept = shapely.contains_xy(stock, *points.T) & ~shapely.contains_xy(within, *points.T)
        kept &= cKDTree(result.path.p[ends, :2]).query(points)[0] > R + 0.8e-3
        return float(cKDTree(others).query(points[kept])[0].max(initial=0.0))

    was, is_ = outline(told), outline(left)
    return max(far(is_, was, told), far(was, is_, left))


@pytest.mark.parametrize("name", PARTS)
@pytest.mark.parametrize("seed", range(2))
def test_no_wall_reads_more_than_the_polygons(name, seed):
    """Every block is carried aside by another amount, and along its feed."""
    result, rng = run(*PARTS[name]), np.random.default_rng([seed, *name.encode()])
    block = result.path.block - result.path.block.min()
    aside, along = (most * rng.uniform(-1.0, 1.0, block.max() + 1)[block] for most in (0.28e-3, 0.15e-3))
    bent = pushed(result, along, aside, -0.05e-3)
    assert abs(bent.verdict.wall.value) == pytest.approx(worst_wall(bent), abs=2.5e-6, rel=0.01)
    assert len(bent.gauge.gone) == 0


def two_slots(apart: float, stock: Stock = BLOCK):
    """The second one ``apart`` mm beside the first, the metal between them part of the part."""
    y = 0.5 * apart
    lines = [f"G0 X-40 Y{y} Z5", "G0 Z-2", "G1 X40 F900", "G0 Z5", f"G0 X-40 Y{-y}", "G0 Z-2", "G1 X40"]
    return run(*lines, stock=stock)


@pytest.mark.parametrize("thick", [0.1, 0.4, 0.55, 0.7, 2.0])
def test_a_wall_between_two_slots_that_is_cut_away_is_never_green(thick):
    """Each slot goes 0.29 mm towards the other: what is told thinner than 0.58 mm is gone, with tolerance 0.3 mm."""
    made = two_slots(8.0 + thick)
    bent = pushed(made, left=np.where(made.path.p[:, 1] > 0.0, -0.29e-3, 0.29e-3))
    gone = thick < 0.58
    assert bent.verdict.level == ("out" if gone else "tight")
    assert (len(bent.gauge.gone) > 100) == gone
    assert ("cut away (line 4, 8)" in bent.verdict.sentence) == gone
    assert abs(bent.verdict.wall.value) == pytest.approx(0.29e-3, abs=1e-8)
    assert judged_record(bent)["gone"] == ([4, 8] if gone else [])
    assert set(np.flatnonzero(bent.columns()["gone"])) == set(bent.gauge.gone)


@pytest.mark.parametrize(("thick", "gone"), [(0.2, True), (0.28, True), (0.3, False), (1.0, False)])
def test_a_wall_between_a_slot_and_the_side_of_the_block_may_go_too(thick, gone):
    made = run(
        "G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F900", stock=Stock([-30e-3, -20e-3, -10e-3], [30e-3, R + thick * 1e-3, 0])
    )
    bent = pushed(made, left=0.29e-3)
    assert (len(bent.gauge.gone) > 0) == gone
    assert bent.verdict.red == gone


def test_a_rib_that_tapers_to_nothing_misses_only_its_tip():
    """Slots that open by 30 degrees from each other lose the tip between them, shorter than what is looked for; by 3
    degrees the rib is gone over a finger's breadth."""
    for angle, gone in ((30.0, False), (3.0, True)):
        y = 30.0 * np.tan(np.radians(0.5 * angle)) + 4.0 / np.cos(np.radians(0.5 * angle))
        near = y - 60.0 * np.tan(np.radians(0.5 * angle))
        made = run(
            f"G0 X-30 Y{near:.4f} Z5",
            "G0 Z-2",
            f"G1 X30 Y{y:.4f} F900",
            "G0 Z5",
            f"G0 X-30 Y{-near:.4f}",
            "G0 Z-2",
            f"G1 X30 Y{-y:.4f}",
        )
        bent = pushed(made, left=np.where(made.path.block < 6, -0.2e-3, 0.2e-3))
        assert (len(bent.gauge.gone) > 0) == gone


@pytest.mark.parametrize("step", [1e-3, 2e-3])
def test_a_wall_is_looked_at_between_samples_too(step):
    """Into a corner the tool is pressed off its wall by 0.2 mm within a step; most of it is cut on the way out."""
    made = run("G0 X-40 Y0 Z5", "G0 Z-2", "G1 X0 F900", "G1 Y-40", step=step)
    corner = np.flatnonzero(made.path.block == 4)[-1]
    aside = np.where(made.path.block == 4, -0.04e-3, -0.02e-3)
    aside[corner] = -0.2e-3
    bent = pushed(made, left=aside)
    assert abs(bent.verdict.wall.value) == pytest.approx(worst_wall(bent), rel=0.15)


@pytest.mark.parametrize(("thick", "thin"), [(0.1, True), (0.24, True), (0.26, False), (1.0, False)])
def test_a_wall_that_bends_under_the_cut_is_said(thick, thin):
    """2 mm high: less than 0.25 mm is thin, between two slots and at the side of the block."""
    side = Stock([-30e-3, -20e-3, -10e-3], [30e-3, R + thick * 1e-3, 0])
    beside = run("G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F900", stock=side)
    for result, lines in ((two_slots(8.0 + thick), {4, 8}), (beside, {4})):
        codes = [note.code for note in result.surface_notes]
        assert ("thin-wall" in codes) == thin
        assert set(result.path.block[result.gauge.thin]) == (lines if thin else set())
        assert judged_record(result)["thin_wall"] == (sorted(lines) if thin else [])
        assert set(result.columns()["line"][result.columns()["thin_wall"] == 1.0]) == (lines if thin else set())


@pytest.mark.parametrize("name", PARTS)
def test_tips_between_crossing_cuts_are_no_thin_walls(name):
    assert len(run(*PARTS[name]).gauge.thin) == 0


@pytest.mark.parametrize("turn", [6.0, 9.0])
def test_an_arc_of_few_chords_has_its_inner_wall_at_every_one(turn: float) -> None:
    """Though they overlap there: a half circle of 10 mm by a mill of 8, whose inner wall has a radius of 6 mm."""
    angle = np.radians(np.arange(-90.0, 90.0 + 0.5 * turn, turn))
    arc = [f"G1 X{10 * np.cos(each):.6f} Y{10 * np.sin(each):.6f}" for each in angle]
    made = pushed(run("G0 X-20 Y-10 Z5", "G0 Z-2", "G1 X-1 F1800", *arc, "G1 X-20", step=10e-3))
    on_arc = np.flatnonzero(made.path.cutting & (made.path.p[:, 0] > 1e-3) & (made.path.step_length > 0.0))
    walls = made.gauge.walls
    inner = np.abs(np.hypot(walls.place[:, 0], walls.place[:, 1]) - 6e-3) < 0.5e-3
    assert len(on_arc) == len(angle) - 2
    assert {*on_arc.tolist()} <= {*walls.sample[inner & (walls.length > 0.0)].tolist()}
    np.testing.assert_allclose(walls.error[inner], 0.0, atol=1e-9)


@pytest.mark.parametrize(("bend", "around"), [(4.0, False), (-4.8, False), (5.2, True), (-9.0, True)])
def test_walls_are_looked_for_all_around_where_a_path_turns_by_more_than_five_degrees(bend: float, around: bool):
    """Readings that stand for no length are those that are not beside the path."""
    x, y = 40.0 * np.cos(np.radians(bend)), 40.0 * np.sin(np.radians(bend))
    made = run("G0 X-40 Y0 Z5", "G0 Z-2", "G1 X0 F1800", f"G1 X{x:.6f} Y{y:.6f}")
    walls = pushed(made, left=0.1e-3).gauge.walls
    near = np.abs(made.path.p[walls.sample, 0]) < 1.5e-3
    assert (walls.length[near] > 0.0).any()
    assert (walls.length[near] == 0.0).any() == around
    assert (walls.length[~near & (np.abs(made.path.p[walls.sample, 0]) < 20e-3)] > 0.0).all()
