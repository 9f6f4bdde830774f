"""A march: one step asked and cut at a time, voids of a mesh, and which steps a straight run passes over."""

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.surface.contact.engagement import engage
from robomill.surface.contact.march import March
from robomill.surface.stock import Stock, stock_grid
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
    whole, _ = march.run()
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


def test_a_step_is_looked_at_beside_where_it_is_cut():
    """Raised by 0.5 mm each step of a slot of 2 mm meets 1.5 mm; it is cut all the same: there is no more in it."""
    p, cutting = passes(along(0.0, 0.002), along(0.0, 0.002))
    looked = np.zeros_like(p)
    looked[: len(p) // 2, 2] = 0.5e-3
    found = engage(March(STOCK, 2e-4, TOOLS["flat"], p, None, cutting, looked=looked))
    n = len(p) // 2
    np.testing.assert_allclose(found.a_p[10:n], 1.5e-3, rtol=1e-3)
    assert not found.part.touches[n:].any()


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


def turned(lengths, angles, slopes=None):
    """A path of steps (mm) that turn by so many radians from one to the next, in plan or down along slopes."""
    heading = np.cumsum(angles)
    down = np.zeros(len(heading)) if slopes is None else np.asarray(slopes)
    way = np.column_stack([np.cos(heading) * np.cos(down), np.sin(heading) * np.cos(down), -np.sin(down)])
    return np.vstack([np.zeros(3), np.cumsum(np.asarray(lengths)[:, None] * 1e-3 * way, axis=0)])


def test_runs_end_where_the_way_bends_the_tool_or_its_axis_changes():
    p = turned(np.ones(7), [0, 0, 1e-9, 0, np.pi, 0, 0])
    march = March(STOCK, 1e-4, TOOLS["flat"], p)
    np.testing.assert_array_equal(march._begins, [True, False, True, False, True, False, False])
    tooling = Tooling((TOOLS["flat"], TOOLS["ball"]), [0, 0, 0, 1, 1, 0, 0, 0])
    straight = turned(np.ones(7), np.zeros(7))
    march = March(STOCK, 1e-4, tooling, straight)
    np.testing.assert_array_equal(march._begins, [True, False, True, False, True, False, False])
    k = np.tile([0.0, 0.0, 1.0], (8, 1))
    k[5:] = 0.0, 0.6, 0.8
    march = March(STOCK, 1e-4, TOOLS["flat"], straight, k)
    np.testing.assert_array_equal(march._begins, [True, False, False, False, True, True, False])


def test_steps_are_those_at_feed_that_move_and_whose_ends_are_known():
    p = turned(np.ones(8), np.zeros(8))
    p[4] = p[3]
    really = p + np.array([0.0, 1e-4, 0.0])
    really[6] = np.nan
    cutting = np.array([True, True, False, True, True, True, True, True, True])
    march = March(STOCK, 1e-4, TOOLS["flat"], p, None, cutting, really=really)
    np.testing.assert_array_equal(march.steps, [1, 3, 4, 5, 8])  # the fourth has no length and begins the fifth
    np.testing.assert_allclose(march._ends[:, [1, 4]], 1e-4)
    assert len(March(STOCK, 1e-4, TOOLS["flat"], p, None, np.zeros(9, bool)).steps) == 0


@pytest.mark.parametrize(
    ("cutters", "layered", "slack"),
    [
        ((TOOLS["flat"],), False, 0.01 * 2e-4),
        ((TOOLS["flat"], TOOLS["ball"]), False, (2e-4) ** 2 / R),
        ((Cutter("bull", 2 * R, corner_radius=1e-3), TOOLS["ball"]), False, (2e-4) ** 2 / 1e-3),
        ((Cutter("chamfer", 2 * R, tip_angle=np.radians(60)),), False, 1e-4 / np.tan(np.radians(30))),
        ((Cutter("chamfer", 2 * R, tip_angle=np.radians(60)),), True, 1e-4),
    ],
)
def test_between_cells_heights_differ_by_what_the_sharpest_nose_leaves_there(cutters, layered, slack):
    tooling = Tooling(cutters, np.zeros(2, dtype=int))
    march = March(STOCK, 2e-4, tooling, np.zeros((2, 3)))
    assert march._slack(stock_grid(STOCK, 2e-4), layered) == pytest.approx(slack, rel=1e-6)
    wide = stock_grid(Stock((0, 0, -1), (0.01, 0.013, 0)), 4e-3)._replace(dx=1e-4, dy=2e-4)
    assert march._slack(wide, layered) == pytest.approx(slack, rel=1e-6)


@pytest.mark.parametrize(("lean", "slack"), [(0.0, 0.01 * 2e-4), (0.1, 0.5 * 2e-4)])
def test_columns_that_may_hold_layers_are_trusted_to_half_a_cell(lean, slack):
    """Where cutters lean a column may have gaps, and room for them; a flat mill that stands upright leaves steps."""
    p, cutting = passes(along(0.0, 0.002))
    march = March(STOCK, 2e-4, TOOLS["flat"], p, np.array([0.0, np.sin(lean), np.cos(lean)]), cutting)
    world, _ = march._state(np.ones(len(march.steps), dtype=bool), stock_grid(STOCK, 2e-4))
    assert (world.dexels.heights.shape[2] > 1) == (lean > 0.0)
    assert world.dexels.slack == pytest.approx(slack, rel=1e-6)
    np.testing.assert_allclose(world.dexels.heights[..., 0].max(), 0.0)


def test_a_path_keeps_only_the_cells_it_can_reach_and_meets_the_same(monkeypatch):
    """In a stock many times as large: what is met of a corner's own cells is what is met of all of them."""
    wide = Stock((-0.1, -0.1, -0.01), (0.1, 0.1, 0.0))
    p, cutting = passes(along(0.0, 0.002))
    march = March(wide, 5e-4, TOOLS["ball"], p, None, cutting)
    assert march._reached.nx * march._reached.ny < 0.2 * 400 * 400
    found, sectors = march.run()
    monkeypatch.setattr(March, "_reached", stock_grid(wide, 5e-4))
    of_all, their_sectors = March(wide, 5e-4, TOOLS["ball"], p, None, cutting).run()
    assert np.abs(of_all).max() > 0.0
    np.testing.assert_allclose(found, of_all, rtol=1e-9, atol=1e-15)
    np.testing.assert_array_equal(sectors, their_sectors)


def test_a_link_to_where_a_cut_begins_is_cut_before_the_cut_is_met():
    """A tool led 0.18 mm aside between two cuts meets what it meets where that way is a cut of its own."""
    told = np.array([[-10, 0, -2], [5, 0, -2], [5, 0, -2], [5, -8, -2]]) * 1e-3
    led = np.array([[-10, 0, -2], [5, 0, -2], [5.1, 0.15, -2], [5.1, -8, -2]]) * 1e-3
    alone = np.array([[-10, 0, -2], [5, 0, -2], [5.1, 0.15, -2], [5.1, 0.15, -2], [5.1, -8, -2]]) * 1e-3
    cutting = np.array([False, True, True, True])
    found = engage(March(STOCK, 2e-4, TOOLS["flat"], told, cutting=cutting, really=led))
    expected = engage(March(STOCK, 2e-4, TOOLS["flat"], alone, cutting=np.append(cutting, True)))
    assert found.a_e[2] > 1e-4
    for name in ("phi_st", "phi_ex", "a_p", "a_e"):
        np.testing.assert_allclose(getattr(found, name)[2:], getattr(expected, name)[3:], rtol=1e-6)
    np.testing.assert_allclose(found.part.moments[2:], expected.part.moments[3:], atol=1e-9)


LINKS = {"aside": (0.1, 0.15), "straight on": (0.4, 0.0), "back": (-0.3, 0.0), "as the next cut goes": (0.0, -0.3)}


@pytest.mark.parametrize("link", LINKS)
def test_a_link_is_a_run_of_its_own_however_it_goes(link):
    """The tool is led aside between two cuts of many steps: all is met, and left, as where that way is a cut."""
    at = np.array([5.0, 0.0, -2.0])
    to = at + np.append(LINKS[link], 0.0)
    before, after = np.linspace(at - [15.0, 0, 0], at, 6), np.linspace(0.0, -8.0, 6)[1:, None] * [0.0, 1.0, 0.0]
    told, led = np.vstack([before, at, at + after]) * 1e-3, np.vstack([before, to, to + after]) * 1e-3
    alone = np.vstack([before, to, to, to + after]) * 1e-3
    cutting = np.arange(len(told)) > 0
    march = March(STOCK, 2e-4, TOOLS["flat"], told, None, cutting, really=led)
    np.testing.assert_array_equal(np.flatnonzero(march._begins), [0, 5, 6])
    truth = March(STOCK, 2e-4, TOOLS["flat"], alone, None, np.arange(len(alone)) > 0)
    found, expected = engage(march), engage(truth)
    for name in ("phi_st", "phi_ex", "a_p", "a_e"):
        np.testing.assert_allclose(getattr(found, name)[6:], getattr(expected, name)[7:], rtol=1e-6, err_msg=name)
    np.testing.assert_allclose(found.part.moments[6:], expected.part.moments[7:], atol=1e-9)
