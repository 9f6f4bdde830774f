"""APT-CL (cutter location) files: GOTO points with tool axes, as CAM systems write them before post-processing.

Read are GOTO, GODLTA, FROM, RAPID, FEDRAT, SPINDL, LOADTL, UNITS, MULTAX, CUTTER, PARTNO, PPRINT, COOLNT, TOOLNO,
END and FINI. What may move the tool in another way (CIRCLE after a MOVARC, CYCLE, GOHOME) is refused; other words
that move nothing are counted as ignored.
"""

import math
import re
from dataclasses import dataclass, field

import numpy as np

from robomill.errors import GCodeError
from robomill.toolpath.gcode.findings import NO_UNITS, Findings
from robomill.toolpath.path import Toolpath
from robomill.toolpath.text import Source, read_source
from robomill.units import to_si

_NUMBER = re.compile(r"[-+]?(?:\d++\.?+\d*+|\.\d++)(?:[eE][-+]?\d++)?+$")  # of any length at once: it never goes back
_MOVES = frozenset(
    {
        *("CIRCLE", "MOVARC", "ARC", "INDIRV", "INDIRP", "THREAD", "CYCLE", "GOHOME", "RETRCT"),
        *("GOCLER", "GOLFT", "GORGT", "GOFWD", "GOBACK", "GOUP", "GODOWN"),
        *("ROTATE", "ROTABL", "TRACUT", "COPY", "CALL", "MACRO"),
    }
)
_SILENT = frozenset(
    {
        *("PARTNO", "PPRINT", "REMARK", "INSERT", "MACHIN", "SEQNO", "LEADER", "FINI", "END", "STOP", "OPSTOP"),
        *("COOLNT", "CUTTER", "SELCTL", "CATLOG", "TURRET", "PREFUN", "AUXFUN", "TLAXIS", "ORIGIN"),
        *("INTOL", "OUTTOL", "TOLER", "CLEARP", "DISPLY", "PAINT"),
    }
)
MAX_POINTS = 5_000_000


@dataclass
class _State:
    unit: str = "mm"
    unit_said: str = ""
    feed: float = 0.0
    speed: float = 0.0
    ccw: bool = False
    waited: float = 0.0
    tool: int = 0
    rapid: bool = False
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    rows: list[tuple[float, ...]] = field(default_factory=list)


_GOTO = re.compile(rb"^[ \t]*(?:GOTO|FROM)[ \t]*/", re.IGNORECASE | re.MULTILINE)


def is_apt(data: bytes) -> bool:
    """True if the bytes of a file look like APT-CL (a GOTO/ or FROM/ statement near the start)."""
    return _GOTO.search(data[:200_000]) is not None


def read_apt(path_or_text: Source) -> Toolpath:
    """The toolpath of an APT-CL file: a path, its text or its bytes. Axes i, j, k become unit tool axes.

    The first point is the start. Raises GCodeError naming the line.
    """
    data, _ = read_source(path_or_text)
    state, findings = _State(), Findings()
    for line, text in _statements(data.decode("utf-8", "replace")):
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


def _statements(text: str) -> list[tuple[int, str]]:
    """Statements with the line where each starts: ``$$`` begins a comment, ``$`` at the end goes on below."""
    out: list[tuple[int, str]] = []
    pending, start = "", 0
    for number, raw in enumerate(text.split("\n"), 1):
        code = raw.split("$$")[0].strip()
        if not code:
            continue
        start = start or number
        if code.endswith("$"):
            pending += code[:-1]
            continue
        out.append((start, pending + code))
        pending, start = "", 0
    if pending:
        out.append((start, pending))
    return out


def _numbers(values: list[str], line: int, word: str) -> list[float]:
    if not all(_NUMBER.match(v) for v in values):
        bad = next(v for v in values if not _NUMBER.match(v))
        raise GCodeError.at(line, f"{word} has {bad!r}; expected a number.")
    numbers = [float(v) for v in values]
    if not all(math.isfinite(n) for n in numbers):
        raise GCodeError.at(line, f"{word} has a number that is too large.")
    return numbers


def _statement(state: _State, findings: Findings, word: str, values: list[str], line: int) -> None:
    if word in ("GOTO", "FROM"):
        _go(state, _numbers(values, line, word), line, is_start=word == "FROM")
    elif word == "GODLTA":
        numbers = _numbers(values, line, word)
        if len(numbers) != 3 or not state.rows:
            raise GCodeError.at(line, "GODLTA needs three steps and a point before it.")
        at = [float(v) / to_si(1.0, state.unit) for v in state.rows[-1][:3]]
        _go(state, [a + n for a, n in zip(at, numbers)], line)
    elif word == "RAPID":
        state.rapid = True
    elif word == "FEDRAT":
        _feed(state, values, line)
    elif word == "SPINDL":
        _spindle(state, values, line)
    elif word == "UNITS":
        _units(state, values, line)
    elif word in ("LOADTL", "TOOLNO"):
        state.tool = int(abs(_numbers(values[:1], line, word)[0])) if values else state.tool
    elif word == "DELAY":
        turns = "REV" in (v.upper() for v in values)
        count = sum(_numbers([v for v in values if v.upper() != "REV"], line, word)[:1])
        state.waited += count if not turns else count / state.speed if state.speed > 0.0 else 0.0
    elif word == "MULTAX":
        state.axis = state.axis if not values or values[0].upper() == "ON" else (0.0, 0.0, 1.0)
    elif word in _MOVES:
        raise GCodeError.at(line, f"{word} moves the tool in a way that is not read; write GOTO points.")
    elif word not in _SILENT:
        findings.add("unknown-word", "ignored", line, f"{word[:20]} is not known and is left out")


def _go(state: _State, numbers: list[float], line: int, is_start: bool = False) -> None:
    if len(numbers) not in (3, 6):
        raise GCodeError.at(line, f"found {len(numbers)} numbers; a point has x,y,z or x,y,z,i,j,k.")
    if len(numbers) == 6:
        size = math.sqrt(sum(v * v for v in numbers[3:]))
        if size < 1e-9:
            raise GCodeError.at(line, "the tool axis i,j,k is 0; expected a direction.")
        state.axis = (numbers[3] / size, numbers[4] / size, numbers[5] / size)
    cutting = bool(state.rows) and not state.rapid and not is_start
    if cutting and state.feed <= 0:
        raise GCodeError.at(line, "a cut needs a feed; FEDRAT comes first.")
    point = [to_si(v, state.unit) for v in numbers[:3]]
    feed = state.feed if cutting else 0.0
    turning = (state.speed, state.tool, state.ccw and state.speed > 0.0)
    state.rows.append((*point, *state.axis, feed, cutting, line, *turning, state.waited))
    state.rapid, state.waited = False, 0.0


def _feed(state: _State, values: list[str], line: int) -> None:
    words = [v.upper() for v in values]
    numbers = [v for v in values if _NUMBER.match(v)]
    if "RAPID" in words:
        state.rapid = True
        return
    if len(numbers) != 1 or float(numbers[0]) < 0:
        raise GCodeError.at(line, f"FEDRAT has {','.join(values)!r}; expected one rate of 0 or more.")
    if any(w in words for w in ("IPR", "MMPR", "PERREV")):
        unit = "in" if "IPR" in words else "mm" if "MMPR" in words else state.unit
        state.feed = to_si(float(numbers[0]), unit) * state.speed
        return
    unit = "in/min" if "IPM" in words else "mm/min" if "MMPM" in words else f"{state.unit}/min"
    state.feed = to_si(float(numbers[0]), unit)


def _spindle(state: _State, values: list[str], line: int) -> None:
    words = [v.upper() for v in values]
    numbers = [v for v in values if _NUMBER.match(v)]
    if "OFF" in words:
        state.speed = 0.0
        return
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
    state.unit = state.unit_said = unit
