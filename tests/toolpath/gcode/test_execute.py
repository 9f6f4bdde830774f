"""What a line sets: tools and what is said of them."""

from __future__ import annotations

import math
from itertools import product

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret


@pytest.mark.parametrize(("in_spindle", "selected", "on_line"), [*product([0, 4], [None, 0, 7], [None, 0, 9])])
def test_a_change_to_no_tool_is_told_only_where_none_was_named_and_none_was_there(in_spindle, selected, on_line):
    before = [f"M61 Q{in_spindle}"] if in_spindle else []
    before += [] if selected is None else [f"T{selected}"]
    change = "M6" if on_line is None else f"T{on_line} M6"
    program = interpret("\n".join(["G21", *before, change, "G0 X1", "M2\n"]))
    told = [f.line for f in program.findings if f.code == "no-tool"]
    nothing_named = not selected and on_line is None
    assert told == ([len(before) + 2] if nothing_named and not in_spindle else [])
    number = on_line if on_line is not None else selected or 0
    assert program.tool.tolist() == [number]


def test_tool_0_is_no_tool_and_may_be_said():
    assert interpret("G21\nM61 Q4\nM61 Q0\nG0 X1\nM2\n").tool.tolist() == [0]
    with pytest.raises(GCodeError, match="M61 needs Q, a tool number of 0 or more"):
        interpret("G21\nM61 Q-1\nM2\n")


MODES = {
    "G20": "_imperial",
    "G18": "_plane",
    "G91": "_incremental",
    "G95": "_units_per_rev",
    "G56": "_coord_system",
    "G99": "_retract_r_plane",
    "G90.1": "_ijk_absolute_mode",
    "G7": "_lathe_diameter_mode",
}


def kept(text: str) -> list[float]:
    """What the modes are at the end of a program."""
    lines = [f"#{1 + i}=#<{name}>" for i, name in enumerate(MODES.values())]
    shown = "".join(f"(debug,#{1 + i})\n" for i in range(len(MODES)))
    program = interpret("\n".join([text, *lines, shown + "M2", ""]))
    return [float(said) for _, said in program.messages]


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize(("keep", "back"), [("M70", "M72"), ("O1 sub\nM73", "O1 endsub\nO1 call")])
def test_modes_that_were_kept_come_back(mode: str, keep: str, back: str) -> None:
    start = "G21 G17 G90 G94 G54 G98 G91.1 G8 F100 S100 M3\n"
    before, changed = kept(start), kept(f"{start}{mode}\n")
    assert changed != before
    assert kept(f"{start}{keep}\n{mode}\n{back}\n") == before


def test_a_point_is_kept_where_it_is_when_units_come_back() -> None:
    program = interpret("G21 G90\nG0 X25.4 Y50.8\nM70\nG20\nG0 X3\nM72\nG0 Z5\nM2\n")
    assert program.end[-1] * 1e3 == pytest.approx([76.2, 50.8, 5.0])


def test_diameters_are_halved_until_radii_count_again() -> None:
    program = interpret("G21 G90 G7\nG0 X30 Z1\nX20\nG8 X12\nG7 X12\nM2\n")
    assert program.end[:, 0] * 1e3 == pytest.approx([15, 10, 12, 6])


def test_no_input_is_ever_read_and_5399_says_so():
    """LinuxCNC: #5399 is -1 where an input was waited for in vain."""
    assert interpret("G21\nG0 X5\nM66 P0 L0\nG0 X#5399\nM2\n").end[:, 0].tolist() == pytest.approx([5e-3, -1e-3])


def test_m72_ends_and_renews_the_shift_of_g92() -> None:
    """As rs274 moves: M72 does G92.2 where G92 came behind M70, and G92.3 where G92.2 did."""
    program = interpret("G21 G90\nG0 X1\nM70\nG92 X11\nM72\nG0 X5\nG92.3\nM70\nG92.2\nG0 X6\nM72\nG0 X6\nM2\n")
    assert (program.end[:, 0] * 1e3).round(9).tolist() == [1, 5, 6, -4]


def test_where_a_probe_ended_is_kept_in_the_program_s_units() -> None:
    """LinuxCNC: #5061 to #5066 are X to C of the last probe, in the coordinates in force; #5070 is 1 where it hit."""
    probe = "G20 G90\nG10 L2 P1 X1 Y2 Z3\nG0 X4 Y5 Z6 A7 B8 C9\nG38.2 Z5.5 F10\nG0 X9 Y9 Z9 A0 B0 C0\n"
    program = interpret(f"{probe}G0 X#5061 Y#5062 Z#5063 A#5064 B#5065 C[#5066 + #5070]\nM2\n")
    assert program.end[-1].tolist() == pytest.approx([0.0254 * v for v in (4 + 1, 5 + 2, 5.5 + 3)])
    assert program.rotary[-1].tolist() == pytest.approx([math.radians(v) for v in (7, 8, 9)])


@pytest.mark.parametrize(("code", "must_meet"), [("G38.2", True), ("G38.3", False), ("G38.4", True), ("G38.5", False)])
def test_a_probe_that_must_meet_something_has_a_way_to_go(code: str, must_meet: bool) -> None:
    """LinuxCNC: G38.2 and G38.4 report a probe that met nothing; G38.3 and G38.5 are content with that."""
    text = f"G21 G90 F100\nG0 X1 Y2 Z50\n{code} X1 Y2 Z{{}}\nG1 X5\nM2\n"
    assert (interpret(text.format(49.9)).end[-1] * 1e3).tolist() == pytest.approx([5, 2, 49.9])
    if must_meet:
        with pytest.raises(GCodeError, match=f"^Line 3: {code} starts where it should end; move away first"):
            interpret(text.format(50))
    else:
        assert (interpret(text.format(50)).end[-1] * 1e3).tolist() == pytest.approx([5, 2, 50])


UNITS_IN_CYCLE = [
    ("fanuc", "O1\nG21 G90 S9 M3 F99\nG81 X1. Z-5. R2.\n{}G20\nX1.\n", "G80\n"),
    ("auto", "G21 G90 S9 M3 F99\nG81 X1 Z-5 R2\n{}G20\nG0 X1\n", "G80\n"),
    ("sinumerik", "G71 G90 S9 M3 F99\nMCALL CYCLE81(30,0,2,-5)\n{}G70\nG0 X1\n", "MCALL\n"),
]


@pytest.mark.parametrize(("dialect", "text", "end"), UNITS_IN_CYCLE)
def test_units_do_not_change_beneath_a_cycle_that_holds(dialect: str, text: str, end: str) -> None:
    """A depth of 5 mm became one of 5 in at the next hole."""
    with pytest.raises(GCodeError, match=r"^Line [34]: units change while a cycle is in force"):
        interpret(f"{text.format('')}M30\n", dialect=dialect)
    assert interpret(f"{text.format(end)}M30\n", dialect=dialect).end[-1, 0] == pytest.approx(25.4e-3)
    same = text.format("").replace("G20", "G21").replace("G70", "G71")
    assert interpret(f"{same}M30\n", dialect=dialect).end[-1, 0] == pytest.approx(1e-3)
