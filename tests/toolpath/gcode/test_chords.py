"""Moves as straight pieces: their ends, what stands with which of them, turning axes by rotation matrices."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomill.errors import GCodeError
from robomill.toolpath import arcs
from robomill.toolpath.gcode import chords, interpret
from robomill.toolpath.gcode.chords import to_toolpath, tool_axis

WALK = (
    "G21 F60 S120 M3\nG0 X5\nG1 Y4\nG2 X9 Y8 I4 J0 Z2\nG4 P2\nG1 X20 F30\nS60 M4\nG33.1 Z-3 K1\n"
    "G4 P0.5\nG3 X10 Y18 I-10 J0\nG0 Z9\nM2\n"
)


def corners_within(start: np.ndarray, centre: np.ndarray, sweep: float, chord_error: float) -> int:
    """Multiples of a circle's step, a quarter turn cut into equal parts, that lie between the ends of an arc in XY."""
    across = start - centre
    parts = next(n for n in range(3, 999) if np.hypot(*across[:2]) * (1 - np.cos(np.pi / 4 / n)) <= chord_error)
    begin = np.arctan2(across[1], across[0])
    low, high = sorted((begin, begin + sweep))
    every = np.arange(-8 * parts, 8 * parts) * np.pi / 2 / parts
    return int(((every > low + 1e-6) & (every < high - 1e-6)).sum())


@pytest.mark.parametrize("block", [1, 3, 500_000])
def test_every_move_begins_where_the_one_before_ended_whatever_is_done_at_once(
    monkeypatch: pytest.MonkeyPatch, block: int
) -> None:
    monkeypatch.setattr(chords, "_BLOCK", block)
    program = interpret(WALK)
    path = to_toolpath(program, 1e-5)
    for n, line in enumerate(program.line):
        rows = np.flatnonzero(path.block == line)
        rows = rows[rows > 0]
        np.testing.assert_array_equal(path.p[rows[0] - 1], program.start[n])
        if program.is_kind("tap")[n]:
            np.testing.assert_array_equal(path.p[rows], [program.end[n], program.start[n]])
            continue
        np.testing.assert_array_equal(path.p[rows[-1]], program.end[n])
        if not program.is_kind("arc")[n]:
            assert len(rows) == 1
            continue
        assert len(rows) == 1 + corners_within(program.start[n], program.centre[n], program.sweep[n], 1e-5)
        r = np.linalg.norm((path.p[rows] - program.centre[n])[:, :2], axis=1)
        np.testing.assert_allclose(r, np.linalg.norm((program.start - program.centre)[n, :2]), rtol=1e-9)
        np.testing.assert_allclose(np.diff(path.p[rows[:-1], 2], 2), 0.0, atol=1e-15)
    assert len(path) == 1 + sum((path.block[1:] == line).sum() for line in program.line)


def test_what_stands_with_a_move_stands_with_all_of_its_pieces_and_a_dwell_with_the_first() -> None:
    path = to_toolpath(interpret(WALK), 1e-5)
    first = {line: np.flatnonzero(path.block == line)[0] for line in (3, 4, 6, 8, 10, 11)}
    np.testing.assert_array_equal(path.cutting[1:], ~np.isin(path.block[1:], [2, 11]))
    assert not path.cutting[0]
    for line, feed in ((2, 0), (3, 60), (4, 60), (6, 30), (10, 30), (11, 0)):
        np.testing.assert_allclose(path.v_f[path.block == line][-1] * 60e3, feed)
    np.testing.assert_allclose(path.n_s[path.block == 4], 2.0)
    np.testing.assert_allclose(path.n_s[path.block == 10], 1.0)
    np.testing.assert_array_equal(path.ccw[path.block == 6], False)
    np.testing.assert_array_equal(path.ccw[path.block == 10], True)
    expected = np.zeros(len(path))
    expected[first[6]], expected[first[10]] = 2.0, 0.5
    np.testing.assert_array_equal(path.dwell, expected)
    assert path.counts == (2, 2, 2)
    assert path.block[0] == 2


def test_an_axis_turns_in_steps_of_two_degrees_on_its_way() -> None:
    program = interpret("G21 F60\nG1 X10 A30 B-7\nX20 A90\nX30\nX31 C5\nG0 A0\nM2\n")
    path = to_toolpath(program)
    counts = [int((path.block[1:] == line).sum()) for line in program.line]
    assert counts == [15, 30, 1, 3, 45]
    angles = np.radians([[0, 0, 0], [30, -7, 0], [90, -7, 0], [90, -7, 0], [90, -7, 5], [0, -7, 5]])
    expected = [tool_axis(angles[0])]
    for (a, b), count in zip(pairwise(angles), counts, strict=True):
        expected += [tool_axis(a + (n + 1) / count * (b - a)) for n in range(count)]
    np.testing.assert_allclose(path.k, expected, atol=1e-12)
    np.testing.assert_allclose(np.diff(path.p[:16, 0]), 10e-3 / 15)
    np.testing.assert_allclose(path.p[15], [10e-3, 0, 0])


@pytest.mark.parametrize("since", [0, 3])
def test_the_path_is_the_tips_which_stands_off_the_told_points(since: int) -> None:
    """From a move on another tool is in the spindle: lines, arcs, taps and turns are where its tip goes."""
    program = interpret(WALK.replace("G0 Z9", "G1 X30 A20\nG0 Z9"))
    lift = np.where(np.arange(len(program))[:, None] >= since, [1e-3, -2e-3, 7e-3], 0.0)
    told, path = to_toolpath(program, 1e-5), to_toolpath(replace(program, lift=lift), 1e-5)
    np.testing.assert_array_equal(path.block, told.block)
    moved = np.where(np.isin(path.block, program.line[since:])[:, None], [1e-3, -2e-3, 7e-3], 0.0)
    moved[0] = lift[0]
    np.testing.assert_allclose(path.p, told.p + moved, atol=1e-12)


def test_the_tool_axis_is_that_of_the_rotations() -> None:
    """k = R_x(A) R_y(B) R_z(C) z."""
    for a, b, c in np.random.default_rng(3).uniform(-3, 3, (20, 3)):
        k = Rotation.from_euler("XYZ", [a, b, c]).apply([0, 0, 1])
        np.testing.assert_allclose(tool_axis(np.array([a, b, c])), k, atol=1e-12)


def test_one_arc_does_not_fill_the_memory_by_its_turns() -> None:
    """A turn of 20 mm radius takes 2 pi / (2 acos(1 - 1e-6 / 0.02)) = 314.2 chords, which are 316 with a corner on each
    quarter: 600 500 points are 1900.3 turns."""
    helix = "G21 F60 G17\nG1 X0 Y0\nG1 X20\nG2 X20 Y0 Z-9 I-20 J0 P{}\nM2\n"
    assert len(to_toolpath(interpret(helix.format(1899)))) > 599_000
    with pytest.raises(GCodeError, match=r"the path would need \d+ points; at most 600500 fit. Split the program."):
        to_toolpath(interpret(helix.format(1902)))


def test_too_many_points_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arcs, "MAX_POINTS", 20)
    twenty = "G21 F60\n" + "\n".join(f"G1 X{n + 1}" for n in range(20))
    assert len(to_toolpath(interpret(f"{twenty}\nM2\n"))) == 21
    with pytest.raises(GCodeError, match="the path would need 21 points; at most 20 fit"):
        to_toolpath(interpret(f"{twenty}\nX99\nM2\n"))
    assert len(to_toolpath(interpret("G21 F60\nG1 A40\nM2\n"))) == 21
    with pytest.raises(GCodeError, match="turning axes would need more than 20 points"):
        to_toolpath(interpret("G21 F60\nG1 A42\nM2\n"))
    with pytest.raises(GCodeError, match="found no motion"):
        to_toolpath(interpret("G21\nM2\n"))


def test_a_program_that_stands_still_to_its_end_is_a_path_of_its_moves() -> None:
    assert len(to_toolpath(interpret("G21\nG0 X0 Y0\nM2\n"))) == 2
    assert len(to_toolpath(interpret("G21\nG0 X0 Y0\nG0 X0\nG0 X5\nM2\n"))) == 2
