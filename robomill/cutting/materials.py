"""Work materials as cutting force coefficients, each with its source. SI: N/m^2, N/m.

A row is of one law; each law stands with the force model that takes it, in ``forces``.
A coefficient that no source gives is None and ``unknown``, never zero; it may be assumed (``completed``), aloud.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from robomill.arguments import made_by
from robomill.cutting.edge import EdgeTerm
from robomill.errors import CuttingError
from robomill.provenance import GIVEN, Provenance
from robomill.quantities import described, quantities, quantity, settle
from robomill.spelled import Replaceable
from robomill.units import to_si
from robomill.values import Said

PUBLISHED = {"radial": (0.2, 0.95), "axial": (0.04, 0.42)}
"""Lowest and highest share of the tangential force that the six rows for aluminium of doi 10.1186/s10033-021-00536-9,
Table 5, have at chips of 0.02 to 0.2 mm."""
CALIBRATED = (to_si(0.01, "mm"), to_si(0.5, "mm"))
"""Feeds per tooth, m, within which rows are relied on; cutting tests lie at 0.02 to 0.3 mm. Assumed of all rows alike:
their sources do not state theirs."""
RUBS = to_si(1.0, "um")
"""A tooth that is fed less has no chip, m: the edge of a sharp carbide tooth is rounded by some 5 um (assumed)."""


def per_area(label: str, *, leads: bool = False, optional: bool = False) -> Any:
    """Force per chip area; no metal has less than 10 or more than 50 000 N/mm^2: such a value has another unit."""
    least = to_si(10.0, "N/mm2") if leads else 0.0
    return quantity(label, "N/mm2", optional=optional, least=least, most=to_si(5e4, "N/mm2"))


@made_by("rm.load_material(name)")
@dataclass(frozen=True, repr=False)
class Material(Replaceable, Said):
    """Cutting force coefficients of one alloy with one kind of cutter. A child declares those of its law.

    ``alloy`` groups the alternative sets of one alloy ("Al 7075"), ``title`` tells them apart.
    Raises CuttingError with one sentence for a row that contradicts itself.

    kind     the law's name
    gives    coefficients that a source may leave out, and the force that is then unknown: ``"radial"``, ``"axial"``

    Examples
    --------
    >>> import robomill as rm
    >>> rm.load_material("al7075_t6_carbide_ref190").alloy
    'Al 7075'
    """

    kind: ClassVar[str] = ""
    gives: ClassVar[Mapping[str, str]] = {}

    name: str
    title: str
    alloy: str
    provenance: Provenance

    def _said(self) -> str:
        return f"{self.name}: {described(self)}"

    def __post_init__(self) -> None:
        if not self.name or not self.title or not self.alloy:
            raise CuttingError("A material needs a name, a title and an alloy.", where="name")
        if not self.provenance.source.strip():
            raise CuttingError(f"{self.who}: it needs a source; say where the numbers come from.", where="source")
        settle(self, CuttingError, self.who)

    @property
    def who(self) -> str:
        """How a refusal begins."""
        return f"Material {self.name!r}"

    @property
    def terms(self) -> tuple[EdgeTerm, ...]:
        """The row as force law of the edge; the terms of an ``unknown`` force are 0 and must not be relied on."""
        raise NotImplementedError

    def tangential(self, name: str) -> float:
        """What a coefficient is, where its force is the tangential one."""
        return 1.0

    @property
    def missing(self) -> tuple[str, ...]:
        """The coefficients that its source does not give."""
        return tuple(name for name in quantities(type(self)) if getattr(self, name) is None)

    @property
    def unknown(self) -> tuple[str, ...]:
        """The forces on its edge that its source does not give: ``"radial"``, ``"axial"``."""
        return tuple(dict.fromkeys(self.gives[name] for name in self.missing))

    def completed(self, shares: Mapping[str, float | None]) -> Material:
        """The row with its unknown forces as ``shares`` of the tangential one; itself where none of them is given."""
        given = {part: share for part in self.unknown if (share := shares.get(part)) is not None}
        if not given:
            return self
        words = ", ".join(f"{part} {share:g}" for part, share in given.items())
        source = f"{self.provenance.source}; as shares of the tangential force assumed: {words}"
        changes: dict[str, Any] = {
            "title": f"{self.title}, {words} assumed",
            "provenance": Provenance("assumed", source),
        }
        for name in self.missing:
            if self.gives[name] in given:
                changes[name] = given[self.gives[name]] * self.tangential(name)
        return self.replace(**changes)

    def filled(self, other: Material) -> Material:
        """The row with the coefficients that its source does not give as those of another one: so it widens no range of
        a force that it does not know. Itself where it gives them all."""
        missing = {name: getattr(other, name) for name in self.missing if getattr(other, name) is not None}
        return self.replace(**missing, provenance=self.provenance) if missing else self

    def _taken(self, changes: dict[str, Any]) -> dict[str, Any]:
        """Coefficients that were changed are of who changed them."""
        numbers = [name for name in quantities(type(self)) if name in changes]
        if "provenance" not in changes and any(changes[name] != getattr(self, name) for name in numbers):
            changes["provenance"] = GIVEN
        return changes


def alternatives(material: Material, materials: Iterable[Material]) -> tuple[Material, ...]:
    """The other rows of the same alloy and kind, by name: their spread is the honest uncertainty."""
    others = {m.name: m for m in materials if m.alloy == material.alloy and m.kind == material.kind}
    others.pop(material.name, None)
    return tuple(others[name] for name in sorted(others))
