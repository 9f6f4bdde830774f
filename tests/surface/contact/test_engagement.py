"""Engagement against geometry: air, entry, slot, half immersion, earlier passes, exit."""

from itertools import pairwise

import numpy as np
import pytest
import shapely

from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.surface.contact.engagement import engage as engage_march
from robomill.surface.contact.march import March
from robomill.surface.stock import Stock
from tests.cutting.brute_force import UPRIGHT, Cut, Floats, Move, axis, box, in_tool_axes
from tests.simulation.cuts import AL7075, FEED, MM

R = 0.004
FLAT = Cutter("flat", 2 * R)
CELL = 1e-4
STOCK = Stock((0.0, -0.02, -0.01), (0.04, 0.02, 0.0))


def engage(*path):
    return engage_march(March(*path))


def line(a, b, step=5e-4):
    a, b = np.asarray(a, float), np.asarray(b, float)
    n = int(np.ceil(np.linalg.norm(b - a) / step))
    return a + np.linspace(0, 1, n + 1)[:, None] * (b - a)


def degrees(found, x, p, at):
    """phi_st, phi_ex in degrees of the step that ends nearest to x = at."""
    n = int(np.argmin(np.abs(x[1:] - at))) + 1
    return np.degrees(found.phi_st[n]), np.degrees(found.phi_ex[n]), found.a_p[n], found.a_e[n]


def run(p, stock=STOCK, cutter=FLAT, k=None, cutting=None):
    return engage(stock, CELL, cutter, p, k, cutting)


def test_air_entry_slot_and_exit():
    p = line([-0.01, 0, -0.002], [0.05, 0, -0.002])
    found = run(p)
    x = p[:, 0]
    air = (x < -R - 2e-4) | (x > 0.04 + 2e-4)
    assert (found.phi_st[air] == 0).all()
    assert (found.phi_ex[air] == 0).all()
    assert (found.a_p[air] == 0).all()
    assert degrees(found, p[:, 0], p, 0.02) == pytest.approx((0.0, 180.0, 0.002, 0.008), rel=1e-5)
    # entering, the arc ahead of the stock's face x = 0 is open: half angle acos(distance / R) about 90 degrees
    # (near 0 and 180 degrees, where the chip has no thickness, material is seen a little early)
    for at, tolerance in ((-0.003, 6.0), (-0.002, 6.0), (-0.001, 12.0)):
        half = np.degrees(np.arccos(-at / R))
        st, ex, a_p, _ = degrees(found, p[:, 0], p, at)
        assert (st, ex) == pytest.approx((90 - half, 90 + half), abs=tolerance)
        assert a_p == pytest.approx(0.002)
    rising = found.a_e[(x > -R) & (x < 0)]
    assert (np.diff(rising) >= 0).all()


@pytest.mark.parametrize("angle", [0.0, 90.0, 37.0])
def test_half_and_quarter_immersion(angle):
    """A block edge along the feed: material only on the right (or left) of a line."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    stock = Stock((-0.03, -0.03, -0.01), (0.03, 0.03, 0.0))
    first = line([-0.05, 0.0, -0.002], [0.05, 0.0, -0.002]) @ turn.T
    for offset, st, ex in ((-R, 90.0, 180.0), (R, 0.0, 90.0), (-R / 2, 120.0, 180.0)):
        # an earlier pass has cleared y > -R .. R about y = 0; the second runs beside it
        second = line([-0.05, offset, -0.002], [0.05, offset, -0.002]) @ turn.T
        p = np.vstack([first, second])
        cutting = np.ones(len(p), bool)
        cutting[len(first)] = False
        found = run(p, stock, cutting=cutting)
        middle = len(first) + len(second) // 2
        expected_st, expected_ex = (st, ex) if abs(offset) == R else (120.0, 180.0)
        assert np.degrees(found.phi_st[middle]) == pytest.approx(expected_st, abs=3.0)
        assert np.degrees(found.phi_ex[middle]) == pytest.approx(expected_ex, abs=3.0)
        width = R if abs(offset) == R else R / 2
        assert found.a_e[middle] == pytest.approx(width, abs=2 * CELL)


def test_a_second_pass_in_the_same_slot_is_air():
    first = line([-0.01, 0, -0.002], [0.05, 0, -0.002])
    found = run(np.vstack([first, first[::-1]]))
    back = slice(len(first) + 1, None)
    assert found.a_p[: len(first)].max() == pytest.approx(0.002)
    assert (found.a_p[back] == 0).all()
    assert (found.phi_ex[back] == 0).all()


def test_second_depth_meets_only_what_is_left():
    first = line([-0.01, 0, -0.002], [0.05, 0, -0.002])
    second = first[::-1] - np.array([0, 0, 0.001])
    found = run(np.vstack([first, second]), cutting=np.arange(2 * len(first)) != len(first))
    n = len(first) + len(first) // 2
    assert found.a_p[n] == pytest.approx(0.001)
    assert np.degrees(found.phi_ex[n]) == 180.0


def test_stepped_stock_gives_the_mean_depth():
    """Right half 2 mm deep, left half cleared to 1 mm: an arc of 180 degrees with 1.5 mm on average."""
    clear = line([-0.02, R, -0.001], [0.06, R, -0.001])
    clear2 = line([0.06, R + 2e-3, -0.001], [-0.02, R + 2e-3, -0.001])
    slot = line([-0.02, 0, -0.002], [0.06, 0, -0.002])
    p = np.vstack([clear, clear2, slot])
    found = run(p)
    n = len(clear) + len(clear2) + len(slot) // 2
    assert np.degrees([found.phi_st[n], found.phi_ex[n]]) == pytest.approx([0.0, 180.0])
    assert found.a_p[n] == pytest.approx(0.0015, abs=3e-5)


def test_a_plunge_engages_its_end_and_no_flank():
    """The disk of the end faces the feed: dphi ds over it is 2 pi R; nothing of the flank does."""
    found = run(line([0.02, 0, 0.003], [0.02, 0, -0.003]))
    inside = np.append(False, line([0.02, 0, 0.003], [0.02, 0, -0.003])[1:, 2] < -1e-9)
    assert (found.a_p == 0).all()
    np.testing.assert_array_equal(found.part.touches, inside)
    lying, upright = found.part.of(1.0)[:, 4], found.part.of(1.0)[:, 7]
    np.testing.assert_allclose(lying[inside], 2 * np.pi * R, rtol=1e-6)
    np.testing.assert_allclose(upright, 0.0, atol=1e-12)


def test_ball_engages_at_its_effective_radius():
    p = line([-0.01, 0, -0.001], [0.05, 0, -0.001])
    found = run(p, cutter=Cutter("ball", 2 * R))
    n = len(p) // 2
    assert np.degrees([found.phi_st[n], found.phi_ex[n]]) == pytest.approx([0.0, 180.0])
    assert found.a_p[n] == pytest.approx(0.001, rel=1e-6)
    assert found.a_e[n] == pytest.approx(2 * np.sqrt(2 * R * 1e-3 - 1e-6), rel=0.02)


def test_unreached_steps_do_not_engage():
    p = line([-0.01, 0, -0.002], [0.05, 0, -0.002])
    p[40] = np.nan
    found = run(p)
    assert found.a_p[40] == found.a_p[41] == 0
    assert found.a_p[39] > 0


def in_material(material, stock, points):
    return shapely.contains_xy(material, points[:, 0], points[:, 1]) & shapely.contains_xy(
        shapely.box(*stock.lower[:2], *stock.upper[:2]), points[:, 0], points[:, 1]
    )


def test_engaged_width_against_shapes():
    """A flat mill on a level walk: what stands ahead of its rim is the block less the capsules of the steps before."""
    rng = np.random.default_rng(6)
    corners = np.column_stack([rng.uniform(0.0, 0.04, 7), rng.uniform(-0.02, 0.02, 7), np.full(7, -0.002)])
    p = np.vstack([line(a, b, 1.7e-3) for a, b in pairwise(corners)])
    p = p[np.append(True, np.linalg.norm(np.diff(p, axis=0), axis=1) > 0)]
    cell = 5e-5
    found = engage(STOCK, cell, FLAT, p)
    material = shapely.box(*STOCK.lower[:2], *STOCK.upper[:2])
    phi = (np.arange(3600) + 0.5) * np.pi / 3600
    widths, depths, plain = [], [], []
    for a, b in pairwise(p[:, :2]):
        feed = (b - a) / np.linalg.norm(b - a)
        left = np.array([-feed[1], feed[0]])
        rim = b - 1e-6 * feed + (R + 1e-6) * (np.sin(phi)[:, None] * feed + np.cos(phi)[:, None] * left)
        touched = in_material(material, STOCK, rim)
        widths.append(R * np.sin(phi)[touched].sum() * np.pi / 3600)
        parts = np.diff(np.flatnonzero(np.diff(touched, prepend=~touched[0], append=~touched[-1])))
        plain.append(parts.min() * np.pi / 3600 > 0.25)  # thinner ribs and gaps than R / 4 may be passed over
        span = np.flatnonzero(touched)
        depths.append(0.002 * len(span) / (span[-1] + 1 - span[0]) if len(span) else 0.0)
        material = material.difference(shapely.LineString([a, b]).buffer(R, quad_segs=200))
    assert np.mean(plain) > 0.9
    assert np.abs(found.a_e[1:] - widths)[plain].max() < 8 * cell
    assert np.median(np.abs(found.a_e[1:] - widths)) < 1.5 * cell
    assert np.median(np.abs(found.a_p[1:] - depths)) < 2e-5
    assert 0.1 < np.mean(np.array(widths) > 0.5 * R) < 0.95


@pytest.mark.parametrize("lean", [0.1, -0.2])
def test_a_leaning_mill_meets_more_along_its_axis(lean):
    """Leaning across the feed, in uncut material: the depth along the axis is on average the depth over its cosine."""
    k = np.array([0.0, np.sin(lean), np.cos(lean)])
    stock = Stock((0.0, -0.02, -0.01), (0.04, 0.02, 0.0))
    found = engage(stock, CELL, FLAT, np.array([[0.02, 0.0, -0.003], [0.0203, 0.0, -0.003]]), k)
    assert np.degrees([found.phi_st[1], found.phi_ex[1]]) == pytest.approx([0.0, 180.0])
    assert found.a_p[1] == pytest.approx(0.003 / np.cos(lean), rel=1e-3)
    assert found.a_e[1] == pytest.approx(2 * R, rel=1e-3)


@pytest.mark.parametrize("lean", [0.1, -0.2])
def test_a_leaning_mill_cuts_what_it_meets(lean):
    """Back through its own slot next to nothing is left (material is looked up straight above the tip plane, not along
    the axis)."""
    k = np.array([0.0, np.sin(lean), np.cos(lean)])
    p = line([-0.01, 0.0, -0.003], [0.05, 0.0, -0.003], 2e-3)
    back = engage(STOCK, 2 * CELL, FLAT, np.vstack([p, p[::-1]]), k)
    assert back.a_p[: len(p)].max() > 0.002
    assert (back.a_p[len(p) + 1 :] < 0.15 * back.a_p.max()).all()


@pytest.mark.parametrize(
    ("cutter", "radius"),
    [
        (Cutter("bull", 2 * R, corner_radius=0.002), lambda h: 0.002 + np.sqrt(0.002**2 - (0.002 - h) ** 2)),
        (Cutter("chamfer", 2 * R, tip_angle=np.radians(90.0), tip_diameter=0.002), lambda h: 0.001 + h),
        (Cutter("ball", 2 * R), lambda h: np.sqrt(R**2 - (R - h) ** 2)),
    ],
    ids=["bull", "chamfer", "ball"],
)
def test_a_shaped_cutter_is_as_wide_as_at_the_materials_top(cutter, radius):
    depth = 0.0012
    p = line([-0.01, 0.0, -depth], [0.05, 0.0, -depth])
    found = engage(STOCK, CELL, cutter, p)
    n = len(p) // 2
    assert found.a_e[n] == pytest.approx(2 * radius(depth), rel=1e-4)
    assert found.a_p[n] == pytest.approx(depth, rel=1e-9)
    assert np.degrees([found.phi_st[n], found.phi_ex[n]]) == pytest.approx([0.0, 180.0])


def test_a_standing_tool_and_one_drawn_out_engage_nothing():
    out = engage(STOCK, CELL, FLAT, np.array([[0.02, 0.0, -0.003], [0.02, 0.0, 0.0]]))
    assert not out.part.touches.any()
    still = engage(STOCK, CELL, FLAT, np.array([[0.02, 0.0, -0.002], [0.02, 0.0, -0.002]]))
    assert still.a_p[1] == 0.0


def test_below_the_stock_there_is_nothing():
    """A cutter under the block's lower face meets the whole block, and what is cut away is gone."""
    p = line([-0.01, 0.0, -0.015], [0.05, 0.0, -0.015])
    found = engage(STOCK, CELL, FLAT, np.vstack([p, p[::-1]]))
    n = len(p) // 2
    assert found.a_p[n] == pytest.approx(0.01)
    assert (found.a_p[len(p) + 1 :] == 0).all()


@pytest.mark.parametrize("passes", [2, 4, 7, 9])
def test_from_a_gap_on_that_no_column_has_room_for_nothing_is_known(passes):
    """Slots of a tool that leans 60 degrees, one above the other: a column keeps six gaps between seven layers."""
    lean, radius = np.radians(60.0), 1e-3
    stock = Stock((-0.02, -0.01, -0.08), (0.02, 0.01, 0.0))
    depths = -0.008 - 0.006 * np.arange(passes)
    p = np.array([(0.0, side, z) for z in depths for side in (-0.015, 0.015)])
    k, cutting = np.array([np.sin(lean), 0.0, np.cos(lean)]), np.tile([False, True], passes)
    found = engage(stock, 5e-4, Cutter("flat", 2 * radius), p, k, cutting)
    x, z = np.arange(-0.01975, 0.02, 5e-4), depths[:, None]
    middle = z + x / np.tan(lean)
    low = np.maximum(middle - radius / np.sin(lean), z - x * np.tan(lean))  # of the slot, and of its flat end
    high = middle + radius / np.sin(lean)
    inside = (low < high) & (high < 0.0) & (low > -0.08)
    gaps = np.cumsum(inside, axis=0).max(axis=1)  # most in a column after each slot
    assert gaps.max() == passes
    np.testing.assert_array_equal(found.part.known[1::2], np.concatenate([[True], gaps[:-1] <= 6]))


def finishing(cutter: Cutter, k: Floats, tips: list[tuple[float, float]], cell: float) -> float:
    """How far the force of the last of some passes along X, tips at (y, z) mm beside a block whose side is y = 0 and
    whose top is z = 0, is off, as a share of it."""
    low, high, ahead = np.array([-20.0, 0.0, -25.0]) * MM, np.array([20.0, 10.0, 0.0]) * MM, np.array([1.0, 0.0, 0.0])
    ends = [np.array([[-30.0, y, z], [30.0, y, z]]) * MM for y, z in tips]
    ends[-1] = np.vstack([ends[-1][0], [[2.5e-3, *ends[-1][0][1:]], [3e-3, *ends[-1][0][1:]]]])
    p = np.concatenate(ends)
    cutting = np.concatenate([np.arange(len(each)) > 0 for each in ends])
    axes = np.tile(k, (len(p), 1))
    part = engage(Stock(low, high), cell * MM, Tooling.of(cutter, len(p)), p, axes, cutting).part
    found = part.force(AL7075, cutter, np.full(len(p), FEED))[-1]
    moves = tuple(Move(cutter, each[0], each[-1] - 1e-8 * ahead, k) for each in ends)
    cut = Cut(box(low, high), moves, 8 * MM, 1_000_000)
    truth = in_tool_axes(cut.mean_force(cutter, AL7075, ends[-1][-1], FEED * ahead, k), ahead, k)
    return float(np.linalg.norm(found - truth) / np.linalg.norm(truth))


BALL10 = Cutter("ball", 10 * MM, flutes=5)
DOWN_A_WALL = {"0.2 by 0.3": (0.2, 0.3), "0.1 by 0.3": (0.1, 0.3), "0.2 by 1": (0.2, 1.0), "0.05 square": (0.05, 0.05)}


@pytest.mark.parametrize("cell", [0.1, 0.2])
@pytest.mark.parametrize("bite", DOWN_A_WALL)
def test_what_a_ball_takes_off_a_wall_is_narrower_than_a_piece_of_its_nose(bite: str, cell: float) -> None:
    a_e, down = DOWN_A_WALL[bite]
    tips = [(a_e - 5.0, -6.0 - down * n) for n in range(4)]
    assert finishing(BALL10, UPRIGHT, tips, cell) < 0.05


@pytest.mark.parametrize("aside", [-2.0, -2.5, -3.0, -3.3])
def test_an_edge_of_the_stock_that_a_leaning_ball_takes_off(aside: float) -> None:
    assert finishing(BALL10, axis(B=18), [(aside, -1.4)], 0.1) < 0.05


@pytest.mark.parametrize("point", [60.0, 90.0, 118.0])
def test_a_point_that_widens_a_hole_cuts_the_ring_that_is_left_at_its_top(point: float) -> None:
    """Of a cone on its way down into a hole of radius r a ring is in the material, from r to where its flank passes the
    top: so wide, all round. Rings are as narrow as 0.02 mm, where the hole has just been met."""
    hole, half = 3 * MM, np.radians(point / 2)
    cone = Cutter("chamfer", 16 * MM, tip_angle=2 * half)
    wide = np.array([0.02, 0.05, 0.08, 0.13, 0.2, 0.33, 0.5, 0.8]) * MM
    tips = np.append(1 * MM, -(hole + wide) / np.tan(half))
    z = np.concatenate([[1 * MM, -19 * MM], tips])
    p = np.column_stack([0 * z, 0 * z, z])
    made = Tooling((Cutter("flat", 2 * hole), cone), np.repeat([0, 1], [2, len(tips)]))
    block = Stock((-0.01, -0.01, -0.02), (0.01, 0.01, 0.0))
    part = engage(block, 2 * CELL, made, p, None, [False, True, False, *np.ones(len(wide), dtype=bool)]).part
    length = part.of(0.0)[3:, 7] / (2 * np.pi * np.cos(half))  # of edge, the mean over a turn
    np.testing.assert_allclose(length, wide / np.sin(half), rtol=0.02, atol=2e-6)
