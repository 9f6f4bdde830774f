"""An exercise as data: what is asked, the answer, how near is right, and what usual slips would give instead."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from robomill.units import unit_label
from robomill.values import Value


@dataclass(frozen=True)
class Slip:
    """A usual mistake: the ``value`` (SI) that it leads to, and the sentence that names it.

    Examples
    --------
    >>> from robomill import learn
    >>> learn.exercise("torque", 1234567).slips[0].says
    "The lever arm is missing: a torque is the force times its distance from the joint's axis."
    """

    says: str
    value: float


@dataclass(frozen=True, eq=False, repr=False)
class Exercise(Value):
    """An exercise with one student's numbers.

    ``answer`` is in SI, asked for in ``unit`` (a key of ``robomill.units.UNITS``); right is what lies within
    ``tolerance`` of it, a share of its size (0: that number alone). ``equation`` is TeX, ``number`` its number in the
    paper. ``data`` are columns of readings where there are some. ``seed`` names what its numbers are drawn from.

    Examples
    --------
    >>> from robomill import learn
    >>> given = learn.exercise("tip", 1234567)
    >>> given.unit, given.number, len(given.hints)
    ('mm', '(15), (16)', 3)
    """

    id: str
    title: str
    text: str
    seed: str
    unit: str
    tolerance: float
    hints: tuple[str, ...]
    equation: str
    number: str
    answer: float
    slips: tuple[Slip, ...]
    data: Mapping[str, tuple[float, ...]] = field(default_factory=dict)

    def _said(self) -> str:
        return f"{self.id}: {self.title}, {self.asked}"

    def _facts(self) -> Sequence[tuple[str, str]]:
        return [("asked", self.text), ("in", self.asked)]

    @property
    def asked(self) -> str:
        """The unit of the answer as people read it; a word where there is none."""
        return unit_label(self.unit) or "a number"

    def holds(self, value: float, other: float | None = None) -> bool:
        """Whether a value (SI) is the answer, or the ``other`` value, within the tolerance."""
        wanted = self.answer if other is None else other
        return abs(value - wanted) <= max(self.tolerance, 1e-9) * abs(wanted)

    def telling(self, slips: Iterable[Slip]) -> Exercise:
        """Itself with those of its ``slips`` that can be told from the answer and from a slip before them."""
        kept: list[Slip] = []
        for slip in slips:
            if not self.holds(slip.value) and not any(self.holds(slip.value, other.value) for other in kept):
                kept.append(slip)
        return replace(self, slips=tuple(kept))
