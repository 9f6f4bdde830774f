"""Whatever the path, the cutter and the push: no section says what cannot be, and what it leaves out has a reason."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.surface.sections.groove import groove_sections
from robomill.surface.stock import Stock
from robomill.surface.swept import CutPath

CUTTERS = (
    Cutter("flat", 8e-3),
    Cutter("flat", 3e-3),
    Cutter("ball", 6e-3),
    Cutter("bull", 8e-3, corner_radius=1e-3),
)
STOCK = Stock((-0.03, -0.03, -0.01), (0.03, 0.03, 0.0))
MOST = 0.15e-3  # m: largest push along any axis


@pytest.mark.parametrize("seed", range(12))
def test_polylines_that_cross_themselves_with_a_push_that_wanders(seed: int) -> None:
    rng = np.random.default_rng(seed)
    cutter = CUTTERS[seed % len(CUTTERS)]
    corners = np.column_stack([rng.uniform(-0.032, 0.032, (6, 2)), rng.choice([-1e-3, -2e-3, -4e-3], 6)])
    pieces = [a + np.linspace(0.0, 1.0, 20)[1:, None] * (b - a) for a, b in itertools.pairwise(corners)]
    p = np.vstack([corners[:1], *pieces])
    push = np.cumsum(rng.normal(0.0, 1.0, p.shape), axis=0)
    path = CutPath(p, p + MOST * push / np.abs(push).max(), np.arange(len(p)) > 0)
    length, far = float(np.linalg.norm(np.diff(p, axis=0), axis=1).sum()), 2.0 * np.sqrt(3.0) * MOST
    for found in groove_sections(STOCK, cutter, path, rng.uniform(0.0, length, 12)):
        for name in found.measures:
            assert np.isfinite(getattr(found, name)) or found.why.get(name), (found.kind, name)
        for side in ("left", "right"):
            angle, form, error = (getattr(found, f"wall_{side}_{name}") for name in ("angle", "straightness", "error"))
            assert not abs(np.degrees(angle) - 90.0) > 5.1
            assert not form > 0.35e-3
            assert not abs(error) > far
        assert not abs(found.floor_tilt) > np.radians(1.0)
        assert not abs(found.error_max) > far
