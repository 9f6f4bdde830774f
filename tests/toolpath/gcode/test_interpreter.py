"""Where a program's lines end: how long one may be, and how a program goes back to who called it."""

from __future__ import annotations

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret, read_gcode
from robomill.toolpath.gcode.interpreter import MAX_LINE


@pytest.mark.parametrize("first", ["G0 X5", "#1=5 G0 X5"])
def test_a_line_may_be_so_long_and_no_longer(first):
    longest = first + " " * (MAX_LINE - len(first))
    assert interpret(f"G21\n{longest}\nM2\n").end[-1, 0] == pytest.approx(5e-3)
    with pytest.raises(GCodeError, match=f"Line 2: {MAX_LINE + 1} characters long"):
        interpret(f"G21\n{longest} \nM2\n")


def said(text, code):
    return [(f.line, f.level) for f in interpret(text).findings if f.code == code]


@pytest.mark.parametrize("end", ["%", "%(done)", "%;done", " % "])
def test_a_percent_sign_ends_the_program_it_began(end):
    text = f"\n %\nG21\nG0 X1\n{end}\nG0 X9\n"
    assert interpret(text).end[-1, 0] == pytest.approx(1e-3)
    assert said(text, "percent") == []
    assert said(f"G21\nG0 X1\n{end}\n", "percent") == [(3, "warning")]


@pytest.mark.parametrize("end", ["%X", "%9", "% G0"])
def test_a_percent_sign_with_more_behind_it_is_no_end(end):
    with pytest.raises(GCodeError, match="Line 3: found % and more") as refused:
        interpret(f"%\nG21\n{end}\n%\n")
    assert refused.value.line == 3


def test_behind_the_percent_sign_that_begins_a_program_may_be_its_name():
    assert said("\n%PART 7\nG21\nM2\n", "program-name") == [(2, "info")]
    assert said("%\nG21\nM2\n", "program-name") == []


@pytest.mark.parametrize(
    ("rest", "line"), [("", 0), ("\n\n(made by hand)\n; and so on\n%\n", 0), ("G0 X1\n", 4), ("\n\nX9\nX8\n", 6)]
)
def test_what_stands_behind_the_end_is_said_with_its_line(rest, line):
    assert said(f"G21\nG0 X1\nM2\n{rest}", "after-end") == [(line, "warning")] * bool(line)


def test_a_program_without_an_end_is_told_so_on_its_last_line():
    assert said("G21\nG0 X1\n", "no-end") == [(3, "warning")]
    assert said("G21\nG0 X1", "no-end") == [(2, "warning")]
    for end in ("M2", "M30", "%"):
        assert said(f"G21\nG0 X1\n{end}\n", "no-end") == []


def test_comments_that_speak():
    text = "G21\n#1=4\n(MSG, #1 is here)\n(debug,#1)\n( print , [#1] )\n(log,a, b)\n(note, #1)\n(msg)\nM2\n"
    assert [(line, words.strip()) for line, words in interpret(text).messages] == [
        (3, "#1 is here"),
        (4, "4.000000"),
        (5, "[4.000000]"),
        (6, "a, b"),
    ]
    with pytest.raises(GCodeError, match="Line 2: the program gives up: too deep by 4.000000"):
        interpret("#1=4\n(abort, too deep by #1)\nM2\n")
    assert len(interpret("(msg,x)\n" * 1003 + "M2\n").messages) == 1000


def test_a_percent_sign_behind_comments_alone_begins_the_program():
    """As posts write it that name themselves first; LinuxCNC takes it for the end."""
    text = "( made with a post )\n;of ours\n\n%\nG21\nG0 X1\n%\nG0 X9\n"
    assert interpret(text).end[-1, 0] == pytest.approx(1e-3)
    with pytest.raises(GCodeError, match="no motion"):
        read_gcode(text, dialect="linuxcnc")
