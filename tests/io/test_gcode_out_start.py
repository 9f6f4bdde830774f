"""Where a written program begins: a first rapid to wherever the path does, along one axis or several."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.io.gcode_out import toolpath_to_gcode
from robomill.toolpath.gcode import read_gcode
from robomill.toolpath.path import toolpath_from_lines


@pytest.mark.parametrize("start", [(0, 0, 0), (5, 0, 0), (0, -5, 0), (0, 0, 5), (5, 5, 5)])
def test_a_path_is_begun_where_it_begins(start: tuple[float, float, float]) -> None:
    start_m = np.array(start) * 1e-3
    path = toolpath_from_lines([start_m], [start_m + np.array([0.01, 0.0, 0.0])], 0.01)
    again = read_gcode(toolpath_to_gcode(path))
    cut = np.flatnonzero(again.cutting)
    np.testing.assert_allclose(again.p[cut[0] - 1], start_m, atol=1e-12)
    assert len(again) == (3 if any(start) else 2)  # a reader's path begins at zero


def test_the_first_move_names_every_axis_also_those_at_zero() -> None:
    """A machine stands anywhere when a program begins: an axis that is left out stays there."""
    path = read_gcode("G21 G90 S9000 M3\nG0 X-60 Z5\nG0 Z-2\nG1 X50 F1800\nM2\n")
    first = next(line for line in toolpath_to_gcode(path).splitlines() if "G0" in line)
    assert first.split()[1:] == ["G0", "X-60", "Y0", "Z5"]
    from_zero = toolpath_to_gcode(toolpath_from_lines([[0, 0, 0]], [[0.01, 0, 0]], 0.01))
    assert "G0 X0 Y0 Z0" in from_zero


@pytest.mark.parametrize("axis", [(0.6, 0.0, 0.8), (0.0, 0.6, 0.8)])
def test_a_first_axis_that_leans_is_written_from_the_start(axis: tuple[float, float, float]) -> None:
    path = toolpath_from_lines([[0, 0, 0]], [[0.01, 0, 0]], 0.01, k=axis)
    again = read_gcode(toolpath_to_gcode(path))
    cut = np.flatnonzero(again.cutting)
    np.testing.assert_allclose(again.k[cut[0] - 1 :], np.tile(axis, (len(again) - cut[0] + 1, 1)), atol=1e-7)
