"""The groove as a section shows it: walls, width, depth, centre offset, floor, from the exact swept envelope.

A section is a vertical plane across the commanded feed. ``w`` (m) counts in it from the commanded tool tip
along the feed-normal z x feed, so positive is left of the feed. Nothing here is read off a grid.
"""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, as_floats, frozen
from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.errors import SurfaceError
from robomill.progress import checkpoint
from robomill.surface.raster import skin_on_line
from robomill.surface.stock import Stock, stock_span
from robomill.surface.swept import CutPath, Heights, Station, SweptPath, station_at, swept_path
from robomill.surface.trace import trace_groove


@dataclass(frozen=True)
class GrooveSection:
    """One section across the commanded feed; lengths in m, angles in rad, NaN where there is nothing to measure.

    station        path length of the commanded feed path
    block          source line of the move there
    centre, normal (3,) commanded tool tip and unit feed-normal in {W}
    width, depth   of the machined groove: between its walls at the top, and from the stock's top to its floor
    centre_offset  machined middle between the walls minus the ideal one, positive along the feed-normal (left)
    floor_error    machined floor minus ideal floor at the tool axis, positive: material left
    wall_left, wall_right            positions w of the machined walls at the top; NaN where the stock's side is open
    wall_left_ideal, wall_right_ideal    of the same pass, even where what is told leaves no material between two
    wall_left_angle, wall_right_angle    from the floor's side of the horizontal: 90 degrees is upright, more opens up
    wall_left_straightness, wall_right_straightness   range about the best straight line
    floor, floor_tilt                height at the tool axis; slope of the machined floor across the groove
    w, z_ideal, z_machined           (q,) the section's profile
    note                             why something could not be measured, or ""
    """

    station: float
    block: int
    centre: FloatArray
    normal: FloatArray
    width: float
    depth: float
    centre_offset: float
    floor_error: float
    wall_left: float
    wall_right: float
    wall_left_ideal: float
    wall_right_ideal: float
    wall_left_angle: float
    wall_right_angle: float
    wall_left_straightness: float
    wall_right_straightness: float
    floor: float
    floor_tilt: float
    w: FloatArray
    z_ideal: FloatArray
    z_machined: FloatArray
    note: str = ""


def groove_sections(
    stock: Stock, cutter: Cutter | Tooling, path: CutPath, stations: ArrayLike, samples: int = 401
) -> tuple[GrooveSection, ...]:
    """Sections of the groove at path lengths ``stations`` (q,) m of the commanded path; see GrooveSection.

    The groove is the cut region around the tool, between the first material on either side. A wall that the pass itself
    left is measured from the one it was told to leave; where another pass took away what should have stayed, that wall
    has no ideal, and the middle is NaN.
    """
    ideal = as_floats(path.p, "commanded points", (None, 3), error=SurfaceError)
    moved = as_floats(path.p_machined, "deflected points", (len(ideal), 3), error=SurfaceError, finite=False)
    used = np.asarray(path.cutting, dtype=bool)
    lines = np.zeros(len(ideal), dtype=int) if path.block is None else np.asarray(path.block)
    why = ["the tool does not reach this point"] * len(ideal) if path.why is None else path.why
    tooling = Tooling.of(cutter, len(ideal))
    known = np.where(np.isfinite(moved).all(axis=1, keepdims=True), ideal, np.nan)
    told, left, sure = (swept_path(stock, tooling, p, path.k, used) for p in (ideal, moved, known))
    paths = told, left, sure
    s, found = np.cumsum(np.append(0.0, np.where(used[1:], np.linalg.norm(np.diff(ideal, axis=0), axis=1), 0.0))), []
    places = np.atleast_1d(np.asarray(stations, dtype=float))
    for n, station in enumerate(places):
        checkpoint(n / len(places), "Sections")
        place = station_at(ideal, used, float(station))
        i, f = place.entry, place.fraction
        tip = moved[i - 1] + f * (moved[i] - moved[i - 1])
        made = tooling.cutters[tooling.of_step[i]]
        near = slice(*np.searchsorted(s, float(station) + np.array([-OWN, OWN]) * made.diameter) - [1, -1])
        near = slice(max(near.start, 0), near.stop)
        k = path.k if path.k is None or np.ndim(path.k) == 1 else path.k[near]
        some = Tooling(tooling.cutters, tooling.of_step[near])
        own = tuple(swept_path(stock, some, p[near], k, used[near]) for p in (ideal, moved))
        lost = i if not np.isfinite(moved[i]).all() else i - 1
        found.append(_section(paths, _Tool(place, int(lines[i]), tip, made, why[lost], own), samples))
    return tuple(found)


OWN = 1.5  # cutter diameters of the path, before and after a station, whose walls are its own
MANY_PASSES = 1.2  # cutter diameters: a cut wider than this was made by several passes
WIDE = "wider than the cutter: several passes made it, so look at the walls; the middle and the tilt say little"
NEIGHBOUR = "another pass took away a wall that this one was told to leave, so the middle is not measured"
SAME, LIKE = 1e-7, 0.25  # m, and of the radius: walls that stand so close are one, or one as told and as left
ONE_HEIGHT = 1e-9  # m: heights that differ by less are one


@dataclass(frozen=True)
class _Tool:
    """The tool at a station: where it was told to be, in which source line, where its ``tip`` is, or ``why`` that is
    not known, its ``cutter``, and what its path ``own`` close by leaves, as told and as it went."""

    place: Station
    block: int
    tip: FloatArray
    cutter: Cutter
    why: str
    own: tuple[SweptPath, ...]

    def own_walls(self, line: tuple[float, float, float], skin: Heights) -> tuple[FloatArray, FloatArray]:
        """Its own walls (left, right) m, told and as left; ``line``: where it is (shift), and the stock's sides."""
        shift, low, high = line
        walls = []
        for path, middle in zip(self.own, (0.0, shift), strict=True):
            assert self.place.normal is not None
            height = path.heights(self.place.centre, self.place.normal, high - low)
            found = trace_groove(height, middle, low, high, self.cutter.radius, skin)
            walls.append(np.full(2, np.nan) if found is None else np.array([found.left, found.right]))
        return walls[0], walls[1]


def _section(paths: tuple[SweptPath, SweptPath, SweptPath], at: _Tool, samples: int) -> GrooveSection:
    """``paths``: as told, as left, and as told where it is known what is left."""
    stock, place, tip, cutter, block = paths[0].stock, at.place, at.tip, at.cutter, at.block
    if place.normal is None:
        return _empty(place, block, "the feed is along the tool axis here, so there is no section across it")
    if not np.isfinite(tip).all():
        return _empty(place, block, at.why)
    shift = float((tip - place.centre) @ place.normal)
    low, high = stock_span(stock, place.centre, place.normal)
    window = 2.5 * cutter.radius + abs(shift)
    if not (low < 0.0 < high and low < shift < high):
        return _empty(place, block, "the tool's axis is beside the stock here, so there is no groove to measure")
    w = np.linspace(max(low, -window), min(high, window), samples)
    skin = skin_on_line(stock, place.centre, place.normal)
    told, left, sure = (path.heights(place.centre, place.normal, float(high - low)) for path in paths)
    ideal = trace_groove(told, 0.0, low, high, cutter.radius, skin)
    machined = trace_groove(left, shift, low, high, cutter.radius, skin)
    if ideal is None:
        above = place.centre[2] >= stock.upper[2]
        return _empty(place, block, "the tool passes above the stock here" if above else "nothing is to be cut here")
    inside = w[~(w < ideal.right) & ~(w > ideal.left)]
    if (np.abs(told(inside) - sure(inside)) > ONE_HEIGHT).any():
        return _empty(place, block, "a pass without a number goes through here, so what it leaves is not known")
    if machined is None:
        return _empty(place, block, "the deflected tool cuts nothing here")
    walls = np.array([machined.left, machined.right])
    ideal_walls = np.array([ideal.left, ideal.right])
    told_of, own_of = (path.meeting(place.centre, place.normal, float(high - low)) for path in (paths[0], at.own[0]))
    if told_of > own_of:  # some of what meets the section may be of other passes
        told_walls, left_walls = at.own_walls((shift, low, high), skin)
        ideal_walls = np.where(np.abs(walls - left_walls) < SAME, told_walls, ideal_walls)
    ideal_walls[np.abs(walls - ideal_walls) > LIKE * cutter.radius + abs(shift)] = np.nan
    taken = bool((np.isnan(ideal_walls) & ~np.isnan(walls)).any())
    wide = NEIGHBOUR if taken else WIDE if walls[0] - walls[1] > MANY_PASSES * cutter.diameter else ""
    return GrooveSection(
        station=place.station,
        block=block,
        centre=frozen(place.centre),
        normal=frozen(place.normal),
        width=machined.left - machined.right,
        depth=machined.top - machined.floor,
        centre_offset=float(walls.mean() - ideal_walls.mean()),
        floor_error=machined.floor - ideal.floor,
        wall_left=machined.left,
        wall_right=machined.right,
        wall_left_ideal=float(ideal_walls[0]),
        wall_right_ideal=float(ideal_walls[1]),
        wall_left_angle=machined.left_angle,
        wall_right_angle=machined.right_angle,
        wall_left_straightness=machined.left_straightness,
        wall_right_straightness=machined.right_straightness,
        floor=machined.floor,
        floor_tilt=machined.floor_tilt,
        w=frozen(w),
        z_ideal=frozen(ideal.height(w)),
        z_machined=frozen(machined.height(w)),
        note=wide,
    )


def _empty(place: Station, block: int, note: str) -> GrooveSection:
    nothing: Any = dict.fromkeys((field.name for field in fields(GrooveSection)), float("nan"))
    for name in ("w", "z_ideal", "z_machined"):
        nothing[name] = frozen(np.zeros(0))
    normal = frozen(np.full(3, np.nan) if place.normal is None else place.normal)
    known = {"station": place.station, "block": block, "centre": frozen(place.centre), "normal": normal}
    return GrooveSection(**{**nothing, **known, "note": note})
