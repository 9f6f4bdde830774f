"""Splines against Bernstein's polynomials and scipy's B-splines."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.special import comb

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret

START = np.array([1.0, -2.0])


def read(lines):
    program = interpret(f"G21 G90 F100\nG0 X{START[0]} Y{START[1]} Z3\n{lines}\nM2\n")
    return [program.end[program.line == i][:, :2] * 1e3 for i in range(3, program.line.max() + 1)]


def off(points, curve):
    """The farthest of the points from a fine polyline (m, 2)."""
    a, b = curve[:-1], curve[1:]
    d = b - a
    s = np.clip(np.einsum("kmi,mi->km", points[:, None] - a, d) / np.einsum("mi,mi->m", d, d), 0, 1)
    return np.linalg.norm(points[:, None] - (a + s[..., None] * d), axis=2).min(axis=1).max()


def bezier(points, m=4000):
    n = len(points) - 1
    t = np.linspace(0, 1, m)[:, None]
    return sum(comb(n, k) * t**k * (1 - t) ** (n - k) * np.asarray(p) for k, p in enumerate(points))


def test_cubic_and_the_smooth_one_after_it():
    """P Q is measured from the end; without I J the next one leaves as the last one came."""
    first, second = read("G5 X11 Y-2 I2 J6 P-3 Q5\nG5 X20 Y4 P1 Q-6")
    end = (11, -2)
    one = bezier([START, (3, 4), (8, 3), end])
    two = bezier([end, (14, -7), (21, -2), [20, 4]])
    for found, curve in ((first, one), (second, two)):
        assert off(found, curve) < 1e-5
        assert len(found) > 20
        assert np.linalg.norm(np.diff(found, axis=0), axis=1).max() < 2.5
        np.testing.assert_allclose(found[-1], curve[-1], atol=1e-9)


def test_quadratic():
    (found,) = read("G5.1 X9 Y1 I3 J7")
    curve = bezier([START, (4, 5), [9, 1]])
    assert off(found, curve) < 1e-5
    np.testing.assert_allclose(found[-1], [9, 1], atol=1e-9)


@pytest.mark.parametrize("order", [3, 4, 5])
@pytest.mark.parametrize("first_weight", [None, 2.5])
def test_nurbs_is_a_rational_b_spline(order, first_weight):
    """A first line with P alone weighs the start; L is the order."""
    weights = np.array([first_weight or 1.0, 1.0, 3.0, 0.5, 2.0, 1.0])
    points = np.array([START, [3, 4], [7, 5], [9, -3], [12, 0], [15, 2]])
    begin = f"G5.2 P{first_weight} L{order}\n" if first_weight else f"G5.2 L{order} "
    lines = "\n".join(f"X{x} Y{y} P{w}" for (x, y), w in zip(points[1:], weights[1:], strict=True))
    program = interpret(f"G21 G90 F100\nG0 X{START[0]} Y{START[1]} Z3\n{begin}{lines}\nG5.3\nM2\n")
    found = program.end[1:, :2] * 1e3
    n, degree = len(points), order - 1
    knots = np.concatenate([[0] * degree, np.arange(n - degree + 1), [n - degree] * degree]).astype(float)
    u = np.linspace(0, n - degree, 6000)
    homogeneous = BSpline(knots, np.column_stack([points * weights[:, None], weights]), degree)(u)
    curve = homogeneous[:, :2] / homogeneous[:, 2:]
    assert off(found, curve) < 2e-5
    np.testing.assert_allclose(found[-1], [15, 2], atol=1e-9)
    assert np.linalg.norm(np.diff(found, axis=0), axis=1).max() < 1.5


def test_after_a_nurbs_no_motion_is_in_force():
    with pytest.raises(GCodeError) as caught:
        interpret("F100\nG5.2 X1 Y3 P1\nX4 Y4 P1\nX8 Y0 P1\nG5.3\nX9\nM2\n")
    assert caught.value.line == 6


def test_the_order_of_a_nurbs_is_what_its_largest_l_says():
    """Three is what it is without a word; a later L3 does not lower it, as in the reference."""
    begin, more = "G5.2 X3 Y4 P1", "X7 Y5 P1\nX9 Y-3 P1\nX12 Y0 P1\nG5.3"
    plain, third, fourth, later = (
        interpret(f"G21 G90 F100\nG0 X1 Y-2\n{text}\nM2\n").end
        for text in (
            f"{begin}\n{more}",
            f"{begin} L3\n{more}",
            f"{begin} L4\n{more}",
            f"{begin} L4\n{more.replace('X9', 'L3 X9')}",
        )
    )
    np.testing.assert_array_equal(third, plain)
    np.testing.assert_array_equal(later, fourth)
    assert np.abs(fourth - plain).max() > 1e-4


@pytest.mark.parametrize("count", [7, 8, 9])
def test_a_nurbs_has_so_many_control_points_at_most_its_start_with_them(count, monkeypatch):
    monkeypatch.setattr("robomill.toolpath.gcode.splines.MAX_CONTROL_POINTS", 8)
    moves = "\n".join(f"G5.2 X{2 + k} Y{k % 2} P1" for k in range(count - 1))
    if count <= 8:
        (points,) = (p for p in read(f"{moves}\nG5.3") if len(p))
        np.testing.assert_allclose(points[-1], [count, (count - 2) % 2], atol=1e-9)
    else:
        with pytest.raises(GCodeError, match=r"^Line 10: a spline has more than 8 control points; split it\.$"):
            read(f"{moves}\nG5.3")


def test_a_curve_begins_where_the_tool_stands_whatever_weight_is_said_there():
    """A place of no weight would be none of the curve's."""
    more = "X7 Y5 P1\nX9 Y-3 P2\nX12 Y0 P1\nG5.3"
    plain, none = read(f"G5.2 P1 L3\n{more}"), read(f"G5.2 P0 L3\n{more}")
    np.testing.assert_allclose(np.concatenate(none), np.concatenate(plain), atol=1e-9)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("I5 J5 P-5 Q5", ""),
        ("P-5 Q5", ""),
        ("I5 J5 P-5", "G5 needs P and Q, its second control point"),
        ("I5 J5 Q5", "G5 needs P and Q, its second control point"),
        ("I5 P-5 Q5", "G5 needs both I and J, or neither"),
        ("J5 P-5 Q5", "G5 needs both I and J, or neither"),
    ],
)
def test_a_cubic_spline_has_its_control_points_whole(words: str, says: str) -> None:
    text = f"G21 G90 G17 F100\nG0 X0 Y0\nG5 X10 Y0 {words}\nM2\n"
    if not says:
        np.testing.assert_allclose(interpret(text).end[-1] * 1e3, [10, 0, 0], atol=1e-9)
        return
    with pytest.raises(GCodeError, match=f"^Line 3: {says}"):
        interpret(text)
