"""Lines as they are executed, against the interpreter that runs them in stretches."""

import numpy as np
import pytest

from robomill.toolpath.gcode.reading import interpret
from robomill.toolpath.gcode.trace import trace

LOOP = (
    "G21 G90\n#1=0\nG0 Z5\nG1 Z-2 F300\no100 while [#1 LT 3]\n#1=[#1+1]\nG1 X[#1*10] Y#1\no100 endwhile\nG0 Z20\nM2\n"
)
FRAMES = "G21 G90\nG10 L2 P2 X5 Y7 Z1 R30\nG55\nG0 X1 Y2 Z5\nG20\nG92 X1\nG91 G1 X1 Y1 Z-.1 F20 A10\nG18\nG1 X.5\nM30\n"


@pytest.mark.parametrize("text", [LOOP, FRAMES])
def test_the_moves_are_those_of_the_interpreter(text: str) -> None:
    program, executed, dialect = trace(text)
    again = interpret(text.encode())
    np.testing.assert_array_equal(program.end, again.end)
    np.testing.assert_array_equal(program.line, again.line)
    assert dialect == again.dialect
    assert sum(each.last - each.first for each in executed) == len(again)
    for each in executed:
        assert (program.line[each.first : each.last] == each.index + 1).all()


def test_a_loop_is_written_down_as_often_as_it_is_run() -> None:
    _, executed, _ = trace(LOOP)
    assert [each.index for each in executed].count(6) == 3


def test_modes_lead_from_words_to_the_machine_and_back() -> None:
    program, executed, _ = trace(FRAMES)
    said = {3: [1.0, 2.0, 5.0]}
    for each in executed:
        for j in range(each.first, each.last):
            words = each.modes.words(program.end[j])
            np.testing.assert_allclose(each.modes.point(words), program.end[j], atol=1e-15)
            if each.index in said:
                np.testing.assert_allclose(words, said[each.index], atol=1e-12)
    last = executed[-2].modes
    assert (last.unit, last.absolute, last.plane) == ("in", False, 18)
    assert last.angles(program.rotary[-1])[0] == pytest.approx(10.0)


def test_modes_that_turn_words_into_other_places_are_named() -> None:
    text = "O1\nG21 G90\nG51 X0 Y0 Z0 P2000\nG0 X1\nG50\nG0 X2\nG16\nG0 X3 Y30\nG15\nM30\n"
    _, executed, _ = trace(text, "fanuc")
    assert [each.modes.other for each in executed if each.last > each.first] == [
        ("scaling (G51)",),
        (),
        ("polar words (G16)",),
    ]
