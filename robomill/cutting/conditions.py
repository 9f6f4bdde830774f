"""How the tool cuts at every step of the path: feed, speed, depth and the arc of engagement. SI, rad.

The engagement angle phi is seen from the spindle, measured clockwise from the left of the feed:
phi = 0 is the left of the feed, pi/2 straight ahead, pi the right. It is geometry and does not depend on the
cutter's hand; a right-hand cutter's teeth run from 0 to pi.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, IntArray, as_floats, frozen, made_array, sealed
from robomill.cutting.engaged import EngagedPart, sinks
from robomill.cutting.tool import DISH, Cutter
from robomill.cutting.tooling import Tooling
from robomill.errors import CuttingError
from robomill.provenance import Finding
from robomill.units import format_count, format_si

STRAIGHT = 1e-6  # share of the feed across the tool axis below which a move goes straight along that
STEEP = 0.5  # share of it below which a move goes mostly along the axis: its wall is a hole's
WHOLE = ("part", "tooling", "block_name")  # fields that are values of their own


@dataclass(frozen=True, eq=False)
class CutConditions:
    """Arrays of shape (m,), one entry a step of the path; a scalar stands for all steps.

    v_f      m/s    feed rate along the path
    n_s      1/s    spindle revolutions per second, 0 where stopped
    a_p      m      axial depth of cut, 0 in air
    phi_st   rad    start of the arc of engagement, 0..pi clockwise from the left of the feed
    phi_ex   rad    end of the arc; equal to phi_st in air
    cutting  bool   False on rapids
    s        m      path length from the start
    t        s      time from the start
    across   1      share of the feed across the tool axis: 1 on the level, 0 in a plunge
    block    int    source line, 0 where not stated (refusals name it)
    along    1      part of the unit feed along the tool axis: negative on the way down
    steep    1      how steeply its end ``sinks``, 0 to 1 (None: as the feed goes down)
    ccw      bool   True where the spindle runs counter-clockwise seen from above (M4)
    part            the engaged part of the cutter, where it was found from the stock (None: the arc over the depth)
    reach    m      highest engaged place above the tip (None: a_p)
    tooling         which cutter makes which step (None: one for all)

    The spindle's speed is NaN where it is not known (it turns, but who knows how fast): such steps are not judged.

    Raises CuttingError for lengths that differ, values that are not finite, or an arc the wrong way round.
    """

    v_f: FloatArray
    n_s: FloatArray
    a_p: FloatArray
    phi_st: FloatArray
    phi_ex: FloatArray
    cutting: BoolArray
    s: FloatArray
    t: FloatArray
    across: FloatArray = made_array(1.0)
    block: IntArray = made_array(0)
    along: FloatArray = made_array(0.0)
    ccw: BoolArray = made_array(False)
    part: EngagedPart | None = None
    reach: FloatArray | None = None
    tooling: Tooling | None = None
    steep: FloatArray | None = None
    block_name: str = "line"

    def __post_init__(self) -> None:
        names = [
            field.name for field in fields(self) if field.name not in WHOLE and getattr(self, field.name) is not None
        ]
        m = max(np.size(getattr(self, name)) for name in names)
        for name in names:
            value = as_floats(
                getattr(self, name),
                f"cutting conditions, {name}",
                (),
                error=CuttingError,
                finite=name != "n_s",
            )
            if value.shape not in ((), (1,), (m,)):
                raise CuttingError(f"Cutting conditions, {name}: expected {m} values, found shape {value.shape}.")
            dtype: Any = {"cutting": bool, "ccw": bool, "block": np.int64}.get(name, np.float64)
            object.__setattr__(self, name, frozen(np.broadcast_to(value, (m,)), dtype))
        self._check_signs()

    def _check_signs(self) -> None:
        for name in ("v_f", "n_s", "a_p"):
            bad = np.flatnonzero(self.cutting & (getattr(self, name) < 0.0))
            if bad.size:
                raise CuttingError(f"{self.place(bad[0])}: {name} is negative; it must be 0 or more.", where=name)
        small = 1e-9
        wrong = (self.phi_st < -small) | (self.phi_ex > np.pi + small) | (self.phi_ex < self.phi_st - small)
        bad = np.flatnonzero(self.cutting & wrong)
        if bad.size:
            i = bad[0]
            raise CuttingError(
                f"{self.place(i)}: arc of engagement from {format_si(self.phi_st[i], 'deg')} to "
                f"{format_si(self.phi_ex[i], 'deg')}; expected 0° <= start <= end <= 180°.",
                where="phi_st",
            )

    def at(self, i: int) -> CutConditions:
        """(1,) those of step ``i`` alone, whose part is not known yet."""
        arrays = {name: value[i : i + 1] for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        tooling = None if self.tooling is None else Tooling(self.tooling.cutters, self.tooling.of_step[i : i + 1])
        return self._with(**arrays, tooling=tooling, part=None)

    def meeting(self, **found: Any) -> CutConditions:
        """With what a march has ``found``: a_p, phi_st, phi_ex, reach, part."""
        return self._with(**found)

    def _with(self, **values: Any) -> CutConditions:
        """With values that nobody gives and so need no check: a coupled march asks for them at every turn."""
        made = object.__new__(type(self))
        vars(made).update(vars(self), **values)
        return made

    def place(self, i: int) -> str:
        """Where step ``i`` is for people: its source line, or its number where no line is stated."""
        return f"{self.block_name.capitalize()} {self.block[i]}" if self.block[i] > 0 else f"Step {i}"

    def __len__(self) -> int:
        return len(self.v_f)

    @property
    def engaged(self) -> BoolArray:
        """(m,) True where the cutter cuts material; not where it only stands in it or is drawn out of it."""
        if self.part is not None:
            return sealed(np.asarray(self.cutting & self.part.touches))
        down = (self.across > STRAIGHT) | (self.along < 0.0)
        return sealed(np.asarray(self.cutting & (self.a_p > 0.0) & (self.phi_ex > self.phi_st) & down))

    @property
    def highest(self) -> FloatArray:
        """(m,) m above the tip: how high the cutter cuts."""
        return self.a_p if self.reach is None else self.reach

    @property
    def sinks(self) -> FloatArray:
        """(m,) how steeply the end of the tool sinks, 0 to 1."""
        return sealed(sinks(self.along) if self.steep is None else self.steep)

    @property
    def mostly_axial(self) -> BoolArray:
        """(m,) True where the tool goes more along its axis than across it, down or up: what stands beside is a
        hole's."""
        return sealed(self.across < STEEP)

    @property
    def plunges(self) -> BoolArray:
        """(m,) True where that is the way down, on rapids, too."""
        return sealed(self.mostly_axial & (self.along < 0.0))

    def f_z(self, flutes: ArrayLike) -> FloatArray:
        """Feed per tooth (m,) m: v_f / (n_s flutes); 0 outside the material, NaN where the speed is not known.

        Raises CuttingError where the tool is in the material with its spindle stopped or without a feed.
        """
        engaged = self.engaged
        for name, text in (("n_s", "the spindle stands still"), ("v_f", "the feed rate is 0")):
            lacking = engaged & (getattr(self, name) <= 0.0)
            if lacking.any():
                word = "S and M3 before the cut" if name == "n_s" else "F before the cut"
                if name == "n_s" and not self.n_s.any():
                    word += ", or a spindle speed (spindle_1_min of the set-up's source)"
                if self.block_name != "line":
                    word = "the path spindle_1_min" if name == "n_s" else "it feed_mm_min"
                where = f"{self.place(int(np.argmax(lacking)))}: {text} while the tool is in the material"
                raise CuttingError(f"{where}; give {word}.", where=name)
        result = np.zeros(len(self))
        return np.divide(self.v_f, self.n_s * np.asarray(flutes), out=result, where=engaged)

    def chip(self, i: int, flutes: int) -> float:
        """What one tooth is fed at step ``i``, m, whatever it meets there."""
        return float(self.v_f[i] / (self.n_s[i] * flutes))

    @classmethod
    def steady(
        cls,
        v_f: ArrayLike,
        n_s: ArrayLike,
        a_p: ArrayLike,
        *,
        arc: tuple[float, float] = (0.0, np.pi),
        **others: Any,
    ) -> CutConditions:
        """The same arc everywhere, a full slot unless ``arc`` (phi_st, phi_ex) says otherwise; cutting, s = t = 0."""
        given: dict[str, Any] = {"cutting": True, "s": 0.0, "t": 0.0, **others}
        return cls(v_f=v_f, n_s=n_s, a_p=a_p, phi_st=arc[0], phi_ex=arc[1], **given)  # type: ignore[arg-type]


def beyond_flutes(conditions: CutConditions, tooling: Tooling) -> BoolArray:
    """(m,) whether a step is engaged above the cutter's edges."""
    edges = np.array([each.edge_height for each in tooling.cutters])
    return np.asarray(conditions.engaged & (conditions.highest > edges[tooling.of_step] * (1.0 + 1e-9)))


THRUSTS = {
    "thrust-end-teeth": "of the end teeth, to the centre, by the same coefficients as the flank",
    "thrust-lips": "of a drill's two lips by the handbook, 0.5 k_c f D/2 sin(half point angle)",
}
"""Where the thrust of a tool that goes down comes from."""


def cut_warnings(cutter: Cutter, conditions: CutConditions, computed: bool | BoolArray = True) -> tuple[Finding, ...]:
    """What deserves a word though it can be computed: depth beyond the flutes and, where the force is ``computed`` (for
    all, or (m,)) from the material, what the thrust of a plunge or of a drill is, and where it is taken as none."""
    found = []
    engaged = conditions.engaged
    tooling = Tooling.of(conditions.tooling or cutter, len(conditions))
    highest = conditions.highest
    beyond = beyond_flutes(conditions, tooling)
    for each, made in tooling.steps_of_each():
        deep = np.flatnonzero(beyond & made)
        if deep.size:
            worst = deep[np.argmax(highest[deep])]
            end, rubs = ("stick-out", "holder") if each.flute_length is None else ("flute length", "shank")
            text = (
                f"depth {format_si(highest[worst], 'mm')} is beyond the {end} {format_si(each.edge_height, 'mm')}; "
                f"the {rubs} would rub ({format_count(deep.size, 'step')})."
            )
            found.append(Finding("warning", text, int(conditions.block[worst]), code="beyond-flutes"))
    sinks = conditions.sinks > 0.0
    down = engaged & (conditions.along < -DISH) & sinks & computed
    for code, steps in (("thrust-end-teeth", down & ~tooling.drills), ("thrust-lips", down & tooling.drills)):
        if steps.any():
            count = format_count(int(steps.sum()), "step")
            text = f"the tool goes down into the material; its thrust is that {THRUSTS[code]}: not measured ({count})."
            found.append(Finding("info", text, int(conditions.block[np.argmax(steps)]), code=code))
    heel = engaged & sinks & ~(conditions.along < -DISH) & computed & (tooling.each("flat_radius") > 0.0)
    if heel.any():
        slope, count = format_si(math.asin(DISH), "deg", 1), format_count(int(heel.sum()), "step")
        text = (
            f"the tool goes down by less than {slope}: its end is taken as ground hollow by as much, so that its heel "
            f"cuts and no more of its end: assumed ({count})."
        )
        found.append(Finding("info", text, int(conditions.block[np.argmax(heel)]), code="end-teeth-heel"))
    return tuple(found)
