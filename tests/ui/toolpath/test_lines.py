"""Tables of lines on the screen to the source and back, in the units people type."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from robomill.errors import ToolpathError
from robomill.ui.toolpath import lines


def test_lines_in_inches() -> None:
    frame = pd.DataFrame([[0.0, 0.0, -0.1, 4.0, 0.0, -0.1, 60.0]], columns=list(lines.COLUMNS))
    source = lines.lines_from_frame(frame, "in", "in/min", 200.0)
    np.testing.assert_allclose(source.end, [[0.1016, 0.0, -0.00254]])
    np.testing.assert_allclose(source.v_f, [0.0254])
    back = lines.lines_frame(source, "in", "in/min")
    np.testing.assert_allclose(back.to_numpy(), frame.to_numpy(), atol=1e-9)


def test_an_empty_cell_of_a_line_is_named() -> None:
    row = [0.0, 0.0, -2.0, 50.0, None, -2.0, 1800.0]
    with pytest.raises(ToolpathError, match="Row 1: y₁ is missing"):
        lines.lines_from_frame(pd.DataFrame([row], columns=list(lines.COLUMNS)), "mm", "mm/min")
    with pytest.raises(ToolpathError, match="no rows"):
        lines.lines_from_frame(pd.DataFrame([], columns=list(lines.COLUMNS)), "mm", "mm/min")
