"""Milling force from the process: cutter, material, feed and engagement give the mean force and its peak."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.conditions import CutConditions
from robomill.cutting.edge import force_over_pitch, mean_force
from robomill.cutting.force import PLUNGE, ForceModel, ForceSpread
from robomill.cutting.materials import Material
from robomill.cutting.tool import Cutter
from robomill.errors import CuttingError
from robomill.provenance import Provenance
from robomill.quantities import switch

#: Cuts whose revolution is computed at once, to bound the memory.
CASES = 2048


@dataclass(frozen=True)
class ProcessForce(ForceModel):
    """Mean force over a revolution from a cutter and a material row; parent of the models that differ in their rows.

    ``alternatives`` are other rows of the same alloy; ``by_material`` gives the force of each.
    ``axial`` False leaves out the axial component, to name what the helix adds.
    """

    cutter: Cutter
    material: Material
    alternatives: tuple[Material, ...] = ()
    axial: bool = switch(
        "Axial pull of the helix",
        default=True,
        hint="Off names what the feed force and the feed-normal force do alone.",
    )

    follows_cut: ClassVar[bool] = True
    ends_with_material: ClassVar[bool] = False
    stated: ClassVar[bool] = False

    def __post_init__(self) -> None:
        super().__post_init__()
        for row in (self.material, *self.alternatives):
            if row.kind != self.takes:
                raise CuttingError(
                    f"Material {row.name!r} has {row.kind} coefficients; a {self.kind} force needs {self.takes} ones.",
                    where="material",
                )

    @property
    def provenance(self) -> Provenance:
        """Computed, from the material's source."""
        return Provenance(
            "computed", f"{self.kind} force with {self.material.title}: {self.material.provenance.source}"
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """Unknown coefficients taken as 0."""
        return self.material.notes

    @property
    def numbers(self) -> str:
        """The material, and whether the axial force is left out."""
        return self.material.title + ("" if self.axial else ", axial force left out")

    def cut_by(self, cutter: Cutter) -> Self:
        """The same material cut by another cutter."""
        return self if cutter == self.cutter else replace(self, cutter=cutter)

    def components(self, conditions: CutConditions) -> FloatArray:
        """Mean force ON the tool (m, 3) N: feed, feed-normal, axial; 0 in air, on rapids and in a plunge.

        Only the feed across the tool axis makes chips aside; the thrust of a plunge is not modelled.
        Raises CuttingError where the tool cuts with its spindle stopped or without feed.
        """
        return self._mean(self.material, conditions)

    def by_material(self, conditions: CutConditions) -> list[tuple[Material, FloatArray]]:
        """Mean force (m, 3) N for ``material`` and each of ``alternatives``."""
        return [(row, self._mean(row, conditions)) for row in (self.material, *self.alternatives)]

    def peak(self, conditions: CutConditions) -> ForceSpread:
        """Extremes over a revolution, with the lag of the helix (teeth alike, no run-out); 0 where ``components`` is.

        Steps that cut alike (feed, depth and arc within a thousandth of the largest) are computed once.
        """
        zeros = np.zeros((len(conditions), 3))
        spread = ForceSpread(zeros.copy(), zeros.copy(), zeros.copy())
        load, index = self._loads(conditions)
        if not index.size:
            return spread
        scale = np.max(np.abs(load), axis=0) * 1e-3
        alike = np.round(load / np.where(scale > 0.0, scale, 1.0))
        _, first, inverse = np.unique(alike, axis=0, return_index=True, return_inverse=True)
        cases = load[first]
        for start in range(0, len(cases), CASES):
            part = cases[start : start + CASES]
            c, a_p, *arc = part.T
            turns = force_over_pitch(self.material.terms, self.cutter, c, a_p, (arc[0], arc[1]))
            turns[..., 2] *= self.axial
            rows = np.flatnonzero((inverse >= start) & (inverse < start + len(part)))
            case = inverse[rows] - start
            largest = np.argmax(np.linalg.norm(turns, axis=-1), axis=-1)
            spread.low[index[rows]] = turns.min(-2)[case]
            spread.high[index[rows]] = turns.max(-2)[case]
            spread.at_peak[index[rows]] = turns[case, largest[case]]
        return spread

    def _loads(self, conditions: CutConditions) -> tuple[FloatArray, np.ndarray]:
        """Feed per tooth, depth and arc (k, 4) of the steps that make chips aside, and their indices (k,)."""
        c = conditions.f_z(self.cutter.flutes) * conditions.across
        index = np.flatnonzero(conditions.engaged & (conditions.across > PLUNGE))
        ends = (np.clip(phi[index], 0.0, np.pi) for phi in (conditions.phi_st, conditions.phi_ex))
        return np.stack([c[index], conditions.a_p[index], *ends], axis=1), index

    def _mean(self, material: Material, conditions: CutConditions) -> FloatArray:
        load, index = self._loads(conditions)
        result = np.zeros((len(conditions), 3))
        result[index] = mean_force(material.terms, self.cutter, *load.T)
        result[:, 2] *= self.axial
        return result
