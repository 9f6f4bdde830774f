"""The moves of a path, their samples, and the pieces that corrected moves are written in."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.errors import GCodeError
from robomill.simulation.judging.places import APART
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import stepped
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.fitting import Piece, along_piece, arc_pieces, straight_pieces
from robomill.toolpath.gcode.chords import point_counts
from robomill.toolpath.gcode.program import ARC, Program
from robomill.toolpath.path import Toolpath
from robomill.toolpath.sampling import CORNER, divided

SAME = 1e-8  # m: corrections that differ by less need no link
CLOSEST = 0.1e-3  # m: samples are no closer where a deflection changes quickly
MOST_SAMPLES = 400_000  # more are not taken for that
UPRIGHT = 1e-9  # m: rapids that go no further aside go along the tool


@dataclass(frozen=True, eq=False)
class Moves:
    """The moves of a path: where each ends (m, 3) m in {W}, whether it is at feed (m,), the plane (m,) and sweep (m,)
    rad of arcs (0: straight). ``owner`` (n,) says of which move each sample of ``wanted`` is,
    ``share`` (n,) how much of it is made there."""

    wanted: Toolpath
    owner: IntArray
    share: FloatArray
    end: FloatArray
    at_feed: BoolArray
    plane: IntArray
    sweep: FloatArray

    @classmethod
    def of_path(cls, setup: SimulationSetup) -> Moves:
        """Every point of a path ends a straight move."""
        path = setup.toolpath
        flat = np.zeros(len(path), dtype=np.int64)
        return cls._sampled(setup, np.arange(len(path)), (path.p, path.cutting, flat, np.zeros(len(path))))

    @classmethod
    def of_program(cls, setup: SimulationSetup, program: Program) -> Moves:
        """The canonical moves of a program, of which the set-up's path was made."""
        counts = point_counts(program)
        if counts.sum() + 1 != len(setup.toolpath):
            raise GCodeError("Program: what it is read as is no longer its path; read it again.")
        owner = np.append(0, np.repeat(np.arange(len(program)), counts))
        arc = program.kind == ARC
        told = (program.end + program.lift, program.at_feed & np.ones(len(program), dtype=bool))
        return cls._sampled(setup, owner, (*told, np.where(arc, program.plane, 0), np.where(arc, program.sweep, 0.0)))

    @classmethod
    def _sampled(
        cls, setup: SimulationSetup, owner: IntArray, told: tuple[FloatArray, BoolArray, IntArray, FloatArray]
    ) -> Moves:
        path = setup.toolpath
        tagged = stepped(setup, replace(path, block=np.arange(len(path))))
        entry = tagged.block
        wanted = replace(tagged, block=path.block[entry])
        of = owner[entry]
        return cls(wanted, of, _shares(wanted, of), *told)

    def finer(self, run: SimulationResult) -> Moves:
        """The same with more samples where the deflection of a ``run`` changes quickly: where a cut begins and ends."""
        d = np.nan_to_num(run.delta)
        change = np.append(0.0, np.linalg.norm(np.diff(d, axis=0), axis=1))
        change[~self.wanted.cutting] = 0.0
        most = np.maximum(np.floor(self.wanted.step_length / CLOSEST), 1.0)
        counts = np.minimum(np.maximum(np.ceil(change / APART), 1.0), most).astype(np.int64)
        if counts.sum() > MOST_SAMPLES or (counts == 1).all():
            return self
        wanted, owner = divided(self.wanted, counts), np.repeat(self.owner, counts)
        return replace(self, wanted=wanted, owner=owner, share=_shares(wanted, owner))

    def corrected(self, c: FloatArray, bound: float) -> tuple[dict[int, list[Piece]], FloatArray]:
        """The pieces of the moves at feed within ``bound`` (m) of where corrections c (n, 3) m of the samples lead
        them, and where every move ends (m, 3) m."""
        q = self.wanted.p + c
        first = np.searchsorted(self.owner, np.arange(len(self.end)), "left").tolist()
        past = np.searchsorted(self.owner, np.arange(len(self.end)), "right").tolist()
        ends = self.end + self._led(c, first, past)
        pieces: dict[int, list[Piece]] = {}
        for j in np.flatnonzero(self.at_feed).tolist():
            a, b = first[j], past[j]
            if a == b:  # it stands still
                pieces[j] = [Piece(0.0, 1.0, self.end[j] + c[a - 1])]
            else:
                links, pieces[j] = self._pieces(j, max(a, 1), b, q, bound)
                if links and self.wanted.dwell[a] > 0.0 and self._leads_out(j, a):  # where it waits nothing pushes
                    pieces[j - 1].append(Piece(1.0, 1.0, links[0].end))
                    ends[j - 1] = links[0].end
                else:
                    pieces[j] = links + pieces[j]
            ends[j] = pieces[j][-1].end
        return pieces, ends

    def _leads_out(self, j: int, a: int) -> bool:
        """Whether a move at feed, whose first sample is ``a``, draws the tool out of a cut along its axis."""
        if j == 0 or not self.at_feed[j - 1]:
            return False
        way = self.end[j] - self.end[j - 1]
        return bool(way @ self.wanted.k[a] > np.cos(CORNER) * np.linalg.norm(way))

    def _pieces(self, j: int, a: int, b: int, q: FloatArray, bound: float) -> tuple[list[Piece], list[Piece]]:
        """Of move ``j``, whose samples are ``a`` to ``b``: the link to where it begins, if one is needed, and its own.
        One that draws the tool out of a hole begins at its bottom, where nothing but that can push as it lets go."""
        before = start = q[a - 1]
        if self._leads_out(j, a):
            start = self.end[j - 1] + q[a] - self.wanted.p[a]
        if self.share[a] <= 0.0:
            start, a = q[a], a + 1
        links = [Piece(0.0, 0.0, start)] if np.abs(start - before).max() > SAME else []
        f = np.append(0.0, self.share[a:b])
        nodes = np.vstack([start, q[a:b]])
        if self.sweep[j] != 0.0:
            return links, arc_pieces(f, nodes, int(self.plane[j]), float(self.sweep[j]), bound)
        return links, straight_pieces(f, nodes, bound)

    def _led(self, c: FloatArray, first: list[int], past: list[int]) -> FloatArray:
        """(m, 3) m: how far the ends of rapids are moved: where a cut begins as that is, and what goes straight up or
        down beside a cut stays over it, or under it, so that nothing is dragged aside in the part."""
        led, k = np.zeros_like(self.end), self.wanted.k
        rapid = ~self.at_feed
        for j in np.flatnonzero(rapid).tolist():
            if past[j] > first[j]:
                led[j] = c[past[j] - 1]
        for j in range(len(self.end) - 2, -1, -1):  # before a cut
            if rapid[j] and rapid[j + 1] and led[j + 1].any() and not led[j].any() and self._along_tool(j + 1, past, k):
                led[j] = _aside(led[j + 1], k[past[j] - 1])
        for j in range(1, len(self.end)):  # behind one
            if rapid[j] and not led[j].any() and self._along_tool(j, past, k):
                before = led[j - 1] if rapid[j - 1] else c[past[j - 1] - 1]
                led[j] = _aside(before, k[past[j] - 1]) if past[j] > first[j] else before  # what goes nowhere stays
        return led

    def _along_tool(self, j: int, past: list[int], k: FloatArray) -> bool:
        way = self.end[j] - self.end[j - 1]
        return bool(np.linalg.norm(_aside(way, k[past[j] - 1])) < UPRIGHT)

    def places(self, made: dict[int, list[tuple[FloatArray, Piece]]]) -> FloatArray:
        """(n, 3) m: where the samples are on pieces as they were written, each with where it starts."""
        q = np.array(self.wanted.p)
        bounds = np.searchsorted(self.owner, np.arange(len(self.end) + 1), "left").tolist()
        for j, written in made.items():
            a, b = bounds[j], bounds[j + 1]
            if a == b:
                continue
            f = self.share[a:b]
            of = np.searchsorted([piece.f1 for _, piece in written], f - 1e-12, "left")
            for n, (start, piece) in enumerate(written):
                some = np.flatnonzero(np.minimum(of, len(written) - 1) == n)
                if len(some):
                    q[a + some] = along_piece(start, piece, f[some], int(self.plane[j]) or 17)
        return q


def _shares(path: Toolpath, owner: IntArray) -> FloatArray:
    """(n,) how much of its move each sample of a path has made, for the moves ``owner`` (n,)."""
    s = np.cumsum(path.step_length)
    first, last = np.searchsorted(owner, owner, "left"), np.searchsorted(owner, owner, "right") - 1
    begin = s[np.maximum(first - 1, 0)]
    length = s[last] - begin
    return np.divide(s - begin, length, out=np.ones(len(s)), where=length > 0.0)


def _aside(d: FloatArray, k: FloatArray) -> FloatArray:
    """The part of d (3,) across the tool axis k (3,)."""
    return np.asarray(d - float(d @ k) * k)
