"""The order in which material goes: what is told leads from the stock to the surface, for every kind of cutter."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.arrays import FloatArray
from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.surface.history import History, history
from robomill.surface.stock import Stock
from robomill.surface.zmap import ZMap, cut

BLOCK = Stock(np.array([0.0, 0.0, -0.02]), np.array([0.06, 0.04, 0.0]))
PATH = np.array([[-0.01, 0.02, -0.004], [0.03, 0.02, -0.004], [0.05, 0.03, -0.008], [0.03, 0.01, -0.006]])


def replay(surface: ZMap, found: History, upto: int) -> FloatArray:
    z = np.broadcast_to(surface.z_stock, surface.z.shape).ravel().copy()
    for cell, height, step in zip(found.cell, found.height, found.step, strict=True):
        if step <= upto:
            z[cell] = height
    return z.reshape(surface.z.shape)


@pytest.mark.parametrize("kind", ["flat", "ball", "bull", "chamfer"])
@pytest.mark.parametrize("lean", [0.0, 0.3])
def test_it_leads_from_the_stock_to_the_surface(kind: str, lean: float) -> None:
    cutter = Cutter("flat", 0.008).reshaped(kind)
    k = np.tile([np.sin(lean), 0.0, np.cos(lean)], (len(PATH), 1))
    tooling = Tooling.single(cutter, len(PATH))
    removes = np.array([False, True, True, True])
    surface = cut(BLOCK, 0.0005, tooling, PATH, k, removes)
    found = history(surface, tooling, PATH, k, removes)
    depth = float(np.max(surface.z_stock - surface.z))
    assert found.least == pytest.approx(0.01 * depth)
    assert np.abs(replay(surface, found, 3) - surface.z).max() <= found.least + 1e-12
    assert (np.diff(found.step) >= 0).all()
    for step in (1, 2):
        partial = cut(
            BLOCK, 0.0005, Tooling.single(cutter, step + 1), PATH[: step + 1], k[: step + 1], removes[: step + 1]
        )
        assert np.abs(replay(surface, found, step) - partial.z).max() <= found.least + 1e-12


def test_where_there_are_too_many_the_small_ones_are_left_out() -> None:
    cutter = Cutter("flat", 0.008).reshaped("ball")
    t = np.linspace(0.0, 1.0, 200)
    path = np.column_stack([0.06 * t, 0.02 + 0.01 * np.sin(40 * t), -0.002 - 0.006 * t])
    tooling, removes = Tooling.single(cutter, len(path)), np.append(False, np.ones(len(path) - 1, dtype=bool))
    k = np.tile([0.0, 0.0, 1.0], (len(path), 1))
    surface = cut(BLOCK, 0.0005, tooling, path, k, removes)
    every = history(surface, tooling, path, k, removes)
    few = history(surface, tooling, path, k, removes, most=len(every.cell) // 2)
    assert len(few.cell) <= len(every.cell) // 2
    assert few.least > every.least
    assert np.abs(replay(surface, few, len(path)) - surface.z).max() <= few.least + 1e-12


def test_two_cutters_follow_the_path_and_not_each_other() -> None:
    cutters = (Cutter("flat", 0.008), Cutter("flat", 0.004))
    tooling = Tooling(cutters, np.array([0, 0, 1, 0]))
    removes, k = np.array([False, True, True, True]), np.tile([0.0, 0.0, 1.0], (4, 1))
    surface = cut(BLOCK, 0.0005, tooling, PATH, k, removes)
    found = history(surface, tooling, PATH, k, removes)
    assert (np.diff(found.step) >= 0).all()
    assert np.abs(replay(surface, found, 3) - surface.z).max() <= found.least + 1e-12
    assert set(found.step.tolist()) == {1, 2, 3}
