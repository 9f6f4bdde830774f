"""The swept envelope against brute force: a cutter stamped at many places along the move."""

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.surface import envelope
from robomill.surface.envelope import cutter_shape

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


@pytest.mark.parametrize("cutter", CUTTERS)
@pytest.mark.parametrize("move", MOVES)
def test_envelope_is_the_lowest_stamp(cutter, move):
    a, b = (np.array(end) for end in MOVES[move])
    shape, moved = cutter_shape(CUTTERS[cutter]), envelope.move_of(a, b)
    rng = np.random.default_rng(3)
    x, y = rng.uniform(-0.005, 0.026, 300), rng.uniform(-0.013, 0.015, 300)
    z, d = envelope.swept_height(shape, moved, x, y)
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
    shape = cutter_shape(CUTTERS[cutter])
    a, b = np.array([0.0, 0.0, 0.001]), np.array([0.01, 0.004, 0.003])
    x, y = np.linspace(-0.003, 0.012, 50), np.linspace(-0.002, 0.005, 50)
    forth, back = (envelope.swept_height(shape, envelope.move_of(*ends), x, y) for ends in ((a, b), (b, a)))
    np.testing.assert_array_equal(forth, back)


def test_many_moves_at_once_equal_one_by_one():
    rng = np.random.default_rng(5)
    ends = np.vstack([rng.uniform(-0.01, 0.01, (30, 6)), np.zeros((1, 6))])
    ends[:5, 5] = ends[:5, 2]
    x, y = rng.uniform(-0.01, 0.01, 40), rng.uniform(-0.01, 0.01, 40)
    for cutter in CUTTERS.values():
        shape = cutter_shape(cutter)
        z, d = envelope.swept_height(shape, envelope.moves_of(ends), x, y)
        for n, end in enumerate(ends):
            z_n, d_n = envelope.swept_height(shape, envelope.move_of(end[:3], end[3:]), x, y)
            inside = d_n >= 0
            np.testing.assert_allclose(d[n], d_n, atol=1e-15)
            np.testing.assert_allclose(z[n][inside], z_n[inside], atol=1e-14)


def test_row_interval_is_the_capsule():
    rng = np.random.default_rng(7)
    for _ in range(200):
        a, b = rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3)
        if rng.random() < 0.3:
            b[rng.integers(2)] = a[rng.integers(2)] * 0 + a[0] if rng.random() < 0.5 else a[1]
        move, R, x = envelope.move_of(a, b), rng.uniform(0.1, 0.8), rng.uniform(-1.5, 1.5)
        low, high = envelope.row_interval(move, R, np.array(x))
        y = np.linspace(-3, 3, 2001)
        span = b[:2] - a[:2]
        t = np.clip(((x - a[0]) * span[0] + (y - a[1]) * span[1]) / (span @ span), 0, 1)
        inside = np.hypot(x - a[0] - t * span[0], y - a[1] - t * span[1]) <= R
        np.testing.assert_array_equal((y >= low) & (y <= high), inside)


def test_covered_share_is_an_area():
    rng = np.random.default_rng(11)
    u, v = (np.arange(1000) + 0.5) / 1000 - 0.5, (np.arange(1000) + 0.5) / 1000 - 0.5
    for _ in range(30):
        dx, dy, angle, d = rng.uniform(0.5, 2), rng.uniform(0.5, 2), rng.uniform(0, 7), rng.uniform(-1, 1)
        n = np.cos(angle), np.sin(angle)
        expected = (u[:, None] * dx * n[0] + v[None, :] * dy * n[1] <= d).mean()
        share = envelope.covered_share(*(np.array(q) for q in (d, *n)), dx, dy)
        assert share == pytest.approx(expected, abs=2e-3)


def test_full_corner_is_a_ball_and_no_corner_is_flat():
    assert cutter_shape(Cutter("bull", 0.008, corner_radius=0.004)).kind == envelope.BALL
    assert cutter_shape(CUTTERS["flat"]).kind == envelope.FLAT
