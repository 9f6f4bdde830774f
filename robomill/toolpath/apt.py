"""APT-CL (cutter location) files: GOTO points with tool axes, as CAM systems write them before post-processing.

Read are GOTO, GODLTA, FROM (places, or points that POINT/ has named), INDIRV with TLON,GOFWD (CATIA's arcs), RAPID,
FEDRAT, SPINDL, LOADTL, LOAD/TOOL, TOOLNO, UNITS, UNIT, MULTAX, TLAXIS, CIRCLE, MOVARC, CYCLE, TRANS, MSYS, CSYS, DELAY
and FINI. What may move the tool in another way (TRACUT, RETRCT, GOFWD) is
refused; other words that move nothing are counted as ignored.
"""

import math
import re
from dataclasses import dataclass, field

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import GCodeError
from robomill.toolpath.apt_moves import (
    NUMBER,
    Arc,
    Drilling,
    arc_of,
    drilling_of,
    feed_of,
    frame_of,
    numbers_of,
    tangent_arc,
)
from robomill.toolpath.apt_statements import is_broken, statements_of, unit_of_feeds
from robomill.toolpath.arcs import MAX_POINTS
from robomill.toolpath.findings import NO_UNITS, UNITS_OF_FEED, Findings
from robomill.toolpath.path import Toolpath
from robomill.toolpath.text import Source, read_source
from robomill.toolpath.tools import MOST
from robomill.units import to_si

_MOVES = frozenset(
    (
        *("ARC", "INDIRP", "TLON", "TLLFT", "TLRGT", "THREAD", "RETRCT", "ROTATE", "ROTABL", "TRACUT", "COPY", "CALL"),
        *("LOOPST", "LOOPND", "JUMPTO", "IF", "TERMAC", "REPEAT"),
        *("MACRO", "GO", "HELIX", "NURBS", "SPLINE", "GOCLER", "GOLFT", "GORGT", "GOFWD", "GOBACK", "GOUP", "GODOWN"),
    )
)
_SILENT = frozenset(
    {
        *(
            "PARTNO",
            "PPRINT",
            "TPRINT",
            "REMARK",
            "INSERT",
            "MACHIN",
            "SEQNO",
            "LEADER",
            "FINI",
            "END",
            "STOP",
            "OPSTOP",
        ),
        *("COOLNT", "CUTTER", "SELCTL", "CATLOG", "TURRET", "PREFUN", "AUXFUN", "OPSKIP", "LOADTL", "TLDATA"),
        *("TOOL PATH", "END-OF-PATH", "LOAD", "CLAMP", "HEAD", "ARCSLP"),
        *("INTOL", "OUTTOL", "TOLER", "CLEARP", "DISPLY", "PAINT", "AUTOPS"),
    }
)
_RATES = ("IPR", "MMPR", "PERREV", "IPM", "MMPM", "PERMIN")
_INSERTED = re.compile(r"INSERT\b.*[XYZ]\s*[-+]?[.\d]")
_STANDS = "feed counts per turn, and the spindle stands; SPINDL comes first."


@dataclass
class _State:
    """What statements change. ``here`` is the last point as written; ``frame`` takes points into the first one."""

    unit: str = "mm"
    unit_said: str = ""
    rate: tuple[float, str, str] = (0.0, "PERMIN", "mm")  # as FEDRAT said it: how much, by what, in which unit
    speed: float = 0.0
    ccw: bool = False
    waited: float = 0.0
    tool: int = 0
    rapid: bool = False
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    here: tuple[float, ...] = ()
    shift: tuple[float, ...] = (0.0, 0.0, 0.0)
    first_frame: FloatArray | None = None
    frame: FloatArray | None = None
    arc: Arc | None = None
    tangent: FloatArray | None = None
    points: dict[str, list[str]] = field(default_factory=dict)
    drilling: Drilling | None = None
    rows: list[tuple[float, ...]] = field(default_factory=list)

    @property
    def feed(self) -> float:
        """m/s; one per turn follows the spindle, whichever of the two is said first."""
        return feed_of(*self.rate, self.speed)


_NAMES = re.compile(r"[A-Z]\w*\s*=.*")
_FORWARD = re.compile(r"TLON\s*,\s*GOFWD")


def read_apt(path_or_text: Source) -> Toolpath:
    """The toolpath of an APT-CL file: a path, its text or its bytes. Axes i, j, k become unit tool axes.

    The first point is the start. Raises GCodeError naming the line.
    """
    data, _ = read_source(path_or_text)
    state, findings = _State(), Findings()
    statements = statements_of(data.decode("utf-8", "replace"))
    by_feed = unit_of_feeds(statements)
    if by_feed:
        state.unit = state.unit_said = by_feed.unit
        text = f"no UNITS: lengths are taken as {by_feed.unit}, as the feed of line {by_feed.line} is in {by_feed.word}"
        findings.add(UNITS_OF_FEED, "suspicious" if by_feed.unit == "in" else "info", 0, text)
    for line, text in statements:
        word, _, rest = text.partition("/")
        word = word.strip().upper()
        values = [v.strip() for v in rest.split(",")] if rest.strip() else []
        _statement(state, findings, word, values, line)
        if len(state.rows) > MAX_POINTS:
            raise GCodeError.at(line, f"more than {MAX_POINTS} points; split the file.")
        if word == "FINI":
            break
    if len(state.rows) < 2:
        raise GCodeError("APT file: found fewer than two GOTO points; expected a path.")
    if not state.unit_said:
        findings.add(NO_UNITS, "suspicious", 0, "no UNITS: lengths are taken as mm")
    table = np.array(state.rows)
    still = np.flatnonzero((table[:, 7] > 0) & (table[:, 9] == 0.0))
    if len(still) and table[:, 9].any():
        text = "cuts with the spindle stopped; start it with SPINDL/ before"
        findings.add("spindle-stopped", "warning", int(table[still[0], 8]), text, len(still))
    return Toolpath(
        p=table[:, 0:3],
        k=table[:, 3:6],
        v_f=table[:, 6],
        cutting=table[:, 7] > 0,
        block=table[:, 8].astype(np.int64),
        n_s=table[:, 9],
        tool=table[:, 10].astype(np.int64),
        ccw=table[:, 11] > 0,
        dwell=table[:, 12],
        findings=findings.freeze(),
        units=state.unit,
    )


def _statement(state: _State, findings: Findings, word: str, values: list[str], line: int) -> None:
    if word in ("GOTO", "FROM"):
        _go(state, numbers_of(_placed(state, values, line), line, word), line, is_start=word == "FROM")
    elif _NAMES.fullmatch(word):
        _define(state, findings, word, values, line)
    elif word == "INDIRV":
        state.tangent = _tangent(values, line)
    elif _FORWARD.fullmatch(word):
        _along_circle(state, ",".join(values), line)
    elif word == "GODLTA":
        numbers = numbers_of(values, line, word)
        if len(numbers) == 1:  # along the tool
            numbers = [numbers[0] * part for part in state.axis]
        if len(numbers) != 3 or not state.rows:
            raise GCodeError.at(line, "GODLTA needs three steps, or one along the tool, and a point before it.")
        _go(state, [a + n for a, n in zip(state.here, numbers)], line)
    elif word == "RAPID":
        state.rapid = True
    elif word == "FEDRAT":
        _feed(state, values, line)
    elif word == "SPINDL":
        _spindle(state, values, line)
    elif word in ("UNITS", "UNIT"):
        _units(state, values, line)
    elif word == "DELAY":
        turns = "REV" in (v.upper() for v in values)
        count = sum(numbers_of([v for v in values if v.upper() != "REV"], line, word)[:1])
        state.waited += count if not turns else count / state.speed if state.speed > 0.0 else 0.0
    elif word in ("CIRCLE", "MOVARC"):
        state.arc = arc_of(values, state.unit, line)
    elif word == "CYCLE":
        state.drilling = drilling_of(values, state.unit, line)
        if state.drilling is not None and state.drilling.placed:
            text = "CYCLE/ has three numbers before their unit: they are taken as depth, clearance and feed"
            findings.add("cycle-places", "info", line, text)
    elif word in ("TLAXIS", "MULTAX"):
        _axis(state, findings, word, values, line)
    elif word in ("TRANS", "MSYS", "CSYS"):
        _frame(state, findings, word, values, line)
    elif word in _MOVES or any(part in _MOVES for part in word.split(",")):
        raise GCodeError.at(line, f"{word[:20]} moves the tool in a way that is not read; write GOTO points.")
    else:
        _other(state, findings, word, values, line)


def _placed(state: _State, values: list[str], line: int) -> list[str]:
    """The values of GOTO and FROM, with the places of a point that is called by its name."""
    name = values[0].upper() if values else ""
    if not name[:1].isalpha():
        return values
    if name not in state.points:
        raise GCodeError.at(line, f"GOTO has {name[:20]!r}, which no POINT/ before it has named; expected x,y,z.")
    return [*state.points[name], *values[1:]]


def _define(state: _State, findings: Findings, word: str, values: list[str], line: int) -> None:
    """P1=POINT/x,y,z names a point; other shapes move nothing by themselves."""
    name, _, kind = (part.strip() for part in word.partition("="))
    if kind == "POINT":
        numbers = numbers_of(values, line, "POINT")
        if len(numbers) not in (2, 3):
            raise GCodeError.at(line, f"POINT has {len(numbers)} numbers; expected x,y,z.")
        state.points[name] = [*values, "0"][:3]
        return
    if kind in _MOVES:
        raise GCodeError.at(line, f"{kind} moves the tool in a way that is not read; write GOTO points.")
    state.points.pop(name, None)
    findings.add("definition", "ignored", line, "definitions other than POINT move nothing and are left out")


def _tangent(values: list[str], line: int) -> FloatArray:
    numbers = numbers_of(values, line, "INDIRV")
    if len(numbers) != 3:
        raise GCodeError.at(line, f"INDIRV has {len(numbers)} numbers; expected a direction i,j,k.")
    return np.array(_direction(numbers, line, "the direction of INDIRV"))


def _along_circle(state: _State, text: str, line: int) -> None:
    """TLON,GOFWD: along a circle from where the tool is, in the direction that INDIRV has said."""
    tangent, state.tangent = state.tangent, None
    if tangent is None or not state.here:
        raise GCodeError.at(line, "TLON,GOFWD needs INDIRV/i,j,k and a point before it, where its arc begins.")
    start = np.array([to_si(v, state.unit) for v in state.here])
    state.arc, end = tangent_arc(text, tangent, start, state.unit, line)
    _go(state, end, line)


def _other(state: _State, findings: Findings, word: str, values: list[str], line: int) -> None:
    """Statements that move nothing by themselves."""
    if word in ("LOADTL", "TOOLNO", "LOAD"):
        if word == "LOAD" and values[:1] and values[0].upper() != "TOOL":
            return
        numbers = [v for v in values if NUMBER.match(v)]
        if values and not numbers:
            raise GCodeError.at(line, f"{word} has {values[0]!r}; expected a number.")
        state.tool = int(min(abs(numbers_of(numbers[:1], line, word)[0]), MOST)) if numbers else state.tool
    elif word == "GOHOME":
        state.rapid = True
        findings.add("home", "info", line, "GOHOME is left out: where the machine's home lies is not known here")
    elif word == "MODE":
        if "INCR" in (v.upper() for v in values):
            text = "MODE/INCR says how a post-processor writes coordinates: GOTO points are places all the same"
            findings.add("mode-incr", "warning", line, text)
    elif word == "CUTCOM" and values[:1] and values[0].upper() in ("LEFT", "RIGHT", "ON"):
        findings.add("cutcom", "warning", line, "CUTCOM is left out: points are taken as those of the tool's centre")
    elif _INSERTED.match(word):
        findings.add("insert", "warning", line, f"{word[:40]!r} is the machine's own code, which is left out")
    elif word == "ORIGIN" and any(numbers_of(values, line, word)):
        findings.add("origin", "info", line, "ORIGIN is left out: points count from where the file counts them")
    elif is_broken(word):
        text = (
            f"found {word[:40]!r}, which may move the tool; write each statement in a line of its own, as GOTO/x,y,z."
        )
        raise GCodeError.at(line, text)
    elif word not in ("CUTCOM", "ORIGIN") and _SILENT.isdisjoint((word, word.split(" ")[0])):
        findings.add("unknown-word", "ignored", line, f"{word[:20]} is not known and is left out")


def _axis(state: _State, findings: Findings, word: str, values: list[str], line: int) -> None:
    """TLAXIS/i,j,k is the tool axis from here on; with MULTAX/OFF the last one stays."""
    if word == "MULTAX":
        if values and values[0].upper() == "OFF" and math.dist(state.axis, (0.0, 0.0, 1.0)) > 1e-6:
            text = "MULTAX/OFF keeps the last tool axis, which is not Z; write TLAXIS/0,0,1 after it where Z is meant"
            findings.add("axis-kept", "warning", line, text)
        return
    numbers = numbers_of(values, line, word)
    if len(numbers) != 3:
        raise GCodeError.at(line, f"TLAXIS has {len(numbers)} numbers; expected a direction i,j,k.")
    state.axis = _direction(numbers, line)


def _frame(state: _State, findings: Findings, word: str, values: list[str], line: int) -> None:
    if word == "TRANS":
        numbers = numbers_of(values, line, word)
        if len(numbers) not in (1, 2, 3):
            raise GCodeError.at(line, f"TRANS has {len(numbers)} numbers; expected a shift x,y,z.")
        state.shift = tuple(to_si(v, state.unit) for v in [*numbers, 0.0, 0.0][:3])
        if any(state.shift):
            findings.add("trans", "warning", line, "TRANS shifts the points behind it, as a post-processor does")
        return
    found = frame_of(values, word, state.unit, line)
    if state.first_frame is None and not state.rows:
        state.first_frame = found
        if not np.allclose(found, np.eye(4), atol=1e-9):
            findings.add("frame", "info", line, f"part zero is that of {word}/, in which the points are given")
        return
    first = np.eye(4) if state.first_frame is None else state.first_frame
    state.frame = None if np.allclose(found, first, atol=1e-9) else np.linalg.inv(first) @ found
    if state.frame is not None:
        findings.add("frame", "warning", line, f"{word}/ is another one: its points are taken into the first {word}/")


def _direction(numbers: list[float], line: int, what: str = "the tool axis") -> tuple[float, float, float]:
    size = math.sqrt(sum(v * v for v in numbers))
    if size < 1e-9:
        raise GCodeError.at(line, f"{what} i,j,k is 0; expected a direction.")
    return numbers[0] / size, numbers[1] / size, numbers[2] / size


def _go(state: _State, numbers: list[float], line: int, is_start: bool = False) -> None:
    if len(numbers) not in (3, 6):
        raise GCodeError.at(line, f"found {len(numbers)} numbers; a point has x,y,z or x,y,z,i,j,k.")
    if len(numbers) == 6:
        state.axis = _direction(numbers[3:], line)
    before, state.here = state.here, tuple(numbers[:3])
    point = np.array([to_si(v, state.unit) for v in numbers[:3]])
    arc, state.arc = state.arc, None
    if state.drilling is not None and not is_start:
        axis, down = np.array(state.axis), feed_of(*state.drilling.rate, state.speed)
        if down <= 0.0:
            raise GCodeError.at(line, f"the cycle's {_STANDS}")
        above = float((_stands(state) - point) @ axis) if state.rows else 0.0
        if above > state.drilling.out:
            _put(state, point + above * axis, 0.0, line)
        for height, feed, dwell in state.drilling.moves(down):
            state.waited += dwell
            _put(state, point + height * axis, feed, line)
        state.rapid = False
        return
    cutting = bool(state.rows) and not state.rapid and not is_start
    if cutting and state.feed <= 0:
        turns = state.rate[0] > 0.0
        raise GCodeError.at(line, f"its {_STANDS}" if turns else "a cut needs a feed; FEDRAT comes first.")
    feed = state.feed if cutting else 0.0
    points = [point]
    if arc is not None and before and not is_start:
        points = list(arc.points(np.array([to_si(v, state.unit) for v in before]), point, line))
    for each in points:
        _put(state, each, feed, line)
    state.rapid = False


def _stands(state: _State) -> FloatArray:
    """Where the tool is, which a cycle leaves above its point: (3,) m, as points are written now."""
    place = np.array(state.rows[-1][:3]) - state.shift
    return place if state.frame is None else state.frame[:3, :3].T @ (place - state.frame[:3, 3])


def _put(state: _State, point: FloatArray, feed: float, line: int) -> None:
    """A point as it is written becomes one of the path: shifted (TRANS), and in the first coordinate system."""
    axis = np.array(state.axis)
    if state.frame is not None:
        point, axis = state.frame[:3, :3] @ point + state.frame[:3, 3], state.frame[:3, :3] @ axis
    place = [float(v + s) for v, s in zip(point, state.shift)]
    turning = (state.speed, state.tool, state.ccw and state.speed > 0.0)
    if feed == 0.0 and state.rows and state.rows[-1][:6] == (*place, *map(float, axis)) and state.drilling is not None:
        return
    state.rows.append((*place, *map(float, axis), feed, feed > 0.0, line, *turning, state.waited))
    state.waited = 0.0


def _feed(state: _State, values: list[str], line: int) -> None:
    words = [v.upper() for v in values]
    numbers = [v for v in values if NUMBER.match(v)]
    if "RAPID" in words:
        state.rapid = True
        return
    if len(numbers) != 1 or float(numbers[0]) < 0:
        raise GCodeError.at(line, f"FEDRAT has {','.join(values)!r}; expected one rate of 0 or more.")
    units = [w for w in words if w not in numbers]
    if units and not any(w in _RATES for w in units):
        text = f"FEDRAT counts by {units[0]:.20}, which is not read; write the feed per minute (MMPM, IPM)."
        raise GCodeError.at(line, text)
    unit = next((w for w in _RATES if w in units), "PERMIN")
    state.rate = float(numbers[0]), unit, state.unit


def _spindle(state: _State, values: list[str], line: int) -> None:
    words = [v.upper() for v in values]
    numbers = [v for v in values if NUMBER.match(v)]
    if "OFF" in words:
        state.speed = 0.0
        return
    if surface := [w for w in words if w in ("SFM", "SMM")]:
        text = f"SPINDL/{surface[0]} says the speed of the surface; expected turns per minute, as SPINDL/RPM,900."
        raise GCodeError.at(line, text)
    if "CLW" in words or "CCLW" in words:
        state.ccw = "CCLW" in words
    if numbers:
        state.speed = to_si(abs(float(numbers[0])), "1/min")
    elif not any(w in words for w in ("ON", "CLW", "CCLW")):
        raise GCodeError.at(line, f"SPINDL has {','.join(values)!r}; expected a speed or OFF.")


def _units(state: _State, values: list[str], line: int) -> None:
    found = values[0].upper() if values else ""
    unit = {"MM": "mm", "METRIC": "mm", "MILLIMETERS": "mm", "INCH": "in", "INCHES": "in", "IN": "in"}.get(found)
    if unit is None:
        raise GCodeError.at(line, f"UNITS has {found!r}; expected MM or INCHES.")
    ratio = to_si(1.0, state.unit) / to_si(1.0, unit)  # what was written before stays where it is
    state.here = tuple(v * ratio for v in state.here)
    state.points = {name: [str(float(v) * ratio) for v in place] for name, place in state.points.items()}
    state.unit = state.unit_said = unit
