"""From the material: mechanistic coefficients."""

from dataclasses import dataclass
from typing import ClassVar

from robomill.cutting.process import ProcessForce


@dataclass(frozen=True)
class MechanisticForce(ProcessForce):
    """Chip and edge coefficients (Ktc..Kae), closed form of the mean (Altintas, Manufacturing Automation)."""

    kind: ClassVar[str] = "mechanistic"
    title: ClassVar[str] = "From the material, mechanistic"
    rank: ClassVar[int] = 3
    takes: ClassVar[str] = "mechanistic"
    example: ClassVar[str] = "al7075_t6_carbide_ref190"
