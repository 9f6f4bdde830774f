"""Moves as they are kept: blocks that are put away, columns that nobody wrote, lengths and extents against chords."""

from __future__ import annotations

import types

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret, program as programs
from robomill.toolpath.gcode.chords import to_toolpath
from robomill.toolpath.gcode.program import Move, Recorder, Rows


def move(n: int) -> Move:
    row = Move(n)
    row.kind, row.end, row.v_f, row.clockwise = n % 3, [0.1 * n, -n, 2.0 * n], n / 7, n % 2 == 1
    return row


@pytest.mark.parametrize("count", [0, 1, 6, 7, 8, 14, 15, 40])
def test_moves_come_back_as_they_were_put_in(monkeypatch: pytest.MonkeyPatch, count: int) -> None:
    monkeypatch.setattr(programs, "FLUSH", 7)
    recorder = Recorder()
    for n in range(count):
        recorder.add(move(n))
        assert len(recorder) == n + 1
        assert recorder.free()[1] < 7
    columns = recorder.columns()
    assert (len(recorder), {len(column) for column in columns.values()}) == (count, {count})
    expected = [move(n) for n in range(count)]
    for name, column in columns.items():
        np.testing.assert_array_equal(column, np.array([getattr(row, name) for row in expected]).reshape(column.shape))
        assert not column.flags.writeable
    if count:
        assert columns["rotary"].strides[0] == 0  # 0 throughout takes no room
        recorder.add(move(count))
        np.testing.assert_array_equal(recorder.columns()["line"], range(count + 1))


def test_more_moves_than_are_kept_are_refused_by_their_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(programs, "FLUSH", 5)
    monkeypatch.setattr(programs, "MAX_MOVES", 10)
    recorder = Recorder()
    for n in range(14):
        recorder.add(move(n))
    with pytest.raises(GCodeError, match="Line 14: the program makes more than 10 moves") as refused:
        recorder.add(move(14))
    assert refused.value.line == 14
    fits = Recorder()
    for n in range(10):
        fits.add(move(n))
    assert len(fits.columns()["line"]) == 10


def test_a_row_that_is_asked_for_again_is_kept_once() -> None:
    """Rules in plain Python ask for the next row, write it and count it; one that is not counted leaves nothing."""
    machine = types.SimpleNamespace(recorder=Recorder(), moves=99)
    rows = Rows(machine)
    assert (machine.moves, len(rows) > 10**9) == (0, True)
    for n in range(5):
        for again in range(3):
            rows[machine.moves].line = 100 * again + n
        machine.moves += 1
        assert len(machine.recorder) == n
    for _ in range(3):
        rows.keep()
    rows[machine.moves].line = 7
    assert machine.recorder.columns()["line"].tolist() == [200, 201, 202, 203, 204]


WALK = "G21 F60 S60 M3\nG0 X5\nG1 Y4\nG2 X9 Y8 I4 J0 Z2\nG18 G3 X1 Z0 I-4 K-1\nG33.1 Z-3 K1\nG38.3 X40\nG0 Z90\nM2\n"


def test_lengths_are_those_of_the_chords_there_and_back() -> None:
    program = interpret(WALK)
    path = to_toolpath(program, 1e-9)
    walked = np.linalg.norm(np.diff(path.p, axis=0), axis=1)
    by_line = [walked[path.block[1:] == line].sum() for line in program.line]
    np.testing.assert_allclose(program.length, by_line, rtol=1e-6)
    assert program.length[-3] == pytest.approx(2 * 3e-3)


def test_extents_are_those_of_the_moves_at_feed() -> None:
    """Taps count, probing and rapids do not."""
    program, path = interpret(WALK), to_toolpath(interpret(WALK), 1e-9)
    at_feed = np.isin(path.block, program.line[[1, 2, 3, 4]])
    points = np.concatenate([path.p[at_feed], path.p[:-1][at_feed[1:]]])
    low, high = program.extents
    np.testing.assert_allclose(low, points.min(axis=0), atol=1e-8)
    np.testing.assert_allclose(high, points.max(axis=0), atol=1e-8)
    for text in ("G21 G0 X1\nM2\n", "G21 F60\nG38.3 X40\nM2\n"):
        assert interpret(text).extents is None
    straight = interpret("G21 F60\nG0 X7\nG1 X3 Y1\nM2\n").extents
    np.testing.assert_allclose(np.array(straight) * 1e3, [[3, 0, 0], [7, 1, 0]], atol=1e-12)


def test_kinds_are_told_by_name() -> None:
    program = interpret(WALK)
    assert [programs.KINDS[k] for k in program.kind] == ["traverse", "feed", "arc", "arc", "tap", "probe", "traverse"]
    for name in programs.KINDS:
        np.testing.assert_array_equal(program.is_kind(name), [programs.KINDS[k] == name for k in program.kind])


@pytest.mark.parametrize("first", ["G1 F200", "G0", "G1 F9\nG0\nG1 F200", "G1 X0 Y0 Z0 F200"])
def test_what_goes_nowhere_first_is_no_cut(first: str) -> None:
    """Posts state a feed with a bare G1: the tool has not been anywhere yet, and nothing is cut at zero."""
    after = "G0 X50 Y40 Z2\nM3 S900\nG1 Z-1 F200\nX60\nX60\nM2\n"
    with_it, without = (interpret(f"G21 G90\n{head}{after}") for head in (f"{first}\n", ""))
    np.testing.assert_array_equal(with_it.extents, without.extents)
    np.testing.assert_allclose(with_it.extents, [[0.05, 0.04, -0.001], [0.06, 0.04, 0.002]], atol=1e-15)
    path, told = to_toolpath(with_it), to_toolpath(without)
    np.testing.assert_array_equal(path.p, told.p)
    np.testing.assert_array_equal(path.cutting, [False, False, True, True, True])
    assert [f.code for f in with_it.findings] == [f.code for f in without.findings], "and no spindle stands still"


def test_a_program_that_goes_nowhere_cuts_nothing() -> None:
    program = interpret("G21 G1 F200\nG1 F300\nM2\n")
    assert (len(program), program.extents, program.at_feed.any()) == (2, None, False)
    assert not to_toolpath(program).cutting.any()
