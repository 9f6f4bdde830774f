"""How a surface came to be: which cells each step of a path lowered, for pictures of the cut in progress."""

from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.cutting.tooling import Tooling
from robomill.progress import checkpoint
from robomill.surface.passes import Passes, at_one_axis
from robomill.surface.zmap import ZMap


@dataclass(frozen=True, eq=False)
class History:
    """Every lowering of a cell, in the order of the path: flat index ``cell`` (e,), ``height`` (e,) m after it, and the
    ``step`` (e,) of the path, from p[step - 1] to p[step]. A cell is told again once it is ``least`` m lower."""

    cell: IntArray
    height: FloatArray
    step: IntArray
    least: float


def history(
    surface: ZMap, tooling: Tooling, p: FloatArray, k: FloatArray, removes: BoolArray, most: int = 1_000_000
) -> History:
    """The way from the stock of ``surface`` to it, over its grid: p (m, 3) m tool tip, k (m, 3) tool axis, ``removes``
    (m,) steps that cut, whose ends are finite.

    At most ``most`` lowerings: where there are more, smaller ones are not told. Voids that a leaning cutter leaves
    below material are not told either; ``surface`` itself is the end.
    """
    depth = float(np.max(surface.z_stock - surface.z, initial=0.0))
    if depth <= 0.0 or not removes.any():
        return History(np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0, dtype=np.int64), 0.0)
    least = 0.01 * depth
    while True:
        found = _lowered(surface, tooling, (p, k, removes), least, most)
        if found is not None:
            return History(*found, least)
        least *= 2.0


def _lowered(
    surface: ZMap, tooling: Tooling, path: tuple[FloatArray, FloatArray, BoolArray], least: float, most: int
) -> tuple[IntArray, FloatArray, IntArray] | None:
    """Cells, heights and steps; None where there are more than ``most``."""
    from robomill.surface.cells_kernels import Heights
    from robomill.surface.history_kernels import Lowerings, lower_in_turn
    from robomill.surface.tilt_kernels import TiltedMoves, plan_boxes

    p, k, removes = path
    z = np.empty(surface.z.shape)
    z[...] = surface.z_stock
    top = float(z.max())
    tile = Heights(z, float(surface.x[0]), float(surface.y[0]), surface.dx, surface.dy)
    found = Lowerings(np.empty(most, dtype=np.int64), np.empty(most), np.empty(most, dtype=np.int64), np.zeros(1, int))
    steps = np.flatnonzero(removes)
    made = tooling.of_step[steps]
    for run in np.split(steps, np.flatnonzero(np.diff(made)) + 1):
        cutter = tooling.at(int(run[0]))
        moves = Passes(np.hstack([p[run - 1], p[run]]), np.hstack([k[run - 1], k[run]]))
        ends, axes, owner = at_one_axis(moves, cutter.radius, max(surface.dx, surface.dy))
        ends, axes = np.ascontiguousarray(ends), np.ascontiguousarray(axes)
        boxes = np.empty((len(ends), 4))
        plan_boxes(cutter.radius, ends, axes, top, boxes)
        checkpoint()
        lower_in_turn(cutter.solid, TiltedMoves(ends, axes, boxes), run[owner], tile, least, found)
        if found.told[0] > most:
            return None
    count = int(found.told[0])
    return found.cell[:count].copy(), np.maximum(found.height[:count], surface.bottom), found.move[:count].copy()
