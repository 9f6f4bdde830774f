"""What people's programs do without a word of theirs is said: cuts with a spindle that stands still, and the like."""

from __future__ import annotations

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret
from robomill.toolpath.tools import Tool


def said(text: str) -> set[str]:
    return {finding.code for finding in interpret(text).findings}


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("G21 S9 M3\nG1 X99 F1\nM5\nG1 X10\nM2\n", "spindle-stopped"),
        ("G21 T1 M6 S9 M3\nG1 X99 F1\nT2 M6\nG1 X10\nM2\n", "spindle-stopped"),  # a tool change stops it
        ("G21 M3\nG1 X99 F1\nM2\n", "no-spindle"),
        ("G21 S900\nG1 X99 F1\nM2\n", "no-spindle"),
        ("G21 T3\nS900 M3\nG1 X99 F1\nM2\n", "no-change"),
        ("G21 M6\nS900 M3\nG1 X99 F1\nM2\n", "no-tool"),
        ("G21 S9 M3\nG1 X99 F1\nM30\nG1 Z-5\n", "after-end"),
    ],
)
def test_it_is_said(text: str, code: str) -> None:
    assert code in said(text)


def test_nothing_is_said_of_what_is_in_order() -> None:
    codes = {"spindle-stopped", "no-spindle", "no-change", "no-tool", "after-end"}
    good = "%\nO1000\nG21 T1 M6\nT2\nS9 M3\nM98 P2\nM6\nS9 M4\nG1 X9\nM5\nG0 Z9\nM30\nO2\nG1 X99 F1\nM99\n%\n"
    assert not codes & said(good)
    assert not codes & said("G21 G96 S9 M3\nG1 X99 F1\nM2\n(the end)\n")


def test_each_stretch_with_the_spindle_stopped_counts_once() -> None:
    text = "G21 S9 M3 F1\nG1 X99\nM5\nX1\nX2\nM3\nX3\nM5\nX4\nX5\nM2\n"
    (found,) = (f for f in interpret(text).findings if f.code == "spindle-stopped")
    assert (found.line, found.count) == (4, 2)


@pytest.mark.parametrize(
    ("text", "dialect", "seconds"),
    [
        ("G04 P1500\n", "fanuc", 1.5),  # milliseconds where there is no point
        ("G4 P1.5\n", "fanuc", 1.5),
        ("G04 X1.5\n", "fanuc", 1.5),
        ("G4 P1500\n", "linuxcnc", 1500.0),
        ("G4 F1.5\n", "sinumerik", 1.5),
    ],
)
def test_dwells_count_as_their_control_counts_them(text: str, dialect: str, seconds: float) -> None:
    assert interpret(text, dialect=dialect).dwell_time == pytest.approx(seconds)


def test_smoothing_of_fanuc_and_haas_moves_nothing() -> None:
    program = interpret("O1000\nG21 G05.1 Q1\nG187 P3\nS9 M3\nG1 X5 F1\nG05.1 Q0\nM30\n", dialect="fanuc")
    assert len(program) == 1
    assert sum(f.count for f in program.findings if f.code == "harmless-g") == 3


@pytest.mark.parametrize(
    ("text", "says"), [("T2147483648 M6\n", "tool number"), ("F9\nG2 I1 P1e1\nG2 I1 P" + "9" * 308, "turns")]
)
def test_numbers_that_no_machine_has_are_refused(text: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        interpret(text.replace("P1e1", "P1") + "\n")


def found(text: str, code: str, **more):
    return [f for f in interpret(text, **more).findings if f.code == code]


@pytest.mark.parametrize(
    ("mm", "said_unit", "other"),
    [
        (7.9, "G21\n", ""),
        (8.0, "G21\n", ""),
        (7.9, "", "200.7 mm"),
        (7.9, "G20\n", ""),
        (3000.0, "G21\n", ""),
        (3001.0, "G21\n", "118.1 mm"),
        (3001.0, "G20\n", "118.1 mm"),
    ],
)
def test_a_part_of_an_unlikely_size_is_doubted(mm: float, said_unit: str, other: str) -> None:
    """Measured along its longest side, by the moves at feed. A small part is doubted where no unit is said."""
    size = mm / 25.4 if said_unit == "G20\n" else mm
    text = f"{said_unit}F100\nG0 X-9000 Y0\nX0\nG1 Y{size} X{0.5 * size}\nG0 Z9000\nM2\n"
    doubts = found(text, "size-doubt")
    assert [f.line for f in doubts] == [0] * bool(other)
    if other:
        assert other in doubts[0].message


def test_a_part_of_no_size_is_not_doubted() -> None:
    assert found("G21 F9\nG1 X0\nM2\n", "size-doubt") == []
    assert found("G21 F9\nG0 X1\nM2\n", "size-doubt") == []


def test_what_is_of_no_line_stands_at_line_0() -> None:
    text = "G21 T3\nG1 X99 F1\nM2\n"
    assert [f.line for code in ("no-spindle", "no-change") for f in found(text, code)] == [0, 0]
    assert [f.line for f in found("G0 X=1\nM2\n", "dialect-guessed")] == [0]
    assert found("G0 X=1\nM2\n", "dialect-guessed", dialect="sinumerik") == []
    assert found("G0 X1\nM2\n", "dialect-guessed") == []
    assert [f.line for f in found("G0 X1\nM2\n", "no-units")] == [0]
    assert found("M2\n", "no-units") == []


def test_cuts_with_another_tools_length_are_warned_of_once_a_tool_at_their_first_line() -> None:
    tools = {n: Tool(n, 6e-3, offset=(0.0, 0.0, 0.01 * n)) for n in (1, 2, 3)}
    text = "G21 F9 S9 M3\nT1 M6\nG43 H2\nG0 X1\nG1 X9\nX10\nT2 M6\nM3\nG43 H2\nX11\nT3 M6\nM3\nX12\nG38.3 X13\nM2\n"
    doubts = found(text, "wrong-length", tools=tools)
    assert [f.line for f in doubts] == [5, 13]
    assert "tool 1 cuts with the length of another tool (G43): its tip goes 10.000 mm higher" in doubts[0].message
    assert "tool 3" in doubts[1].message
    assert "10.000 mm lower" in doubts[1].message
    assert found(text.replace("G1 X9\nX10", "G38.3 X9\nG0 X10").replace("X12\n", ""), "wrong-length", tools=tools) == []


@pytest.mark.parametrize(("end", "lines"), [("M2", 3), ("M2\n", 3), ("M2\n\n", 4)])
def test_lines_are_counted_without_an_empty_last_one(end: str, lines: int) -> None:
    assert interpret(f"G21\nG0 X1\n{end}").lines == lines


def test_a_place_too_far_off_names_its_line() -> None:
    far = "1" + "0" * 308
    with pytest.raises(GCodeError, match="Line 3: a point lies 1e.305 m from part zero") as refused:
        interpret(f"G21 G91\nG0 X1\nX{far}\nX{far}\nM2\n")
    assert refused.value.line == 3


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("X1e99", "a point lies 1e.96 m from part zero"),
        ("X-10000001", "a point lies 10.000 m from part zero"),
        ("G2 X1 R1e15", "the centre of an arc lies more than 1 000 000 km from part zero"),
        ("A1e99", "an axis turns more than 100 000 times"),
        ("X1 F1e99", "a feed is above 60 000 000 mm/min"),
        ("M3 S1e99\nX1", "a spindle turns faster than 6 000 000 1/min"),
        ("G4 P1e99\nX1", "a dwell takes more than three years"),
    ],
)
def test_numbers_that_no_machine_has_are_refused_by_name(line: str, says: str) -> None:
    with pytest.raises(GCodeError, match=f"Line [23]: {says}"):
        interpret(f"G21 G90 G1 F100 X0\n{line}\nM2\n")
