"""What other controls allow that LinuxCNC refuses: read as they read it and said, refused where LinuxCNC is stated."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret, read_gcode

DRILL = "G21 G90\n{}G0 X1 Y0 Z20\n{}G98 G81 X10 Z-5 R2 F100\nX20\nG80\nZ15.\nM30\n"


def ends(text: str, dialect: str = "auto") -> list[tuple[int, str, float, float, float]]:
    program = interpret(text, dialect=dialect)
    return [
        (int(n), "RFA"[k], *(round(float(v) * 1e3, 6) for v in p))
        for n, k, p in zip(program.line, program.kind, program.end)
    ]


@pytest.mark.parametrize("dialect", ["auto", "fanuc"])
@pytest.mark.parametrize(("between", "kind"), [("", "R"), ("G1 X2 F50\n", "F")])
def test_g80_leaves_the_motion_before_the_cycle_in_force(dialect: str, between: str, kind: str) -> None:
    """Fanuc and Haas: G73 to G89 and G80 are group 09; the last of group 01 (G0 to G3) stays beside them."""
    program = DRILL.format("", between)
    assert ends(program, dialect)[-1][1:] == (kind, 20, 0, 15)
    line = 6 + bool(between)
    said = [(f.line, f.level) for f in interpret(program, dialect=dialect).findings if f.code == "motion-kept"]
    assert said == [(line, "info")]


def test_a_long_program_keeps_it_in_compiled_code_too() -> None:
    """Twenty thousand lines are executed by the compiled rules; the last of G0 to G3 was among them."""
    text = DRILL.format("G1 X1 F9\n" * 20_000, "")
    assert ends(text)[-1][1:] == ("R", 20, 0, 15)


@pytest.mark.parametrize("dialect", ["auto", "fanuc", "grbl", "sinumerik"])
def test_a_program_begins_with_g0_in_force(dialect: str) -> None:
    assert ends("G21 G90\nX5 Z20.\nM30\n", dialect) == [(2, "R", 5, 0, 20)]


def test_a_sinumerik_begins_with_g1_in_force_once_it_has_a_feed() -> None:
    assert ends("G71 G90\nX5 F9\nM30\n", "sinumerik") == [(2, "F", 5, 0, 0)]
    assert ends("G71 G90 F9\nX5\nG0 X6\nM30\n", "sinumerik") == [(2, "F", 5, 0, 0), (3, "R", 6, 0, 0)]


STRICT = [
    ("G21\nG0 X1\nG80\nZ15.\nM30\n", "Line 4: axis words without a motion"),
    ("G21\nZ15.\nM30\n", "Line 2: axis words without a motion"),
    ("G21\nG0 G91 G28 Z0\nM30\n", "Line 2: G28 and G0 both want the axis words"),
    ("G21\nG187 P1\nM30\n", "Line 2: G187 is not known"),
    ("G21\nG69\nM30\n", "Line 2: G69 is not known"),
    ("G21\nG0 X1 I0 J0 K1\nM30\n", "Line 2: I has no use here"),
]


@pytest.mark.parametrize(("text", "says"), STRICT)
def test_stated_as_linuxcnc_s_it_is_refused_as_there(text: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        interpret(text, dialect="linuxcnc")
    interpret(text)


@pytest.mark.parametrize("words", ["G0 G91 G28 Z0", "G91 G28 G0 Z0", "G01 G91 G30 Z0"])
def test_g0_beside_g28_is_in_force_from_the_next_line_on(words: str) -> None:
    text = f"G21 G90 G1 X5 Z5 F9\n{words}\nG90 X9 Z3\nM30\n"
    program = interpret(text)
    assert "RF"[program.kind[-1]] == ("F" if "G01" in words else "R")
    assert read_gcode(text).p[-1] * 1e3 == pytest.approx([9, 0, 3])


def test_k0_is_no_centre_outside_of_the_plane() -> None:
    arc = interpret("G21 G90 G0 X0 Y0\nG2 X10 Y0 I5 J0 K0 F100\nM30\n")
    assert arc.centre[-1] * 1e3 == pytest.approx([5, 0, 0])
    for other in ("K1", "K-0.01"):
        with pytest.raises(GCodeError, match="G2 has K, which is not in the plane G17"):
            interpret(f"G21 G90\nG2 X10 Y0 I5 J0 {other} F100\nM30\n")


HARMLESS = [
    "G187 P2 E0.01",
    "G103 P1",
    "G103",
    "G05.1 Q1",
    "G5.1 Q1 R1",
    "G05 P10000",
    "G05 P0",
    "G08 P1",
    "G50",
    "G69",
    "G15",
]


@pytest.mark.parametrize("words", HARMLESS)
@pytest.mark.parametrize("dialect", ["auto", "fanuc"])
def test_words_that_move_nothing_are_left_out_and_said(words: str, dialect: str) -> None:
    program = interpret(f"G21 G90 G0 X1\n{words}\nX5\nM30\n", dialect=dialect)
    assert program.end[-1, 0] * 1e3 == pytest.approx(5)
    assert [f.line for f in program.findings if f.code == "harmless-g"] == [2]


def test_what_they_mean_with_axis_words_is_another_thing() -> None:
    with pytest.raises(GCodeError, match="G50 with axis words sets a coordinate system"):
        interpret("G21\nG50 X5\nM30\n")
    assert len(interpret("G21 G90 F9\nG5.1 X10 Y0 I5 J5\nM2\n")) > 10


@pytest.mark.parametrize("line", ["$G", "$$", "$H", "$X", "$32=1", "$N0=G54", "$I"])
def test_lines_for_grbl_are_told_and_left_out(line: str) -> None:
    text = f"{line}\nG21 G90 G0 X5\nM2\n"
    if line == "$H":
        with pytest.raises(GCodeError, match=r"Line 1: \$H moves the machine"):
            interpret(text)
        return
    program = interpret(text)
    assert (program.dialect, len(program)) == ("grbl", 1)


@pytest.mark.parametrize("words", ["M36 P1 S5", "M42 P6 Q1", "M101 P3 Q2 R4"])
def test_words_beside_an_m_code_that_is_left_out_are_left_out_with_it(words: str) -> None:
    assert ends(f"G21 G90\n{words}\nG0 X5\nM2\n") == [(3, "R", 5, 0, 0)]


def test_i_j_k_of_length_one_are_the_direction_of_the_tool_on_straight_moves() -> None:
    path = read_gcode("G21 G90 G0 X0 Z5 I0 J0 K1\nG1 X5 I0.6 J0 K0.8 F100\nX9 I0 J-0.8 K0.6\nM30\n")
    for x, k in ((5, (0.6, 0, 0.8)), (9, (0, -0.8, 0.6))):
        np.testing.assert_allclose(path.k[np.isclose(path.p[:, 0], x * 1e-3)][-1], k, atol=1e-9)
    with pytest.raises(GCodeError, match="Line 2: I has no use here"):
        interpret("G21\nG0 X1 I0.6 J0 K0.9\nM30\n")


def test_centres_that_fit_as_places_are_offered() -> None:
    text = "G21 G90 G0 X10 Y0\nG2 X10 Y20 I10 J10 F100\nG2 X10 Y0 I10 J10\nM30\n"
    with pytest.raises(GCodeError, match=r"Line 3: G2 does not end .*\. As absolute centres all arcs fit: write G90.1"):
        interpret(text)
    fits = interpret(f"G90.1\n{text}")
    assert fits.length[1:].sum() * 1e3 == pytest.approx(20 * np.pi)
    with pytest.raises(GCodeError) as caught:
        interpret(text.replace("X10 Y0 I10 J10", "X10 Y0 I10 J12"))
    assert "absolute" not in str(caught.value)


@pytest.mark.parametrize(("code", "says"), [("G12 I5 D1", "Haas"), ("G13 I5", "Haas"), ("G150 X1", "pocket")])
def test_cycles_that_are_known_and_not_read_are_refused_by_name(code: str, says: str) -> None:
    with pytest.raises(GCodeError, match=f"Line 2: {code.split()[0]} .*{says}.*let the CAM system write its moves out"):
        interpret(f"G21 G90\n{code}\nM30\n")


def test_a_place_in_the_machine_said_in_incremental_mode_is_one_where_linuxcnc_is_not_stated() -> None:
    text = "G21 G90 G54\nG0 X1 Y1 Z1\nG91 G1 X1 F5\nG53 G0 Z0\nM30\n"
    program = interpret(text)
    assert [(f.line, f.level) for f in program.findings if f.code == "g53-incremental"] == [(4, "warning")]
    assert program.unplaced.tolist() == [False, False, True]
    for refused, dialect in ((text, "linuxcnc"), (f"G10 L2 P1 X5\n{text}", "auto")):
        with pytest.raises(GCodeError, match="G53 needs absolute coordinates; use G90 first"):
            interpret(refused, dialect=dialect)


def test_the_direction_of_a_tool_is_a_direction_in_g91_too() -> None:
    places = "G21 G90 G0 X0 Z5 I0 J0 K1\nG1 X5 I0.6 J0 K0.8 F100\nX9 I0 J-0.8 K0.6\nM30\n"
    steps = "G21 G90 G0 X0 Z5 I0 J0 K1\nG91 G1 X5 I0.6 J0 K0.8 F100\nX4 I0 J-0.8 K0.6\nM30\n"
    one, other = read_gcode(places), read_gcode(steps)
    np.testing.assert_allclose(other.p, one.p, atol=1e-12)
    np.testing.assert_allclose(other.k, one.k, atol=1e-12)


@pytest.mark.parametrize(
    ("line", "dialect", "says"),
    [
        # Haas, M96: a jump to line P where input Q is off
        ("M96 P5 Q8", "fanuc", "M96 jumps by an input of the machine"),
        ("G90 G65 P9 X1.", "fanuc", "G65 stands first on its line"),
    ],
)
def test_what_no_reading_follows_is_refused_by_what_it_does(line: str, dialect: str, says: str) -> None:
    with pytest.raises(GCodeError, match=f"Line 2: {says}"):
        interpret(f"G90 F100\n{line}\nG1 X1.\nN5 Y1.\nM30\n", dialect=dialect)
