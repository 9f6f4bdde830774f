"""What the maker of an exercise gives: its text, its answer and the slips."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from robomill.learn.exercise import Slip


@dataclass(frozen=True)
class Made:
    """Text, answer (SI) and slips with one student's numbers.

    ``unit`` is given where it depends on the robot, ``tolerance`` where it depends on the readings, which are ``data``.
    """

    text: str
    answer: float
    slips: tuple[Slip, ...]
    unit: str = ""
    tolerance: float | None = None
    data: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
