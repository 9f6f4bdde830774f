"""Sections of grooves drawn with pencil and compass: each is known for what it is and measured to a cell's hundredth.

The commanded path is the shape; every pass is moved by a known deviation. Nothing here asks the product what a cutter
leaves: walls and floors are those of circles, cones and planes.
"""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.surface.sections.groove import groove_sections
from robomill.surface.stock import Stock
from robomill.surface.swept import CutPath
from tests.surface.sections.shapes import (
    BALL,
    BULL,
    CONE,
    EXACT,
    FLAT,
    MOVED,
    STOCK,
    THIN,
    degrees,
    middle_of,
    passes,
    section,
    slot,
)


@pytest.mark.parametrize("angle", [0.0, 13.0, 37.5, 45.0, 90.0, 163.0, -71.0])
def test_a_slot_at_any_angle_to_the_grid(angle):
    stock = Stock((-0.07, -0.07, -0.01), (0.07, 0.07, 0.0))
    found = section([slot()], FLAT, angle=angle, stock=stock)
    assert (found.kind, found.near, found.note) == ("groove", "", "")
    assert found.centre_offset == pytest.approx(0.15e-3, abs=EXACT)
    assert found.floor_error == pytest.approx(-0.06e-3, abs=EXACT)
    assert (found.width, found.depth) == pytest.approx((8e-3, 2.06e-3), abs=EXACT)
    assert (found.wall_left_error, found.wall_right_error) == pytest.approx((0.15e-3, 0.15e-3), abs=EXACT)
    assert degrees(found.wall_left_angle) == pytest.approx(90.0, abs=1e-4)
    assert found.wall_right_straightness == pytest.approx(0.0, abs=EXACT)
    assert found.floor_tilt == pytest.approx(0.0, abs=1e-9)
    assert dict(found.why) == {}


@pytest.mark.parametrize("turn", [2.0, 5.0, -8.0])
def test_a_slot_by_a_cutter_that_leans_across(turn):
    """Leaning to the left by t: the floor falls to the left by tan t, the left wall opens up by t, the right one hides
    under its lip (the other way round for a lean to the right)."""
    t = np.radians(turn)
    found = section([slot(z=-3.0)], FLAT, k=np.array([0.0, np.sin(t), np.cos(t)]))
    assert found.kind == "groove"
    assert found.floor_tilt == pytest.approx(-t, abs=1e-6)
    seen, hidden = ("left", "right") if turn > 0 else ("right", "left")
    assert degrees(getattr(found, f"wall_{seen}_angle")) == pytest.approx(90.0 + abs(turn), abs=1e-4)
    assert getattr(found, f"wall_{seen}_straightness") < EXACT
    assert "lip" in found.why[f"wall_{hidden}_angle"]


@pytest.mark.parametrize("depth", [0.02, 0.05, 0.09])
def test_a_slot_as_shallow_as_a_scratch_has_place_and_depth_and_no_lean(depth):
    found = section([slot(z=-depth)], FLAT, moved=np.array([0.0, 0.1e-3, -0.004e-3]))
    assert found.kind == "groove"
    assert found.centre_offset == pytest.approx(0.1e-3, abs=EXACT)
    assert found.depth == pytest.approx(1e-3 * depth + 0.004e-3, abs=EXACT)
    assert np.isnan([found.wall_left_angle, found.wall_left_straightness]).all()
    assert "too low" in found.why["wall_left_angle"]


@pytest.mark.parametrize("z", [-10.0, -12.0])
def test_a_slot_through_the_stock_has_walls_and_no_floor(z):
    found = section([slot(z=z)], FLAT)
    assert found.kind == "groove"
    assert found.centre_offset == pytest.approx(0.15e-3, abs=EXACT)
    assert np.isnan([found.depth, found.floor_error, found.floor_tilt, found.floor]).all()
    assert found.why["depth"] == found.why["floor_error"] == "cut through the stock: there is no floor"
    assert degrees(found.wall_left_angle) == pytest.approx(90.0, abs=1e-4)


def test_a_slot_whose_floor_only_the_push_takes_away():
    found = section([slot(z=-9.98)], FLAT)
    assert "no floor" in found.why["floor_error"]
    assert found.width == pytest.approx(8e-3, abs=EXACT)


def test_a_v_groove_has_flanks_of_half_its_cone_and_no_floor_to_lean():
    """90 degrees of cone from a flat of 1 mm, 3 mm deep: flanks at 135 degrees, width 1 + 2 * 3.06 mm at the top."""
    found = section([slot(z=-3.0)], CONE)
    assert found.kind == "groove"
    assert found.width == pytest.approx(1e-3 + 2 * 3.06e-3, abs=EXACT)
    assert degrees(found.wall_left_angle) == pytest.approx(135.0, abs=1e-4)
    assert degrees(found.wall_right_angle) == pytest.approx(135.0, abs=1e-4)
    assert found.wall_left_straightness < EXACT
    assert found.centre_offset == pytest.approx(0.15e-3, abs=EXACT)


def test_a_v_groove_so_deep_that_the_shank_cuts_is_measured_beside_the_shank():
    """The cone is 4.5 mm high, the slot 9.9 mm deep: the wall is the cylinder's."""
    found = section([slot(z=-9.8)], CONE)
    assert degrees(found.wall_left_angle) == pytest.approx(90.0, abs=1e-4)
    assert found.width == pytest.approx(10e-3, abs=EXACT)


def test_a_ball_groove_has_round_flanks_and_no_straight_floor():
    found = section([slot()], BALL)
    half = np.sqrt(4e-3**2 - (4e-3 - 2.06e-3) ** 2)
    assert found.kind == "groove"
    assert found.width == pytest.approx(2 * half, abs=EXACT)
    assert found.floor_error == pytest.approx(-0.06e-3, abs=EXACT)
    assert "round" in found.why["wall_left_angle"]
    assert "no straight floor" in found.why["floor_tilt"]


def test_a_deep_ball_groove_is_measured_above_the_ball():
    found = section([slot(z=-7.0)], BALL)
    assert degrees(found.wall_left_angle) == pytest.approx(90.0, abs=1e-4)
    assert found.wall_left_straightness < EXACT


@pytest.mark.parametrize(("z", "round_"), [(-0.8, True), (-3.0, False)])
def test_a_bull_nose_rounds_the_foot_of_its_walls(z, round_):
    found = section([slot(z=z)], BULL)
    assert found.kind == "groove"
    assert found.floor_tilt == pytest.approx(0.0, abs=1e-9)
    assert found.centre_offset == pytest.approx(0.15e-3, abs=EXACT)
    if round_:
        assert "round" in found.why["wall_left_angle"]
    else:
        assert degrees(found.wall_left_angle) == pytest.approx(90.0, abs=1e-4)


def test_a_slot_cut_there_and_back_is_one_groove_as_wide_as_both_pushes_make_it():
    """There 0.15 mm to +y, back 0.05 mm to -y: walls at +4.15 and -4.05 mm."""
    lines = [slot(), (50, 0, -2, -50, 0, -2)]
    moved = np.array([[0, 0.15e-3, -0.06e-3], [0, -0.05e-3, -0.02e-3]])
    there, back = (section(lines, FLAT, number=n, moved=moved) for n in (0, 1))
    assert {there.kind, back.kind} == {"groove"}
    assert there.width == back.width == pytest.approx(8.2e-3, abs=EXACT)
    assert there.centre_offset == pytest.approx(0.05e-3, abs=EXACT)
    assert back.centre_offset == pytest.approx(-0.05e-3, abs=EXACT)
    assert there.floor_error == pytest.approx(-0.06e-3, abs=EXACT)


def test_a_slot_in_two_depths_pushed_differently_has_a_wall_that_is_not_straight():
    """1 mm deep pushed by 0.10 mm, then 3 mm deep by 0.16 mm: the left wall has a jog of 0.06 mm a third of the way
    down. Nine heights from 5 to 98 % of it against their best line."""
    lines = [slot(z=-1.0), slot(z=-3.0)]
    found = section(lines, FLAT, number=1, moved=np.array([[0, 0.10e-3, 0.0], [0, 0.16e-3, 0.0]]))
    assert found.kind == "groove"
    levels = -3e-3 + 3e-3 * np.linspace(0.05, 0.98, 9)
    right = np.where(levels < -1e-3, -3.84e-3, -3.90e-3)  # the shallow pass reaches further on the right
    slope, offset = np.polyfit(levels, right, 1)
    off = (right - slope * levels - offset) / np.hypot(1, slope)
    assert found.wall_right_straightness == pytest.approx(np.ptp(off), abs=1e-7)
    assert found.wall_left_straightness < EXACT  # the deep pass went further left and made all of that wall
    assert found.wall_left_error == pytest.approx(0.16e-3, abs=EXACT)


def test_a_groove_in_the_floor_of_a_pocket_is_measured_from_that_floor():
    """A pocket of 24 mm and 2 mm deep, a slot of 3 mm another 1.5 mm deeper along its middle."""
    roughing = [slot(y=y) for y in (-8.0, -4.0, 0.0, 4.0, 8.0)]
    p, cutting, which, _ = passes(*roughing, slot(z=-3.5))
    moved = p + np.where(which[:, None] == 5, MOVED, 0.0)
    from robomill.cutting.tooling import Tooling

    tooling = Tooling((FLAT, THIN), np.where(which == 5, 1, 0))
    path = CutPath(p, moved, cutting)
    found = groove_sections(STOCK, tooling, path, [middle_of(p, cutting, which, 5)])[0]
    assert found.kind == "groove"
    assert (found.width, found.depth) == pytest.approx((3e-3, 1.56e-3), abs=EXACT)
    assert found.centre_offset == pytest.approx(0.15e-3, abs=EXACT)
    assert found.wall_left_straightness < EXACT


def test_a_groove_along_an_arc_is_measured_across_it():
    """A circle of 20 mm pushed outwards by 0.1 mm everywhere: the middle is 0.1 mm to the right of the feed (going
    counter-clockwise), to second order in the chords."""
    angle = np.linspace(0.0, np.pi, 361)
    radius = 20e-3
    p = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(len(angle), -2e-3)])
    out = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(len(angle))])
    path = CutPath(p, p + 0.1e-3 * out + [0, 0, -0.02e-3], np.arange(len(p)) > 0)
    for found in groove_sections(STOCK, FLAT, path, np.array([0.2, 0.37, 0.61]) * np.pi * radius):
        assert found.kind == "groove"
        assert found.centre_offset == pytest.approx(-0.1e-3, abs=1e-6)
        assert found.width == pytest.approx(8e-3, abs=2e-6)
        assert found.floor_error == pytest.approx(-0.02e-3, abs=EXACT)
        assert degrees(found.wall_left_angle) == pytest.approx(90.0, abs=1e-3)


@pytest.mark.parametrize(
    ("line", "word"),
    [(slot(z=1.0), "above the stock"), (slot(y=-45.0), "beside the stock"), ((-50, 0, 0, 50, 0, 0), "above the stock")],
)
def test_where_nothing_is_cut_the_section_says_so_and_shows_the_stock(line, word):
    found = section([line], FLAT)
    assert found.kind == "nothing"
    assert found.note.startswith("nothing is cut here")
    assert word in found.note
    assert found.measures == ()
    if word == "above the stock":
        np.testing.assert_allclose(found.z_ideal, 0.0)
        assert len(found.w) > 100


def test_a_drilled_hole_has_no_section_across_the_feed():
    p = np.array([[0, 0, 2e-3], [0, 0, -5e-3]])
    path = CutPath(p, p + MOVED, np.array([False, True]))
    found = groove_sections(STOCK, Cutter("drill", 0.006, tip_angle=np.radians(118.0)), path, [4e-3])[0]
    assert (found.kind, found.measures) == ("unknown", ())
    assert "along the tool axis" in found.note


def test_a_tool_pushed_out_of_the_stock_cuts_nothing_and_every_measure_says_so():
    found = section([slot(z=-0.02)], FLAT, moved=np.array([0.0, 0.0, 0.03e-3]))
    assert found.kind == "groove"
    assert set(found.why) == set(found.measures)
    assert "cuts nothing" in found.why["width"]


def test_a_slot_beside_a_hole_of_the_stock_is_a_step_there():
    """A mesh block with a square window of 20 mm through it, whose edge lies 1 mm left of the path: on that side the
    cut ends in the void."""
    trimesh = pytest.importorskip("trimesh")
    bars = []
    for low, high in (
        ((-0.04, -0.03), (0.04, 0.001)),
        ((-0.04, 0.021), (0.04, 0.03)),
        ((-0.04, 0.001), (-0.01, 0.021)),
        ((0.01, 0.001), (0.04, 0.021)),
    ):
        bars.append(trimesh.creation.box(bounds=[[*low, -0.01], [*high, 0.0]]))
    mesh = trimesh.util.concatenate(bars)
    stock = Stock((-0.04, -0.03, -0.01), (0.04, 0.03, 0.0), np.asarray(mesh.triangles))
    at_hole = section([(-35, 0, -2, 35, 0, -2)], FLAT, stock=stock)
    beside = section([(-35, 0, -2, 35, 0, -2)], FLAT, stock=stock, off=0.025)
    assert (at_hole.kind, at_hole.near) == ("step", "right")
    assert at_hole.wall_right_error == pytest.approx(0.15e-3, abs=EXACT)
    assert beside.kind == "groove"
    assert beside.centre_offset == pytest.approx(0.15e-3, abs=EXACT)


@pytest.mark.parametrize("depth", [0.03, 2.0])
@pytest.mark.parametrize(("aside", "stepped"), [(-5.5, True), (5.5, True), (6.5, False)])
def test_a_floor_has_a_lean_where_it_is_straight_half_a_radius_to_either_side(depth, aside, stepped):
    """Another pass, 0.015 mm deeper, has cut from 4 mm beside its middle on; however shallow both are."""
    found = section([slot(z=-depth), slot(y=aside, z=-depth - 0.015)], FLAT, moved=np.zeros(3))
    if stepped:
        assert np.isnan(found.floor_tilt)
        assert "not straight" in found.why["floor_tilt"]
    else:
        assert found.floor_tilt == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("angle", [60.0, 90.0, 120.0])
def test_the_walls_of_a_v_groove_are_off_in_plan_as_the_cone_has_gone_aside_and_down(angle):
    """At one height a cone pushed aside and down is wider by its depth times the tangent of half its angle."""
    cone, half = Cutter("chamfer", 0.01, tip_angle=np.radians(angle)), np.radians(0.5 * angle)
    found = section([slot()], cone)
    wider = 0.06e-3 * np.tan(half)
    assert found.wall_left_error == pytest.approx(0.15e-3 + wider, abs=EXACT)
    assert found.wall_right_error == pytest.approx(0.15e-3 - wider, abs=EXACT)
