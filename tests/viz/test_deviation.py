"""Components of the deflection along the path."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.simulation.result import SimulationResult
from robomill.viz.deviation import components_figure


def test_the_components_drawn_are_the_deflection_and_the_worst_point_is_among_them(result: SimulationResult) -> None:
    fig = components_figure(result, "mm", dark=False)
    curves = {t.name: np.asarray(t.y, dtype=float) for t in fig.figure.data}
    total = sum(curves[f"δ<sub>{a}</sub>"] ** 2 for a in "XYZ")
    np.testing.assert_allclose(np.sqrt(total), curves["size"], equal_nan=True)
    np.testing.assert_array_equal(np.isfinite(curves["size"]), result.path.cutting)
    assert np.nanmax(curves["size"]) == pytest.approx(1e3 * np.nanmax(np.linalg.norm(result.delta, axis=1)))
