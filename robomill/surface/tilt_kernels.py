"""What a cutter takes away whose axis leans: upright in its own frame, where the vertical lines of {W} lean.

Compiled, one vertical line at a time.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import In2, Out2, called, kernel, part
from robomill.cutting.profile_kernels import Shape
from robomill.surface.envelope_kernels import Move, move_between, row_interval, swept_height

UPRIGHT = 1e-9  # an axis that leans less than this (sine) is upright
GOLDEN = 0.6180339887498949
SEARCHES, BISECTIONS = 64, 48


class ToolFrame(NamedTuple):
    """The tool's own frame for a leaning axis k, in {W}: e1 is level, e2 = k x e1 points uphill across the tool.

    sine, cosine  of the angle between k and the vertical: the parts of e2 and of k along z_W (e1 has none).
    """

    e1x: float
    e1y: float
    e2x: float
    e2y: float
    kx: float
    ky: float
    sine: float
    cosine: float


class TiltedMoves(NamedTuple):
    """Moves of a leaning cutter: ends (n, 6) m, one axis each (n, 3), and their ``plan_boxes`` (n, 4) m."""

    ends: Out2  # read only, but the compiler tells arrays inside a tuple apart by who may write them
    axes: Out2
    boxes: Out2


class Line(NamedTuple):
    """A vertical line in the tool's frame: the point (X, Y + z sine, h + z cosine) at height z, m."""

    X: float
    Y: float
    h: float


@part
def tool_frame(kx: float, ky: float, kz: float) -> ToolFrame:
    """Frame of a tool axis that is not vertical."""
    sine = math.hypot(kx, ky)
    e1x, e1y = -ky / sine, kx / sine
    return ToolFrame(e1x, e1y, -kz * e1y, kz * e1x, kx, ky, sine, kz)


@part
def vertical_line(frame: ToolFrame, x: float, y: float) -> Line:
    """The vertical line at (x, y) of {W}, in the tool's frame."""
    return Line(x * frame.e1x + y * frame.e1y, x * frame.e2x + y * frame.e2y, x * frame.kx + y * frame.ky)


@part
def move_in_frame(frame: ToolFrame, ends: FloatArray) -> Move:
    """The move ``ends`` (6,) m of {W}, in the tool's frame."""
    a, b = vertical_line(frame, ends[0], ends[1]), vertical_line(frame, ends[3], ends[4])
    sine, cosine = frame.sine, frame.cosine
    return move_between(
        a.X, a.Y + ends[2] * sine, a.h + ends[2] * cosine, b.X, b.Y + ends[5] * sine, b.h + ends[5] * cosine
    )


@part
def plan_box(R: float, ends: FloatArray, k: FloatArray, top: float) -> tuple[float, float, float, float]:
    """Plan limits (x low, x high, y low, y high) of what a cutter leaning along k (3,) meets below ``top`` on a move
    ``ends`` (6,), m.

    From its tip the cutter reaches up along its axis until its low side is above ``top``.
    """
    up = max(0.0, top - min(ends[2], ends[5]) + R * math.hypot(k[0], k[1])) / k[2]
    x, y = up * k[0], up * k[1]
    x_low, x_high = min(ends[0], ends[3]) + min(0.0, x) - R, max(ends[0], ends[3]) + max(0.0, x) + R
    y_low, y_high = min(ends[1], ends[4]) + min(0.0, y) - R, max(ends[1], ends[4]) + max(0.0, y) + R
    return x_low, x_high, y_low, y_high


@kernel
def plan_boxes(R: float, ends: In2, axes: In2, top: float, boxes: Out2) -> None:
    """Those of moves ``ends`` (n, 6) m and axes (n, 3), into ``boxes`` (n, 4) m."""
    for n in range(len(ends)):
        boxes[n, 0], boxes[n, 1], boxes[n, 2], boxes[n, 3] = plan_box(R, ends[n], axes[n], top)


@called
def hull_gap(shape: Shape, move: Move, frame: ToolFrame, line: Line, z: float) -> float:
    """Height of the swept surface over a point of a vertical line, along the tool axis; <= 0 inside the body."""
    return swept_height(shape, move, line.X, line.Y + z * frame.sine) - (line.h + z * frame.cosine)


@part
def tilted_interval(shape: Shape, move: Move, frame: ToolFrame, line: Line, ceiling: float) -> tuple[float, float]:
    """Heights (low, high) m of a vertical line inside the body swept by a tilted cutter, not above ``ceiling``.

    ``move`` is in the tool's frame. Along the line the gap to the swept surface is convex, so the line is inside
    between two roots. low > high where it misses the body.
    """
    low, high = row_interval(move, shape.R, line.X)
    low, high = (low - line.Y) / frame.sine, min((high - line.Y) / frame.sine, ceiling)
    if low >= high:
        return math.inf, -math.inf
    inside = point_inside(shape, move, frame, line, low, high)
    if inside == math.inf:
        return math.inf, -math.inf
    return surface_between(shape, move, frame, line, low, inside), surface_between(
        shape, move, frame, line, high, inside
    )


@part
def point_inside(shape: Shape, move: Move, frame: ToolFrame, line: Line, low: float, high: float) -> float:
    """A height in [low, high] where the convex gap is not positive, by golden section; inf if there is none."""
    if hull_gap(shape, move, frame, line, low) <= 0.0:
        return low
    if hull_gap(shape, move, frame, line, high) <= 0.0:
        return high
    a, b = low, high
    c, d = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
    gap_c, gap_d = hull_gap(shape, move, frame, line, c), hull_gap(shape, move, frame, line, d)
    for _ in range(SEARCHES):
        if gap_c <= 0.0:
            return c
        if gap_d <= 0.0:
            return d
        if gap_c < gap_d:
            b, d, gap_d = d, c, gap_c
            c = b - GOLDEN * (b - a)
            gap_c = hull_gap(shape, move, frame, line, c)
        else:
            a, c, gap_c = c, d, gap_d
            d = a + GOLDEN * (b - a)
            gap_d = hull_gap(shape, move, frame, line, d)
    return math.inf


@part
def surface_between(shape: Shape, move: Move, frame: ToolFrame, line: Line, end: float, inside: float) -> float:
    """Height where the line from ``inside`` towards ``end`` leaves the body; ``end`` if it does not."""
    if hull_gap(shape, move, frame, line, end) <= 0.0:
        return end
    for _ in range(BISECTIONS):
        middle = 0.5 * (end + inside)
        if hull_gap(shape, move, frame, line, middle) > 0.0:
            end = middle
        else:
            inside = middle
    return inside
