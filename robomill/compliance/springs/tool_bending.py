"""Bending of the cutter."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Self

from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.compliance.spring import Spring, about_tool
from robomill.cutting.tool import LONGEST, SHORTEST, THINNEST, WIDEST, Cutter
from robomill.errors import RobotError
from robomill.provenance import Provenance
from robomill.quantities import quantity
from robomill.spelled import in_units
from robomill.units import format_short, format_si, to_si

#: Young's modulus of solid carbide, Pa.
E_CARBIDE = to_si(600e3, "N/mm2")
SOFT, HARD = to_si(1e3, "N/mm2"), to_si(2e6, "N/mm2")  # a plastic, and more than diamond
#: Bending diameter of a fluted cutter over its outer diameter.
FLUTED_CORE = 0.8
OTHER = 0.75  # of a diameter: a shank may be a little thicker or thinner than its cutter
CARBIDE = Provenance("assumed", "cantilever of solid carbide, E = 600 GPa, bending diameter 0.8 of the cutter's")


@in_units(RobotError, "Tool bending")
@dataclass(frozen=True, repr=False)
class ToolBending(Spring):
    """The cutter as a cantilever: delta = F L^3 / (3 E I) across its axis, rigid along it.

    diameter m, stick_out L m, E Pa; the bending diameter is ``core`` times the diameter (flutes weaken it).

    Examples
    --------
    >>> import robomill as rm
    >>> rm.ToolBending(8e-3, 30e-3).name
    'tool bending'
    """

    kind: ClassVar[str] = "tool_bending"
    title: ClassVar[str] = "Tool bending"
    hint: ClassVar[str | None] = "The cutter as a cantilever of solid carbide."
    follows_tooth: ClassVar[bool] = True
    rank: ClassVar[int] = 1

    diameter: float = quantity("Diameter", "mm", above=0.0, boxed=False, slip=WIDEST, tiny=THINNEST)
    stick_out: float = quantity("Stick-out", "mm", above=0.0, digits=1, slip=LONGEST, tiny=SHORTEST)
    E: float = quantity("Young's modulus", "N/mm2", default=E_CARBIDE, least=SOFT, most=HARD, digits=0)
    core: float = quantity(
        "Bending Ø / Ø",
        default=FLUTED_CORE,
        above=0.0,
        most=1.0,
        digits=2,
        hint="Flutes weaken the shank: its bending diameter over the cutter's.",
    )
    name: str = "tool bending"
    provenance: Provenance = CARBIDE

    if TYPE_CHECKING:

        def __init__(
            self,
            diameter: float = ...,
            stick_out: float = ...,
            E: float = ...,
            core: float = ...,
            name: str = ...,
            provenance: Provenance = ...,
            *,
            diameter_mm: float = ...,
            stick_out_mm: float = ...,
            E_N_mm2: float = ...,
        ) -> None: ...

    def _said(self) -> str:
        return f"{format_short(self.diameter, 'mm')} thick, sticks out {format_short(self.stick_out, 'mm')}"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.provenance == CARBIDE and (self.E, self.core) != (E_CARBIDE, FLUTED_CORE):
            words = f"cantilever, E = {self.E:.4g} N/m^2, bending diameter {self.core:g} of the cutter's"
            object.__setattr__(self, "provenance", Provenance("user", words))

    @classmethod
    def first(cls, cutter: Cutter) -> Self:
        """The cutter as it sticks out; four diameters where that is not given."""
        return cls(cutter.diameter, cutter.stick_out or 4.0 * cutter.diameter)

    @property
    def lateral(self) -> float:
        """Compliance across the axis, m/N: L^3 / (3 E I)."""
        second_moment = math.pi / 64.0 * (self.core * self.diameter) ** 4
        return self.stick_out**3 / (3.0 * self.E * second_moment)

    @property
    def facts(self) -> str:
        """Its compliance."""
        return f"Ø {format_si(self.diameter, 'mm', 1)}: {format_si(self.lateral, 'um/N', 4)} across the axis"

    def edited(self, **changes: Any) -> Self:
        """A copy with numbers changed; its source says by itself what differs from solid carbide."""
        return replace(self, **changes)

    def fitted(self, cutter: Cutter) -> Self:
        """With the diameter of ``cutter``."""
        return replace(self, diameter=cutter.diameter)

    def of_tool(self, cutter: Cutter, longer: float) -> Self:
        """With the diameter and stick-out of ``cutter``; where that is not given, sticking out as much more."""
        stick_out = cutter.stick_out or max(self.stick_out + longer, cutter.diameter)
        return replace(self, diameter=cutter.diameter, stick_out=stick_out)

    def doubted(self, cutters: Sequence[Cutter]) -> str:
        """A bending that is of none of the ``cutters``, the first of which is named."""
        if any(OTHER * cutter.diameter < self.diameter < cutter.diameter / OTHER for cutter in cutters):
            return ""
        thick, wide = format_short(self.diameter, "mm"), format_short(cutters[0].diameter, "mm")
        return f"{self.name.capitalize()}: it is of a tool of {thick}, and the cutter is {wide} wide: is it of another?"

    def contribution(self, frames: ArrayLike) -> FloatArray:
        """C (..., 3, 3) m/N in {M}."""
        return about_tool(frames, self.lateral, 0.0)
