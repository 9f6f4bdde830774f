"""From the material: Kienzle's coefficients."""

from dataclasses import dataclass
from typing import ClassVar

from robomill.cutting.process import ProcessForce


@dataclass(frozen=True)
class KienzleForce(ProcessForce):
    """Kienzle's kc = kc1.1 (h / 1 mm)^(-mc), its mean over the arc as incomplete beta integrals."""

    kind: ClassVar[str] = "kienzle"
    title: ClassVar[str] = "From the material, Kienzle"
    rank: ClassVar[int] = 4
    takes: ClassVar[str] = "kienzle"
    example: ClassVar[str] = "al_wrought_cured_kienzle"
