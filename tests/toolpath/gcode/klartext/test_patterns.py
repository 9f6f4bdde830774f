"""Patterns of holes in Heidenhain's dialogue, their places reckoned by hand."""

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode.program import FEED, TRAVERSE, Program
from robomill.toolpath.gcode.reading import interpret

HEAD = (
    "BEGIN PGM A MM\nTOOL CALL 1 Z S900 F300\nL X+0 Y+0 Z{z} R0 FMAX\n"
    "CYCL DEF 200 Q200=2 Q201=-10 Q206=150 Q202=10 Q210=0 Q203=+1 Q204=50 Q211=0\n"
)
ROOT3 = 3.0**0.5


def drilled(body: str, z: float = 80.0) -> tuple[list[list[float]], Program]:
    """X, Y and the depth (mm) of each hole."""
    program = interpret(f"{HEAD.format(z=z)}{body}\nCYCL CALL PAT FMAX M3\nEND PGM A MM\n")
    ends = program.end[program.kind == FEED] * 1e3
    return (ends.round(9) + 0.0).tolist(), program


PATTERNS = {
    "PATTERN DEF POS1 (X+10 Y+20 Z+0)": [[10, 20, -9]],
    "PATTERN DEF POS1 (X+10 Y-20 Z+0) POS2 (X+30 Y+20 Z+4)": [[10, -20, -9], [30, 20, -5]],
    "PATTERN DEF~\n POS1 (X+10 Y-20) ~\n ROW1 (X+5 Y+6 D+8 NUM3 ROT+90 Z-1)": [
        [10, -20, -9],
        *([5, y, -10] for y in (6, 14, 22)),
    ],
    "Q5=8\nPATTERN DEF ROW1 (X+Q5 Y+6 D-8 NUM2)": [[8, 6, -9], [0, 6, -9]],
    "PATTERN DEF PAT1 (X+1 Y+2 DX+10 DY+5 NUMX2 NUMY3 ROT+0 ROTX+0 ROTY+0 Z+0)": [
        [x, y, -9] for x in (1, 11) for y in (2, 7, 12)
    ],
    "PATTERN DEF PAT1 (X+1 Y+2 DX+10 DY+5 NUMX2 NUMY2 ROT+90)": [[x, y, -9] for x in (1, -4) for y in (2, 12)],
    "PATTERN DEF FRAME1 (X+0 Y+0 DX+10 DY+5 NUMX3 NUMY3 ROT+0)": [
        [x, y, -9] for x in (0, 10, 20) for y in (0, 5, 10) if (x, y) != (10, 5)
    ],
    "PATTERN DEF CIRC1 (X+50 Y+0 D20 START+90 NUM4 Z+0)": [[50, 10, -9], [40, 0, -9], [50, -10, -9], [60, 0, -9]],
    "PATTERN DEF CIRC1 (X+50 Y+0 D20 NUM4)": [[60, 0, -9], [50, 10, -9], [40, 0, -9], [50, -10, -9]],
    "PATTERN DEF PITCHCIRC1 (X+50 Y+0 D20 START+0 STEP-30 NUM2)": [[60, 0, -9], [50 + 5 * ROOT3, -5, -9]],
}
"""The surface lies at Q203 = 1 and the place's Z above it, the holes are 10 deep."""


@pytest.mark.parametrize("pattern", PATTERNS)
def test_a_pattern_is_drilled_at_its_places(pattern: str) -> None:
    found, program = drilled(pattern)
    expected = np.array(PATTERNS[pattern], dtype=float)
    np.testing.assert_allclose(np.array(sorted(found)), expected[np.lexsort(expected.T[::-1])], atol=1e-6)
    assert (program.n_s[program.kind == FEED] == 15.0).all(), "M3 stands on the line that calls"


@pytest.mark.parametrize(("z", "between"), [(80.0, 80.0), (5.0, 51.0)])
def test_between_holes_the_tool_is_at_q204_or_as_high_as_it_was(z: float, between: float) -> None:
    found, program = drilled("PATTERN DEF POS1 (X+10 Y+10) POS2 (X+20 Y+10)", z)
    level = np.hypot(*(program.end - program.start)[:, :2].T) > 0.0
    assert (program.kind[level] == TRAVERSE).all()
    heights = program.end[level, 2] * 1e3
    np.testing.assert_allclose(heights[-2:], between)
    assert len(found) == 2


@pytest.mark.parametrize(
    "pattern",
    [
        "PATTERN DEF",
        "PATTERN DEF POS1 (X+10 Z+0)",
        "PATTERN DEF POS1 (X+10 Y+Q7)",
        "PATTERN DEF POS1 (X+10 Y+1 W+3)",
        "PATTERN DEF STAR1 (X+10 Y+1)",
        "PATTERN DEF ROW1 (X+1 Y+1 D+8 NUM0)",
        "PATTERN DEF ROW1 (X+1 Y+1 D+8 NUM2.5)",
        "PATTERN DEF PAT1 (X+1 Y+2 DX+10 DY+5 NUMX2 NUMY2 ROTX+5)",
        "PATTERN DEF PAT1 (X+1 Y+2 DX+10 DY+5 NUMX2 NUMY2 ROTY-5)",
        "PATTERN DEF PAT1 (X+1 Y+2 DX+10 DY+5 NUMX200 NUMY200)",
        "PATTERN DEF " + "ROW1 (X+1 Y+1 D+8 NUM9000) " * 2,
    ],
)
def test_a_pattern_that_is_not_read_is_refused(pattern: str) -> None:
    with pytest.raises(GCodeError, match=r"^Line 5: "):
        drilled(pattern)
    with pytest.raises(GCodeError, match=r"^Line 6: CYCL CALL PAT"):
        drilled("; nothing")


@pytest.mark.parametrize(
    ("pattern", "holes"),
    [
        ("ROW1 (X+1 Y+1 D+8 NUM{})", 6),
        ("CIRC1 (X+50 Y+0 D20 START+90 NUM{})", 6),
        ("PAT1 (X+1 Y+2 DX+10 DY+5 NUMX{} NUMY1)", 6),
        ("PAT1 (X+1 Y+2 DX+10 DY+5 NUMX3 NUMY{})", 2),
        ("FRAME1 (X+1 Y+2 DX+10 DY+5 NUMX{} NUMY2)", 3),
    ],
)
def test_a_pattern_has_one_hole_to_as_many_as_are_said(monkeypatch: pytest.MonkeyPatch, pattern: str, holes: int):
    """The last count that fits, the first that does not."""
    monkeypatch.setattr("robomill.toolpath.gcode.klartext.patterns.MOST_HOLES", 6)
    assert len(drilled(f"PATTERN DEF {pattern.format(1)}")[0]) >= 1
    assert len(drilled(f"PATTERN DEF {pattern.format(holes)}")[0]) == 6
    with pytest.raises(GCodeError, match="6"):
        drilled(f"PATTERN DEF {pattern.format(holes + 1)}")


@pytest.mark.parametrize(("z", "up"), [(80.0, []), (4.0, []), (3.0, []), (2.0, [51.0]), (-5.0, [51.0])])
def test_a_call_at_a_place_goes_up_first_where_the_tool_stands_too_low(z: float, up: list[float]) -> None:
    """Below the set-up clearance, 2 mm above the surface at 1 mm, it would run into the part on its way across."""
    program = interpret(f"{HEAD.format(z=z)}CYCL CALL POS X+10 Y+20 Z+0 FMAX M3\nEND PGM A MM\n")
    ways = program.end - program.start
    aside = np.hypot(ways[:, 0], ways[:, 1]) > 0.0
    assert aside.sum() == 1
    first = int(np.argmax(aside))
    level = up[-1] if up else z
    np.testing.assert_allclose(program.end[first] * 1e3, [10, 20, level], atol=1e-9)
    assert (program.kind[: first + 1] == TRAVERSE).all()
    moved = np.abs(ways[:first, 2]) > 0.0
    np.testing.assert_allclose(program.end[:first][moved, 2][1:] * 1e3, up, atol=1e-9)
    np.testing.assert_allclose(program.end[program.kind == FEED] * 1e3, [[10, 20, -9]], atol=1e-9)
