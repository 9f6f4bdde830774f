"""From the material: Kienzle's coefficients."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from robomill.arguments import asking
from robomill.cutting.edge import EdgeTerm
from robomill.cutting.materials import Material, per_area
from robomill.cutting.process import ProcessForce
from robomill.quantities import quantity
from robomill.units import to_si

#: Chip thickness and width at which kc1.1 holds.
REFERENCE_CHIP = to_si(1.0, "mm")


@asking
@dataclass(frozen=True, repr=False)
class KienzleRow(Material):
    """F_t = kc11 (h / 1 mm)^(-mc) h b, kc11 in N/m^2; radial_ratio and axial_ratio are F_r / F_t and F_a / F_t.

    Examples
    --------
    >>> import robomill as rm
    >>> row = rm.load_material("steel_c45_annealed_kienzle")
    >>> isinstance(row, rm.KienzleRow), row.kc11 * 1e-6, row.mc
    (True, 1500.0, 0.22)
    """

    kind: ClassVar[str] = "kienzle"
    gives: ClassVar[Mapping[str, str]] = {"radial_ratio": "radial", "axial_ratio": "axial"}

    kc11: float = per_area("kc11", leads=True)
    mc: float = quantity("mc", least=0.0, below=1.0)
    radial_ratio: float | None = quantity("radial_ratio", optional=True, least=0.0)
    axial_ratio: float | None = quantity("axial_ratio", optional=True, least=0.0)

    @property
    def terms(self) -> tuple[EdgeTerm, ...]:
        """One term, in the power of the chip."""
        K = self.kc11 * REFERENCE_CHIP**self.mc
        return (EdgeTerm(1.0 - self.mc, K, K * (self.radial_ratio or 0.0), K * (self.axial_ratio or 0.0)),)


@asking
@dataclass(frozen=True, repr=False)
class KienzleForce(ProcessForce):
    """Kienzle's kc = kc1.1 (h / 1 mm)^(-mc), its mean over the arc as incomplete beta integrals.

    Examples
    --------
    >>> import robomill as rm
    >>> cutter = rm.Cutter("flat", diameter_mm=8, flutes=3)
    >>> isinstance(rm.process_force("steel_c45_annealed_kienzle", cutter), rm.KienzleForce)
    True
    """

    kind: ClassVar[str] = "kienzle"
    title: ClassVar[str] = "From the material, Kienzle"
    rank: ClassVar[int] = 4
    takes: ClassVar[type[Material] | None] = KienzleRow
    example: ClassVar[str] = "al_wrought_cured_kienzle"
