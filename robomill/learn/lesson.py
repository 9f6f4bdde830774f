"""A lesson as data: a question, what one may say, what the model says of each, the reason, and the equation of now."""

from __future__ import annotations

from dataclasses import dataclass, field

from robomill.arrays import FloatArray
from robomill.learn.exercise import Exercise

COUNT = 8
TITLES = (
    "Push: where does the tip go?",
    "Which joint gives?",
    "Lever arm and det(J)",
    "Reading a compliance map",
    "Up or down milling",
    "Which test sees a joint?",
    "What compensation leaves",
    "Stiffen or move?",
)
MINUTES = (6, 6, 6, 6, 7, 6, 6, 7)
"""Of a lesson of 50 minutes."""


@dataclass(frozen=True)
class Choice:
    """What one may say, and what the model says of it."""

    text: str
    told: str


@dataclass(frozen=True, eq=False)
class Bars:
    """A picture of amounts by name: values (k,) in SI, shown in ``unit``; ``best`` is the one asked for (-1: none)."""

    title: str
    names: tuple[str, ...]
    values: FloatArray
    unit: str
    best: int = -1


@dataclass(frozen=True, eq=False)
class Lesson:
    """One screen. Where ``typed`` is given, the prediction is a number, else one of the ``choices``.

    ``push`` (3,) N and ``moved`` (3,) m are the arrows of the picture; ``bars`` what else there is to see. ``equation``
    is TeX with the numbers of now, ``paper`` its number in the paper.
    """

    number: int
    question: str
    right: int
    choices: tuple[Choice, ...]
    reason: str
    equation: str
    paper: str
    breaking: str
    teacher: str
    push: FloatArray
    moved: FloatArray
    typed: Exercise | None = None
    bars: Bars | None = field(default=None)

    @property
    def title(self) -> str:
        return TITLES[self.number - 1]

    @property
    def answer(self) -> str:
        """The right answer in words."""
        return self.choices[self.right].told
