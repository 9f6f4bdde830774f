"""The swept envelope against brute force: a cutter stamped at many places along the move."""

import numpy as np
import pytest
import shapely

from robomill.cutting.tool import Cutter
from robomill.surface.envelope_kernels import move_between, row_interval, swept_height, swept_upright

CUTTERS = {
    "flat": Cutter("flat", 0.008),
    "ball": Cutter("ball", 0.008),
    "bull": Cutter("bull", 0.008, corner_radius=0.0015),
    "chamfer": Cutter("chamfer", 0.008, tip_angle=np.radians(90.0), tip_diameter=0.001),
}
MOVES = {
    "level": ((0.0, 0.0, 0.0), (0.02, 0.007, 0.0)),
    "ramp": ((0.0, 0.0, 0.0), (0.02, -0.007, 0.004)),
    "steep": ((0.002, 0.001, 0.01), (0.0, 0.0, 0.0)),
    "tiny rise": ((0.0, 0.0, 0.0), (0.01, 0.01, 1e-7)),
    "plunge": ((0.0, 0.0, 0.005), (0.0, 0.0, 0.0)),
    "point": ((0.0, 0.0, 0.001), (0.0, 0.0, 0.001)),
}


def brute_force(cutter, a, b, x, y, n=20001):
    t = np.linspace(0, 1, n)[:, None]
    tip = np.asarray(a) + t * (np.asarray(b) - np.asarray(a))
    r = np.hypot(x - tip[:, :1], y - tip[:, 1:2])
    return (tip[:, 2:] + cutter.profile(r)).min(axis=0)


def heights(shape, move, x, y):
    return np.array([swept_height(shape, move, *point) for point in zip(x, y, strict=True)])


def depth_in_track(a, b, R, x, y):
    """How far inside the track of a move points are: R less their distance to its line in plan."""
    line = shapely.LineString([a[:2], b[:2]]) if np.any(a[:2] != b[:2]) else shapely.Point(a[:2])
    return R - shapely.distance(line, shapely.points(x, y))


@pytest.mark.parametrize("cutter", CUTTERS)
@pytest.mark.parametrize("move", MOVES)
def test_envelope_is_the_lowest_stamp(cutter, move):
    a, b = (np.array(end) for end in MOVES[move])
    shape, moved = CUTTERS[cutter].solid, move_between(*a, *b)
    rng = np.random.default_rng(3)
    x, y = rng.uniform(-0.005, 0.026, 300), rng.uniform(-0.013, 0.015, 300)
    z, d = heights(shape, moved, x, y), depth_in_track(a, b, CUTTERS[cutter].radius, x, y)
    inside = d > 2e-5  # on the rim a stamp may miss what the sweep reaches
    expected = brute_force(CUTTERS[cutter], a, b, x, y)
    assert inside.sum() > 10
    assert np.isinf(expected[d < 0]).all()
    assert (z[inside] <= expected[inside] + 1e-15).all()
    # the stamps stand 1 um apart and miss the minimum by the slope times that at most
    assert expected[inside] == pytest.approx(z[inside], abs=6e-6)
    assert np.median(expected[inside] - z[inside]) < 1e-6


@pytest.mark.parametrize("cutter", CUTTERS)
def test_direction_of_travel_does_not_matter(cutter):
    shape = CUTTERS[cutter].solid
    a, b = np.array([0.0, 0.0, 0.001]), np.array([0.01, 0.004, 0.003])
    x, y = np.linspace(-0.003, 0.012, 50), np.linspace(-0.002, 0.005, 50)
    forth, back = (heights(shape, move_between(*p, *q), x, y) for p, q in ((a, b), (b, a)))
    np.testing.assert_array_equal(forth, back)


def test_row_interval_is_the_capsule():
    rng = np.random.default_rng(7)
    for _ in range(200):
        a, b = rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3)
        if rng.random() < 0.3:
            b[rng.integers(2)] = a[rng.integers(2)] * 0 + a[0] if rng.random() < 0.5 else a[1]
        move, R, x = move_between(*a, *b), rng.uniform(0.1, 0.8), rng.uniform(-1.5, 1.5)
        low, high = row_interval(move, R, x)
        y = np.linspace(-3, 3, 2001)
        span = b[:2] - a[:2]
        t = np.clip(((x - a[0]) * span[0] + (y - a[1]) * span[1]) / (span @ span), 0, 1)
        inside = np.hypot(x - a[0] - t * span[0], y - a[1] - t * span[1]) <= R
        np.testing.assert_array_equal((y >= low) & (y <= high), inside)


@pytest.mark.parametrize("cutter", CUTTERS)
@pytest.mark.parametrize("move", [name for name in MOVES if name != "point"])
def test_what_is_left_is_as_upright_as_its_heights_say(cutter, move):
    """Against the numeric gradient of the height, where it has one; a flat end on a ramp leaves the ramp."""
    a, b = (np.array(end) for end in MOVES[move])
    shape, moved = CUTTERS[cutter].solid, move_between(*a, *b)
    rng = np.random.default_rng(5)
    x, y = rng.uniform(-0.005, 0.026, 400), rng.uniform(-0.013, 0.015, 400)
    inside = depth_in_track(a, b, CUTTERS[cutter].radius, x, y) > 2e-5
    x, y, h = x[inside], y[inside], 1e-8
    slopes = []
    for dx, dy in ((h, 0.0), (0.0, h)):
        ahead, behind = heights(shape, moved, x + dx, y + dy), heights(shape, moved, x - dx, y - dy)
        here = heights(shape, moved, x, y)
        slopes.append(((ahead - behind) / (2 * h), np.abs(ahead + behind - 2 * here) / h))
    smooth = (slopes[0][1] < 1e-3) & (slopes[1][1] < 1e-3)  # not on a kink
    expected = 1.0 / np.sqrt(1.0 + slopes[0][0] ** 2 + slopes[1][0] ** 2)
    found = np.array([swept_upright(shape, moved, *point) for point in zip(x, y, strict=True)])
    assert smooth.sum() > 10
    np.testing.assert_allclose(found[smooth], expected[smooth], atol=2e-5)
