"""Subprograms of Sinumerik programs with values, variables and modes of their own: places reckoned by hand."""

from __future__ import annotations

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret

HEAD = "G71 G90 G17 F100\nG0 X0 Y0\n"


def places(body: str, subs: str) -> list[tuple[float, float]]:
    program = interpret(f"{HEAD}{body}M30\n{subs}", dialect="sinumerik")
    return [(round(float(x) * 1e3, 6) + 0.0, round(float(y) * 1e3, 6) + 0.0) for x, y, _ in program.end[1:]]


LINE = "%_N_LINE_SPF\nPROC LINE(REAL LEN, REAL WID=3)\nG1 X=LEN Y=WID\nM17\n"


@pytest.mark.parametrize(
    ("body", "subs", "found"),
    [
        # values in order; one that is left out is what PROC says, else 0
        ("LINE(10,5)\n", LINE, [(10, 5)]),
        ("LINE(10)\n", LINE, [(10, 3)]),
        ("LINE(,7)\n", LINE, [(0, 7)]),
        ("LINE\n", LINE, [(0, 3)]),
        ("N10 CALL LINE(2*(3+1),SQRT(16)) P1\n", LINE, [(8, 4)]),
        ("R1=4 R2=6\nLINE(R1+1,-R2)\n", LINE, [(5, -6)]),
        ("EXTERN LINE(REAL,REAL)\nLINE(1,2)\n", LINE, [(1, 2)]),
        ("LINE(1,2)\nX9\nM30\nPROC LINE(REAL LEN, REAL WID)\nG1 X=LEN Y=WID\nRET\n", "", [(1, 2), (9, 2)]),
        # an INT keeps the next whole number, a BOOL 0 or 1
        ("ANY(2.6,7)\n", "PROC ANY(INT NUM, BOOL ON1)\nG1 X=NUM Y=ON1\nM17\n", [(3, 1)]),
        ("DEF INT NUM\nNUM=7/2\nG1 X=NUM\n", "", [(4, 0)]),
        # each subprogram has its own variables, and each repeat its own values
        (
            "DEF REAL LEN=50\nLINE(1,2)\nX=LEN\n",
            LINE,
            [(1, 2), (50, 2)],
        ),
        (
            "DEF REAL AB=5\nOTHER\nX=AB\n",
            "PROC OTHER\nDEF REAL AB=1\nG1 X=AB\nM17\n",
            [(1, 0), (5, 0)],
        ),
        ("UP(1) P2\n", "PROC UP(REAL AB)\nAB=AB+1\nG1 X=AB\nM17\n", [(2, 0), (2, 0)]),
        ("OUTER(3)\n", "PROC OUTER(REAL AB)\nLINE(AB*2,1)\nX=AB\nM17\n" + LINE, [(6, 1), (3, 1)]),
        ("FOR R1=1 TO 2\nLINE(R1,R1)\nENDFOR\n", LINE, [(1, 1), (2, 2)]),
        # VAR is the caller's own variable
        ("DEF REAL AB=5\nADD(AB)\nG1 X=AB\n", "PROC ADD(VAR REAL SUM)\nSUM=SUM+2\nM17\n", [(7, 0)]),
        ("R5=1\nADD(R5)\nG1 X=R5\n", "PROC ADD(VAR REAL SUM)\nSUM=SUM+2\nM17\n", [(3, 0)]),
        # a modal one is called behind every move with the values of its MCALL
        ("MCALL UP(4)\nG0 X1 Y1\nMCALL\nX0\n", "PROC UP(REAL AB)\nG1 Y=AB\nM17\n", [(1, 1), (1, 4), (0, 4)]),
        # SAVE gives modes and frame back, without it they stay
        ("STEP\nX5\n", "PROC STEP SAVE DISPLOF\nG91 G1 X10\nM17\n", [(10, 0), (5, 0)]),
        ("STEP\nX5\n", "PROC STEP\nG91 G1 X10\nM17\n", [(10, 0), (15, 0)]),
        ("STEP(2)\nX5\n", "PROC STEP(REAL AB) SAVE\nTRANS X=AB\nG1 X10\nM17\n", [(12, 0), (5, 0)]),
        ("TRANS X100\nSTEP\nX5\n", "PROC STEP SAVE\nATRANS Y1\nX10 Y0\nM17\n", [(110, 1), (105, 1)]),
    ],
)
def test_values_are_those_of_the_call(body: str, subs: str, found: list[tuple[float, float]]) -> None:
    assert places(body, subs) == found


@pytest.mark.parametrize(
    ("body", "subs", "says"),
    [
        ("LINE(1,2,3)\n", LINE, "Line 3: LINE is called with 3 values; PROC takes 2"),
        ("OUT(1)\n", "PROC OUT(STRING[10] NAME)\nM17\n", "Line 3: PROC OUT has 'STRING.10. NAME', which is not read"),
        ("OUT(1)\n", "PROC OUT(REAL AB\nM17\n", "Line 3: PROC OUT has brackets that do not match"),
        ("OUT()\n", "PROC OUT(VAR REAL AB)\nM17\n", "Line 3: OUT is called without AB, a variable of the caller's"),
        ("OUT(3)\n", "PROC OUT(VAR REAL AB)\nM17\n", "Line 3: 3 is no variable; define it"),
        ("OUT(3)\n", "%_N_OUT_SPF\nX1\nM17\n", r"Line 3: OUT is called with values, but no line PROC OUT\(REAL A"),
        ("LINE(R9)\n", LINE, "Line 3: R9 is read before the program sets it"),
    ],
)
def test_what_cannot_be_given_is_refused(body: str, subs: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        places(body, subs)
