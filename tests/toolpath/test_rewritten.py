"""A path by other means cuts what it cut."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import ToolpathError
from robomill.toolpath.path import Toolpath
from robomill.toolpath.rewritten import MOST_ROWS, lines_of_path, sketch_of_path
from robomill.toolpath.source import GCodeSource, SketchSource

PROGRAM = (
    "G21 G90\nS3000 M3\nG0 X0 Y0 Z5\nG1 Z-1 F300\nX20 F600\nX20 Y9\nX5 Y4 F900\nG0 Z5\nX40 Y0\nG1 Z-2 F300\nY8\nM2\n"
)


def cuts(path: Toolpath, level: bool = False) -> list[tuple[float, ...]]:
    """Every cut: from where, to where, mm, how fast, mm/s; those that are ``level`` alone where asked."""
    found = [
        (*np.round(1e3 * path.p[i - 1], 6), *np.round(1e3 * path.p[i], 6), round(1e3 * float(path.v_f[i]), 6))
        for i in np.flatnonzero(path.cutting)
    ]
    return [cut for cut in found if cut[:3] != cut[3:6] and (not level or cut[2] == cut[5])]


def test_the_table_of_a_path_makes_the_same_cuts() -> None:
    path = GCodeSource(PROGRAM).read()
    assert cuts(lines_of_path(path).read()) == cuts(path)


def test_the_sketch_of_a_path_makes_its_level_cuts_one_run_of_a_feed_a_shape() -> None:
    path = GCodeSource(PROGRAM).read()
    sketch = sketch_of_path(path)
    assert sketch is not None
    assert cuts(SketchSource(sketch).read(), level=True) == cuts(path, level=True)
    assert [(each.shape, len(each.points)) for each in sketch.elements] == [("polyline", 3), ("line", 2), ("line", 2)]
    assert sketch.n_s == pytest.approx(50.0)


def test_what_nobody_would_read_is_not_made() -> None:
    zigzag = "".join(f"X{n} Y{n % 2}\n" for n in range(1, MOST_ROWS + 2))
    path = GCodeSource(f"G21 G90\nG0 X0 Y0 Z-1\nG1 F600\n{zigzag}M2\n").read()
    assert sketch_of_path(path) is None
    with pytest.raises(ToolpathError, match=f"has {MOST_ROWS + 1} cuts; a table holds at most {MOST_ROWS}"):
        lines_of_path(path)
    assert sketch_of_path(GCodeSource("G21 G90\nG0 X0 Y0 Z5\nG1 Z-3 F60\nG0 Z5\nM2\n").read()) is None, "a hole alone"
