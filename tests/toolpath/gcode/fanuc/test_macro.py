"""Macro B: each program with the places along X that Python finds for it."""

from __future__ import annotations

import math

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret

HEAD = "%\nO0001\nG21 G90 G1 F100\n"


def xs(body: str, dialect: str = "auto") -> list[float]:
    return [round(float(x) * 1e3, 9) for x in interpret(f"{HEAD}{body}M30\n%\n", dialect=dialect).end[1:, 0]]


RUN = [
    ("#1=1\nN5 X#1\n#1=#1+1\nIF [#1 LE 4] GOTO 5\nX9\n", [1, 2, 3, 4, 9]),
    ("#100=0\nWHILE [#100 LT 3] DO 1\n#100 = #100 + 1 (on)\nX#100\nEND 1\nX9\n", [1, 2, 3, 9]),
    ("WHILE [1 LT 0] DO1\nX5\nEND1\nX9\n", [9]),
    ("#1=0\nWHILE[#1LT2]DO1\n#1=#1+1\n#2=0\nWHILE[#2LT2]DO2\n#2=#2+1\nX[#1*10+#2]\nEND2\nEND1\n", [11, 12, 21, 22]),
    ("#1=0\nDO1\n#1=#1+1\nX#1\nIF[#1GE3]GOTO9\nEND1\nN9 X9\n", [1, 2, 3, 9]),
    ("#1=0\nWH[#1LT2]DO1\n#1=#1+1\nX#1 (SI[90] GO9)\nEN1\nIF[#1EQ2]GO9\nX5\nN9 X[SQ[81]]\n", [1, 2, 9]),
    ("IF[1EQ1]TH#2=RO[1.6]+FI[1.6]+CO[60]\nX#2\n", [3.5]),
    ("GOTO 20\nX1\nN20 X2\n", [2]),
    ("#3=20\nGOTO #3\nX1\nN20 X2\nGOTO [#3+10]\nX3\nN30 X4\n", [2, 4]),
    ("#1=3\nIF [#1 EQ 3] THEN #2=7\nIF [#1 EQ 4] THEN #2=8\nX#2\n", [7]),
    ("#1=2*3+4\n#[#1]=5-#1/2\nX#10\nX[#1 MOD 4]\nX-#1\n", [0, 2, -10]),
    ("N10 #5=SQRT[16]+FIX[2.7]\nX#5\n", [6]),
]


@pytest.mark.parametrize(("body", "places"), RUN)
@pytest.mark.parametrize("dialect", ["auto", "fanuc"])
def test_branches_and_loops_are_followed(body: str, places: list[float], dialect: str) -> None:
    assert xs(body, dialect) == places


def test_controls_cut_towards_zero_and_linuxcnc_downwards() -> None:
    """Fanuc, Custom Macro B: FIX[-1.2] is -1, FUP[-1.2] is -2, and a remainder has the sign of what is divided."""
    body = "#1=FIX[-1.2]\nX#1\n#1=FUP[-1.2]\nX#1\n#1=[-7] MOD 3\nX#1\n#1=FIX[1.8]+FUP[1.2]+[7 MOD 3]\nX#1\n"
    assert xs(body, "fanuc") == [-1, -2, -1, 4]
    linuxcnc = "G21\n#1=FIX[-1.2]\nG0 X#1\n#1=FUP[-1.2]\nX#1\n#1=[[-7] MOD 3]\nX#1\nM2\n"
    assert (interpret(linuxcnc, dialect="linuxcnc").end[:, 0] * 1e3).tolist() == pytest.approx([-2, -1, 2])
    assert (interpret("G71\nG0 X=TRUNC(-1.7)\nM30\n", dialect="sinumerik").end[:, 0] * 1e3).tolist() == [-1]


def test_fanuc_s_logical_operators_go_bit_by_bit() -> None:
    """Fanuc, Custom Macro B: AND, OR and XOR are of binary numbers, bit by bit; LinuxCNC's of true and false."""
    body = "#1=6 AND 3\nX#1\n#1=6 OR 3\nX#1\n#1=6 XOR 3\nX#1\n"
    body += "IF[[#1 AND 2]EQ 0]GOTO 9\nX99.\nN9 X[[1 EQ 1] AND [2 GT 1]]\n"
    assert xs(body, "fanuc") == [2, 7, 5, 1]
    linuxcnc = "G21\nG0 X[6 AND 3]\nX[6 XOR 3]\nM2\n"
    assert (interpret(linuxcnc, dialect="linuxcnc").end[:, 0] * 1e3).tolist() == pytest.approx([1, 0])
    with pytest.raises(GCodeError, match=r"Line 4: "):
        xs("X[2.5 AND 1]\n", "fanuc")


@pytest.mark.parametrize("value", [-1.0, -0.7, -0.2, 0.0, 0.2, 0.7, 1.0])
def test_a_control_cuts_to_the_whole_number_nearer_to_zero_or_farther_from_it(value: float) -> None:
    nearer, farther = math.trunc(value), math.copysign(math.ceil(abs(value)), value)
    assert xs(f"#1=FIX[{value}]\nX#1\n#1=FUP[{value}]\nX#1\n", "fanuc") == [nearer, farther]


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("GOTO 7\n", "Line 4: GOTO 7 leads nowhere: no line has the number N7"),
        ("IF [1 EQ 1] X5\n", "Line 4: found 'x5' after the condition of IF; expected GOTO or THEN"),
        ("IF [1 EQ 1] THEN X5\n", "Line 4: THEN sets variables"),
        *(
            (f"IF [1 EQ 1] THEN #2=3 {word}\n", "Line 4: THEN sets variables")
            for word in ("X5", "M8", "G91", "M77", "G333")
        ),
        ("WHILE [1 EQ 1] DO1\nX5\n", "Line 4: WHILE ... DO and END do not match here"),
        ("#1=1\nWHILE [#1 GT 0] DO1 #1=#1-1\nX1\nEND1\n", "Line 5: found '#1=#1-1' behind GOTO, DO or END"),
        ("WHILE [0 EQ 1] DO1 X5\nEND1\n", "Line 4: found 'x5' behind GOTO, DO or END"),
        ("GOTO 7 X5\nN7 X1\n", "Line 4: found 'x5' behind GOTO"),
        ("X1\nEND1\n", "Line 5: WHILE ... DO and END do not match here"),
        ("IF [#0 LT 1] GOTO 5\nN5\n", "#0 does not exist"),
        (
            "#13001=16.\n",
            "parameters run from 1 to 5601, and those of a control beyond, such as tool offsets, cannot be set",
        ),
        ("N5 X1\nGOTO 5\n", "loops took longer than 1.3 s after "),
    ],
)
def test_what_leads_nowhere_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError) as caught:
        xs(body)
    assert says in str(caught.value)


def test_then_sets_several_variables_or_none() -> None:
    assert xs("IF [1 EQ 1] THEN #2=3 #4=5\nX[#2+#4]\n") == xs("X8\n")
    assert xs("#2=1\nIF [1 EQ 2] THEN #2=3 M77\nX#2\n") == xs("X1\n")


def test_stated_as_linuxcnc_s_there_is_no_macro_b() -> None:
    for body in ("GOTO 20\nN20 X2\n", "#1=2+3\nX#1\n"):
        with pytest.raises(GCodeError):
            xs(body, "linuxcnc")
