"""Drilling, tapping and patterns of holes of Heidenhain's dialogue: every move as the manual's sequence has it."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret

HEAD = "BEGIN PGM Q MM\nTOOL CALL 1 Z S1000 F99\nL X+0 Y+0 Z+10 FMAX M3\n"


def read(body: str) -> Program:
    return interpret(f"{HEAD}{body}END PGM Q MM\n")


def ends(body: str) -> list[list[float]]:
    return (np.round(read(body).end[1:] * 1e3, 6) + 0.0).tolist()


def test_a_hole_may_begin_on_the_surface() -> None:
    """Q200=0, as countersinks in a shop have it: down to the surface at rapid, in 1 mm and back by Q204."""
    cycle = "CYCL DEF 200 SINK ~\n Q200=+0 ~\n Q201=-1 ~\n Q206=30 ~\n Q202=1 ~\n Q203=-3.5 ~\n Q204=20\n"
    assert [row[2] for row in ends(f"{cycle}L X+1 Y+0 FMAX M99\n")] == [10, -3.5, -4.5, 16.5]


DRILL = "CYCL DEF 200 HOLE ~\n  Q200=2 ;CLEARANCE ~\n  Q201=-6 ~\n  Q206=+120 ~\n  Q202=4 ~\n  Q203=+1 ~\n  Q204=8\n"


def test_drilling_where_m99_leads() -> None:
    """Surface 1: clear at 3, pecks to -3 (and back to 2 above that), bottom at -5, back to 9."""
    program = read(f"{DRILL}L X+5 Y+5 FMAX M99\nL X+15 FMAX M99\n")
    heights = (np.round(program.end[1:7, 2] * 1e3, 6)).tolist()
    assert heights == [10, 3, -3, 3, -1, -5]
    assert program.end[7, 2] * 1e3 == pytest.approx(9)
    drilled = program.end[(program.kind == 1) & (program.end[:, 2] < -4.9e-3), :2] * 1e3
    np.testing.assert_allclose(drilled, [[5, 5], [15, 5]])
    np.testing.assert_allclose(program.v_f[program.kind == 1] * 6e4, 120.0)


@pytest.mark.parametrize(
    "body",
    [
        f"{DRILL}L X+5 Y+5 FMAX\nCYCL CALL M3\nL X+15 FMAX\nCYCL CALL\n",
        f"L X+5 Y+5 FMAX\n{DRILL}L FMAX M99\nL X+15 FMAX M99\n",
        f"{DRILL}CYCL CALL POS X+5 Y+5 Z+0 FMAX\nCYCL CALL POS X+15 Y+5 Z+0 FMAX\n",
        f"{DRILL}L X+5 Y+5 FMAX M89\nL X+15 FMAX M99\nL X+50 FMAX\n",
        DRILL.replace("~", "") + "L X+5 Y+5 FMAX M99\nL X+15 FMAX M99\n",
    ],
)
def test_a_cycle_is_called_in_many_ways(body: str) -> None:
    program = read(body)
    drilled = program.end[(program.kind == 1) & (program.end[:, 2] < -4.9e-3), :2] * 1e3
    np.testing.assert_allclose(drilled, [[5, 5], [15, 5]])


def test_a_called_position_shifts_the_cycle_by_its_z_and_is_gone_to_in_the_plane_first() -> None:
    """TNC 640, Cycle Programming, CYCL CALL POS: the coordinate in the tool axis is an additional datum shift."""
    program = read(f"{DRILL}CYCL CALL POS X+5 Y+0 Z-2 FMAX\nCYCL CALL POS X+15 Y+0 Z+0 FMAX M3\nL X+9 FMAX M99\n")
    moves = np.column_stack([program.kind, np.round(program.end * 1e3, 6)[:, [0, 2]]]).tolist()
    first = [[0, 5, 10], [0, 5, 1], [1, 5, -5], [0, 5, 1], [0, 5, -3], [1, 5, -7], [0, 5, 7]]
    assert moves[1:8] == first
    assert moves[8:10] == [[0, 15, 7], [0, 15, 3]]
    assert moves[12] == [0, 15, -1]
    assert min(z for _, x, z in moves if x == 9) == -5
    with pytest.raises(GCodeError, match="Line [0-9]+: CYCL CALL POS has IZ"):
        read(f"{DRILL}CYCL CALL POS X+5 Y+0 IZ-2 FMAX\n")


def test_tapping_goes_by_its_pitch() -> None:
    program = read("CYCL DEF 207 TAPPING ~\nQ200=2 ~\nQ201=-8 ~\nQ239=+1.5 ~\nQ203=+0 ~\nQ204=5\nL X+1 FMAX M99\n")
    assert program.thread[program.kind == 1].all()
    np.testing.assert_allclose(program.v_f[program.kind == 1] * 6e4, 1500.0)


def test_a_drill_that_leaves_at_rapid_says_so_by_max() -> None:
    """Q208= MAX, as posts write it, is the default: out of the hole at rapid."""
    cycle = "CYCL DEF 203 ~\nQ200=2 ~\nQ201=-4 ~\nQ206=150 ~\nQ202=0 ~\nQ203=0 ~\nQ204=5 ~\nQ208= {}\nL X+1 FMAX M99\n"
    for value, height in (("MAX ;RETRACTION", -4.0), ("500", 2.0)):
        program = read(cycle.format(value))
        assert program.end[program.kind == 1, 2][-1] * 1e3 == pytest.approx(height)


RAPID = 0.0
TABLE = {
    # what is said beside the common words: depths of the plunges below the surface, feed down and out, whether it taps
    "200 Q202=3": ([3, 6], 120, RAPID, False),
    "200 Q202=4": ([4], 120, RAPID, False),
    "200 Q202=8": ([], 120, RAPID, False),
    "200 Q202=0 Q212=1 Q208=77 Q239=2": ([], 120, RAPID, False),
    "201 Q208=77": ([], 120, 77, False),
    "201 Q208=0 Q202=3": ([], 120, 120, False),
    "201 Q208=MAX": ([], 120, RAPID, False),
    "202 Q208=250 Q214=1 Q336=0": ([], 120, 250, False),
    "202 Q208=0 Q214=0": ([], 120, 120, False),
    "202 Q208=MAX Q214=4": ([], 120, RAPID, False),
    "203 Q202=3 Q212=0 Q205=0 Q208=500": ([3, 6], 120, 500, False),
    "203 Q202=3 Q212=0.5 Q205=0 Q208=0": ([3, 5.5, 7.5], 120, 120, False),
    "203 Q202=3 Q212=0.5 Q205=2.25 Q208=MAX": ([3, 5.5, 7.75], 120, RAPID, False),
    "203 Q202=3 Q212=2 Q205=0 Q208=99999": ([3, 5, 7], 120, RAPID, False),
    "205 Q202=3 Q212=0.5 Q205=2": ([3, 5.5, 7.5], 120, RAPID, False),
    "205 Q202=3 Q212=0.5 Q205=2 Q258=0.5 Q259=0.9": ([3, 5.5, 7.5], 120, RAPID, False),
    "205 Q202=5 Q212=0 Q205=2 Q208=0": ([5], 120, 120, False),
    "205 Q202=5 Q212=0 Q205=2 Q208=300": ([5], 120, 300, False),
    "206 Q208=77 Q202=3 Q239=2": ([], 120, 120, True),
    "207 Q239=+1.5": ([], 1500, 1500, True),
    "207 Q239=-1.25": ([], 1250, 1250, True),
    "209 Q239=2 Q202=3": ([], 2000, 2000, True),
    "240 Q343=0 Q202=3 Q239=2 Q208=77": ([], 120, RAPID, False),
}


@pytest.mark.parametrize("unit", ["MM", "INCH"])
@pytest.mark.parametrize("name", TABLE)
def test_cycles_move_as_the_manual_says(name: str, unit: str) -> None:
    """TNC 640, Cycle Programming: heights about a surface at 1, set-up clearance 2, depth 8, second clearance 9."""
    plunges, down, out, thread = TABLE[name]
    number, *more = name.split(" ")
    cycle = " ~\n".join(
        [f"CYCL DEF {number}", "Q200=2", "Q201=-8", "Q206=120", "Q211=0.5", "Q210=0.25", "Q203=1", "Q204=9", *more]
    )
    head = HEAD.replace("MM", unit).replace("Z+10", "Z+30")
    program = interpret(f"{head}{cycle}\nL X+5 FMAX M99\nEND PGM Q {unit}\n")
    size = {"MM": 1e-3, "INCH": 25.4e-3}[unit]
    tenth = 10.0 if unit == "INCH" and number not in ("207", "209") else 1.0
    expected = [(30.0, RAPID), (3.0, RAPID)]
    for k, depth in enumerate(plunges):  # back into the hole at rapid: not quite to where it was
        near = 0.5 + 0.2 * k if "Q258" in name else 0.0 if number == "205" else 2.0
        expected += [(1.0 - depth, down), (3.0, out), (1.0 - depth + near, RAPID)]
    back = [2 + 3 * k + 2 for k in range(len(plunges))]  # into the hole again, behind Q210 above it
    expected += [(-7.0, down), *([(3.0, out)] if out else []), (10.0, RAPID)]
    np.testing.assert_allclose(program.end[1:, 2] / size, [z for z, _ in expected], atol=1e-9)
    np.testing.assert_allclose(program.v_f[1:] * 60 / size * tenth, [v for _, v in expected], rtol=1e-9)
    assert (program.kind[1:] == [int(v != RAPID) for _, v in expected]).all()
    assert program.thread[1:].tolist() == [thread and v > 0 for _, v in expected]
    waits = [0.0] * len(expected)
    waits[-2 if out else -1] = 0.0 if number in ("207", "209") else 0.5  # these have no Q211
    for k in back if number in ("200", "203") else ():
        waits[k] = 0.25
    assert program.dwell[1:].tolist() == waits


@pytest.mark.parametrize(
    ("number", "waits"), [("207 Q239=1", 0.0), ("209 Q239=1", 0.0), ("206", 2.0), ("240 Q343=0", 2.0)]
)
def test_a_dwell_of_an_earlier_cycle_is_that_of_a_later_one_that_has_it(number: str, waits: float) -> None:
    """Q parameters stay; but tapping in step with the spindle (207, 209) knows no Q211: the drilling alone waits."""
    first = "CYCL DEF 200 Q200=2 Q201=-4 Q206=150 Q202=9 Q210=0 Q203=0 Q204=5 Q211=2\nL X+1 FMAX M99\n"
    program = read(f"{first}CYCL DEF {number} Q200=2 Q201=-4 Q206=150 Q203=0 Q204=5\nL X+2 FMAX M99\n")
    assert program.dwell_time == pytest.approx(2.0 + waits)


def test_a_centring_by_its_diameter_is_not_asked_of_the_cycle_behind_it() -> None:
    first = "CYCL DEF 240 Q200=2 Q201=-3 Q343=1 Q206=100 Q203=0 Q204=5\n"
    program = read(f"{first}CYCL DEF 200 Q200=2 Q201=-4 Q206=150 Q202=9 Q210=0 Q203=0 Q204=5 Q211=0\nL X+1 FMAX M99\n")
    assert program.end[:, 2].min() * 1e3 == pytest.approx(-4.0)


def test_a_retraction_feed_of_an_earlier_cycle_is_not_that_of_a_later_one_without() -> None:
    """Cycle 205 knows Q208 since software 34059x-04: older programs do not say it, and leave the hole at FMAX."""
    first = "CYCL DEF 203 Q200=2 Q201=-4 Q206=150 Q202=0 Q203=0 Q204=5 Q208=500\nL X+1 FMAX M99\n"
    program = read(f"{first}CYCL DEF 205 Q200=2 Q201=-4 Q206=150 Q202=0 Q203=0 Q204=5\nL X+2 FMAX M99\n")
    feeds = [np.round(program.v_f[(program.end[:, 0] == x) & (program.kind == 1)] * 6e4) for x in (1e-3, 2e-3)]
    assert [each.tolist() for each in feeds] == [[150, 500], [150]]


@pytest.mark.parametrize(
    ("word", "rpm", "left_out"),
    [("", 0, 0), ("M3", 1000, 0), ("M4", -1000, 0), ("M13", 1000, 0), ("M14", -1000, 0), ("M8", 0, 0), ("M77", 0, 1)],
)
def test_a_call_obeys_the_m_behind_it_as_any_line_does(word: str, rpm: float, left_out: int) -> None:
    """TNC 640: CYCL CALL takes a miscellaneous function, e.g. M3 to switch the spindle on; M13 is M3 and M8."""
    program = read(f"L M5\n{DRILL}CYCL CALL {word}\n")
    down = program.end[:, 2] < -4.9e-3
    assert down.any()
    np.testing.assert_allclose(np.abs(program.n_s[down] * 60), abs(rpm))
    assert sum(f.code == "unknown-m" for f in program.findings) == left_out


PATTERN = {
    "a whole circle": (
        "CYCL DEF 220 ~\nQ216=50 ~\nQ217=50 ~\nQ244=40 ~\nQ245=0 ~\nQ246=360 ~\nQ247=0 ~\nQ241=4\n",
        [[70, 50], [50, 70], [30, 50], [50, 30]],
    ),
    "a quarter, both its ends": (
        "CYCL DEF 220 ~\nQ216=0 ~\nQ217=0 ~\nQ244=40 ~\nQ245=0 ~\nQ246=90 ~\nQ247=0 ~\nQ241=3 ~\nQ301=0\n",
        [[20, 0], [14.142136, 14.142136], [0, 20]],
    ),
    "about another place, by its step": (
        "CYCL DEF 220 ~\nQ216=30 ~\nQ217=-7 ~\nQ244=-40 ~\nQ245=90 ~\nQ246=17 ~\nQ247=-90 ~\nQ241=3\n",
        [[30, 13], [50, -7], [30, -27]],
    ),
    "a whole circle the other way round, from an angle": (
        "CYCL DEF 220 ~\nQ216=1 ~\nQ217=2 ~\nQ244=2 ~\nQ245=90 ~\nQ246=-270 ~\nQ247=0 ~\nQ241=4\n",
        [[1, 3], [2, 2], [1, 1], [0, 2]],
    ),
    "one hole": (
        "CYCL DEF 220 ~\nQ216=1 ~\nQ217=2 ~\nQ244=2 ~\nQ245=0 ~\nQ246=90 ~\nQ247=0 ~\nQ241=1\n",
        [[2, 2]],
    ),
    "three rows, there, back and there": (
        "CYCL DEF 221 ~\nQ225=0 ~\nQ226=0 ~\nQ237=5 ~\nQ238=7 ~\nQ242=2 ~\nQ243=3 ~\nQ224=0\n",
        [[0, 0], [5, 0], [5, 7], [0, 7], [0, 14], [5, 14]],
    ),
    "by its step": (
        "CYCL DEF 220 ~\nQ216=0 ~\nQ217=0 ~\nQ244=40 ~\nQ245=90 ~\nQ246=0 ~\nQ247=-90 ~\nQ241=2\n",
        [[0, 20], [20, 0]],
    ),
    "lines, there and back": (
        "CYCL DEF 221 ~\nQ225=10 ~\nQ226=20 ~\nQ237=5 ~\nQ238=7 ~\nQ242=2 ~\nQ243=2 ~\nQ224=90\n",
        [[10, 20], [10, 25], [3, 25], [3, 20]],
    ),
}


@pytest.mark.parametrize("name", PATTERN)
def test_patterns_drill_at_once(name: str) -> None:
    body, places = PATTERN[name]
    program = read(f"CYCL DEF 200 ~\nQ200=2 ~\nQ201=-10 ~\nQ206=100 ~\nQ203=0 ~\nQ204=20\n{body}")
    drilled = program.end[program.end[:, 2] < -9.9e-3, :2] * 1e3
    np.testing.assert_allclose(drilled, places, atol=1e-6)
    away = program.end[(np.arange(len(program)) > 0) & (program.kind == 0), 2]
    assert away.min() * 1e3 == pytest.approx(2)  # no rapid below the set-up clearance


@pytest.mark.parametrize(("between", "height"), [("", 20), ("Q301=1", 20), ("Q301=0", 2)])
@pytest.mark.parametrize("start", ["L Z+1 FMAX\n", "L Z+30 FMAX\n", "L Z+0 FMAX M91\n"])
def test_between_the_holes_of_a_pattern_the_tool_is_as_high_as_it_says(start: str, between: str, height: int) -> None:
    """TNC 640, cycle 220, Q301: 0 moves at the set-up clearance, 1 at the second one; the last hole ends at that."""
    lines = "CYCL DEF 221 ~\nQ225=10 ~\nQ226=20 ~\nQ237=5 ~\nQ238=7 ~\nQ242=3 ~\nQ243=1 ~\nQ224=0"
    program = read(
        f"{start}CYCL DEF 200 ~\nQ200=2 ~\nQ201=-10 ~\nQ206=100 ~\nQ204=20\n{lines} ~\n{between}\nL Y+1 FMAX\n"
    )
    across = (np.abs(np.diff(program.end[:, 0])) > 1e-9) & (program.kind[1:] == 0)
    heights = program.end[1:][across, 2] * 1e3
    np.testing.assert_allclose(heights[1:], height)
    assert program.end[-1, 2] * 1e3 == pytest.approx(20)
    if "M91" not in start:
        assert heights[0] == pytest.approx(30 if "30" in start else 20)
    else:
        assert program.away[1:][across, 2].tolist() == [True, False, False]  # over the first hole where M91 led to
