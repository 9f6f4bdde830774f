"""Work materials as cutting force coefficients, each with its source. SI: N/m^2, N/m.

A row is either mechanistic (Ktc, Kte, Krc, Kre and perhaps Kac, Kae) or Kienzle's (kc1.1, mc), never both.
A coefficient that no source gives is None and ``unknown``, never zero; it may be assumed (``completed``), aloud.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from robomill.cutting.edge import EdgeTerm
from robomill.errors import CuttingError
from robomill.provenance import Provenance
from robomill.quantities import Replaceable, quantity, settle
from robomill.units import to_si

MECHANISTIC = ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae")
KIENZLE = ("kc11", "mc", "radial_ratio", "axial_ratio")
#: Coefficients that a source may leave out, and the force that is then unknown.
GIVES = {"radial_ratio": "radial", "axial_ratio": "axial", "Kac": "axial", "Kae": "axial"}
PUBLISHED = {"radial": (0.2, 0.95), "axial": (0.04, 0.42)}
"""Lowest and highest share of the tangential force that the six rows for aluminium of doi 10.1186/s10033-021-00536-9,
Table 5, have at chips of 0.02 to 0.2 mm."""
#: Chip thickness and width at which kc1.1 holds.
REFERENCE_CHIP = to_si(1.0, "mm")


def _per_area(label: str, *, leads: bool = False) -> Any:
    """Force per chip area; no metal has less than 10 or more than 50 000 N/mm^2: such a value has another unit."""
    least = to_si(10.0, "N/mm2") if leads else 0.0
    return quantity(label, "N/mm2", optional=True, least=least, most=to_si(5e4, "N/mm2"))


def _per_length(label: str) -> Any:
    return quantity(label, "N/mm", optional=True, least=0.0, most=to_si(1e3, "N/mm"))


@dataclass(frozen=True)
class Material(Replaceable):
    """Cutting force coefficients of one alloy with one kind of cutter.

    Ktc, Krc, Kac  N/m^2   force per chip area: tangential, radial, axial
    Kte, Kre, Kae  N/m     force per length of edge
    kc11, mc       N/m^2, 1    Kienzle: F_t = kc11 (h / 1 mm)^(-mc) h b
    radial_ratio, axial_ratio  1   Kienzle: F_r / F_t and F_a / F_t

    ``alloy`` groups the alternative sets of one alloy ("Al 7075"), ``title`` tells them apart.
    Raises CuttingError with one sentence for a row that contradicts itself.
    """

    name: str
    title: str
    alloy: str
    provenance: Provenance
    Ktc: float | None = _per_area("Ktc", leads=True)
    Kte: float | None = _per_length("Kte")
    Krc: float | None = _per_area("Krc")
    Kre: float | None = _per_length("Kre")
    Kac: float | None = _per_area("Kac")
    Kae: float | None = _per_length("Kae")
    kc11: float | None = _per_area("kc11", leads=True)
    mc: float | None = quantity("mc", optional=True, least=0.0, below=1.0)
    radial_ratio: float | None = quantity("radial_ratio", optional=True, least=0.0)
    axial_ratio: float | None = quantity("axial_ratio", optional=True, least=0.0)

    def __post_init__(self) -> None:
        if not self.name or not self.title or not self.alloy:
            raise CuttingError("A material needs a name, a title and an alloy.", where="name")
        if not self.provenance.source.strip():
            raise CuttingError(f"{self._who}: it needs a source; say where the numbers come from.", where="source")
        settle(self, CuttingError, self._who)
        mechanistic = [c for c in MECHANISTIC if getattr(self, c) is not None]
        kienzle = [c for c in KIENZLE if getattr(self, c) is not None]
        if mechanistic and kienzle:
            raise CuttingError(
                f"{self._who}: found {', '.join(mechanistic)} and {', '.join(kienzle)}; "
                "a row holds either Ktc to Kae or Kienzle's kc1.1 and mc, so make two rows of it.",
                where=kienzle[0],
            )
        needed = ("kc11", "mc") if kienzle else ("Ktc", "Kte", "Krc", "Kre")
        for coefficient in needed:
            if getattr(self, coefficient) is None:
                raise CuttingError(
                    f"{self._who}: {coefficient} is missing; it takes {', '.join(needed)}"
                    f"{'' if kienzle else ' (or kc11 and mc)'}.",
                    where=coefficient,
                )
        if (self.Kac is None) != (self.Kae is None):
            missing, given = ("Kac", "Kae") if self.Kac is None else ("Kae", "Kac")
            raise CuttingError(
                f"{self._who}: {given} is given without {missing}; give both, or neither.", where=missing
            )

    @property
    def _who(self) -> str:
        return f"Material {self.name!r}"

    @property
    def kind(self) -> str:
        """``"mechanistic"`` or ``"kienzle"``."""
        return "mechanistic" if self.Ktc is not None else "kienzle"

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Names of the coefficients of its kind, given or not."""
        return MECHANISTIC if self.kind == "mechanistic" else KIENZLE

    @property
    def missing(self) -> tuple[str, ...]:
        """The coefficients that its source does not give."""
        return tuple(name for name in self.coefficients if getattr(self, name) is None)

    @property
    def unknown(self) -> tuple[str, ...]:
        """The forces on its edge that its source does not give: ``"radial"``, ``"axial"``."""
        return tuple(dict.fromkeys(GIVES[name] for name in self.missing))

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
        tangential = {"Kac": self.Ktc, "Kae": self.Kte}
        for name in self.missing:
            if GIVES[name] in given:
                changes[name] = given[GIVES[name]] * (tangential.get(name) or 1.0)
        return self.replace(**changes)

    def filled(self, other: Material) -> Material:
        """The row with the coefficients that its source does not give as those of another one: so it widens no range of
        a force that it does not know. Itself where it gives them all."""
        missing = {name: getattr(other, name) for name in self.missing if getattr(other, name) is not None}
        return self.replace(**missing) if missing else self

    @property
    def terms(self) -> tuple[EdgeTerm, ...]:
        """The row as force law of the edge; the terms of an ``unknown`` force are 0 and must not be relied on."""
        if self.kind == "mechanistic":
            return (
                EdgeTerm(1.0, float(self.Ktc or 0.0), float(self.Krc or 0.0), float(self.Kac or 0.0)),
                EdgeTerm(0.0, float(self.Kte or 0.0), float(self.Kre or 0.0), float(self.Kae or 0.0)),
            )
        mc = float(self.mc or 0.0)
        K = float(self.kc11 or 0.0) * REFERENCE_CHIP**mc
        return (EdgeTerm(1.0 - mc, K, K * float(self.radial_ratio or 0.0), K * float(self.axial_ratio or 0.0)),)


def alternatives(material: Material, materials: Iterable[Material]) -> tuple[Material, ...]:
    """The other rows of the same alloy and kind, by name: their spread is the honest uncertainty."""
    others = {m.name: m for m in materials if m.alloy == material.alloy and m.kind == material.kind}
    others.pop(material.name, None)
    return tuple(others[name] for name in sorted(others))
