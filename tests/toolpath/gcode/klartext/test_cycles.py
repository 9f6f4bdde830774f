"""Which cycles of Heidenhain's dialogue are read, and how much of them at most."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret

DRILLS = (200, 201, 202, 203, 205, 206, 207, 208, 209, 240)
OLD = (1, 2)
SET_AND_LEFT_OUT = (7, 8, 9, 10, 11, 13, 19, 26, 32, 247, 332, 392)
PATTERNS = (220, 221)


def read(body: str) -> Program:
    return interpret(f"BEGIN PGM Q MM\nTOOL CALL 1 Z S1000 F99\nL X+0 Y+0 Z+10 FMAX M3\n{body}END PGM Q MM\n")


def test_no_cycle_is_passed_over_that_may_move() -> None:
    """Of all numbers that a control has, those that are not read are refused by their number."""
    for number in range(1, 400):
        body = f"CYCL DEF {number}.0 NAME\n"
        if number in DRILLS + OLD + SET_AND_LEFT_OUT:
            assert len(read(body)) == 1
        elif number not in PATTERNS:
            with pytest.raises(GCodeError, match=f"CYCL DEF {number} NAME is a cycle that is not read"):
                read(body)


@pytest.mark.parametrize("line", ["L X+5 FMAX", "CC X+0 Y+0", "CALL LBL 1", "TOOL CALL 2 Z"])
def test_a_line_that_a_tilde_joins_to_a_cycle_is_not_swallowed(line: str) -> None:
    with pytest.raises(
        GCodeError, match=f"found '{line.split(' X')[0].split(' LBL')[0].split(' 2')[0]}' among the values"
    ):
        read(f"CYCL DEF 200 DRILLING ~\nQ200=2 ~\nQ201=-5 ~\nQ206=99 ~\n{line}\nL X+9 FMAX\n")


PECKING = "CYCL DEF 1.0 PECKING\nCYCL DEF 1.1 SET UP 2\nCYCL DEF 1.2 DEPTH -12\nCYCL DEF 1.3 PECKG 12\n"


def test_a_feed_of_an_old_cycle_may_be_that_of_the_tool_call() -> None:
    """FAUTO; no depth and no dwell may be AUTO."""
    call = "L X+5 Z+2 FMAX M99\n"
    program = read(f"{PECKING}CYCL DEF 1.5 FAUTO\n{call}")
    assert np.nanmax(program.v_f[program.kind == 1]) * 6e4 == pytest.approx(99.0)
    for part in ("1.2 DEPTH AUTO", "1.3 PECKG AUTO", "1.4 DWELL AUTO"):
        with pytest.raises(GCodeError, match=f"CYCL DEF {part} is not read"):
            read(f"{PECKING}CYCL DEF {part}\nCYCL DEF 1.5 F99\n{call}")


HOLE = "Q200=2 Q201=-20 Q206=150 Q203=0 Q204=10 Q211=0"
PECKED = {
    "200": f"CYCL DEF 200 {HOLE} Q202={{}}\nL X+5 FMAX M99\n",
    "203": f"CYCL DEF 203 {HOLE} Q202={{}} Q212=0 Q205=0 Q208=MAX Q213=0\nL X+5 FMAX M99\n",
    "205": f"CYCL DEF 205 {HOLE} Q202={{}} Q212=0 Q205=0 Q258=0 Q259=0\nL X+5 FMAX M99\n",
    "breaks": f"CYCL DEF 205 {HOLE} Q202=20 Q212=0 Q205=0 Q257={{}} Q256=.2\nL X+5 FMAX M99\n",
    "1": (
        "CYCL DEF 1.0 PECKING\nCYCL DEF 1.1 SET UP 2\nCYCL DEF 1.2 DEPTH -20\nCYCL DEF 1.3 PECKG {}\n"
        "CYCL DEF 1.5 F150\nL X+5 Z+2 FMAX M99\n"
    ),
}


@pytest.mark.parametrize("name", PECKED)
def test_so_many_pecks_and_no_more_are_made(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """A hole of 20 mm in steps of 4 mm has four depths before its bottom, in steps of 3.9 mm five."""
    monkeypatch.setattr("robomill.toolpath.gcode.klartext.pecks.MAX_PECKS", 4)
    for step, pecks in ((20, 0), (10, 1), (4, 4)):
        heights = read(PECKED[name].format(step)).end[:, 2] * 1e3
        assert heights.min() == pytest.approx(-20.0)
        assert (np.diff(heights) > 1e-9).sum() == pecks + 1
    with pytest.raises(GCodeError, match="more than 4"):
        read(PECKED[name].format(3.9))


@pytest.mark.parametrize(
    ("pattern", "most"),
    [
        ("CYCL DEF 220 Q216=0 Q217=0 Q244=40 Q245=0 Q246=360 Q247=0 Q241={}", 6),
        ("CYCL DEF 221 Q225=0 Q226=0 Q237=5 Q238=7 Q242={} Q243=1 Q224=0", 6),
        ("CYCL DEF 221 Q225=0 Q226=0 Q237=5 Q238=7 Q242=1 Q243={} Q224=0", 6),
        ("CYCL DEF 221 Q225=0 Q226=0 Q237=5 Q238=7 Q242=3 Q243={} Q224=0", 2),
    ],
)
def test_a_pattern_repeats_once_to_as_often_as_is_said(monkeypatch: pytest.MonkeyPatch, pattern: str, most: int):
    """The last count that fits, the first that does not."""
    monkeypatch.setattr("robomill.toolpath.gcode.klartext.patterns.MOST_HOLES", 6)
    hole = f"CYCL DEF 200 {HOLE} Q202=0\n"
    drilled = [(read(f"{hole}{pattern.format(n)}\n").end[:, 2] < -19e-3).sum() for n in (1, most)]
    assert drilled == [6 // most, 6]
    for count in (0, most + 1):
        with pytest.raises(GCodeError, match="6"):
            read(f"{hole}{pattern.format(count)}\n")


@pytest.mark.parametrize("number", [200, 201, 203, 205, 206, 240])
def test_a_hole_needs_a_depth_below_its_surface_and_begins_there(number: int) -> None:
    cycle = f"CYCL DEF {number} Q200=2 Q201={{}} Q206=150 Q203=0 Q204=10\nL X+5 FMAX M99\n"
    assert read(cycle.format("-0.5")).end[:, 2].min() == pytest.approx(-0.5e-3)
    for depth in ("0", "0.5", "+20"):
        with pytest.raises(GCodeError, match=f"CYCL DEF {number} needs Q201, its depth, below 0"):
            read(cycle.format(depth))
    for start in ("0.5", "1", "-0.5"):
        with pytest.raises(GCodeError, match="starts below the surface"):
            read(cycle.format(f"-3 Q379={start}"))


@pytest.mark.parametrize("waits", [("0.5", "0.25"), ("-1", "0.25"), ("0.5", "-1"), ("0", "0")])
def test_only_a_dwell_above_nothing_is_waited(waits: tuple[str, str]) -> None:
    """Q211 at the bottom, Q210 above the hole after its one peck."""
    at_bottom, above = waits
    program = read(
        f"CYCL DEF 200 Q200=2 Q201=-8 Q206=150 Q202=4 Q203=0 Q204=10 Q211={at_bottom} Q210={above}\nL X+5 FMAX M99\n"
    )
    assert program.dwell_time == pytest.approx(sum(max(float(each), 0.0) for each in waits))
