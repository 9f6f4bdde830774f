"""Programs of other controls: what they are told by, and what their words mean."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Tool, interpret
from robomill.toolpath.gcode.dialects import LONGEST, NAMES, choose_dialect
from robomill.toolpath.gcode.words import Block

TOLD = [
    ("G21\nG0 X1\n", "linuxcnc"),
    ("#<depth>=2\nG65 P1\n", "linuxcnc"),
    ("o100 sub\nG65\n", "linuxcnc"),
    ('MSG("hello")\n', "sinumerik"),
    ("; $PATH=/_N_WKS_DIR\n", "sinumerik"),
    ("G0 X=5\n", "sinumerik"),
    ("R1=AC(3)\nG2 X1 CR=5\n", "sinumerik"),
    ("DEF REAL DEPTH\n", "sinumerik"),
    ("G710\n", "sinumerik"),
    ("G642\n", "sinumerik"),
    ("G71\nG0 X1\n", "sinumerik"),
    ("G71 P10 Q20 D1\n", "linuxcnc"),
    ("G71\nG0 G43 Z1 H1\n", "linuxcnc"),
    ("M17\n", "sinumerik"),
    ("M17\n(turn servos on)\nG0 X1\nM2\n", "linuxcnc"),
    ("$H\n", "grbl"),
    ("$J=G91 X1\n", "grbl"),
    ("$110=500\n", "grbl"),
    ("G65 P9010\n", "fanuc"),
    ("G54.1 P2\n", "fanuc"),
    (":1234\nG0 X1\n", "fanuc"),
    ("O1234\nG0 X1\n", "fanuc"),
    ("O123\nG0 X1\n", "linuxcnc"),
    ("M98 P100\n", "fanuc"),
    ("IF [#1 EQ 2] GOTO 5\n", "fanuc"),
    ("#1=2\nIF[#1EQ2]GOTO900\nN900\n", "fanuc"),
    ("#1=2\nWHILE[#1GT2]DO1\nEND1\n", "fanuc"),
    ("#1=2\no1 while [#1 GT 2] (do it)\no1 endwhile\n", "linuxcnc"),
    ("G68.2 I0 J0 K0\n", "fanuc"),
    ("G28 U0 W0\n", "fanuc"),
    ("(G65 $H and M17)\n; G710\nG0 X1\n", "linuxcnc"),
    ("G0 X1" + " " * LONGEST + "G65\n", "linuxcnc"),
]


@pytest.mark.parametrize(("text", "name"), TOLD)
def test_a_program_is_told_by_its_words(text: str, name: str) -> None:
    found = choose_dialect(text, "auto")
    assert (found.name, found.guessed) == (name, True)
    for wanted in NAMES:
        assert (choose_dialect(text, wanted).name, choose_dialect(text, wanted).guessed) == (wanted, False)


def test_a_dialect_that_is_none_is_refused() -> None:
    with pytest.raises(GCodeError, match="'fidia' is not known; expected auto, linuxcnc"):
        choose_dialect("", "fidia")


MEANS = [
    ("fanuc", "G4 X2.5", "G4 P2.5"),
    ("fanuc", "G04 U1.", "G04 P1."),
    ("fanuc", "G4 P2500", "G4 P2.500"),
    ("fanuc", "G4 P1.5", "G4 P1.5"),
    ("fanuc", "G4 X.5", "G4 P.5"),
    ("fanuc", "G5.1 Q1 R3\nG0 X5", "\nG0 X5"),
    ("sinumerik", "G71 G0 X=5 Y=-2.5", "G21 G0 X5 Y-2.5"),
    ("sinumerik", "G700 G0 X1", "G20 G0 X1"),
    ("sinumerik", "G0 X=AC(4) Y2", "G0 X4 Y2"),
    ("sinumerik", "G1 F60\nG2 X10 CR=5", "G1 F60\nG2 X10 R5"),
    ("sinumerik", "G0 X10\nG1 F60\nG2 I-10 J0 X10 TURN=2", "G0 X10\nG1 F60\nG2 I-10 J0 X10 P3"),
    ("sinumerik", "G500 G0 X3 D1", "G54 G0 X3"),
    ("sinumerik", 'T="MILL_8" G0 X3', "G0 X3"),
    ("sinumerik", "G0 X3 ; X9", "G0 X3"),
    ("sinumerik", "TRAORI\nFFWON\nCYCLE832(0.01,1)\nCYCLE800()\nG0 X3", "\n\n\n\nG0 X3"),
    ("sinumerik", "G4 F2\nG0 X1", "G4 P2\nG0 X1"),
]


@pytest.mark.parametrize(("dialect", "lines", "plain"), MEANS)
def test_words_mean_what_they_are_in_plain_words(dialect: str, lines: str, plain: str) -> None:
    found, expected = (
        interpret(f"G21 G90\n{text}\nG0 Z1\nM2\n", dialect=name)
        for text, name in ((lines, dialect), (plain, "linuxcnc"))
    )
    for name in ("kind", "end", "sweep", "dwell"):
        np.testing.assert_allclose(getattr(found, name), getattr(expected, name), atol=1e-12)
    assert found.dwell_time == pytest.approx(expected.dwell_time)


def test_what_is_left_out_is_counted() -> None:
    found = interpret("G21\nG187 P1\nG15\nM77\nG0 X1\nM2\n", dialect="fanuc")
    left_out = {(each.code, each.line) for each in found.findings}
    assert left_out >= {("harmless-g", 2), ("harmless-g", 3), ("unknown-m", 4)}
    for dialect, why in (("linuxcnc", "; it may move the machine"), ("grbl", " to grbl 1.1")):
        with pytest.raises(GCodeError, match=f"Line 2: G187 is not known{why}"):
            interpret("G21\nG187\nM2\n", dialect=dialect)


@pytest.mark.parametrize("letter", ["Q", "P"])
def test_words_without_use_are_refused_by_linuxcnc_and_counted_elsewhere(letter: str) -> None:
    with pytest.raises(GCodeError, match=f"{letter} has no use here"):
        interpret(f"G21\nG0 X1 {letter}3\nM2\n", dialect="linuxcnc")
    findings = interpret(f"G21\nG0 X1 {letter}3\nM2\n", dialect="fanuc").findings
    assert [(f.line, f.level) for f in findings if f.code == "unused-word"] == [(2, "ignored")]
    with pytest.raises(GCodeError, match="I has no use here"):
        interpret("G21\nG0 X1 I2\nM2\n", dialect="fanuc")


@pytest.mark.parametrize(
    ("call", "dialect", "repeats"),
    [
        ("M98 P1234", "fanuc", 1),
        ("M98 P31234", "fanuc", 3),
        ("M98 P1234 L4", "fanuc", 4),
        ("M98 P1234 L1", "linuxcnc", 1),
    ],
)
def test_subprograms_are_called_as_often_as_it_is_said(call: str, dialect: str, repeats: int) -> None:
    text = f"G21 G91\n{call}\nM2\nO1234\nG0 X1\nM99\n"
    assert interpret(text, dialect=dialect).end[-1, 0] * 1e3 == pytest.approx(repeats)


def test_a_million_repeats_may_be_asked_for() -> None:
    called = Block(3, words={"p": 7.0, "l": 1_000_000.0})
    assert choose_dialect("", "fanuc").subprogram(called) == (7, 1_000_000)


def test_subprograms_that_cannot_be_are_refused() -> None:
    for call, says in (("P1.5", "M98 has P1.5"), ("P-2", "M98 has P-2"), ("P7 L1000001", "at most 1000000")):
        with pytest.raises(GCodeError, match=says):
            interpret(f"G21\nM98 {call}\nM2\nO7\nG0 X1\nM99\n", dialect="fanuc")


@pytest.mark.parametrize("dialect", NAMES)
@pytest.mark.parametrize(
    ("word", "x"),
    [("X-1.776e-15", 0.0), ("X1.5E1", 15.0), ("X-2e+1", -20.0), ("G0X.5e-1", 0.05), ("(X9e9) X3", 3.0)],
)
def test_exponents_are_read_in_every_dialect(dialect: str, word: str, x: float) -> None:
    """As a language prints a float; most controls stop there, none takes -1.776 for it."""
    text = f"G21 G90 G0 X1\n{word}\nM2\n"
    if dialect == "heidenhain":
        plain = word.removeprefix("(X9e9) ").removeprefix("G0")
        text = f"L X1 FMAX\nL {plain} FMAX {';X9e9' if '(' in word else ''}\nM2\n"
    found = interpret(text, dialect=dialect)
    assert found.end[-1, 0] * 1e3 == pytest.approx(x, abs=1e-12)
    assert [f.line for f in found.findings if f.code == "exponent"] == ([2] if "(" not in word else [])


def test_e_keeps_its_meaning_where_it_has_one() -> None:
    assert not [f for f in interpret("G21 G0 X1\nM68 E0 Q1\nM2\n").findings if f.code == "exponent"]
    assert interpret("G71\nG0 X=1.5EX2\nM2\n", dialect="sinumerik").end[-1, 0] == pytest.approx(0.15)


@pytest.mark.parametrize(
    ("tool", "dialect", "named"),
    [
        ('T="MILL_10" D1\nM6', "sinumerik", 'tool "MILL_10"'),
        ("T3 D1\nM6", "sinumerik", "tool 3"),
        ("D1", "sinumerik", "the tool in the spindle"),
        ("", "linuxcnc", "the tool in the spindle"),
        ("T3 M6", "fanuc", "tool 3"),
    ],
)
def test_compensation_without_a_table_asks_for_one(tool: str, dialect: str, named: str) -> None:
    with pytest.raises(GCodeError, match=f"G41 needs the diameter of {named}; give a tool table"):
        interpret(f"G21 G90 F100\n{tool}\nG41 G1 X10 Y0\nX20\nM30\n", dialect=dialect)


def test_a_tool_that_is_called_by_name_is_the_one_of_that_name() -> None:
    """Straight along X with the tool to the left, G41: off to +Y by its radius."""
    text = 'G71 G90 F100\nT="Mill_10" D1\nM6\nG41 G1 X10 Y0\nX20\nM30\n'
    tools = {4: Tool(4, 6e-3), 7: Tool(7, 10e-3, name="MILL_10")}
    program = interpret(text, dialect="sinumerik", tools=tools)
    assert program.end[-1] * 1e3 == pytest.approx([20, 5, 0])
    assert program.tool[-1] == 7
    with pytest.raises(GCodeError, match='Line 4: tool "Mill_10" is not in the tool table; add it under that name'):
        interpret(text, dialect="sinumerik", tools={4: Tool(4, 6e-3)})


def test_a_zero_that_the_program_places_is_said() -> None:
    program = interpret("G21 G90\nG10 L2 P1 X50 Y-20\nG0 X0 Y0\nG1 X10 F100\nM2\n")
    assert program.end[-1] * 1e3 == pytest.approx([60, -20, 0])
    assert [
        (f.line, "places G54 at X50 Y-20 Z0" in f.message) for f in program.findings if f.code == "zero-placed"
    ] == [(2, True)]
    still = interpret("G21 G90\nG10 L2 P1 X0 Y0 Z0\nG10 L2 P2 X5\nG0 X0 Y0\nG1 X10 F100\nM2\n")
    assert not [f for f in still.findings if f.code == "zero-placed"]


def test_systems_that_nobody_has_placed_lie_over_one_another_and_that_is_said() -> None:
    text = "G21 G90 F100\nG54 G1 X1\nG55 G1 X2\nM2\n"
    said = [f.message for f in interpret(text).findings if f.code == "zeros-overlaid"]
    assert len(said) == 1
    assert "2 coordinate systems, and G54, G55 are nowhere placed" in said[0]
    for alone in ("G55 G1 X2", "G54 G1 X1\nG55 G0 X2", "G10 L2 P1 X9\nG10 L2 P2 X99\nG54 G1 X1\nG55 G1 X2"):
        assert not [f for f in interpret(f"G21 G90 F100\n{alone}\nM2\n").findings if f.code == "zeros-overlaid"], alone


ONLY_SINUMERIK = [
    'WORKPIECE(,"",,"BOX",112,0,-50,-80,-60,60,60,-60)',
    "N5 MCALL CYCLE81(10,0,2,-5)",
    "CYCLE83(10,0,2,-5)",
    'T="MILL 10"',
    "TRANS X5",
    "N10 ATRANS Y5 Z1",
    "TRAORI",
    "SUPA G0 Z0",
    "%_N_PART_MPF",
    "R12=5",
    "G1 X5 RND=2",
    "A3=0 B3=0 C3=1",
]


@pytest.mark.parametrize("line", ONLY_SINUMERIK)
def test_words_that_only_a_sinumerik_has_tell_it(line: str) -> None:
    assert choose_dialect(f"G90 G54\n{line}\nG1 X5 F100\n", "auto").name == "sinumerik"


@pytest.mark.parametrize("dialect", ["auto", "fanuc"])
@pytest.mark.parametrize("word", ["X", "U", "P"])
def test_seconds_of_a_dwell_stand_behind_x_u_or_p(dialect: str, word: str) -> None:
    program = interpret(f"G21 G90\nG1 X1. F9\nG4 {word}1.5\nX2.\nM30\n", dialect=dialect)
    assert program.dwell_time == pytest.approx(1.5)
    assert (program.end[:, 0] * 1e3).tolist() == [1, 2]


@pytest.mark.parametrize("start", ["G112", "N10 G112 (polar)", "G94 G112"])
def test_polar_interpolation_is_not_read_as_the_place_of_a_part(start: str) -> None:
    """G112 to G113, with C as a length (Fanuc); a place of the part (Haas's G154 P3) stands beside its first move."""
    with pytest.raises(GCodeError, match=r"Line 2: G112 alone on its line begins polar interpolation"):
        interpret(f"G21 F9\n{start}\nG1 X5. C3.\nG113\nM30\n", dialect="fanuc")
    beside = interpret("G10 L20 P3 X7. Y0 Z0\nG21 G0 G90 G112 X1. Y2.\nM30\n", dialect="fanuc")
    assert (beside.end * 1e3).tolist() == [[8, 2, 0]]


@pytest.mark.parametrize("code", ["G110", "G111", "G112"])
def test_poles_of_a_sinumerik_are_named(code: str) -> None:
    with pytest.raises(GCodeError, match=f"Line 2: {code} sets a pole, which is read for Sinumerik controls alone"):
        interpret(f"G21 F9\n{code} X1 Y1\nM30\n", dialect="linuxcnc")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("G0 G0 X1", "G0 and G0 are of one modal group"),
        ("M7 M8", "M7 and M8 are of one modal group"),
        ("M3 M3", "M3 and M3 are of one modal group"),
    ],
)
def test_words_said_twice_stop_linuxcnc_alone(text: str, says: str) -> None:
    assert interpret(f"G21 G0 X0\n{text}\nG0 X2\n").end[-1, 0] * 1e3 == pytest.approx(2)
    with pytest.raises(GCodeError, match=f"Line 2: {says}"):
        interpret(f"G21 G0 X0\n{text}\nG0 X2\n", dialect="linuxcnc")


def test_a_point_alone_is_nought_on_a_fanuc() -> None:
    program = interpret("G21 G90 G0 X5. Y-.5\nG43 Z. H3 (Z.)\nX-. Y.5\nM30\n", dialect="fanuc")
    assert (program.end[-1] * 1e3).tolist() == [0.0, 0.5, 0.0]
    with pytest.raises(GCodeError, match="'.' is not a number"):
        interpret("G21 G0 Z.\n", dialect="linuxcnc")


def test_haas_engraving_is_named() -> None:
    with pytest.raises(GCodeError, match="Line 2: G47 engraves text"):
        interpret("G20 G0 X0\nG47 E7.5 F15. I45. J.5 P0 R0.05 Z-0.005 (TEXT)\n")


def test_units_beside_other_words_count_for_the_line_on_a_fanuc_and_that_is_said() -> None:
    """25.4 mm is 1 in; F10 is 10 in/min, 254 mm/min. On a line of its own G20 says nothing more."""
    program = interpret("G21 G90 G0 X0\nG20 G1 X1. F10.\nM30\n", dialect="fanuc")
    np.testing.assert_allclose([program.end[-1, 0] * 1e3, program.v_f[-1] * 6e4], [25.4, 254])
    said = {f.code: f.line for f in program.findings}
    assert said["units-beside"] == 2
    assert "feed-units" not in said
    for apart in ("G21 G90 G0 X0\nG20\nG1 X1. F10.\nM30\n", "G21 G90\nG0 G21 X1.\nM30\n"):
        assert "units-beside" not in {f.code for f in interpret(apart, dialect="fanuc").findings}


def test_e_is_no_word_of_a_sinumerik() -> None:
    """X=1e99 is no number there, and its X=1 is not what it means."""
    with pytest.raises(GCodeError, match="Line 2: E is no word of a Sinumerik; it writes 1000 as 1EX3"):
        interpret("G71 F9\nG1 X=1e99\nM30\n", dialect="sinumerik")
    with pytest.raises(GCodeError, match="Line 2: TURN=999999999 is more than a Sinumerik takes; expected 0 to 999"):
        interpret("G71 F9\nG2 I5 TURN=999999999\nM30\n", dialect="sinumerik")
    assert interpret("G71 F9\nG2 I5 TURN=999\nM30\n", dialect="sinumerik").turns[-1] == 1000


def test_a_feed_beside_g20_counts_in_inches_on_grbl() -> None:
    """grbl 1.1, gcode.c: the units of a block hold for all of it."""
    program = interpret("G21 G90\nG20 G1 X1 F10\nX2 F20\nG21 X3 F30\nM2\n", dialect="grbl")
    np.testing.assert_allclose(program.v_f * 6e4, [254, 508, 30])
    assert "feed-units" not in {f.code for f in program.findings}


@pytest.mark.parametrize(("word", "units", "size"), [("G71", "mm", 5.0), ("G70", "in", 127.0)])
def test_mach3_says_its_units_as_others_rough_on_a_lathe(word: str, units: str, size: float) -> None:
    """Vectric's Mach2/3 posts write G71 or G70 with G91.1; beside P and Q both rough, which is refused."""
    for gap in ("", " "):
        program = interpret(f"N10G0X0Y0\nN20{gap}{word}{gap}G91.1\nN30 G1 X5 F100\nM30\n")
        assert (program.units, program.dialect) == (units, "linuxcnc")
        assert program.end[-1, 0] * 1e3 == pytest.approx(size)
    with pytest.raises(GCodeError, match=f"Line 2: {word} makes holes on an? .* or is a lathe's cycle"):
        interpret(f"G0 X0\n{word} P10 Q20 U1 W1\nG1 X3 F9\n")


@pytest.mark.parametrize("head", ["%\nO1\n", "%\nO0001 (PART)\n"])
def test_axis_words_beside_g80_move_as_the_motion_before_the_cycle_does(head: str) -> None:
    """Smid, CNC Programming Handbook: G80 Z25.0 ends the cycle and moves; LinuxCNC refuses it."""
    body = "G21 G17 G90 G54\nS1000 M3\nG0 X0. Y0. Z25.\nG99 G81 X10. Z-5. R2. F100.\nG80 Z25.\nM30\n"
    program = interpret(f"{head}{body}%\n")
    assert program.dialect == "fanuc"
    assert (program.kind[-1], program.end[-1, 2] * 1e3) == (0, 25.0)
    with pytest.raises(GCodeError, match="G80 ends a cycle and takes no axis words"):
        interpret(body, dialect="linuxcnc")


def test_programs_of_nx_number_their_tool_changes_by_a_colon_and_count_feeds_in_inches() -> None:
    """Its three-axis post of the box writes G70 in the head, G43 and :0030; 10 in/min are 254 mm/min."""
    body = (
        "N0010 G40 G17 G90 G70\n:0030 T01 M06\nN0040 G0 X1. Y0. S100 M3\nN0050 G43 Z.5 H01\n:0060 G1 Z-.1 F10.\nX2.\n"
    )
    program = interpret(f"%\n{body}N0090 M02\n%\n")
    np.testing.assert_allclose(program.end[-1] * 1e3, [50.8, 0, -2.54])
    assert program.v_f[-1] * 6e4 == pytest.approx(254)
    blocks = interpret("G71 G90\n:10 G0 X0 Y0 Z0\n:20 G1 X=2*3 F100\nM30\n", dialect="sinumerik")
    np.testing.assert_allclose(blocks.end[-1] * 1e3, [6, 0, 0])


def test_an_arc_with_radius_and_centre_is_that_of_its_radius_on_a_fanuc() -> None:
    """Fanuc's manual: if I, J, K and R are specified simultaneously, the arc specified by R takes precedence."""
    body = "G21 G90 G0 X0 Y0 Z0\nG2 X10 Y10 {} F100\nM30\n"
    both = interpret(body.format("I3 J9 R10"), dialect="fanuc")
    np.testing.assert_allclose(both.centre[-1, :2] * 1e3, [10, 0], atol=1e-9)
    assert [f.line for f in both.findings if f.code == "radius-counts"] == [2]
    with pytest.raises(GCodeError, match="Line 2: G2 has both a centre"):
        interpret(body.format("I3 J9 R10"), dialect="linuxcnc")


def test_what_macros_print_moves_nothing() -> None:
    program = interpret("%\nO1234\nG21 G90 G0 X0 Y0 Z0\n#1=2.\nPOPEN\nDPRNT[X#1[53]*Y]\nPCLOS\nG1 X#1 F9\nM30\n%\n")
    assert program.end[-1, 0] == pytest.approx(2e-3)
    assert sum(f.count for f in program.findings if f.code == "harmless-g") == 3


def test_a_spline_with_a_leading_zero_is_not_fanucs_smoothing() -> None:
    text = "G21 G90 F99\nG0 X0 Y0\n{} I3 J3 P0 Q-3 X9 Y0\nM2\n"
    spline = interpret(text.format("G05"))
    assert spline.dialect == "linuxcnc"
    assert np.array_equal(spline.end, interpret(text.format("G5")).end)
    assert interpret("G21 G90\nG05 P10000\nG0 X1.\nM30\n").dialect == "fanuc"


def test_the_limits_of_the_machine_are_no_move() -> None:
    """G22 X Y Z I J K: where the tool must not go, or must stay within."""
    program = interpret(
        "G21 G90 S1 M3\nG0 X5.\nG22 X100. Y100. Z100. I0 J0 K0\nG22 X9. Y9. Z9.\nG23\n", dialect="fanuc"
    )
    assert (program.end * 1e3).tolist() == [[5.0, 0.0, 0.0]]


COMMENTS = "G21 G90\n(DRILL (HSS) )\nG0 X5\n(Tool: 3 (6mm)\nG1 X9 F100 (a (b)) Y2 (c)\n; (d (e\nM2\n"


@pytest.mark.parametrize("dialect", ["auto", "fanuc", "grbl"])
def test_comments_within_comments_are_one_where_they_pair_and_end_at_the_first_else(dialect: str) -> None:
    with pytest.raises(GCodeError, match="Line 2: a comment holds another"):
        interpret(COMMENTS, dialect="linuxcnc")
    program = interpret(COMMENTS, dialect=dialect)
    assert (program.end * 1e3).tolist() == [pytest.approx([5, 0, 0]), pytest.approx([9, 2, 0])]


@pytest.mark.parametrize("line", ["M3 P100", "M4 P50", "P12.5 M3"])
def test_a_power_beside_the_spindle_is_left_out(line: str) -> None:
    """Snapmaker's posts write it; where LinuxCNC is stated it is refused, as LinuxCNC does."""
    text = f"G21 G90\n{line}\nG0 X5\nG1 X9 F100\nM5\nM2\n"
    assert [f.code for f in interpret(text).findings if f.line == 2] == ["unused-word"]
    with pytest.raises(GCodeError, match="P has no use here"):
        interpret(text, dialect="linuxcnc")


@pytest.mark.parametrize(("word", "code"), [("G7", "diameters"), ("G101 X0", "mirror")])
def test_what_halves_or_mirrors_x_is_said(word: str, code: str) -> None:
    found = interpret(f"G21 G90\n{word}\nG0 X50\nG1 X60 F100\nM30\n").findings
    assert [(f.code, f.line) for f in found if f.line] == [(code, 2)]


def test_a_preset_of_the_workpiece_moves_nothing() -> None:
    text = "O0001\nG21 G90\nG0 X50. Y50. Z20.\nG92.1 X0 Y0 Z0\nG1 X60. F100.\nM30\n"
    assert (interpret(text, dialect="fanuc").end * 1e3).tolist() == [
        pytest.approx([50, 50, 20]),
        pytest.approx([60, 50, 20]),
    ]
