"""Lines beside a contour, at the distance of the cutter's radius; corners are rounded on their outer side."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import ToolpathError
from robomill.extras import needed
from robomill.toolpath.arcs import CHORD_ERROR
from robomill.toolpath.chaining import tidy_chain, turning
from robomill.toolpath.contour import Contour
from robomill.toolpath.plane import doubled_area
from robomill.toolpath.sketch import centre_of
from robomill.units import format_many, format_si

SAME = 1e-9


def beside_line(contour: Contour, side: str, radius: float) -> list[Contour]:
    """The path of a tool of ``radius`` (m) on one ``side`` of a contour: one line, or more where it falls apart.

    Raises ToolpathError where there is none, or where the side means nothing for an open line.
    """
    if contour.shape == "circle":
        return [_beside_circle(contour, side, radius)]
    if contour.closed:
        return _beside_closed(contour, side, radius)
    if side not in ("left", "right"):
        raise ToolpathError(
            f"Layer {contour.layer}: {contour.place} has no {side}; choose left or right of the line, or on it."
        )
    away = radius if side == "left" else -radius
    return _beside_arc(contour, away) if contour.shape == "arc" else _beside_open(contour, away)


def _beside_circle(contour: Contour, side: str, radius: float) -> Contour:
    centre, rim = contour.points
    R = float(np.linalg.norm(rim - centre))
    new = R + radius if side in ("right", "outside") else R - radius
    if new < SAME:
        raise _no_room(contour, 2.0 * radius)
    moved = replace(contour, points=np.array([centre, centre + (rim - centre) * (new / R)]))
    if side != "outside":
        return moved
    return replace(moved, shape="polygon", points=moved.outline()[:0:-1])  # clockwise, which a circle is not


def _beside_closed(contour: Contour, side: str, radius: float) -> list[Contour]:
    with needed("A cut beside its line"):
        import shapely

    area = shapely.Polygon(contour.outline())
    if not area.is_valid:
        raise ToolpathError(
            f"Layer {contour.layer}: {contour.place} crosses or touches itself, so it has no clear inside; mend the "
            "drawing, or cut on the line."
        )
    outwards = side in ("right", "outside")
    grown = area.buffer(radius if outwards else -radius, quad_segs=_segments(radius))
    rings = [(np.array(ring.coords), hole) for each in _parts(grown) for hole, ring in _rings(each)]
    if not rings:
        raise _no_room(contour, 2.0 * radius)
    found = []
    for ring, hole in rings:
        turned = _from(tidy_chain(ring)[:-1], contour.points[0])
        clockwise = (side == "outside") != hole
        found.append(replace(contour, shape="polygon", points=turning(turned, clockwise)))
    return found


def _beside_arc(contour: Contour, away: float) -> list[Contour]:
    """The arc about the same centre."""
    corners = contour.outline()
    a, b, c = contour.points
    turns_left = doubled_area(a, b, c) > 0.0
    middle = centre_of(a, b, c)
    if middle is None:
        return _beside_open(replace(contour, shape="polyline", points=corners), away)
    R = float(np.linalg.norm(a - middle))
    new = R - away if turns_left else R + away
    if new < SAME:
        raise _no_room(contour, 2.0 * abs(away))
    return [replace(contour, points=middle + (contour.points - middle) * (new / R))]


def _beside_open(contour: Contour, away: float) -> list[Contour]:
    with needed("A cut beside its line"):
        import shapely

    line = shapely.LineString(contour.outline())
    moved = line.offset_curve(away, quad_segs=_segments(abs(away)), join_style="round")
    chains = [tidy_chain(np.array(part.coords)) for part in _parts(moved)]
    chains = [chain for chain in chains if len(chain) > 1]
    if not chains:
        raise _no_room(contour, 2.0 * abs(away))
    return [replace(contour, shape="line" if len(each) == 2 else "polyline", points=each) for each in chains]


def _segments(radius: float) -> int:
    """Chords of a quarter turn of a round corner."""
    return max(8, math.ceil(math.pi / (4.0 * math.acos(max(1.0 - CHORD_ERROR / radius, 0.5)))))


def _parts(shape: Any) -> list[Any]:
    return [part for part in getattr(shape, "geoms", [shape]) if not part.is_empty]


def _rings(polygon: Any) -> list[tuple[bool, Any]]:
    return [(False, polygon.exterior), *((True, ring) for ring in polygon.interiors)]


def _from(ring: FloatArray, start: FloatArray) -> FloatArray:
    """A ring that begins where it is nearest to ``start``."""
    return np.roll(ring, -int(np.argmin(np.linalg.norm(ring - start, axis=1))), axis=0)


def _no_room(contour: Contour, diameter: float) -> ToolpathError:
    corners = contour.outline()
    size = format_many(corners.max(axis=0) - corners.min(axis=0), "mm", 2, between=" × ")
    return ToolpathError(
        f"Layer {contour.layer}: a cutter of {format_si(diameter, 'mm', 2)} does not fit beside {contour.place} "
        f"({size}); take a smaller one, another side, or cut on the line."
    )
