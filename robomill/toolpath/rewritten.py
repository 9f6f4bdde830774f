"""A path by other means: its cuts as the rows of a table, or as the shapes of a sketch."""

from __future__ import annotations

from typing import Any

import numpy as np

from robomill.errors import ToolpathError
from robomill.toolpath.path import Toolpath
from robomill.toolpath.sketch import Element, Sketch
from robomill.toolpath.source import LinesSource
from robomill.units import format_count

MOST_ROWS = 200  # nobody reads a longer table, or a sketch of more shapes
LEVEL = 1e-9  # m
BENEATH = 1e-6  # m under the part's zero


def lines_of_path(path: Toolpath) -> LinesSource:
    """Every feed move as a row. Raises ToolpathError where a table would be too long."""
    i = np.flatnonzero(path.cutting & (path.step_length > 0))
    if len(i) > MOST_ROWS:
        raise ToolpathError(
            f"The path has {format_count(len(i))} cuts; a table holds at most {MOST_ROWS}. It stays as it is."
        )
    n_s = float(path.n_s[i].max()) if len(i) else 0.0
    return LinesSource(path.p[i - 1], path.p[i], path.v_f[i], n_s)


def sketch_of_path(path: Toolpath) -> Sketch | None:
    """The level cuts below z = 0 as lines and polylines; None where there are none, or too many to draw."""
    level = path.cutting & (path.step_length > 0) & (np.abs(np.diff(path.p[:, 2], prepend=path.p[0, 2])) < LEVEL)
    level &= path.p[:, 2] < -BENEATH
    i = np.flatnonzero(level)
    if len(i) == 0 or len(i) > MOST_ROWS:
        return None
    same = np.append(False, (np.diff(i) == 1) & (path.v_f[i[1:]] == path.v_f[i[:-1]]))
    elements = []
    for run in np.split(i, np.flatnonzero(~same)[1:]):
        points = path.p[np.append(run[0] - 1, run), :2]
        shape: Any = "line" if len(points) == 2 else "polyline"
        elements.append(Element(shape, points, float(-path.p[run[0], 2]), float(path.v_f[run[0]])))
    first = elements[0]
    return Sketch(tuple(elements), n_s=float(path.n_s[i].max()), v_f=first.v_f, depth=first.depth)
