"""Which cutter a program means: D that stays in force, T that changes at once, and Mazak's T of the tool after next."""

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode.reading import interpret
from robomill.toolpath.tools import Tool

TOOLS = {n: Tool(n, diameter=d * 1e-3) for n, d in {1: 4.0, 2: 6.0, 9: 8.0}.items()}
"""Radii of 2, 3 and 4 mm."""


def told(text: str, dialect: str = "auto") -> list[list[float]]:
    """X and Y (mm) where each move at feed ends, and the tool that makes it."""
    program = interpret(text, dialect=dialect, tools=TOOLS)
    rows = np.flatnonzero(np.broadcast_to(program.at_feed, len(program)))
    return [[*(program.end[row, :2] * 1e3).round(6).tolist(), int(program.tool[row])] for row in rows]


def test_d_of_a_fanuc_control_stays_in_force_until_another_one() -> None:
    """Left of a cut along +Y lies at less X: by 4 mm with D9, once more without a D, by 2 mm with D1."""
    text = (
        "O0001\nG21 G90\nT1 M6\nS900 M3\nG0 X0 Y0 Z0\nG41 D9 G1 X10. Y0 F100.\nY20.\nG40 X0\n"
        "G41 X10. Y30.\nY40.\nG40 X0\nG41 D1 X10. Y50.\nY60.\nG40 X0\nM30\n"
    )
    ends = [[6, 0, 1], [6, 20, 1], [0, 20, 1], [6, 30, 1], [6, 40, 1], [0, 40, 1], [8, 50, 1], [8, 60, 1], [0, 60, 1]]
    assert told(text) == ends


@pytest.mark.parametrize("line", ["T1 D9", "D9", "T1 M6 D9"])
def test_d_on_a_line_of_its_own_is_that_of_the_g41_that_comes(line: str) -> None:
    found = told(f"G21 G90\n{line}\nG0 X0 Y0\nG41 G1 X10 Y0 F100\nY20\nG40 X0\nM30\n")
    assert [each[:2] for each in found[1:]] == [[6, 20], [0, 20]]
    with pytest.raises(GCodeError, match=r"^Line 2: D has no use here"):
        interpret(f"G21 G90\n{line}\nG0 X0 Y0\nM2\n", dialect="linuxcnc", tools=TOOLS)


def test_t_of_a_sinumerik_that_never_says_m6_changes_the_tool() -> None:
    """Cut along +X at Y-2, then -3 (right of the contour at Y0): the radii of tools 1 and 2."""
    text = "G71 G90\nT1 D1\nS900 M3\nG0 X-5 Y-9\nG42 G1 X0 Y0 F100\nX20\nG40 Y-9\nT2\nG42 X0 Y0\nX-20\nG40 Y9\nM30\n"
    assert [each for each in told(text, "sinumerik") if each[0] in (20, -20) and abs(each[1]) < 9] == [
        [20, -2, 1],
        [-20, 3, 2],
    ]
    changed = told("G71 G90\nT1\nM6\nT2\nG0 X-5 Y0\nG1 X0 Y0 F100\nM30\n", "sinumerik")
    assert changed == [[0, 0, 1]], "with an M6 anywhere T only chooses"


def test_a_tool_that_no_table_names_leaves_the_one_before() -> None:
    """T="..." without a row took the diameter of the tool before."""
    text = 'G71 G90\nT1\nM6\nS900 M3\nG0 X0 Y0\nT="NOBODY"\nM6\nG41 G1 X10 Y0 F100\nY20\nM30\n'
    with pytest.raises(GCodeError, match=r"^Line 8: .*NOBODY"):
        interpret(text, dialect="sinumerik", tools=TOOLS)


def test_two_tools_beside_m6_are_the_one_to_load_and_the_next() -> None:
    """Mazak: T1 T2 M6 loads tool 1 and makes tool 2 ready, which the next M6 loads; T00 makes none ready."""
    text = "O0001\nG21 G90\nT1T2M6\nG0X0Y0\nG1X5.F99\nM6\nG1X6.\nT9T00M6\nG1X7.\nM30\n"
    assert told(text) == [[5, 0, 1], [6, 0, 2], [7, 0, 9]]
    for wrong, dialect in (("T1 T2", "auto"), ("T1 T2 T9 M6", "auto"), ("T1 T2 M6", "linuxcnc")):
        with pytest.raises(GCodeError, match=r"^Line 2: T is given twice"):
            interpret(f"G21\n{wrong}\nG0 X1\n", dialect=dialect)


@pytest.mark.parametrize(
    ("words", "read"),
    [
        ('T="MILL"\nM6', True),
        ("T1\nM6", True),
        ('T="FOO"\nM6', False),
        ('T="FOO"\nM6\nT1\nM6', True),
        ('T="FOO"\nM6\nT="MILL"\nM6', True),
        ('T1\nM6\nT="FOO"', True),  # asked for, while tool 1 is in the spindle
        ('T1\nM6\nT="FOO"\nM6', False),
    ],
)
def test_the_tool_in_the_spindle_needs_a_size_whatever_was_called_before(words: str, read: bool) -> None:
    """Left of x = 0 by its radius of 2 mm."""
    text = f"G17 G90 G71 G54\n{words}\nG0 X0 Y-20 Z0\nG41 G1 X0 Y0 F9\nY50\nG40 X-30\nM30\n"
    tools = {1: Tool(1, 4e-3, name="Mill")}
    if read:
        assert interpret(text, dialect="sinumerik", tools=tools).end[-2, :2] * 1e3 == pytest.approx([-2, 50])
        return
    line = 4 + words.count("\n")
    with pytest.raises(GCodeError, match=f'^Line {line}: tool "FOO" is not in the tool table; add it under that name'):
        interpret(text, dialect="sinumerik", tools=tools)


CUT = "O0001\nG21 G90 S900 M3\nT1 M6\nG0 X0 Y0 Z0\n{}Y20.\n{}G40 X0\nM30\n"


def test_another_d_within_the_contour_is_refused_and_the_same_one_is_heard() -> None:
    """A control changes over to D2 at once; passed over, the rest of the contour was cut with the size before."""
    assert told(CUT.format("G41 D1 G1 X10. Y0 F100.\n", "D1 Y30.\n"), "fanuc")[1:3] == [[8, 20, 1], [8, 30, 1]]
    for other in ("D2", "D0"):
        with pytest.raises(GCodeError, match=rf"^Line 7: {other} changes the cutter while G41 or G42 is on; use G40"):
            told(CUT.format("G41 D1 G1 X10. Y0 F100.\n", f"{other} Y30.\n"), "fanuc")


@pytest.mark.parametrize("start", ["G41 D0 G1 X10. Y0 F100.\n", "D0\nG41 G1 X10. Y0 F100.\n"])
def test_d0_of_a_fanuc_control_is_no_size_at_all(start: str) -> None:
    """Its offset number 0 always means 0; LinuxCNC takes the tool in the spindle, of a radius of 2 mm."""
    assert told(CUT.format(start, ""), "fanuc") == [[10, 0, 1], [10, 20, 1], [0, 20, 1]]
    assert interpret(CUT.format(start, ""), dialect="fanuc").ok, "no table is needed for it"
    if start.startswith("G41"):
        assert told(CUT.format(start, "").replace("O0001", ""), "linuxcnc")[1] == [8, 20, 1]
