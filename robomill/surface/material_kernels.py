"""What is still material in the middle of a march, compiled: looked up in columns, and exact near every edge.

The columns of a height map know where material is to about a cell. They also keep which run of moves made each end of
each layer, so that near an edge a point is asked of those runs themselves: it is material if the stock held it and no
run's swept body does. Walls stand where they stand, not where the cells are.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robomill.arrays import FloatArray
from robomill.compiled import Axes, Out2, Out3, OutInt1, part
from robomill.surface.envelope_kernels import Move, Shape, move_between, nearest, swept_height
from robomill.surface.tilt_kernels import UPRIGHT, move_in_frame, tool_frame, vertical_line

Names2 = Annotated[NDArray[np.int32], Axes("int32", 2, written=True)]
Names3 = Annotated[NDArray[np.int32], Axes("int32", 3, written=True)]

AIR, SOLID, UNSURE = range(3)
SKIN = 1e-10  # m: thinner layers are rounding
NOBODY = -1  # made by no run: the stock's own surface


class Columns(NamedTuple):
    """Material over the cells of a grid, m: layers from the top down, and which run of moves made their ends.

    top, low (nx, ny, layers)  upper and lower ends; -inf and inf where there is no layer
    by, under                  the run that made either end, ``NOBODY`` for the stock itself
    beside (nx, ny)            the run whose side reaches furthest into the cell, even short of its centre
    lost (1,)                  how often a gap between layers was closed for want of room
    x0, y0, dx, dy             centre of cell [0, 0] and the size of a cell
    slack                      how far off the ends of layers around a place the end there may lie
    One layer, as every upright cutter leaves it in a block, has no ``low`` and ``under``: it ends at the bottom.
    """

    top: Out3
    low: Out3
    by: Names3
    under: Names3
    beside: Names2
    lost: OutInt1
    x0: float
    y0: float
    dx: float
    dy: float
    slack: float


class Runs(NamedTuple):
    """Straight runs of moves as far as they are cut: ends (r, 6) m, unit axes (r, 3), tools (r,) (rows of ``shapes``
    (t, 5), the numbers of ``Shape``) and how many runs are known by now, (1,)."""

    ends: Out2
    axes: Out2
    tool: OutInt1
    shapes: Out2
    known: OutInt1


class Block(NamedTuple):
    """Corners of the stock, m."""

    x_low: float
    y_low: float
    z_low: float
    x_high: float
    y_high: float
    z_high: float


class Mesh(NamedTuple):
    """Faces of a stock: triangles (t, 3, 3) m, none for a block; which of them lie over each square of a coarse grid
    from the lower corner on (``faces`` from ``first[b]`` to ``first[b + 1]``, columns fastest), and its size."""

    triangles: Out3
    first: OutInt1
    faces: OutInt1
    size: float


class World(NamedTuple):
    """The stock as it stands in the middle of a march."""

    columns: Columns
    runs: Runs
    block: Block
    mesh: Mesh


@part
def shape_of(runs: Runs, r: int) -> Shape:
    """The cutter of a run."""
    numbers = runs.shapes[runs.tool[r]]
    return Shape(int(numbers[0]), numbers[1], numbers[2], numbers[3], numbers[4])


@part
def seen_by(runs: Runs, r: int, x: float, y: float, z: float) -> tuple[Move, float, float, float]:
    """A run and a point of {W} as its tool sees them: the move, and the point's (x, y, height)."""
    k, ends = runs.axes[r], runs.ends[r]
    if math.hypot(k[0], k[1]) <= UPRIGHT:
        return move_between(ends[0], ends[1], ends[2], ends[3], ends[4], ends[5]), x, y, z
    frame = tool_frame(k[0], k[1], k[2])
    line = vertical_line(frame, x, y)
    return move_in_frame(frame, ends), line.X, line.Y + z * frame.sine, line.h + z * frame.cosine


@part
def height_of_run(runs: Runs, r: int, x: float, y: float, z: float) -> float:
    """Height of a point of {W} above what a run leaves there, along its tool's axis, m; -inf beside its track."""
    shape = shape_of(runs, r)
    move, px, py, h = seen_by(runs, r, x, y, z)
    ex, ey = nearest(move, px, py)
    if h <= move.az or ex * ex + ey * ey >= shape.R * (shape.R - 2.0 * SKIN):
        return -math.inf
    return h - swept_height(shape, move, px, py)


@part
def cell_of(columns: Columns, x: float, y: float) -> tuple[int, int]:
    """The cell that holds a point in plan; beyond the grid the nearest one."""
    i = math.floor((x - columns.x0) / columns.dx + 0.5)
    j = math.floor((y - columns.y0) / columns.dy + 0.5)
    return max(0, min(i, columns.top.shape[0] - 1)), max(0, min(j, columns.top.shape[1] - 1))


@part
def cells_around(columns: Columns, x: float, y: float) -> tuple[int, int, int, int]:
    """The four cells whose centres stand around a point in plan, as rows i, i_next and columns j, j_next."""
    i, j = math.floor((x - columns.x0) / columns.dx), math.floor((y - columns.y0) / columns.dy)
    rows, width = columns.top.shape[0] - 1, columns.top.shape[1] - 1
    return max(0, min(i, rows)), max(0, min(i + 1, rows)), max(0, min(j, width)), max(0, min(j + 1, width))


@part
def in_column(columns: Columns, i: int, j: int, z: float, slack: float) -> int:
    """Whether a height lies in material of a column, in air, or within ``slack`` of an end of a layer."""
    for layer in range(columns.top.shape[2]):
        if z > columns.top[i, j, layer] + slack:
            return AIR
        if z > columns.top[i, j, layer] - slack:
            return UNSURE
        if z > columns.low[i, j, layer] + slack:
            return SOLID
        if z > columns.low[i, j, layer] - slack:
            return UNSURE
    return AIR


@part
def looked_up(columns: Columns, cells: tuple[int, int, int, int], z: float) -> int:
    """What the cells around a point say of a height: ``SOLID`` or ``AIR`` where all agree, else ``UNSURE``."""
    i, a, j, b = cells
    slack = columns.slack
    if columns.top.shape[2] == 1:
        p, q, r, s = columns.top[i, j, 0], columns.top[i, b, 0], columns.top[a, j, 0], columns.top[a, b, 0]
        if z < min(min(p, q), min(r, s)) - slack:
            return SOLID
        return AIR if z > max(max(p, q), max(r, s)) + slack else UNSURE
    said = in_column(columns, i, j, z, slack)
    for n in range(1, 4):
        if said == UNSURE or in_column(columns, a if n > 1 else i, b if n % 2 else j, z, slack) != said:
            return UNSURE
    return said


@part
def named(columns: Columns, i: int, j: int, n: int) -> int:
    """The n-th run that a cell names: it beside, then those of the ends of its layers."""
    if n == 0:
        return int(columns.beside[i, j])
    layer = (n - 1) // 2
    if n % 2 == 1:
        return int(columns.by[i, j, layer])
    return int(columns.under[i, j, layer])


@part
def above_runs(
    columns: Columns, runs: Runs, cells: tuple[int, int, int, int], point: tuple[float, float, float], but: int
) -> float:
    """Height of a point (x, y, z) above the lowest of what the runs named by the cells around it leave there, m; > 0
    inside a swept body, -inf if none reaches the point in plan. ``but`` one run is not asked."""
    names, height = 2 if columns.top.shape[2] == 1 else 1 + 2 * columns.top.shape[2], -math.inf
    last = before = NOBODY
    for cell in range(4):
        i, j = cells[1] if cell > 1 else cells[0], cells[3] if cell % 2 else cells[2]
        for n in range(names):
            name = named(columns, i, j, n)
            if name in (NOBODY, last, before, but):
                continue
            before, last = last, name
            height = max(height, height_of_run(runs, name, point[0], point[1], point[2]))
    return height


@part
def in_stock(block: Block, mesh: Mesh, point: tuple[float, float, float]) -> bool:
    """Whether the stock held a point (x, y, z) m before the first cut: of a mesh, by the faces above the point."""
    x, y, z = point
    if x < block.x_low or x > block.x_high or y < block.y_low or y > block.y_high:
        return False
    if z < block.z_low or z > block.z_high:
        return False
    if len(mesh.triangles) == 0:
        return True
    columns = int((block.y_high - block.y_low) / mesh.size) + 1
    b = int((x - block.x_low) / mesh.size) * columns + int((y - block.y_low) / mesh.size)
    inside = False
    for n in range(mesh.first[b], mesh.first[b + 1]):
        if under_triangle(mesh.triangles[mesh.faces[n]], x, y, z):
            inside = not inside
    return inside


@part
def under_triangle(t: FloatArray, x: float, y: float, z: float) -> bool:
    """Whether the upward ray from a point meets a triangle (3, 3); an edge belongs to one of its two triangles."""
    crossings = 0
    for a in range(3):
        b = (a + 1) % 3
        if (t[a, 1] > y) != (t[b, 1] > y) and x < t[a, 0] + (y - t[a, 1]) / (t[b, 1] - t[a, 1]) * (t[b, 0] - t[a, 0]):
            crossings += 1
    if crossings != 1:
        return False
    ux, uy, uz = t[1, 0] - t[0, 0], t[1, 1] - t[0, 1], t[1, 2] - t[0, 2]
    vx, vy, vz = t[2, 0] - t[0, 0], t[2, 1] - t[0, 1], t[2, 2] - t[0, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    return nz != 0.0 and t[0, 2] - (nx * (x - t[0, 0]) + ny * (y - t[0, 1])) / nz > z


@part
def is_solid(world: World, point: tuple[float, float, float], run: int) -> bool:
    """Whether a point (x, y, z) m is still material; it is known to be outside what ``run`` has swept."""
    x, y, z = point
    block, columns = world.block, world.columns
    if x < block.x_low or x > block.x_high or y < block.y_low or y > block.y_high:
        return False
    if z < block.z_low or z > block.z_high:
        return False
    cells = cells_around(columns, x, y)
    said = looked_up(columns, cells, z)
    if said != UNSURE:
        return said == SOLID
    return in_stock(block, world.mesh, point) and above_runs(columns, world.runs, cells, point, run) <= SKIN


@part
def top_over(world: World, x: float, y: float) -> float:
    """Height of the material over a point in plan, m, for columns of one layer cut by upright tools; -inf outside."""
    block, columns = world.block, world.columns
    if x < block.x_low or x > block.x_high or y < block.y_low or y > block.y_high:
        return -math.inf
    cells = cells_around(columns, x, y)
    i, a, j, b = cells
    p, q, r, s = columns.top[i, j, 0], columns.top[i, b, 0], columns.top[a, j, 0], columns.top[a, b, 0]
    high = max(max(p, q), max(r, s))
    if high - min(min(p, q), min(r, s)) <= SKIN:
        return high
    return block.z_high - max(0.0, above_runs(columns, world.runs, cells, (x, y, block.z_high), NOBODY))
