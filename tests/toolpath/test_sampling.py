"""Resampling: corners, length, lines and what begins is kept."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import ToolpathError
from robomill.toolpath.gcode import read_gcode
from robomill.toolpath.path import Toolpath, toolpath_from_lines
from robomill.toolpath.sampling import drawn_back, resample
from robomill.units import format_count


def two_lines():
    return toolpath_from_lines([[0, 0, 0], [0, 0.02, 0]], [[0.01, 0, 0], [0.01, 0.02, 0]], 0.03, 200.0)


@pytest.mark.parametrize("step", [1e-3, 0.7e-3, 3.3e-3, 1.0])
def test_resampling_keeps_corners_length_and_blocks(step: float) -> None:
    path = two_lines()
    fine = resample(path, step)
    assert fine.step_length[fine.cutting].max() <= step * (1 + 1e-9)
    assert fine.s[-1] == pytest.approx(path.s[-1], rel=1e-12)
    for corner in path.p:
        assert (np.abs(fine.p - corner).max(axis=1) == 0).any()
    assert set(fine.block) == set(path.block)


def test_the_tool_axis_turns_on_the_great_circle() -> None:
    path = toolpath_from_lines([[0, 0, 0]], [[0.1, 0, 0]], 0.03, k=[[0, 0, 1.0], [0, 1.0, 0]])
    fine = resample(path, 0.05)
    middle = np.argmin(np.abs(fine.s - 0.05))
    assert fine.k[middle] == pytest.approx([0, np.sqrt(0.5), np.sqrt(0.5)])


@pytest.mark.parametrize("angle", [0.0, 1e-14, 0.01, 0.6, 1.5, 2.9])
def test_an_axis_turns_evenly_with_the_way(angle: float) -> None:
    start, turned = np.array([0.0, 0.0, 1.0]), np.array([np.sin(angle), 0.0, np.cos(angle)])
    path = toolpath_from_lines([[0, 0, 0]], [[0.1, 0, 0]], 0.03, k=[start, turned])
    fine = resample(path, 0.0125)
    told = fine.s / 0.1 * angle
    np.testing.assert_allclose(fine.k, np.column_stack([np.sin(told), 0 * told, np.cos(told)]), atol=1e-9)


def test_pieces_are_as_few_as_the_step_allows() -> None:
    for length, step, pieces in ((0.01, 0.01, 1), (0.01, 0.0099, 2), (0.01, 0.0025, 4), (0.01, 0.00249, 5)):
        fine = resample(toolpath_from_lines([[0, 0, 0]], [[length, 0, 0]], 0.03), step)
        np.testing.assert_allclose(fine.step_length[fine.cutting], [0.0] + [length / pieces] * pieces)


def test_the_step_that_a_refusal_names_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robomill.budgets.samples", lambda: 100)
    with pytest.raises(ToolpathError, match="at most 100 fit, so use ") as refused:
        resample(two_lines(), 1e-4)
    step = float(str(refused.value).split("so use ")[1].split(" mm")[0]) * 1e-3
    assert 50 < len(resample(two_lines(), 1.01 * step)) <= 100


@pytest.mark.parametrize("step", [0.0, -1.0, float("nan"), float("inf")])
def test_a_step_must_be_a_length(step: float) -> None:
    path = two_lines()
    of_moves = np.full(len(path), 0.01)
    assert len(resample(path, of_moves)) == len(resample(path, 0.01))
    of_moves[-1] = step
    for each in (step, of_moves):
        with pytest.raises(ToolpathError, match="expected a length above 0"):
            resample(path, each)


def test_too_fine_a_step_is_refused_with_one_that_fits() -> None:
    with pytest.raises(ToolpathError, match="use .* mm or more"):
        resample(two_lines(), 1e-12)


def test_a_cut_and_a_corner_also_have_a_sample_at_their_start() -> None:
    path = toolpath_from_lines([[0, 0, 0], [0.01, 0, 0]], [[0.01, 0, 0], [0.01, 0.01, 0]], 0.03)
    fine = resample(path, 0.005)
    assert fine.step_length[1:] == pytest.approx([0, 0.005, 0.005, 0, 0.005, 0.005])
    assert fine.block.tolist() == [1, 1, 1, 1, 2, 2, 2]


def test_only_what_begins_or_turns_has_a_sample_at_its_start() -> None:
    # x (mm), cutting: on in one line, a rapid in that line, on, a cut of no length, on, gently round, sharply round
    moves = [
        (10, 0, 1),
        (20, 0, 1),
        (30, 0, 0),
        (40, 0, 1),
        (40, 0, 1),
        (50, 0, 1),
        (60, 0.1, 1),
        (60, 9, 1),
        (60, 20, 1),
    ]
    begins = [True, False, False, True, False, True, False, True, False]
    p = np.array([(0, 0, 0), *((x, y, 0) for x, y, _ in moves)]) * 1e-3
    cutting = np.array([False, *(bool(cut) for _, _, cut in moves)])
    line = np.arange(len(p))
    path = Toolpath(p, np.array([0.0, 0, 1]), np.where(cutting, 0.01, 0.0), cutting, line, np.zeros(1), np.zeros(1))
    fine = resample(path, 1.0)
    expected = [0]
    for i, begin in enumerate(begins, 1):
        expected += [i, i] if begin else [i]
    assert fine.block.tolist() == expected
    assert fine.p[:, 0] * 1e3 == pytest.approx([0, 0, 10, 20, 30, 30, 40, 40, 40, 50, 60, 60, 60, 60], abs=1e-12)


@pytest.mark.parametrize(
    ("slopes", "begins"),
    [
        ((-4, 0, 0), (1, 1, 0)),  # down, and on
        ((0, -4, -2, 0), (1, 1, 0, 1)),
        ((2, -0.6, 0.02), (1, 1, 1)),
        ((-0.4, 0, -0.4), (1, 0, 0)),  # too gentle for a whole end to push
        ((-1, -0.3, 0), (1, 0, 0)),  # and little by little
        ((5, 0, 3), (1, 0, 0)),
    ],
)
@pytest.mark.parametrize("lean", [0.0, 15.0])
def test_where_a_way_down_begins_or_ends_a_sample_stands_at_the_start(
    slopes: tuple[float, ...], begins: tuple[int, ...], lean: float
) -> None:
    """Moves of 10 mm with slopes in degrees against an axis that leans along them."""
    angles = np.radians(np.array(slopes) + lean)
    steps = 10e-3 * np.column_stack([np.cos(angles), 0.0 * angles, np.sin(angles)])
    p = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
    k = np.array([-np.sin(np.radians(lean)), 0.0, np.cos(np.radians(lean))])
    cutting = np.arange(len(p)) > 0
    path = Toolpath(p, k, np.where(cutting, 0.01, 0.0), cutting, np.arange(len(p)), np.zeros(1), np.zeros(1))
    expected = [0]
    for i, begin in enumerate(begins, 1):
        expected += [i, i] if begin else [i]
    sines = (np.sin(np.radians(0.05)), np.sin(np.radians(0.5)))
    assert resample(path, 1.0, sines).block.tolist() == expected
    assert resample(path, 1.0).block.tolist() == [0, 1, *range(1, len(p))]


@pytest.mark.parametrize(("wait", "twice"), [("", False), ("G4 P0.2\n", True), ("G4 P1\n", True)])
def test_a_tool_drawn_straight_back_begins_nothing_unless_it_has_waited(wait: str, twice: bool) -> None:
    """At the bottom of a plunge it is asked once; where it waits there, as it comes and as it leaves."""
    fine = resample(read_gcode(f"G21 F600\nG0 Z5\nG1 Z-3\n{wait}G1 Z5\nM2\n"), 1.0)
    assert np.isclose(fine.p[:, 2], -3e-3).sum() == 1 + twice
    aside = resample(read_gcode(f"G21 F600\nG0 Z5\nG1 Z-3\n{wait}G1 X5\nM2\n"), 1.0)
    assert np.isclose(aside.p[:, 0] + aside.p[:, 2], -3e-3).sum() == 2


@pytest.mark.parametrize("step", [None, 2e-3, 1.0])
@pytest.mark.parametrize("wait", ["", "G4 P0.2\n"])
def test_drawn_back_is_what_goes_up_at_feed_right_behind_a_plunge(wait: str, step: float | None) -> None:
    """Line by line: up in two moves, aside, up again, down at rapid and up, down aslant and up, as resampled or not."""
    up = "G1 Z1\nZ5\nX5\nZ9\nG0 Z-1\nG1 Z6\nX9 Z1\nZ7\nM2\n"
    path = read_gcode(f"G21 F600\nG0 Z5\nG1 Z-3\n{wait}{up}")
    path = path if step is None else resample(path, step)
    ways = np.diff(path.p, axis=0, prepend=path.p[:1])
    first = 4 + bool(wait)
    behind = ~np.isin(path.block, [] if wait else [first, first + 1]) | (np.linalg.norm(ways, axis=1) == 0.0)
    np.testing.assert_array_equal(drawn_back(path), ~behind)


WORDS = [
    *("M3 S600", "G1 X1 F600", "X2", "M5", "X3", "M4", "X4", "G4 P0.5", "G4 P0.25", "G2 X6 I1", "X8 I1"),
    *("M3", "G1 X9", "M4 S0", "X10", "S900", "G0 X11", "G4 P2", "M2"),
]


def test_short_steps_keep_the_sense_and_wait_once() -> None:
    path = read_gcode("\n".join(WORDS))
    fine = resample(path, 1e-4)
    assert fine.dwell.sum() == pytest.approx(path.dwell.sum())
    for line in np.unique(path.block):
        assert set(fine.ccw[fine.block == line]) == set(path.ccw[path.block == line])
    waits = np.flatnonzero(fine.dwell)
    assert (fine.block[waits] != fine.block[waits - 1]).all()


def test_as_many_points_are_allowed_as_are_made(monkeypatch: pytest.MonkeyPatch) -> None:
    """Corners, cuts that begin, rapids and moves of no length: the count that is checked is the count that comes."""
    path = read_gcode("G21 F600\nG0 X1\nG1 Y20\nX20\nX20.5 Y20.01\nG0 Z5\nX0\nG1 Z-1\nX0\nX9\nM2\n")
    made = len(resample(path, 1.7e-3))
    monkeypatch.setattr("robomill.budgets.samples", lambda: made)
    assert len(resample(path, 1.7e-3)) == made
    monkeypatch.setattr("robomill.budgets.samples", lambda: made - 1)
    with pytest.raises(
        ToolpathError, match=f"would need {format_count(made)} points; at most {format_count(made - 1)} fit"
    ):
        resample(path, 1.7e-3)
