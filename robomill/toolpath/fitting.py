"""A moved path as few straight pieces and arcs: a line or an arc whose points have been moved, each by its own bit, is
kept whole where that stays within a bound, and split only where it does not."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from robomill.arrays import FloatArray
from robomill.toolpath.arcs import Arcs
from robomill.toolpath.plane import axes

FEWEST = 3  # points of an arc that is worth fitting
WIDEST = math.radians(330.0)  # of one arc: nearly closed ones are fitted in halves
FLATTEST = 1e-4  # rad: what bends less is a line


@dataclass(frozen=True)
class Piece:
    """A straight cut, or an arc about ``centre`` with a signed ``sweep`` (rad), from where the last piece ended to
    ``end`` (3,) m; it is the share ``f0`` to ``f1`` of its move. A link has f0 = f1: it leads from one correction to
    the next."""

    f0: float
    f1: float
    end: FloatArray
    centre: FloatArray | None = None
    sweep: float = 0.0


def straight_pieces(f: FloatArray, q: FloatArray, bound: float) -> list[Piece]:
    """Points q (n, 3) m at shares f (n,) of a move, the first one where it starts, as chords within ``bound`` (m)."""
    ends = _kept(f, q, bound)
    return [Piece(float(f[a]), float(f[b]), q[b]) for a, b in pairwise(ends)]


def _kept(f: FloatArray, q: FloatArray, bound: float) -> list[int]:
    """The points at which a chord ends (Ramer, Douglas and Peucker), share by share."""
    keep, todo = {0, len(f) - 1}, [(0, len(f) - 1)]
    while todo:
        a, b = todo.pop()
        if b - a < 2:
            continue
        some = slice(a + 1, b)
        share = ((f[some] - f[a]) / (f[b] - f[a]) if f[b] > f[a] else np.zeros(b - a - 1))[:, None]
        off = np.linalg.norm(q[some] - q[a] - share * (q[b] - q[a]), axis=1)
        worst = int(np.argmax(off))
        if off[worst] > bound:
            middle = a + 1 + worst
            keep.add(middle)
            todo += [(a, middle), (middle, b)]
    return sorted(keep)


def arc_pieces(f: FloatArray, q: FloatArray, plane: int, sweep: float, bound: float) -> list[Piece]:
    """Points of an arc that turns by ``sweep`` (rad) in a ``plane``: one arc where that holds, several or chords where
    those are fewer."""
    arcs = _arcs(f, q, plane, sweep, bound)
    chords = straight_pieces(f, q, bound)
    return chords if len(arcs) > len(chords) else arcs


def _arcs(f: FloatArray, q: FloatArray, plane: int, sweep: float, bound: float) -> list[Piece]:
    """Arcs, each as long as it holds, and chords where none does."""
    pieces: list[Piece] = []
    begin, at, last = 0, 0, len(f) - 1
    while at < last:
        end, piece = _longest(f[at:], q[at:], plane, sweep, bound)
        if piece is not None:
            some = slice(begin, at + 1)
            pieces += [*(straight_pieces(f[some], q[some], bound) if at > begin else []), piece]
            begin = at + end
        at += end
    return pieces + (straight_pieces(f[begin:], q[begin:], bound) if last > begin else [])


def _longest(f: FloatArray, q: FloatArray, plane: int, sweep: float, bound: float) -> tuple[int, Piece | None]:
    """Up to which of the points the longest arc from the first one holds, and the arc; a step without one."""

    def to(end: int) -> Piece | None:
        some = slice(0, end + 1)
        return _one_arc(f[some], q[some], plane, sweep * float(f[end] - f[0]), bound)

    last = len(f) - 1
    if last < FEWEST - 1:
        return 1, None
    whole = to(last)
    if whole is not None:
        return last, whole
    low, high, found = 1, FEWEST - 1, None
    while high < last and (piece := to(high)) is not None:
        low, high, found = high, 2 * high, piece
    high = min(high, last)
    while found is not None and high - low > 1:
        middle = (low + high) // 2
        piece = to(middle)
        low, high, found = (middle, high, piece) if piece is not None else (low, middle, found)
    shorter = to(low - 1) if low == last - 1 and low > FEWEST - 1 else None  # two steps are left for another
    return (low, found) if shorter is None else (low - 1, shorter)


def _one_arc(f: FloatArray, q: FloatArray, plane: int, sweep: float, bound: float) -> Piece | None:
    """The arc from the first point to the last one that lies nearest to all, if within ``bound``: its centre stands on
    the bisector of its chord, so that it ends on its circle."""
    first, second, third = axes(plane)
    u, w = q[:, [first, second]], q[:, third]
    chord = u[-1] - u[0]
    length = float(np.linalg.norm(chord))
    closed = length < 1e-9
    if (abs(sweep) > WIDEST and not closed) or abs(sweep) > 2.0 * math.pi + 1e-6:
        return None
    centre = _centre(u)
    if not closed and centre is not None:
        middle, normal = 0.5 * (u[0] + u[-1]), np.array([-chord[1], chord[0]]) / length
        centre = middle + float((centre - middle) @ normal) * normal
    if centre is None:
        return None
    out = u - centre
    radius = float(np.linalg.norm(out[0]))
    turned = np.unwrap(np.arctan2(out[:, 1], out[:, 0]))
    turned -= turned[0]
    total = float(turned[-1])
    if abs(total) < FLATTEST or abs(total - sweep) > 0.5 or total * sweep <= 0.0:
        return None
    level = w[0] + turned / total * (w[-1] - w[0])
    off = np.hypot(np.linalg.norm(out, axis=1) - radius, w - level)
    if off.max() > bound:
        return None
    return Piece(float(f[0]), float(f[-1]), q[-1], _in_space(plane, centre, float(w[0])), total)


def _centre(u: FloatArray) -> FloatArray | None:
    """The centre of the circle nearest to points u (n, 2): least squares of what is linear in it."""
    mean = u.mean(axis=0)
    x = u - mean
    size = float(np.abs(x).max())
    if size < 1e-9:
        return None
    x = x / size
    A = np.column_stack([2.0 * x, np.ones(len(x))])
    found, _, rank, _ = np.linalg.lstsq(A, (x * x).sum(axis=1), rcond=1e-9)
    return mean + size * found[:2] if rank == 3 else None


def _in_space(plane: int, centre: FloatArray, w: float) -> FloatArray:
    first, second, third = axes(plane)
    out = np.empty(3)
    out[[first, second, third]] = centre[0], centre[1], w
    return out


def along_piece(start: FloatArray, piece: Piece, f: FloatArray, plane: int = 17) -> FloatArray:
    """(n, 3) m: where a piece from ``start`` (3,) m is at shares f (n,) of its move."""
    share = (f - piece.f0) / (piece.f1 - piece.f0) if piece.f1 > piece.f0 else np.ones(len(f))
    if piece.centre is None:
        return np.asarray(start + share[:, None] * (piece.end - start))
    arc = Arcs(start[None], piece.end[None], piece.centre[None], np.array([plane]), np.array([piece.sweep]))
    return arc.at(np.zeros(len(f), dtype=np.int64), share)
