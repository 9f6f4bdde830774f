"""The toolpath as a value, tables of lines, and resampling."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import ToolpathError
from robomill.toolpath.path import Toolpath, toolpath_from_lines
from robomill.toolpath.sampling import resample


def two_lines():
    return toolpath_from_lines([[0, 0, 0], [0, 0.02, 0]], [[0.01, 0, 0], [0.01, 0.02, 0]], 0.03, 200.0)


def test_lines_that_do_not_touch_are_joined_by_a_rapid() -> None:
    path = two_lines()
    assert path.cutting.tolist() == [False, True, False, True]
    assert path.block.tolist() == [1, 1, 2, 2]
    assert path.s[-1] == pytest.approx(0.02)
    assert path.t[-1] == pytest.approx(0.02 / 0.03)


def test_lines_that_touch_are_not() -> None:
    path = toolpath_from_lines([[0, 0, 0], [0.01, 0, 0]], [[0.01, 0, 0], [0.01, 0.01, 0]], 0.03)
    assert path.cutting.tolist() == [False, True, True]


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


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (dict(v_f=0.0), "Row 1: feed is 0 mm/min; a cut needs more than 0"),
        (dict(end=[[0.0, 0, 0]]), "Row 1: start and end are the same point"),
        (dict(end=[[np.nan, 0, 0]]), "line ends: expected finite numbers"),
    ],
)
def test_bad_rows_are_named(change: dict, sentence: str) -> None:
    arguments = dict(start=[[0.0, 0, 0]], end=[[0.1, 0, 0]], v_f=0.03) | change
    with pytest.raises(ToolpathError, match=sentence):
        toolpath_from_lines(**arguments)


@pytest.mark.parametrize("step", [0.0, -1.0, float("nan")])
def test_a_step_must_be_a_length(step: float) -> None:
    with pytest.raises(ToolpathError, match="expected a length above 0"):
        resample(two_lines(), step)


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
