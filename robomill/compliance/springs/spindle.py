"""Spindle, holder and their bearings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.compliance.spring import ASSUMED, Spring, about_tool
from robomill.cutting.tool import Cutter
from robomill.errors import RobotError
from robomill.provenance import Provenance
from robomill.quantities import quantity
from robomill.spelled import in_units
from robomill.units import format_short, to_si

TYPICAL = Provenance("assumed", "20 N/µm across and 50 N/µm along, typical of a milling spindle with its holder")


STIFFEST = 1e-11  # m/N: nothing gives as little without being called rigid: was it meant in m/N?
SOFT = 5e-6  # m/N: the softest spindles and longest tools give way a tenth as much
UNIT_SLIP = 1e-3  # m/N: no spindle gives as much: was it meant in um/N?


@in_units(RobotError, "Spindle and holder")
@dataclass(frozen=True, repr=False)
class SpindleSpring(Spring):
    """Spindle, holder and bearings as springs at the tip: ``lateral`` and ``axial`` compliance, m/N; 0 is rigid.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.SpindleSpring(5e-8, 2e-8).name
    'spindle and holder'
    """

    kind: ClassVar[str] = "spindle"
    title: ClassVar[str] = "Spindle and holder"
    follows_tooth: ClassVar[bool] = True
    at_tip: ClassVar[bool] = True
    rank: ClassVar[int] = 2

    lateral: float = quantity("Across", "um/N", least=0.0, digits=4, slip=UNIT_SLIP, tiny=STIFFEST)
    axial: float = quantity("Along", "um/N", default=0.0, least=0.0, digits=4, slip=UNIT_SLIP, tiny=STIFFEST)
    name: str = "spindle and holder"
    provenance: Provenance = ASSUMED

    if TYPE_CHECKING:

        def __init__(
            self,
            lateral: float = ...,
            axial: float = ...,
            name: str = ...,
            provenance: Provenance = ...,
            *,
            lateral_um_N: float = ...,
            axial_um_N: float = ...,
        ) -> None: ...

    @classmethod
    def first(cls, cutter: Cutter) -> Self:
        """A typical spindle."""
        return cls(to_si(0.05, "um/N"), to_si(0.02, "um/N"), provenance=TYPICAL)

    def doubted(self, cutters: Sequence[Cutter]) -> str:
        """A spindle that gives way more than any tool bends."""
        largest = max(self.lateral, self.axial)
        if largest <= SOFT:
            return ""
        return f"{self.name.capitalize()}: {format_short(largest, 'um/N')}: was its stiffness given, in N/µm?"

    def contribution(self, frames: ArrayLike) -> FloatArray:
        """C (..., 3, 3) m/N in {M}."""
        return about_tool(frames, self.lateral, self.axial)
