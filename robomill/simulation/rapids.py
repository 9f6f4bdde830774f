"""Rapids that run through material: a machine would break the tool there, and the simulation must say so."""

from typing import NamedTuple

import numpy as np

from robomill.provenance import Finding, named
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.tools import tooling
from robomill.surface.collisions import collisions
from robomill.surface.passes import Passes
from robomill.surface.stock import fitting_cell
from robomill.toolpath.path import Toolpath

MOST_CELLS = 4_000_000  # a large block is looked at in larger cells than it is cut in


class Crashes(NamedTuple):
    """Source lines of rapids through material, in order: through what no cut removes (``never``: what they leave is not
    known), and through what is cut only later (``early``); and of a ``first`` one that ends in it (0: it does not).

    Where a machine stands before its first move is not known, and a program may be the end of a longer one, so the
    first is said and no more.
    """

    never: tuple[int, ...] = ()
    early: tuple[int, ...] = ()
    first: int = 0

    def notes(self) -> tuple[Finding, ...]:
        """What they break, by their lines."""
        found = []
        if self.first:
            text = "the first rapid ends in the material: the tool is taken to stand there, and to break nothing."
            found.append(Finding("warning", text, self.first, code="begins-in-material"))
        for lines, which, code in (
            (self.never, "no cut removes", "rapid-in-material"),
            (self.early, "is cut only later", "rapid-before-cut"),
        ):
            if lines:
                also = f" (also line {named(lines[1:])})" if len(lines) > 1 else ""
                text = f"a rapid runs through material that {which}; lift the tool first{also}."
                found.append(Finding("warning", text, lines[0], code=code))
        return tuple(found)


def crashes(setup: SimulationSetup, path: Toolpath) -> Crashes:
    """Rapids of a program that pass through material which no cut before them has removed."""
    moves = path.step_length > 0
    feed, rapid = moves & path.cutting, moves & ~path.cutting
    begins = int(np.argmax(moves))
    start, start_axis = np.roll(path.p, 1, axis=0), np.roll(path.k, 1, axis=0)
    if rapid[begins]:
        start[begins], start_axis[begins] = path.p[begins], path.k[begins]
    length, width, _ = setup.stock_block.size
    cell = max(setup.cell, fitting_cell(float(length), float(width), MOST_CELLS))
    moves_made = Passes(np.hstack([start, path.p]), np.hstack([start_axis, path.k]))
    met = collisions(setup.stock_block, cell, tooling(setup, path), moves_made, (feed, rapid))
    first = int(path.block[begins]) if met.early[begins] else 0
    met.early[begins] = met.never[begins] = False
    never, early = (set(path.block[some].tolist()) for some in (met.never, met.early))
    return Crashes(tuple(sorted(never)), tuple(sorted(early - never)), first)
