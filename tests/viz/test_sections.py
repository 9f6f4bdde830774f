"""A section across the groove as it is drawn."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.simulation.result import SimulationResult
from robomill.viz.views import section_drawing


def test_section_is_upright_at_the_measured_walls(result: SimulationResult) -> None:
    drawing = section_drawing(result.groove(0.05), "mm")
    steep = np.abs(np.diff(drawing.machined)) > 1.0
    assert steep.sum() == 2
    assert np.diff(drawing.u)[steep] == pytest.approx(0.0)
    walls = sorted(drawing.u[:-1][steep])
    assert walls == pytest.approx(sorted([drawing.wall_left, drawing.wall_right]))
    assert drawing.centre_offset == pytest.approx(0.2295, abs=5e-4)
