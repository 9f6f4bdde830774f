"""Canonical moves as the straight pieces of a Toolpath."""

import math
from typing import Any

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.errors import GCodeError
from robomill.rigid import axis_from_tilt
from robomill.toolpath import arcs
from robomill.toolpath.gcode import tilted
from robomill.toolpath.gcode.program import Program
from robomill.toolpath.path import Toolpath, far_off
from robomill.units import to_si

MAX_TILT_STEP = math.radians(2.0)
TABLE_STEP = math.radians(0.5)
"""2 um off the circle that a table leads a tool round, 200 mm from its axis."""
POINTS, POINTS_A_LINE = 600_000, 100
"""So many points a path may have, and so many more for each line of its program: what needs more turns without end."""
_BLOCK = 500_000


def most_points(lines: int) -> int:
    """How many points the path of a program of so many lines may have."""
    return min(arcs.MAX_POINTS, POINTS + POINTS_A_LINE * lines)


def to_toolpath(program: Program, chord_error: float = arcs.CHORD_ERROR, table: str = "") -> Toolpath:
    """The moves as points of {W}: arcs as chords within ``chord_error`` (m), turning axes in steps of 2 degrees.

    ``table`` is the rotary axis that turns the part (one of ``TABLES``): {W} turns with it, about part zero. Raises
    GCodeError if nothing moves, a point is beyond any machine, or more points than ``most_points`` would be needed.
    """
    if len(program) == 0:
        raise GCodeError("Program: found no motion; expected at least one G0, G1, G2 or G3 move.")
    is_arc, is_tap = program.is_kind("arc") & ~program.unplaced, program.is_kind("tap")
    counts, whole = _pieces(program, chord_error, table)
    first = np.cumsum(counts) - counts + 1
    p = np.empty((int(counts.sum()) + 1, 3))
    start, end = _ends(program)
    p[0] = start[0]
    single = counts == 1
    p[first[single]] = end[single]
    p[first[is_tap]], p[first[is_tap] + 1] = end[is_tap], start[is_tap]
    for rows in _blocks(np.flatnonzero((counts > 1) & ~is_tap), counts):
        owner, fraction = _fractions(program, rows, counts, whole)
        points = start[rows][owner] + fraction[:, None] * (end[rows] - start[rows])[owner]
        turning = is_arc[rows]
        if turning.any():
            on = turning[owner]
            points[on] = program.arcs_of(rows[turning]).at((np.cumsum(turning) - 1)[owner[on]], fraction[on])
        points[np.cumsum(counts[rows]) - 1] = end[rows]
        p[np.repeat(first[rows] - np.cumsum(counts[rows]) + counts[rows], counts[rows]) + np.arange(len(owner))] = (
            points
        )
    block = _spread(program.line, counts, program.line[0])
    k = _axes(program, counts, whole)
    if program.planes:
        p, k = tilted.stand(program.planes, p, k, first)
    if far := far_off(p, block):
        raise GCodeError.at(*far)
    v_f = _spread(np.where(program.at_feed, program.v_f, 0.0), counts, 0.0)
    if table and program.planes:
        raise GCodeError("Program: it tilts its plane, and a rotary table is stated; take that back.")
    if table and (program.rotary.any() or program.rotary0.any()):
        p, k, v_f = on_table(program, (counts, whole), p, v_f, table)
    return Toolpath(
        p=p,
        k=k,
        v_f=v_f,
        cutting=_spread(program.at_feed, counts, False),
        block=block,
        n_s=_spread(program.n_s, counts, program.n_s[0]),
        ccw=_spread(program.ccw, counts, program.ccw[0]),
        thread=_spread(program.thread, counts, False),
        dwell=_at_first(program.dwell, first, len(p)),
        tool=_spread(program.tool, counts, program.tool[0]),
        findings=program.findings,
        units=program.units or "mm",
        counts=(int((program.kind == 0).sum()), int((program.kind == 1).sum()), int((program.kind == 2).sum())),
    )


def _ends(program: Program) -> tuple[FloatArray, FloatArray]:
    """Where each move starts and ends (m, 3), m, at the tip.

    What only the machine knows is clear of the part: as high as the program ever goes, over where the tool was last.
    """
    start, end = program.start + program.lift, program.end + program.lift
    if not program.away.any():
        return start, end
    known = np.vstack([start[:1], end])
    away = np.vstack([np.zeros((1, 3), dtype=bool), program.away])
    for axis in range(2):
        last = np.maximum.accumulate(np.where(away[:, axis], 0, np.arange(len(known))))
        known[:, axis] = known[last, axis]
    top = float(known[~away[:, 2], 2].max())
    known[away[:, 2], 2] = top
    tap = program.is_kind("tap")
    start = np.where(tap[:, None], start, known[:-1])
    return start, known[1:]


def point_counts(program: Program) -> IntArray:
    """(m,) how many points each move has on the toolpath: none for first ones that stand where it begins anyway."""
    return _pieces(program, arcs.CHORD_ERROR)[0]


def _pieces(program: Program, chord_error: float, table: str = "") -> tuple[IntArray, FloatArray]:
    """Straight pieces of each move (m,), and how many would make a whole turn of those that are arcs (m,), else 0."""
    still = program.still if program.still < len(program) else 0
    rows = np.flatnonzero(program.is_kind("arc") & ~program.unplaced)
    rows = rows[rows >= still]
    turns, fit = program.arcs_of(rows), most_points(program.lines)
    whole = np.zeros(len(program))
    whole[rows] = turns.whole(chord_error)
    counts = _tilts(program, TABLE_STEP if table else MAX_TILT_STEP, fit)
    counts[program.is_kind("tap")] = 2
    for number, (row, _) in enumerate(program.planes):
        if row < len(program):
            turn = tilted.turn_between(
                program.planes, number, *(tool_axis(q[row]) for q in (program.rotary0, program.rotary))
            )
            counts[row] = max(counts[row], math.ceil(turn / MAX_TILT_STEP - 1e-4))
    asked = 4.0 * np.ceil(counts[rows] * 0.5 * math.pi / np.abs(turns.sweep))
    whole[rows] = np.where(counts[rows] > 1, np.maximum(whole[rows], asked), whole[rows])
    counts[rows] = turns.counts(whole[rows])
    counts[:still] = 0
    if counts.sum() > fit:
        raise GCodeError(f"Program: the path would need {counts.sum()} points; at most {fit} fit. Split the program.")
    return counts, whole


def _tilts(program: Program, most: float, fit: int) -> IntArray:
    """(m,) pieces in which no axis turns by more than ``most`` (rad); more than ``fit`` are refused."""
    if not (program.rotary.any() or program.rotary0.any()):
        return np.ones(len(program), dtype=np.int64)
    tilt = np.ceil(np.abs(program.rotary - program.rotary0).max(axis=1) / most - 1e-4)
    if tilt.sum() > fit:
        raise GCodeError(f"Program: the turning axes would need more than {fit} points.")
    return np.maximum(tilt, 1.0).astype(np.int64)


def _fractions(program: Program, rows: IntArray, counts: IntArray, whole: FloatArray) -> tuple[IntArray, FloatArray]:
    """For each piece of the moves ``rows``: which of them it belongs to, and what part of the move it ends."""
    owner, step = arcs.steps(counts[rows])
    fraction = step / counts[rows][owner]
    turning = whole[rows] > 0.0
    if turning.any():
        fraction[turning[owner]] = program.arcs_of(rows[turning]).ends(whole[rows[turning]])[1]
    return owner, fraction


def _blocks(rows: IntArray, counts: IntArray) -> list[IntArray]:
    """``rows`` in blocks of about ``_BLOCK`` points, to keep temporary arrays small."""
    if len(rows) == 0:
        return []
    block = np.cumsum(counts[rows]) // _BLOCK
    return np.split(rows, np.flatnonzero(np.diff(block)) + 1)


def _spread(values: Any, counts: IntArray, first: Any) -> Any:
    """A value of each move for each of its points, with ``first`` in front for the start (one value if all agree)."""
    if values[0] == first and (values == first).all():
        return values[:1]
    out = np.empty(int(counts.sum()) + 1, dtype=values.dtype)
    out[0] = first
    out[1:] = np.repeat(values, counts)
    return out


def _at_first(values: FloatArray, first: IntArray, count: int) -> FloatArray:
    """A value of each move for the first of its ``count`` points alone, 0 for the others (one 0 if all are)."""
    if not values.any():
        return np.zeros(1)
    out = np.zeros(count)
    out[first] = values
    return out


def _axes(program: Program, counts: IntArray, whole: FloatArray) -> FloatArray:
    if not (program.rotary.any() or program.rotary0.any()):
        return np.array([0.0, 0.0, 1.0])
    return tool_axis(_angles(program, counts, whole))


def _angles(program: Program, counts: IntArray, whole: FloatArray) -> FloatArray:
    """A, B, C (n, 3) rad at each point."""
    owner, fraction = _fractions(program, np.arange(len(program)), counts, whole)
    angles = program.rotary0[owner] + fraction[:, None] * (program.rotary - program.rotary0)[owner]
    return np.concatenate([program.rotary0[:1], angles])


def on_table(
    program: Program, pieces: tuple[IntArray, FloatArray], p: FloatArray, v_f: FloatArray, table: str
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points p (n, 3) m, axes k and feeds v_f in the part that a ``table`` turns, from those beside the machine.

    ISO 841: a rotary axis counts as if the tool turned about the part, so p and k turn by it about part zero (by its
    negative for "-A"). A move takes the time that its feed gives to its lengths beside the machine.
    """
    counts = pieces[0]
    angles = _angles(program, *pieces)
    axis, sense = "ABC".index(table[-1]), -1.0 if table[0] == "-" else 1.0
    turn = sense * angles[:, axis]
    angles[:, axis] = 0.0
    owner, _ = arcs.steps(counts)
    beside, degrees = program.length, np.degrees(np.linalg.norm(program.rotary - program.rotary0, axis=1))
    told = np.where(beside > 1e-9, beside, to_si(degrees, program.units or "mm"))
    turned = _turned(p, turn, axis)
    piece = np.linalg.norm(np.diff(turned, axis=0), axis=1)
    share = np.where(told > 0.0, np.bincount(owner, piece, len(program)) / np.where(told > 0.0, told, 1.0), 1.0)
    v_f = np.broadcast_to(v_f, (len(p),)).copy()
    v_f[1:] *= share[owner]
    return turned, _turned(tool_axis(angles), turn, axis), v_f


def _turned(v: FloatArray, angle: FloatArray, axis: int) -> FloatArray:
    """Vectors (n, 3) turned by angles (n,) about X, Y or Z."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    out = np.array(v)
    out[:, first] = v[:, first] * np.cos(angle) - v[:, second] * np.sin(angle)
    out[:, second] = v[:, first] * np.sin(angle) + v[:, second] * np.cos(angle)
    return out


def tool_axis(angles: FloatArray) -> FloatArray:
    """k (..., 3) for rotations A, B, C (..., 3) rad; C spins about k."""
    return axis_from_tilt(angles[..., 0], angles[..., 1])
