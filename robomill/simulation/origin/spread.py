"""How far the answer moves with what is not known for sure: the alloy's other coefficients, the peak of a turn."""

from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.deflection import displacement
from robomill.cutting.force import ForceSpread, force_by_material
from robomill.cutting.materials import Material
from robomill.simulation.result import SimulationResult


@dataclass(frozen=True, eq=False)
class AlloySpread:
    """The same run with every coefficient row of the alloy, the one in force first.

    materials (r,), the rows; F (r, m, 3) N and delta (r, m, 3) m in {M}.
    """

    materials: tuple[Material, ...]
    F: FloatArray
    delta: FloatArray

    @property
    def titles(self) -> tuple[str, ...]:
        """(r,) what the rows are called."""
        return tuple(material.title for material in self.materials)

    @property
    def axial(self) -> tuple[bool, ...]:
        """(r,) whether a row knows the axial force."""
        return tuple("axial" not in material.unknown for material in self.materials)

    @property
    def deviation(self) -> FloatArray:
        """(r, m) m: size of the path deviation."""
        return np.asarray(np.linalg.norm(self.delta, axis=-1))


def alloy_spread(result: SimulationResult) -> AlloySpread | None:
    """The run's one-pass deflection for each row of the alloy; None where the force is not computed from a material.

    The part of delta that the force does not cause (sag) stays; coupling is not iterated anew.
    """
    rows = force_by_material(result.setup.force, result.conditions, result.R_MF)
    if not rows:
        return None
    C = result.C
    F = np.stack([f for _, f in rows])
    rest = result.delta - displacement(C, result.F)
    delta = displacement(C, F) + rest
    return AlloySpread(tuple(material for material, _ in rows), F, delta)


def peak_force(result: SimulationResult) -> ForceSpread | None:
    """Extremes of the force over a revolution, feed frame, (m, 3) N; None where only a mean is known."""
    return result.setup.force.peak(result.conditions)
