"""Arcs, drilling cycles and coordinate systems of APT-CL files, each a value that says where the tool goes (m).

Vendors write the words of a cycle in two ways (ISO 4343:1978 by place, ISO 4343:2000 and NX by name); both are read:

    CYCLE/DRILL, 20, MMPM, 100, 2                      CYCLE/DRILL, DEPTH, 20, MMPM, 100, CLEAR, 2
    CYCLE/DRILL, 20, 100, MMPM, 2                      CYCLE/DEEP, FEDTO, -20, MMPM, 100, RAPTO, 2, STEP, 5
    CYCLE/DRILL, 20, 2, 100, MMPM

The last one is CATIA's, whose tables of words put the total depth before the clearance at the tip, and a feed before
its unit (Dassault Systemes, PP Tables and Word Syntaxes).
SolidWorks CAM begins cycles with CYCLE/INIT, pecks with CYCLE/DEEP2, ..., 1STPECK, 5, SUBPECK, 2, and leaves the radius
of arcs to the point where they begin.
"""

import math
import re
from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import GCodeError
from robomill.toolpath.arcs import CHORD_ERROR, chord_ends, turn_counts
from robomill.units import format_si, to_si

NUMBER = re.compile(r"[-+]?(?:\d++\.?+\d*+|\.\d++)(?:[eE][-+]?\d++)?+$")  # of any length at once: it never goes back
_FEED_UNITS = ("MMPM", "IPM", "PERMIN", "MMPR", "IPR", "PERREV", "PITCH")
_NAMED = frozenset(
    (
        *(
            "DEPTH",
            "FEDTO",
            "CLEAR",
            "RAPTO",
            "RTRCTO",
            "RETURN",
            "STEP",
            "STEP1",
            "1STPECK",
            "SUBPECK",
            "DWELL",
            "ORIENT",
        ),
        *("ORIANT", *_FEED_UNITS),
    )
)
"""Words of a cycle that a number follows."""
_KINDS = frozenset(["DRILL", "FACE", "CSINK", "REAM", "BORE", "TAP", "DEEP", "DEEP2", "BRKCHP", "THRU"])
_OUT_AT_FEED = frozenset({"REAM", "BORE", "TAP"})
OFF_CIRCLE = 1e-3
"""Start and end of an arc may be off its radius by this share, or"""
OFF_CIRCLE_LEAST = 2e-5  # m
MAX_PECKS = 10_000
MAX_TURNS = 10_000


@dataclass(frozen=True)
class Arc:
    """An arc about ``axis`` (unit vector), counter-clockwise as seen from its tip; ``angle`` (rad) where it is said.

    A ``radius`` of None is that of the point where the arc begins.
    """

    centre: FloatArray
    axis: FloatArray
    radius: float | None
    angle: float | None
    turns: int

    def points(self, start: FloatArray, end: FloatArray, line: int) -> FloatArray:
        """Chords (n, 3) from ``start`` (left out) to ``end``, climbing along the axis; refused off its circle."""
        out, along = [], []
        for point in (start, end):
            height = float((point - self.centre) @ self.axis)
            out.append(point - self.centre - height * self.axis)
            along.append(height)
        sizes = [float(np.linalg.norm(v)) for v in out]
        radius = sizes[0] if self.radius is None else self.radius
        if max(abs(size - radius) for size in sizes) > max(OFF_CIRCLE * radius, OFF_CIRCLE_LEAST) or radius <= 0.0:
            shown = " and ".join(format_si(size, "mm", 4) for size in sizes)
            meant = "one radius" if self.radius is None else f"its radius, {format_si(self.radius, 'mm', 4)}"
            raise GCodeError.at(line, f"the arc's ends lie {shown} from its centre; expected {meant}.")
        cross = float(np.cross(out[0], out[1]) @ self.axis)
        sweep = math.atan2(cross, float(out[0] @ out[1])) % (2.0 * math.pi)
        if sweep < 1e-8 or 2.0 * math.pi - sweep < 1e-8:
            sweep = 2.0 * math.pi
        sweep = self._turned(sweep + 2.0 * math.pi * (self.turns - 1), line)
        first = np.cross(self.axis, np.eye(3)[np.argmin(np.abs(self.axis))])
        first /= np.linalg.norm(first)
        across = np.cross(self.axis, first)
        begin, turn = math.atan2(float(out[0] @ across), float(out[0] @ first)), np.array([sweep])
        t = chord_ends(np.array([begin]), turn, turn_counts(turn, np.array([radius]), CHORD_ERROR))[1][:, None]
        angle = begin + t * sweep
        size = sizes[0] + t * (sizes[1] - sizes[0])
        level = along[0] + t * (along[1] - along[0])
        points = self.centre + size * (np.cos(angle) * first + np.sin(angle) * across) + level * self.axis
        points[-1] = end
        return np.asarray(points)

    def _turned(self, sweep: float, line: int) -> float:
        """The signed angle: as it is said, where that leads to the end on either side, be it by whole turns more."""
        if self.angle is None:
            return sweep
        for signed in (sweep, sweep - 2.0 * math.pi if sweep < 2.0 * math.pi else -sweep):
            more = round((abs(self.angle) - abs(signed)) / (2.0 * math.pi))
            size = abs(signed) + 2.0 * math.pi * more
            if 0 <= more < MAX_TURNS and abs(size - abs(self.angle)) < math.radians(0.5):
                return math.copysign(size, signed)
        text = f"the arc turns by {math.degrees(self.angle):g} degrees, which does not lead to its end; mend the file."
        raise GCodeError.at(line, text)


def arc_of(values: list[str], unit: str, line: int) -> Arc:
    """CIRCLE/, MOVARC/ x,y,z, i,j,k [, r] [, ...] [, ANGLE, degrees] [, TIMES, n]; also with CENTER, AXIS, RADIUS."""
    words = [v for v in values if v.upper() not in ("CENTER", "AXIS", "RADIUS")]
    named = {words[i].upper(): words[i + 1] for i in range(len(words) - 1) if words[i].upper() in ("ANGLE", "TIMES")}
    count = next((i for i, v in enumerate(words) if v.upper() in ("ANGLE", "TIMES")), len(words))
    numbers = _floats(words[:count], line)
    if len(numbers) < 6:
        raise GCodeError.at(line, "an arc needs its centre, axis and radius: x,y,z,i,j,k,r.")
    size = math.sqrt(sum(v * v for v in numbers[3:6]))
    if size < 1e-9 or (len(numbers) > 6 and numbers[6] <= 0.0):
        raise GCodeError.at(line, "an arc needs an axis i,j,k and a radius above 0.")
    angle = math.radians(_floats([named["ANGLE"]], line)[0]) if "ANGLE" in named else None
    turns = round(_floats([named["TIMES"]], line)[0]) if "TIMES" in named else 1
    if not 1 <= turns <= MAX_TURNS:
        raise GCodeError.at(line, f"an arc turns {turns} times; expected 1 to {MAX_TURNS}.")
    centre = np.array([to_si(v, unit) for v in numbers[:3]])
    radius = to_si(numbers[6], unit) if len(numbers) > 6 else None
    return Arc(centre, np.array(numbers[3:6]) / size, radius, angle, turns)


_CATIA = re.compile(
    r"\(\s*CIRCLE\s*/([^()]*)\)\s*,\s*ON\s*(?:,\s*2\s*,\s*INTOF\s*)?,\s*\(\s*LINE\s*/([^()]*)\)\s*", re.IGNORECASE
)


def tangent_arc(text: str, tangent: FloatArray, start: FloatArray, unit: str, line: int) -> tuple[Arc, list[float]]:
    """TLON,GOFWD/ (CIRCLE/ x,y,z,r),ON,(LINE/ centre, end), as CATIA writes arcs: the arc, and its end as written.

    It leaves ``start`` (m) along ``tangent``; "2,INTOF": the line meets the circle once before that.
    """
    found = _CATIA.fullmatch(text.strip())
    if found is None:
        shown = " ".join(text.split())[:40]
        expected = "expected (CIRCLE/x,y,z,r),ON,(LINE/x,y,z,x,y,z), or GOTO points"
        raise GCodeError.at(line, f"TLON,GOFWD has {shown!r}, which is not read; {expected}.")
    circle, ray = (_floats([v.strip() for v in each.split(",")], line) for each in found.groups())
    if len(circle) != 4 or len(ray) != 6 or circle[3] <= 0.0:
        raise GCodeError.at(line, "an arc of TLON needs CIRCLE/x,y,z,r, and LINE/ with its centre and its end.")
    centre = np.array([to_si(v, unit) for v in circle[:3]])
    axis = np.cross(start - centre, tangent)
    size, radius = float(np.linalg.norm(axis)), to_si(circle[3], unit)
    straight = float(np.linalg.norm(tangent)) * radius
    if abs((start - centre) @ tangent) > 0.02 * straight or size < 0.5 * straight:
        raise GCodeError.at(line, "INDIRV is not along the circle where the tool stands; expected its tangent there.")
    return Arc(centre, axis / size, radius, None, 1), ray[3:]


@dataclass(frozen=True)
class Drilling:
    """A cycle that each point is drilled with: lengths (m) from the point along the tool, dwell in s.

    ``rate`` is its feed as the cycle says it: how much, by what, in which unit (see ``feed_of``); ``placed`` where that
    and the lengths stand without a word, the unit last.
    """

    depth: float
    rate: tuple[float, str, str]
    clear: float
    out: float
    first: float
    step: float
    dwell: float
    feed_out: bool
    placed: bool = False

    def moves(self, feed: float) -> list[tuple[float, float, float]]:
        """(height above the point, feed, dwell before), in order, at a ``feed`` (m/s); a feed of 0 is a rapid."""
        moves = [(self.out, 0.0, 0.0), (self.clear, 0.0, 0.0)]
        if self.step > 0.0:
            pecks = math.ceil((self.clear + self.depth - self.first) / self.step - 1e-9) + 1
            for peck in range(min(pecks, MAX_PECKS) - 1):
                down = self.clear - self.first - peck * self.step
                moves += [(down, feed, 0.0), (self.clear, 0.0, 0.0), (down, 0.0, 0.0)]
        moves.append((-self.depth, feed, 0.0))
        moves.append((self.clear, feed if self.feed_out else 0.0, self.dwell))
        return [*moves, (self.out, 0.0, 0.0)]


def drilling_of(values: list[str], unit: str, line: int) -> Drilling | None:
    """CYCLE/...; None for OFF and INIT. Raises GCodeError for what is not read."""
    words = [v.upper() for v in values]
    if words[:1] in (["OFF"], ["NOMORE"], ["INIT"]):
        return None
    kinds = [word for word in words if word in _KINDS]
    if not kinds or words[0] not in _KINDS:
        found = words[0] if words else "nothing"
        raise GCodeError.at(line, f"CYCLE/{found[:20]} is not read; expected DRILL, DEEP, FACE, REAM, BORE or TAP.")
    named, places = _said_of([word for word in words if word not in _KINDS], words[0], line)
    depth = abs(named.get("DEPTH", named.get("FEDTO", places[0])))
    clear = named.get("CLEAR", places[0] if ("DEPTH" in named or "FEDTO" in named) else places[1])
    clear, rapid = (0.0 if math.isnan(clear) else clear), named.get("RAPTO", 0.0)
    feeds = [word for word in _FEED_UNITS if word in named]
    if math.isnan(depth) or depth <= 0.0 or len(feeds) != 1 or named[feeds[0]] <= 0.0:
        text = f"CYCLE/{words[0]} needs its depth and its feed, as in CYCLE/DRILL,DEPTH,20,MMPM,100,CLEAR,2."
        raise GCodeError.at(line, text)
    near = max(rapid, clear - rapid, 0.0)
    away = max(near, clear, named.get("RTRCTO", 0.0), named.get("RETURN", 0.0))
    step = max(named.get("STEP", named.get("STEP1", named.get("SUBPECK", 0.0))), 0.0)
    first = max(named.get("1STPECK", step), 0.0) or step
    down, near, away, first, step = (to_si(v, unit) for v in (depth, near, away, first, step))
    rate = named[feeds[0]], feeds[0], unit
    leaves = bool(_OUT_AT_FEED & set(kinds))
    placed = _rate_behind(words)
    return Drilling(down, rate, near, away, first, step, max(named.get("DWELL", 0.0), 0.0), leaves, placed)


def _rate_behind(words: list[str]) -> bool:
    """Whether three numbers stand before their unit: depth, clearance and feed."""
    numbers = [bool(NUMBER.match(word)) for word in words if word not in _KINDS]
    units = [word in _FEED_UNITS for word in words if word not in _KINDS]
    return numbers[:3] == [True] * 3 and units[3:4] == [True]


def _said_of(words: list[str], kind: str, line: int) -> tuple[dict[str, float], list[float]]:
    """The numbers of a cycle: those that stand behind their word, and two by place (depth, clearance; NaN for none)."""
    named: dict[str, float] = {}
    places: list[float] = []
    rest = iter(words)
    for word in rest:
        if word in _FEED_UNITS and (len(places) == 2 or _rate_behind(words)) and not named:  # its rate stands before it
            named[word] = places.pop()
        elif word in _NAMED:
            value = next(rest, "")
            if word in named:
                text = f"CYCLE/{kind} gives {word} more than once (a table of pecks), which is not read"
                raise GCodeError.at(line, f"{text}; let the CAM system write GOTO.")
            if value != "AUTO":
                named[word] = numbers_of([value], line, f"CYCLE/{kind} {word}")[0]
        elif NUMBER.match(word):
            places.append(float(word))
        else:
            raise GCodeError.at(
                line, f"CYCLE/{kind} has {word[:20]!r}, which is not read; let the CAM system write GOTO."
            )
    if len(places) > 2:
        text = f"CYCLE/{kind} has {len(places)} numbers without a word; expected DEPTH, CLEAR and so on before them."
        raise GCodeError.at(line, text)
    return named, [*places, math.nan, math.nan][:2]


def feed_of(rate: float, word: str, unit: str, speed: float) -> float:
    """A feed rate in m/s; ``word`` is its unit (IPM, MMPM, IPR, MMPR; PERMIN, PERREV and PITCH count in ``unit``)."""
    if word in ("IPR", "MMPR", "PERREV", "PITCH"):
        return to_si(rate, {"IPR": "in", "MMPR": "mm"}.get(word, unit)) * speed
    return to_si(rate, {"IPM": "in/min", "MMPM": "mm/min"}.get(word, f"{unit}/min"))


def frame_of(values: list[str], word: str, unit: str, line: int) -> FloatArray:
    """T (4, 4), m: where the coordinate system of MSYS/ (origin, x axis, y axis) or CSYS/ (three rows of four) lies."""
    numbers = _floats(values, line)
    T = np.eye(4)
    if word == "CSYS" and len(numbers) == 12:
        T[:3] = np.reshape(numbers, (3, 4))
    elif word == "MSYS" and len(numbers) >= 9:
        T[:3, 0], T[:3, 1], T[:3, 3] = numbers[3:6], numbers[6:9], numbers[:3]
        T[:3, 2] = np.cross(*np.clip(T[:3, :2].T, -2.0, 2.0))  # what is larger is refused, and would overflow
    else:
        text = f"{word} has {len(numbers)} numbers; expected 12 (CSYS) or an origin and two axes (MSYS)."
        raise GCodeError.at(line, text)
    if np.abs(T[:3, :3]).max() > 2.0 or not np.allclose(T[:3, :3].T @ T[:3, :3], np.eye(3), atol=1e-4):
        raise GCodeError.at(line, f"the axes of {word} are not at right angles and of length 1; mend the file.")
    T[:3, 3] = [to_si(float(v), unit) for v in T[:3, 3]]
    return T


def numbers_of(values: list[str], line: int, word: str) -> list[float]:
    """The values as numbers. Raises GCodeError naming the line and the word."""
    if not all(NUMBER.match(v) for v in values):
        bad = next(v for v in values if not NUMBER.match(v))
        raise GCodeError.at(line, f"{word} has {bad!r}; expected a number.")
    numbers = [float(v) for v in values]
    if not all(math.isfinite(n) for n in numbers):
        raise GCodeError.at(line, f"{word} has a number that is too large.")
    return numbers


def _floats(values: list[str], line: int) -> list[float]:
    return numbers_of(values, line, "the statement")
