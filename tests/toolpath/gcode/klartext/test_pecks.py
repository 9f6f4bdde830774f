"""Cycles 1 and 2 of Heidenhain's older controls, by the heights that their manual gives."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.arrays import FloatArray
from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret


def read(body: str) -> Program:
    return interpret(f"BEGIN PGM Q MM\nTOOL CALL 1 Z S1000 F99\nL X+0 Y+0 Z+10 FMAX M3\n{body}END PGM Q MM\n")


def _long(program: Program) -> FloatArray:
    return np.linalg.norm(np.diff(program.end, axis=0), axis=1) > 1e-9


def moved(program: Program) -> FloatArray:
    """mm: where the moves behind the first one end, without those of no length."""
    return program.end[1:][_long(program)] * 1e3


def feeds(program: Program) -> FloatArray:
    return np.nan_to_num(program.v_f[1:][_long(program)] * 6e4)


OLD = """CYCL DEF 1.0 PECKING
CYCL DEF 1.1 SET UP 2
CYCL DEF 1.2 DEPTH {}
CYCL DEF 1.3 PECKG {}
CYCL DEF 1.4 DWELL 0.5
CYCL DEF 1.5 F150
L X+5 Z+2 FMAX M99
L X+9 FMAX
"""


@pytest.mark.parametrize(
    ("depth", "peck", "heights"),
    [
        (-12, 5, [2, -5, 2, -4.4, -10, 2, -9.4, -12, 2]),
        (-5, 5, [2, -5, 2]),
        (-5, 0, [2, -5, 2]),
        (-0.5, 5, [2, -0.5, 2]),
        (-40, -20, [2, -20, 2, -19.2, -40, 2]),
        (-400, 250, [2, -250, 2, -243, -400, 2]),
    ],
)
def test_pecking_of_old_begins_and_ends_where_the_tool_stands(depth: float, peck: float, heights: list[float]) -> None:
    """It comes back to 0.6 mm above the depth that it had, in a hole of 40 mm to 40 / 50, in one of 400 mm to 7 mm."""
    program = read(OLD.format(depth, peck))
    x, z = moved(program)[:-1, ::2].T
    np.testing.assert_allclose(z, heights, atol=1e-9)
    np.testing.assert_allclose(x, 5.0)
    cuts = [level in (-0.5, -5, -10, -12, -20, -40, -250, -400) for level in heights]
    np.testing.assert_allclose(feeds(program)[:-1], np.where(cuts, 150.0, 0.0))
    assert sum(program.dwell) == pytest.approx(0.5)


def test_tapping_of_old_goes_out_at_its_feed() -> None:
    program = read(
        "CYCL DEF 2.0 TAPPING\nCYCL DEF 2.1 SET UP 3\nCYCL DEF 2.2 DEPTH -12\nCYCL DEF 2.3 DWELL 0\n"
        "CYCL DEF 2.4 F500\nL X+5 Z+3 FMAX\nCYCL CALL\n"
    )
    np.testing.assert_allclose(moved(program)[1:, 2], [-12, 3], atol=1e-9)
    np.testing.assert_allclose(feeds(program)[1:], 500.0)


@pytest.mark.parametrize(
    ("body", "says"),
    [
        (OLD.format(5, 5), "CYCL DEF 1 needs its DEPTH below 0"),
        (OLD.format(0, 5), "CYCL DEF 1 needs its DEPTH below 0"),
        (OLD.format(-5, 5).replace("F150", "F0"), "CYCL DEF 1 needs its DEPTH below 0 and its F above"),
        (OLD.format(-5, 5).replace("1.5 F150", "1.5 FMAX"), "CYCL DEF 1.5 FMAX is not read"),
        (OLD.format(-5, 5).replace("CYCL DEF 1.3 PECKG 5\n", ""), "CYCL DEF 1 has no PECKG"),
        (OLD.format(-5, 5).replace("1.4 DWELL 0.5", "1.7 X 0.5"), "CYCL DEF 1.7 X 0.5 is not read"),
        (OLD.format(-50, 0.001), "CYCL DEF 1 needs more than 10000 pecks"),
    ],
)
def test_pecking_of_old_that_is_not_whole_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        read(body)


HOLE = "Q200=2 Q201=-20 Q206=150 Q203=0 Q204=10 Q211=0"
IN_205 = f"CYCL DEF 205 {HOLE} Q202=8 Q212=0 Q205=0 Q258=0.5 Q259=0.3"
IN_203 = f"CYCL DEF 203 {HOLE} Q202=6 Q210=0 Q212=1 Q205=4 Q208=500"


@pytest.mark.parametrize(
    ("cycle", "heights", "feed_out"),
    [
        # Infeeds of 6, 5, then 4 mm; up by Q256 twice (Q213), the third time out of the hole and back to Q200 above.
        (f"{IN_203} Q213=2 Q256=0.5", [2, -6, -5.5, -11, -10.5, -15, 2, -13, -19, -18.5, -20, 2, 10], 500),
        (f"{IN_203} Q213=1 Q256=0.5", [2, -6, -5.5, -11, 2, -9, -15, -14.5, -19, 2, -17, -20, 2, 10], 500),
        (f"{IN_203} Q213=0 Q256=0.5", [2, -6, 2, -4, -11, 2, -9, -15, 2, -13, -19, 2, -17, -20, 2, 10], 500),
        # Every 3 mm (Q257) of each infeed of 8 mm up by Q256; back to Q258 above the first depth, Q259 above the last.
        (
            f"{IN_205} Q257=3 Q256=0.2",
            [2, -3, -2.8, -6, -5.8, -8, 2, -7.5, -11, -10.8, -14, -13.8, -16, 2, -15.7, -19, -18.8, -20, 10],
            0,
        ),
        (f"{IN_205} Q257=8 Q256=0.2", [2, -8, 2, -7.5, -16, 2, -15.7, -20, 10], 0),
        (f"{IN_205} Q257=0 Q256=0.2", [2, -8, 2, -7.5, -16, 2, -15.7, -20, 10], 0),
    ],
)
def test_chips_are_broken_and_brought_out_where_the_manual_says(cycle: str, heights: list, feed_out: float) -> None:
    """Heights by hand, of a hole of 20 mm. Down to a depth at Q206; out at Q208 (203) or rapid, up by Q256 at rapid."""
    program = read(f"{cycle}\nL X+5 FMAX M99\n")
    x, z = moved(program)[1:, ::2].T
    np.testing.assert_allclose(z, heights, atol=1e-9)
    np.testing.assert_allclose(x, 5.0)
    before = np.array([10.0, *heights[:-1]])
    again = np.isclose(z, 2.0) & (before < 0.0)
    down = (z < before) & (z < np.minimum.accumulate(before))
    down[0] = False  # to the set-up clearance
    np.testing.assert_allclose(feeds(program)[1:], np.where(down, 150.0, np.where(again, feed_out, 0.0)))


@pytest.mark.parametrize(("often", "fits"), [(0.0021, True), (0.0019, False)])
def test_so_many_breaks_and_no_more_are_made(often: float, fits: bool) -> None:
    """20 mm in steps of 0.002 mm are ten thousand."""
    cycle = f"CYCL DEF 205 {HOLE} Q202=20 Q212=0 Q205=0 Q258=0.5 Q259=0.3 Q257={often} Q256=0.2\nL X+5 FMAX M99\n"
    if fits:
        assert (np.diff(moved(read(cycle))[:, 2]) > 0.0).sum() == round(20 / often - 0.5) + 1
        return
    with pytest.raises(GCodeError, match="CYCL DEF 205 needs more than"):
        read(cycle)


@pytest.mark.parametrize("number", [207, 209])
def test_a_tap_without_a_pitch_is_refused(number: int) -> None:
    """Q239: with one it goes that far a turn, 1000 of them a minute."""
    tap = f"CYCL DEF {number} Q200=2 Q201=-8 Q239={{}} Q203=0 Q204=10 Q257=0 Q256=0 Q336=0\nL X+5 FMAX M99\n"
    program = read(tap.format(1.25))
    assert program.v_f[program.thread].max() * 6e4 == pytest.approx(1250.0)
    with pytest.raises(GCodeError, match="Q239"):
        read(tap.format(0))
