"""The engaged part: sectors of the turn, sums of a full slot by adaptive quadrature, and what of it counts."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from robomill.cutting.edge import EdgeTerm
from robomill.cutting.engaged import FACING, EngagedPart, end_of, full_slot, nose_of, sector_edges
from robomill.cutting.tool import DISH, PRESSED
from robomill.errors import CuttingError
from tests.cutting.cutters import CUTTERS, MILL


@pytest.mark.parametrize(("count", "turn"), [(1, np.pi), (2, 2 * np.pi), (48, np.pi), (96, 2 * np.pi)])
def test_sectors_part_one_or_two_half_turns(count, turn):
    edges = sector_edges(count)
    assert (len(edges), edges[0]) == (count + 1, 0.0)
    assert edges[-1] == pytest.approx(turn)
    assert (np.diff(edges) > 0.0).all()
    np.testing.assert_allclose(edges, turn - edges[::-1], atol=1e-15)


def test_finer_sectors_are_quarters_of_panels_that_crowd_at_the_sides():
    """Twelve panels between the projections of twelve equal angles of another half turn on its diameter."""
    edges = sector_edges(48)
    panels = edges[::4]
    np.testing.assert_allclose(np.arccos(1.0 - 2.0 * panels / np.pi), np.pi * np.arange(13) / 12, atol=1e-12)
    for i, (low, high) in enumerate(pairwise(panels)):
        np.testing.assert_allclose(edges[4 * i : 4 * i + 5], np.linspace(low, high, 5), rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(sector_edges(96)[48:], edges + np.pi, rtol=1e-15)


def test_a_part_touches_where_any_of_its_sums_is_not_zero():
    moments = np.zeros((3, 2, 8))
    moments[1, 1, 6] = 1e-12
    part = EngagedPart((1.0, 0.0), moments, np.zeros((3, 1, 4)))
    np.testing.assert_array_equal(part.touches, [False, True, False])
    np.testing.assert_array_equal(part.of(0.0)[1], [0, 0, 0, 0, 0, 0, 1e-12, 0])
    with pytest.raises(CuttingError, match=r"\(1.0, 0.0\); the force law has 0.74"):
        part.of(0.74)


def profile(cutter, depth):
    """Pieces of the profile (from, to, length a unit, angle of the normal) as functions of z, by hand."""
    R, rho = cutter.diameter / 2, cutter.corner_radius
    if cutter.kind == "chamfer":
        half, height = cutter.tip_angle / 2, (R - cutter.tip_diameter / 2) / math.tan(cutter.tip_angle / 2)
        nose = (0.0, min(depth, height), lambda z: 1.0 / math.cos(half), lambda z: math.pi / 2 - half)
    else:
        height = rho
        kappa = lambda z: math.acos(1.0 - z / rho)  # noqa: E731
        nose = (0.0, min(depth, height), lambda z: 1.0 / math.sin(kappa(z)), kappa)
    side = (height, max(depth, height), lambda z: 1.0, lambda z: math.pi / 2)
    return [piece for piece in (nose, side) if piece[1] > piece[0]]


def over_turn(e, ahead, along, kappa):
    """Integrals over the turn of (v . n)^e times 1 and sin phi, where a surface whose normal leans kappa faces the feed
    v = (ahead, along): v . n = ahead sin kappa sin phi - along cos kappa."""
    s, t = ahead * math.sin(kappa), -along * math.cos(kappa)
    if s + t <= FACING:
        return np.zeros(2)
    low, high = (0.0, 2.0 * math.pi) if t >= s else (-math.asin(t / s), math.pi + math.asin(t / s))
    one, sine = high - low, math.cos(low) - math.cos(high)
    square = 0.5 * one - 0.25 * (math.sin(2 * high) - math.sin(2 * low))
    return np.array([one, sine]) if e == 0.0 else np.array([s * sine + t * one, s * square + t * sine])


@pytest.mark.parametrize("along", [-1.0, -0.6, -0.0005, 0.3])
@pytest.mark.parametrize("depth", [0.6e-3, 9e-3])
@pytest.mark.parametrize("cutter", CUTTERS, ids=lambda c: c.kind)
def test_sums_of_a_full_slot_by_quadrature(cutter, depth, along):
    ahead = math.sqrt(1.0 - along**2)
    found = full_slot(cutter, (1.0, 0.0), np.array([depth]), np.array([along])).moments[0]
    for n, e in enumerate((1.0, 0.0)):

        def over_profile(which, weight, e=e):
            return sum(
                quad(lambda z: over_turn(e, ahead, along, k(z))[which] * weight(k(z)) * length(z), low, high)[0]  # noqa: B023
                for low, high, length, k in profile(cutter, depth)
            )

        one, sine = over_turn(e, ahead, along, 0.0) * cutter.flat_radius * (-along > DISH)
        sums = [
            0.0,
            over_profile(1, lambda kappa: 1.0) + sine,
            over_profile(1, math.sin),
            0.0,
            over_profile(0, math.cos) + one,
            over_profile(1, math.cos) + sine,
            0.0,
            over_profile(0, math.sin),
        ]
        np.testing.assert_allclose(found[n], sums, atol=4e-3 * np.abs(sums).max())


def test_all_of_the_end_of_a_flat_mill_takes_part_from_its_dish_on_and_none_where_it_is_pressed():
    slopes = np.array([0.0, -PRESSED, -DISH, -1.001 * DISH])
    ends = full_slot(MILL, (0.0,), np.full(4, 2e-3), slopes).moments[:, 0, 4]
    np.testing.assert_allclose(ends, MILL.radius * 2.0 * np.pi * np.array([0.0, 0.0, 1.0, 1.0]), atol=1e-15)


@pytest.mark.parametrize("share", [0.05, 0.3, 0.7, 0.95])
def test_a_hollow_end_cuts_where_its_rim_has_passed_higher_before(share):
    """Points of an end that rises towards the axis by the dish, on a slope ``share`` of it as steep: material stands
    where no earlier place of the end, the rim with it, was as low. Looked at place by place along the way."""
    R, dish = 4e-3, math.tan(math.asin(DISH))
    slope = share * dish
    way = np.linspace(0.0, 2.2 * R, 4001)[1:]
    for phi in np.radians([-175.0, -90.0, -60.0, -20.0, 3.0, 30.0, 61.0, 89.0]):
        r = (np.arange(200) + 0.5) * R / 200
        x, y, z = r * math.sin(phi), r * math.cos(phi), (R - r) * dish
        far = np.hypot(x[:, None] + way, y[:, None])  # of the axis where it was before
        lowest = np.where(far <= R, way * slope + (R - far) * dish, np.inf).min(axis=1)
        stands = lowest > z + 1e-9
        assert end_of(MILL, share, math.sin(phi)) == pytest.approx(stands.mean() * R, abs=0.012 * R)


def test_the_force_of_a_full_slot_is_continuous_in_its_slope():
    """Angles 64 times as close together change it by at most a quarter as much: there is no jump at any angle, and at
    the dish no more than the corner of a square root."""
    terms = (EdgeTerm(1.0, 8e8, 3e8, 1e8), EdgeTerm(0.0, 2e4, 2e4, 1e3))

    def largest_change(step):
        angles = np.radians(np.arange(0.0, 0.6, step))
        part = full_slot(MILL, (1.0, 0.0), np.full(len(angles), 2e-3), -np.sin(angles))
        return np.abs(np.diff(part.force(terms, MILL, 0.05e-3), axis=0)).max(axis=0)

    assert (largest_change(0.04 / 64) < largest_change(0.04) / 4.0).all()


def test_a_surface_that_faces_the_feed_by_less_than_a_millionth_does_not_cut():
    plunge = full_slot(MILL, (0.0,), np.array([2e-3]), np.array([-1.0])).moments[0, 0]
    assert plunge[7] == 0.0  # the flank of a mill that goes straight down
    nearly = math.sqrt(1.0 - (0.5 * FACING) ** 2)
    assert full_slot(MILL, (0.0,), np.array([2e-3]), np.array([-nearly])).moments[0, 0, 7] == 0.0


@pytest.mark.parametrize("cutter", CUTTERS, ids=lambda c: c.kind)
@pytest.mark.parametrize("share", [0.0, 0.4, 1.0])
def test_pieces_of_a_nose_lie_on_its_profile(cutter, share):
    top = share * cutter.nose_height
    low, high, kappa, ds = nose_of(cutter, top)
    if top == 0.0:
        assert not np.concatenate([low, high, ds]).any()
        return
    assert (low[0], high[-1]) == (0.0, pytest.approx(top))
    np.testing.assert_array_equal(low[1:], high[:-1])
    np.testing.assert_allclose(np.diff(ds), 0.0, atol=1e-12)
    radius = [cutter.radius_at(z) for z in (low, high)]
    np.testing.assert_allclose(ds, np.hypot(high - low, radius[1] - radius[0]), rtol=1e-3)
    # The normal stands across the chord: its slope is the profile's.
    np.testing.assert_allclose(np.tan(0.5 * np.pi - kappa), (radius[1] - radius[0]) / (high - low), rtol=1e-9)
