"""A path in a few numbers, against plain counting and a fine walk along it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from robomill.toolpath.sampling import resample
from robomill.toolpath.source import GCodeSource
from robomill.toolpath.summary import distinct, middle_of_cut, summary_of


def test_the_summary_is_what_plain_counting_says() -> None:
    path = GCodeSource(
        "G21 G90\nS1000 M3\nG0 Z5\nG1 Z-1 F600\nG1 X3 Y1\nX9 Y4\nX2 Y7\nG0 Z5\nX0\nG1 Z-1 F600\nY-3\nG0 Z5\nM2\n"
    ).read()
    summary = summary_of(path)
    assert summary.moves == len(path) - 1
    assert summary.cuts == sum(bool(c) for c in path.cutting)
    assert summary.blocks == len({int(b) for b, c in zip(path.block, path.cutting, strict=True) if c})
    assert summary.rapids == pytest.approx(
        sum(float(s) for s, c in zip(path.step_length, path.cutting, strict=True) if not c)
    )
    assert summary.feeds == pytest.approx((0.01, 0.01))
    assert summary.spindles == pytest.approx((1000 / 60, 1000 / 60))


def test_spindle_speeds_are_those_of_cuts_where_they_are_known() -> None:
    """The first rapid turns slower than any cut, the last one faster, and of one cut the speed is not known."""
    path = GCodeSource("G21 G90\nS100 M3\nG0 X1 Z5\nS1000\nG1 X3 F600\nX9\nS2000\nY4\nS9000\nG0 Z5.5\nM2\n").read()
    assert summary_of(path).spindles == pytest.approx((1000 / 60, 2000 / 60))
    n_s = np.where(path.p[:, 1] > 3e-3, np.nan, path.n_s)
    assert summary_of(replace(path, n_s=n_s)).spindles == pytest.approx((1000 / 60, 1000 / 60))
    assert summary_of(replace(path, n_s=0.0 * path.n_s)).spindles is None


def test_the_tools_of_a_path_are_named_once_and_its_corners_are_those_of_its_cuts() -> None:
    """Tool 3 only travels; before the first change there is none."""
    text = "G21 G90\nS99 M3\nG0 X-50 Z5\nT9 M6\nG1 X1 Y2 Z-1 F6\nT1 M6\nG1 X4 Y-3\nT9 M6\nX5\nT3 M6\nG0 Z90\nM2\n"
    summary = summary_of(GCodeSource(text).read())
    assert summary.tools == (1, 3, 9)
    np.testing.assert_allclose(summary.low * 1e3, [-50, -3, -1], atol=1e-9)
    np.testing.assert_allclose(summary.high * 1e3, [5, 2, 5], atol=1e-9)


def test_distinct_values_by_counting_are_those_by_sorting() -> None:
    rng = np.random.default_rng(0)
    for values in (
        rng.integers(0, 50, 1000),
        rng.integers(-5, 5, 99),
        np.array([7, 10**12]),
        np.empty(0, dtype=np.int64),
    ):
        np.testing.assert_array_equal(distinct(values), np.unique(values))


def test_the_middle_of_a_cut_is_the_mean_of_many_points_along_it() -> None:
    """Rapids do not count, however far they go; a long line counts more than a short one."""
    path = GCodeSource("G21 G90\nG0 X0 Y0 Z5\nG1 Z-1 F600\nX30 Y10\nX31\nG0 Z50\nX400\nZ5\nG1 Z-2\nY80\nM2\n").read()
    fine = resample(path, 1e-5)
    ends = np.flatnonzero(fine.cutting)
    np.testing.assert_allclose(middle_of_cut(path), (0.5 * (fine.p[ends] + fine.p[ends - 1])).mean(axis=0), atol=1e-4)
    assert middle_of_cut(GCodeSource("G21 G90\nG0 X0 Y0 Z5\nX4\nM2\n").read()) is None
