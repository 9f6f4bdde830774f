"""What is doubted of a program that can be read."""

from __future__ import annotations

import re

import pytest

from robomill.toolpath.gcode import interpret, read_gcode

POINTS = "".join(f"X{k}.5 Y{k}.\n" for k in range(60))


@pytest.mark.parametrize(
    ("slip", "dialect", "said"),
    [
        ("X100", "auto", True),
        ("Z-5", "fanuc", True),
        ("X100", "grbl", False),
        ("X0", "auto", False),
        ("X100.", "auto", False),
        ("(X100)", "auto", False),
        ("(3X3 BLOCK, X100 Y7)", "auto", False),
        ("X1.5 ;X100 on", "auto", False),
        ("#100=5\nX#100", "auto", False),
        ("X100Y2.5", "auto", True),
        ("X100(on)Y2.5", "auto", True),
        ("X1E2", "auto", False),
    ],
)
def test_a_missing_decimal_point_among_numbers_that_have_one_is_doubted(slip: str, dialect: str, said: bool) -> None:
    found = interpret(f"G21 G90\nG1 F100 X1.\n{POINTS}{slip}\nM30\n", dialect=dialect).findings
    doubts = [(f.line, f.level, f.message.split()[0]) for f in found if f.code == "no-point"]
    assert doubts == [(63, "suspicious", re.split("[Y(]", slip)[0])] * said


def test_programs_that_write_whole_numbers_are_not_doubted() -> None:
    text = "".join(f"X{k} Y{k}.5\n" for k in range(60))
    assert not [f for f in interpret(f"G21 G90\nG1 F100 X1.\n{text}M30\n").findings if f.code == "no-point"]


@pytest.mark.parametrize(("said", "doubted"), [("", True), ("G21 ", False), ("G20 ", False)])
def test_a_small_part_is_doubted_only_where_no_unit_is_said(said: str, doubted: bool) -> None:
    found = interpret(f"{said}G90 G0 Z1\nG1 X5 F100\nM30\n").findings
    assert ("size-doubt" in {f.code for f in found}) == doubted


def test_a_second_table_is_asked_for() -> None:
    """One stated table turns the part; another axis that turns as far cannot be a lean of the tool."""
    text = "G21 G90 G0 X0 Y0 Z30 A0 C0\nG1 Z20 F100\nX5 A120\nX10 A200 {}\nM30\n"
    both = [f for f in read_gcode(text.format("C180"), table="A").findings if f.code == "rotary-asked"]
    assert [(f.line, f.message[:44]) for f in both] == [(4, "C turns by 180 degrees beside the rotary tab")]
    assert not [f for f in read_gcode(text.format("C45"), table="A").findings if f.code == "rotary-asked"]


@pytest.mark.parametrize(("angle", "asked"), [("B89.9", False), ("B90", True), ("A-90.", True), ("A91", True)])
def test_a_quarter_is_asked_for(angle: str, asked: bool) -> None:
    """Two faces of a part on a table: the commonest program with a fourth axis, whose tool would lie on its side."""
    text = f"G21 G90 S9 M3\nG0 X0 Y0 Z30\nG1 Z20 F100\nG0 Z30\nG0 {angle}\nG1 Z20\nM30\n"
    assert any(f.code == "rotary-asked" for f in read_gcode(text).findings) == asked


@pytest.mark.parametrize(
    ("line", "asked"), [("B30 C20", ["C"]), ("C20", []), ("B30", []), ("A-5 B3 C-170", ["C"]), ("B100 C20", ["B", "C"])]
)
def test_c_beside_a_lean_is_asked_for_at_any_angle(line: str, asked: list[str]) -> None:
    """A head or table that turns by C leads the lean aside; about the tool's own axis C changes nothing."""
    text = f"G21 G90 G0 X0 Y0 Z30\nG1 Z20 F100\nX10 {line}\nM30\n"
    assert [f.message[0] for f in read_gcode(text).findings if f.code == "rotary-asked"] == asked
    back = [f"G21 F9\nG0 X9 B30 C20\n{way} B0 C0\nG1 X5\nM2\n" for way in ("G0", "G1")]
    assert [any(f.code == "rotary-asked" for f in read_gcode(each).findings) for each in back] == [False, True]


def test_a_few_whole_numbers_with_a_point_show_how_a_program_writes_them() -> None:
    text = "G21 G90\nG0 X10. Y20.\nG1 Z-5. F100.\nX2000\nX30.5\nM30\n"
    assert [f.line for f in interpret(text).findings if f.code == "no-point"] == [4]


def test_numbers_without_needless_zeros_are_not_doubted() -> None:
    """Posts that write 10 for 10.000 have hardly a whole number in a finished surface."""
    text = "".join(f"X{k / 7:.3f} Y{k / 11:.3f} Z-{k / 13:.3f}\n" for k in range(1, 200) if k % 7 and k % 11 and k % 13)
    assert not [f for f in interpret(f"G21 G90\nG1 F100 X1\n{text}X5\nM30\n").findings if f.code == "no-point"]


@pytest.mark.parametrize(("said", "found"), [("G56", True), ("G54", False), ("", False), ("G10 L2 P3 X0\nG56", False)])
def test_a_system_other_than_the_first_is_said_to_be_at_part_zero(said: str, found: bool) -> None:
    findings = interpret(f"G21 G90 S9 M3\n{said}\nG1 X5 F9\nM30\n").findings
    assert [f.message[:40] for f in findings if f.code == "zero-taken"] == [
        "part zero is taken to be that of G56, wh"
    ] * found


@pytest.mark.parametrize(
    ("text", "code", "level"),
    [
        ("G21 G90\nG1 X-25000 Y-10000 F9\nM30\n", "no-points", "suspicious"),
        ("G21 G90\nG1 X50 Y20 F9\nM30\n", "no-points", "info"),
        ("G21 G90\nG1 X10000 Y5.5 F9\nM30\n", "no-point", "suspicious"),
        ("G21 G90\nG1 X1000 Y5.5 F9\nM30\n", "no-point", "suspicious"),  # a millimetre, in thousandths
        ("G21 G90\nG1 X999 Y5.5 F9\nM30\n", "", ""),
        ("G21 G90\nG1 X50. Y20. F9\nM30\n", "", ""),
    ],
)
def test_numbers_without_a_point_are_said_of_a_fanuc_program(text: str, code: str, level: str) -> None:
    found = [(f.code, f.level) for f in interpret(text, dialect="fanuc").findings if f.code.startswith("no-point")]
    assert found == ([(code, level)] if code else [])


@pytest.mark.parametrize(("unit", "read"), [("G21", "reads 50 as 0.05 mm"), ("G20", "reads 50 as 0.005 inches")])
def test_the_least_step_of_a_control_is_a_micrometre_or_a_tenth_of_a_thou(unit: str, read: str) -> None:
    """Fanuc's conventional input in increment system IS-B: 0.001 mm and 0.0001 inch."""
    findings = interpret(f"{unit} G90\nG1 X50 Y20 F9\nM30\n", dialect="fanuc").findings
    assert [read in each.message for each in findings if each.code == "no-points"] == [True]


def codes(text: str, dialect: str = "auto") -> list[str]:
    return [each.code for each in interpret(text, dialect=dialect).findings]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("%\nO1\nT0101\nG97 S1000 M3\nG0 X50. Z2.\nG1 Z-20. F0.2\nM30\n%\n", True),
        ("%\nO1\nT0101 M6\nG0 X50. Z2.\nG1 Z-20. F0.2\nM30\n%\n", False),
        ("%\nO1\nT0101\nG0 X50. Y0. Z2.\nG1 Z-20. F0.2\nM30\n%\n", False),
        ("%\nO1\nT0102\nG0 X50. Z2.\nG1 Z-20. F0.2\nM30\n%\n", False),
    ],
)
def test_the_program_of_a_lathe_is_told(text: str, said: bool) -> None:
    assert ("lathe" in codes(text)) == said


def test_a_program_that_moves_nothing_is_told() -> None:
    assert "no-move" in codes("o<a> sub\nG0 X1\no<a> endsub\nM2\n")
    assert "no-move" not in codes("G0 X1\nM2\n")


@pytest.mark.parametrize(("dialect", "said"), [("fanuc", True), ("linuxcnc", False)])
def test_on_a_fanuc_a_third_of_the_points_may_be_forgotten(dialect: str, said: bool) -> None:
    text = "G21 G90\nG0 X0. Y0. Z5.\nG1 Z-2. F100.\nX10.\nX25\nX30.\nX45\nX50.\nG0 Z50.\nM30\n"
    assert ("no-point" in codes(text, dialect)) == said
    many = text.replace("X30.", "X30").replace("X10.", "X10")
    assert "no-point" not in codes(many, dialect)


@pytest.mark.parametrize(("dwells", "said"), [((60,), False), ((60.5,), True), ((1, 119), False), ((1, 119.5), True)])
def test_dwells_of_more_than_a_minute_on_average_are_doubted(dwells: tuple[float, ...], said: bool) -> None:
    text = "".join(f"G4 P{each}\n" for each in dwells)
    program = interpret(f"G21 G90 F100\nG1 X1\n{text}G1 X2\nM2\n", dialect="linuxcnc")
    assert ("long-dwell" in {f.code for f in program.findings}) == said


@pytest.mark.parametrize(
    ("body", "dialect", "code", "line"),
    [
        # LinuxCNC's P on an arc is no word of a Fanuc's
        ("G0 X5. Y0\nG3 I-5. Z-3. P3\n", "fanuc", "arc-turns", 3),
        ("G0 X5. Y0\nG3 I-5. Z-3.\n", "fanuc", "", 0),
        ("G0 X5. Y0\nG3 I-5. Z-3. P3\n", "linuxcnc", "", 0),
        # Fanuc, canned cycles: operation 1 goes to X and Y at the initial level, 2 to R, 6 back to the initial level
        ("G0 X0 Y0 Z1.\nG98 G81 X9. Z-5. R2.\nX20.\n", "fanuc", "cycle-below-r", 3),
        ("G0 X0 Y0 Z1.\nG98 G81 Z-5. R2.\n", "fanuc", "", 0),
        ("G0 X0 Y0 Z3.\nG98 G81 X9. Z-5. R2.\nX20.\nX30. R2.5\n", "fanuc", "", 0),
        ("G0 X0 Y0 Z3.\nG98 G81 X9. Z-5. R2.\nX20.\nX30. R5.\n", "fanuc", "cycle-below-r", 5),
        ("G0 X0 Y0\nG98 G81 X9. Z-5. R2.\nX20.\n", "fanuc", "", 0),  # how high the tool stands nobody has said
        ("G0 Z1.\nG91 G28 X0 Y0 Z5.\nG90\n", "fanuc", "", 0),
        ("#1=ATAN[-1]/[1]\nG1 X#1\n", "fanuc", "atan-range", 2),
    ],
)
def test_what_a_fanuc_control_may_do_otherwise_is_said(body: str, dialect: str, code: str, line: int) -> None:
    found = interpret(f"G21 G90 G17 F100\n{body}M30\n", dialect=dialect).findings
    said = [(f.code, f.line) for f in found if f.code in ("arc-turns", "cycle-below-r", "atan-range")]
    assert said == ([(code, line)] if code else [])
