"""Where programs go on: against Python's own way through the same program, and compiled against plain."""

from __future__ import annotations

import dataclasses
import random
import time
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.progress import Cancelled, Progress, watched
from robomill.toolpath.gcode import interpret, interpreter, stretches
from robomill.toolpath.gcode.program import Program
from robomill.toolpath.gcode.rules.flow_rules import first_word
from tests.toolpath.gcode.programs import Writer

ODD = (
    *("O7 if 1", "G0 X[1/0]", "#<other>=#<nope>", "O101 endif", "O1 call [1", "O2 call [#<nope>]", "O55 call"),
    *("O101 break", "O102 continue", "O103 else", "/O2 call [1] [2]", "O104 elseif [1]", "O1 return", "M70", "M73"),
    *("O2 call [#<_x>] [#5420]", "(debug,#1 #<_value>)", "O1 endsub [1] x", "o#1 call [3]", "o[1+1] call [0] [2]"),
    *("O9999 (bare)", "M98 P9999 L2", "M99", "G0 X#<_call_level>", "O3 sub", "O106 repeat [3]", "O101 endrepeat"),
    *("O106 do", "G41.1 D2", "G40", "G0 X#<n_args>", "M2", "%", "O1 call" + " [1]" * 31, "o 1 c a l l [1]", "O1 foo"),
    *("N5 O1 call [1] [1] (\u00e4)", "G0 @5 ^20", "^30", "G0 X[EXISTS[#<n_args>]]", "M72", "O107 while [1]"),
)
"""Lines to come between: refused, or of more than the rules know."""


@pytest.fixture(params=["plain", "compiled"])
def way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    _go(monkeypatch, request.param)
    return str(request.param)


def _go(monkeypatch: pytest.MonkeyPatch, way: str) -> None:
    for name in ("LONG", "LOADED_LONG"):
        monkeypatch.setattr(stretches, name, 0 if way == "compiled" else 10**9)


def xs(program: Program) -> list[float]:
    return [round(float(x) * 1e3, 9) for x in program.end[:, 0]]


def test_programs_go_where_python_goes(way: str) -> None:
    told = 0
    for seed in range(150):
        writer = Writer(seed)
        assert xs(interpret(writer.text())) == writer.expected(), writer.text()
        told += len(writer.expected())
    assert told > 500


def read(text: str) -> list[Any]:
    program = interpret(text, partial=True)
    return [getattr(program, field.name) for field in dataclasses.fields(program)]


def test_compiled_rules_go_where_plain_ones_go(monkeypatch: pytest.MonkeyPatch) -> None:
    """Programs that break out of everything, with lines left out and odd ones between, to the same refusals."""
    monkeypatch.setattr(interpreter, "MAX_STEPS", 3000)
    refused = 0
    for seed in range(300):
        lines, r = Writer(seed, wild=True).lines, random.Random(seed)
        for _ in range(r.randint(0, 3)):
            at = r.randrange(len(lines))
            lines[at : at + r.randint(0, 1)] = [r.choice(ODD)] * r.randint(0, 1)
        found = []
        for way in ("plain", "compiled"):
            _go(monkeypatch, way)
            found.append(read("\n".join(lines)))
        for plain, compiled in zip(*found, strict=True):
            if isinstance(plain, np.ndarray):
                np.testing.assert_allclose(compiled, plain, rtol=1e-14, atol=1e-14)
            else:
                assert plain == compiled, "\n".join(lines)
        refused += any("refused" in str(field) for field in found[0])
    assert 50 < refused < 250


def test_what_is_returned_and_what_is_passed(way: str) -> None:
    text = (
        "G21\nO1 sub\nO2 if [#1 GT 0]\nO1 return [#1*10]\nO2 endif\nO1 endsub\n"
        "O1 call [4]\nG0 X#<_value>\nG0 X#<_value_returned>\nO1 call [-4]\nG0 X#<_value>\nG0 X#<_value_returned>\n"
        "O3 sub\nG0 X#<n_args>\nG0 X#30\n#30=7\nO3 endsub\n#30=5\nO3 call" + " [2]" * 30 + "\nG0 X#30\nM2\n"
    )
    assert xs(interpret(text)) == [40, 1, 0, 0, 30, 2, 5]


def test_a_call_is_left_by_the_interpreter_where_more_is_to_be_done(way: str) -> None:
    """Modes that M73 keeps, subprograms, computed numbers."""
    kept = "G21 G90\nO1 sub\nM73\nG91\nG0 X1\nO1 endsub\nO1 call\nO1 call\nG0 X5\nM2\n"
    assert xs(interpret(kept)) == [1, 2, 5]
    computed = "G21\nO7 sub\nG0 X#1\nO7 endsub\n#1=7\no#1 call [3]\nG0 X#1\nM2\n"
    assert xs(interpret(computed)) == [3, 7]
    again = (
        "G21 G91\n#1=0\nO5 repeat [2]\nM98 P9 L2\nO5 endrepeat\nM2\n"
        "O9\nO6 repeat [2]\n#1=[#1+1]\nG0 X#1\nO6 endrepeat\nM99\n"
    )
    assert xs(interpret(again)) == [1, 3, 6, 10, 15, 21, 28, 36]


def test_so_many_lines_are_executed_and_no_more(way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interpreter, "MAX_STEPS", 5000)
    text = "#1=0\nO1 while [1]\n#1=[#1+1]\nG0 X#1\nO1 endwhile\n"
    program = interpret(text, partial=True)
    assert len(program) == (5000 + 6 - 1) // 4  # of its 6 lines and 5000 more, the first sets #1
    with pytest.raises(GCodeError, match="more than 5000 lines were executed"):
        interpret(text)


@pytest.mark.parametrize("line", ["#1=[#1+1]", f"#1=[{'+'.join(['1'] * 100)}]", "G0 X[SIN[#1]]"])
def test_a_loop_hears_that_it_is_wanted_no_more(way: str, line: str) -> None:
    heard: list[float] = []

    def stop() -> bool:
        heard.append(time.monotonic())
        return len(heard) > 4

    with watched(Progress(stop=stop)), pytest.raises(Cancelled):
        interpret(f"#1=0\nO1 while [1]\n{line}\nO1 endwhile\n")
    assert max(b - a for a, b in pairwise(heard)) < (2.0 if way == "plain" else 0.5)


@pytest.mark.parametrize("count", [0, 1, 2, 7])
def test_the_first_word_at_or_behind_a_line(count: int) -> None:
    lines = sorted(random.Random(count).sample(range(20), count))
    words = np.array([(line,) for line in lines], [("line", "i8")]).view(np.recarray)
    for line in range(22):
        assert first_word(words, line) == sum(known < line for known in lines)


TAKES = {  # values behind an O word that LinuxCNC reads there, and a program around it
    "if": (1, "o1 if{}\nG0 X1\no1 endif"),
    "elseif": (1, "o1 if [0]\no1 elseif{}\nG0 X1\no1 endif"),
    "while": (1, "G0 X1\no1 while{}\no1 break\no1 endwhile"),
    "repeat": (1, "o1 repeat{}\nG0 X1\no1 endrepeat"),
    "return": (1, "o1 sub\nG0 X1\no1 return{}\no1 endsub\no1 call"),
    "endsub": (1, "o1 sub\nG0 X1\no1 endsub{}\no1 call"),
    "sub": (0, "o1 sub{}\nG0 X1\no1 endsub\no1 call"),
    "do": (0, "o1 do{}\nG0 X1\no1 while [0]"),
    "endif": (0, "o1 if [1]\nG0 X1\no1 endif{}"),
}


@pytest.mark.parametrize("word", TAKES)
def test_a_value_more_than_a_word_takes_is_refused(word: str) -> None:
    most, body = TAKES[word]
    head = "G21 G90\n"
    assert interpret(f"{head}{body.format(' [1]' * most)}\nM2\n").end[-1, 0] == pytest.approx(1e-3)
    with pytest.raises(GCodeError, match=rf"found '\[7\]' after O1 {word}; remove it"):
        interpret(f"{head}{body.format(' [1]' * most + ' [7]')}\nM2\n")
