"""A corrected path as a program: a program's own lines with other places, or G-code of a path that was none; what is
written is read again and compared with what was meant."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.errors import CompensationError, GCodeError
from robomill.improve.program import Moves
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.corrected import Mark, key_of, marked
from robomill.toolpath.fitting import Piece
from robomill.toolpath.gcode.program import TAP, Program
from robomill.toolpath.gcode.reading import interpret
from robomill.toolpath.gcode.rewriting import Rewriter
from robomill.toolpath.gcode.trace import trace
from robomill.toolpath.path import PER_MOVE, Toolpath
from robomill.toolpath.source import LEANS, GCodeSource, PathSource
from robomill.toolpath.text import is_apt

WriteGCode = Callable[[Toolpath], str]
NEAR = 0.6e-6  # m: what was read again lies so near to what was written
STILL = 1e-8  # m: moves that go no further are none


@dataclass(frozen=True, eq=False)
class Written:
    """The ``text``, where its path is at the samples of the wanted one (n, 3) m in {W}, what was written out, and how
    many lines went in."""

    text: str
    q: FloatArray
    unrolled: tuple[str, ...]
    lines_in: int


class Writing:
    """How a set-up's path is written back: ``moves`` first, then ``write`` as often as wanted."""

    moves: Moves
    components: tuple[str, ...] = ()  # in which it is corrected, as it says of itself

    def write(self, c: FloatArray, bound: float) -> Written:
        """The program with corrections c (n, 3) m of the samples, within ``bound`` (m)."""
        raise NotImplementedError


def writing(setup: SimulationSetup, write_gcode: WriteGCode) -> Writing:
    """By where the path comes from. Raises CompensationError for programs that cannot be written back."""
    source = setup.source
    if not isinstance(source, GCodeSource) or is_apt(source.text.encode()):
        return _OfPath(setup, write_gcode)
    if source.table not in ("", LEANS):
        raise CompensationError(
            "The program is not corrected: a table turns the part, and its words would have to turn with it; correct "
            "the operations apart, each as a program without the table."
        )
    return _OfProgram(setup, source)


class _OfProgram(Writing):
    def __init__(self, setup: SimulationSetup, source: GCodeSource) -> None:
        self.setup, self.source = setup, source
        self.tools = setup.tools or None
        self.program, self.executed, self.dialect = trace(source.text, source.dialect, self.tools)
        if self.dialect == "heidenhain":
            raise CompensationError(
                "The program is not corrected: Heidenhain's dialogue is read, but not written yet; let the CAM system "
                "write G-code (DIN/ISO)."
            )
        if self.program.planes:
            raise CompensationError(
                "The program is not corrected: it tilts its working plane, and its words would have to turn with that; "
                "let the CAM system write it upright, with the tool's direction."
            )
        self.moves = Moves.of_program(setup, self.program)

    def write(self, c: FloatArray, bound: float) -> Written:
        program = self.program
        taps = np.flatnonzero((program.kind == TAP) | program.thread)
        if len(taps):
            line = int(program.line[taps[0]])
            raise CompensationError(f"Line {line}: a thread is cut in step with the spindle, which is not corrected.")
        pieces, ends = self.moves.corrected(c, bound)
        text_lines = self.source.block_texts()
        found = Rewriter(program, self.dialect, pieces, ends).write(text_lines, self.executed)
        text = _marked(found.text, self.source, self.components, self.dialect)
        self._check(text, found.made)
        text = text.replace("\n", "\r\n") if "\r\n" in self.source.text else text
        return Written(text, self.moves.places(found.made), found.unrolled, len(text_lines))

    def _check(self, text: str, made: dict[int, Any]) -> None:
        """Read the text again: it must make the pieces that were written, and nothing else."""
        program = self.program
        told = [(j, end) for j in range(len(program)) for end in _ends(program, made, j)]
        owner, ends = np.array([j for j, _ in told]), np.array([end for _, end in told])
        try:
            again = interpret(text.encode("utf-8", "surrogateescape"), dialect=self.source.dialect, tools=self.tools)
        except GCodeError as refusal:
            raise CompensationError(f"The corrected program cannot be read: {refusal}") from None
        keep = _moving(ends, program.start[0] + program.lift[0], program.rotary[owner] if len(owner) else ends)
        back_ends = again.end + again.lift
        back = _moving(back_ends, back_ends[0] if not len(again) else again.start[0] + again.lift[0], again.rotary)
        owner, ends, read = owner[keep], ends[keep], np.flatnonzero(back)
        line = _differs(program, owner, ends, again, read)
        if line:
            raise CompensationError(
                f"Line {line}: written back, it would not lead where it should; write the moves of this line with "
                "G0, G1, G2 and G3."
            )


def _marked(text: str, source: PathSource, components: tuple[str, ...], dialect: str) -> str:
    """A corrected program's text with what it says of itself at its head."""
    return "\n".join(marked(text.split("\n"), Mark(source.name, key_of(source.block_texts()), components), dialect))


def _ends(program: Program, made: dict[int, Any], j: int) -> list[FloatArray]:
    """Where the pieces of a move end; one that was not made anew ends as it did."""
    return [piece.end for _, piece in made[j]] if j in made else [program.end[j] + program.lift[j]]


def _moving(ends: FloatArray, start: FloatArray, rotary: FloatArray) -> Any:
    """(m,) bool: moves that go anywhere, by where they end."""
    step = np.diff(ends, axis=0, prepend=start[None])
    turn = np.diff(rotary, axis=0, prepend=rotary[:1])
    return (np.abs(step) > STILL).any(axis=1) | (np.abs(turn) > STILL).any(axis=1)


def _differs(program: Program, owner: IntArray, ends: FloatArray, again: Program, read: IntArray) -> int:
    """The line of the first move that reads otherwise than it was meant; 0 for none."""
    count = min(len(owner), len(read))
    a, b = owner[:count], read[:count]
    same = (np.abs(ends[:count] - (again.end + again.lift)[b]) < NEAR).all(axis=1)
    same &= np.broadcast_to(program.at_feed, len(program))[a] == np.broadcast_to(again.at_feed, len(again))[b]
    same &= np.isclose(program.v_f[a], again.v_f[b], rtol=1e-4, atol=1e-9)
    same &= np.isclose(program.n_s[a], again.n_s[b], equal_nan=True) & (program.tool[a] == again.tool[b])
    bad = np.flatnonzero(~same)
    if len(bad):
        return int(program.line[a[bad[0]]])
    if len(owner) != len(read):
        return int(program.line[owner[min(count, len(owner) - 1)]])
    return 0


class _OfPath(Writing):
    """Lines, sketches, points and location files: a program is written of the path."""

    def __init__(self, setup: SimulationSetup, write_gcode: WriteGCode) -> None:
        self.setup, self.write_gcode = setup, write_gcode
        self.moves = Moves.of_path(setup)

    def write(self, c: FloatArray, bound: float) -> Written:
        path, moves = self.setup.toolpath, self.moves
        pieces, ends = moves.corrected(c, bound)
        made = {j: pieces.get(j) or [_whole(ends[j])] for j in range(len(path))}
        owner = np.array([j for j in made for _ in made[j]])
        share = np.array([piece.f1 for j in made for piece in made[j]])
        p = np.round(np.array([piece.end for j in made for piece in made[j]]), 9)
        before = np.maximum(owner - 1, 0)
        k = path.k[before] + share[:, None] * (path.k[owner] - path.k[before])
        k /= np.linalg.norm(k, axis=1, keepdims=True)
        arrays = {name: getattr(path, name)[owner] for name in PER_MOVE}
        arrays["dwell"] = np.where(np.append(True, np.diff(owner) > 0), arrays["dwell"], 0.0)
        text = self.write_gcode(replace(path, p=p, k=k, **arrays))
        starts = np.vstack([p[:1], p[:-1]])
        written: dict[int, Any] = {}
        every = [piece for some in made.values() for piece in some]
        for n, j in enumerate(owner.tolist()):
            written.setdefault(j, []).append((starts[n], replace(every[n], end=p[n])))
        text = _marked(text, self.setup.source, self.components, "linuxcnc")
        return Written(text, moves.places(written), (), len(self.setup.source.block_texts()))


def _whole(end: FloatArray) -> Piece:
    return Piece(0.0, 1.0, end)
