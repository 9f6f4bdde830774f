"""Ribs and gaps of material along the rim of a cutter, compiled: looked for in the columns, from cell to cell.

What is engaged is measured at a few angles; what stands between two of them and is narrower shows in the columns that
the rim passes over, exactly where the side of a run passes through one.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import called, part
from robomill.cutting.profile_kernels import FLAT, Shape
from robomill.surface.material_kernels import NOBODY, World, top_over
from robomill.surface.step_kernels import Step
from robomill.surface.turn_kernels import COSINE, HALF, PHI, SINE, gap_end, jumps

PITCH = 0.7  # cells: so far apart ribs and gaps of material are looked for


class Walk(NamedTuple):
    """Steps along a circle about the axis of the cutter: where it is in cells (x, y), the ways from it along the feed
    and to its left as far as the circle is wide (cells), its height (m), and the angle of a step (rad; 0: no walk), its
    sine and cosine."""

    x: float
    y: float
    fx: float
    fy: float
    lx: float
    ly: float
    height: float
    pitch: float
    sine: float
    cosine: float


@part
def is_plain(world: World, step: Step) -> bool:
    """Whether the material ends but once over every place, and the tool stands upright in it."""
    return world.dexels.heights.shape[2] == 1 and step.kx == 0.0 and step.ky == 0.0


@part
def walk_on(world: World, shape: Shape, step: Step) -> Walk:
    """From cell to cell along the rim of an upright flat mill in one layer of material; none for others."""
    dexels, R, pitch = world.dexels, shape.R, 0.0
    if shape.kind == FLAT and step.z < world.bounds.z_high and is_plain(world, step):
        pitch = PITCH * min(dexels.dx, dexels.dy) / R
    return Walk(
        (step.x - dexels.x0) / dexels.dx + 0.5,
        (step.y - dexels.y0) / dexels.dy + 0.5,
        R * step.fx / dexels.dx,
        R * step.fy / dexels.dy,
        R * step.lx / dexels.dx,
        R * step.ly / dexels.dy,
        step.z,
        pitch,
        math.sin(pitch),
        math.cos(pitch),
    )


@part
def top_on(world: World, walk: Walk, sine: float, cosine: float) -> float:
    """How high above the circle material stands at an angle, m: by the column there, or exact where a side passes."""
    dexels = world.dexels
    x, y = walk.x + sine * walk.fx + cosine * walk.lx, walk.y + sine * walk.fy + cosine * walk.ly
    i, j = math.floor(x), math.floor(y)
    if i < 0 or j < 0 or i >= dexels.heights.shape[0] or j >= dexels.heights.shape[1]:
        return 0.0
    if dexels.names[i, j, 0] == NOBODY:
        return max(dexels.heights[i, j, 0] - walk.height, 0.0)
    top = top_over(world, dexels.x0 + (x - 0.5) * dexels.dx, dexels.y0 + (y - 0.5) * dexels.dy)
    return max(top - walk.height, 0.0)


@called
def next_change(
    world: World, walk: Walk, rows: FloatArray, since: tuple[int, int, int], gaps: int
) -> tuple[int, float]:
    """The next change along the rim: the gap, of ``gaps`` between the angles of rows, and the angle in it at which
    material stands higher or lower there than at the angles looked at about it. ``since``: the gap it is looked for
    from, the row to look on from, and that where the gap begins. Past the last gap if none."""
    gap, row, left = since
    low = top_on(world, walk, rows[left, SINE], rows[left, COSINE])
    while gap < gaps:
        right = gap_end(gap)
        phi, end, sine, cosine = rows[row, PHI], rows[right, PHI], rows[row, SINE], rows[row, COSINE]
        high = top_on(world, walk, rows[right, SINE], rows[right, COSINE])
        while phi + walk.pitch < end:
            phi += walk.pitch
            sine, cosine = sine * walk.cosine + cosine * walk.sine, cosine * walk.cosine - sine * walk.sine
            top = top_on(world, walk, sine, cosine)
            if jumps(top, low) and jumps(top, high):
                return gap, phi
        gap, row, low = gap + 1, right, high
        if gap == HALF and gap < gaps:  # where both half turns meet, the other one has a row of its own
            row += 1
            low = top_on(world, walk, rows[row, SINE], rows[row, COSINE])
    return gaps, 0.0
