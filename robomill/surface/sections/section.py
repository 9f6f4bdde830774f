"""One section as it is measured: its two surfaces on a line across the feed, and what a gauge reads of each kind."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.cutting.tool import Cutter
from robomill.lazy import cached_property
from robomill.surface.sections.section_law import has_floor, straight_part
from robomill.surface.sections.trace import AT_TOP, OWN, SEVERAL, Line, Side, WallForm, first_above, wall_form

REACH, SHOWN = 2.5, 3.25  # cutter radii to either side that a section measures, and shows
LIKE = 0.25  # of the radius: walls that stand so close are one as told and as left
ONE_HEIGHT = 1e-9  # m: heights that differ by less are one
FLOOR_POINTS = 21
MOST_LEAN = np.radians(5.0)  # against the cutter's own flank: what leans more is not the wall of one pass
MOST_HEEL = 0.05  # tangent: on steeper ramps the floor is round across
STEP = 5e-6  # m: a floor that is off its line across by more has steps, and no lean
HEEL = 0.15  # of the radius times the slope of the path: how round its heel leaves half of a floor (1 - cos 30 degrees)
STEEPER = 1.0  # against the free surface's own slope: what is steeper is the flank beside it
TURN = 0.05  # of the radius: so far along the feed the direction of another pass's wall is sought
UNDERCUT = 1e-3  # sine of the tool's lean across, from which the wall on one side is hidden below its lip

NO_FLOOR = "cut through the stock: there is no floor"
ROUND_FLOOR = "the cutter leaves no straight floor"
STEPPED_FLOOR = "the floor is not straight across here: several passes, or a path that climbs"
STEPS = "steps all over: no surface of its own here"
ASLANT = "the wall does not run along the feed here"
LEANS = "the floor leans with the tool"
ROUND_WALL = "the flank is round: a nose made it"
HIDDEN = "the wall leans back under its lip"
TAKEN = "another pass took away the wall that should stand here"
LEFT = "material is left before the wall that should stand here"
TURNS = "the wall turns here"


@dataclass(frozen=True)
class Found:
    """A number (SI), or NaN and the reason ``why`` it is not known."""

    value: float = float("nan")
    why: str = ""


@dataclass(frozen=True)
class Seen:
    """A section line with both its surfaces: ``told`` and ``left``, the axis ``at`` (m on either), the ``cutter``, the
    stock's ``bottom`` m, how far the tool ``leans`` to the left of the feed (the sine), and how steep (the tangent) the
    feed ``rises``, and how steep against the cutter's flat (``heel``)."""

    told: Line
    left: Line
    at: tuple[float, float]
    cutter: Cutter
    bottom: float
    leans: float
    rises: float
    heel: float

    @property
    def shift(self) -> float:
        """How far the axis is off across the feed, m."""
        return self.at[1] - self.at[0]

    @cached_property
    def floors(self) -> tuple[float, float]:
        """Heights of the floors at the axis, told and left, m."""
        told, left = (float(line.height(np.array([w]))[0]) for line, w in zip((self.told, self.left), self.at))
        return told, left

    @property
    def through(self) -> bool:
        """Whether either surface has no floor."""
        return min(self.floors) <= self.bottom + ONE_HEIGHT

    def window(self, samples: int) -> FloatArray:
        """Positions (samples,) m that the section shows."""
        reach = SHOWN * self.cutter.radius + abs(self.shift)
        low, high = max(self.told.low, self.at[0] - reach), min(self.told.high, self.at[0] + reach)
        return np.linspace(low, high, samples)

    def floor_error(self) -> Found:
        """Machined floor minus ideal floor, each at its axis; beside a step of the ideal one there is none."""
        told, left = self.floors
        if self.through:
            return Found(why=NO_FLOOR)
        beside = abs(self.shift) + LIKE * self.cutter.radius
        if beside <= self.cutter.flat_radius:
            across = np.linspace(-beside, beside, FLOOR_POINTS)
            w = self.at[0] + across[(self.at[0] + across > self.told.low) & (self.at[0] + across < self.told.high)]
            z = self.told.height(w)
            cut = z < self.told.skin(w) - ONE_HEIGHT
            if not self._straight(w[cut], z[cut]):
                return Found(why=STEPPED_FLOOR)
        return Found(left - told)

    def _straight(self, across: FloatArray, z: FloatArray) -> bool:
        """Whether heights z (q,) m of a floor, from anywhere, are those of a flat that leans as the tool does."""
        lean = -self.leans / np.sqrt(1.0 - self.leans**2)
        heel = HEEL * min(abs(self.heel), MOST_HEEL) * self.cutter.radius
        return bool(np.ptp(z - lean * across) <= STEP + heel)

    @cached_property
    def _edges(self) -> dict[tuple[float, Side], Found]:
        """Edges found so far: every measure of a wall asks for its edge."""
        return {}

    def edge(self, side: float, ideal: Side) -> Found:
        """Where the machined counterpart of an ideal wall has its edge."""
        if (side, ideal) not in self._edges:
            self._edges[side, ideal] = self._edge(side, ideal)
        return self._edges[side, ideal]

    def _edge(self, side: float, ideal: Side) -> Found:
        middle, floor = self.at[1], self.floors[1]
        top = float(self.left.skin(np.array([middle]))[0])
        level = top - AT_TOP * (top - floor) if ideal.of_stock else 0.5 * (self.floors[0] + ideal.top)
        w = float(first_above(self.left, middle, side, np.array([level]))[0])
        return Found(w, TAKEN if np.isnan(w) else "")

    def form(self, side: float, ideal: Side) -> WallForm:
        """Lean and form of the machined wall on a side, over its own height."""
        if side * self.leans < -UNDERCUT:
            return WallForm(why=HIDDEN)
        edge, floor = self.edge(side, ideal), max(self.floors[1], self.bottom)
        if not np.isfinite(edge.value):
            return WallForm(why=edge.why)
        if has_floor(self.cutter) and not self.cutter.conical:
            floor = max(floor, float(self.left.height(np.array([self._beside(side, edge.value)]))[0]))
        own = self.floors[1] if self.through else floor
        top = float(self.left.skin(np.array([edge.value]))[0]) if ideal.of_stock else self._carried(side, ideal)
        part = straight_part(self.cutter, own, top)
        if part is None:
            return WallForm(why=ROUND_WALL)
        found = wall_form(self.left, self.at[1], side, (max(part[0], self.bottom), part[1]))
        cone = self.cutter.half_angle if self.cutter.conical and part[0] == own else 0.0
        lean = found.angle - (0.5 * np.pi + cone + np.arcsin(abs(self.leans)))
        return WallForm(why=SEVERAL) if abs(lean) > MOST_LEAN else found

    def _beside(self, side: float, edge: float) -> float:
        """Where the floor ends beside a wall: a nose before an upright one, and at the end of a flat that leans."""
        nose = self.cutter.radius - self.cutter.flat_radius + (OWN - 1.0) * self.cutter.radius
        end = self.at[1] + side * min(0.98 * self.cutter.flat_radius, abs(edge - self.at[1]))
        return end if abs(self.leans) > UNDERCUT else edge - side * min(nose, abs(edge - self.at[1]))

    def _carried(self, side: float, ideal: Side) -> float:
        """Height of what the machined wall on a side carries, where the ideal one carries a ledge."""
        beyond = np.linspace(0.05, LIKE, 5) * self.cutter.radius
        w = self.edge(side, ideal).value + side * beyond
        return float(np.min(self.left.height(w)))

    def top(self, walls: dict[float, Side]) -> float:
        """From where depth counts: the stock's top over the axis, or the lowest of the ledges that the walls carry."""
        skin = float(self.left.skin(np.array([self.at[1]]))[0])
        ledges = [self._carried(side, wall) for side, wall in walls.items() if not wall.of_stock]
        return min([skin, *ledges])

    def floor_tilt(self) -> Found:
        """Lean (rad) of the machined floor across, rising to the left +, around the axis, half way to what ends it."""
        if self.through:
            return Found(why=NO_FLOOR)
        if not has_floor(self.cutter):
            return Found(why=ROUND_FLOOR)
        middle, floor = self.at[1], self.floors[1]
        most = min(0.5 * self.cutter.radius, 0.9 * self.cutter.flat_radius)
        ends, top = [], self.left.skin(np.array([middle]))
        for side in (-1.0, 1.0):
            edge = float(first_above(self.left, middle, side, top - AT_TOP * (top - floor), 2.0 * most)[0])
            room = abs((self.left.end(side) if np.isnan(edge) else edge) - middle)
            ends.append(side * min(0.5 * room, most))
        across = np.linspace(ends[0], ends[1], FLOOR_POINTS)
        z = self.left.height(middle + across) - floor
        if not self._straight(across, z):
            return Found(why=STEPPED_FLOOR)
        return Found(float(np.arctan(np.polyfit(across, z, 1)[0])))

    def flatness(self, w: FloatArray) -> Found:
        """Range of the machined floor over what of the ideal one is in reach of the section, beside walls and steps."""
        if self.through:
            return Found(why=NO_FLOOR)
        if not has_floor(self.cutter):
            return Found(why=ROUND_FLOOR)
        flat = np.abs(self.told.height(w) - self.floors[0]) <= ONE_HEIGHT
        beside = abs(self.shift) + self.cutter.radius - self.cutter.flat_radius + 2.0 * (w[1] - w[0])
        flat = _eroded(flat, int(np.ceil(beside / (w[1] - w[0])))) & self._in_reach(w)
        if flat.sum() < FLOOR_POINTS:
            return Found(why=LEANS if abs(self.leans) > UNDERCUT else "too little of the floor is in the section")
        return Found(float(np.ptp(self.left.height(w[flat]))))

    def _in_reach(self, w: FloatArray) -> BoolArray:
        return np.asarray(np.abs(w - self.at[0]) <= REACH * self.cutter.radius)

    def normal_error(self, w: FloatArray) -> dict[str, float]:
        """Machined against ideal along the free surface's normal, over what is cut in both: mean, largest (signed) and
        root mean square (m), and the local slope of the ideal one (rad)."""
        told, left, skin = self.told.height(w), self.left.height(w), self.told.skin(w)
        cut = (told < skin - ONE_HEIGHT) & (left < skin - ONE_HEIGHT) & self._in_reach(w)
        near = cut & (np.abs(w - self.at[0]) <= self.cutter.radius)
        if near.sum() < 3:
            return {}
        across = float(np.polyfit(w[near], told[near], 1)[0])
        steep = np.abs(np.gradient(np.stack([told, left]), w, axis=1) - across).max(axis=0) > STEEPER
        cut &= _eroded(~steep, int(np.ceil(LIKE * self.cutter.radius / (w[1] - w[0]))))
        if not cut.any():
            return {}
        slope = float(np.hypot(across, self.rises))
        error = (left - told)[cut] / np.hypot(1.0, slope)
        return {
            "error_mean": float(error.mean()),
            "error_max": float(error[np.argmax(np.abs(error))]),
            "error_rms": float(np.sqrt(np.mean(error**2))),
            "slope": float(np.arctan(slope)),
        }

    def wall_error(self, side: float, ideal: Side, direction: float) -> Found:
        """How far the machined wall stands from the ideal one along its normal, positive to the left of the feed;
        ``direction`` (the tangent) is how an ideal wall of another pass runs against the feed, NaN where it turns."""
        edge = self.edge(side, ideal)
        if not np.isfinite(edge.value):
            return edge
        off = edge.value - ideal.w
        if abs(off) > LIKE * self.cutter.radius + abs(self.shift):
            return Found(why=TAKEN if side * off > 0.0 else LEFT)
        return Found(off / np.hypot(1.0, direction)) if np.isfinite(direction) else Found(why=TURNS)

    def is_own(self, ideal: Side) -> bool:
        """Whether the pass itself was told to leave a wall: it stands as far from the axis as the cutter reaches."""
        rise = (ideal.top - self.floors[0]) * (1.0 if ideal.of_stock else 0.5)
        reaches = float(self.cutter.radius_at(max(rise, 0.0)))
        return abs(abs(ideal.w - self.at[0]) - reaches) <= (OWN - 1.0) * self.cutter.radius


def _eroded(mask: BoolArray, by: int) -> BoolArray:
    """What is left of a mask (q,) where everything ``by`` samples beside a False is False, too."""
    padded = np.concatenate([np.ones(by, dtype=bool), mask, np.ones(by, dtype=bool)])
    around = np.convolve(~padded, np.ones(2 * by + 1), mode="valid")
    return np.asarray(around < 0.5)
