"""Turns, places and circles of a plane, against the same in complex numbers."""

import cmath
import math

import pytest
from hypothesis import given, strategies as st

from robomill.toolpath.plane import axes, centre_by_radius, doubled_area, from_plane, polar, swept, through, turned

number = st.floats(-1e3, 1e3)
angle = st.floats(-20.0, 20.0)
place = st.builds(complex, number, number)


def pair(z: complex) -> tuple[float, float]:
    return z.real, z.imag


def near(found: tuple[float, float], expected: complex, size: float = 1e3) -> bool:
    return abs(complex(*found) - expected) <= 1e-13 * size + 1e-12


@given(place, angle, place)
def test_a_turn_is_a_product_with_a_number_on_the_unit_circle(z: complex, t: float, about: complex) -> None:
    assert near(turned(*pair(z), t, *pair(about)), about + z * cmath.exp(1j * t), 4e3)
    assert near(turned(*pair(z), t), z * cmath.exp(1j * t), 4e3)


@given(number, angle, place)
def test_a_polar_place_is_a_number_by_its_modulus_and_argument(r: float, t: float, about: complex) -> None:
    assert near(polar(r, t, *pair(about)), about + r * cmath.exp(1j * t), 4e3)
    assert near(polar(r, t), r * cmath.exp(1j * t), 4e3)


@given(place, st.floats(0.1, 1e3), angle, st.floats(0.3, 1.8), st.floats(0.3, 1.8))
def test_three_places_of_a_circle_give_its_centre(c: complex, r: float, t: float, one: float, two: float) -> None:
    places = [pair(c + cmath.rect(r, phi)) for phi in (t, t + one, t + one + two)]
    assert complex(*through(*places)) == pytest.approx(c, abs=1e-8 * (abs(c) + r))
    assert doubled_area(*places) > 0.0 > doubled_area(*places[::-1])


@given(place, place, place)
def test_twice_the_area_of_a_triangle_is_that_of_the_parallelogram(a: complex, b: complex, c: complex) -> None:
    expected = ((b - a).conjugate() * (c - a)).imag
    assert doubled_area(pair(a), pair(b), pair(c)) == pytest.approx(expected, abs=1e-8)


def test_places_on_a_line_span_no_area() -> None:
    assert doubled_area((1.0, 1.0), (2.0, 3.0), (4.0, 7.0)) == 0.0


@given(place, st.floats(0.1, 1e3), angle, st.floats(0.05, 3.1), st.sampled_from([1, -1]), st.booleans())
def test_a_radius_gives_the_centre_that_the_arc_was_drawn_about(
    c: complex, r: float, t: float, part: float, turn: int, long: bool
) -> None:
    sweep = turn * (2.0 * math.pi - part if long else part)
    start, end = (pair(c + cmath.rect(r, phi)) for phi in (t, t + sweep))
    found = centre_by_radius(start, end, -r if long else r, turn)
    assert complex(*found) == pytest.approx(c, abs=1e-6 * (abs(c) + r))
    if abs(c) < 100.0 * r:
        assert swept(start, end, found, turn) == pytest.approx(sweep, abs=1e-4)


@pytest.mark.parametrize("radius", [5.0, -5.0, 4.9, 0.0])
@pytest.mark.parametrize("turn", [1, -1])
def test_a_radius_that_just_reaches_or_does_not_puts_the_centre_in_the_middle(radius: float, turn: int) -> None:
    assert centre_by_radius((1.0, 2.0), (7.0, 10.0), radius, turn) == pytest.approx((4.0, 6.0), abs=1e-14)


@pytest.mark.parametrize("turn", [1, -1, 3, -2])
@pytest.mark.parametrize("angle", [1e-12, 0.3, 2.0, math.pi, 4.0, 6.2])
@pytest.mark.parametrize("begin", [-3.0, -0.2, 0.0, 1.5, 3.1])
def test_swept_is_the_angle_that_turns_the_start_onto_the_end(begin: float, angle: float, turn: int) -> None:
    centre, radius, sign = complex(2, -1), 1.7, math.copysign(1.0, turn)
    start, end = (centre + cmath.rect(radius, begin + sign * share) for share in (0.0, angle))
    total = swept(*((q.real, q.imag) for q in (start, end, centre)), turn)
    expected = 2 * math.pi if angle < 1e-8 else angle
    assert total == pytest.approx(sign * (expected + 2 * math.pi * (abs(turn) - 1)), abs=1e-9)


def test_a_full_turn_is_one_however_it_is_rounded() -> None:
    assert swept((1.0, 0.0), (1.0, 0.0), (0.0, 0.0), -1) == -2.0 * math.pi
    assert swept((1.0, 0.0), (1.0, 1e-5), (0.0, 0.0), 1, 1e-4) == 2.0 * math.pi
    assert swept((1.0, 0.0), (1.0, 1e-5), (0.0, 0.0), 1) == pytest.approx(1e-5)


@pytest.mark.parametrize(("plane", "letters"), [(17, "xyz"), (18, "zxy"), (19, "yzx")])
def test_the_axes_of_a_plane_are_in_their_turn(plane: int, letters: str) -> None:
    assert "".join("xyz"[axis] for axis in axes(plane)) == letters
    point = from_plane(plane, 1.0, 2.0, 3.0)
    assert tuple(point[axis] for axis in axes(plane)) == (1.0, 2.0, 3.0)
