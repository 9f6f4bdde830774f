"""Where a run of an upright cutter is to cut, compiled: its track, less what its neighbours on the path cut.

Runs of a path that goes on overlap: a disc about every corner is swept by two of them, and is cut by one.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import part
from robomill.cutting.profile_kernels import Shape, radius_at
from robomill.surface.contact.material_kernels import AXIS, ENDS, MOVE, SKIN, World
from robomill.surface.envelope_kernels import POINT, Move, row_interval


class Track(NamedTuple):
    """What a run of an upright cutter is to cut: its move and how wide it reaches into the stock, its ends (3,), its
    way in plan and that of the run before; whether it follows that one, and leaves what lies ahead to the next."""

    move: Move
    radius: float
    a: FloatArray
    b: FloatArray
    way: tuple[float, float]
    before: tuple[float, float]
    follow: bool
    leave: bool


@part
def goes_on(runs: FloatArray, r: int) -> bool:
    """Whether a run begins where the one before left off, with the same tool and axis."""
    same = r > 0
    if same:
        for n in range(MOVE):
            before = n + 3 if ENDS <= n < ENDS + 3 else n
            same = same and (ENDS + 3 <= n < AXIS or runs[r - 1, before] == runs[r, n])
    return same


@part
def follows(runs: FloatArray, r: int) -> bool:
    """Whether a run has nothing to cut behind its start: it goes on from another and does not go down."""
    return goes_on(runs, r) and runs[r, ENDS + 5] >= runs[r, ENDS + 2]


@part
def leaves(runs: FloatArray, r: int) -> bool:
    """Whether a run leaves what lies ahead of its end to the next one, which begins with the tool there: it does not
    go up, and not straight down."""
    if r + 1 == len(runs) or runs[r, ENDS + 5] > runs[r, ENDS + 2] or not goes_on(runs, r + 1):
        return False
    ux, uy = way_in_plan(runs, r)
    return ux != 0.0 or uy != 0.0


@part
def way_in_plan(runs: FloatArray, r: int) -> tuple[float, float]:
    """Unit vector of a run in plan, from its start to its end; (0, 0) straight up or down."""
    vx, vy = runs[r, ENDS + 3] - runs[r, ENDS], runs[r, ENDS + 4] - runs[r, ENDS + 1]
    length = math.hypot(vx, vy)
    return (vx / length, vy / length) if length > POINT else (0.0, 0.0)


@part
def ahead_of(place: FloatArray, way: tuple[float, float], x: float, back: float) -> tuple[float, float]:
    """Where the line at ``x`` parallel to y lies ahead of a place (x, y), or at most so far ``back``: (low, high) m;
    everywhere if there is no way."""
    if way[1] == 0.0:
        return (-math.inf, math.inf) if (x - place[0]) * way[0] >= -back else (math.inf, -math.inf)
    y = place[1] - ((x - place[0]) * way[0] + back) * (1.0 / way[1])
    return (y, math.inf) if way[1] > 0.0 else (-math.inf, y)


@part
def track_of(world: World, shape: Shape, move: Move, r: int) -> Track:
    """What a run of an upright cutter is to cut: ahead of its start, where it follows another, and of where that one
    stopped; up to its end, where it leaves what lies ahead."""
    runs, follow = world.runs, follows(world.runs, r)
    way = way_in_plan(runs, r)
    before = way_in_plan(runs, r - 1) if follow else way
    radius = radius_at(shape, world.bounds.z_high - move.az)
    return Track(move, radius, runs[r, ENDS : ENDS + 3], runs[r, ENDS + 3 : AXIS], way, before, follow, leaves(runs, r))


@part
def row_of(track: Track, x: float, aside: float) -> tuple[float, float]:
    """Where the line at ``x`` parallel to y lies in what a run is to cut, or so far ``aside``: (low, high) m."""
    y_low, y_high = row_interval(track.move, track.radius + aside, x)
    if track.follow:
        own, others = ahead_of(track.a, track.way, x, SKIN + aside), ahead_of(track.a, track.before, x, SKIN + aside)
        y_low, y_high = max(y_low, min(own[0], others[0])), min(y_high, max(own[1], others[1]))
    if track.leave:
        behind = ahead_of(track.b, (-track.way[0], -track.way[1]), x, SKIN + aside)
        y_low, y_high = max(y_low, behind[0]), min(y_high, behind[1])
    return y_low, y_high
