"""Canned cycles as Fanuc counts them, with the holes that they make."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret


def read(body: str) -> Program:
    return interpret(f"G21 G90 S100 M3 F100\nG0 X0 Y0 Z10\n{body}G80\nM30\n", dialect="fanuc")


def holes(body: str) -> list[tuple[float, ...]]:
    program = read(body)
    return [tuple(row) for row in (np.round(program.end[program.kind == 1] * 1e3, 9) + 0.0).tolist()]


@pytest.mark.parametrize("word", ["K3", "L3"])
def test_k_repeats_as_l_does(word: str) -> None:
    assert holes(f"G91 G99 G81 X10 Z-5 R-8 {word}\n") == [(10, 0, -3), (20, 0, -3), (30, 0, -3)]


@pytest.mark.parametrize("word", ["K0", "L0"])
def test_no_time_at_all_keeps_the_cycle_for_the_next_line(word: str) -> None:
    assert holes(f"G99 G81 X10 Z-5 R2 {word}\nX20\nY5\n") == [(20, 0, -5), (20, 5, -5)]


def test_a_dwell_may_be_left_out() -> None:
    assert holes("G99 G82 X10 Z-5 R2\nG89 X20 Z-4 R2\n") == [(10, 0, -5), (20, 0, -4), (20, 0, 2)]
    assert read("G99 G82 X10 Z-5 R2 P500\nX20\n").dwell_time == pytest.approx(1.0)


def test_fine_boring_goes_down_at_feed_and_out_at_rapid() -> None:
    program = read("G99 G76 X10 Z-5 R2 Q0.2 P500\nX20\n")
    assert [f.line for f in program.findings if f.code == "fine-boring"] == [3]
    assert holes("G99 G76 X10 Z-5 R2 Q0.2 P500\nX20\n") == [(10, 0, -5), (20, 0, -5)]


def test_back_boring_is_refused_by_name() -> None:
    with pytest.raises(GCodeError, match="Line 3: G87 bores from below on a Fanuc control, which is not read"):
        read("G87 X10 Z-5 R-20 Q1\n")
