"""The push that leads aside most, and what one may say of where it leads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray
from robomill.paper import SLOT
from robomill.units import format_si
from robomill.wording import signed

FORCE = SLOT.force  # N
ASIDE = 0.02  # share of the displacement that counts as going somewhere


@dataclass(frozen=True)
class AsidePush:
    """A push along axis ``along`` (0, 1, 2) that leads most aside along ``aside``, and ``other`` is the third axis."""

    along: int
    aside: int
    other: int

    @classmethod
    def of(cls, C: FloatArray) -> AsidePush:
        """The push that leads aside most, by the compliance C (3, 3)."""
        size = np.abs(C)
        across = size - np.diag(np.diag(size))
        share = across.max(axis=0) / np.maximum(np.linalg.norm(C, axis=0), np.finfo(float).tiny)
        along = int(np.argmax(np.round(share, 9)))
        first, second = (i for i in range(3) if i != along)
        aside = first if across[first, along] > across[second, along] else second
        return cls(along, aside, 3 - along - aside)

    @property
    def name(self) -> str:
        return "XYZ"[self.along]

    @property
    def force(self) -> FloatArray:
        """(3,) N."""
        return FORCE * np.eye(3)[self.along]

    @property
    def answers(self) -> dict[str, str]:
        """What one may say: nowhere else, to either side, or along the third axis."""
        start = f"Along {self.name}"
        sides = {f"{sign}{self.aside}": f"{start} and {side(self.aside, sign == '+')}" for sign in "+-"}
        return {"alone": f"{start}, nowhere else", **sides, "other": f"{start} and along {'XYZ'[self.other]}"}

    def went(self, delta: FloatArray) -> str:
        """Which of the answers is right for a displacement (3,) under this push."""
        aside, other = abs(delta[self.aside]), abs(delta[self.other])
        if max(aside, other) < ASIDE * np.linalg.norm(delta):
            return "alone"
        if other > aside:
            return "other"
        return f"{'+' if delta[self.aside] > 0 else '-'}{self.aside}"

    def told(self, delta: FloatArray, unit: str, size: str = "{}") -> str:
        """A displacement (3,) m in words, first along the push, then aside; each length in ``unit``, set as ``size``
        says."""
        parts = [
            f"{size.format(format_si(abs(float(delta[i])), unit))} "
            + (f"along {self.name}" if i == self.along else side(i, bool(delta[i] > 0)))
            for i in (self.along, *(i for i in range(3) if i != self.along))
            if abs(delta[i]) > ASIDE * np.linalg.norm(delta)
        ]
        return " and ".join(parts) if parts else "nowhere"

    @property
    def column(self) -> str:
        """Which column of C says where this push leads."""
        return ("first", "second", "third")[self.along]

    def said(self, answer: str) -> str:
        """An answer inside a sentence."""
        return self.answers[answer].replace("Along", "along", 1)


def side(axis: int, plus: bool) -> str:
    """To which side: up, down, or towards an axis."""
    if axis == 2:
        return "up" if plus else "down"
    return f"towards {signed(1.0 if plus else -1.0, 'XY'[axis])}"
