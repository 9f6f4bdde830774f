"""Work materials as cutting force coefficients, each with its source. SI: N/m^2, N/m.

A row is either mechanistic (Ktc, Kte, Krc, Kre and perhaps Kac, Kae) or Kienzle's (kc1.1, mc), never both.
A coefficient that no source gives is None: it is then taken as 0, and ``notes`` says so.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from robomill.cutting.edge import EdgeTerm
from robomill.errors import CuttingError
from robomill.provenance import Provenance
from robomill.units import from_si, to_si, unit_label

MECHANISTIC = ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae")
KIENZLE = ("kc11", "mc", "radial_ratio", "axial_ratio")
#: Unit at the edge of every coefficient.
COEFFICIENT_UNITS = {
    "Ktc": "N/mm2",
    "Kte": "N/mm",
    "Krc": "N/mm2",
    "Kre": "N/mm",
    "Kac": "N/mm2",
    "Kae": "N/mm",
    "kc11": "N/mm2",
    "mc": "1",
    "radial_ratio": "1",
    "axial_ratio": "1",
}
#: No metal known to milling lies outside these; a value that does was given in another unit.
CREDIBLE = {"N/mm2": (to_si(10.0, "N/mm2"), to_si(5e4, "N/mm2")), "N/mm": (0.0, to_si(1e3, "N/mm"))}
#: Chip thickness and width at which kc1.1 holds.
REFERENCE_CHIP = to_si(1.0, "mm")


@dataclass(frozen=True)
class Material:
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
    Ktc: float | None = None
    Kte: float | None = None
    Krc: float | None = None
    Kre: float | None = None
    Kac: float | None = None
    Kae: float | None = None
    kc11: float | None = None
    mc: float | None = None
    radial_ratio: float | None = None
    axial_ratio: float | None = None

    def __post_init__(self) -> None:
        if not self.name or not self.title or not self.alloy:
            raise CuttingError("A material needs a name, a title and an alloy.", where="name")
        if not self.provenance.source.strip():
            raise CuttingError(f"{self._who}: it needs a source; say where the numbers come from.", where="source")
        for coefficient in (*MECHANISTIC, *KIENZLE):
            self._check_number(coefficient)
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

    def _check_number(self, name: str) -> None:
        value = getattr(self, name)
        if value is None:
            return
        try:
            number = float(value)
        except (TypeError, ValueError) as exc:
            raise CuttingError(f"{self._who}: {name} should be a number, found {value!r:.40}.", where=name) from exc
        unit = COEFFICIENT_UNITS[name]
        shown = f"{from_si(number, unit):g} {unit_label(unit)}".rstrip()
        if not math.isfinite(number):
            raise CuttingError(f"{self._who}: {name} should be a finite number, found {number}.", where=name)
        if number < 0.0 or (number == 0.0 and name in ("Ktc", "kc11")):
            expected = "must be greater than 0" if name in ("Ktc", "kc11") else "cannot be negative"
            raise CuttingError(f"{self._who}: {name} is {shown}; it {expected}.", where=name)
        if name == "mc" and number >= 1.0:
            raise CuttingError(f"{self._who}: mc is {number:g}; expected 0 to less than 1.", where=name)
        low, high = CREDIBLE.get(unit, (0.0, math.inf))
        if number > high or (name in ("Ktc", "kc11") and number < low):
            raise CuttingError(f"{self._who}: {name} is {shown}, which no metal has; check its unit.", where=name)
        object.__setattr__(self, name, number)

    @property
    def kind(self) -> str:
        """``"mechanistic"`` or ``"kienzle"``."""
        return "mechanistic" if self.Ktc is not None else "kienzle"

    @property
    def terms(self) -> tuple[EdgeTerm, ...]:
        """The row as force law of the edge; unknown coefficients as 0 (see ``notes``)."""
        if self.kind == "mechanistic":
            return (
                EdgeTerm(1.0, float(self.Ktc or 0.0), float(self.Krc or 0.0), float(self.Kac or 0.0)),
                EdgeTerm(0.0, float(self.Kte or 0.0), float(self.Kre or 0.0), float(self.Kae or 0.0)),
            )
        mc = float(self.mc or 0.0)
        K = float(self.kc11 or 0.0) * REFERENCE_CHIP**mc
        return (EdgeTerm(1.0 - mc, K, K * float(self.radial_ratio or 0.0), K * float(self.axial_ratio or 0.0)),)

    @property
    def notes(self) -> tuple[str, ...]:
        """What the source does not give and is therefore taken as 0, in sentences."""
        unknown = []
        if self.kind == "mechanistic" and self.Kac is None:
            unknown.append("axial")
        if self.kind == "kienzle":
            unknown += [
                word for word, ratio in (("radial", self.radial_ratio), ("axial", self.axial_ratio)) if ratio is None
            ]
        return tuple(
            f"{self.title}: the {word} coefficients are unknown, the force they give is taken as 0." for word in unknown
        )

    def replace(self, **changes: Any) -> Material:
        """A checked copy with fields changed; edited coefficients should come with their own provenance."""
        return replace(self, **changes)


def alternatives(material: Material, materials: Iterable[Material]) -> tuple[Material, ...]:
    """The other rows of the same alloy and kind, by name: their spread is the honest uncertainty."""
    others = {m.name: m for m in materials if m.alloy == material.alloy and m.kind == material.kind}
    others.pop(material.name, None)
    return tuple(others[name] for name in sorted(others))
