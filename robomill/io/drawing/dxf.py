"""DXF drawings as lines by layer: read by ezdxf, blocks opened where they are inserted, no other file followed."""

import io
import logging
import math
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

import numpy as np

from robomill.arrays import FARTHEST, FloatArray
from robomill.errors import ToolpathError
from robomill.extras import needed
from robomill.progress import checkpoint
from robomill.toolpath.arcs import CHORD_ERROR, chord_counts
from robomill.toolpath.chaining import SHORTEST
from robomill.toolpath.contour import Contour
from robomill.toolpath.sketch import MAX_POINTS, Shape, centre_of, outline
from robomill.units import format_count, to_si

MOST_ENTITIES = 50_000  # looked at, with those of blocks each time that one is inserted
MOST_TAGS, MOST_RECORDS = 1_000_000, 200_000  # of the file: pairs of lines, and those of them that begin something
MOST_FIT = 1_000  # points that a spline goes through: finding it takes their square of memory
DEEPEST_BLOCK = 16
LONGEST_S = 10.0
# What $INSUNITS says, by the key of ``units.UNITS``; other numbers of it are units that no part is drawn in.
UNITS_OF_DXF = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 8: "uin", 9: "thou", 13: "um"}
PER_INCH = {"px": 96, "pt": 72}  # pixels as browsers and Inkscape count them, points as Illustrator does
FLAT = 1e-9
# What the libraries that read drawings meet in a file that is damaged, or none of theirs.
STUMBLES = (OSError, EOFError, LookupError, ValueError, TypeError, AttributeError, ArithmeticError)


def metres(unit: str) -> float:
    """A unit of length of a drawing, a key of ``units.UNITS`` or of ``PER_INCH``, in m."""
    return float(to_si(1.0 / PER_INCH[unit], "in") if unit in PER_INCH else to_si(1.0, unit))


@dataclass(frozen=True)
class Read:
    """What a file holds: its lines in m, layers that are switched off, and what was not taken, by its name."""

    pieces: list[Contour] = field(default_factory=list)
    hidden: set[str] = field(default_factory=set)
    left_out: Counter[str] = field(default_factory=Counter)


class Reading:
    """One pass through a drawing called ``name``: what was ``found``, and an end to what is too much or takes too long.

    ``room`` is how many points may still come.
    """

    def __init__(self, name: str) -> None:
        self.name, self.found, self.room = name, Read(), MAX_POINTS
        self._until = time.thread_time() + LONGEST_S

    def refuse(self, why: str) -> ToolpathError:
        """Why it is not read to its end."""
        return ToolpathError(f"{self.name}: {why}; save what is to be cut in a drawing of its own.")

    def look(self, points: int = 0) -> None:
        """Whether so many ``points`` may come. Raises ToolpathError where that is too much, or it is too late."""
        checkpoint()
        if points > self.room:
            raise self.refuse(f"its lines have more than {format_count(MAX_POINTS)} points")
        if time.thread_time() > self._until:
            raise self.refuse(f"it takes longer than {LONGEST_S:.0f} s to read")

    def near(self, points: FloatArray) -> None:
        """Refuse ``points`` (m) that no part has."""
        if not (np.abs(points) <= FARTHEST).all():
            raise self.refuse(f"a line goes farther than {FARTHEST / 1e3:g} km")

    def take(self, layer: str, shape: Shape, points: FloatArray) -> None:
        """One line of it, ``points`` (r, 2) in m."""
        if not np.isfinite(points).all():
            raise self.refuse(f"a {shape} on layer {layer:.40} has a point that is no number")
        self.near(points)
        if shape == "circle" and np.linalg.norm(points[1] - points[0]) < SHORTEST:
            shape = "line"  # a point, which is left out as those are
        count = _chords(shape, points)
        self.look(count)
        self.room -= count
        self.found.pieces.append(Contour(layer, shape, points))


def _chords(shape: Shape, points: FloatArray) -> int:
    """Points that a line has, or at most comes to once its arcs are chords."""
    if shape == "circle":
        radius, sweep = float(np.linalg.norm(points[1] - points[0])), math.tau
    elif shape == "arc" and (centre := centre_of(*points)) is not None:
        radius = max(float(np.linalg.norm(points[0] - centre)), 1e-12)
        longest = 0.5 * math.pi * float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
        sweep = min(longest / radius, math.tau)
    else:
        return len(points)
    return int(chord_counts(np.array([sweep]), np.array([radius]), CHORD_ERROR)[0])


class Dxf:
    """A DXF document; ``unit`` is what it says its numbers are in, "" where it is silent."""

    def __init__(self, data: bytes, name: str) -> None:
        with needed("A DXF drawing"):
            from ezdxf import DXFError
        self.name = name
        _look_over(data, name)
        try:
            self.doc = _document(data, name)
            self.unit = UNITS_OF_DXF.get(int(self.doc.header.get("$INSUNITS", 0)), "")
        except ToolpathError:
            raise
        except (DXFError, *STUMBLES):  # ezdxf names most of what is wrong with a file by an error of its own
            text = f"{name}: this is no DXF file, or one that is damaged or cut off; export the drawing again as DXF."
            raise ToolpathError(text) from None
        except RecursionError:
            raise ToolpathError(f"{name}: its parts are nested too deep; export the drawing again as DXF.") from None

    def scale(self, unit: str) -> float:
        """m: its unit of length, where that is a ``unit``."""
        return metres(unit)

    def read(self, scale: float) -> Read:
        """Its lines, with ``scale`` (m) for its unit of length."""
        return _DxfReading(self.name, self.doc, scale).read()


def _look_over(data: bytes, name: str) -> None:
    """Refuse a file that is too much for ezdxf, which takes a hundred times its bytes where they are short lines."""
    tags = data.count(b"\n") // 2
    begun = sum(code.strip() == b"0" for code in islice(io.BytesIO(data), 0, None, 2)) if tags > MOST_RECORDS else 0
    for found, most, what in ((tags, MOST_TAGS, "values"), (begun, MOST_RECORDS, "entities and other records")):
        if found > most:
            raise Reading(name).refuse(f"it holds {format_count(found)} {what}, at most {format_count(most)} are read")


def _document(data: bytes, name: str) -> Any:
    """As it should be read, which is quick; where that fails, with ezdxf's mending of old and odd files."""
    import ezdxf
    from ezdxf import recover
    from ezdxf.audit import AuditError

    logging.getLogger("ezdxf").setLevel(logging.ERROR)  # a word for each number that it mends
    try:
        return ezdxf.read(io.StringIO(data.decode("utf-8-sig").replace("\r\n", "\n")))
    except (UnicodeDecodeError, ezdxf.DXFError):
        doc, audit = recover.read(io.BytesIO(data))
    for found in (*audit.errors, *audit.fixes):  # "1,5" would be 1.0
        if found.code == AuditError.INVALID_FLOATING_POINT_VALUE:
            raise ToolpathError(f"{name}: {found.message[:120]}; export the drawing again as DXF.")
    return doc


class _DxfReading(Reading):
    """One pass through the model space."""

    def __init__(self, name: str, doc: Any, scale: float) -> None:
        super().__init__(name)
        self.doc, self.scale, self.looked_at = doc, scale, 0
        self.held: dict[str, int] = {}  # entities of each block, blocks opened

    def read(self) -> Read:
        for entity, layer in self._walk(self.doc.modelspace(), "", 0):
            self._take(entity, layer)
        for layer in self.doc.layers:
            if layer.is_off() or layer.is_frozen():
                self.found.hidden.add(str(layer.dxf.name))
        return self.found

    def _walk(self, entities: Iterable[Any], around: str, depth: int) -> Iterator[tuple[Any, str]]:
        """Every entity with its layer; what a block has on layer 0 is on the layer of its insert."""
        for entity in entities:
            self.looked_at += 1
            self._check_count(self.looked_at)
            self.look()
            own = (
                str(entity.dxf.layer) if entity.dxf.is_supported("layer") else "0"
            )  # what ezdxf does not know has none
            layer = around if own == "0" and around else own
            if entity.dxftype() != "INSERT":
                yield entity, layer
                continue
            for one in self._each(entity):
                yield from self._opened(one, layer, depth + 1)

    def _each(self, insert: Any) -> Iterator[Any]:
        """An insert, or those that an array of it stands for."""
        if insert.mcount > MOST_ENTITIES:
            raise self.refuse(f"a block is inserted {format_count(insert.mcount)} times in an array")
        return iter(insert.multi_insert()) if insert.mcount > 1 else iter([insert])

    def _opened(self, insert: Any, layer: str, depth: int) -> Iterator[tuple[Any, str]]:
        block = insert.block()
        if block is None or block.block is None or block.block.is_xref or block.block.is_xref_overlay:
            self.found.left_out["reference to another drawing, or to a block that is not there"] += 1
            return
        if depth > DEEPEST_BLOCK:
            raise self.refuse(f"blocks are nested deeper than {DEEPEST_BLOCK}, or hold themselves")

        self._check_count(self.looked_at + self._held(block, depth))

        def skipped(entity: Any, why: str) -> None:
            self.found.left_out[entity.dxftype()] += 1

        yield from self._walk(insert.virtual_entities(skipped_entity_callback=skipped), layer, depth)

    def _held(self, block: Any, depth: int) -> int:
        """Entities of a block, with those of the blocks in it each time that one is inserted; known before any of them
        is made. What is nested too deep, or in itself, is refused where it is opened."""
        if block.name not in self.held:
            self.held[block.name] = 0
            for entity in block:
                inside = entity.block() if entity.dxftype() == "INSERT" and depth < DEEPEST_BLOCK else None
                more = 0 if inside is None else max(entity.mcount, 1) * self._held(inside, depth + 1)
                self.held[block.name] += 1 + more
        return self.held[block.name]

    def _check_count(self, count: int) -> None:
        if count > MOST_ENTITIES:
            raise self.refuse(f"it holds more than {format_count(MOST_ENTITIES)} entities, blocks opened")

    def _take(self, entity: Any, layer: str) -> None:
        kind = entity.dxftype()
        make = MAKERS.get(kind)
        try:
            made = None if make is None else make(entity, self)
        except RecursionError:  # a curve with a number that is none, or too large, is halved without end
            raise self.refuse(f"the {kind} on layer {layer:.40} has a point that is no number, or far away") from None
        except ToolpathError:
            raise
        except STUMBLES:
            made = None  # ezdxf's words for a curve that cannot be: too few points, a degree that does not fit
        if made is None:
            self.found.left_out[kind] += 1
            return
        self.take(layer, *made)


Made = tuple[Shape, FloatArray] | None


def _flat(points: Iterable[Any], scale: float) -> FloatArray:
    """(r, 2) m: points of ezdxf seen from above."""
    return np.array([(p[0], p[1]) for p in points], dtype=float).reshape(-1, 2) * scale


def _chain(points: FloatArray) -> Made:
    """A line or polyline."""
    return None if len(points) < 2 else ("line" if len(points) == 2 else "polyline", points)


def _line(entity: Any, to: _DxfReading) -> Made:
    return "line", _flat([entity.dxf.start, entity.dxf.end], to.scale)


def _upright(entity: Any) -> bool:
    """Whether a plane figure lies in a plane of the drawing, seen from above or below."""
    x, y, _ = entity.dxf.extrusion.normalize()
    return abs(x) < FLAT and abs(y) < FLAT


def _leaning(entity: Any, to: _DxfReading) -> Made:
    """A circle, or a part of one, that is seen as an ellipse."""
    radius = abs(entity.dxf.radius) * to.scale
    if not radius <= FARTHEST:
        raise to.refuse(f"it has a circle of a radius of more than {FARTHEST / 1e3:g} km")
    to.look(_chords("circle", np.array([[0.0, 0.0], [radius, 0.0]])))
    return _chain(_flat(entity.flattening(CHORD_ERROR / to.scale), to.scale))


def _circle(entity: Any, to: _DxfReading) -> Made:
    scale = to.scale
    if not _upright(entity):
        return _leaning(entity, to)
    centre = _flat([entity.ocs().to_wcs(entity.dxf.center)], scale)[0]
    return "circle", np.array([centre, centre + np.array([abs(entity.dxf.radius) * scale, 0.0])])


def _arc(entity: Any, to: _DxfReading) -> Made:
    scale = to.scale
    if not _upright(entity):
        return _leaning(entity, to)
    begin, end = entity.dxf.start_angle % 360.0, entity.dxf.end_angle % 360.0
    turn = (end - begin) % 360.0
    if turn < FLAT:
        return _circle(entity, to)
    angles = np.radians(begin + turn * np.array([0.0, 0.5, 1.0]))
    centre, radius = entity.dxf.center, entity.dxf.radius
    own = [(centre[0] + radius * np.cos(a), centre[1] + radius * np.sin(a), centre[2]) for a in angles]
    return "arc", _flat([entity.ocs().to_wcs(p) for p in own], scale)


def _bulged(corners: list[tuple[float, float, float]], closed: bool, height: float, ocs: Any, to: _DxfReading) -> Made:
    """A polyline of (x, y, bulge); a bulge is the tangent of a quarter of the arc's angle, to the right if positive."""
    if len(corners) < 2:
        return None
    scale, count = to.scale, len(corners)
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
        count += _chords("arc", arc)
        to.look(count)
        chains.append(outline("arc", arc)[1:] / scale)
    own = np.vstack(chains)
    return _chain(_flat([ocs.to_wcs((x, y, height)) for x, y in own.tolist()], scale))


def _lwpolyline(entity: Any, to: _DxfReading) -> Made:
    to.look(len(entity))
    corners = [(float(x), float(y), float(b)) for x, y, b in entity.get_points("xyb")]
    return _bulged(corners, bool(entity.closed), float(entity.dxf.elevation), entity.ocs(), to)


def _polyline(entity: Any, to: _DxfReading) -> Made:
    to.look(len(entity.vertices))
    if entity.is_3d_polyline:
        points = _flat([v.dxf.location for v in entity.vertices], to.scale)
        return _chain(np.vstack([points, points[:1]]) if entity.is_closed else points)
    if not entity.is_2d_polyline:
        return None
    corners = [
        (float(v.dxf.location[0]), float(v.dxf.location[1]), float(v.dxf.get("bulge", 0.0))) for v in entity.vertices
    ]
    height = float(entity.vertices[0].dxf.location[2]) if entity.vertices else 0.0
    return _bulged(corners, bool(entity.is_closed), height, entity.ocs(), to)


def _spline(entity: Any, to: _DxfReading) -> Made:
    if entity.control_point_count() == 0 and entity.fit_point_count() > MOST_FIT:
        raise to.refuse(
            f"it has a spline through {format_count(entity.fit_point_count())} points, at most "
            f"{format_count(MOST_FIT)} are read"
        )
    return _curve(entity, to)


def _curve(entity: Any, to: _DxfReading) -> Made:
    """An ellipse or a spline, in as many chords as ``CHORD_ERROR`` asks for."""
    points = []
    for p in entity.flattening(CHORD_ERROR / to.scale):
        points.append((p[0], p[1]))
        if len(points) > to.room:
            to.look(len(points))
    return _chain(np.array(points, dtype=float).reshape(-1, 2) * to.scale)


MAKERS: dict[str, Callable[[Any, _DxfReading], Made]] = {
    "LINE": _line,
    "CIRCLE": _circle,
    "ARC": _arc,
    "LWPOLYLINE": _lwpolyline,
    "POLYLINE": _polyline,
    "ELLIPSE": _curve,
    "SPLINE": _spline,
}
