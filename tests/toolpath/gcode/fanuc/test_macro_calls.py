"""Macros with values: each program with the places that its variables make, reckoned by hand."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret

HEAD = "%\nO0001\nG21 G90 G0 X0 Y0 Z5\n"


def read(body: str) -> Program:
    return interpret(f"{HEAD}{body}%\n", dialect="fanuc")


def places(body: str) -> list[tuple[float, ...]]:
    return [tuple(row) for row in (np.round(read(body).end[1:] * 1e3, 9) + 0.0).tolist()]


def test_a_macro_has_its_own_variables() -> None:
    body = "#24=7\n#100=1\nG65 P9 X10 Y4. A-1.5 F50\nG0 X#24 Y#100\nM30\n"
    body += "O9\nG0 X#24 Y#25\nG1 Z#1 F#9\n#24=99\n#100=3\nM99\n"
    assert places(body) == [(10, 4, 5), (10, 4, -1.5), (7, 3, -1.5)]
    assert read(body).v_f[2] * 6e4 == pytest.approx(50.0)


def test_every_repeat_begins_with_the_values_that_were_given() -> None:
    body = "G91\nG65 P9 D4 L3\nM30\nO9\nG0 X#7\n#7=#7+1\nG65 P8 A#7\nM99\nO8\nG0 Y#1\nM99\n"
    assert places(body)[::2] == [(4, 0, 5), (8, 5, 5), (12, 10, 5)]
    assert places(body)[1::2] == [(4, 5, 5), (8, 10, 5), (12, 15, 5)]


def test_i_j_and_k_may_be_given_again_and_again() -> None:
    """I1 J1 K1 are #4 #5 #6, I2 J2 K2 #7 #8 #9."""
    assert places("G65 P9 I1 J2 K3 I4 J5 K6\nM30\nO9\nG0 X#4 Y#5 Z#6\nX#7 Y#8 Z#9\nM99\n") == [(1, 2, 3), (4, 5, 6)]


def test_a_word_with_an_empty_variable_is_left_out() -> None:
    assert places("G65 P9 X3\nM30\nO9\nG0 X#24 Y#25 Z-#26\nX[#24+#25]\nM99\n") == [(3, 0, 5), (3, 0, 5)]
    assert places("#1=5\n#2=#1\nX#2\n#1=#0\n#2=#1\nG0 X9 Y#2\nM30\n") == [(5, 0, 5), (9, 0, 5)]


@pytest.mark.parametrize(
    ("asked", "holds"),
    [
        ("#7 EQ #0", True),
        ("#7 NE #0", False),
        ("#24 EQ #0", False),
        ("#24 NE #0", True),
        ("#0 EQ #7", True),
        ("#7 EQ 0", False),
        ("#7 NE 0", True),
        ("#7 LT 1", True),
    ],
)
def test_empty_is_not_zero_where_it_is_asked_for(asked: str, holds: bool) -> None:
    found = places(f"G65 P9 X1\nM30\nO9\nIF [{asked}] GOTO 5\nG0 X9\nN5 G0 Y1\nM99\n")
    assert found == ([(0, 1, 5)] if holds else [(9, 0, 5), (9, 1, 5)])


def test_a_modal_macro_follows_every_line_that_moves() -> None:
    body = "G66 P9 Z-2 F100\nX10\nM8\nX20\nG67\nX30\nM30\nO9\nG1 Z#26 F#9\nG0 Z5\nM99\n"
    assert places(body) == [(10, 0, 5), (10, 0, -2), (10, 0, 5), (20, 0, 5), (20, 0, -2), (20, 0, 5), (30, 0, 5)]


def test_holes_on_a_circle() -> None:
    body = (
        "G65 P9100 X10. Y20. R5. H4 Z-3. I2. F100.\nM30\nO9100\nIF [#9 EQ #0] GOTO 900\n#2=0\n"
        "WHILE [#2 LT #11] DO1\n#3=360*#2/#11\nG0 X[#24+#18*COS[#3]] Y[#25+#18*SIN[#3]]\nG0 Z#4\nG1 Z#26 F#9\nG0 Z#4\n"
        "#2=#2+1\nEND1\nGOTO 999\nN900 #3000=1(FEED MISSING)\nN999 M99\n"
    )
    drilled = [row[:2] for row in places(body) if row[2] == -3]
    assert drilled == [(15, 20), (10, 25), (5, 20), (10, 15)]
    with pytest.raises(GCodeError, match=r"Line 18: the program stops here with an alarm \(#3000\): FEED MISSING"):
        read(body.replace(" F100.", ""))


def test_the_controls_own_variables() -> None:
    """#4003 is G90 or G91, #5041 where the tool is; what nobody can know here is refused."""
    assert places("G91\n#1=#4003\nG90 X4\nG#1 X1\nG90 Y[#5041+1]\nM30\n") == [(4, 0, 5), (5, 0, 5), (5, 6, 5)]
    with pytest.raises(GCodeError, match="Line 4: #4012 is the control's own, and is not known here"):
        read("X#4012\nM30\n")


def test_a_variable_that_nobody_has_set_is_said() -> None:
    found = [f for f in read("X[#500+3]\nM30\n").findings if f.code == "never-set"]
    assert [(f.level, f.line, f.message[:8]) for f in found] == [("warning", 4, "#500 is ")]


@pytest.mark.parametrize(
    ("call", "says"),
    [
        ("G65 P77 X1", "G65 calls O77, but there is no O77 in the program"),
        ("G65 X1", "a macro is called by P"),
        ("G65 P9.5", "a macro is called by P"),
        ("G65 P-9", "a macro is called by P"),
        ("G65 P9 L10000", "a macro is called by P"),
        ("G65 P9 L-1", "a macro is called by P"),
        ("G66 P9 L0.5", "a macro is called by P"),
        ("G65 P9 G1", "found 'G' among the values of a macro"),
    ],
)
def test_what_cannot_be_called_is_refused(call: str, says: str) -> None:
    with pytest.raises(GCodeError, match=f"Line 4: {says}"):
        read(f"{call}\nM30\nO9\nM99\n")


#: Custom Macro B, argument specification I and II, as the manual prints the two tables.
FIRST = "A#1 B#2 C#3 I#4 J#5 K#6 D#7 E#8 F#9 H#11 M#13 Q#17 R#18 S#19 T#20 U#21 V#22 W#23 X#24 Y#25 Z#26"
SECOND = [f"{letter}#{4 + 3 * n + k}" for n in range(10) for k, letter in enumerate("IJK")]


@pytest.mark.parametrize("order", [1, -1])
def test_letters_are_the_variables_of_the_manuals_table(order: int) -> None:
    """Each with a value of its own, in any order of the letters; all other variables are empty."""
    table = [each.split("#") for each in FIRST.split()]
    said = {letter: 100 + int(number) for letter, number in table}
    words = [f"{letter}{value}." for letter, value in said.items()]
    if order < 0:  # but I, J, K in theirs: another order makes a second set
        words = [*reversed([each for each in words if each[0] not in "IJK"]), "I104.", "J105.", "K106."]
    sets = "".join(f"IF [#{k} EQ #0] GOTO {k}\nX#{k}\nN{k}\n" for k in range(1, 34))
    found = [x for x, *_ in places(f"G65 P9 (values) {' '.join(words)} (end)\nM30\nO9\n{sets}M99\n")]
    assert found == sorted(float(value) for value in said.values())


@pytest.mark.parametrize("count", [1, 2, 3, 10, 11])
def test_sets_of_i_j_and_k_fill_the_manuals_second_table(count: int) -> None:
    words = " ".join(f"I{3 * n + 1}. J{3 * n + 2}. K{3 * n + 3}." for n in range(count))
    body = f"G65 P9 {words}\nM30\nO9\n" + "".join(f"X#{each.split('#')[1]}\n" for each in SECOND[: 3 * count])
    if count > 10:
        with pytest.raises(GCodeError, match="Line 4: I, J and K are given more than 10 times"):
            read(f"{body}M99\n")
    else:
        assert [x for x, *_ in places(f"{body}M99\n")] == list(range(1, 3 * count + 1))


@pytest.mark.parametrize(
    ("words", "variables"),
    [
        ("I1. K2. J3.", {4: 1, 6: 2, 8: 3}),
        ("J1. I2. K3.", {5: 1, 7: 2, 9: 3}),
        ("K1. K2. K3.", {6: 1, 9: 2, 12: 3}),
        ("I1. D2. I3.", {4: 1, 7: 3}),  # the later of two words for one variable counts
        ("I1. I3. D2.", {4: 1, 7: 2}),
    ],
)
def test_i_j_or_k_left_out_goes_on_to_the_next_set(words: str, variables: dict[int, float]) -> None:
    body = f"G65 P9 {words}\nM30\nO9\n" + "".join(f"X#{number}\n" for number in variables)
    assert [x for x, *_ in places(f"{body}M99\n")] == list(variables.values())


@pytest.mark.parametrize("number", [1, 33, 100, 199, 500, 999])
def test_a_variable_is_empty_until_it_is_set(number: int) -> None:
    assert places(f"X9 Y#{number}\n#{number}=4\nX8 Y#{number}\n#{number}=#0\nX7 Y#{number}\nM30\n") == [
        (9, 0, 5),
        (8, 4, 5),
        (7, 4, 5),
    ]


def test_what_the_control_says_of_itself() -> None:
    """Groups 01, 02, 03 and 06, F, S and T, and the place in the coordinates in force, each as a step along X."""
    head = "G10 L2 P2 X100. Y50.\nT7 M6\nG55 G18 G91 G1 F250. S900 M3\nG90 X1. Y2. Z3.\n"
    asked = {4001: 1, 4002: 18, 4003: 90, 4006: 21, 4109: 250, 4119: 900, 4120: 7, 5041: 1, 5042: 2, 5043: 3, 5001: 1}
    kept = "".join(f"#{100 + k}=#{number}\n" for k, number in enumerate(asked))
    body = head + kept + "".join(f"X#{100 + k}\n" for k in range(len(asked)))
    assert [x - 100 for x, *_ in places(f"{body}M30\n")[-len(asked) :]] == list(asked.values())
    assert places("G20 X1.\n#100=#4006\nG21 X#100\nG91\n#101=#4003\nG90 G0 X#101\n#102=#4001\nX#102\nM30\n")[1:] == [
        (20, 0, 5),
        (91, 0, 5),
        (0, 0, 5),
    ]


def test_g67_ends_a_modal_macro_that_is_not_called_from_within_itself() -> None:
    body = "G66 P9 X3. L2\nG0 Y1\nM8\nG67\nY5\nM30\nO9\nG91 X#24\nG90\nM99\n"
    assert places(body) == [(0, 1, 5), (3, 1, 5), (6, 1, 5), (6, 5, 5)]


@pytest.mark.parametrize(
    "line", ["G67 X30", "G90 G67 X30", "G0 X30 G67", "N5 G80 G67 G0 X30 (end)", "G67\nX30", "G67 M9\nX30"]
)
def test_g67_ends_a_modal_macro_wherever_it_stands_and_its_line_is_executed(line: str) -> None:
    body = f"G66 P9 Z-2 F100\nX10\n{line}\nY4\nM30\nO9\nG1 Z#26 F#9\nG0 Z5\nM99\n"
    assert places(body) == [(10, 0, 5), (10, 0, -2), (10, 0, 5), (30, 0, 5), (30, 4, 5)]
    assert not [each for each in read(body).findings if "G67" in each.message]
