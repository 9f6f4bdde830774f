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
from robomill.compiled import Axes, Out2, Out3, OutInt1, called, part
from robomill.cutting.profile_kernels import profile_within, shape_of
from robomill.surface.contact.relief_kernels import Relief, square_about, tops_about
from robomill.surface.envelope_kernels import Move, move_between, nearest, swept_height
from robomill.surface.tilt_kernels import move_in_frame, tool_frame, vertical_line

Names3 = Annotated[NDArray[np.int32], Axes("int32", 3, written=True)]

FAR = 1e-3  # m: how deep in material or air is counted, at most
SKIN = 1e-10  # m: thinner layers are rounding
NOBODY = 0  # made by no run: the stock's own surface; runs are numbered from 1


class Dexels(NamedTuple):
    """Material in columns over the cells of a grid, m (dexels: Van Hook 1986): layers from the top down, and which run
    of moves made their ends.

    heights (nx, ny, n)    upper and lower end of one layer after the other; -inf and inf where there is none. Of one
                           layer, as upright cutters leave it in a block, only the upper: it ends at the bottom
    names (nx, ny, 1 + n)  the run whose side reaches furthest into the cell, even short of its centre, then those that
                           made the ends; ``NOBODY`` for the stock itself
    lost (1,)              how often a gap between layers was closed for want of room
    x0, y0, dx, dy         centre of cell [0, 0] and the size of a cell
    slack                  how far off the ends of layers around a place the end there may lie
    """

    heights: Out3
    names: Names3
    lost: OutInt1
    x0: float
    y0: float
    dx: float
    dy: float
    slack: float


class Bounds(NamedTuple):
    """Corners of the stock, m."""

    x_low: float
    y_low: float
    z_low: float
    x_high: float
    y_high: float
    z_high: float


class Facets(NamedTuple):
    """Faces of a stock's mesh: triangles (t, 3, 3) m, none for a block; which of them lie over each square of a coarse
    grid from the lower corner on (``faces`` from ``first[b]`` to ``first[b + 1]``, columns fastest), and its size."""

    triangles: Out3
    first: OutInt1
    faces: OutInt1
    size: float


class World(NamedTuple):
    """The stock as it stands in the middle of a march.

    runs (1 + r, 21): after nobody's, straight runs of moves as far as they are cut: the five numbers of the tool's
    ``Shape``, ends (m), unit axis, and the seven of the ``Move`` as the tool sees it, once it is cut.
    """

    dexels: Dexels
    runs: Out2
    bounds: Bounds
    facets: Facets
    relief: Relief


SHAPE, ENDS, AXIS, MOVE, RUN = 0, 5, 11, 14, 21  # where in a run its parts begin


@part
def is_upright(run: FloatArray) -> bool:
    """Whether the tool of a run stands upright."""
    return bool(run[AXIS] == 0.0 and run[AXIS + 1] == 0.0)


@part
def see_move(run: FloatArray) -> Move:
    """The move of a run as its tool sees it, noted in the run."""
    ends = run[ENDS:AXIS]
    if is_upright(run):
        move = move_between(ends[0], ends[1], ends[2], ends[3], ends[4], ends[5])
    else:
        move = move_in_frame(tool_frame(run[AXIS], run[AXIS + 1], run[AXIS + 2]), ends)
    run[MOVE], run[MOVE + 1], run[MOVE + 2], run[MOVE + 3] = move.ax, move.ay, move.az, move.ux
    run[MOVE + 4], run[MOVE + 5], run[MOVE + 6] = move.uy, move.length, move.m
    return move


@part
def place_in_run(runs: FloatArray, r: int, x: float, y: float, z: float) -> tuple[float, float]:
    """A point of {W} as the tool of a run passes it, m: its height above what the run leaves there, along the axis, and
    how far it lies within the track; the height is only about where it lies beside the track or below it."""
    run = runs[r]
    move = Move(run[MOVE], run[MOVE + 1], run[MOVE + 2], run[MOVE + 3], run[MOVE + 4], run[MOVE + 5], run[MOVE + 6])
    if not is_upright(run):
        frame = tool_frame(run[AXIS], run[AXIS + 1], run[AXIS + 2])
        line = vertical_line(frame, x, y)
        x, y, z = line.X, line.Y + z * frame.sine, line.h + z * frame.cosine
    ex, ey = nearest(move, x, y)
    distance = math.sqrt(ex * ex + ey * ey)
    within = run[SHAPE + 1] - distance
    if within <= SKIN or z <= move.az:
        return z - move.az, within
    shape = shape_of(run)
    if move.m == 0.0:
        return z - move.az - profile_within(shape, ex * ex + ey * ey), within
    return z - swept_height(shape, move, x, y), within


@part
def height_of_run(runs: FloatArray, r: int, x: float, y: float, z: float) -> float:
    """Height of a point of {W} above what a run leaves there, along its tool's axis, m; -inf beside its track."""
    height, within = place_in_run(runs, r, x, y, z)
    return height if within > SKIN else -math.inf


@part
def beside(bounds: Bounds, x: float, y: float) -> bool:
    """Whether a point in plan lies beside the stock."""
    return x < bounds.x_low or x > bounds.x_high or y < bounds.y_low or y > bounds.y_high


@part
def cell_of(dexels: Dexels, x: float, y: float) -> tuple[int, int]:
    """The cell that holds a point in plan; beyond the grid the nearest one."""
    i = math.floor((x - dexels.x0) * (1.0 / dexels.dx) + 0.5)
    j = math.floor((y - dexels.y0) * (1.0 / dexels.dy) + 0.5)
    return max(0, min(i, dexels.heights.shape[0] - 1)), max(0, min(j, dexels.heights.shape[1] - 1))


@part
def cells_around(dexels: Dexels, x: float, y: float) -> tuple[int, int, int, int]:
    """The four cells whose centres stand around a point in plan, as rows i, i_next and columns j, j_next."""
    i, j = math.floor((x - dexels.x0) * (1.0 / dexels.dx)), math.floor((y - dexels.y0) * (1.0 / dexels.dy))
    rows, width = dexels.heights.shape[0] - 1, dexels.heights.shape[1] - 1
    return max(0, min(i, rows)), max(0, min(i + 1, rows)), max(0, min(j, width)), max(0, min(j + 1, width))


@part
def in_column(dexels: Dexels, i: int, j: int, z: float) -> float:
    """How deep in the material of a column a height is, m: the way to the nearest end of its layer, < 0 in air."""
    before, count = math.inf, dexels.heights.shape[2]
    if count == 1:
        return dexels.heights[i, j, 0] - z
    for n in range(count):
        end = dexels.heights[i, j, n]
        if z > end:
            deep = min(z - end, before - z)
            return deep if n % 2 == 1 else -deep
        before = end
    return before - z if count % 2 == 1 else z - before


@part
def lowest_and_highest(dexels: Dexels, cells: tuple[int, int, int, int]) -> tuple[float, float]:
    """The lowest and the highest of the tops of four cells, m."""
    i, a, j, b = cells
    tops = dexels.heights
    p, q, r, s = tops[i, j, 0], tops[i, b, 0], tops[a, j, 0], tops[a, b, 0]
    return min(min(p, q), min(r, s)), max(max(p, q), max(r, s))


@part
def looked_up(dexels: Dexels, cells: tuple[int, int, int, int], z: float) -> float:
    """How deep in the material the cells around a point have a height, m (``FAR`` at most), < 0 in air; 0 where they do
    not agree by more than their slack."""
    i, a, j, b = cells
    if dexels.heights.shape[2] == 1:
        low, high = lowest_and_highest(dexels, cells)
        if low - z > dexels.slack:
            return min(low - z, FAR)
        return max(high - z, -FAR) if z - high > dexels.slack else 0.0
    deep = in_column(dexels, i, j, z)
    sign = 1.0 if deep > 0.0 else -1.0
    deep = min(sign * deep, FAR)
    for n in range(1, 4):
        if deep <= dexels.slack:
            return 0.0
        deep = min(deep, sign * in_column(dexels, a if n > 1 else i, b if n % 2 else j, z))
    return sign * deep if deep > dexels.slack else 0.0


@part
def has_side(dexels: Dexels, cells: tuple[int, int, int, int]) -> bool:
    """Whether a run's side passes through one of four cells, so that material may end between their centres."""
    i, a, j, b = cells
    names = dexels.names
    here, there = max(names[i, j, 0], names[i, b, 0]), max(names[a, j, 0], names[a, b, 0])
    return max(here, there) != NOBODY


@called
def in_runs(
    names: Names3, runs: FloatArray, cells: tuple[int, int, int, int], point: tuple[float, float, float], but: int
) -> tuple[float, float]:
    """How high a point (x, y, z) is above the lowest of what the runs named by the cells around it leave there, and how
    deep it is in one of their bodies, up or to the side, m; < 0 outside of them, -inf if there are none, or none in
    whose track it lies. ``but`` one run is not asked."""
    high, deep, last, before = -math.inf, -math.inf, NOBODY, NOBODY
    for cell in range(4):
        i, j = cells[1] if cell > 1 else cells[0], cells[3] if cell % 2 else cells[2]
        for n in range(names.shape[2]):
            name = names[i, j, n]
            if name != NOBODY and name != last and name != before and name != but:
                before, last = last, name
                height, within = place_in_run(runs, name, point[0], point[1], point[2])
                deep = max(deep, min(height, within))
                if within > SKIN:
                    high = max(high, height)
    return high, deep


@part
def in_stock(bounds: Bounds, facets: Facets, point: tuple[float, float, float]) -> bool:
    """Whether the stock held a point (x, y, z) m before the first cut: of a mesh, by the faces above the point."""
    x, y, z = point
    if beside(bounds, x, y) or z < bounds.z_low or z > bounds.z_high:
        return False
    return len(facets.triangles) == 0 or in_mesh(bounds, facets, point)


@called
def in_mesh(bounds: Bounds, facets: Facets, point: tuple[float, float, float]) -> bool:
    """Whether a point (x, y, z) m within the bounds of a mesh is in it, by its faces above the point."""
    x, y, z = point
    across = int((bounds.y_high - bounds.y_low) / facets.size) + 1
    b = int((x - bounds.x_low) / facets.size) * across + int((y - bounds.y_low) / facets.size)
    inside = False
    for n in range(facets.first[b], facets.first[b + 1]):
        if under_triangle(facets.triangles[facets.faces[n]], x, y, z):
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
def standing(world: World, point: tuple[float, float, float], run: int) -> float:
    """How deep in the material a point (x, y, z) is, m: > 0 in it, < 0 in air; exact near where it ends, elsewhere
    about. The point is known to be outside what ``run`` has swept."""
    _, _, sides = square_about(world.relief, point[0], point[1])
    return standing_near(world, point, run, sides)


@part
def standing_near(world: World, point: tuple[float, float, float], run: int, sides: bool) -> float:
    """``standing`` where it is known whether the ``sides`` of runs may pass about the point."""
    x, y, z = point
    bounds, dexels = world.bounds, world.dexels
    within = min(min(x - bounds.x_low, bounds.x_high - x), min(y - bounds.y_low, bounds.y_high - y))
    within = min(min(within, FAR), min(z - bounds.z_low, bounds.z_high - z))
    if within < 0.0:
        return max(within, -FAR)
    cells = cells_around(dexels, x, y)
    near = sides and has_side(dexels, cells)
    deep = 0.0 if near else looked_up(dexels, cells, z)
    if deep == 0.0:
        deep = -dexels.slack
        if in_stock(bounds, world.facets, point):
            deep = min(2.0 * SKIN - in_runs(dexels.names, world.runs, cells, point, run)[1], FAR)
    return min(deep, within + SKIN)


@part
def top_over(world: World, x: float, y: float) -> float:
    """Height of the material over a point in plan, m, for columns of one layer cut by upright tools; -inf outside."""
    bounds, dexels = world.bounds, world.dexels
    if beside(bounds, x, y):
        return -math.inf
    low, high = tops_about(world.relief, x, y)
    if high - low <= SKIN:
        return high
    cells = cells_around(dexels, x, y)
    low, high = lowest_and_highest(dexels, cells)
    if high - low <= SKIN and not has_side(dexels, cells):
        return high
    height, _ = in_runs(dexels.names, world.runs, cells, (x, y, bounds.z_high), NOBODY)
    return bounds.z_high - max(0.0, height)
