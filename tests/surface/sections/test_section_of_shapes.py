"""Sections of shapes drawn with pencil and compass: each is known for what it is and measured to a cell's hundredth.

The commanded path is the shape; every pass is moved by a known deviation. Nothing here asks the product what a cutter
leaves: walls, floors, crests and slopes are those of circles, cones and planes.
"""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.surface.sections.groove import groove_sections
from robomill.surface.stock import Stock
from robomill.surface.swept import CutPath

FLAT, THIN = Cutter("flat", 0.008, flutes=3), Cutter("flat", 0.003)
BALL, CONE = Cutter("ball", 0.008), Cutter("chamfer", 0.01, tip_angle=np.radians(90.0), tip_diameter=1e-3)
BULL = Cutter("bull", 0.008, corner_radius=1e-3)
STOCK = Stock((-0.06, -0.03, -0.01), (0.06, 0.03, 0.0))
MOVED = np.array([0.0, 0.15e-3, -0.06e-3])  # feed, feed-normal, up
EXACT = 1e-8  # m: a ten-thousandth of a usual cell


def passes(*lines, step=1e-3, angle=0.0):
    """Straight passes (x0, y0, z0, x1, y1, z1) mm at feed with rapids between them: points m, cutting (m,), which pass
    (m,); turned by ``angle`` degrees about Z."""
    points, cutting, which = [], [], []
    for number, line in enumerate(lines):
        a, b = 1e-3 * np.array(line[:3], dtype=float), 1e-3 * np.array(line[3:], dtype=float)
        count = max(int(np.ceil(np.linalg.norm(b - a) / step)), 1)
        points.append(a + np.linspace(0, 1, count + 1)[:, None] * (b - a))
        cutting += [False] + [True] * count
        which += [number] * (count + 1)
    turn = np.radians(angle)
    R = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    return np.vstack(points) @ R.T, np.array(cutting), np.array(which), R


def middle_of(p, cutting, which, number):
    """Station (m) in the middle of a pass."""
    s = np.cumsum(np.append(0.0, np.where(cutting[1:], np.linalg.norm(np.diff(p, axis=0), axis=1), 0.0)))
    own = s[which == number]
    return 0.5 * (own[0] + own[-1])


def section(lines, cutter, *, number=0, moved=MOVED, stock=STOCK, angle=0.0, k=None, off=0.0):
    """The section in the middle of pass ``number`` (``off`` m further); ``moved`` (3,) or one for each pass, along the
    shape's own axes."""
    p, cutting, which, R = passes(*lines, angle=angle)
    delta = (np.broadcast_to(moved, (len(lines), 3))[which]) @ R.T
    station = middle_of(p, cutting, which, number) + off
    return groove_sections(stock, cutter, CutPath(p, p + delta, cutting, k), [station])[0]


def slot(y=0.0, z=-2.0, x=50.0):
    return (-x, y, z, x, y, z)


def degrees(angle):
    return float(np.degrees(angle))


# --- grooves ---------------------------------------------------------------------------------------------------------


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


# --- steps -----------------------------------------------------------------------------------------------------------


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


# --- pockets ---------------------------------------------------------------------------------------------------------

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


# --- free surfaces ---------------------------------------------------------------------------------------------------


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


# --- nothing, and what is not known ----------------------------------------------------------------------------------


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


# --- stocks of other shapes ------------------------------------------------------------------------------------------


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


# --- nothing impossible ----------------------------------------------------------------------------------------------


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
