"""Everyday words of Sinumerik controls: every program with the places that plane geometry gives."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret
from tests.toolpath.gcode.sinumerik.moves import HEAD, ends, places

VALUES = [
    ("R1=5\nG1 X=R1\n", 5),
    ("R1=2EX1\nG1 X=R1*1.5EX-1\n", 3),
    ("G1 X=-2EX-1\n", -0.2),
    ("R1=5 R2=-2\nG1 X=R1*(3+R2)-1\n", 4),
    ("N10 R10=2.5\nN20 R11=R10*2\nN30 G1 X=-R11\n", -5),
    ("R1=30\nG1 X=10*SIN(R1)\n", 5),
    ("G1 X=10+5 Y0\n", 15),
    ("R1=4\nG1 X1\nX=IC(2)\n", 3),
    ("R1=3\nIF R1==3 GOTOF L_A\nG1 X9\nL_A:\nG1 X2\n", 2),
    ("R1=3\nIF R1<>3 GOTOF L_A\nG1 X9\nL_A:\n", 9),
    ("R1=0\nAGAIN: R1=R1+1\nIF R1<4 GOTOB AGAIN\nG1 X=R1\n", 4),
    ("GOTO N50\nG1 X9\nN50 G1 X3\n", 3),
    ("GOTOF ENDE\nG1 X9\nENDE: G1 X6\n", 6),
]
VALUES += [
    ("R1=POT(3)\nG1 X=R1+POT(1+(1))\n", 13),
    ("R1=ATAN2(1,1)\nG1 X=R1+ATAN2(2*(1),-2)\n", 180),
    # words need no blanks between them
    ("N10G1X5Y1\nN20X=IC(2)\n", 7),
    ("G91G1X5\nG90X=IC(2)\n", 7),
    ("G1X4\nG91X=AC(9)\n", 9),
    ("R1=2\nN5G1X=R1*3 F50\n", 6),
    ("G1X-1.776E-15Y1\nG4F1\n", 0),
    ("G1 X3\nL7P2\nM30\n%_N_L7_SPF\nG91X1\nG90\nM17\n", 5),
    ("G641 ADIS=0.5 ADISPOS=.2\nCTOL=0.01 ACC[X]=50\nG1 X8\n", 8),
]


@pytest.mark.parametrize(("body", "x"), VALUES)
def test_r_parameters_labels_and_jumps(body: str, x: float) -> None:
    assert places(body)[-1][0] == pytest.approx(x)


FRAMES = [
    ("TRANS X10 Y5 Z1\nG1 X1 Y2 Z3\n", (11, 7, 4)),
    ("TRANS X10\nATRANS X5\nG1 X1\n", (16, 0, 0)),
    ("TRANS X10\nTRANS Y5\nG1 X1 Y2\n", (1, 7, 0)),
    ("ROT RPL=90\nG1 X5\n", (0, 5, 0)),
    ("ROT Z90\nG1 X5\n", (0, 5, 0)),
    ("TRANS X10 Y5\nAROT RPL=90\nG1 X5 Y1\n", (9, 10, 0)),
    ("ROT RPL=90\nATRANS X5\nG1 X1\n", (0, 6, 0)),
    ("AROT RPL=30\nAROT RPL=60\nG1 X5\n", (0, 5, 0)),
    ("TRANS X10\nROT RPL=90\nG1 X5\n", (0, 5, 0)),
    ("TRANS X10\nTRANS\nG1 X5\n", (5, 0, 0)),
    ("TRANS X10\nAROT RPL=90\nROT\nG1 X5\n", (5, 0, 0)),
]


@pytest.mark.parametrize(("body", "end"), FRAMES)
def test_frames_shift_and_turn_coordinates(body: str, end: tuple[float, float, float]) -> None:
    """TRANS and ROT begin anew from the coordinate system, ATRANS and AROT add to what holds; empty ones end it."""
    assert places(body)[-1] == pytest.approx(end, abs=1e-6)


@pytest.mark.parametrize(
    ("at", "way", "to", "turned"),
    [
        (10, "DC", 350, -20),
        (10, "DC", 190, 180),
        (10, "DC", 191, -179),
        (350, "DC", 10, 20),
        (10, "DC", 10, 0),
        (10, "ACP", 350, 340),
        (10, "ACP", 10, 0),
        (350, "ACP", 10, 20),
        (-30, "ACP", 10, 40),
        (10, "ACN", 350, -20),
        (10, "ACN", 10, 0),
        (350, "ACN", 10, -340),
        (400, "ACN", 10, -30),
        (400, "DC", 10, -30),
    ],
)
def test_axes_turn_the_short_way_up_or_down(at: float, way: str, to: float, turned: float) -> None:
    program = interpret(f"{HEAD}G1 A{at}\nA={way}({to})\nM30\n", dialect="sinumerik")
    assert np.degrees(program.rotary[-1, 0] - program.rotary[-2, 0]) == pytest.approx(turned, abs=1e-9)
    with pytest.raises(GCodeError, match=f"Line 2: X={way}. . is for axes that turn"):
        interpret(f"{HEAD}G1 X={way}(5)\nM30\n", dialect="sinumerik")


def test_corners_are_rounded_and_chamfered() -> None:
    assert places("G1 X20 RND=5\nY20 CHR=2\nX0 CHF=2\nY0\n") == [
        (15, 0, 0),
        (20, 5, 0),
        (20, 18, 0),
        (18, 20, 0),
        (pytest.approx(np.sqrt(2), abs=1e-6), 20, 0),
        (0, pytest.approx(20 - np.sqrt(2), abs=1e-6), 0),
        (0, 0, 0),
    ]


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("G1 X=R7\n", "Line 2: R7 is read before the program sets it"),
        ("R5000=1\n", "Line 2: R5000 does not exist"),
        ("GOTOF NOWHERE\n", "Line 2: GOTOF NOWHERE leads nowhere"),
        ("A_B:\nGOTOF A_B\n", "Line 3: GOTOF A_B leads nowhere: there is no such label on that side"),
        ("ROT X45\n", "Line 2: ROT X45 is not read; expected shifts along X, Y, Z or a turn about Z"),
        ("TRANS X5 RPL=30\n", "Line 2: TRANS X5 RPL=30 is not read; expected shifts along X, Y, Z or a turn about Z"),
        ("ATRANS RPL=30\n", "Line 2: ATRANS RPL=30 is not read; expected shifts along X, Y, Z or a turn about Z"),
        ("ROT Z5 RPL=30\n", "Line 2: ROT Z5 RPL=30 is not read; expected shifts along X, Y, Z or a turn about Z"),
        ("CYCLE81(50,0)\n", "Line 2: CYCLE81 needs RTP, RFP and DP or DPR"),
        ("CYCLE81(50,0,2,5)\n", "Line 2: CYCLE81: expected RTP above RFP + SDIS, and the depth below"),
        ("CYCLE84(50,0,2,-10,,0,5,7)\n", "Line 2: CYCLE84 needs PIT"),
        ("CYCLE84(50,0,2,-10,,0,5,,1,0,90,90,0,2)\n", "Line 2: CYCLE84 has its pitch by _PITA 2"),
        ("G1 X9 FB=300\n", "Line 2: FB= is the feed of its block alone"),
        ("G1 X9 FB=R1*2\n", "Line 2: FB= is the feed of its block alone"),
        ("G2 X20 Y0 I1=10 J1=10\n", "Line 2: I1= is a point on the arc of CIP"),
        ("G1 X9 RNDM=-.5\n", "Line 2: RNDM=-0.5 is below 0"),
        ("G1 X9 RND=2 FRC=-5\n", "Line 2: FRC=-5 is below 0"),
        ("CYCLE83(50,0,2,-10)\n", "Line 2: CYCLE83 needs FDEP or FDPR"),
        ("CYCLE81(50,0,2,-10,,0,1)\n", "Line 2: CYCLE81 counts its depth by the diameter"),
        ("POCKET3(50,0)\n", "POCKET3"),
    ],
)
def test_what_is_not_read_is_refused_by_name(body: str, says: str) -> None:
    with pytest.raises(GCodeError) as caught:
        ends(body)
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("code", "says"),
    [
        ("X10 L100", "L100 calls a subprogram; put it on a line of its own"),
        ("G58 X5", "G58 shifts coordinates on a Sinumerik"),
        ("G59 Y5", "G59 shifts coordinates on a Sinumerik"),
    ],
)
def test_words_that_would_be_read_wrongly_are_refused(code: str, says: str) -> None:
    with pytest.raises(GCodeError, match=f"Line 2: {says}"):
        interpret(f"G90 G1 F100\n{code}\nM30\n", dialect="sinumerik")


def test_subprograms_behind_the_end_are_not_said_to_be_left_out() -> None:
    program = interpret("G91 G1 F100\nL100\nM30\n%_N_L100_SPF\nX10\nM17\n", dialect="sinumerik")
    assert "after-end" not in {f.code for f in program.findings}


def test_what_moves_nothing_is_left_out() -> None:
    body = 'GROUP_BEGIN(0,"TOP",0,0)\nCYCLE800(1,"TC1",200000,27,0,0,0,0,0,0,0,0,0,1,,0)\nX5\nGROUP_END(0,0)\n'
    program = interpret(f"G90 G1 F100 X0\n{body}M30\n", dialect="sinumerik")
    assert program.end[-1, 0] == pytest.approx(5e-3)
    assert {f.message.split()[0] for f in program.findings if f.code == "harmless-word"} == {
        "GROUP_BEGIN",
        "GROUP_END",
        "CYCLE800",
    }


@pytest.mark.parametrize(
    "words",
    [
        "CUT2DF",
        "SPCON",
        "SPCOF",
        "TCOABS",
        "PAROTOF",
        "TRAILOF(A,X)",
        "DISC=0",
        "H1=5",
        "H5=-2.5 M8",
        "M=QU(7)",
        "h2=qu(3)",
    ],
)
def test_words_of_headers_move_nothing(words: str) -> None:
    """Couplings that end, speeds, blocks for other parts of the control: 840D, list of instructions."""
    program = interpret(f"G71 G90 G1 F100 X0\n{words}\nX5 {words}\nM30\n", dialect="sinumerik")
    assert (program.end[:, 0] * 1e3).tolist() == pytest.approx([0, 5])
    assert {f.code for f in program.findings if f.line == 2} == {"harmless-word"}


def test_a_radius_that_feeds_of_turning_axes_count_by_is_said() -> None:
    program = interpret("G71 G90 G1 F100 X0\nFGREF[A]=10 FGREF[C]=20\nX5\nM30\n", dialect="sinumerik")
    said = [f.message for f in program.findings if f.code == "turning-feed"]
    assert [each.split()[0] for each in said] == ["FGREF[A]", "FGREF[C]"]
    for words in ("DISC=50", "DISC=0.5", "FGREF[A]=R1"):
        with pytest.raises(GCodeError):
            interpret(f"G71 G90 G1 F100 X0\n{words}\nM30\n", dialect="sinumerik")


def test_lines_too_long_to_be_looked_through_are_refused() -> None:
    with pytest.raises(GCodeError, match="Line 1: 9000 characters long; at most 3000"):
        interpret("X=AC(" * 1800 + "\nM30\n", dialect="sinumerik")


def test_shifts_and_turns_may_be_computed() -> None:
    body = "R1=5\nTRANS X=R1*2 Y5 Z=-R1\nG1 X1 Y0 Z0\nROT RPL=45+R1*9\nX1 Y0\n"
    assert places(body) == [(11, 5, -5), (0, 1, -5)]


@pytest.mark.parametrize(
    ("body", "rates"),
    [
        ("G70 G1 X1 F100\nX2 F200\n", [100, 200]),
        ("R1=5\nG70 G1 X1 F=R1*2\n", [10]),
        ("G1 X1 F50\nG70 X2\nX3 F60\nG71 X2 F70\n", [50, 50, 60, 70]),
        ("G700 G1 X1 F10\nX2 F20\nG710 X3 F300\n", [254, 508, 300]),
        ("G700 G1 X1 F10\nG70 X2 F20\n", [254, 20]),
    ],
)
def test_feeds_count_in_inches_under_g700_alone(body: str, rates: list[float]) -> None:
    """840D sl, Fundamentals, Inch or metric dimensions: G70 and G71 change lengths, G700 and G710 feeds too."""
    program = interpret(f"G90 G17 S500 M3\n{body}M30\n", dialect="sinumerik")
    np.testing.assert_allclose(program.v_f * 6e4, rates)
    codes = {f.code for f in program.findings}
    assert "feed-units" not in codes
    assert ("feeds-metric" in codes) == ("G70 " in body)


def test_a_semicolon_in_quotes_begins_no_comment_and_the_last_line_of_a_subprogram_may_move() -> None:
    assert places('MSG("HALLO; (x) G1 X999")\nG1 X1 ; "a\nX2\n') == [(1, 0, 0), (2, 0, 0)]
    assert places("L1\nX9\nM30\n%_N_L1_SPF\nG91 G1 X1\nG90 X5 M17\n") == [(1, 0, 0), (5, 0, 0), (9, 0, 0)]
    assert places("OFFN=0\nG1 X1\n") == [(1, 0, 0)]
    with pytest.raises(GCodeError, match="Line 2: OFFN"):
        places("OFFN=0.5\nG1 X1\n")


@pytest.mark.parametrize(
    ("dwell", "seconds"), [("F2", 2), ("F=2", 2), ("F=R1", 3), ("F = R1+1", 4), ("S50", 6), ("S=R1*10", 3.6)]
)
def test_a_dwell_may_be_computed(dwell: str, seconds: float) -> None:
    """By F in seconds, by S in turns of the spindle (500 a minute)."""
    program = interpret(f"{HEAD}R1=3\nG4 {dwell}\nG1 X5\nM30\n", dialect="sinumerik")
    assert program.dwell_time == pytest.approx(seconds)


@pytest.mark.parametrize(
    ("said", "feeds"),
    [
        ("FRC=20", [100, 20, 100, 100, 100]),
        ("FRCM=R1", [100, 30, 100, 30, 100]),
        ("FRC=20 FRCM=40", [100, 20, 100, 40, 100]),
        ("", [100] * 5),
    ],
)
def test_a_corner_may_have_a_feed_of_its_own(said: str, feeds: list[float]) -> None:
    """840D, Fundamentals: FRC is non-modal, FRCM holds for every chamfer and rounding that follows."""
    program = interpret(f"{HEAD}R1=30\nG1 X20 RND=2 {said}\nY20 CHR=2\nX0\nM30\n", dialect="sinumerik")
    np.testing.assert_allclose(program.v_f * 6e4, feeds)
    turned = interpret(f"{HEAD}G95 F0.2\nG1 X20 RND=2 FRC=0.1\nY20\nM30\n", dialect="sinumerik")
    np.testing.assert_allclose(turned.v_f * 6e4, [100, 50, 100])


def test_words_of_the_first_spindle() -> None:
    program = interpret("G90 G71 G0 X0 Y0 Z0\nM1=4 S1=600\nG1 X10 F100\nM30\n", dialect="sinumerik")
    assert program.n_s[-1] == pytest.approx(10)
    assert program.ccw[-1]


@pytest.mark.parametrize("line", ["G74 X1=0 Y1=0 Z1=0", "G75 FP=2 X1=0 Y1=0 Z1=0", "N9 G75 Z1=0", "G75 Z=0"])
def test_fixed_points_are_where_only_the_machine_knows(line: str) -> None:
    """They are of their block alone: G1 goes on behind them."""
    body = f"G90 G71 G1 X5 Y5 Z-1 F100\n{line}\nX0 Y0 Z9\nZ-2\nM30\n"
    program = interpret(body, dialect="sinumerik")
    assert [f.line for f in program.findings if f.code == "machine-place"] == [2]
    assert program.at_feed.tolist()[-1]
    np.testing.assert_allclose(program.end[-1] * 1e3, [0, 0, -2])
    assert len(program) == 3


def test_a_way_round_the_first_corner_that_is_not_known_is_told() -> None:
    program = interpret(f"{HEAD}NORM\nKONT\nG1 X5\nM30\n", dialect="sinumerik")
    assert [(f.code, f.line) for f in program.findings if f.level == "warning"] == [("approach", 3)]


@pytest.mark.parametrize(
    "word", ["DYNNORM", "DYNROUGH", "DYNSEMIFIN", "DYNFINISH", "DYNPOS", "DYNPREC", "RTLION", "RTLIOF"]
)
def test_dynamics_move_nothing(word: str) -> None:
    program = interpret(f"G71 G90\n{word}\nG0 X5\nM30\n", dialect="sinumerik")
    assert [(f.code, f.line) for f in program.findings if f.line] == [("harmless-word", 2)]
    assert (program.end * 1e3).tolist() == [pytest.approx([5, 0, 0])]
