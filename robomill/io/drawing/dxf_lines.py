"""Each kind of line of a DXF drawing, where the blocks around it put it, as it is seen from above.

Blocks in blocks may be scaled unevenly and turned, which shears: no insert says that. So the matrices of all inserts
are multiplied, and points go through the product. Where circles stay round they are arcs, else fine chords.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from robomill.arrays import FARTHEST, FloatArray
from robomill.io.drawing.reading import Reading, chords_of
from robomill.toolpath.arcs import CHORD_ERROR
from robomill.toolpath.sketch import Shape, outline
from robomill.units import format_count

MOST_FIT = 1_000  # points that a spline goes through: finding it takes their square of memory
FLAT = 1e-9
ROUND = 1e-7
"""A circle whose two axes are seen as long as this share, and as square, is one."""
LEAST = 1e-12  # m: what a unit of length comes to where a block is scaled to nothing
FRAME = 16
"""Flag of a vertex that bends the curve of a polyline and is none of its points."""
Made = tuple[Shape, FloatArray] | None


@dataclass(frozen=True, eq=False)
class Place:
    """``P`` (2, 4) takes a point (x, y, z, 1) of a block to m in the drawing, seen from above."""

    P: FloatArray

    def seen(self, points: Iterable[Any]) -> FloatArray:
        """(r, 2) m: points (x, y, z) of ezdxf."""
        own = np.array([(p[0], p[1], p[2]) for p in points], dtype=float).reshape(-1, 3)
        return np.asarray(own @ self.P[:, :3].T + self.P[:, 3])

    @property
    def stretch(self) -> float:
        """m: what the longest unit of length comes to."""
        return _stretch(self.P[:, :3])

    def axes(self, ocs: Any) -> FloatArray:
        """(2, 2) m: what X and Y of a plane figure are seen as, in columns."""
        across = [(v.x, v.y, v.z) for v in (ocs.to_wcs((1.0, 0.0, 0.0)), ocs.to_wcs((0.0, 1.0, 0.0)))]
        return np.asarray(self.P[:, :3] @ np.array(across).T)


def _stretch(B: FloatArray) -> float:
    return max(float(np.linalg.norm(B, 2)), LEAST) if np.isfinite(B).all() else math.inf


def _round(B: FloatArray) -> bool:
    """Whether a circle of these axes is seen as one."""
    (xx, xy), (_, yy) = B.T @ B
    return bool(abs(xx - yy) <= 2.0 * ROUND * xx and abs(xy) <= ROUND * xx)


def _chain(points: FloatArray) -> Made:
    """A line or polyline."""
    return None if len(points) < 2 else ("line" if len(points) == 2 else "polyline", points)


def _line(entity: Any, place: Place, to: Reading) -> Made:
    return "line", place.seen([entity.dxf.start, entity.dxf.end])


def _circle(entity: Any, place: Place, to: Reading) -> Made:
    return _turned(entity, place, to, (0.0, 360.0))


def _arc(entity: Any, place: Place, to: Reading) -> Made:
    begin, end = entity.dxf.start_angle % 360.0, entity.dxf.end_angle % 360.0
    turn = (end - begin) % 360.0
    return _turned(entity, place, to, (begin, 360.0 if turn < FLAT else turn))


def _turned(entity: Any, place: Place, to: Reading, swept: tuple[float, float]) -> Made:
    """A circle, or a part of one from an angle on by another (deg)."""
    ocs, radius, (begin, turn) = entity.ocs(), abs(entity.dxf.radius), swept
    B, centre = place.axes(ocs), place.seen([ocs.to_wcs(entity.dxf.center)])[0]
    if not radius * _stretch(B) <= FARTHEST:
        raise to.refuse(f"it has a circle of a radius of more than {FARTHEST / 1e3:g} km")
    count = 2
    if not _round(B):
        rim = np.array([[0.0, 0.0], [radius * _stretch(B), 0.0]])
        count = max(math.ceil(chords_of("circle", rim) * turn / 360.0), 2)
        to.look(count)
    elif turn == 360.0:
        return "circle", np.array([centre, centre + np.array([radius * float(np.linalg.norm(B[:, 0])), 0.0])])
    angles = np.radians(begin + turn * np.linspace(0.0, 1.0, count + 1))
    points = centre + radius * np.column_stack([np.cos(angles), np.sin(angles)]) @ B.T
    return ("arc", points) if _round(B) else _chain(points)


def _bulged(
    corners: list[tuple[float, float, float]], closed: bool, height: float, place: tuple[Place, Any], to: Reading
) -> Made:
    """A polyline of (x, y, bulge); a bulge is the tangent of a quarter of the arc's angle, to the right if positive."""
    if len(corners) < 2:
        return None
    around, ocs = place
    scale, count = _stretch(around.axes(ocs)), len(corners)
    to.look(count)
    pairs = zip(corners, corners[1:] + corners[:1] * closed, strict=False)
    chains = [np.array([corners[0][:2]])]
    for (x, y, bulge), (u, v, _) in pairs:
        p, q = np.array([x, y]), np.array([u, v])
        if abs(bulge) < FLAT or np.allclose(p, q, rtol=0.0, atol=FLAT):
            chains.append(np.array([q]))
            continue
        way = 0.5 * (p + q) + 0.5 * bulge * np.array([v - y, x - u])
        arc = np.array([p, way, q]) * scale
        to.near(arc)
        count += chords_of("arc", arc)
        to.look(count)
        chains.append(outline("arc", arc)[1:] / scale)
    own = np.vstack(chains)
    return _chain(around.seen([ocs.to_wcs((x, y, height)) for x, y in own.tolist()]))


def _lwpolyline(entity: Any, place: Place, to: Reading) -> Made:
    to.look(len(entity))
    corners = [(float(x), float(y), float(b)) for x, y, b in entity.get_points("xyb")]
    return _bulged(corners, bool(entity.closed), float(entity.dxf.elevation), (place, entity.ocs()), to)


def _polyline(entity: Any, place: Place, to: Reading) -> Made:
    """The frame that a curve was fitted to stands among its vertices, and is not drawn."""
    to.look(len(entity.vertices))
    drawn = [v for v in entity.vertices if not v.dxf.flags & FRAME]
    if entity.is_3d_polyline:
        points = place.seen([v.dxf.location for v in drawn])
        return _chain(np.vstack([points, points[:1]]) if entity.is_closed else points)
    if not entity.is_2d_polyline:
        return None
    corners = [(float(v.dxf.location[0]), float(v.dxf.location[1]), float(v.dxf.get("bulge", 0.0))) for v in drawn]
    height = float(drawn[0].dxf.location[2]) if drawn else 0.0
    return _bulged(corners, bool(entity.is_closed), height, (place, entity.ocs()), to)


def _spline(entity: Any, place: Place, to: Reading) -> Made:
    if entity.control_point_count() == 0 and entity.fit_point_count() > MOST_FIT:
        raise to.refuse(
            f"it has a spline through {format_count(entity.fit_point_count())} points, at most "
            f"{format_count(MOST_FIT)} are read"
        )
    off = CHORD_ERROR / place.stretch
    curve = entity.construction_tool()
    return _chained(curve.flattening(off) if curve.is_clamped else _defined(curve, off), place, to)


def _defined(curve: Any, off: float) -> Iterator[Any]:
    """Points of a spline whose ends are not clamped, such as a closed one: it is defined between the knots that as
    many others stand before and behind as its degree says, and ezdxf would follow it over all of them."""
    inner = np.unique(np.array(curve.knots())[curve.degree : -curve.degree])
    steps = np.unique(np.concatenate([np.linspace(a, b, 5) for a, b in pairwise(inner)])).tolist()
    yield curve.point(steps[0])
    for first, last in pairwise(steps):
        yield from _halved(curve, first, last, off)


def _halved(curve: Any, first: float, last: float, off: float) -> Iterator[Any]:
    """Points behind the one at ``first``, so that the middle of no chord lies farther than ``off`` from the curve."""
    middle = 0.5 * (first + last)
    a, b = (curve.point(t) for t in (first, last))
    if curve.point(middle).distance(a.lerp(b)) < off or not first < middle < last:
        yield b
        return
    yield from _halved(curve, first, middle, off)
    yield from _halved(curve, middle, last, off)


def _ellipse(entity: Any, place: Place, to: Reading) -> Made:
    return _chained(entity.flattening(CHORD_ERROR / place.stretch), place, to)


def _chained(flat: Iterable[Any], place: Place, to: Reading) -> Made:
    """A curve in as many chords as ``CHORD_ERROR`` asks for."""
    points = []
    for p in flat:
        points.append(p)
        if len(points) > to.room:
            to.look(len(points))
    return _chain(place.seen(points))


MAKERS: dict[str, Callable[[Any, Place, Reading], Made]] = {
    "LINE": _line,
    "CIRCLE": _circle,
    "ARC": _arc,
    "LWPOLYLINE": _lwpolyline,
    "POLYLINE": _polyline,
    "ELLIPSE": _ellipse,
    "SPLINE": _spline,
}
