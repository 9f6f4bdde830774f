"""Sections of steps, pockets, rows and slopes drawn with pencil and compass, as those of grooves in
``test_section_of_shapes``: walls, floors, crests and slopes are those of circles, cones and planes.
"""

from __future__ import annotations

import numpy as np
import pytest

from robomill.surface.stock import Stock
from tests.surface.sections.shapes import BALL, BULL, CONE, EXACT, FLAT, THIN, degrees, section, slot


@pytest.mark.parametrize("angle", [0.0, 90.0, -90.0, 180.0])
def test_a_shoulder_has_the_place_of_its_one_wall(angle):
    """Half the cutter off the stock's edge: the wall is to the left of the feed."""
    half = np.array([0.03, 0.06]) if angle in (90.0, -90.0) else np.array([0.06, 0.03])
    stock = Stock((*-half, -0.01), (*half, 0.0))
    found = section([slot(y=-28.0)], FLAT, angle=angle, stock=stock)
    assert (found.kind, found.near) == ("step", "left")
    assert found.wall_left_error == pytest.approx(0.15e-3, abs=EXACT)
    assert found.depth == pytest.approx(2.06e-3, abs=EXACT)
    assert found.floor_error == pytest.approx(-0.06e-3, abs=EXACT)
    assert found.flatness == pytest.approx(0.0, abs=EXACT)
    assert degrees(found.wall_left_angle) == pytest.approx(90.0, abs=1e-4)
    assert np.isnan([found.width, found.centre_offset, found.wall_right, found.wall_right_angle]).all()


def test_a_path_on_the_edge_of_the_stock_leaves_a_step():
    found = section([slot(y=-30.0)], FLAT)
    assert (found.kind, found.near) == ("step", "left")
    assert found.wall_left_error == pytest.approx(0.15e-3, abs=EXACT)
    assert found.depth == pytest.approx(2.06e-3, abs=EXACT)


def test_a_path_beside_the_stock_that_trims_its_edge_leaves_a_step():
    """The axis is 2 mm beside the stock: 2 mm of the cutter are in it."""
    found = section([slot(y=-32.0)], FLAT)
    assert (found.kind, found.near) == ("step", "left")
    assert found.wall_left_error == pytest.approx(0.15e-3, abs=EXACT)
    assert found.floor_error == pytest.approx(-0.06e-3, abs=EXACT)


def test_a_step_below_what_an_earlier_pass_has_lowered():
    """To the right another pass has gone 1 mm deeper: the wall is to the left alone."""
    found = section([slot(), slot(y=-7.0, z=-3.0)], FLAT)
    assert (found.kind, found.near) == ("step", "left")
    assert found.wall_left_error == pytest.approx(0.15e-3, abs=EXACT)


def test_a_step_up_to_a_ledge_that_is_lower_than_the_stock():
    """Three passes side by side, each 1 mm deeper than the one before, at the stock's edge: the last stands under a
    ledge."""
    lines = [slot(y=-12.0, z=-1.0), slot(y=-19.0, z=-2.0), slot(y=-26.0, z=-3.0)]
    moved = np.array([[0, 0, 0], [0, 0, 0.02e-3], [0, 0.1e-3, -0.03e-3]])
    found = section(lines, FLAT, number=2, moved=moved)
    assert (found.kind, found.near) == ("step", "left")
    assert found.wall_left_error == pytest.approx(0.1e-3, abs=EXACT)
    assert found.depth == pytest.approx(1.05e-3, abs=EXACT)  # from the ledge as it is left
    assert found.wall_left_straightness < EXACT


def test_a_cone_along_an_edge_leaves_a_chamfer():
    found = section([slot(y=-30.0, z=-3.0)], CONE)
    assert (found.kind, found.near) == ("step", "left")
    assert degrees(found.wall_left_angle) == pytest.approx(135.0, abs=1e-4)
    # along the flank's level normal the push aside and the push down add: 0.15 mm and 0.06 mm * tan 45
    assert found.wall_left_error == pytest.approx(0.15e-3 + 0.06e-3, abs=EXACT)


ROWS = (-10.0, -5.0, 0.0, 5.0, 10.0)


def test_the_floor_of_a_pocket_says_how_high_and_how_flat_it_is():
    """Rows 5 mm apart, 0.00 to 0.04 mm too deep, seen 10 mm to either side of the middle one: there the first row alone
    has cut from -10 to -9 mm and the last one from 6 mm on, so all of the 0.04 mm lies in it."""
    moved = np.array([[0.0, 0.0, -0.01e-3 * n] for n in range(5)])
    found = section([slot(y=y) for y in ROWS], FLAT, number=2, moved=moved)
    assert found.kind == "pocket"
    assert found.floor_error == pytest.approx(-0.02e-3, abs=EXACT)
    assert found.flatness == pytest.approx(0.04e-3, abs=EXACT)
    assert np.isnan([found.width, found.centre_offset]).all()


def test_the_wall_of_a_pocket_is_measured_from_the_row_beside_it():
    moved = np.array([[0.0, 0.02e-3 * n, 0.0] for n in range(5)])
    found = section([slot(y=y) for y in ROWS], FLAT, number=4, moved=moved)
    assert (found.kind, found.near) == ("pocket", "left")
    assert found.wall_left_error == pytest.approx(0.08e-3, abs=EXACT)
    assert degrees(found.wall_left_angle) == pytest.approx(90.0, abs=1e-4)
    assert found.wall_left_straightness < EXACT


def test_rows_pushed_apart_leave_a_rib_that_is_no_flat_floor():
    """7.9 mm apart, told to overlap by 0.1 mm; pushed 0.15 mm apart a rib of 0.05 mm stands: no flat floor there."""
    moved = np.array([[0.0, -0.1e-3, 0.0], [0.0, 0.05e-3, 0.0], [0.0, 0.05e-3, 0.0]])
    found = section([slot(y=-7.9), slot(y=0.0), slot(y=7.9)], FLAT, number=1, moved=moved)
    assert found.kind == "pocket"
    assert not found.flatness < 1.9e-3
    assert np.nanmax([abs(found.wall_left_error), abs(found.wall_right_error), 0.0]) < 0.2e-3


@pytest.mark.parametrize("turn", [-12.0, 10.0, 25.0])
def test_a_wall_that_another_pass_made_is_measured_along_its_own_normal(turn):
    """A wall along x at y = 14 mm pushed by 0.1 mm; a section across a path that runs ``turn`` degrees to it meets it
    aslant and sees 0.1 mm / cos: the wall itself is off by 0.1 mm."""
    t = np.tan(np.radians(turn))
    rows = [slot(y=10.0), slot(y=5.0), slot(y=0.0)]
    other = (-8.0, 7.5 - 8.0 * t, -2.0, 8.0, 7.5 + 8.0 * t, -2.0)
    moved = np.array([[0.0, 0.1e-3, 0.0], *[[0.0, 0.0, 0.0]] * 3])
    found = section([*rows, other], FLAT, number=3, moved=moved)
    assert (found.kind, found.near) == ("pocket", "left")
    across = found.wall_left - found.wall_left_ideal
    assert across == pytest.approx(0.1e-3 / np.cos(np.radians(turn)), abs=EXACT)
    assert found.wall_left_error == pytest.approx(0.1e-3, abs=EXACT)


def test_rows_pushed_to_different_depths_do_not_tilt_the_floor():
    """Two rows 1 mm apart: the deeper one's rim passes 3 mm from the axis of the other; a step is not a tilt."""
    found = section([slot(), slot(y=5.0)], FLAT, moved=np.array([[0, 0, 0.0], [0, 0, -0.5e-3]]))
    assert found.floor_tilt == pytest.approx(0.0, abs=1e-6) or "not straight" in found.why["floor_tilt"]


@pytest.mark.parametrize("s", [0.4, 0.8, 1.5, 2.5])
def test_a_ball_raster_has_crests_of_s2_by_8r_and_an_error_along_its_normal(s):
    """Moved down by 0.06 mm and not aside it is the same surface lower: mean, RMS and largest error are 0.06 mm."""
    rows = [slot(y=y) for y in s * np.arange(-12, 13)]
    found = section(rows, BALL, number=12, moved=np.array([0.0, 0.0, -0.06e-3]))
    assert found.kind == "free"
    near = np.abs(found.w) < 1.01 * s * 1e-3
    crest = np.ptp(found.z_ideal[near])
    r = 4e-3
    height, sampled = r - np.sqrt(r * r - (0.5e-3 * s) ** 2), (found.w[1] - found.w[0]) * 0.5e-3 * s / r
    assert height - sampled < crest <= height + 1e-12  # drawn at points, one of which is beside the crest
    assert height == pytest.approx((1e-3 * s) ** 2 / (8 * r), rel=0.03)
    for name in ("error_mean", "error_max"):
        assert getattr(found, name) == pytest.approx(-0.06e-3, abs=EXACT)
    assert found.error_rms == pytest.approx(0.06e-3, abs=EXACT)
    assert found.slope == pytest.approx(0.0, abs=2e-3)
    assert np.isnan([found.width, found.depth, found.centre_offset, found.wall_left, found.floor_error]).all()


@pytest.mark.parametrize("tilt", [-20.0, 10.0, 30.0, 45.0])
def test_a_slope_finished_by_rows_of_a_ball_has_its_slope_and_its_normal_error(tilt):
    """Rows along x that climb to the left by ``tilt``: moved along y and z the plane is off by dz cos - dy sin."""
    t = np.radians(tilt)
    stock = Stock((-0.06, -0.03, -0.04), (0.06, 0.03, 0.0))
    rows = [(-50.0, y, -20.0 + y * np.tan(t), 50.0, y, -20.0 + y * np.tan(t)) for y in np.arange(-13.5, 13.51, 0.3)]
    found = section(rows, BALL, number=len(rows) // 2, moved=np.array([0.0, 0.05e-3, -0.04e-3]), stock=stock)
    truth = -0.04e-3 * np.cos(t) - 0.05e-3 * np.sin(t)
    assert found.kind == "free"
    assert found.slope == pytest.approx(abs(t), abs=np.radians(0.5))
    assert found.error_mean == pytest.approx(truth, abs=1e-6)
    assert np.sign(found.error_max) == np.sign(truth)
    assert found.error_rms == pytest.approx(abs(truth), abs=4e-6)


@pytest.mark.parametrize("aside", [-0.8e-3, 0.0, 0.8e-3])
def test_the_slope_is_that_of_the_told_surface_where_the_tool_was_told_to_be(aside):
    """Tips on a hollow of 30 mm radius, balls of 4 mm: they leave one of 34 mm, at Y6 as steep as asin(6 / 34)."""
    rows = [(-50.0, y, z, 50.0, y, z) for y in np.arange(-13.5, 13.51, 0.3) for z in [-np.sqrt(30.0**2 - y * y)]]
    number = int(np.argmin([abs(row[1] - 6.0) for row in rows]))
    stock = Stock((-0.06, -0.03, -0.04), (0.06, 0.03, 0.0))
    found = section(rows, BALL, number=number, moved=np.array([0.0, aside, -0.02e-3]), stock=stock)
    assert found.slope == pytest.approx(np.arcsin(6.0 / 34.0), abs=2e-3)


def test_a_slope_along_the_feed_counts_as_slope():
    """A ball goes up a ramp of 20 degrees in rows: the error along the normal is that across, by its cosine."""
    rise = 20.0 * np.tan(np.radians(20.0))
    rows = [(-10.0, y, -8.5, 10.0, y, -8.5 + rise) for y in np.arange(-5.0, 5.01, 0.5)]
    found = section(rows, BALL, number=10, moved=np.array([0.0, 0.0, -0.05e-3]))
    assert found.kind == "free"
    assert degrees(found.slope) == pytest.approx(20.0, abs=0.1)
    assert found.error_mean == pytest.approx(-0.05e-3 * np.cos(np.radians(20.0)), abs=1e-7)


def test_a_face_milled_over_its_whole_width_is_a_surface_without_walls():
    stock = Stock((-0.06, -0.012, -0.01), (0.06, 0.012, 0.0))
    found = section([slot(y=y, z=-0.5) for y in (-9.0, -3.0, 3.0, 9.0)], FLAT, number=1, stock=stock)
    assert found.kind == "free"
    assert (found.error_mean, found.error_max) == pytest.approx((-0.06e-3, -0.06e-3), abs=EXACT)
    assert found.slope == pytest.approx(0.0, abs=1e-6)


def test_terraces_finer_than_a_quarter_of_the_radius_are_a_slope():
    rows = [(-50.0, y, -6.0 + 0.8 * y, 50.0, y, -6.0 + 0.8 * y) for y in np.arange(-4.0, 4.01, 0.4)]
    found = section(rows, FLAT, number=10)
    assert found.kind == "free"


@pytest.mark.parametrize("cutter", [FLAT, BALL, BULL, CONE, THIN])
@pytest.mark.parametrize("spacing", [1.5, 4.0, 6.5, 8.05])
def test_no_section_of_rows_says_what_cannot_be(cutter, spacing):
    """Whatever the rows: walls lean between upright and the cutter's flank, are straight to what the rows differ, and
    what is not measured has a reason."""
    rows = [(-30.0, spacing * n, -2.0 - 0.3 * (n % 3), 30.0, spacing * n, -2.0 - 0.3 * (n % 3)) for n in range(-3, 4)]
    moved = np.array([[0.0, 0.05e-3 * (-1) ** n, -0.02e-3 * n] for n in range(7)])
    for number in range(7):
        found = section(rows, cutter, number=number, moved=moved)
        for side in ("left", "right"):
            angle, form = (getattr(found, f"wall_{side}_{name}") for name in ("angle", "straightness"))
            assert not degrees(angle) > 90.0 + degrees(cutter.half_angle) + 3.0
            assert not degrees(angle) < 87.0
            assert not form > 0.15e-3
            assert not abs(getattr(found, f"wall_{side}_error")) > 0.2e-3
        assert not abs(found.floor_tilt) > np.radians(1.0)
        for name in found.measures:
            assert np.isfinite(getattr(found, name)) or found.why.get(name), (found.kind, name)
