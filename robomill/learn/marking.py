"""What is right or wrong with an answer: its sign, its unit, or the term that is missing, told in one sentence."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from robomill.arguments import asked
from robomill.arrays import brief
from robomill.errors import ArgumentError, NumberError
from robomill.learn.exercise import Exercise
from robomill.typed_numbers import read_number
from robomill.units import format_percent, to_si

Kind = Literal["right", "sign", "unit", "slip", "wrong", "unread", "missing"]
MARKS: dict[Kind, float] = {"right": 2.0, "sign": 1.0, "unit": 1.0}
"""What an answer earns; every other earns nothing."""
MOST = 2.0
# Factors by which a unit goes wrong, and how that is told.
THOUSANDS = {1e3: "a thousand times too large", 1e-3: "a thousand times too small"}
THOUSANDS |= {1e6: "a million times too large", 1e-6: "a million times too small"}
SHARES = {1e2: "a hundred times too large", 1e-2: "a hundred times too small"}  # of what is asked for in per cent
TURN = math.pi / 180.0


@dataclass(frozen=True)
class Judgement:
    """What an answer is: its ``kind``, one whole sentence for the student, the ``value`` read (SI, NaN where none).

    kind: right; sign (right but for its sign); unit (by 1000 or a million, a share for per cent, or degrees for
    radians); slip (what a named mistake gives); wrong; unread (no number); missing (no answer).

    Examples
    --------
    >>> from robomill import learn
    >>> found = learn.check(learn.exercise("torque", 1234567), "about ten")
    >>> found.kind, found.right, found.marks
    ('unread', False, 0.0)
    """

    kind: Kind
    sentence: str
    value: float = math.nan

    @property
    def right(self) -> bool:
        return self.kind == "right"

    @property
    def marks(self) -> float:
        """Of ``MOST``: all for a right answer, half where only sign or unit is wrong."""
        return MARKS.get(self.kind, 0.0)


@asked
def check(exercise: Exercise, answer: str | float | None) -> Judgement:
    """Mark one answer.

    Parameters
    ----------
    exercise : Exercise
        As ``robomill.learn.exercise`` gives it.
    answer : str, float or None
        As typed, with decimal comma or point and a unit if one likes; a number (of NumPy, too) is in the exercise's
        unit, while ``exercise.answer`` is in SI.

    Returns
    -------
    Judgement
        Its ``sentence`` says what is wrong; an answer that is no number is judged too, never refused.

    Raises
    ------
    ArgumentError
        For an argument of another kind.

    Examples
    --------
    >>> from robomill import learn
    >>> given = learn.exercise("soft_joint", 1234567)
    >>> learn.check(given, "1e999").sentence
    "This is no number: found '1e999', expected a number that is finite."
    """
    if getattr(answer, "shape", None) == ():  # a number of NumPy, or an array of one
        answer = answer.item()  # type: ignore[union-attr]
    if answer is None or (isinstance(answer, str) and not answer.strip()):
        return Judgement("missing", "There is no answer.")
    if isinstance(answer, bool) or not isinstance(answer, str | float | int):
        raise ArgumentError(f"check: answer: expected a text or a number, or None, found {brief(answer)}.")
    try:
        typed = read_number(answer if isinstance(answer, str) else repr(float(answer)), exercise.unit)
    except NumberError as refusal:
        return Judgement("unread", f"This is no number: {refusal}")
    except OverflowError:
        return Judgement("unread", "This is no number: it has more digits than a number can have.")
    value = float(to_si(typed.value, exercise.unit))
    if not math.isfinite(value):
        return Judgement("unread", "This is no number: it is not finite.")
    return _judged(exercise, value)


def _judged(exercise: Exercise, value: float) -> Judgement:
    if exercise.holds(value):
        return Judgement("right", "Right.", value)
    if exercise.tolerance == 0.0:  # one of a few: nothing is near it
        slip = next((slip for slip in exercise.slips if slip.value == value), None)
        return Judgement("slip" if slip else "wrong", slip.says if slip else "This is none of them.", value)
    if exercise.holds(-value):
        return Judgement(
            "sign", "The size is right, the sign is wrong: check which way the force and the axis point.", value
        )
    factors = THOUSANDS | (SHARES if exercise.unit == "%" else {})
    for factor, words in factors.items():
        for sign, also in ((1.0, ""), (-1.0, ", and its sign is wrong")):
            if exercise.holds(sign * value / factor):
                return Judgement(
                    "unit", f"The number is {words}{also}: the answer is asked for in {exercise.asked}.", value
                )
    # What was named is told before what may be a chance: degrees and radians last.
    for slip in exercise.slips:
        if exercise.holds(value, slip.value):
            return Judgement("slip", slip.says, value)
    for factor, words in ((TURN, "radians were"), (1.0 / TURN, "degrees were")):
        if exercise.holds(value / factor) or exercise.holds(-value / factor):
            other = "degrees" if factor == TURN else "radians"
            return Judgement("unit", f"The number is off by π/180: {words} used where {other} belong.", value)
    return Judgement("wrong", _off(exercise, value), value)


def _off(exercise: Exercise, value: float) -> str:
    share = value / exercise.answer - 1.0
    if value == 0.0:
        return "It is not zero: take the next hint."
    if abs(share) < 0.5:
        more = "large" if share > 0.0 else "small"
        return f"Not right: the size is {format_percent(abs(share), 1)} too {more}, which no usual slip explains."
    return "Not right, and no usual slip gives this number: take the next hint."
