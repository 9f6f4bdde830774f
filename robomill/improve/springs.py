"""Where the force jumps the tip springs, whatever a program does: from one cut to another, and as a plunge first
touches. What it is off there is told apart from what a corrected program leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.provenance import Finding, named
from robomill.simulation.corners import SAME
from robomill.simulation.cut import steps_in_stock
from robomill.simulation.meant import LINK, linked
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import along, spin_of, stepped
from robomill.simulation.samples import sampled
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.units import format_count, format_si
from robomill.vectors import nearest_on

LOOKS = 8  # at a link
MOST = 50  # times as many along the whole of a line that is a link in part
WORDS = {
    "link": ("corner", "goes from one correction to the next by a short link, on which the tip is off by up to"),
    "touch": ("plunge", "touches first, and the tip springs sideways onto its path, by up to"),
}


@dataclass(frozen=True)
class Springs:
    """Places of one ``kind`` ("link" or "touch"): how many, on which ``lines`` of the corrected program, and how far
    (m) the tip springs at most."""

    kind: str
    count: int
    lines: tuple[int, ...]
    size: float

    @property
    def finding(self) -> Finding:
        """In a sentence."""
        what, does = WORDS[self.kind]
        text = (
            f"at {format_count(self.count, what)} (line {named(list(self.lines))} of the corrected program) it {does} "
            f"{format_si(self.size, 'mm')}: the force jumps there, and no program can take that away."
        )
        return Finding("info", text, code=f"springs-{self.kind}")


def springs(led: SimulationResult) -> tuple[Springs, ...]:
    """Of the run ``led`` of a corrected program, measured against the path that was meant. On links a run of the same
    text says it that is told nothing of that path."""
    found = []
    path = stepped(led.setup, led.setup.toolpath)
    links = linked(path, led.path)
    if links.any():
        finely, at = _finely(led.setup, path, np.flatnonzero(links))
        plain = along(led.setup, finely, spin=spin_of(led.ik))
        on = at >= 0
        tips = finely.p[on] + led.setup.to_part(np.nan_to_num(plain.delta[on]))
        off = _beside(tips, led.path, at[on])
        begins = links & ~np.append(False, links[:-1])
        lines = tuple(sorted(set(led.path.block[links].tolist())))
        found.append(Springs("link", int(begins.sum()), lines, float(off.max())))
    assert led.ahead is not None
    pushed = np.einsum("mij,mi->mj", led.R_MF, led.delta - led.ahead)
    size = np.linalg.norm(pushed[:, :2], axis=1)
    touch = _touches(led) & (size > LINK)
    if touch.any():
        lines = tuple(sorted(set(led.path.block[touch].tolist())))
        found.append(Springs("touch", int(touch.sum()), lines, float(size[touch].max())))
    return tuple(found)


def _finely(setup: SimulationSetup, path: Toolpath, links: IntArray) -> tuple[Toolpath, IntArray]:
    """The program of ``setup`` with the ``links`` (k,), samples of its ``path``, in ``LOOKS`` steps each: the tip is
    furthest off anywhere on them. And (m,) at which sample of ``path`` each is that is on a link, else -1."""
    longest = {}
    for line in set(path.block[links].tolist()):  # a cut that goes on beyond its corner is a link from there only
        on_it, whole = (
            float(path.step_length[some].sum()) for some in (links[path.block[links] == line], path.block == line)
        )
        longest[line] = max(on_it, whole / MOST) / LOOKS

    def seen(moves: Toolpath) -> FloatArray:
        near = steps_in_stock(setup, moves) if setup.engagement else np.full(len(moves), np.inf)
        return np.minimum(near, [longest.get(line, np.inf) for line in moves.block.tolist()])

    finely = sampled(setup.toolpath, setup.step, seen)
    gone, end = (np.cumsum(each.step_length) for each in (finely, path))
    of = np.minimum(np.searchsorted(end[links], gone - SAME), len(links) - 1)
    there = links[of]
    on = (gone > end[there] - path.step_length[there] - SAME) & (gone < end[there] + SAME)
    at = np.where(on & (finely.block == path.block[there]), there, -1)
    at[np.flatnonzero((at >= 0) & (np.append(finely.block[1:], -1) != finely.block))] = -1  # where the next cut begins
    return finely, np.where(finely.cutting, at, -1)


def _touches(led: SimulationResult) -> BoolArray:
    """(m,) the first samples of plunges that cut."""
    cuts = led.conditions.engaged & led.conditions.mostly_axial
    before = np.append(False, led.path.cutting[:-1] & ~led.conditions.engaged[:-1])
    return np.asarray(cuts & before & led.path.cutting)


def _beside(tips: FloatArray, path: Toolpath, at: IntArray) -> FloatArray:
    """(k,) m: how far tips (k, 3) m, meant to be at samples ``at`` (k,), are off the two lines of a path that meet
    there."""
    place = np.cumsum(path.step_length >= SAME)
    first, last = np.searchsorted(place, place[at], "left"), np.searchsorted(place, place[at], "right") - 1
    ends = path.p[np.maximum(first - 1, 0)], path.p[np.minimum(last + 1, len(path) - 1)]
    return np.minimum(*(nearest_on(tips, path.p[at], end)[1] for end in ends))
