"""Single lines and arcs of a drawing joined to contours where exactly two of them meet at their ends."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from robomill.arrays import FloatArray
from robomill.toolpath.contour import CLOSED, Contour

GAP = 1e-5
"""m: ends of lines that lie no farther apart meet."""
SHORTEST = 1e-8
"""m: what is shorter is a point."""


def turning(ring: FloatArray, clockwise: bool) -> FloatArray:
    """A ring of points (r, 2) m that begins where it did and runs the way it is told."""
    x, y = ring.T
    turns_left = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) > 0.0
    return ring if turns_left != clockwise else np.vstack([ring[:1], ring[:0:-1]])


def joined(pieces: Sequence[Contour]) -> tuple[list[Contour], int, int]:
    """The contours of each layer in the order of their first pieces; how many pieces were there twice, or a point."""
    kept, twice, dots = _once(pieces)
    layers: dict[str, list[Contour]] = defaultdict(list)
    for piece in kept:
        layers[piece.layer].append(piece)
    return [contour for of_layer in layers.values() for contour in _chains(of_layer)], twice, dots


def tidy_chain(points: FloatArray) -> FloatArray:
    """A chain of points (r, 2) m without those that are where the one before is; its two ends stay."""
    kept = np.append(True, np.linalg.norm(np.diff(points, axis=0), axis=1) > SHORTEST)
    found = points[kept]
    if len(found) > 1:
        found[-1] = points[-1]
    return found


def _once(pieces: Sequence[Contour]) -> tuple[list[Contour], int, int]:
    """The pieces that have a length, each once, whichever way it was drawn."""
    seen, kept, dots = set(), [], 0
    for piece in pieces:
        corners = piece.outline()
        if np.ptp(corners, axis=0).max() < SHORTEST:
            dots += 1
            continue
        middle = corners.mean(axis=0) if piece.closed else np.abs(np.diff(corners, axis=0)).sum(axis=0)
        ends = sorted(map(tuple, np.round(corners[[0, -1]], 7).tolist()))
        box = np.round([*corners.min(axis=0), *corners.max(axis=0), *middle], 7) + 0.0
        key = (piece.layer, len(corners), *ends, *box.tolist())
        if key not in seen:
            seen.add(key)
            kept.append(piece)
    return kept, len(pieces) - dots - len(kept), dots


class _Nodes:
    """Numbers of the places where ends lie, equal for those within ``GAP``."""

    def __init__(self) -> None:
        self.known: dict[tuple[int, int], list[tuple[float, float, int]]] = defaultdict(list)
        self.count = 0

    def of(self, p: FloatArray) -> int:
        x, y = float(p[0]), float(p[1])
        i, j = int(np.floor(x / GAP)), int(np.floor(y / GAP))
        for cell in ((a, b) for a in (i, i - 1, i + 1) for b in (j, j - 1, j + 1)):
            for u, v, number in self.known.get(cell, ()):
                if (u - x) ** 2 + (v - y) ** 2 <= GAP**2:
                    return number
        self.known[i, j].append((x, y, self.count))
        self.count += 1
        return self.count - 1


def _chains(pieces: Sequence[Contour]) -> list[Contour]:
    """The contours of one layer."""
    nodes, ends, at = _Nodes(), {}, defaultdict(list)
    for k, piece in enumerate(pieces):
        if not piece.closed:
            corners = piece.outline()
            ends[k] = nodes.of(corners[0]), nodes.of(corners[-1])
            for node in ends[k]:
                at[node].append(k)
    found: dict[int, Contour] = {k: _closed(piece) for k, piece in enumerate(pieces) if piece.closed}
    left = dict(ends)
    begins = [k for k, pair in ends.items() if any(len(at[node]) != 2 for node in pair)]
    for k in (*begins, *ends):
        if k in left:
            first = 0 if len(at[ends[k][0]]) != 2 else 1 if len(at[ends[k][1]]) != 2 else 0
            chain = _followed(k, first, left, at)
            found[min(number for number, _ in chain)] = _contour(chain, pieces)
    return [found[k] for k in sorted(found)]


def _followed(k: int, first: int, left: dict[int, tuple[int, int]], at: dict[int, list[int]]) -> list[tuple[int, bool]]:
    """Pieces from ``k`` on, each with whether it is followed backwards, as far as exactly two meet."""
    chain, turned = [], first == 1
    while True:
        pair = left.pop(k)
        chain.append((k, turned))
        node = pair[0] if turned else pair[1]
        onward = [other for other in at[node] if other in left]
        if len(at[node]) != 2 or not onward:
            return chain
        k = onward[0]
        turned = left[k][0] != node


def _contour(chain: list[tuple[int, bool]], pieces: Sequence[Contour]) -> Contour:
    """One contour of a chain, the way its first piece in the drawing was drawn."""
    if min(chain)[1]:
        chain = [(k, not turned) for k, turned in reversed(chain)]
    first = pieces[chain[0][0]]
    outlines = [pieces[k].outline()[:: -1 if turned else 1] for k, turned in chain]
    points = tidy_chain(np.vstack([outlines[0], *(each[1:] for each in outlines[1:])]))
    ends_meet = np.linalg.norm(points[-1] - points[0]) <= GAP
    if len(points) > 3 and ends_meet:
        return _closed(replace(first, shape="polygon", points=points[:-1]))
    if len(chain) == 1 and first.shape in ("line", "arc"):
        return first
    return replace(first, shape="line" if len(points) == 2 else "polyline", points=points)


def _closed(contour: Contour) -> Contour:
    """A closed contour that runs counter-clockwise from where it was begun."""
    if contour.shape == "circle":
        return contour
    ring = contour.outline()[:-1] if contour.shape in CLOSED else contour.points
    return replace(contour, shape="polygon", points=turning(ring, clockwise=False))
