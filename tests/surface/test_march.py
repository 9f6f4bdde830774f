"""A march: one step asked and cut at a time, voids of a mesh, and what a straight run may leave for later."""

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.surface.engagement import engage
from robomill.surface.march import March
from robomill.surface.stock import Stock
from robomill.surface.zmap import cut

R = 0.004
STOCK = Stock((-0.03, -0.02, -0.01), (0.03, 0.02, 0.0))
TOOLS = {"flat": Cutter("flat", 2 * R), "ball": Cutter("ball", 2 * R)}


def along(y, depth, step=1e-3):
    x = np.arange(-0.03, 0.02, step)
    return np.column_stack([x, 0 * x + y, 0 * x - depth])


def passes(*parts):
    cutting = np.concatenate([[False, *np.ones(len(part) - 1, dtype=bool)] for part in parts])
    return np.vstack(parts), cutting


@pytest.mark.parametrize("kind", TOOLS)
@pytest.mark.parametrize("lean", [0.0, 0.1])
def test_step_by_step_is_the_march(kind, lean):
    """Asked one after the other, each step its own run, steps meet what they meet in runs known as one move."""
    p, cutting = passes(along(0.0, 0.002), along(0.003, 0.003)[:20])
    k = np.array([0.0, np.sin(lean), np.cos(lean)])
    march = March(STOCK, 2e-4, TOOLS[kind], p, k, cutting)
    whole, _, _ = march.run()
    for i in np.flatnonzero(cutting):
        row, _ = march.meet(i, p[i - 1], p[i])
        again, _ = march.meet(i, p[i - 1], p[i])
        np.testing.assert_array_equal(row, again)
        np.testing.assert_allclose(row, whole[i], atol=2e-3 * np.abs(whole[i]).max() + 1e-9)
        march.cut(i, p[i - 1], p[i])


def test_a_finishing_pass_thinner_than_a_cell_leaves_nothing_for_the_next():
    """0.03 mm off the wall: the arc is arccos(1 - a_e / R); run again on its own path it is air."""
    thin = 3e-5
    p, cutting = passes(along(0.0, 0.002), along(thin, 0.002), along(thin, 0.002))
    found = engage(March(STOCK, 1e-4, TOOLS["flat"], p, None, cutting))
    n = len(p) // 3
    assert found.phi_ex[n + n // 2] == pytest.approx(np.arccos(1 - thin / R), rel=1e-2)
    assert not found.part.touches[2 * n + 3 :].any()


def test_each_step_meets_the_part_with_its_own_cutter():
    """A slot by 8 mm, then one by 12 mm on the same line: what is left for it is 2 mm on either side."""
    p, cutting = passes(along(0.0, 0.002), along(0.0, 0.002))
    n = len(p) // 2
    tooling = Tooling((TOOLS["flat"], Cutter("flat", 3 * R)), np.arange(len(p)) // n)
    found = engage(March(STOCK, 1e-4, tooling, p, None, cutting))
    assert found.a_e[n // 2] == pytest.approx(2 * R, rel=1e-4)
    assert found.a_e[n + n // 2] == pytest.approx(R, rel=1e-2)


def faces(low, high):
    x, y, z = zip(low, high, strict=True)
    v = np.array([[a, b, c] for a in x for b in y for c in z])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return [v[list(t)] for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def test_a_cavity_is_not_removed():
    """A block with a box of air from -1 to -6 mm under half the slot: 8 mm wide, 3 mm deep, and the air in it."""
    inner = faces((0.0, -0.01, -0.006), (0.02, 0.01, -0.001))
    stock = Stock(
        (-0.03, -0.02, -0.01), (0.03, 0.02, 0.0), np.array([*faces((-0.03, -0.02, -0.01), (0.03, 0.02, 0.0)), *inner])
    )
    p = np.array([[-0.04, 0.0, -0.003], [0.04, 0.0, -0.003]])
    left = cut(stock, 2e-4, TOOLS["flat"], p)
    assert left.removed_volume == pytest.approx(2 * R * (0.06 * 0.003 - 0.02 * 0.002), rel=2e-3)
    assert left.z[50, 100] == pytest.approx(-0.003)
    # what is left of the air, which a height map has filled: all of it but the 8 mm of the slot down to -3 mm
    assert left.filled == pytest.approx(0.02 * (0.02 * 0.005 - 2 * R * 0.002), rel=2e-2)
    assert [note.code for note in left.notes()] == ["void-filled"]


def test_a_pass_far_off_with_another_axis_changes_nothing():
    """Two leaning passes, the second under the overhang of the first, with and without an upright one elsewhere."""
    k = np.array([0.0, np.sin(0.45), np.cos(0.45)])
    leaning = (along(0.006, 0.006, 2e-3), along(0.009, 0.008, 2e-3))
    alone, cutting = passes(*leaning)
    truth = engage(March(STOCK, 2e-4, TOOLS["flat"], alone, np.broadcast_to(k, alone.shape), cutting))
    mixed, cutting = passes(along(-0.012, 0.001, 2e-3), *leaning)
    n = len(mixed) - len(alone)
    axes = np.vstack([np.broadcast_to([0, 0, 1.0], (n, 3)), np.broadcast_to(k, alone.shape)])
    found = engage(March(STOCK, 2e-4, TOOLS["flat"], mixed, axes, cutting))
    for name in ("a_p", "a_e", "phi_st", "phi_ex"):
        np.testing.assert_allclose(getattr(found, name)[n:], getattr(truth, name), atol=1e-9, err_msg=name)
    assert np.nanmax(truth.a_e[len(alone) // 2 + 2 :]) > 1e-4
