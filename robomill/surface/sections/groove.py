"""Sections of what a path has cut, each with the measures of what it is: groove, step, pocket, free surface.

A section is a vertical plane across the commanded feed. ``w`` (m) counts in it from the commanded tool tip
along the feed-normal z x feed, so positive is left of the feed. Nothing here is read off a grid.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import made_by
from robomill.arrays import FloatArray, as_floats, frozen
from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.errors import SurfaceError
from robomill.frames import Columns
from robomill.progress import checkpoint
from robomill.surface.passes import tool_axes
from robomill.surface.raster import skin_on_line
from robomill.surface.sections.measures import MEASURED
from robomill.surface.sections.section import ASLANT, LIKE, NO_FLOOR, ONE_HEIGHT, REACH, STEPS, TURN, TURNS, Found, Seen
from robomill.surface.sections.section_law import MEASURES, Kind, kind_of
from robomill.surface.sections.trace import Line, Side, side_of
from robomill.surface.stock import Stock, stock_span
from robomill.surface.swept import CutPath, Station, SweptPath, station_at, swept_path
from robomill.units import format_count, format_si, from_si
from robomill.values import Table, Tabled, captioned, head_of, short

NAN = float("nan")
SIDES = {1.0: "left", -1.0: "right"}
OWN_PATH = 1.5  # cutter diameters of the path, before and after a station, whose walls are its own
SAME = 1e-7  # m: walls that stand so close are one
ALONG = 0.02  # tangent: a flank that leans shows its lean where it runs along the feed
NEIGHBOUR = "another pass took away a wall that this one was told to leave, so the middle is not measured"


@made_by("rm.simulate(setup).groove(station)")
@dataclass(frozen=True, eq=False, repr=False)
class GrooveSection(Tabled):
    """One section across the commanded feed; lengths in m, angles in rad, NaN where there is nothing to measure.

    station        path length of the commanded feed path
    block          source line of the move there
    centre, normal (3,) commanded tool tip and unit feed-normal in {W}
    kind           what is cut here, by the ideal surface (``section_law``); "nothing", or "unknown" where that is
    near           "left" or "right": the wall of a step, the nearer one of a pocket; "" where none is in the section
    width, depth   between the walls at the top; from the stock's top (or what the lower wall carries) to the floor
    centre_offset  machined middle between the walls of a groove minus the ideal one, positive along the feed-normal
    floor_error    machined floor minus ideal floor at the tool axis, positive: material left
    wall_left, wall_right            positions w of the machined walls; NaN where none is left
    wall_left_ideal, wall_right_ideal    of the same walls as they were told to be
    wall_left_error, wall_right_error    across the wall, in plan, at one height, to the left of the feed +; normal
    to a wall that leans (a cone's) it is off by the cosine of its lean of that
    wall_left_angle, wall_right_angle    from the floor's side of the horizontal: 90 degrees is upright, more opens up
    wall_left_straightness, wall_right_straightness   range about the best straight line over the wall's own height
    floor, floor_tilt                height at the tool axis; lean of the machined floor across, rising to the left +
    flatness                         range of the machined floor over what is in reach of the section
    error_mean, error_max, error_rms of a free surface along its normal, + material left; ``slope`` its own, rad
    w, z_ideal, z_machined           (q,) the section's profile
    note           what one must know of it, or why there is none; "" for nothing
    why            of each measure that is NaN and belongs to the kind, the reason

    Examples
    --------
    >>> import robomill as rm
    >>> section = rm.simulate(rm.load_setup("paper_flute")).groove(0.05)
    >>> section.kind, round(section.centre_offset * 1e3, 3), round(section.floor_error * 1e3, 3)
    ('groove', 0.23, -0.102)
    """

    station: float
    block: int
    centre: FloatArray
    normal: FloatArray
    kind: Kind = "unknown"
    near: str = ""
    width: float = NAN
    depth: float = NAN
    centre_offset: float = NAN
    floor_error: float = NAN
    wall_left: float = NAN
    wall_right: float = NAN
    wall_left_ideal: float = NAN
    wall_right_ideal: float = NAN
    wall_left_error: float = NAN
    wall_right_error: float = NAN
    wall_left_angle: float = NAN
    wall_right_angle: float = NAN
    wall_left_straightness: float = NAN
    wall_right_straightness: float = NAN
    floor: float = NAN
    floor_tilt: float = NAN
    flatness: float = NAN
    error_mean: float = NAN
    error_max: float = NAN
    error_rms: float = NAN
    slope: float = NAN
    w: FloatArray = field(default_factory=lambda: frozen(np.zeros(0)))
    z_ideal: FloatArray = field(default_factory=lambda: frozen(np.zeros(0)))
    z_machined: FloatArray = field(default_factory=lambda: frozen(np.zeros(0)))
    note: str = ""
    why: Mapping[str, str] = field(default_factory=dict)

    @property
    def measures(self) -> tuple[str, ...]:
        """What a gauge has for its kind: names of its numbers."""
        names = [name for name in MEASURES[self.kind] if self.near or "_near_" not in name]
        return tuple(name.replace("_near_", f"_{self.near}_") for name in names)

    def columns(self) -> Columns:
        """The profile across the feed, to the left of it positive."""
        return {f"{name}_mm": from_si(getattr(self, name), "mm") for name in ("w", "z_ideal", "z_machined")}

    def _said(self) -> str:
        told = ", ".join(map(" ".join, self._read())) or self.note
        return f"at {format_si(self.station, 'mm', 1)}: {self.kind}{': ' if told else ''}{told}"

    def _facts(self) -> list[tuple[str, str]]:
        return [("kind", self.kind), ("line", str(self.block)), *self._read()]

    def _read(self) -> list[tuple[str, str]]:
        named = [(name, MEASURED[name].unit) for name in self.measures]
        return [(name.replace("_", " "), format_si(getattr(self, name), unit)) for name, unit in named]


class GrooveSections(Table, tuple[GrooveSection, ...]):
    """Sections in the order of their stations: a tuple that is a table of what is measured on each."""

    __slots__ = ()

    def columns(self) -> Columns:
        """One row a section; NaN where a kind has no such measure, or nothing can be measured there."""
        kind = np.array([section.kind for section in self], dtype=str)
        numbers = {
            f"{name}_{of.unit}": from_si(np.array([getattr(each, name) for each in self], dtype=np.float64), of.unit)
            for name, of in MEASURED.items()
        }
        return {"station_mm": numbers.pop("station_mm"), "kind": kind, **numbers}

    def _said(self) -> str:
        kinds = ", ".join(dict.fromkeys(section.kind for section in self))
        return f"{format_count(len(self), 'section')}{': ' if kinds else ''}{kinds}"

    def __repr__(self) -> str:
        return short(self)

    def _repr_html_(self) -> str:
        return captioned(self, head_of(self.columns()))


def groove_sections(
    stock: Stock, cutter: Cutter | Tooling, path: CutPath, stations: ArrayLike, samples: int = 401
) -> GrooveSections:
    """Sections of what is cut at path lengths ``stations`` (q,) m of the commanded path; see GrooveSection.

    A wall that the pass itself left is measured from the one it was told to leave; where another pass took away what
    should have stayed, that wall has no ideal, and the middle is NaN.
    """
    ideal = as_floats(path.p, "commanded points", (None, 3), error=SurfaceError)
    moved = as_floats(path.p_machined, "deflected points", (len(ideal), 3), error=SurfaceError, finite=False)
    used, axes = np.asarray(path.cutting, dtype=bool), tool_axes(path.k, len(ideal))
    lines = np.zeros(len(ideal), dtype=int) if path.block is None else np.asarray(path.block)
    why = ["the tool does not reach this point"] * len(ideal) if path.why is None else path.why
    tooling = Tooling.of(cutter, len(ideal))
    known = np.where(np.isfinite(moved).all(axis=1, keepdims=True), ideal, np.nan)
    told, left, sure = (swept_path(stock, tooling, p, path.k, used) for p in (ideal, moved, known))
    s, found = np.cumsum(np.append(0.0, np.where(used[1:], np.linalg.norm(np.diff(ideal, axis=0), axis=1), 0.0))), []
    places = np.atleast_1d(as_floats(stations, "stations (m)", (), error=SurfaceError))
    if places.ndim != 1:
        raise SurfaceError(f"Stations: expected a list of lengths, found shape {places.shape}.")
    for n, station in enumerate(places):
        checkpoint(n / len(places), "Sections")
        place = station_at(ideal, used, float(station))
        i, f = place.entry, place.fraction
        made = tooling.cutters[tooling.of_step[i]]
        near = slice(*np.searchsorted(s, float(station) + np.array([-OWN_PATH, OWN_PATH]) * made.diameter) - [1, -1])
        near = slice(max(near.start, 0), near.stop)
        k = path.k if path.k is None or np.ndim(path.k) == 1 else path.k[near]
        some = Tooling(tooling.cutters, tooling.of_step[near])
        own = tuple(swept_path(stock, some, p[near], k, used[near]) for p in (ideal, moved))
        lost = i if not np.isfinite(moved[i]).all() else i - 1
        tool = _Tool(
            place,
            int(lines[i]),
            moved[i - 1] + f * (moved[i] - moved[i - 1]),
            axes[i - 1] + f * (axes[i] - axes[i - 1]),
            made,
            ideal[i] - ideal[i - 1],
            why[lost],
            own,
        )
        found.append(_section((told, left, sure), tool, samples))
    return GrooveSections(found)


@dataclass(frozen=True)
class _Tool:
    """The tool at a station: where it was told to be, in which source line, where its ``tip`` is, or ``why`` that is
    not known, its axis ``k`` and ``cutter``, its ``move`` (m) there, and what its path ``own`` close by leaves, as told
    and as it went."""

    place: Station
    block: int
    tip: FloatArray
    k: FloatArray
    cutter: Cutter
    move: FloatArray
    why: str
    own: tuple[SweptPath, ...]

    @property
    def lean(self) -> float:
        """Sine of the axis' lean to the left of the feed."""
        return float(self.k @ self.place.normal) if self.place.normal is not None else 0.0


def _section(paths: tuple[SweptPath, SweptPath, SweptPath], at: _Tool, samples: int) -> GrooveSection:
    """``paths``: as told, as left, and as told where it is known what is left."""
    place, cutter, stock = at.place, at.cutter, paths[0].stock
    bare = GrooveSection(place.station, at.block, frozen(place.centre), frozen(np.full(3, np.nan)))
    if place.normal is None:
        return replace(bare, note="the feed is along the tool axis here, so there is no section across it")
    bare = replace(bare, normal=frozen(place.normal))
    if not np.isfinite(at.tip).all():
        return replace(bare, note=at.why)
    seen = _seen(paths[:2], at)
    if seen is None:
        return replace(bare, kind="nothing", note="nothing is cut here: the tool passes beside the stock")
    w = seen.window(samples)
    told, left = seen.told.height(w), seen.left.height(w)
    z_ideal, z_machined = (frozen(np.maximum(z, stock.lower[2])) for z in (told, left))
    bare = replace(bare, w=frozen(w), z_ideal=z_ideal, z_machined=z_machined)
    top = float(seen.told.skin(np.array([seen.at[0]]))[0])
    if not seen.floors[0] < top - ONE_HEIGHT:
        above = place.centre[2] >= stock.upper[2]
        reason = "the tool passes above the stock" if above else "there is no material"
        return replace(bare, kind="nothing", note=f"nothing is cut here: {reason}")
    sides = {side: side_of(seen.told, seen.at[0], side) for side in SIDES}
    ends = [sides[side].w if sides[side].ends == "wall" else np.inf * side for side in SIDES]
    sure = paths[2].heights(place.centre, place.normal, float(seen.told.high - seen.told.low))(w)
    if (np.abs(told - sure)[(w < ends[0]) & (w > ends[1])] > ONE_HEIGHT).any():
        note = "a pass without a number goes through here, so what it leaves is not known"
        return replace(bare, w=frozen(w[:0]), z_ideal=frozen(w[:0]), z_machined=frozen(w[:0]), note=note)
    sides = _of_own_path(paths, at, seen, sides)
    kind = kind_of(sides[1.0], sides[-1.0], cutter)
    near = _near(sides, seen) if kind in ("step", "pocket") else ""
    bare = replace(bare, kind=kind, near=near)
    if not seen.floors[1] < float(seen.left.skin(np.array([seen.at[1]]))[0]) - ONE_HEIGHT:
        note = "the deflected tool cuts nothing here"
        return replace(bare, note=note, why=dict.fromkeys(bare.measures, note))
    if kind == "free":
        error = seen.normal_error(w)
        why = {} if error else dict.fromkeys(bare.measures, STEPS)
        return replace(bare, **error, floor=seen.floors[1], why=why)  # type: ignore[arg-type]
    turns = {side: _direction(paths[0], at, seen, (side, ideal)) for side, ideal in sides.items()}
    return _measured(bare, seen, sides, turns)


def _seen(paths: tuple[SweptPath, SweptPath], at: _Tool) -> Seen | None:
    """The line across the feed with both surfaces; None where the tool does not come over the stock.

    The axis of a ball is where its lowest point is, however it leans. Where it is beside the stock, the middle of what
    the cutter covers of it stands for it.
    """
    place, cutter, stock = at.place, at.cutter, paths[0].stock
    assert place.normal is not None
    low, high = stock_span(stock, place.centre, place.normal)
    ball = cutter.flat_radius == 0.0 and not cutter.conical
    lean = at.lean * cutter.radius if ball else 0.0
    middles = []
    for w in (lean, lean + float((at.tip - place.centre) @ place.normal)):
        covered = max(low, w - cutter.radius), min(high, w + cutter.radius)
        if not covered[0] < covered[1]:
            return None
        middles.append(w if low < w < high else 0.5 * (covered[0] + covered[1]))
    skin = skin_on_line(stock, place.centre, place.normal)
    told, left = (
        Line(path.heights(place.centre, place.normal, float(high - low)), skin, low, high, cutter.radius)
        for path in paths
    )
    plan = float(np.linalg.norm(at.move[:2]))
    rises, along = float(at.move[2] / plan), float(at.k[:2] @ at.move[:2] / plan / at.k[2])
    return Seen(told, left, (middles[0], middles[1]), cutter, float(stock.lower[2]), at.lean, rises, rises + along)


def _of_own_path(
    paths: tuple[SweptPath, SweptPath, SweptPath], at: _Tool, seen: Seen, sides: dict[float, Side]
) -> dict[float, Side]:
    """The ideal sides; where the pass itself has left the wall that stands, as it was told to leave it, even where what
    is told leaves no material between two passes."""
    place = at.place
    assert place.normal is not None
    reach = float(seen.told.high - seen.told.low)
    some_of_others = paths[0].meeting(place.centre, place.normal, reach) > at.own[0].meeting(
        place.centre, place.normal, reach
    )
    alone = _seen((at.own[0], at.own[1]), at) if some_of_others else None
    if alone is None:
        return sides
    found, stock_top = dict(sides), Side("wall", of_stock=True)
    for side, ideal in sides.items():
        if ideal.ends == "wall" and seen.is_own(ideal):
            continue
        if abs(seen.edge(side, stock_top).value - alone.edge(side, stock_top).value) < SAME:
            found[side] = side_of(alone.told, alone.at[0], side)
    return found


def _near(sides: dict[float, Side], seen: Seen) -> str:
    """The name of the side whose wall is nearest to the axis; "" where the section shows none."""
    walls = [(abs(sides[which].w - seen.at[0]), SIDES[which]) for which in _in_reach(sides, seen)]
    return min(walls)[1] if walls else ""


def _in_reach(sides: dict[float, Side], seen: Seen) -> dict[float, Side]:
    """The sides whose walls the section shows."""
    reach = REACH * seen.cutter.radius
    return {which: side for which, side in sides.items() if side.ends == "wall" and abs(side.w - seen.at[0]) <= reach}


def _direction(told: SweptPath, at: _Tool, seen: Seen, wall: tuple[float, Side]) -> float:
    """Tangent of the angle between a wall that was told and the feed: 0 where the pass leaves it, NaN where the wall
    turns."""
    side, ideal = wall
    normal = at.place.normal
    if ideal.ends != "wall" or normal is None or seen.is_own(ideal):
        return 0.0
    feed, places = np.array([normal[1], -normal[0], 0.0]) * TURN * seen.cutter.radius, []
    for way in (-1.0, 1.0):
        centre = at.place.centre + way * feed
        low, high = stock_span(told.stock, centre, normal)
        if not low < seen.at[0] < high:
            return NAN
        height, skin = told.heights(centre, normal, float(high - low)), skin_on_line(told.stock, centre, normal)
        beside = side_of(Line(height, skin, low, high, seen.cutter.radius), seen.at[0], side)
        places.append(beside.w if beside.ends == "wall" else NAN)
    even = abs(places[0] + places[1] - 2.0 * ideal.w) <= SAME + LIKE * abs(places[1] - places[0])
    return (places[1] - places[0]) / (2.0 * TURN * seen.cutter.radius) if even else NAN


def _measured(bare: GrooveSection, seen: Seen, sides: dict[float, Side], turns: dict[float, float]) -> GrooveSection:
    """A section with walls, with all that its kind has measures for."""
    walls = _in_reach(sides, seen)
    floor = Found(seen.floors[1] if not seen.through else NAN)
    found = {"floor": floor, "floor_error": seen.floor_error(), "floor_tilt": seen.floor_tilt()}
    if bare.kind != "groove":
        found["flatness"] = seen.flatness(bare.w)
    for which, ideal in walls.items():
        name, form = f"wall_{SIDES[which]}", seen.form(which, ideal)
        error = seen.wall_error(which, ideal, turns[which])
        lost = error.why if np.isnan(error.value) and error.why != TURNS else ""
        aslant = seen.cutter.conical and not abs(turns[which]) <= ALONG
        found[f"{name}_ideal"], found[f"{name}_error"] = Found(ideal.w), error
        found[name] = Found(why=lost) if lost else seen.edge(which, ideal)
        found[f"{name}_angle"] = (
            Found(why=lost) if lost else Found(*((NAN, ASLANT) if aslant else (form.angle, form.why)))
        )
        found[f"{name}_straightness"] = (
            Found(why=lost) if lost else Found(*((NAN, ASLANT) if aslant else (form.straightness, form.why)))
        )
    stand = {which: wall for which, wall in walls.items() if np.isfinite(found[f"wall_{SIDES[which]}"].value)}
    found["depth"] = Found(why=NO_FLOOR) if seen.through else Found(seen.top(stand) - seen.floors[1])
    if len(walls) == 2:
        found["width"], found["centre_offset"] = _between(found)
    if bare.kind != "groove":
        found.pop("centre_offset", None)
    note = NEIGHBOUR if bare.kind == "groove" and len(stand) < 2 else ""
    made = replace(bare, **{name: each.value for name, each in found.items()}, note=note)  # type: ignore[arg-type]
    why = {name: found[name].why for name in made.measures}
    return replace(made, why={name: reason for name, reason in why.items() if reason})


def _between(found: Mapping[str, Found]) -> tuple[Found, Found]:
    """Width between two walls, and their machined middle minus the ideal one."""
    both = [(found[f"wall_{side}"], found[f"wall_{side}_ideal"]) for side in SIDES.values()]
    for wall, _ in both:
        if wall.why:
            return wall, wall
    (left, left_ideal), (right, right_ideal) = ((wall.value, ideal.value) for wall, ideal in both)
    return Found(left - right), Found(0.5 * (left + right) - 0.5 * (left_ideal + right_ideal))
