"""Ribs and gaps of material along the rim of a cutter, compiled: looked for in the columns, from cell to cell.

What is engaged is measured at a few angles; what stands between two of them and is narrower shows in the columns that
the rim passes over, and in the sides that runs have noted in them even where they do not reach a cell's centre.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import called, part
from robomill.cutting.engaged import PANELS
from robomill.cutting.profile_kernels import FLAT, Shape
from robomill.surface.material_kernels import NOBODY, World, cell_of
from robomill.surface.step_kernels import Step

PITCH = 0.7  # cells: so far apart ribs and gaps of material are looked for
JUMP = 0.2  # of the longer one: neighbouring engaged lengths that differ by more than this are a jump
HALF = 3 * PANELS  # gaps between the angles looked at in a half turn
PHI, SINE, COSINE = range(3)  # of a row that is known of an angle: itself, its sine and cosine


class Walk(NamedTuple):
    """Steps along the rim of the cutter: its radius where the material ends (m), the angle of a step (rad), its sine
    and cosine."""

    radius: float
    pitch: float
    sine: float
    cosine: float


@part
def is_plain(world: World, step: Step) -> bool:
    """Whether the material ends but once over every place, and the tool stands upright in it."""
    return world.columns.heights.shape[2] == 1 and step.kx == 0.0 and step.ky == 0.0


@part
def jumps(a: float, b: float) -> bool:
    """Whether two engaged lengths at neighbouring angles differ by more than what is smooth."""
    return abs(a - b) > JUMP * max(a, b)


@part
def walk_on(world: World, shape: Shape, step: Step) -> Walk:
    """From cell to cell along the rim of an upright flat mill in one layer of material; none (radius 0) for others."""
    if shape.kind != FLAT or step.z >= world.block.z_high or not is_plain(world, step):
        return Walk(0.0, 0.0, 0.0, 1.0)
    pitch = PITCH * min(world.columns.dx, world.columns.dy) / shape.R
    return Walk(shape.R, pitch, math.sin(pitch), math.cos(pitch))


@part
def gap_end(gap: int) -> int:
    """The row at which a gap between the angles looked at ends; each half turn begins with a row of its own."""
    return gap + gap // HALF + 1


@part
def cell_on_rim(world: World, step: Step, radius: float, sine: float, cosine: float) -> tuple[float, int]:
    """How high above the tip the column at an angle of the rim stands (0 outside the stock), and whose side."""
    columns, block = world.columns, world.block
    x = step.x + radius * (sine * step.fx + cosine * step.lx)
    y = step.y + radius * (sine * step.fy + cosine * step.ly)
    if x < block.x_low or x > block.x_high or y < block.y_low or y > block.y_high:
        return 0.0, NOBODY
    i, j = cell_of(columns, x, y)
    return max(columns.heights[i, j, 0] - step.z, 0.0), columns.names[i, j, 0]


@called
def next_change(
    world: World, step: Step, walk: Walk, rows: FloatArray, since: tuple[int, int, int], gaps: int
) -> tuple[int, float]:
    """The next change along the rim: the gap, of ``gaps`` between the angles of rows, and the angle in it at which the
    column under the rim is higher or lower than at both its ends, or another side is noted than before. ``since``: the
    gap it is looked for from, the row to look on from, and that where the gap begins. Past the last gap if none."""
    gap, row, left = since
    top, noted = cell_on_rim(world, step, walk.radius, rows[row, SINE], rows[row, COSINE])
    low = top if left == row else cell_on_rim(world, step, walk.radius, rows[left, SINE], rows[left, COSINE])[0]
    while gap < gaps:
        right = gap_end(gap)
        phi, end, sine, cosine = rows[row, PHI], rows[right, PHI], rows[row, SINE], rows[row, COSINE]
        high, after = cell_on_rim(world, step, walk.radius, rows[right, SINE], rows[right, COSINE])
        while phi + walk.pitch < end:
            phi += walk.pitch
            sine, cosine = sine * walk.cosine + cosine * walk.sine, cosine * walk.cosine - sine * walk.sine
            top, name = cell_on_rim(world, step, walk.radius, sine, cosine)
            if (jumps(top, low) and jumps(top, high)) or name != noted:
                return gap, phi
        gap, row, low, noted = gap + 1, right, high, after
        if gap == HALF and gap < gaps:  # where both half turns meet, the other one has a row of its own
            row += 1
            low, noted = cell_on_rim(world, step, walk.radius, rows[row, SINE], rows[row, COSINE])
    return gaps, 0.0
