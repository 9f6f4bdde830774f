"""Milling force from the process: cutter, material, feed and engagement give the mean force and its peak."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import chain, product
from typing import Any, ClassVar, Self

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.cutting.conditions import CutConditions, beyond_flutes
from robomill.cutting.course import CASES, INSTANTS, TEETH, Course, about_ends, evenly, force_at
from robomill.cutting.edge import EdgeTerm, mean_force
from robomill.cutting.engaged import FACING, full_slot
from robomill.cutting.force import ForceModel, ForceSpread
from robomill.cutting.materials import CALIBRATED, PUBLISHED, RUBS, Material
from robomill.cutting.numbers import Number, numbers_of, with_number
from robomill.cutting.tool import DISH, Cutter
from robomill.cutting.tooling import Tooling
from robomill.cutting.unjudged import Unjudged, against_hand
from robomill.errors import CuttingError
from robomill.lazy import cached_property
from robomill.progress import checkpoint, slices
from robomill.provenance import Finding, Provenance
from robomill.quantities import quantities, quantity, switch
from robomill.units import format_short, format_si

#: Share of a drill's tangential force that pushes along its axis, times the sine of half its point angle.
DRILL_THRUST = 0.5
WHY = {
    "spindle_speed": "the spindle's speed follows the diameter (G96) and is not read, so the chip is not known",
    "shank": "a shank that rubs above the flutes has no force model",
    "chip": f"a tooth that is fed less than {format_si(RUBS, 'um', 0)} rubs and has no chip",
    "feed_per_tooth": "teeth fed farther than their radius have no force model",
    "drill_sideways": "a drill led sideways has no force model",
}
"""Why a step in the material has no force, by its code."""


def _share(part: str) -> Any:
    low, high = PUBLISHED[part]
    hint = f"Of the tangential force, for a row that gives no {part} one. Published for aluminium: {low:g} to {high:g}."
    label = f"{part.capitalize()} share, assumed"
    return quantity(label, optional=True, least=0.0, most=3.0, digits=2, boxed=False, hint=hint)


@dataclass(frozen=True, repr=False)
class ProcessForce(ForceModel):
    """Mean force over a revolution from a cutter and a material row; parent of the models that differ in their rows.

    ``alternatives`` are other rows of the same alloy; ``by_material`` gives the force of each.
    ``axial`` False leaves out the axial component, to name what the helix adds.
    ``radial_share`` and ``axial_share`` are assumed of the tangential force where the row's source gives no such force;
    where they are not given either, what needs them is not judged.
    """

    cutter: Cutter
    material: Material
    alternatives: tuple[Material, ...] = ()
    axial: bool = switch(
        "Axial pull of the helix",
        default=True,
        hint="Off names what the feed force and the feed-normal force do alone.",
    )
    radial_share: float | None = _share("radial")
    axial_share: float | None = _share("axial")

    follows_cut: ClassVar[bool] = True
    ends_with_material: ClassVar[bool] = False
    stated: ClassVar[bool] = False

    def __post_init__(self) -> None:
        super().__post_init__()
        for row in (self.material, *self.alternatives):
            if self.takes is not None and not isinstance(row, self.takes):
                raise CuttingError(
                    f"{row.who} has {row.kind} coefficients; a {self.kind} force needs {self.takes.kind} ones.",
                    where="material",
                )

    @property
    def uncertain(self) -> list[Number]:
        """The coefficients of the material, and the shares that are assumed."""
        return numbers_of(self.material) + numbers_of(self)

    def changed(self, key: str, by: float) -> Self:
        """With one of its ``uncertain`` numbers changed ``by`` so much: the material's, or its own."""
        material = with_number(self.material, key, by)
        return with_number(self, key, by) if material is self.material else replace(self, material=material)

    @cached_property
    def row(self) -> Material:
        """The material in force, with what is assumed of it."""
        return self.material.completed(self._shares)

    @property
    def rows(self) -> tuple[Material, ...]:
        """The row in force, the others of its alloy, and, where shares are assumed, the row at the published ends."""
        return (self.row, *(each.completed(self._shares) for each in self.alternatives), *self.ends)

    @property
    def ends(self) -> tuple[Material, ...]:
        """The row with its assumed shares at the published ends; none where nothing is assumed."""
        assumed = [part for part in self.material.unknown if self._shares[part] is not None]
        ends = product(*(PUBLISHED[part] for part in assumed)) if assumed else ()
        return tuple(self.material.completed(dict(zip(assumed, end, strict=True))) for end in ends)

    @property
    def _shares(self) -> dict[str, float | None]:
        return {"radial": self.radial_share, "axial": self.axial_share}

    @property
    def provenance(self) -> Provenance:
        """Computed, from the material's source; assumed where a share is."""
        row = self.row
        source = f"{self.kind} force with {row.title}: {row.provenance.source}"
        return Provenance("computed" if row is self.material else "assumed", source)

    def findings(self, conditions: CutConditions) -> tuple[Finding, ...]:
        """What is assumed of the material (the law of a drill's thrust has none of it), and where its law is only
        carried on: feeds per tooth outside of where coefficients are measured."""
        engaged, found = conditions.engaged, []
        drilled = engaged.any() and self._tooling(conditions).drills[engaged].all()
        for part in () if drilled else self.material.unknown:
            if self._shares[part] is not None:
                low, high = PUBLISHED[part]
                text = (
                    f"{self.material.title}: its source gives no {part} force; assumed {self._shares[part]:g} of the "
                    f"tangential one (published for aluminium: {low:g} to {high:g}, and that is the range shown)."
                )
                found.append(Finding("warning", text, code=f"assumed-{part}-share"))
        c, (low, high) = self._fed(conditions), CALIBRATED
        usual = f"{format_si(low, 'mm', 2)} to {format_si(high, 'mm', 2)}"
        for i in (int(np.argmin(np.nan_to_num(c, nan=low))), int(np.argmax(np.nan_to_num(c, nan=high)))):
            if c[i] < low or c[i] > high:
                fed = format_short(c[i], "mm", 3)
                text = (
                    f"each tooth is fed {fed}; the material's coefficients are measured at about {usual}, and carried "
                )
                text += "on from there."
                found.append(Finding("warning", text, int(conditions.block[i]), code="feed-per-tooth"))
        return tuple(found)

    def _fed(self, conditions: CutConditions) -> FloatArray:
        """(m,) m: feed per tooth in the material, NaN elsewhere and where it is not known."""
        c = conditions.f_z(self._tooling(conditions).each("flutes"))
        return np.asarray(np.where(conditions.engaged, c, np.nan))

    @property
    def numbers(self) -> str:
        """The material, and whether the axial force is left out."""
        return self.row.title + ("" if self.axial else ", axial force left out")

    def cut_by(self, cutter: Cutter) -> Self:
        """The same material cut by another cutter."""
        return self if cutter == self.cutter else replace(self, cutter=cutter)

    @property
    def exponents(self) -> tuple[float, ...]:
        """Those of the material and of its alternatives."""
        return tuple(sorted({term.exponent for row in self.rows for term in row.terms}, reverse=True))

    def unjudged(self, conditions: CutConditions) -> tuple[Unjudged, ...]:
        """Spindles that turn the wrong way or nobody knows how fast, drills led sideways, forces unknown."""
        engaged = conditions.engaged
        if not engaged.any():
            return ()
        tooling = self._tooling(conditions)
        drill, c = tooling.drills, self._fed(conditions)
        reasons = {
            "spindle_speed": ~np.isfinite(conditions.n_s),
            "shank": beyond_flutes(conditions, tooling),
            "chip": c < RUBS,
            "feed_per_tooth": c > tooling.each("radius"),
            "drill_sideways": drill & (conditions.across > DISH),
        }
        found = (Unjudged.at(code, engaged & where, WHY[code]) for code, where in reasons.items())
        lacking = self._unknown(conditions, tooling)
        return (*against_hand(conditions, tooling), *chain.from_iterable(found), *lacking)

    def _unknown(self, conditions: CutConditions, tooling: Tooling) -> tuple[Unjudged, ...]:
        """Steps whose force has a part that the material does not give: every mill's the radial one; the axial one,
        where the helix pulls, along the axis, on a nose or at the end face."""
        if not self.row.unknown:
            return ()
        mills = ~tooling.drills
        nose = (tooling.each("nose_height") > 0.0) | (conditions.sinks > 0.0)
        needs = {"radial": mills, "axial": mills & (tooling.each("pull") != 0.0) & (self.axial | nose)}
        lacking = [part for part in self.row.unknown if (needs[part] & conditions.engaged).any()]
        if not lacking:
            return ()
        where = np.any([needs[part] for part in lacking], axis=0)
        names = (name for name in self.row.missing if self.material.gives[name] in lacking)
        shares = " and ".join(quantities(type(self))[f"{part}_share"].label for part in lacking)
        why = (
            f"the {' and the '.join(lacking)} force of {self.material.title} is not known; assume a share of the "
            f"tangential force ({shares}), or take another material"
        )
        return Unjudged.at("coefficient", conditions.engaged & where, why, (*names, *(f"{p}_share" for p in lacking)))

    def components(self, conditions: CutConditions) -> FloatArray:
        """Mean force ON the tool (m, 3) N: feed, feed-normal, axial; 0 in air and on rapids.

        Raises CuttingError where the tool cuts with its spindle stopped or without feed.
        """
        return self._mean(self.row, conditions)

    def by_material(self, conditions: CutConditions) -> list[tuple[Material, FloatArray]]:
        """Mean force (m, 3) N for each of ``rows``; what a row's source does not give is as in the row in force."""
        return [(row, self._mean(row.filled(self.row), conditions)) for row in self.rows]

    def at_ends(self, conditions: CutConditions) -> list[FloatArray]:
        """Mean force (m, 3) N for each of ``ends``."""
        return [self._mean(row, conditions) for row in self.ends]

    def peak(self, conditions: CutConditions) -> ForceSpread:
        """Extremes over a revolution, with the lag of the helix (teeth alike, no run-out); 0 where ``components`` is.

        The course is that of the engaged part sector by sector, about the mean force. Steps that cut alike (their
        numbers are the same to ten bits) are computed once.
        """
        zeros = np.zeros((len(conditions), 3))
        spread = ForceSpread(zeros.copy(), zeros.copy(), zeros.copy())
        mean = self.components(conditions)
        for cutter, made in self._tooling(conditions).steps_of_each():
            index = np.flatnonzero(made & np.isfinite(mean).all(axis=1) & conditions.engaged)
            if not index.size:
                continue
            course, kind = Course.kinds(conditions, cutter, index)
            order = np.argsort(kind, kind="stable")
            for cases in slices(len(course.c), "Force over a turn", max(TEETH // cutter.flutes, 1)):
                turns = self._over_turn(cutter, course.at(cases))
                rows = order[slice(*np.searchsorted(kind[order], [cases.start, cases.stop]))]
                for some in np.array_split(rows, len(rows) // CASES + 1):
                    checkpoint()
                    about, case = mean[index[some]], kind[some] - cases.start
                    spread.low[index[some]] = about + turns.min(-2)[case]
                    spread.high[index[some]] = about + turns.max(-2)[case]
                    course_of = about[:, None] + turns[case]
                    largest = np.argmax(np.linalg.norm(course_of, axis=-1), axis=-1)
                    spread.at_peak[index[some]] = course_of[np.arange(len(some)), largest]
        return spread

    def _over_turn(self, cutter: Cutter, course: Course) -> FloatArray:
        """Force (k, t, 3) N, less its mean, at instants of a turn that show its extremes."""
        ends = about_ends(cutter, course)
        angle = np.hstack([np.broadcast_to(evenly(cutter), (len(ends), INSTANTS)), ends])
        turns = force_at(edge_terms(self.row, cutter), cutter, course, angle)
        turns[..., 2] *= self.axial
        return np.asarray(turns - turns[:, :INSTANTS].mean(axis=-2, keepdims=True))

    def _tooling(self, conditions: CutConditions) -> Tooling:
        return Tooling.of(conditions.tooling or self.cutter, len(conditions))

    def _mean(self, material: Material, conditions: CutConditions) -> FloatArray:
        tooling = self._tooling(conditions)
        c = conditions.f_z(tooling.each("flutes"))
        result = np.zeros((len(conditions), 3))
        for cutter, made in tooling.steps_of_each():
            index = np.flatnonzero(made & conditions.engaged)
            for some in slices(len(index), "Force"):
                i = index[some]
                result[i] = _mean_of(material, cutter, conditions, (i, c[i]))
        result[:, 2] *= self.axial
        return result


def edge_terms(material: Material, cutter: Cutter) -> tuple[EdgeTerm, ...]:
    """The material's law on the edges of a cutter.

    On the lips of a drill the tangential part is the material's; what pushes along their normal is half of it, which
    makes the handbook's thrust 0.5 k_c f (D / 2) sin(half the point angle) (Sandvik Coromant, Metal cutting technology:
    drilling formulas). The chisel edge and the margins are left out.
    """
    if not cutter.family.drills:
        return material.terms
    return tuple(EdgeTerm(term.exponent, term.Kt, DRILL_THRUST * term.Kt, 0.0) for term in material.terms)


def _mean_of(
    material: Material, cutter: Cutter, conditions: CutConditions, steps: tuple[IntArray, FloatArray]
) -> FloatArray:
    """Mean force (k, 3) N of some steps (their indices and feeds per tooth) that one cutter makes."""
    index, c = steps
    terms = edge_terms(material, cutter)
    if conditions.part is not None:
        return conditions.part.force(terms, cutter, c, index)
    a_p, along = conditions.a_p[index], conditions.along[index]
    arc = (np.clip(phi[index], 0.0, np.pi) for phi in (conditions.phi_st, conditions.phi_ex))
    force = mean_force(terms, cutter, c, a_p, *arc)
    steep = np.flatnonzero(np.abs(along) > FACING)
    if steep.size:
        exponents = tuple(term.exponent for term in terms)
        force[steep] = full_slot(cutter, exponents, a_p[steep], along[steep], conditions.sinks[index][steep]).force(
            terms, cutter, c[steep]
        )
    return force
