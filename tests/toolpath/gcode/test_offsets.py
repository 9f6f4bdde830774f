"""Coordinate systems: what turns is not a length, what is measured is; words that a line does not take are refused."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Tool, interpret
from robomill.toolpath.gcode.chords import to_toolpath


@pytest.mark.parametrize("shift", ["G10 L2 P1", "G10 L20 P1", "G92", "G52"])
@pytest.mark.parametrize("back", ["", "G55\nG54\n"])  # as it is set, and as it is kept
def test_degrees_are_degrees_in_inches_too(shift, back):
    found = {}
    for unit, size in (("G21", 25.4), ("G20", 1.0)):
        before = f"{unit} G90 G94 F100\nG0 X{size} Y0 A5 B0\n{shift} X{2 * size} A30 B-12\n{back}"
        program = interpret(f"{before}G1 X{3 * size} Y{size} A10 B4\nM2\n")
        found[unit] = to_toolpath(program)
    np.testing.assert_allclose(found["G20"].k, found["G21"].k, atol=1e-12)
    np.testing.assert_allclose(found["G20"].p, found["G21"].p, atol=1e-12)
    assert np.ptp(found["G21"].k[:, 1]) > 0.1, "the axes do turn"


@pytest.mark.parametrize("kind", [2, 20])
@pytest.mark.parametrize("letters", ["I1", "J1", "I1 J2"])
def test_a_system_takes_no_centre(kind, letters):
    with pytest.raises(GCodeError, match=f"Line 2: G10 L{kind} takes no I or J"):
        interpret(f"G21\nG10 L{kind} P1 X1 {letters}\nM2\n")


def read(text, *numbers, tools=None):
    """What the parameters hold at the end of a program, as moves of X."""
    kept = " ".join(f"#{101 + i}=#{number}" for i, number in enumerate(numbers))
    shown = "".join(f"G53 G0 X#{101 + i}\n" for i in range(len(numbers)))
    program = interpret(f"{text}{kept}\nG49\n{shown}M2\n", tools=tools)
    return program.end[-len(numbers) :, 0] * 1e3


HERE = (5420, 5421, 5422)


@pytest.mark.parametrize("rotation", [0.0, 30.0, -115.0])
@pytest.mark.parametrize("g92", ["", "G92 X11 Y-4 Z2\n"])
def test_where_the_tool_stands_becomes_what_g10_l20_says(rotation, g92):
    start = f"G21 G90\nG10 L2 P1 X7 Y-3 Z1 R{rotation}\nG54\nG0 X5 Y3 Z2\n{g92}"
    x, y, z = read(start, *HERE)
    np.testing.assert_allclose(read(f"{start}G10 L20 P1 X1 Y2\n", *HERE), [1, 2, z], atol=1e-9)
    # What is not named stays as it is read.
    np.testing.assert_allclose(read(f"{start}G10 L20 P1 X1\n", *HERE), [1, y, z], atol=1e-9)
    np.testing.assert_allclose(read(f"{start}G10 L20 P1 Z-6\n", *HERE), [x, y, -6], atol=1e-9)
    # The tool has not moved, in this system nor in another.
    for system, code in ((1, "G54"), (2, "G55")):
        turned = f"G10 L2 P2 R{2 * rotation}\n" if system == 2 else ""
        program = interpret(f"{start}{turned}G10 L20 P{system} X1 Y2 Z3\n{code}\nG0 X1 Y2 Z3\nM2\n")
        np.testing.assert_allclose(program.end[-1], program.start[-1], atol=1e-12)


def test_a_shift_put_aside_and_taken_up_again_is_the_same():
    shift = "G21 G90\nG0 X5 Y6 Z7\nG92 X1 Y20 Z300 A4 B5\n"
    there = interpret(f"{shift}G0 X2 Y3 Z4\nM2\n").end[-1]
    again = interpret(f"{shift}G92.2\nG0 X9 Y9 Z9\nG92.3\nG0 X2 Y3 Z4\nM2\n").end
    np.testing.assert_allclose(again[-1], there, atol=1e-12)
    np.testing.assert_allclose(again[-2], [9e-3, 9e-3, 9e-3], atol=1e-12)
    np.testing.assert_allclose(there, [6e-3, -11e-3, -289e-3], atol=1e-12)


@pytest.mark.parametrize(
    "words",
    [
        *("G92 X1 Y-2 A4", "G92 X1\nG92 X7 Z3", "G52 X9 Y1", "G92 X1 Y2 Z3 B5\nG92.1", "G92 X1 Y2 C3\nG92.2"),
        *("G92 X1 Y2 A3\nG92.2\nG92.3", "G92 X1\nG92.2\nG55\nG92.3", "G10 L2 P1 X4 Z2", "G10 L20 P1 X4"),
    ],
)
def test_no_shift_moves_the_tool(words):
    """Whatever its place is called from then on: a step goes on from where it stands, and axes without a word stay."""
    stands, steps = np.array([5.0, 6.0, 7.0]), np.array([0.25, 0.0, -1.0])
    program = interpret(f"G21 G90\nG0 X5 Y6 Z7 A1 B2 C3\n{words}\nG91 G0 X0.25 Z-1\nA10\nM2\n")
    np.testing.assert_allclose(program.end[-2:] * 1e3, [stands + steps] * 2, atol=1e-9)
    np.testing.assert_allclose(np.degrees(program.rotary[-1]), [11.0, 2.0, 3.0], atol=1e-9)


def test_parameters_say_whether_a_shift_is_in_force_and_keep_what_is_put_aside():
    shift = "G21 G90\nG0 X5 Y6 Z7\nG92 X1 A4\n"  # X5 is called 1 and A0 is called 4
    for words, found in (
        ("G21\n", [0, 0, 0]),
        (shift, [1, 4, -4]),
        (f"{shift}G92.2\n", [0, 4, -4]),
        (f"{shift}G92.2\nG92.3\n", [1, 4, -4]),
        (f"{shift}G92.1\n", [0, 0, 0]),
        ("G21\nG52 X9\n", [1, 9, 0]),
    ):
        np.testing.assert_allclose(read(words, 5210, 5211, 5214), found, atol=1e-9)


TOOL = (5401, 5402, 5403)


def test_a_tool_is_measured_by_words_or_by_where_it_stands():
    """L1 says the offset; L10 says what is to be read here with that offset in force, L11 what in G59.3."""
    start = "G21 G90\nG10 L2 P1 X7 Y-3 Z1 R35\nG10 L2 P9 X-2 Y8 Z11 R-20\nG54\nT3 M6\nG0 X5 Y3 Z2\nG43.1 X1 Z4\n"
    np.testing.assert_allclose(read(f"{start}G10 L1 P3 X0.1 Y0.2 Z52.5\n", *TOOL), [0.1, 0.2, 52.5], atol=1e-9)
    np.testing.assert_allclose(read(f"{start}G10 L1 P3 Z52.5\nG10 L1 P3 X0.1 R6\n", *TOOL, 5410), [0.1, 0, 52.5, 12])
    np.testing.assert_allclose(read(f"{start}G10 L10 P3 Z12\nG43\n", 5422), [12], atol=1e-9)
    np.testing.assert_allclose(read(f"{start}G10 L11 P3 Z12\nG59.3\nG43\n", 5422), [12], atol=1e-9)
    plain = start.replace("R35", "").replace("R-20", "")
    np.testing.assert_allclose(read(f"{plain}G10 L10 P3 X1 Y2 Z12\nG43\n", *HERE), [1, 2, 12], atol=1e-9)
    np.testing.assert_allclose(read(f"{plain}G10 L11 P3 X1 Y2 Z12\nG59.3\nG43\n", *HERE), [1, 2, 12], atol=1e-9)


def test_l11_counts_without_the_shift_that_is_in_force():
    """What it says is read in G59.3 with the new length once that shift of G92 has ended."""
    start = "G21 G90\nG10 L2 P9 X-2 Y8 Z11\nG54\nT3 M6\nG0 X5 Y3 Z2\nG92 X40 Y-7 Z-30\n"
    for words, here in (("Z12", [7, -5, 12]), ("X1 Y2 Z12", [1, 2, 12])):
        found = read(f"{start}G10 L11 P3 {words}\nG92.1\nG59.3\nG43\n", *HERE)
        np.testing.assert_allclose(found, here, atol=1e-9)


def test_a_second_length_is_added_to_the_one_in_force():
    """The machine reads the tip lower by every length it counts with."""
    tools = {1: Tool(1, 0.0, (0.0, 0.0, 50e-3)), 2: Tool(2, 0.0, (3e-3, 0.0, 7e-3))}
    start = "G21 G90\nG0 X0 Y0 Z200\n"
    for words, here in (
        ("G43 H1", [0, 0, 150]),
        ("G43 H1\nG43.2 H2", [-3, 0, 143]),
        ("G43.1 Z5\nG43.1 X2", [-2, 0, 195]),
        ("G43 H1\nG49", [0, 0, 200]),
    ):
        np.testing.assert_allclose(read(f"{start}{words}\n", *HERE, tools=tools), here, atol=1e-9)


def test_any_number_of_tools_may_be_measured_without_a_table():
    start = "G21 G90\nG10 L1 P1 Z50\nG10 L1 P2 X3 Z7\nT2 M6\nG0 X0 Y0 Z200\n"
    np.testing.assert_allclose(read(f"{start}G43\n", *HERE), [-3, 0, 193], atol=1e-9)
    np.testing.assert_allclose(read(f"{start}G43 H1\nG43.2 H2\n", *HERE), [-3, 0, 143], atol=1e-9)
    np.testing.assert_allclose(read(f"{start}T9 M6\nG43\n", *HERE), [0, 0, 200], atol=1e-9)


@pytest.mark.parametrize("code", ["G41", "G42"])
def test_d_names_the_tool_whose_radius_keeps_off(code):
    """Of a line along x the centre keeps half the named tool's diameter off, on its side; D0: the one in use."""
    tools = {number: Tool(number, diameter) for number, diameter in ((1, 4e-3), (2, 10e-3), (7, -6e-3))}
    for word, y in (("", 2.0), ("D1", 2.0), ("D2", 5.0), ("D7", -3.0), ("D0", 2.0), ("D2.00009", 5.0)):
        program = interpret(f"G21 F100 T1 M6\nG0 X0 Y0\n{code} {word}\nG1 X20\nX40\nG40\nM2\n", tools=tools)
        side = 1.0 if code == "G41" else -1.0
        np.testing.assert_allclose(program.end[1:3, 1] * 1e3, y * side, atol=1e-9)
    for word in ("D2.001", "D1.5", "D-1", "D3"):
        with pytest.raises(GCodeError, match="Line 3: "):
            interpret(f"G21 F100 T1 M6\nG0 X0 Y0\n{code} {word}\nG1 X20\nM2\n", tools=tools)
    with pytest.raises(GCodeError, match="give a tool table"):
        interpret(f"G21 F100 T1 M6\nG0 X0 Y0\n{code}\nG1 X20\nM2\n")


@pytest.mark.parametrize("kind", [1, 10, 11])
def test_a_tool_that_the_table_does_not_have_is_not_set(kind):
    text = f"G21 G90\nG10 L{kind} P{{}} R4 Z2\nM2\n"
    with pytest.raises(GCodeError, match=r"^Line 2: tool 5 is not in the tool table; add it\.$"):
        interpret(text.format(5), tools={3: Tool(3)})
    for number in (0, -1):
        with pytest.raises(GCodeError, match=rf"^Line 2: G10 L{kind} has P{number}; tool numbers start at 1\.$"):
            interpret(text.format(number), tools={3: Tool(3)})
    interpret(text.format(3), tools={3: Tool(3)})
    interpret(text.format(5))  # without a table every tool may be set


@pytest.mark.parametrize("kind", [1, 10, 11])
def test_a_tool_of_which_nothing_is_said_is_not_set(kind):
    with pytest.raises(GCodeError, match=rf"^Line 2: G10 L{kind} sets nothing; give Z, R or another word\.$"):
        interpret(f"G21 G90\nG10 L{kind} P3\nM2\n")
    interpret(f"G21 G90\nG10 L{kind} P3 Q2\nM2\n")


@pytest.mark.parametrize("p", ["", "P1.001", "P0.9"])
def test_what_is_set_needs_a_whole_number(p):
    for kind in (1, 2, 10, 11, 20):
        with pytest.raises(GCodeError, match=r"^Line 2: G10 needs P, a whole number\.$"):
            interpret(f"G21 G90\nG10 L{kind} {p} X1\nM2\n")


@pytest.mark.parametrize(("p", "stands"), [(-1, False), (0, True), (9, True), (10, False)])
def test_there_are_nine_coordinate_systems_and_the_current_one(p, stands):
    for kind in (2, 20):
        text = f"G21 G90\nG10 L{kind} P{p} X1\nM2\n"
        if stands:
            interpret(text)
        else:
            with pytest.raises(GCodeError, match=rf"^Line 2: G10 L{kind} has P{p}; coordinate systems run from 1 to 9"):
                interpret(text)
    with pytest.raises(GCodeError, match=r"^Line 2: G10 L20 takes no R\.$"):
        interpret("G21 G90\nG10 L20 P1 X1 R10\nM2\n")


@pytest.mark.parametrize(
    ("body", "ends"),
    [
        (
            "G10 L20 P3 X10 Y20 Z0\nG0 G54.1 P3 X0 Y0\nX1\nG20\nX1\nG54 X0 Y0",
            [(10, 20), (11, 20), (35.4, 20), (0, 0)],
        ),
        ("G10 L2 P2 X7 Y0 Z0\nG55 G0 X0\nG154 P4 X1\nG113 X2", [(7, 0), (1, 0), (2, 0)]),
        ("G0 G54 P2 X3\nG54 X4\nG10 L20 P2 X50\nG54 P2 X1", [(3, 0), (4, 0), (51, 0)]),
    ],
)
def test_further_systems_of_fanuc_and_haas_are_placed_and_selected(body: str, ends: list[tuple[float, float]]) -> None:
    """G10 L20 says where G54.1 P lies on a Fanuc; LinuxCNC's L20 says what the tool's place shall be."""
    program = interpret(f"G21 G90\n{body}\nM30\n", dialect="fanuc")
    np.testing.assert_allclose(program.end[:, :2] * 1e3, ends, atol=1e-9)


def test_further_systems_that_nobody_has_placed_lie_over_one_another() -> None:
    program = interpret("G21 G90 G0 G54.1 P2 X0 Z5\nG1 Z-1 F9\nG54.1 P3 X0\nX5\nM30\n", dialect="fanuc")
    said = next(f.message for f in program.findings if f.code == "zeros-overlaid")
    assert "G54.1 P2, G54.1 P3 are nowhere placed" in said


@pytest.mark.parametrize(
    ("code", "says"),
    [
        ("G90 G10 L2 P0 X5", "G10 L2 P0 moves all coordinate systems"),
        ("G90 G10 L2 P7 X5", "G10 L2 has P7; expected P1 to P6"),
        ("G90 G10 L2 P1 X5 R30", "G10 L2 takes no R on a Fanuc"),
        ("G91\nG10 L2 P1 X5", "G10 L2 in G91 adds"),
        ("G54.1 X5", "G54.1 needs P"),
        ("G54.1 P0 X5", "P0 is no coordinate system"),
        ("G7", "G7 of a Fanuc control is not read"),
    ],
)
def test_words_that_mean_something_else_on_a_fanuc_are_refused(code: str, says: str) -> None:
    with pytest.raises(GCodeError, match=f"Line [23]: {says}"):
        interpret(f"G21\n{code}\nM30\n", dialect="fanuc")


def test_tools_that_a_fanuc_program_sets_are_left_out_with_a_word() -> None:
    program = interpret("G21 G90\nG10 L10 P1 R50.\nG10 L11 P1 R5.\nG0 Z5\nM30\n", dialect="fanuc")
    assert [f.line for f in program.findings if f.code == "tool-set"] == [2, 3]
    assert program.end[-1, 2] == pytest.approx(5e-3)


@pytest.mark.parametrize(("dialect", "z"), [("linuxcnc", 10.0), ("fanuc", 30.0)])
def test_a_tool_change_behind_a_shift_loses_the_height_on_linuxcnc_alone(dialect: str, z: float) -> None:
    """LinuxCNC goes on from the words of the last straight move, as if G52 had not been; others know where they are."""
    text = "G21 G90\nG0 Z30.\nG52 Z-20.\nT1 M6\nG0 X1.\nM30\n"
    assert interpret(text, dialect=dialect).end[-1, 2] * 1e3 == pytest.approx(z)


def test_g92_before_the_first_move_says_where_the_tool_stands() -> None:
    body = "G21 G90 F9\nG92 X0 Y0 Z50.\nG0 Z2.\nG1 Z-5.\nG92 X5.\nX6.\nM30\n"
    program = interpret(body, dialect="fanuc")
    assert (program.end * 1e3).round(9).tolist() == [[0, 0, 2], [0, 0, -5], [1, 0, -5]]
    assert program.start[0].tolist() == [0, 0, 0.05]
    assert "begins-at" in {f.code for f in program.findings}
    other = interpret(body)
    assert other.end[0, 2] * 1e3 == pytest.approx(-48), "as LinuxCNC, and a warning says so"
    assert [f.level for f in other.findings if f.code == "zero-shifted"] == ["warning"]
    assert "zero-shifted" not in {f.code for f in interpret(body, dialect="linuxcnc").findings}


def test_g92_before_the_first_move_says_how_the_part_is_turned() -> None:
    program = interpret("G21 G90 F9\nG92 X0 Y0 Z5. A90. B-30.\nG1 X1.\nA0\nM30\n", dialect="fanuc")
    assert np.degrees(program.rotary0[0]).tolist() == pytest.approx([90.0, -30.0, 0.0])
    assert np.degrees(program.rotary).ravel().tolist() == pytest.approx([90.0, -30.0, 0.0, 0.0, -30.0, 0.0])


def test_further_systems_of_a_sinumerik_are_called_as_there() -> None:
    program = interpret("G71 G90 F9\nG505\nG1 X1\nM30\n", dialect="sinumerik")
    (said,) = (f.message for f in program.findings if f.code == "zero-taken")
    assert said.startswith("part zero is taken to be that of G505")


@pytest.mark.parametrize(("first", "then"), [("G92 X0", "G52 X1."), ("G52 X1.", "G92 X0")])
def test_g52_and_g92_are_two_shifts_on_a_fanuc_control(first: str, then: str) -> None:
    """LinuxCNC keeps one of them alone; a control adds them, which is not read."""
    text = f"G21 G90\nG0 X10.\n{first}\nG0 X5.\n{then}\nG0 X2.\nM30\n"
    with pytest.raises(GCodeError, match=rf"Line 5: {then[:3]} on top of {first[:3]}, as a control adds them"):
        interpret(text, dialect="fanuc")
    interpret(text, dialect="linuxcnc")
    interpret(text.replace(first, "G52 X0"), dialect="fanuc")


@pytest.mark.parametrize("number", range(1, 10))
def test_every_work_offset_is_chosen_by_its_own_word(number: int) -> None:
    """G10 L2 P1 to P9 set what G54 to G59 and G59.1 to G59.3 choose: each shifts a place by its own."""
    words = ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"]
    sets = "".join(f"G10 L2 P{k} X{k * k}\n" for k in range(1, 10))
    program = interpret(f"G21 G90\n{sets}{words[number - 1]}\nG0 X7\nG54\nX7\nM2\n", dialect="linuxcnc")
    np.testing.assert_allclose(program.end[:, 0] * 1e3, [7 + number * number, 8], atol=1e-9)


def fanuc_ends(body, unit="G21"):
    """Where the moves of a program end in mm, on a Fanuc."""
    program = interpret(f"{unit} G90 G94 F100\nG0 X0 Y0 Z0\n{body}M30\n", dialect="fanuc")
    return np.round(program.end[1:] * 1e3, 6).tolist()


def test_a_fanuc_system_moves_as_its_variable_is_set():
    """The machine stands still, so that a word that is not there keeps its place; one that is counts from the new."""
    body = "#5221=10.\nG1 Y5.\nX5.\nIF[#5221EQ10]THEN #5222=#5222+1.\nX5. Y5.\n#5241=100.\nG55 X5.\nG54 X#5241\n"
    assert fanuc_ends(body) == [[0, 5, 0], [15, 5, 0], [15, 6, 0], [105, 6, 0], [110, 6, 0]]
    # a hundred lines more: the rules of long programs leave such a line to the reader
    assert fanuc_ends("X1.\n" * 100 + "#5223=3.\nX2. Z0\n")[-1] == [2, 0, 3]
    assert interpret("G21 G90 F100\nG0 X0\n#5221=10.\nG1 X5\nM2\n", dialect="linuxcnc").end[-1, 0] == 0.005


def test_fanuc_variables_of_places_count_in_the_units_of_the_program():
    body = "G10 L2 P1 X1. Y0 Z0\n#1=#5221\nG0 X#1\nG21\n#2=#5221\nX#2\n#5221=50.8\nG20\nX#5221\n"
    assert fanuc_ends(body, "G20") == [[50.8, 0, 0], [50.8, 0, 0], [101.6, 0, 0]]
    found = interpret(f"G20 G90 F10\n{body}G1 Z0\nM30\n", dialect="fanuc").findings
    assert next(f.message for f in found if f.code == "zero-placed").startswith("the program itself places G54 at X50")


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("G68 X0 Y0 R90.\nG10 L2 P1 X10.\n", "Line 4: G10 L2 moves G54 while coordinates are shifted or turned"),
        ("G68 X0 Y0 R90.\n#5221=10.\n", "Line 4: #5221 moves G54 while coordinates are shifted or turned"),
        ("#5201=10.\n", "Line 3: #5201 moves all coordinate systems"),
        ("G10 L12 P1 R4.\nG41 D1 G1 X10.\nX20.\nG10 L2 P1 X5.\n", "Line 6: G10 L2 cannot be used with cutter comp"),
    ],
)
def test_what_moves_a_fanuc_system_beneath_something_is_refused(body, says):
    with pytest.raises(GCodeError, match=says):
        fanuc_ends(body)


@pytest.mark.parametrize("dialect", ["grbl", "auto"])
@pytest.mark.parametrize("zero", ["G92 Z10", "G10 L20 P1 Z10", "G10 L20 P0 Z10"])
def test_behind_a_probe_the_tool_stands_where_the_program_says(dialect, zero):
    """A plate of 10 mm lies on the part: where it is touched is Z10, however far the probe was sent, and once more
    after a change of the tool."""
    touch = f"G38.2 Z-40 F50\nG0 Z-35\nG38.2 Z-60 F9\n{zero}\nG0 Z15\n"
    found = interpret(f"G21 G90\n{touch}G0 X3\nG1 Z-1 F100\nX9\nM0\n{touch}G1 Z-2\nX3\nM2\n", dialect=dialect)
    cuts = found.end[found.kind == 1] * 1e3
    np.testing.assert_allclose(cuts, [[3, 0, -1], [9, 0, -1], [9, 0, -2], [3, 0, -2]], atol=1e-9)
    assert [f.count for f in found.findings if f.code == "probed-zero"] == [2]
    # what LinuxCNC itself shows: the place the probe was sent to, counted from there
    plain = interpret(f"G21 G90\n{touch}G1 Z-1 F100\nM2\n", dialect="linuxcnc")
    assert plain.end[-1, 2] == pytest.approx(-0.071)


def test_g92_behind_g28_says_where_the_home_lies_from_part_zero():
    """Programs without G54, as Fanuc's manual has them: part zero stays where it is, whatever tool is set again."""
    home = "G91 G28 Z0\nG28 X0 Y0\nG90 G92 X300. Y200. Z{}.\nG0 X10. Y10.\nZ5.\nG1 Z-1.\nX20.\n"
    found = interpret(f"O1\nG21 F100\n{home.format(400)}{home.format(350)}M30\n", dialect="fanuc")
    cuts = found.end[found.kind == 1] * 1e3
    np.testing.assert_allclose(cuts, [[10, 10, -1], [20, 10, -1]] * 2, atol=1e-9)
    assert not found.away[found.kind == 1].any()
    assert [(f.line, f.count) for f in found.findings if f.code == "begins-at"] == [(5, 2)]
    grbl = interpret("G21 G90 F9\nG28 Z0\nG10 L20 P1 X0 Y0 Z400\nG0 X1 Y1\nG1 Z-1\nM2\n", dialect="grbl")
    np.testing.assert_allclose(grbl.end[-1] * 1e3, [1, 1, -1], atol=1e-9)
    # Z alone comes from there: X and Y are known, and are shifted
    found = interpret("O1\nG21 G90 F9\nG0 X5. Y0 Z9.\nG28 Z9.\nG92 X0 Z400.\nG1 X1. Z-1.\nM30\n", dialect="fanuc")
    np.testing.assert_allclose(found.end[-1] * 1e3, [6, 0, -1], atol=1e-9)


def test_a_fanuc_variable_of_a_tool_is_left_out_as_g10_is():
    said = {}
    for line in ("#2001=5.", "G10 L10 P1 R5."):
        found = interpret(f"O1\nG21 G90\n{line}\nG43 H1 G0 Z9.\nG1 Z1. F9\nM30\n", dialect="fanuc")
        assert found.end[-1, 2] == pytest.approx(1e-3)
        said[line] = [f.message.split(" ", 1 + (line[0] == "G"))[-1] for f in found.findings if f.code == "tool-set"]
    assert said["#2001=5."] == said["G10 L10 P1 R5."]
    assert said["#2001=5."] == ["sets a tool of the control, which is left out: the tool table holds"]


@pytest.mark.parametrize("kind", ["L2", "L20"])
@pytest.mark.parametrize(("system", "read"), [(0, False), (1, False), (2, True), (9, True)])
def test_under_compensation_other_systems_alone_are_placed(kind: str, system: int, read: bool) -> None:
    """G54 is in force, by its number or as P0: the cutter's contour would break where that moved."""
    text = "G21 G90 G17 G54 F100\nG0 X0 Y0\nG41.1 D2\nG1 X10\nX20\n{}X30\nG40\nG1 X40 Y9\nM2\n"
    if read:
        plain, found = (interpret(text.format(word)).end for word in ("", f"G10 {kind} P{system} X5\n"))
        np.testing.assert_array_equal(found, plain)
        return
    with pytest.raises(GCodeError, match=f"^Line 6: G10 {kind} cannot move the current coordinate system"):
        interpret(text.format(f"G10 {kind} P{system} X5\n"))


@pytest.mark.parametrize("shift", ["G52 X10.", "G92 X10. Y0"])
def test_what_a_control_forbids_within_a_rotation_is_refused(shift: str) -> None:
    """Fanuc: G52 to G59 and G92 must not be specified in coordinate system rotation; along Z alone nothing turns."""
    head = "O0001\nG21 G90 G54\nG0 X1. Y0 Z10.\nG68 X0 Y0 R90.\n"
    with pytest.raises(GCodeError, match=r"^Line 5: G\d\d while coordinates are turned \(G68\) is not read"):
        interpret(f"{head}{shift}\nG0 X0 Y0\nM30\n", dialect="fanuc")
    program = interpret(f"{head}G52 Z5.\nG0 X2. Y0 Z1.\nM30\n", dialect="fanuc")
    np.testing.assert_allclose(program.end[-1] * 1e3, [0, 2, 6], atol=1e-9)


@pytest.mark.parametrize("scale", ["G51 X0 Y0 P2.", "G51.1 X0"])
def test_another_system_within_a_scale_or_mirror_is_refused(scale: str) -> None:
    """Fanuc: G52 to G59 must not be specified in scaling, nor in a mirror image; G54 within G54 is no other."""
    text = f"O0001\nG21 G90 G54\nG10 L2 P2 X100. Y0 Z0\nG0 X1. Y0 Z10.\n{scale}\n{{}}\nG0 X1. Y0\nM30\n"
    with pytest.raises(GCodeError, match=r"^Line 6: G55 while coordinates are scaled or mirrored"):
        interpret(text.format("G55"), dialect="fanuc")
    assert len(interpret(text.format("G54"), dialect="fanuc")) == 2
