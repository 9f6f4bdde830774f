"""Lines beside a contour: distances and lengths against closed forms, every point against the distance to its line."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from robomill.errors import ToolpathError
from robomill.toolpath.contour import Contour
from robomill.toolpath.gcode import CHORD_ERROR
from robomill.toolpath.parallel import beside_line

R = 4e-3
TWICE = 2.5 * CHORD_ERROR  # chords of the line, and of what is beside it


def contour(shape, points, layer="0"):
    return Contour(layer, shape, np.array(points, dtype=float) * 1e-3)


SQUARE = contour("polygon", [(0, 0), (40, 0), (40, 20), (0, 20)])
CIRCLE = contour("circle", [(10, 10), (20, 10)])
ARC = contour("arc", [(10, 0), (0, 10), (-10, 0)])


def turns_left(line: Contour) -> bool:
    x, y = line.outline()[:-1].T
    return bool(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) > 0.0)


@pytest.mark.parametrize(
    ("line", "side", "length", "left"),
    [
        (SQUARE, "inside", 2 * (32 + 12), True),
        (SQUARE, "left", 2 * (32 + 12), True),
        (SQUARE, "outside", 2 * (40 + 20) + 2 * math.pi * 4, False),
        (SQUARE, "right", 2 * (40 + 20) + 2 * math.pi * 4, True),
        (CIRCLE, "inside", 2 * math.pi * 6, True),
        (CIRCLE, "outside", 2 * math.pi * 14, False),
        (CIRCLE, "right", 2 * math.pi * 14, True),
    ],
)
def test_closed_lines_have_the_length_of_their_formula_and_leave_the_line_on_the_right(line, side, length, left):
    (found,) = beside_line(line, side, R)
    assert found.length == pytest.approx(length * 1e-3, rel=2e-4)
    assert turns_left(found) == left, "inside counter-clockwise, outside clockwise: climb milling"


@pytest.mark.parametrize("side", ["inside", "outside", "left", "right"])
def test_a_circle_stays_about_its_centre(side):
    (found,) = beside_line(CIRCLE, side, R)
    reach = {"inside": 6, "left": 6}.get(side, 14) * 1e-3
    corners = found.outline() - 10e-3
    np.testing.assert_allclose(np.linalg.norm(corners, axis=1), reach, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(corners[1:] + corners[:-1], axis=1) / 2, reach, atol=1.01 * CHORD_ERROR)
    if found.shape == "circle":
        np.testing.assert_allclose(found.points, [[10e-3, 10e-3], [10e-3 + reach, 10e-3]], atol=1e-15)
    np.testing.assert_allclose(found.outline()[0], [10e-3 + reach, 10e-3], atol=1e-15)


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("centre", [0, 30 - 7j])
def test_an_arc_anywhere_is_moved_along_its_spokes(way, side, centre):
    """In complex numbers: each point moves by the radius, towards the centre where the arc turns to its side."""
    spokes = np.exp(1j * way * np.array([0.3, 1.1, 2.4]))
    points = centre + 10 * spokes
    (found,) = beside_line(contour("arc", np.column_stack([points.real, points.imag])), side, R)
    new = centre + (10 - 4 if (way > 0) == (side == "left") else 10 + 4) * spokes
    np.testing.assert_allclose(found.points @ [1e3, 1e3j], new, atol=1e-9)


def test_an_arc_of_three_points_on_a_line_is_moved_as_one():
    (found,) = beside_line(contour("arc", [(0, 0), (5, 0), (10, 0)]), "left", R)
    np.testing.assert_allclose(found.points * 1e3, [[0, 4], [10, 4]], atol=1e-9)
    assert found.shape == "line"


def test_a_bend_of_two_lines_is_three_points_inside_and_rounded_outside():
    bend = contour("polyline", [(0, 0), (20, 0), (20, 20)])
    (inside,), (outside,) = beside_line(bend, "left", R), beside_line(bend, "right", R)
    np.testing.assert_allclose(inside.points * 1e3, [[0, 4], [16, 4], [16, 20]], atol=1e-9)
    assert inside.shape == outside.shape == "polyline"
    assert outside.length == pytest.approx((40 + math.pi / 2 * 4) * 1e-3, rel=1e-4)
    np.testing.assert_allclose(outside.points[[0, -1]] * 1e3, [[0, -4], [24, 20]], atol=1e-9)


@pytest.mark.parametrize("radius", [1e-6, 1e-4, R, 0.3])
def test_round_corners_are_as_fine_as_other_chords(radius):
    """Chords about a corner are within the chord error of its radius; there are at least 8 a quarter."""
    (found,) = beside_line(SQUARE, "outside", radius)
    middles = 0.5 * (found.outline()[1:] + found.outline()[:-1])
    distance = shapely.distance(shapely.Polygon(SQUARE.points), shapely.points(middles))
    assert distance.min() > radius - 1.01 * CHORD_ERROR
    assert len(found.points) >= 4 * 8
    assert len(found.points) <= 4 * max(8, 1 + math.pi / 4 / math.sqrt(2 * CHORD_ERROR / radius) * 1.5) + 8


@pytest.mark.parametrize(("side", "outer", "inner"), [("outside", False, True), ("right", True, False)])
def test_a_mouth_that_closes_leaves_a_line_in_the_cavity(side, outer, inner):
    """Round a C whose mouth is narrower than the cutter: about it and in it, the material on the same hand."""
    c = [
        (0, 0),
        (60, 0),
        (60, 27),
        (50, 27),
        (50, 10),
        (10, 10),
        (10, 50),
        (50, 50),
        (50, 33),
        (60, 33),
        (60, 60),
        (0, 60),
    ]
    found = beside_line(contour("polygon", c), side, R)
    sizes = {shapely.Polygon(each.points).area * 1e6: turns_left(each) for each in found}
    assert len(sizes) == 2
    assert sizes[max(sizes)] == outer
    assert sizes[min(sizes)] == inner
    bulge = 2 * (4 * 3 - (1.5 * math.sqrt(7) + 8 * math.asin(3 / 4)))  # into the mouth, about its two corners
    assert min(sizes) == pytest.approx(32 * 32 + bulge, abs=0.02)


@pytest.mark.parametrize("start", range(4))
@pytest.mark.parametrize("side", ["inside", "outside"])
def test_a_closed_line_begins_beside_where_the_drawn_one_does(start, side):
    corners = [(0, 0), (40, 0), (40, 20), (0, 20)]
    (found,) = beside_line(contour("polygon", corners[start:] + corners[:start]), side, R)
    distance = np.linalg.norm(found.points * 1e3 - corners[start], axis=1)
    assert distance[0] == pytest.approx(distance.min())
    assert len({tuple(each) for each in np.round(found.points, 9).tolist()}) == len(found.points)


@pytest.mark.parametrize(("side", "radius"), [("left", 6), ("right", 14)])
def test_an_arc_keeps_its_centre(side, radius):
    (found,) = beside_line(ARC, side, R)
    assert found.shape == "arc"
    np.testing.assert_allclose(np.hypot(*found.points.T), radius * 1e-3, atol=1e-12)
    assert found.length == pytest.approx(math.pi * radius * 1e-3, rel=1e-4)


@pytest.mark.parametrize("side", ["left", "right"])
def test_every_point_beside_an_open_curve_is_a_radius_from_it_and_on_its_side(side):
    x = np.linspace(0.0, 100.0, 4001)
    wave = contour("polyline", np.column_stack([x, 5.0 * np.sin(x / 8.0)]))
    (found,) = beside_line(wave, side, R)
    curve = shapely.LineString(wave.points)
    corners = found.outline()
    for points in (corners, 0.5 * (corners[1:] + corners[:-1])):
        distance = shapely.distance(curve, shapely.points(points))
        assert np.abs(distance - R).max() < TWICE
    assert found.points[0][0] < found.points[-1][0], "it runs as the line does"
    near = wave.points[np.argmin(np.linalg.norm(wave.points - found.points[len(found.points) // 2], axis=1))]
    above = found.points[len(found.points) // 2][1] > near[1]
    assert above == (side == "left")


def test_a_dumbbell_falls_apart_where_the_cutter_does_not_fit():
    shape = [(0, 0), (20, 0), (20, 7), (30, 7), (30, 0), (50, 0), (50, 20), (30, 20), (30, 13), (20, 13), (20, 20)]
    found = beside_line(contour("polygon", [*shape, (0, 20)]), "inside", R)
    assert len(found) == 2
    round_the_neck = 2 * 4 * math.asin(3 / 4)  # about its two corners, in the place of 6 mm straight on
    for each in found:
        assert each.length == pytest.approx((4 * 12 - 6 + round_the_neck) * 1e-3, rel=1e-4)


@pytest.mark.parametrize(
    ("line", "side", "radius", "said"),
    [
        (SQUARE, "inside", 10.1e-3, "a cutter of 20.20 mm does not fit beside the closed line at 0.00, 0.00 mm"),
        (CIRCLE, "inside", 10e-3, "a cutter of 20.00 mm does not fit"),
        (ARC, "left", 10e-3, "a cutter of 20.00 mm does not fit beside the open line"),
        (contour("line", [(0, 0), (9, 0)], "cut"), "inside", R, "Layer cut: the open line at 0.00, 0.00 mm has no ins"),
        (contour("polygon", [(0, 0), (9, 9), (9, 0), (0, 9)]), "inside", R, "crosses or touches itself"),
    ],
)
def test_what_cannot_be_is_refused_with_its_place(line, side, radius, said):
    with pytest.raises(ToolpathError) as refused:
        beside_line(line, side, radius)
    assert said in str(refused.value)


@pytest.mark.parametrize("away", [1e-3, 2e-3, 9e-3])
def test_round_a_corner_no_chord_is_off_by_more_than_is_allowed_and_one_fewer_would_be(away):
    """A quarter turn in n chords, each off by r (1 - cos(pi / 4 n)) in its middle."""
    (found,) = beside_line(contour("polyline", [(0, 0), (20, 0), (20, 20)]), "right", away)
    spokes = found.outline() - [20e-3, 0.0]
    middles = np.linalg.norm(spokes[1:] + spokes[:-1], axis=1) / 2
    off = away - middles[middles < away]
    assert off.max() <= CHORD_ERROR < away * (1 - math.cos(math.pi / 4 / (len(off) - 1)))
