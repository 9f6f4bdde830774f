"""Where a gauge is put: axes, beginnings, corners and bottoms of a small program, line by line as it is written."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from robomill.cutting.tool import Cutter
from robomill.simulation.judging.places import APART, BETWEEN, Places, _chosen, _parted, places
from robomill.surface.stock import Stock
from tests.simulation.judging.pushed_runs import BLOCK, pushed, run

PROGRAM = [  # line 2 and what follows
    *["G0 X-40 Y0 Z5", "G0 Z-2", "G1 X0 F1800", "G1 Y10", "G0 Z5", "G0 X12 Y-12"],
    *["G1 Z-3 F300", "G1 X18 F900", "G1 X24 Z-1", "G0 Z5", "G0 X-20 Y-15", "G1 Z-4 F300", "G0 Z5"],
]
SLOT, ASIDE, PLUNGE, LEVEL, RAMP, HOLE = 4, 5, 8, 9, 10, 13


@pytest.fixture(scope="module")
def made():
    """Every sample off by something else; some by as much as the one before."""
    result, rng = run(*PROGRAM), np.random.default_rng(5)
    off = rng.normal(size=(3, len(result.path))) * 0.05e-3
    off[:, 1::3] = off[:, :-1:3]
    return pushed(result, *off)


def samples(made, *lines):
    """Judged samples on some lines of the program, without the places between two."""
    at = places(made)
    return at, np.flatnonzero(np.isin(made.path.block[at.i], lines) & ~at.between)


def test_axes_follow_the_feed_and_hold_the_deviation(made):
    at, q = samples(made, SLOT, ASIDE, LEVEL, RAMP)
    moves = q[made.path.step_length[at.i[q]] > 0.0]
    step = made.path.p[at.i[moves]] - made.path.p[at.i[moves] - 1]
    feed = step * [1.0, 1.0, 0.0] / np.linalg.norm(step[:, :2], axis=1, keepdims=True)
    np.testing.assert_allclose(at.feed[moves], feed, atol=1e-9)
    np.testing.assert_allclose(
        at.left_of[moves], np.column_stack([-feed[:, 1], feed[:, 0], 0.0 * feed[:, 0]]), atol=1e-9
    )
    off = made.p_machined - made.path.p
    for q_, axes in ((n, np.stack([at.feed[n], at.left_of[n], [0.0, 0.0, 1.0]])) for n in moves):
        np.testing.assert_allclose(at.d[q_], axes @ off[at.i[q_]], atol=1e-12)
    np.testing.assert_array_equal(at.c[q], made.path.p[at.i[q]])
    np.testing.assert_allclose(at.length[q], made.path.step_length[at.i[q]])


def test_where_the_deviation_changes_three_places_between_are_looked_at(made):
    at, p, off = places(made), made.path.p, made.p_machined - made.path.p
    change = np.linalg.norm(off[1:] - off[:-1], axis=1)
    moves = made.path.step_length > 0.0  # others turn on the spot, at a corner
    asked = made.judged[1:] & made.judged[:-1] & made.removes[1:] & moves[1:] & (change > APART)
    asked = set((np.flatnonzero(asked) + 1).tolist())
    assert 20 < len(asked) < made.judged.sum() - 5
    found: dict[int, list[float]] = {}
    for q in np.flatnonzero(at.between & moves[at.i]):
        i = at.i[q]
        step = p[i] - p[i - 1]
        share = (at.c[q] - p[i - 1]) @ step / (step @ step)
        np.testing.assert_allclose(at.c[q], p[i - 1] + share * step, atol=1e-12)
        expected = share * off[i] + (1.0 - share) * off[i - 1]
        np.testing.assert_allclose(
            at.d[q], [axis[q] @ expected for axis in (at.feed, at.left_of, at.axial)], atol=1e-12
        )
        found.setdefault(int(i), []).append(share)
        assert (at.length[q], at.turn[q]) == (0.0, 0.0)
    assert set(found) == asked
    for shares in found.values():
        np.testing.assert_allclose(sorted(shares), BETWEEN, atol=1e-9)


def test_cuts_begin_and_end_beside_rapids_and_plunges_and_plunges_end_at_bottoms(made):
    at, _ = samples(made)
    block = made.path.block[at.i]

    def ends(*lines):
        on = np.flatnonzero(np.isin(made.path.block, lines) & made.path.cutting)
        return on[0], on[-1]

    begin, end = (set(at.i[chosen].tolist()) for chosen in at.begins_or_ends)
    first, second = ends(SLOT, ASIDE), ends(LEVEL, RAMP)
    assert begin == {i for i in (first[0], second[0]) if made.judged[i]}
    assert end == {first[1], second[1]}
    assert set(at.i[at.bottoms].tolist()) == {ends(PLUNGE)[1], ends(HOLE)[1]}
    np.testing.assert_array_equal(at.steep, np.isin(block, [PLUNGE, HOLE]))
    np.testing.assert_allclose(at.slope[np.isin(block, [SLOT, ASIDE, LEVEL])], 0.0, atol=1e-12)
    np.testing.assert_allclose(at.slope[block == RAMP], 2.0 / 6.0, rtol=1e-9)
    np.testing.assert_allclose(at.slope[at.steep], 2.0)


def test_a_corner_is_one_for_the_sample_before_it_and_after_it(made):
    at, q = samples(made, SLOT, ASIDE)
    block, i = made.path.block[at.i[q]], at.i[q]
    corner = [i[block == SLOT].max(), i[block == ASIDE].min()]
    np.testing.assert_allclose(at.turn[q[np.isin(i, corner)]], np.pi / 2)
    np.testing.assert_allclose(at.turn[q[~np.isin(i, corner)]], 0.0, atol=1e-9)


def test_towards_a_rapid_or_between_two_a_path_has_no_corner():
    """A slot that ends in the block, and the rapid to one side and back above it, which turns by 90 degrees."""
    made = run("G0 X-40 Y10 Z5", "G0 Y0", "G0 Z-2", "G1 X0 F1800", "G0 Y4", "G0 X-20 Y10")
    at = places(made)
    on_slot = made.path.block[at.i] == 5
    assert on_slot.sum() > 10
    np.testing.assert_allclose(at.turn[on_slot], 0.0, atol=1e-9)


@pytest.mark.parametrize("lean", [0, 15])
def test_how_high_the_stock_stands_is_measured_along_the_tool(lean):
    """And how far the tip is below a plate that it cuts through."""
    plate = Stock([*BLOCK.lower[:2], -1.5e-3], BLOCK.upper)
    at = places(run(f"G0 X-40 Y0 Z8 B{lean}", "G0 Z-2", "G1 X20 F1800", stock=plate))
    q, rise = np.arange(len(at.i)), np.cos(np.radians(lean))
    np.testing.assert_allclose(at.below, 0.5e-3 / rise)
    points = at.c + np.array([1e-3, 2e-3, 0.7e-3])
    high = np.where(points[:, 0] <= BLOCK.upper[0], 1.3e-3 / rise, 0.0)
    high[points[:, 0] < BLOCK.lower[0]] = 0.0
    np.testing.assert_allclose(at.depth(q, points), high, atol=1e-12)
    for off in ((0.0, 25e-3, 0.0), (0.0, 0.0, 2e-3)):
        assert not at.depth(q, points + np.array(off)).any()
    for share in (0.99, 1.01):
        np.testing.assert_array_equal(at.stands(q, points, share * high), (high > 0.0) & (share < 1.0))


def test_the_stock_stands_as_high_as_its_mesh_over_the_nearest_cell():
    """A block on a plate, both of boxes; points all over them and beside them, not nearer to an edge than half a cell.
    In cells of 9 mm the plate has 18 by 10, which are not square."""
    low, high, cell = np.array([-0.055, 0.020, -0.012]), np.array([0.100, 0.102, 0.0]), 9e-3
    plate = ((low, [*high[:2], -5e-3]), ([0.062, 0.061, -6e-3], [0.087, 0.102, 0.0]))
    triangles = np.concatenate([trimesh.creation.box(bounds=bounds).triangles for bounds in plate])
    cases = SimpleNamespace(setup=SimpleNamespace(stock_block=Stock(low, high, triangles), cell=cell))
    rng = np.random.default_rng(2)
    points = rng.uniform([-0.08, 0.0, -0.016], [0.12, 0.12, 0.0], (4000, 3))
    edges = [np.array([-0.055, 0.062, 0.087, 0.100]), np.array([0.020, 0.061, 0.102])]
    clear = [np.abs(points[:, [axis]] - edges[axis]).min(axis=1) > 0.51 * cell for axis in (0, 1)]
    points = points[clear[0] & clear[1]]
    lean = np.radians(20.0)
    many = np.tile([0.0, np.sin(lean), np.cos(lean)], (len(points), 1))
    at = Places(cases, *[np.arange(len(points))] * 2, *[points] * 3, many, points, (), np.arange(0), *[None] * 3)
    inside = ((points > low) & (points < high))[:, :2].all(axis=1)
    upon = ((points > plate[1][0]) & (points < plate[1][1]))[:, :2].all(axis=1)
    top = np.where(upon, 0.0, -5e-3)
    depth = np.where(inside, np.maximum(top - points[:, 2], 0.0) / np.cos(lean), 0.0)
    np.testing.assert_allclose(at.depth(np.arange(len(points)), points), depth, atol=1e-12)
    assert min(upon.sum(), (inside & ~upon & (depth > 0)).sum(), (~inside).sum()) > 50


CUTTERS = (
    Cutter("flat", 8e-3),
    Cutter("ball", 8e-3),
    Cutter("chamfer", 8e-3, tip_angle=np.radians(60.0)),
    Cutter("chamfer", 8e-3, tip_angle=np.radians(120.0)),
)


@pytest.mark.parametrize("rise", [0.0, 0.05, -0.3, 0.6])
def test_a_tool_that_rises_on_its_way_is_wider_or_narrower_at_a_height_by_its_own_shape(rise):
    """By its radius at heights a little lower and a little higher; a plunge's sides stay where they are."""
    heights, ahead = np.linspace(0.5e-3, 3.5e-3, 13), 1e-6
    across, many = 1.0 / np.hypot(1.0, rise), len(CUTTERS) * len(heights)
    steep = np.arange(many) % len(heights) == 5
    conditions = SimpleNamespace(mostly_axial=steep, plunges=steep)
    parts = np.full(many, rise * across), np.full(many, across)
    every, rows, of = np.arange(many), np.zeros((many, 3)), np.repeat(np.arange(len(CUTTERS)), len(heights))
    at = Places(SimpleNamespace(conditions=conditions), every, every < 0, *[rows] * 5, CUTTERS, of, None, *parts)
    found = at.wider(every, np.tile(heights, len(CUTTERS)))
    for q in every:
        low, high = (heights[q % len(heights)] + side * ahead * abs(rise) for side in (-1.0, 1.0))
        truth = (CUTTERS[of[q]].radius_at(high) - CUTTERS[of[q]].radius_at(low)) / (2 * ahead)
        assert found[q] == pytest.approx(0.0 if steep[q] else min(truth, 0.9), rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("most", [20, 100])
def test_of_many_samples_those_in_even_steps_are_chosen_and_those_that_are_most_off(most):
    """A tenth of them; their steps, short and long, have nothing to do with where they are off."""
    rng = np.random.default_rng(most)
    s, off = np.cumsum(rng.uniform(0.0, 2e-3, 1500)), rng.normal(size=(1500, 2))
    off[3] = np.nan  # not reached
    chosen = _chosen(s, off, most)
    worst = np.argsort(np.nan_to_num(np.hypot(*off.T)))[-(most // 10) :]
    assert set(worst) <= set(chosen)
    assert most <= len(chosen) + most // 10
    assert len(chosen) <= most + most // 10
    even = sorted(set(range(len(s))) & set(chosen))
    assert (s[even[0]], s[even[-1]]) == (s[0], s[-1])
    assert np.diff(s[even]).max() <= s[-1] / (most - 1) + 2e-3
    assert np.diff(s[sorted(set(even) - set(worst))]).min() >= s[-1] / (most - 1) - 2e-3


def test_all_are_taken_where_there_are_no_more_than_asked_for(made):
    judged = np.flatnonzero(made.judged).tolist()
    for most in (None, len(judged), len(judged) + 1):
        at = places(made, most)
        assert at.i[~at.between].tolist() == judged
    few = places(made, len(judged) - 1)
    assert set(few.i[~few.between].tolist()) < set(judged)


def test_moves_are_taken_in_parts_of_one_length():
    """Whole ones to the last digit, others from division to division of their own way."""
    rng = np.random.default_rng(4)
    parts = np.array([1, 3, 2, 1, 5, 1])
    ends = rng.uniform(-1.0, 1.0, (len(parts), 6)) * 1e-2
    found = iter(_parted(ends, parts))
    for move, n in zip(ends, parts, strict=True):
        at = [move[:3] + (move[3:] - move[:3]) * k / n for k in range(n + 1)]
        for begin, end in pairwise(at):
            np.testing.assert_allclose(next(found), [*begin, *end] if n > 1 else move, rtol=0.0, atol=1e-14 * (n > 1))
    assert next(found, None) is None


@pytest.mark.parametrize(("kind", "parted"), [("ball", True), ("flat", False)])
def test_a_move_on_which_a_nose_is_lifted_is_taken_in_parts_of_four_micrometres_each(kind, parted):
    """At most 32; however high it stands already. What stays at one height is whole, and so is all of a flat end."""
    made = run("G0 X-40 Y0 Z5", "G0 Z-2", "G1 X20 F1800", cutter=Cutter(kind, 8e-3))
    lift = np.random.default_rng(1).choice([0.0, 3e-6, 9e-6, 0.3e-3], len(made.path))
    made = pushed(made, left=0.1e-3, up=0.5e-3 + np.cumsum(lift))
    expected = []
    for i in np.flatnonzero(made.removes):
        height = [made.p_machined[j, 2] - made.path.p[j, 2] for j in (i - 1, i)]
        rise = abs(height[1] - height[0])
        expected += [1 if rise <= 4e-6 or not parted else min(int(np.ceil(rise / 4e-6)), 32)]
    assert len(places(made).outline.told) == sum(expected)
    assert (max(expected) == 32) == parted


@pytest.mark.parametrize("to", [(20, 8), (20, 3), (3, -16), (-20, 8)])
@pytest.mark.parametrize(("kind", "lean"), [("ball", 20), ("ball", 0), ("bull", 20)])
def test_a_ball_that_leans_is_taken_upright_over_its_lowest_point(kind, lean, to):
    """Its axes are those of its way on the plan, and its sphere stays where it is; another nose has its own axes."""
    cutter = Cutter(kind, 8e-3, corner_radius=4e-3 if kind == "ball" else 1e-3)
    made = run(f"G0 X0 Y0 Z8 B{lean}", "G0 Z-2", f"G1 X{to[0]} Y{to[1]} F1800", cutter=cutter)
    at, k = places(made), made.path.k[-1]
    way = np.array([*to, 0.0])
    upright = kind == "ball"
    feed = way / np.linalg.norm(way)
    if not upright:
        feed -= (feed @ k) * k
        feed /= np.linalg.norm(feed)
    up = np.array([0.0, 0.0, 1.0]) if upright else k
    for found, truth in ((at.feed, feed), (at.axial, up), (at.left_of, np.cross(up, feed))):
        np.testing.assert_allclose(found, np.tile(truth, (len(at.i), 1)), atol=1e-9)
    whole = ~at.between
    centre = made.path.p[at.i[whole]] + 4e-3 * k
    lowest = centre - [0.0, 0.0, 4e-3] if upright else made.path.p[at.i[whole]]
    np.testing.assert_allclose(at.c[whole], lowest, atol=1e-12)


@pytest.mark.parametrize("lean", [35, 50])
def test_where_a_leaning_ball_goes_straight_down_its_axes_are_axes(lean):
    """Though it goes no way over the part."""
    made = run(f"G0 X0 Y0 Z8 B{lean}", "G0 Z1", "G1 Z-3 F300", "G1 X5", cutter=Cutter("ball", 8e-3))
    at = places(made)
    axes = np.stack([at.feed, at.left_of, at.axial], axis=1)
    np.testing.assert_allclose(axes @ axes.transpose(0, 2, 1), np.tile(np.eye(3), (len(axes), 1, 1)), atol=1e-9)
