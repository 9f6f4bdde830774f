"""From the material: mechanistic coefficients."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from robomill.arguments import asking
from robomill.cutting.edge import EdgeTerm
from robomill.cutting.materials import Material, per_area
from robomill.cutting.process import ProcessForce
from robomill.errors import CuttingError
from robomill.quantities import quantity
from robomill.units import to_si


def _per_length(label: str, *, optional: bool = False) -> Any:
    return quantity(label, "N/mm", optional=optional, least=0.0, most=to_si(1e3, "N/mm"))


@asking
@dataclass(frozen=True, repr=False)
class MechanisticRow(Material):
    """Ktc, Krc, Kac (N/m^2): per chip area, tangential, radial, axial; Kte, Kre, Kae (N/m): per length of edge.

    Examples
    --------
    >>> import robomill as rm
    >>> isinstance(rm.load_material("al7075_t6_carbide_ref190"), rm.MechanisticRow)
    True
    """

    kind: ClassVar[str] = "mechanistic"
    gives: ClassVar[Mapping[str, str]] = {"Kac": "axial", "Kae": "axial"}

    Ktc: float = per_area("Ktc", leads=True)
    Kte: float = _per_length("Kte")
    Krc: float = per_area("Krc")
    Kre: float = _per_length("Kre")
    Kac: float | None = per_area("Kac", optional=True)
    Kae: float | None = _per_length("Kae", optional=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.Kac is None) != (self.Kae is None):
            missing, given = ("Kac", "Kae") if self.Kac is None else ("Kae", "Kac")
            raise CuttingError(f"{self.who}: {given} is given without {missing}; give both, or neither.", where=missing)

    def tangential(self, name: str) -> float:
        """Of the chip for what the chip causes, of the edge for what the edge does."""
        return {"Kac": self.Ktc, "Kae": self.Kte}[name]

    @property
    def terms(self) -> tuple[EdgeTerm, ...]:
        """Those of the chip and those of the edge."""
        return (
            EdgeTerm(1.0, self.Ktc, self.Krc, self.Kac or 0.0),
            EdgeTerm(0.0, self.Kte, self.Kre, self.Kae or 0.0),
        )


@asking
@dataclass(frozen=True, repr=False)
class MechanisticForce(ProcessForce):
    """Chip and edge coefficients (Ktc..Kae), closed form of the mean (Altintas, Manufacturing Automation).

    Examples
    --------
    >>> import robomill as rm
    >>> cutter = rm.Cutter("flat", diameter_mm=8, flutes=3)
    >>> isinstance(rm.process_force("al7075_t6_carbide_ref190", cutter), rm.MechanisticForce)
    True
    """

    kind: ClassVar[str] = "mechanistic"
    title: ClassVar[str] = "From the material, mechanistic"
    rank: ClassVar[int] = 3
    takes: ClassVar[type[Material] | None] = MechanisticRow
    example: ClassVar[str] = "al7075_t6_carbide_ref190"
