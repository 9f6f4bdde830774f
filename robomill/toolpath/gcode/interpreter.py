"""Programs of straight moves: G0, G1, G20, G21, G90, G91, F, S, T, comments and line numbers (more follows)."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np

from robomill.errors import GCodeError
from robomill.toolpath.gcode.arcs import CHORD_ERROR
from robomill.toolpath.gcode.program import FEED, TRAVERSE, Program
from robomill.toolpath.gcode.source import Source, read_source
from robomill.toolpath.path import Finding, Toolpath
from robomill.units import to_si

_WORD = re.compile(r"([A-Za-z])([-+]?(?:\d+\.?\d*|\.\d+))")
_COMMENT = re.compile(r"\([^)]*\)|;.*")


def read_gcode(
    path_or_text: Source,
    *,
    chord_error: float = CHORD_ERROR,
    dialect: str = "auto",
    tools: Any = None,
    progress: Callable[[float], None] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> Toolpath:
    """The toolpath of a program, arcs as chords within ``chord_error`` (m). Raises GCodeError with its line."""
    program = interpret(path_or_text, dialect=dialect, tools=tools, progress=progress, cancel=cancel)
    return program.toolpath(chord_error)


def interpret(
    source: Source,
    *,
    dialect: str = "auto",
    tools: Any = None,
    progress: Callable[[float], None] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> Program:
    """Canonical moves of a program. Raises GCodeError with the line that is refused."""
    data, _ = read_source(source)
    unit, units, absolute, motion = "mm", "", True, -1
    feed = speed = 0.0
    position = np.zeros(3)
    spindle, tool, selected = False, 0, 0
    rows: list[tuple[Any, ...]] = []
    for number, raw in enumerate(data.decode("utf-8", "replace").split("\n"), 1):
        text = _COMMENT.sub("", raw).replace(" ", "").replace("\t", "").strip()
        if not text or text.startswith("%"):
            continue
        axes: dict[int, float] = {}
        at = 0
        while at < len(text):
            word = _WORD.match(text, at)
            if word is None:
                raise GCodeError(f"Line {number}: expected a word such as X12.5, found {text[at:]!r:.30}.", line=number)
            at = word.end()
            letter, value = word[1].upper(), float(word[2])
            if letter == "G" and value in (0, 1):
                motion = int(value)
            elif letter == "G" and value in (20, 21):
                unit = units = "in" if value == 20 else "mm"
            elif letter == "G" and value in (90, 91):
                absolute = value == 90
            elif letter == "M" and value in (3, 4, 5):
                spindle = value != 5
            elif letter == "M" and value == 6:
                tool = selected
            elif letter == "F":
                feed = value
            elif letter == "S":
                speed = value
            elif letter == "T":
                selected = int(value)
            elif letter in "XYZ":
                axes["XYZ".index(letter)] = value
            elif letter != "N" and not (letter == "G" and value in (17, 40, 49, 54, 64, 80, 94)) and letter != "M":
                raise GCodeError(f"Line {number}: {word[0]} is not supported yet.", line=number)
        if axes:
            if motion < 0:
                raise GCodeError(f"Line {number}: axis words need G0 or G1 first.", line=number)
            if motion == 1 and feed <= 0:
                raise GCodeError(f"Line {number}: G1 needs a feed rate F above 0.", line=number)
            end = position.copy()
            for axis, value in axes.items():
                end[axis] = to_si(value, unit) + (0.0 if absolute else position[axis])
            v_f = to_si(feed, f"{unit}/min") if motion else 0.0
            rows.append((number, FEED if motion else TRAVERSE, position, end, v_f, speed / 60 * spindle, tool))
            position = end
    return _program(rows, units)


def _program(rows: list[tuple[Any, ...]], units: str) -> Program:
    columns: list[Any] = list(zip(*rows, strict=True)) if rows else [()] * 7
    line, kind, start, end, v_f, n_s, tool = (np.array(c, dtype=float) for c in columns)
    findings = () if units else (Finding("suspicious", 0, "no G20 or G21: lengths are taken as mm"),)
    return Program(
        line=line.astype(np.int64), kind=kind.astype(np.int64), start=start.reshape(-1, 3), end=end.reshape(-1, 3),
        rotary0=np.zeros(3), rotary=np.zeros(3), plane=np.int64(0), centre=np.zeros(3), turns=np.int64(0),
        clockwise=np.bool_(False), v_f=v_f, n_s=n_s, tool=tool.astype(np.int64), units=units, findings=findings,
    )  # fmt: skip
