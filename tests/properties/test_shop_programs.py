"""What shops' programs say and how they are written: each case a short program with the moves that its control makes.

Moves are letters (R rapid, F feed, A arc) with the place in mm where they end, reckoned by hand from the manuals of the
controls; refusals are sentences; findings are codes.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.apt import read_apt
from robomill.toolpath.gcode import Program, Tool, interpret, read_gcode

TOOLS = {1: Tool(1, 10e-3), 12: Tool(12, 6e-3, name="MILL6")}


def moves(program: Program) -> list[tuple[str, float, float, float]]:
    return [("RFAT"[k], *(round(float(v) * 1e3, 6) + 0.0 for v in p)) for k, p in zip(program.kind, program.end)]


def codes(program: Program) -> set[str]:
    return {f.code for f in program.findings}


READ = {
    # tool vectors of a Sinumerik are directions, of any length
    "traori": (
        "G71 G90\nTRAORI\nG0 X0 Y0 Z50 A3=0 B3=0 C3=2\nG1 X10 Z0 A3=1 C3=1 F500\nM30\n",
        "auto",
        "R0,0,50 F10,0,0",
    ),
    "L100 P2": (
        "G71 G90\nG0 Z5\nL100 P2\nM30\n%_N_L100_SPF\nG91 G1 X10 F99\nG90\nM17\n",
        "auto",
        "R0,0,5 F10,0,5 F20,0,5",
    ),
    "M97": ("G21 G90\nG0 Z5.\nM97 P100 L2\nM30\nN100 G91 G1 X10. F99\nG90\nM99\n", "fanuc", "R0,0,5 F10,0,5 F20,0,5"),
    "M198": ("G21 G90 G0 Z5.\nM198 P7\nM30\nO7\nG1 X1. F9\nM99\n", "fanuc", "R0,0,5 F1,0,5"),
    "full circle": ("G71 G90 F9\nG0 X10 Y0\nG2 X10 Y0 I=AC(0) J=AC(0)\nM30\n", "auto", "R10,0,0 A10,0,0"),
    "exponent": ("G21 G90\nG1 X-1.776e-15 Y2E1 F100\nM30\n", "fanuc", "F0,20,0"),
    "G41 D1": (
        "G71 G90\nT1 D1\nM6\nG0 X0 Y-20\nG1 G41 X0 Y0 F9\nY50\nG40 X-20\nM30\n",
        "sinumerik",
        "R0,-20,0 F-5,0,0 F-5,50,0 F-20,50,0",
    ),
    "T by name": (
        'G71 G90\nT="mill6" D1\nM6\nG0 X0 Y-20\nG1 G41 X0 Y0 F9\nY50\nG40 X-20\nM30\n',
        "auto",
        "R0,-20,0 F-3,0,0 F-3,50,0 F-20,50,0",
    ),
    # drilling, and what posts write behind it
    "G80 Z15.": (
        "G21 G90\nG0 X1. Y1.\nG43 H1 Z20.\nG81 X1. Y1. Z-5. R2. F9\nG80\nZ15.\nM30\n",
        "auto",
        "R1,1,0 R1,1,20 R1,1,20 R1,1,2 F1,1,-5 R1,1,2 R1,1,15",
    ),
    "G43 first": ("G21 G90\nG43 H1 Z20.\nX5.\nM30\n", "auto", "R0,0,20 R5,0,20"),
    "G0 G91 G28": ("G21 G90\nG0 G91 G28 Z0\nG90 X5. Y5. Z5.\nG1 X6. F9\nM30\n", "auto", "R0,0,0 R0,0,0 R5,5,5 F6,5,5"),
    "K0 on arcs": ("G21 G90\nG1 X0 F9\nG2 X10 Y0 I5 J0 K0\nM2\n", "auto", "F0,0,0 A10,0,0"),
    "smoothing": ("G21 G90 G187 P3\nG103 P1\nG05.1 Q1\nG5.1 Q1 R1\nG0 X1.\nM30\n", "auto", "R1,0,0"),
    "grbl's $": ("$110=500\n$$\nG21\nG0 X1\n", "auto", "R1,0,0"),
    "P beside M": ("G21 G90 M19 P90 S9\nM88 P2\nG0 X1\nM30\n", "auto", "R1,0,0"),
    "G50 G69 G15": ("G21 G90 G50 G69 G15\nG0 X1\nM30\n", "auto", "R1,0,0"),
    "tool vectors": ("G21\nG0 X0 Y0 Z9 I0 J0 K1\nG1 X9 Y0 Z0 I0.6 J0 K0.8 F9\nM30\n", "auto", "R0,0,9 F9,0,0"),
    # macro B, and words of Fanuc and Haas
    "IF GOTO": ("#1=0\nG21 G90 F9\nN10 #1=#1+1\nG1 X#1\nIF[#1LT3]GOTO10\nM30\n", "auto", "F1,0,0 F2,0,0 F3,0,0"),
    "WHILE": ("#1=0\nG21 F9\nWHILE[#1LT2]DO1\n#1=#1+1\nG1 X[#1*2]\nEND1\nM30\n", "auto", "F2,0,0 F4,0,0"),
    "G65": ("O1\nG21 G90\nG65 P9 X1. Y2. F9.\nM30\nO9\nG1 X#24 Y#25 F#9\nM99\n", "fanuc", "F1,2,0"),
    "G68": ("G21 G90 F9\nG68 X10. Y0 R90.\nG1 X20. Y0\nG69\nX0 Y0\nM30\n", "fanuc", "F10,10,0 F0,0,0"),
    "G51": ("G21 G90 F9\nG51 X10. Y10. P2000\nG1 X20. Y10.\nG50\nX0\nM30\n", "fanuc", "F30,10,0 F0,10,0"),
    "G16": ("G21 G90 F9\nG16\nG1 X50. Y90.\nG15\nX1. Y1.\nM30\n", "fanuc", "F0,50,0 F1,1,0"),
    "G84": (
        "G21 G90 S500\nG0 Z9.\nM29 S500\nG84 X1. Z-5. R2. F500.\nG80\nM30\n",
        "fanuc",
        "R0,0,9 R1,0,9 R1,0,2 F1,0,-5 F1,0,2 R1,0,9",
    ),
    ",R ,C": ("G21 G90 F9\nG1 X20. ,R5.\nY20. ,C2.\nX0\nM30\n", "fanuc", "F15,0,0 A20,5,0 F20,18,0 F18,20,0 F0,20,0"),
    # everyday words of Sinumerik
    "CYCLE81": (
        "G71 G90 F9\nG0 Z50\nMCALL CYCLE81(20,0,2,-10)\nX10\nMCALL\nX0\nM30\n",
        "auto",
        "R0,0,50 R10,0,50 R10,0,2 F10,0,-10 R10,0,20 R0,0,20",
    ),
    "R and GOTOB": ("G71 F9\nR1=0\nL_A:\nR1=R1+1\nG1 X=R1*2\nIF R1<2 GOTOB L_A\nM30\n", "auto", "F2,0,0 F4,0,0"),
    "TRANS ROT": ("G71 G90 F9\nTRANS X10 Y5\nAROT RPL=90\nG1 X1 Y0\nTRANS\nX0 Y0\nM30\n", "auto", "F10,6,0 F0,0,0"),
    "RND CHR": ("G71 G90 F9\nG1 X20 RND=5\nY20 CHR=2\nX0\nM30\n", "auto", "F15,0,0 A20,5,0 F20,18,0 F18,20,0 F0,20,0"),
    "IC": ("G71 G90 F9\nG1 X=IC(5) Y=AC(3)\nG91 X=AC(50) Y1\nM30\n", "auto", "F5,3,0 F50,4,0"),
    "GOTOF MSG": ('G71 F9\nMSG("x (y)")\nWORKPIECE(,,,"BOX",1)\nGOTOF E_1\nG1 X9\nE_1: G1 X1\nM30\n', "auto", "F1,0,0"),
    # Heidenhain's dialogue
    "L CR RND": (
        "BEGIN PGM A MM\nTOOL CALL 1 Z S9 F9\nL Z+5 FMAX M3\nL X+20 F9\nRND R5\nL Y+20\n"
        "CR X+10 Y+30 R+10 DR+\nEND PGM A MM\n",
        "auto",
        "R0,0,5 F15,0,5 A20,5,5 F20,20,5 A10,30,5",
    ),
    "CC C CHF": (
        "BEGIN PGM A MM\nTOOL CALL 1 Z F9\nL X+10\nCC X+0 Y+0\nC X+0 Y+10 DR+\nL X-20\nCHF 2\nL Y+0\nEND PGM A MM\n",
        "auto",
        "F10,0,0 A0,10,0 F-18,10,0 F-20,8,0 F-20,0,0",
    ),
    "CALL LBL": (
        "BEGIN PGM A MM\nTOOL CALL 1 Z F9\nLBL 1\nL IX+10\nCALL LBL 1 REP 2\nEND PGM A MM\n",
        "auto",
        "F10,0,0 F20,0,0 F30,0,0",
    ),
    "CYCL DEF 200": (
        "BEGIN PGM A MM\nTOOL CALL 1 Z S9 F9\nL Z+9 FMAX\nCYCL DEF 200 ~\nQ200=2 ~\nQ201=-4 ~\nQ206=50 ~\n"
        "Q202=4 ~\nQ203=0 ~\nQ204=5\nL X+1 FMAX M99\nEND PGM A MM\n",
        "auto",
        "R0,0,9 R1,0,9 R1,0,2 F1,0,-4 R1,0,5",
    ),
}


@pytest.mark.parametrize("name", READ)
def test_it_is_read_with_the_moves_that_its_control_makes(name: str) -> None:
    text, dialect, expected = READ[name]
    program = interpret(text, dialect=dialect, tools=TOOLS)
    wanted = [(each[0], *map(float, each[1:].split(","))) for each in expected.split()]
    assert moves(program) == wanted


def test_tools_lean_as_their_vectors_say() -> None:
    for name, axis in (("traori", [math.sqrt(0.5), 0, math.sqrt(0.5)]), ("tool vectors", [0.6, 0, 0.8])):
        np.testing.assert_allclose(read_gcode(READ[name][0]).k[-1], axis, atol=1e-9)


REFUSED = {
    "L100 missing": ("G71 G90\nL100 P2\nM30\n", "Line 2: L100 calls a subprogram that is not in this file"),
    "M98 missing": ("G21 G90\nM98 P7\nM30\n", "Line 2: M98 calls O7, but there is no O7 in the program"),
    "behind %": ("%\nO1\nG21\nM98 P7\nM30\n%\nO7\nG1 X1 F9\nM99\n", "Line 4: M98 calls O7, which stands behind the %"),
    "G41 without a table": (
        'G71\nT="A" D1\nM6\nG41 G1 X9 F9\nM30\n',
        'Line 4: G41 needs the diameter of tool "A"; give a',
    ),
    "$H": ("$H\nG0 X1\n", "Line 1: \\$H moves the machine"),
    "G12": ("G21\nG12 I10. D1 F9\n", "Line 2: G12 mills a circular pocket \\(Haas\\)"),
    "G13": ("G21\nG13 I10. D1 F9\n", "Line 2: G13 mills a circular pocket \\(Haas\\)"),
    "G150": ("G21\nG150 P9 D1 I1\n", "Line 2: G150 mills a pocket \\(Haas\\)"),
    "absolute centres": (
        "G21 F9\nG0 X10 Y10\nG2 X20 Y20 I20 J10\nX30 Y10 I20 J10\n",
        "As absolute centres all arcs fit: write G90.1",
    ),
    "KRL": ("&ACCESS RVP\nDEF A( )\nPTP {X 1}\nEND\n", "Line 1: this is KUKA KRL, which is not read"),
    "RAPID": ("MODULE M\nMoveL p1, v100, z1, t;\nENDMODULE\n", "Line 1: this is ABB RAPID, which is not read"),
    "pocket cycle": (
        "BEGIN PGM A MM\nCYCL DEF 251 ~\nQ218=1\nEND PGM A MM\n",
        "Line 2: CYCL DEF 251 is a cycle that is not read",
    ),
    "300 digits": (f"G21\nG0 X{'9' * 320}\n", "Line 2: "),
    "long O": (f"O{'9' * 400}\nG21\nM98 P{'9' * 400}\n", "Line 3: "),
    "huge tool": ("G21\nT99999999999 M6\n", "Line 2: A tool number is 1e\\+11"),
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", REFUSED)
def test_it_is_refused_in_a_sentence(name: str) -> None:
    text, says = REFUSED[name]
    with pytest.raises(GCodeError, match=says) as refused:
        read_gcode(text)
    assert len(str(refused.value)) < 400


FOUND = {
    "rotary table": ("G21 G90 S9 M3\nG0 Z9\nG1 Z5 F9\nA360\nM30\n", "auto", "rotary-asked"),
    "G28": ("G21 G90 S9 M3\nG1 Z-1 F9\nG91 G28 Z0\nM30\n", "auto", "machine-place"),
    "M91": ("BEGIN PGM A MM\nTOOL CALL 1 Z S9 F9\nL X+1\nL Z+0 FMAX M91\nEND PGM A MM\n", "auto", "machine-place"),
    "G10 L2": ("G21 G90 G10 L2 P1 X9\nG1 X1 F9\nM2\n", "auto", "zero-placed"),
    "G54 and G55": ("G21 G90 G54\nG1 X1 F9\nG55 X0\nM2\n", "auto", "zeros-overlaid"),
    "G4 P500": ("G21 G90\nG4 P500\nG1 X1 F9\nM2\n", "auto", "long-dwell"),
    "a missing point": ("G21 G90\nG1 X10. Y5. F9\nX20. Y2000\nM2\n", "auto", "no-point"),
    "spindle off": ("G21 G90 S9 M3\nG1 X1 F9\nM5\nX2\nM2\n", "auto", "spindle-stopped"),
    "tool that nobody knows": ("G21 G90\nT7 M6\nG1 X1 F9\nM2\n", "auto", "tool-unknown"),
    "WORKPIECE": ('G71\nWORKPIECE(,,,"BOX",1)\nG0 X1\nM30\n', "auto", "harmless-word"),
}


@pytest.mark.parametrize("name", FOUND)
def test_it_gets_a_finding(name: str) -> None:
    text, dialect, code = FOUND[name]
    assert code in codes(interpret(text, dialect=dialect, tools=TOOLS))


def test_milliseconds_and_small_parts_are_what_their_control_takes_them_for() -> None:
    assert interpret("G21\nG4 P500\nG1 X1. F9\nM30\n", dialect="fanuc").dwell_time == pytest.approx(0.5)
    assert "size-doubt" not in codes(interpret("G21 G90\nG1 X5. F9\nM30\n"))


APT = {
    "UNIT/INCH": ("UNIT/INCH\nFEDRAT/10,IPM\nGOTO/0,0,0\nGOTO/1,0,0\nFINI\n", [25.4, 0, 0]),
    "TRANS": ("UNITS/MM\nFEDRAT/9,MMPM\nTRANS/10,20,30\nGOTO/0,0,0\nGOTO/1,2,3\nFINI\n", [11, 22, 33]),
    "CSYS": ("UNITS/MM\nCSYS/1,0,0,9,0,1,0,9,0,0,1,9\nFEDRAT/9,MMPM\nGOTO/0,0,0\nGOTO/1,2,3\nFINI\n", [1, 2, 3]),
    "LOAD/TOOL": ("UNITS/MM\nLOAD/TOOL,12\nFEDRAT/9,MMPM\nGOTO/0,0,0\nGOTO/1,2,3\nFINI\n", [1, 2, 3]),
    "MODE/INCR": ("UNITS/MM\nFEDRAT/9,MMPM\nGOTO/1,0,0\nMODE/INCR\nGOTO/5,0,0\nFINI\n", [5, 0, 0]),
    "CIRCLE": ("UNITS/MM\nFEDRAT/9,MMPM\nGOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10\nGOTO/0,10,0\nFINI\n", [0, 10, 0]),
    "CYCLE": ("UNITS/MM\nGOTO/0,0,9\nCYCLE/DRILL,DEPTH,10,MMPM,99,CLEAR,3\nGOTO/10,0,0\nFINI\n", [10, 0, 3]),
}


@pytest.mark.parametrize("name", APT)
def test_apt_is_read_with_its_units_frames_and_cycles(name: str) -> None:
    text, last = APT[name]
    path = read_apt(text)
    np.testing.assert_allclose(path.p[-1] * 1e3, last, atol=1e-9)
    if name == "LOAD/TOOL":
        assert path.tool[-1] == 12
    if name == "CIRCLE":
        np.testing.assert_allclose(np.hypot(*path.p[:, :2].T) * 1e3, 10.0, atol=1e-9)
    if name == "CYCLE":
        assert path.p[path.cutting, 2].min() * 1e3 == pytest.approx(-10.0)


def test_tlaxis_holds_until_the_next() -> None:
    path = read_apt(
        "UNITS/MM\nFEDRAT/9,MMPM\nTLAXIS/0,0.6,0.8\nGOTO/0,0,0\nGOTO/1,0,0\nTLAXIS/0,0,1\nGOTO/2,0,0\nFINI\n"
    )
    np.testing.assert_allclose(path.k, [[0, 0.6, 0.8], [0, 0.6, 0.8], [0, 0, 1]], atol=1e-9)
