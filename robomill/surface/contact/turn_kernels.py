"""The angles of a turn at which the engaged part of a cutter is looked at, compiled.

Gauss' rule of two points, in panels finer towards the sides; the angles are rows of an array, those of each half turn
one after the other, with the gaps between them numbered through.
"""

from __future__ import annotations

import math

import numpy as np

from robomill.arrays import FloatArray
from robomill.compiled import part
from robomill.cutting.engaged import PANELS
from robomill.cutting.profile_kernels import GAUSS

JUMP = 0.2  # of the longer one: neighbouring engaged lengths that differ by more than this are a jump
ANGLES = 3 * PANELS + 1  # looked at in a half turn: the ends of its panels, and two of Gauss' nodes in each
SIDE = 1e-3  # rad off the sides of the tool, where its surface does not face the feed: the first angle looked at
HALF = 3 * PANELS  # gaps between the angles looked at in a half turn
HIDDEN = 10 * PANELS  # angles, at most, that are looked at for what the others pass over; their rows follow both halves
PHI, SINE, COSINE = range(3)  # of a row that is known of an angle: itself, its sine and cosine


@part
def aim(row: FloatArray, phi: float) -> None:
    """A row for what is to be measured at an angle."""
    row[PHI], row[SINE], row[COSINE] = phi, math.sin(phi), math.cos(phi)


@part
def panel_end(n: int) -> float:
    """Where the n-th panel of the turn begins, rad; finer towards the sides of the tool."""
    return math.pi * (n // PANELS + 0.5 - 0.5 * math.cos(math.pi * (n % PANELS) / PANELS))


def half_turn() -> FloatArray:
    """(``ANGLES``,) rad: the angles looked at in the half turn ahead."""
    ends = np.array([panel_end(n) for n in range(PANELS)] + [math.pi])
    nodes = ends[:-1, None] + np.diff(ends)[:, None] * np.array([0.0, GAUSS, 1.0 - GAUSS])
    return np.clip(np.append(nodes.ravel(), math.pi), SIDE, math.pi - SIDE)


@part
def gap_end(gap: int) -> int:
    """The row at which a gap between the angles looked at ends; each half turn begins with a row of its own."""
    return gap + gap // HALF + 1


@part
def between_panels(row: int) -> bool:
    """Whether a row is the end of a panel and the beginning of the next one."""
    return row % ANGLES % 3 == 0 and 0 < row % ANGLES < ANGLES - 1


@part
def turn_row(place: int) -> int:
    """The rows of a turn in the order in which they are looked at: the nodes of a panel, then where it begins; of the
    first panel that comes before them, and where the half turn ends follows."""
    within = place % ANGLES
    if within == 0:
        return place
    panel, which = (within - 1) // 3, (within - 1) % 3
    row = 3 * panel if which == 2 else 3 * panel + which + 1
    return place - within + (row if row > 0 else ANGLES - 1)


@part
def jumps(a: float, b: float) -> bool:
    """Whether two engaged lengths at neighbouring angles differ by more than what is smooth."""
    return abs(a - b) > JUMP * max(a, b)
