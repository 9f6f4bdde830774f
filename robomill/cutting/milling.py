"""Milling force from the process: cutter, material, feed and engagement give the mean force and its peak."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.conditions import CutConditions, cut_warnings
from robomill.cutting.edge import force_over_pitch, mean_force
from robomill.cutting.force import PLUNGE, Frame
from robomill.cutting.materials import Material
from robomill.cutting.tool import Cutter
from robomill.errors import CuttingError
from robomill.provenance import Provenance


@dataclass(frozen=True, eq=False)
class ForceSpread:
    """Lowest and highest of each component, each (m, 3) N: over a revolution, or over alternative coefficients.

    ``at_peak`` (m, 3) is the force vector at the instant (or for the coefficients) at which it is largest.
    """

    low: FloatArray
    high: FloatArray
    at_peak: FloatArray


@dataclass(frozen=True)
class ProcessForce:
    """Mean force over a revolution from a cutter and a material row; parent of the two models below.

    ``alternatives`` are other rows of the same alloy; ``band`` is the range they span together with ``material``.
    ``axial`` False leaves out the axial component, to name what the helix adds.
    """

    cutter: Cutter
    material: Material
    alternatives: tuple[Material, ...] = ()
    axial: bool = True

    kind: ClassVar[str] = ""
    frame: ClassVar[Frame] = "path"

    def __post_init__(self) -> None:
        for row in (self.material, *self.alternatives):
            if row.kind != self.kind:
                raise CuttingError(
                    f"Material {row.name!r} has {row.kind} coefficients; a {self.kind} force needs {self.kind} ones.",
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

    def warnings(self, conditions: CutConditions) -> tuple[str, ...]:
        """Depth beyond the flutes, plunging: see ``cut_warnings``."""
        return cut_warnings(self.cutter, conditions)

    def components(self, conditions: CutConditions) -> FloatArray:
        """Mean force ON the tool (m, 3) N: feed, feed-normal, axial; 0 in air, on rapids and in a plunge.

        Only the feed across the tool axis makes chips aside; the thrust of a plunge is not modelled.
        Raises CuttingError where the tool cuts with its spindle stopped or without feed.
        """
        return self._mean(self.material, conditions)

    def band(self, conditions: CutConditions) -> ForceSpread:
        """Range of the mean force over ``material`` and ``alternatives``."""
        rows = np.stack([force for _, force in self.by_material(conditions)])
        largest = np.argmax(np.linalg.norm(rows, axis=-1), axis=0)
        return ForceSpread(rows.min(0), rows.max(0), rows[largest, np.arange(rows.shape[1])])

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
        for start in range(0, len(cases), 2048):
            part = cases[start : start + 2048]
            turns = force_over_pitch(self.material.terms, self.cutter, *part.T)
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


@dataclass(frozen=True)
class MechanisticForce(ProcessForce):
    """Chip and edge coefficients (Ktc..Kae), closed form of the mean (Altintas, Manufacturing Automation)."""

    kind: ClassVar[str] = "mechanistic"


@dataclass(frozen=True)
class KienzleForce(ProcessForce):
    """Kienzle's kc = kc1.1 (h / 1 mm)^(-mc), its mean over the arc as incomplete beta integrals."""

    kind: ClassVar[str] = "kienzle"
