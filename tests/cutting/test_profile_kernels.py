"""The cutter's profile against its closed forms, its own slope, and quadrature of what an edge along it adds up to."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from robomill.cutting.profile_kernels import (
    BALL,
    END,
    FLANK,
    FLAT,
    NOSE,
    beside_place,
    contact_lag,
    edge_sums,
    facing_part,
    heights,
    on_profile,
    profile,
    profile_within,
    radii,
    radius_at,
    stretch_ends,
    upright_part,
    valley,
)
from robomill.cutting.tool import Cutter

CUTTERS = {
    "flat": Cutter("flat", 8e-3),
    "ball": Cutter("ball", 8e-3),
    "bull": Cutter("bull", 8e-3, corner_radius=1.5e-3),
    "chamfer": Cutter("chamfer", 8e-3, tip_angle=np.radians(80.0), tip_diameter=1e-3),
}
REACH = 6e-3


def height(kind, r):
    """Of the four, by hand: a plane, a circle, a circle beside a plane, a cone beside a plane."""
    if kind == "flat":
        return 0.0
    if kind == "ball":
        return 4e-3 - math.sqrt(16e-6 - r * r)
    if kind == "bull":
        return 1.5e-3 - math.sqrt(2.25e-6 - max(r - 2.5e-3, 0.0) ** 2)
    return max(r - 0.5e-3, 0.0) / math.tan(math.radians(40.0))


@pytest.mark.parametrize("kind", CUTTERS)
def test_profile_is_its_closed_form_and_radius_at_its_inverse(kind):
    cutter = CUTTERS[kind]
    shape = cutter.solid
    r = np.linspace(0.0, cutter.radius, 41)
    truth = np.array([height(kind, q) for q in r])
    np.testing.assert_allclose([profile(shape, q) for q in r], truth, atol=1e-15)
    np.testing.assert_allclose([profile_within(shape, q * q) for q in r], truth, atol=1e-10)
    for up in (1e-5, 4e-4, 1.4e-3, 2.9e-3, 5e-3):
        found = radius_at(shape, up)
        reached = r[truth <= up].max()
        assert reached <= found + 1e-12 <= reached + r[1] + 1e-12
        if found < cutter.radius:
            assert height(kind, found) == pytest.approx(up, abs=1e-12)


def test_full_corner_is_a_ball_and_no_corner_is_flat():
    assert Cutter("bull", 8e-3, corner_radius=4e-3).solid.kind == BALL
    assert CUTTERS["flat"].solid.kind == FLAT


@pytest.mark.parametrize("kind", CUTTERS)
def test_many_places_are_one_by_one(kind):
    """Compiled and as Python, in whatever shape the places come; beyond the cutter there is none."""
    cutter, r = CUTTERS[kind], np.linspace(0.0, 4e-3, 100).reshape(4, 25)
    for call in (heights, heights.plain):
        found = np.empty(100)
        call(r.ravel(), cutter.solid, found)
        np.testing.assert_allclose(found, [height(kind, q) for q in r.flat], atol=1e-15)
    np.testing.assert_array_equal(cutter.profile(r.T), cutter.profile(r).T)
    up = np.linspace(1e-6, 6e-3, 100)
    for call in (radii, radii.plain):
        found = np.empty(100)
        call(up, cutter.solid, found)
        np.testing.assert_array_equal(found, cutter.radius_at(up))
    assert np.isinf(cutter.profile([-1e-9, 4.1e-3, np.nan])).all()
    assert np.isnan(cutter.radius_at([-1e-9, np.nan])).all()


@pytest.mark.parametrize("kind", CUTTERS)
def test_the_normal_is_upright_by_the_slope_of_the_profile(kind):
    shape, h = CUTTERS[kind].solid, 1e-8
    for r in (0.0, 0.4e-3, 1.5e-3, 2.6e-3, 3.2e-3, 3.9e-3):
        slope = (height(kind, r + h) - height(kind, max(r - h, 0.0))) / (2 * h if r else h)
        assert upright_part(shape, r) == pytest.approx(1.0 / math.hypot(1.0, slope), abs=1e-5)
    assert upright_part(shape, CUTTERS[kind].flat_radius) == 1.0
    if CUTTERS[kind].corner_radius:
        assert upright_part(shape, 4e-3) == 0.0


def stretches(cutter):
    """(shape, stretch, from, to) of those that have a length."""
    shape = cutter.solid
    for stretch in (END, NOSE, FLANK):
        a, b = stretch_ends(shape, stretch, REACH)
        if b > a:
            yield shape, stretch, a, b


@pytest.mark.parametrize("name", CUTTERS)
def test_the_profile_is_the_cutters_and_its_normal_stands_on_it(name):
    """Walked by its length: radius as the cutter says, each stretch where the last one ended, a normal across it."""
    cutter, at = CUTTERS[name], (0.0, 0.0)
    for shape, stretch, a, b in stretches(cutter):
        assert on_profile(shape, stretch, a)[1:3] == pytest.approx(at, abs=1e-12)
        for s in np.linspace(a, b, 7)[1:-1]:
            along, r, t, sine, cosine = on_profile(shape, stretch, s)
            assert along == s
            h = 1e-8
            before, after = (np.array(on_profile(shape, stretch, s + q)[1:3]) for q in (-h, h))
            along = (after - before) / (2 * h)
            assert np.hypot(*along) == pytest.approx(1.0, abs=1e-6)
            assert (sine, cosine) == pytest.approx((along[1], along[0]), abs=1e-6)
            if stretch != END:
                assert r == pytest.approx(float(cutter.radius_at(t)), abs=1e-9)
        at = on_profile(shape, stretch, b)[1:3]
    assert at == pytest.approx((cutter.radius, REACH))


@pytest.mark.parametrize("name", CUTTERS)
@pytest.mark.parametrize("reach", [-1e-3, 0.0, 0.4e-3, 1.5e-3, 3e-3, 4e-3, 9e-3])
def test_stretches_reach_as_high_as_they_are_asked(name, reach):
    shape = CUTTERS[name].solid
    found = [(stretch, *stretch_ends(shape, stretch, reach)) for stretch in (NOSE, FLANK)]
    highest = max((on_profile(shape, stretch, b).height for stretch, a, b in found if b > a), default=0.0)
    assert highest == pytest.approx(max(reach, 0.0), abs=1e-12)


@pytest.mark.parametrize("name", CUTTERS)
def test_a_place_beside_another_is_the_place_itself(name):
    rng = np.random.default_rng(6)
    for shape, stretch, a, b in stretches(CUTTERS[name]):
        for s in rng.uniform(a, b, 30):
            near = np.clip(s + rng.uniform(-0.1, 0.1) * (shape.rc or 1e-3), a, b)
            found = beside_place(shape, stretch, on_profile(shape, stretch, near), s)
            np.testing.assert_allclose(found, on_profile(shape, stretch, s), rtol=0.0, atol=1e-15)


@pytest.mark.parametrize("name", CUTTERS)
@pytest.mark.parametrize("turn", [0.0, 0.3, -0.3, 1.2, -1.2, -1.9, 2.0, -3.0])
def test_the_part_that_faces_the_feed_is_where_its_normal_does(name, turn):
    """On the way up, on the level and down, ahead and behind; every place asked for itself, but near an end."""
    faces = (math.cos(turn), math.sin(turn))
    for shape, stretch, a, b in stretches(CUTTERS[name]):
        low, high = facing_part(shape, stretch, faces)
        for s in np.linspace(a, b, 41):
            _, _, _, sine, cosine = on_profile(shape, stretch, s)
            facing = faces[0] * sine - faces[1] * cosine
            if abs(facing) > 1e-9:
                assert (low < s < high) == (facing > 0.0)


@pytest.mark.parametrize("exponent", [0.0, 1.0, 0.75, 0.6])
@pytest.mark.parametrize("name", CUTTERS)
def test_an_edge_adds_up_to_its_integral(name, exponent):
    """Chips of any slope of the feed, over any part of a stretch; a place that faces away cuts nothing (exponents)."""
    rng = np.random.default_rng(3)
    for shape, stretch, a, b in stretches(CUTTERS[name]):
        for _ in range(5):
            ends = tuple(np.sort(rng.uniform(a, b, 2)))
            faces = (rng.uniform(0.3, 1.0), rng.uniform(-0.9, 0.05))

            def load(s, faces=faces, stretch=stretch, shape=shape):
                _, _, _, sine, cosine = on_profile(shape, stretch, s)
                facing = faces[0] * sine - faces[1] * cosine
                return (facing if exponent == 1.0 else max(facing, 0.0) ** exponent), sine, cosine

            truth = [quad(lambda s, w=w: load(s)[0] * (1.0, *load(s)[1:])[w], *ends, epsabs=1e-14)[0] for w in range(3)]
            found = edge_sums(shape, tuple(on_profile(shape, stretch, s) for s in ends), faces, exponent)
            rtol = 1e-9 if exponent in (0.0, 1.0) else 2e-4  # in closed form, or by Gauss' rule
            np.testing.assert_allclose(found, truth, rtol=rtol, atol=0.5 * rtol * abs(truth[0]))


@pytest.mark.parametrize("name", CUTTERS)
@pytest.mark.parametrize("share", [0.0, 0.3, 0.8, 0.99])
@pytest.mark.parametrize("rise", [0.0, 0.02, 0.4, 1.0, 1.3, 4.0])
def test_the_cutter_cuts_lowest_where_a_search_along_its_way_finds_it(name, share, rise):
    """A point beside a rising move: w behind it the tip is rise * w lower, and the profile is asked at its distance."""
    shape = CUTTERS[name].solid
    v = share * shape.R
    w = np.linspace(0.0, math.sqrt(shape.R**2 - v * v), 2_001)
    height = np.array([profile(shape, min(math.hypot(a, v), shape.R)) for a in w]) - rise * w
    lag = contact_lag(shape, rise, v * v)
    assert 0.0 <= lag <= w[-1] + 1e-12
    assert profile(shape, min(math.hypot(lag, v), shape.R)) - rise * lag <= height.min() + 1e-9

    def above(a):
        return profile(shape, min(math.hypot(a, v), shape.R)) - rise * a

    lowest = minimize_scalar(above, bounds=(0.0, w[-1]), method="bounded", options={"xatol": 1e-13}).fun
    assert above(lag) <= min(lowest, above(0.0), above(w[-1])) + 1e-13
    if rise == 0.0:
        assert lag == 0.0


@pytest.mark.parametrize("size", [1e-5, 1e-4, 3e-4])
@pytest.mark.parametrize("name", CUTTERS)
def test_a_valley_between_two_places_is_no_deeper_than_it_is_told(name, size):
    """Between two noses side by side the part stands as high as the profile halfway; a flat end leaves nothing, a
    pointed cone what its flanks do, and a round nose much less than the places are apart."""
    shape = CUTTERS[name].solid
    told = valley(shape, size)
    for apart in np.linspace(0.0, size, 7):
        assert height(name, 0.5 * apart) <= told + 1e-18
    assert (told == 0.0) == (name == "flat")
    assert name == "chamfer" or told <= 0.25 * size
    pointed = Cutter("chamfer", 8e-3, tip_angle=np.radians(80.0)).solid
    assert valley(pointed, size) == pytest.approx(0.5 * size / math.tan(math.radians(40.0)))
