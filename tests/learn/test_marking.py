"""Marking: right, sign, unit, the term that is missing; and what is typed by hand or in bad faith."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from robomill import learn
from robomill.errors import RobomillError
from robomill.io.robot.robots import robot_names
from robomill.learn.personal import TASKS
from robomill.units import from_si, to_si

TIP = learn.exercise("tip", 1234567)
IN_MM = from_si(TIP.answer, "mm")


@pytest.mark.parametrize("robot", robot_names())
def test_every_answer_is_right_and_every_slip_is_named(robot: str) -> None:
    for student in (7, 1234567):
        for given in learn.exercises(student, robot):
            value = from_si(given.answer, given.unit)
            assert learn.check(given, value).right
            assert learn.check(given, repr(value)).right
            named = {slip.says for slip in given.slips}
            assert given.slips
            for slip in given.slips:
                found = learn.check(given, from_si(slip.value, given.unit))
                assert not found.right
                assert found.kind in ("slip", "sign", "unit")
                assert found.sentence in named or found.kind != "slip"


@pytest.mark.parametrize(
    "typed",
    [
        f"{IN_MM:.5f}".replace(".", ","),
        f"{IN_MM * 1000:.3f} µm",
        f"{IN_MM / 1000:.9f} m",
        f"  {IN_MM:.5e} ",
        f"{IN_MM:.5f} mm",
        f"{IN_MM / 25.4:.7f} in",
    ],
)
def test_an_answer_is_read_with_decimal_comma_and_with_a_unit(typed: str) -> None:
    assert learn.check(TIP, typed).right, typed


def test_half_a_percent_off_is_right_and_two_percent_are_not() -> None:
    assert learn.check(TIP, IN_MM * 1.005).right
    off = learn.check(TIP, IN_MM * 1.02)
    assert (off.kind, off.marks) == ("wrong", 0.0)
    assert off.sentence == "Not right: the size is 2.0 % too large, which no usual slip explains."


def test_a_wrong_sign_is_told_as_that() -> None:
    found = learn.check(TIP, -IN_MM)
    assert (found.kind, found.marks) == ("sign", 1.0)
    assert found.sentence.startswith("The size is right, the sign is wrong")


@pytest.mark.parametrize(
    ("factor", "words"), [(1e3, "a thousand times too large"), (1e-6, "a million times too small")]
)
def test_a_wrong_unit_is_told_by_its_thousands(factor: float, words: str) -> None:
    found = learn.check(TIP, IN_MM * factor)
    assert (found.kind, found.marks) == ("unit", 1.0)
    assert found.sentence == f"The number is {words}: the answer is asked for in mm."
    assert "its sign is wrong" in learn.check(TIP, -IN_MM * factor).sentence


@pytest.mark.parametrize("factor", [math.pi / 180, 180 / math.pi])
def test_degrees_in_place_of_radians_are_told(factor: float) -> None:
    given = learn.exercise("regular", 1234567)
    found = learn.check(given, given.answer * factor)
    assert found.kind == "unit"
    assert "π/180" in found.sentence


@pytest.mark.parametrize(
    "typed",
    [
        "nan",
        "1e999",
        "-1e999",
        "inf",
        "<b>1</b>",
        "$x$",
        "=1+1",
        "zwei",
        "1 kg",
        "1,234",
        "1..2",
        "\x00",
        "9" * 5000,
        "🙂",
    ],
)
def test_a_hostile_answer_gets_one_sentence_and_no_marks(typed: str) -> None:
    found = learn.check(TIP, typed)
    assert (found.kind, found.marks) == ("unread", 0.0)
    assert found.sentence.startswith("This is no number: ")
    assert "\n" not in found.sentence
    assert len(found.sentence) < 400


@pytest.mark.parametrize("given", [float("nan"), float("inf"), 10**400])
def test_a_number_that_is_not_finite_is_no_answer(given: float) -> None:
    assert learn.check(TIP, given).kind == "unread"


@pytest.mark.parametrize("given", [None, "", "   ", "\n"])
def test_no_answer_is_missing(given: str | None) -> None:
    assert learn.check(TIP, given).kind == "missing"


@pytest.mark.parametrize("given", [True, [1.0], {}, object(), b"1"])
def test_an_answer_of_another_kind_is_refused(given: object) -> None:
    with pytest.raises(RobomillError):
        learn.check(TIP, given)  # type: ignore[arg-type]


def test_a_joint_that_is_none_is_told_so() -> None:
    given = learn.exercise("soft_joint", 3)
    assert learn.check(given, "9").sentence == "This is none of them."
    assert learn.check(given, -given.answer).kind == "wrong"


def test_every_exercise_is_data_with_hints_and_an_equation() -> None:
    for task in TASKS:
        given = learn.exercise(task.id, 5)
        assert len(given.hints) == 3
        assert given.equation
        assert given.number
        assert given.text.endswith(("?", ".", "sign."))
        assert to_si(from_si(given.answer, given.unit), given.unit) == pytest.approx(given.answer)


@pytest.mark.parametrize(
    "of", [np.float64, np.float32, np.array, lambda x: np.array([[x]])[0, 0], lambda x: np.array(x)[()]]
)
def test_a_number_of_numpy_is_a_number(of) -> None:
    assert learn.check(TIP, of(IN_MM)).right


def test_a_joint_counted_by_numpy_is_right() -> None:
    asked = learn.exercise("soft_joint", 1234567)
    shares = np.zeros(6)
    shares[round(asked.answer) - 1] = 1.0
    assert learn.check(asked, shares.argmax() + 1).right
    with pytest.raises(RobomillError, match="True"):
        learn.check(asked, np.bool_(True))


def test_a_share_of_one_is_told_from_one_in_per_cent() -> None:
    asked = learn.exercise("share", 1234567)
    found = learn.check(asked, asked.answer)
    assert (found.kind, found.marks) == ("unit", 1.0)
    assert "a hundred times too small" in found.sentence
    assert learn.check(TIP, IN_MM / 100).kind == "wrong"


def test_zero_is_told_in_words_that_hold_for_every_exercise() -> None:
    """A cutting force of zero was told that every joint lets the tip move."""
    said = {learn.check(asked, 0).sentence for asked in learn.exercises(1234567) if asked.tolerance}
    assert said == {"It is not zero: take the next hint."}


def test_an_exercise_is_a_value() -> None:
    again = pickle.loads(pickle.dumps(TIP))
    assert again == TIP == learn.exercise("tip", 1234567) != learn.exercise("tip", 7)
    assert len({again, TIP}) == 1
