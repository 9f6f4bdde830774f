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
