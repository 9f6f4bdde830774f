"""A program in the figures of the shop floor: for the command line's JSON and for files of moves."""

import json
import math
from pathlib import Path
from typing import Any

from robomill.errors import GCodeError
from robomill.files import written
from robomill.toolpath.gcode.program import ARC, FEED, KINDS, PLANES, TRAVERSE, Program
from robomill.toolpath.path import Toolpath
from robomill.toolpath.plane import axes
from robomill.units import from_si


def gcode_report(program: Program) -> dict[str, Any]:
    """Counts and lengths of moves by kind, extents of feed moves (mm), units, findings and ``ok``.

    ``moves`` and ``length_mm`` always have ``traverse``, ``feed`` and ``arc``; ``tap`` and ``probe`` where there
    are such. ``extents_mm`` is ``[[x, y, z], [x, y, z]]`` or None without feed moves.
    """
    counts, lengths = {}, {}
    for code, name in enumerate(KINDS):
        chosen = program.kind == code
        n = int(chosen.sum())
        if n or code <= ARC:
            counts[name] = n
            lengths[name] = from_si(float(program.length[chosen].sum()), "mm")
    extents = program.extents
    return {
        "moves": counts,
        "length_mm": lengths,
        "extents_mm": None if extents is None else [[from_si(float(v), "mm") for v in corner] for corner in extents],
        "units": program.units or "mm",
        "dialect": program.dialect,
        "lines": program.lines,
        "dwells": program.dwells,
        "findings": [finding.record() for finding in program.findings],
        "ok": program.ok,
    }


def write_path_jsonl(toolpath: Toolpath, path: str | Path) -> None:
    """One straight move of a cutter location file a line: ``line``, ``kind`` (traverse, feed), ``start``, ``end`` (mm).

    Moves at feed also have ``feed_mm_min``; where the tool is tilted anywhere, moves have its ``axis`` at their end.
    """
    tilted = bool((toolpath.k[:, :2] != 0.0).any())
    with written(path, GCodeError) as place, place.open("w", encoding="utf-8") as out:
        for i in range(1, len(toolpath.p)):
            row: dict[str, Any] = {
                "line": int(toolpath.block[i]),
                "kind": KINDS[FEED if toolpath.cutting[i] else TRAVERSE],
                "start": _mm(toolpath.p[i - 1]),
                "end": _mm(toolpath.p[i]),
            }
            if toolpath.cutting[i]:
                row["feed_mm_min"] = from_si(float(toolpath.v_f[i]), "mm/min")
            if tilted:
                row["axis"] = [float(v) for v in toolpath.k[i]]
            out.write(json.dumps(row) + "\n")


def _mm(point: Any) -> list[float]:
    return [from_si(float(v), "mm") for v in point]


def write_moves_jsonl(program: Program, path: str | Path) -> None:
    """One canonical move a line, in order: ``line``, ``kind``, ``start``, ``end`` (mm, machine frame).

    Arcs also have ``plane`` (XY, XZ, YZ), ``centre`` (the two coordinates of the plane: x y, z x, y z), ``turns``,
    ``clockwise``, ``sweep_deg`` and ``length_mm``; feed moves ``feed_mm_min``; moves with turned axes ``rotary_deg``.
    """
    sweep, length = program.sweep, program.length
    turned = bool(program.rotary.any())
    if program.planes:
        raise GCodeError("Program: it tilts its working plane, and its moves stand in that; write its path instead.")
    with written(path, GCodeError) as place, place.open("w", encoding="utf-8") as out:
        for i in range(len(program)):
            kind = int(program.kind[i])
            row: dict[str, Any] = {
                "line": int(program.line[i]),
                "kind": KINDS[kind],
                "start": _mm(program.start[i]),
                "end": _mm(program.end[i]),
            }
            if kind == ARC:
                plane = int(program.plane[i])
                row |= {
                    "plane": PLANES[plane],
                    "centre": _mm(program.centre[i][list(axes(plane)[:2])]),
                    "turns": int(program.turns[i]),
                    "clockwise": bool(program.clockwise[i]),
                    "sweep_deg": math.degrees(float(sweep[i])),
                    "length_mm": from_si(float(length[i]), "mm"),
                }
            if kind:
                row["feed_mm_min"] = from_si(float(program.v_f[i]), "mm/min")
            if turned:
                row["rotary_deg"] = [math.degrees(float(v)) for v in program.rotary[i]]
            out.write(json.dumps(row) + "\n")
