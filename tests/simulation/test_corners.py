"""Which samples of a corrected program belong to the corners of the path that was meant, however few stand there."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.simulation.corners import Ways, at_corners


def staircase(step: float) -> tuple[np.ndarray, np.ndarray]:
    """A cut (m, 3) m of three legs of 20 mm, each turned left or right by 90 degrees, and the leg that each step is
    of."""
    ways, n = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]), round(20e-3 / step)
    steps = np.repeat(ways, n, axis=0) * step
    return np.vstack([np.zeros(3), np.cumsum(steps, axis=0)]), np.append(0, np.repeat(np.arange(3), n))


@pytest.mark.parametrize("step", [10e-3, 5e-3, 1e-3, 0.5e-3])
@pytest.mark.parametrize("off", [(0.3e-3, -0.2e-3, 0.0), (-0.15e-3, -0.1e-3, 0.05e-3), (0.0, 0.0, 0.0)])
def test_where_a_leg_ends_it_belongs_to_the_corner(step: float, off: tuple[float, float, float]) -> None:
    """Moved as a whole, its samples lie before or behind the corner by what it goes aside."""
    p, leg = staircase(step)
    k = np.tile([0.0, 0.0, 1.0], (len(p), 1))
    q, s = p + np.array(off), np.arange(len(p)) * step
    near = s + off[0] * (leg != 1) + off[1] * (leg == 1)
    found = at_corners(q, k, leg, np.clip(near, 0.0, s[-1]), Ways.of(p, k))
    for corner in (20e-3, 40e-3):
        at = int(np.argmin(np.abs(s - corner)))
        assert found[at] == pytest.approx(corner, abs=1e-12)
        assert (found[:at] <= corner + 1e-12).all()
        assert (found[at:] >= corner - 1e-12).all()
    away = np.abs(s[:, None] - [20e-3, 40e-3]).min(axis=1) > 4.5e-3
    np.testing.assert_array_equal(found[away], np.clip(near, 0.0, s[-1])[away])
