"""The cutter's profile by its arc length, and what an edge along it adds up to, against quadrature."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from robomill.cutting.tool import Cutter
from robomill.surface.envelope_kernels import cutter_shape
from robomill.surface.step_kernels import (
    END,
    FLANK,
    NOSE,
    edge_sums,
    on_profile,
    piece_between,
    step_at,
    stretch_ends,
)

CUTTERS = {
    "flat": Cutter("flat", 8e-3),
    "ball": Cutter("ball", 8e-3),
    "bull": Cutter("bull", 8e-3, corner_radius=1.5e-3),
    "chamfer": Cutter("chamfer", 8e-3, tip_angle=np.radians(80.0), tip_diameter=1e-3),
}
REACH = 6e-3


def stretches(cutter):
    """(shape, stretch, from, to) of those that have a length."""
    shape = cutter_shape(cutter)
    for stretch in (END, NOSE, FLANK):
        a, b = stretch_ends(shape, stretch, REACH)
        if b > a:
            yield shape, stretch, a, b


@pytest.mark.parametrize("name", CUTTERS)
def test_the_profile_is_the_cutters_and_its_normal_stands_on_it(name):
    """Walked by its length: radius as the cutter says, each stretch where the last one ended, a normal across it."""
    cutter, at = CUTTERS[name], (0.0, 0.0)
    for shape, stretch, a, b in stretches(cutter):
        assert on_profile(shape, stretch, a)[:2] == pytest.approx(at, abs=1e-12)
        for s in np.linspace(a, b, 7)[1:-1]:
            r, t, sine, cosine = on_profile(shape, stretch, s)
            h = 1e-8
            along = (np.array(on_profile(shape, stretch, s + h)[:2]) - on_profile(shape, stretch, s - h)[:2]) / (2 * h)
            assert np.hypot(*along) == pytest.approx(1.0, abs=1e-6)
            assert (sine, cosine) == pytest.approx((along[1], along[0]), abs=1e-6)
            if stretch != END:
                assert r == pytest.approx(float(cutter.radius_at(t)), abs=1e-9)
        at = on_profile(shape, stretch, b)[:2]
    assert at == pytest.approx((cutter.radius, REACH))


@pytest.mark.parametrize("name", CUTTERS)
@pytest.mark.parametrize("reach", [-1e-3, 0.0, 0.4e-3, 1.5e-3, 3e-3, 4e-3, 9e-3])
def test_stretches_reach_as_high_as_they_are_asked(name, reach):
    shape = cutter_shape(CUTTERS[name])
    found = [(stretch, *stretch_ends(shape, stretch, reach)) for stretch in (NOSE, FLANK)]
    highest = max((on_profile(shape, stretch, b)[1] for stretch, a, b in found if b > a), default=0.0)
    assert highest == pytest.approx(max(reach, 0.0), abs=1e-12)


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
                _, _, sine, cosine = on_profile(shape, stretch, s)
                facing = faces[0] * sine - faces[1] * cosine
                return (facing if exponent == 1.0 else max(facing, 0.0) ** exponent), sine, cosine

            truth = [quad(lambda s, w=w: load(s)[0] * (1.0, *load(s)[1:])[w], *ends, epsabs=1e-14)[0] for w in range(3)]
            found = edge_sums(shape, piece_between(shape, stretch, *ends), faces, exponent)
            np.testing.assert_allclose(found, truth, rtol=2e-4, atol=1e-4 * abs(truth[0]))


def test_a_step_has_its_place_and_a_frame_on_the_axis():
    rng = np.random.default_rng(4)
    for _ in range(20):
        tip, k, v = rng.normal(size=3), rng.normal(size=3), rng.normal(size=3)
        k, v = k / np.linalg.norm(k), v / np.linalg.norm(v)
        step = step_at(tip, k, v, np.zeros(3), 5)
        feed, left, axis = np.array(step[3:6]), np.array(step[6:9]), np.array(step[9:12])
        np.testing.assert_allclose(step[:3], tip)
        np.testing.assert_allclose(axis, k)
        np.testing.assert_allclose(
            np.column_stack([feed, left, axis]).T @ np.column_stack([feed, left, axis]), np.eye(3), atol=1e-12
        )
        np.testing.assert_allclose(np.cross(feed, left), axis, atol=1e-12)
        np.testing.assert_allclose(step.across * feed + step.along * axis, v, atol=1e-12)
        assert step.across > 0.0
        assert step.run == 5


@pytest.mark.parametrize("k", [[0.0, 0, 1], [1.0, 0, 0], [0, 0.6, -0.8], [-0.96, 0.28, 0]])
def test_straight_along_the_axis_the_heading_stands_for_the_feed(k):
    k = np.array(k)
    heading = np.cross(k, [0.3, -0.5, 0.7])
    heading /= np.linalg.norm(heading)
    step = step_at(np.zeros(3), k, -k, heading, 0)
    assert (step.across, step.along) == pytest.approx((0.0, -1.0))
    frame = np.column_stack([step[3:6], step[6:9], k])
    np.testing.assert_allclose(step[3:6], heading, atol=1e-12)
    np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=1e-12)
    assert np.linalg.det(frame) == pytest.approx(1.0)
