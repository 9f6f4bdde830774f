"""Branches, loops and variables of Sinumerik programs, with the places along X that Python finds for them."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret


def xs(body: str) -> list[float]:
    program = interpret(f"G90 G71 G1 F100 S60 M3\n{body}M30\n", dialect="sinumerik")
    return (np.round(program.end[1:, 0] * 1e3, 9) + 0.0).tolist()


@pytest.mark.parametrize(
    ("body", "places"),
    [
        ("R1=2\nIF R1==2\nX10\nELSE\nX20\nENDIF\nX30\n", [10, 30]),
        ("R1=3\nN5 IF R1==2\nX10\nELSE\nX20\nENDIF\nX30\n", [20, 30]),
        ("R1=3\nIF R1<>3\nX10\nENDIF ;done\nX30\n", [30]),
        ("R1=0\nIF R1>1\nIF R1>2\nX1\nELSE\nX2\nENDIF\nELSE\nIF R1==0\nX3\nENDIF\nENDIF\n", [3]),
        ("R1=1\nWHILE R1<4\nX=R1\nR1=R1+1\nENDWHILE\nX9\n", [1, 2, 3, 9]),
        ("FOR R2=1 TO 3\nX=R2\nENDFOR\nX=R2\n", [1, 2, 3, 4]),
        ("FOR R2=3 TO 1\nX=R2\nENDFOR\nX9\n", [9]),
        ("R1=0\nREPEAT\nR1=R1+1\nX=R1\nUNTIL R1>=3\n", [1, 2, 3]),
        ("R1=0\nLOOP\nR1=R1+1\nX=R1\nIF R1>2 GOTOF RAUS\nENDLOOP\nRAUS: X9\n", [1, 2, 3, 9]),
        ("X0\nANF: X=IC(5)\nREPEAT ANF P=2\nX9\n", [0, 5, 10, 15, 9]),
        (
            "X0\nANF: X=IC(5)\nX=IC(1)\nENDE: X=IC(2)\nX50\nREPEAT ANF ENDE P=2\nX9\n",
            [0, 5, 6, 8, 50, 55, 56, 58, 63, 64, 66, 9],
        ),
        ("X0\nEINS: X=IC(5)\nX=IC(1)\nREPEATB EINS P=3\nX9\n", [0, 5, 6, 11, 16, 21, 9]),
        ("X0\nEINS: X=IC(5)\nREPEATB EINS\nX=IC(1)\nREPEATB EINS P2\nX9\n", [0, 5, 10, 11, 16, 21, 9]),
        ("X0\nANF: X=IC(5)\nENDLABEL: X=IC(1)\nX20\nREPEAT ANF\nX9\n", [0, 5, 6, 20, 25, 26, 9]),
        ("X0\nREPEAT ANF ENDE\nX20\nANF: X=IC(5)\nX=IC(1)\nENDE: X=IC(2)\nX9\n", [0, 5, 6, 8, 20, 25, 26, 28, 9]),
        (
            "R1=0\nX0\nGOTOF BEGINN\nANF: X=IC(5)\nR1=R1+1\nIF R1>2 GOTOF RAUS\nENDE: X=IC(1)\nBEGINN: X10\n"
            "REPEAT ANF ENDE P=9\nRAUS: X9\nENDE2: X8\n",
            [0, 10, 15, 16, 21, 22, 27, 9, 8],
        ),
        (  # a jump to the first line of what is repeated, or to its last, does not leave it
            "R1=0\nX0\nANF: X=IC(5)\nR1=R1+1\nIF R1==2 GOTOB ANF\nENDE: X=IC(1)\nX50\nREPEAT ANF ENDE\nX9\n",
            [0, 5, 6, 50, 55, 60, 61, 9],
        ),
        (
            "R1=0\nX0\nANF: X=IC(5)\nR1=R1+1\nIF R1==2 GOTOF ENDE\nX=IC(2)\nENDE: X=IC(1)\nX50\nREPEAT ANF ENDE\nX9\n",
            [0, 5, 7, 8, 50, 55, 56, 9],
        ),
        # a label before REPEAT is meant, and not one of that name on its own line or behind it
        ("X0\nANF: X=IC(5)\nANF: REPEAT ANF P=2\nX9\nANF: X8\n", [0, 5, 10, 15, 9, 8]),
        ("GOTOC NIRGENDS\nX1\n", [1]),
        ("R1=3\nR[R1]=7\nX=R[3]\nX=R[R1]+1\n", [7, 8]),
        ("DEF INT N3=7\nX=7 DIV 2\nX=N3 DIV 2+10\nX=N3 MOD 4\n", [3, 13, 3]),
        ("R1=1\nIF NOT (R1==2)\nX1\nENDIF\nIF NOT (R1==1) OR R1==5\nX2\nENDIF\nX3\n", [1, 3]),
        ("DEF REAL LANG=5.5\nDEF INT ANZ, N2=3\nANZ=2\nX=LANG\nX=ANZ*N2+1\nX=-LANG\n", [5.5, 7, -5.5]),
        ("DEF REAL LA, LB\nLA=2 LB=LA*3\nX=LB\n", [6]),
        ("DEF REAL A1, X1\nA1=2 X1=A1*3\nX=X1\n", [6]),
        ("FOR R999=1 TO 2\nX=R999*10\nENDFOR\n", [10, 20]),
        ("DEF INT I1\nFOR I1=1 TO 2\nX=I1*10\nENDFOR\n", [10, 20]),
        ("DEF BOOL AN=TRUE\nIF AN\nX1\nENDIF\nX=TRUNC(2.7)\n", [1, 2]),
    ],
)
def test_programs_are_followed(body: str, places: list[float]) -> None:
    assert xs(body) == places


def test_a_modal_subprogram_follows_every_line_that_moves() -> None:
    body = "MCALL L100\nX10\nM8\nX20\nMCALL\nX30\nM30\n%_N_L100_SPF\nX=IC(1)\nM17\n"
    assert xs(body) == [10, 11, 20, 21, 30]
    assert xs(body.replace("L100", "BOHR")) == [10, 11, 20, 21, 30]


@pytest.mark.parametrize(
    ("body", "place"),
    [
        ("R1=3\nX=AC(R1*2)\n", 6),
        ("X5\nR1=3\nX=IC(R1-1)\n", 7),
        ("R1=3\nX=R1  + \t 1  Y=2\n", 4),
        ("R1=3\nX=2  *  ( R1   -  1 )   Y=2\n", 4),
        ("G0 X10 Y0\nR2=0\nG3 X10 Y0 I=AC(R2) J=AC(0)\n", 10),
    ],
)
def test_places_may_be_computed(body: str, place: float) -> None:
    assert xs(body)[-1] == place


@pytest.mark.parametrize(("word", "turned"), [("DC(350)", -10), ("ACP(350)", 350), ("ACN(20)", -340), ("DC(20)", 20)])
def test_axes_turn_the_short_way_up_or_down(word: str, turned: float) -> None:
    program = interpret(f"G90 G1 F100\nX5 A={word}\nM30\n", dialect="sinumerik")
    assert np.degrees(program.rotary[-1, 0]) == pytest.approx(turned)


def test_tool_axes_may_be_computed() -> None:
    program = interpret("R1=1\nTRAORI\nG1 X5 A3=R1 C3=R1*1 F100\nM30\n", dialect="sinumerik")
    np.testing.assert_allclose(np.degrees(program.rotary[-1]), [0, 45, 0], atol=1e-9)


def test_dwells_in_turns_of_the_spindle() -> None:
    assert interpret("S60 M3\nG4 S30\nG1 X1 F9\nM30\n", dialect="sinumerik").dwell_time == pytest.approx(30.0)


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("ENDIF\n", "Line 2: ENDIF has no partner"),
        ("IF 1<2\nX1\n", "Line 2: IF has no partner"),
        ("WHILE 1<2\nENDFOR\n", "Line 2: WHILE has no partner"),
        ("FOR X TO\nENDFOR\n", "Line 2: FOR is not read as it stands"),
        ("FOR Q1=1 TO 2\nENDFOR\n", "Line 2: Q1 is no variable"),
        ("DEF STRING[5] NAME\n", "Line 2: DEF STRING.* is not read"),
        ("FOR R1000=1 TO 2\nX5\nENDFOR\n", "Line 2: R1000 is no variable; define it"),
        ("DEF REAL A1\nA1=2 B1=3\n", "Line 3: found 'B1=3' where a variable is set; expected ABC=1"),
        ("DEF REAL FELD[5]\n", "Line 2: found 'FELD.5.' where DEF has a name"),
        ("REPEAT WEG P=2\n", "Line 2: REPEAT WEG leads nowhere"),
        ("REPEAT WEG P=2\nWEG: X1\n", "Line 2: REPEAT WEG leads nowhere: there is no such label before it"),
        ("WEG: X1\nREPEAT WEG ENDE\nENDE: X2\n", "Line 3: REPEAT WEG stands in what it repeats"),
        ("X=7.5 DIV 2\n", "Line 2: DIV is read between whole numbers and INT variables"),
        ("R1=7\nX=R1 DIV 2\n", "Line 3: DIV is read between whole numbers and INT variables, found R1;"),
        ("X=2*7 DIV 2\n", "Line 2: DIV behind another product"),
        ("X=R[2.5]\n", "Line 2: R.2.5. does not exist"),
        ("G90 TRANS X5\n", "Line 2: TRANS stands on a line of its own"),
        ("LOOP\nR1=1\nENDLOOP\n", "the program may not end"),
        ("X=DC(5)\n", r"Line 2: X=DC\( \) is for axes that turn"),
    ],
)
def test_what_cannot_be_followed_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        xs(body)


def test_a_line_sets_several_variables_as_posts_write_their_homes() -> None:
    head = "DEF REAL _X_HOME, _Z_HOME\nG71 G90 FNORM F100\nSETMS(1)\n"
    text = f"{head}_X_HOME=2*(3 - 1) _Z_HOME=-1.5\nG1 X=_X_HOME Z=_Z_HOME\nM30\n"
    program = interpret(text)
    assert (program.end[-1] * 1e3).tolist() == pytest.approx([4, 0, -1.5])
    with pytest.raises(GCodeError, match="Line 4: found 'G0' where a variable is set"):
        interpret(text.replace("_Z_HOME=-1.5\n", "G0\n"))
