"""The toolpath as a value, and tables of lines."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import ToolpathError
from robomill.toolpath.path import toolpath_from_lines


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
