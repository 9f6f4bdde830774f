"""Tables of lines on the screen to the source and back, in the units people type."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from robomill.errors import ToolpathError
from robomill.ui.toolpath import lines


def test_lines_to_the_table_and_back() -> None:
    frame = pd.DataFrame([[0.0, 0.0, -0.00254, 0.1016, 0.0, -0.00254, 0.0254]], columns=list(lines.COLUMNS))
    source = lines.lines_from_frame(frame, 200.0)
    np.testing.assert_array_equal(source.end, [[0.1016, 0.0, -0.00254]])
    np.testing.assert_array_equal(source.v_f, [0.0254])
    assert source.n_s == 200.0
    np.testing.assert_array_equal(lines.lines_frame(source).to_numpy(), frame.to_numpy())


def test_an_empty_cell_of_a_line_is_named() -> None:
    row = [0.0, 0.0, -2.0, 50.0, None, -2.0, 1800.0]
    with pytest.raises(ToolpathError, match="Row 1: y₁ is missing"):
        lines.lines_from_frame(pd.DataFrame([row], columns=list(lines.COLUMNS)))
    with pytest.raises(ToolpathError, match="no rows"):
        lines.lines_from_frame(pd.DataFrame([], columns=list(lines.COLUMNS)))
