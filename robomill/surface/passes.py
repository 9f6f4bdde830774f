"""The feed moves of a path as the surface takes them: ends and tool axes, joined where they go straight on, divided
where the axis turns."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, IntArray, as_floats, next_true
from robomill.errors import SurfaceError
from robomill.vectors import angle_between

STRAIGHT = 1e-11  # rad: a divided line bends less by rounding
SMALLEST_RISE = 0.1
STRAY = 0.2  # cells: how far a point of the cutter may stray where the axis turns, from one piece to the next


class Passes(NamedTuple):
    """Straight moves: ends (n, 6) m (start, end), tool axes at both (n, 6)."""

    ends: FloatArray
    axes: FloatArray


def tool_axes(k: ArrayLike | None, m: int) -> FloatArray:
    """Unit tool axes (m, 3) from one axis (3,) or (m, 3), upright if None. Raises SurfaceError for a wrong axis."""
    if k is None:
        return np.tile([0.0, 0.0, 1.0], (m, 1))
    axes = as_floats(k, "tool axis", (3,), error=SurfaceError)
    if axes.shape not in ((3,), (m, 3)):
        raise SurfaceError(f"Tool axis: found shape {axes.shape} for {m} points; expected (3,) or ({m}, 3).")
    axes = np.array(np.broadcast_to(axes, (m, 3)))
    length = np.linalg.norm(axes, axis=1, keepdims=True)
    if (np.abs(length - 1.0) > 1e-6).any():
        raise SurfaceError("Tool axis: expected unit vectors, found a length that is not 1.")
    return axes / length


def moves_at_feed(p: FloatArray, cutting: ArrayLike | None) -> BoolArray:
    """(m,) bool of a path p (m, 3) m: entry i where the move p[i-1] -> p[i] is made at feed (default: all)."""
    used = np.ones(len(p), dtype=bool) if cutting is None else np.array(cutting, dtype=bool)
    if used.shape != (len(p),):
        raise SurfaceError(f"Cut: found {used.shape} cutting flags for {len(p)} points; expected one each.")
    used[:1] = False
    return used


def moves_of(still: BoolArray, used: BoolArray) -> IntArray:
    """(m,) the move that every entry of a path is a part of: itself, or the next one where it stands ``still`` and all
    up to that one are ``used``; -1 for none."""
    move = next_true(~(still & used), len(still))
    lost = (move == len(still)) | ~used[np.minimum(move, len(still) - 1)] | (still & ~used)
    return np.asarray(np.where(lost, -1, move))


def feed_passes(p: ArrayLike, k: ArrayLike | None, cutting: ArrayLike | None) -> tuple[Passes, int]:
    """Feed moves of a path p (m, 3) m, straight runs joined, and how many were left out for ends not finite.

    k (3,) or (m, 3) unit tool axis (default: upright), cutting (m,) bool. Raises SurfaceError for a wrong axis, or
    one too close to level for a height map.
    """
    points = as_floats(p, "toolpath points", (None, 3), error=SurfaceError, finite=False)
    axes = tool_axes(k, len(points))
    n = np.flatnonzero(moves_at_feed(points, cutting))
    ends = np.hstack([points[n - 1], points[n]])
    known = np.isfinite(ends).all(axis=1)
    check_rise(np.concatenate([axes[n - 1], axes[n]]))
    return joined(Passes(ends[known], np.hstack([axes[n - 1], axes[n]])[known])), int((~known).sum())


def bends(ends: FloatArray) -> FloatArray:
    """(n - 1,) rad by which each of moves, ``ends`` (n, 6) m, bends off the one before; pi where it does not begin at
    that one's end, or either has no length."""
    span = ends[:, 3:] - ends[:, :3]
    goes_on = (ends[:-1, 3:] == ends[1:, :3]).all(axis=1) & span[:-1].any(axis=1) & span[1:].any(axis=1)
    return np.where(goes_on, angle_between(span[:-1], span[1:]), np.pi)


def joined(moves: Passes) -> Passes:
    """The same moves with runs that go straight on under one axis made one move.

    A line that was divided for the deflection is so cut at once where it is still a line.
    """
    ends, axes = moves
    if len(ends) < 2:
        return moves
    goes_on = (
        (bends(ends) <= STRAIGHT) & (axes[:-1] == axes[1:]).all(axis=1) & (axes[1:, :3] == axes[1:, 3:]).all(axis=1)
    )
    first = np.flatnonzero(np.append(True, ~goes_on))
    last = np.append(first[1:], len(ends)) - 1
    return Passes(np.hstack([ends[first, :3], ends[last, 3:]]), axes[first])


def at_one_axis(moves: Passes, R: float, cell: float) -> tuple[FloatArray, FloatArray, IntArray]:
    """Moves whose axis turns divided into pieces of constant axis: ends (q, 6) m, axes (q, 3), and of which move (q,).

    Each piece takes the axis of its middle, so no point of a cutter of radius R strays by more than about a tenth of
    a cell.
    """
    k_a, k_b = moves.axes[:, :3], moves.axes[:, 3:]
    turn = angle_between(k_a, k_b)
    pieces = np.maximum(1, np.ceil(turn * R / (STRAY * cell))).astype(int)
    owner = np.repeat(np.arange(len(moves.ends)), pieces)
    n = (np.arange(len(owner)) - np.repeat(np.cumsum(pieces) - pieces, pieces))[:, None]
    count = pieces[owner][:, None]
    a, b = moves.ends[owner, :3], moves.ends[owner, 3:]
    split = np.hstack([a + n / count * (b - a), np.where(n + 1 == count, b, a + (n + 1) / count * (b - a))])
    k = k_a[owner] + (n + 0.5) / count * (k_b - k_a)[owner]
    return split, k / np.linalg.norm(k, axis=1, keepdims=True), owner


def leaning(axes: FloatArray) -> BoolArray:
    """(n,) bool: which tool axes (n, 3) lean."""
    from robomill.surface.tilt_kernels import UPRIGHT

    return np.asarray(np.hypot(axes[:, 0], axes[:, 1]) > UPRIGHT)


def check_rise(axes: FloatArray) -> None:
    """Raises SurfaceError where a tool axis (..., 3) is too close to level for a height map."""
    rise = float(axes[:, 2].min(initial=1.0))
    if rise < SMALLEST_RISE:
        raise SurfaceError(
            f"Tool axis: its upward part is {rise:.2f}; a height map needs at least {SMALLEST_RISE}, so tilt the tool"
            " less or turn the part."
        )
