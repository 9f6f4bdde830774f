"""A stated force ends with the material where the cut is followed, and acts along the whole cut where it is not."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.cutting.forces.along_path import PathForce
from robomill.io.samples import samples_dir
from robomill.surface.contact.march import March
from robomill.toolpath.source import GCodeSource

SETUP = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(cell=5e-4, step=5e-3)
PROCESS = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(
    cell=5e-4, step=10e-3, coupling=True
)
# In at feed from above, through the block, and on behind it.
CUT = GCodeSource("G21 G90 S12000 M3\nG0 X-60 Y0 Z4\nG1 X-50 F1800\nZ-2\nX0\nX90\nG0 Z20\nM2\n")


@pytest.mark.parametrize("coupling", [False, True])
def test_a_stated_force_in_air(coupling: bool) -> None:
    force = PathForce(10.0, 80.0, -20.0)
    followed = rm.simulate(SETUP.replace(source=CUT, force=force, engagement=True, coupling=coupling))
    told = rm.simulate(SETUP.replace(source=CUT, force=force, engagement=False))
    low, high = SETUP.stock_block.lower[0] - 4e-3, SETUP.stock_block.upper[0] + 4e-3
    x, z = followed.path.p[:, 0], followed.path.p[:, 2]
    level = followed.path.cutting & (np.diff(z, prepend=z[0]) == 0.0) & (np.diff(x, prepend=x[0]) > 0.0)
    air = level & ((x < low - 6e-3) | (x > high + 6e-3)) & (z < 0)
    metal = level & (x > low + 9e-3) & (x < high - 9e-3) & (z < 0)
    assert air.any()
    assert metal.any()
    size = np.sqrt(10.0**2 + 80.0**2 + 20.0**2)
    np.testing.assert_allclose(np.linalg.norm(followed.F[air], axis=1), 0.0)
    np.testing.assert_allclose(np.linalg.norm(followed.F[metal], axis=1), size)
    x, z = told.path.p[:, 0], told.path.p[:, 2]
    level = told.path.cutting & (np.diff(z, prepend=z[0]) == 0.0) & (np.diff(x, prepend=x[0]) > 0.0)
    np.testing.assert_allclose(np.linalg.norm(told.F[level], axis=1), size)


def test_each_step_is_cut_from_where_the_one_before_has_left_the_tool(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first after a rapid from as far aside as it ends: the rapid arrives where the cut begins."""
    cuts: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    make = March.cut

    def noted(self: March, i: int, a: np.ndarray, b: np.ndarray) -> None:
        cuts[i] = np.array(a), np.array(b)
        make(self, i, a, b)

    monkeypatch.setattr(March, "cut", noted)
    run = rm.simulate(PROCESS)
    p, moved = run.path.p, run.delta @ run.setup.T_MW[:3, :3]
    steps = [i for i in cuts if run.conditions.engaged[i]]
    assert len(steps) > 5
    for i in steps:
        a, b = cuts[i]
        np.testing.assert_allclose(b - p[i], moved[i], atol=1e-6)
        before = moved[i - 1] if run.path.cutting[i - 1] else moved[i]
        np.testing.assert_allclose(a - p[i - 1], before, atol=1e-6)
    assert max(np.abs(moved[i] - moved[i - 1]).max() for i in steps if run.path.cutting[i - 1]) > 1e-5
