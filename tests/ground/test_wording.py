"""Signs and their plain spelling, lists in words."""

from __future__ import annotations

import pytest

from robomill.unit_words import raised
from robomill.wording import DASHES, LOWERED, PLAIN, RAISED, listed, lowered, signed, spelled


@pytest.mark.parametrize(
    ("words", "text"), [((), ""), (("A",), "A"), (("A", "B"), "A and B"), (("A", "B", "C"), "A, B and C")]
)
def test_a_list_in_words_has_its_last_word_before_the_last(words, text) -> None:
    assert listed(words) == text
    assert listed(iter(words), "or") == text.replace(" and ", " or ")


def test_a_direction_has_a_true_sign_and_a_number_stands_below_the_line_with_all_its_digits() -> None:
    assert (signed(1.0, "X"), signed(-0.1, "Y")) == ("+X", "−Y")
    assert (lowered("θ", 5), lowered("J", 12)) == ("θ₅", "J₁₂")


def test_what_has_a_plain_spelling_is_plain_and_the_rest_is_asked_for() -> None:
    text = "−45° θ₁₂ 7·10⁻⁷ µm Ö"
    assert spelled(text, 0, len(text), lambda c: f"<{c}>") == ("-45 deg theta_12 7-10^-7 um <Ö>", len(text))
    assert spelled("10⁻⁷", 2, 3, str) == ("^-7", 4)  # a raised number to its own end
    for table in (PLAIN, RAISED, LOWERED):
        assert all(plain.isascii() and not sign.isascii() for sign, plain in table.items())
    assert {PLAIN[dash] for dash in DASHES} == {"-"}


def test_superscripts_on_the_line_are_those_of_the_one_table() -> None:
    for sign, plain in RAISED.items():
        assert raised(f"m{sign}") == f"m^{plain}"
