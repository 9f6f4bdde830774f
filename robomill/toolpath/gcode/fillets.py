"""The arc of a given radius that touches two cuts of one plane, of which one is an arc, where they meet in a corner.

Its centre lies as far as its radius from both cuts, on the inner side of the corner; it touches each where that one is
nearest to the centre. Of all such arcs it is the one nearest to the corner that touches cuts and not what continues
them. (Fanuc ``,R``; Sinumerik RND, RNDM; Heidenhain RND.)
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

from robomill.toolpath.plane import swept

_TOUCHES = 1e-9
"""m and rad: so far beyond the end of a cut an arc may touch it."""
UV = tuple[float, float]


class Cut(NamedTuple):
    """A cut (m, in its plane) seen from the corner that it leads to (``way`` -1) or comes from (+1): its direction of
    travel there, its length, or centre, radius, sense and swept angle of an arc."""

    way: int
    along: UV
    length: float
    centre: UV = (0.0, 0.0)
    radius: float = 0.0
    turn: int = 0


def tangents_turn(first: Cut, then: Cut) -> float:
    """The angle (rad, signed) by which the direction of travel changes in the corner."""
    (a, b), (c, d) = first.along, then.along
    return math.atan2(a * d - b * c, a * c + b * d)


def touching(corner: UV, first: Cut, then: Cut, radius: float) -> tuple[UV, UV, UV] | None:
    """Where the arc leaves the first cut, where it joins the other, and its centre; None where none fits."""
    side = math.copysign(1.0, tangents_turn(first, then))
    found: list[tuple[float, UV, UV, UV]] = []
    for centre in _centres(corner, first, then, side * radius):
        leaves, joins = (_touched(corner, cut, centre) for cut in (first, then))
        if leaves is not None and joins is not None:
            found.append((math.dist(corner, centre), leaves, joins, centre))
    if not found:
        return None
    return min(found)[1:]


def _centres(corner: UV, first: Cut, then: Cut, aside: float) -> Iterator[UV]:
    """Where what lies ``aside`` (m, to the left) of one cut meets what lies so of the other."""
    straight, arc = (first, then) if first.turn == 0 else (then, first)
    reach = arc.radius - arc.turn * aside
    if reach <= 0.0:
        return
    if straight.turn == 0:
        u, v = straight.along
        base = corner[0] - aside * v, corner[1] + aside * u
        ahead = (arc.centre[0] - base[0]) * u + (arc.centre[1] - base[1]) * v
        across = math.dist(arc.centre, (base[0] + ahead * u, base[1] + ahead * v))
        if across <= reach:
            half = math.sqrt(reach**2 - across**2)
            for way in (ahead - half, ahead + half):
                yield base[0] + way * u, base[1] + way * v
        return
    other = straight.radius - straight.turn * aside
    apart = math.dist(arc.centre, straight.centre)
    if other <= 0.0 or not abs(reach - other) <= apart <= reach + other or apart == 0.0:
        return
    along = (apart**2 + reach**2 - other**2) / (2.0 * apart)
    half = math.sqrt(max(reach**2 - along**2, 0.0))
    u, v = ((straight.centre[k] - arc.centre[k]) / apart for k in (0, 1))
    for way in (-half, half):
        yield arc.centre[0] + along * u - way * v, arc.centre[1] + along * v + way * u


def _touched(corner: UV, cut: Cut, centre: UV) -> UV | None:
    """The point of a cut, away from the corner, that is nearest to a centre; None where it is beyond its end."""
    if cut.turn == 0:
        way = sum((centre[k] - corner[k]) * cut.along[k] for k in (0, 1))
        place = corner[0] + way * cut.along[0], corner[1] + way * cut.along[1]
        beyond = way * cut.way
    else:
        share = cut.radius / math.dist(cut.centre, centre)
        place = tuple(cut.centre[k] + share * (centre[k] - cut.centre[k]) for k in (0, 1))  # type: ignore[assignment]
        beyond = abs(swept(*((place, corner) if cut.way < 0 else (corner, place)), cut.centre, cut.turn, 0.0))
    return place if -_TOUCHES <= beyond <= cut.length + _TOUCHES else None
