"""Columns cut run by run, as the Python they are written in: layers by sampling, heights by stamps, who made what."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely

from robomill.cutting.tool import Cutter
from robomill.surface.contact.march_kernels import as_halves, cut_run, go_on, take_out
from robomill.surface.contact.material_kernels import (
    AXIS,
    ENDS,
    MOVE,
    NOBODY,
    RUN,
    SKIN,
    Bounds,
    Dexels,
    Facets,
    World,
    standing,
    top_over,
)
from robomill.surface.contact.track_kernels import follows
from robomill.surface.raster import relief_of
from robomill.surface.stock import Stock

MM = 1e-3
FLAT, BALL = Cutter("flat", 8 * MM), Cutter("ball", 8 * MM)
CUTTERS = {
    "flat": FLAT,
    "ball": BALL,
    "bull": Cutter("bull", 8 * MM, corner_radius=1.5 * MM),
    "chamfer": Cutter("chamfer", 8 * MM, tip_angle=np.radians(80), tip_diameter=1 * MM),
}
UP = (0.0, 0.0, 1.0)


def world_of(moves, layers=0, size=(24.0, 16.0), cells=(31, 17)):
    """A block of 10 mm depth from (0, 0), top at 0, and runs (cutter, start mm, end mm, axis) yet to be cut."""
    lengths = np.array([*size, 10.0]) * MM
    dx, dy = lengths[:2] / cells
    if layers:
        heights = np.full((*cells, 2 * layers), -np.inf)
        heights[..., 1::2] = np.inf
        heights[..., :2] = 0.0, -10 * MM
    else:
        heights = np.zeros((*cells, 1))
    names = np.full((*cells, heights.shape[2] + 1), NOBODY, dtype=np.int32)
    dexels = Dexels(heights, names, np.zeros(1, dtype=np.int64), 0.5 * dx, 0.5 * dy, dx, dy, 0.5 * max(dx, dy))
    runs = np.zeros((1 + len(moves), RUN))
    for run, (cutter, start, end, axis) in zip(runs[1:], moves, strict=True):
        run[:ENDS] = cutter.solid
        run[ENDS:AXIS] = np.array([*start, *end]) * MM
        run[AXIS:MOVE] = axis
    nothing = np.zeros(0, dtype=np.int64)
    bounds = Bounds(0.0, 0.0, -10 * MM, lengths[0], lengths[1], 0.0)
    relief = relief_of(Stock((0.0, 0.0, -10 * MM), (*lengths[:2], 0.0)), 4 * MM)
    return World(dexels, runs, bounds, Facets(np.zeros((0, 3, 3)), nothing, nothing, 1.0), relief)


def centres(dexels):
    nx, ny = dexels.heights.shape[:2]
    return np.meshgrid(dexels.x0 + dexels.dx * np.arange(nx), dexels.y0 + dexels.dy * np.arange(ny), indexing="ij")


def stamped(move, x, y, count=1501):
    """Lowest height (...) m of a cutter's stamps at points in plan, along a move of an upright cutter."""
    cutter, start, end, _ = move
    lowest = np.full(np.shape(x), np.inf)
    for share in np.linspace(0.0, 1.0, count):
        tip = (np.array(start) + share * np.subtract(end, start)) * MM
        lowest = np.minimum(lowest, tip[2] + cutter.profile(np.hypot(x - tip[0], y - tip[1])))
    return lowest


def walk(kind, points):
    return [(CUTTERS[kind], a, b, UP) for a, b in pairwise(points)]


PATHS = {
    "zigzag": [(-6, 3, -2), (9, 5, -2), (18, 12, -2), (12, 14.5, -2), (12, 7, -2), (12, -3, -2)],
    "along the axes": [(4, -5, -1), (4, 11, -1), (20, 11, -1), (20, 3, -1), (9, 3, -1)],
    "up and down": [(2, 2, -1), (8, 6, -3), (15, 6, -3), (20, 9, -1), (20, 9, -4), (20, 9, -0.5), (27, 9, -0.5)],
    "beside and above": [(2, 30, -2), (8.1, 30, -2), (8.1, 8, 1), (16, 8, 1), (16, 8, -1), (16, 19, -1)],
}


@pytest.mark.parametrize("points", PATHS.values(), ids=PATHS)
@pytest.mark.parametrize("kind", CUTTERS)
def test_columns_are_left_by_the_lowest_stamp_and_know_the_run_that_made_them(kind, points):
    """A path whose runs follow one another: what a run need not look at again is cut by the one before."""
    moves = walk(kind, points)
    world = world_of(moves)
    for r in range(1, len(world.runs)):
        cut_run(world, r, False)
    dexels = world.dexels
    x, y = centres(dexels)
    left = [stamped(move, x, y) for move in moves]
    expected = np.minimum(np.min(left, axis=0), 0.0)
    np.testing.assert_allclose(dexels.heights[..., 0], expected, atol=5e-6)
    made = dexels.names[..., 1]
    np.testing.assert_array_equal((made == NOBODY)[expected < -1e-5], False)
    np.testing.assert_array_equal(made[expected > -1e-9], NOBODY)
    i, j = np.nonzero(made != NOBODY)
    by_maker = np.array(left)[made[i, j] - 1, i, j]
    np.testing.assert_allclose(by_maker, dexels.heights[i, j, 0], atol=5e-6)


@pytest.mark.parametrize("seed", range(6))
def test_columns_are_left_by_the_lowest_stamp_where_runs_begin_anew_and_tools_change(seed):
    """Up, down and straight down; the next run begins where this one ends, or elsewhere, or with another cutter."""
    rng = np.random.default_rng(seed)
    moves, at, kind = [], None, "flat"
    for _ in range(8):
        here = rng.uniform([0, 0, -4], [24, 16, -1]) if at is None or rng.random() < 0.4 else at
        there = rng.uniform([0, 0, -4], [24, 16, -1])
        there = np.where([False, False, rng.random() < 0.6], here, there)
        there[:2] = here[:2] if rng.random() < 0.15 else there[:2]
        kind = str(rng.choice(list(CUTTERS))) if rng.random() < 0.25 else kind
        moves, at = [*moves, (CUTTERS[kind], here, there, UP)], there
    world = world_of(moves)
    for r in range(1, len(world.runs)):
        cut_run(world, r, False)
    x, y = centres(world.dexels)
    expected = np.minimum(np.min([stamped(move, x, y) for move in moves], axis=0), 0.0)
    np.testing.assert_allclose(world.dexels.heights[..., 0], expected, atol=8e-6)


@pytest.mark.parametrize("lean", [(0.4, 0.0), (0.0, -0.5), (-0.3, 0.35)])
@pytest.mark.parametrize("kind", ["flat", "ball"])
def test_a_leaning_run_takes_its_body_out_of_the_columns(kind, lean):
    """Heights of every column asked of a cylinder's, or a ball's, stamps along the move."""
    k = np.array([np.sin(lean[0]), np.sin(lean[1]), 1.0])
    k /= np.linalg.norm(k)
    cutter, start, end = CUTTERS[kind], np.array([7.0, 6.0, -4.0]), np.array([12.0, 8.0, -5.0])
    world = world_of([(cutter, start, end, k)], layers=3, cells=(25, 17))
    cut_run(world, 1, False)
    dexels = world.dexels
    x, y = centres(dexels)
    z = np.linspace(-9.98, -0.02, 84) * MM
    points = np.stack(np.broadcast_arrays(x[..., None], y[..., None], z), axis=-1)
    gone, near = np.zeros(points.shape[:-1], dtype=bool), np.zeros(points.shape[:-1], dtype=bool)
    for share in np.linspace(0.0, 1.0, 61):
        from_tip = points - (start + share * (end - start)) * MM
        along = from_tip @ k
        across = np.linalg.norm(from_tip - along[..., None] * k, axis=-1)
        for body, grown in ((gone, 0.0), (near, 6e-5)):
            beside = across <= cutter.radius + grown
            body |= beside & (along + grown >= cutter.profile(np.minimum(across, cutter.radius)))
    ends = dexels.heights
    inside = np.zeros(gone.shape, dtype=bool)
    for layer in range(3):
        inside |= (z <= ends[..., 2 * layer, None]) & (z >= ends[..., 2 * layer + 1, None])
    sure = gone == near
    np.testing.assert_array_equal(inside[sure], ~gone[sure])
    assert gone.any()
    np.testing.assert_array_equal(dexels.lost, [0])


def test_layers_after_many_cuts_are_what_was_never_taken_out():
    rng = np.random.default_rng(2)
    z = np.arange(-10.0, 0.0, 0.01) + 0.005
    for _ in range(60):
        world = world_of([(FLAT, (0, 0, 0), (1, 0, 0), UP)], layers=6, cells=(1, 1))
        dexels = world.dexels
        material, maker = np.ones(len(z), dtype=bool), {-10.0: NOBODY, 0.0: NOBODY}
        for r in range(1, 6):
            low, high = np.sort(rng.choice(np.arange(-11.0, 1.01, 0.25), 2, replace=False))
            take_out(dexels, (0, 0, r), low * MM, np.inf if high > 0.9 else high * MM)
            ends_before = {end for end in maker if not low <= end <= high}
            maker = {end: name for end, name in maker.items() if end in ends_before}
            maker.update({end: r for end in (low, high) if material[np.abs(z - end) < 0.01].all() and -10 < end < 0})
            material &= (z < low) | (z > high)
        ends = dexels.heights[0, 0] / MM
        inside = np.zeros(len(z), dtype=bool)
        for top, bottom in zip(ends[::2], ends[1::2], strict=True):
            inside |= (z < top) & (z > bottom)
        np.testing.assert_array_equal(inside, material)
        assert dexels.lost[0] == 0
        layers = int((ends[::2] > -np.inf).sum())
        assert (np.diff(ends[: 2 * layers]) < 0.0).all()
        assert np.isneginf(ends[2 * layers :: 2]).all()
        for end, name in zip(ends[: 2 * layers], dexels.names[0, 0, 1:], strict=False):
            if round(end, 6) in maker:
                assert name == maker[round(end, 6)]


@pytest.mark.parametrize(
    ("low", "high", "ends", "made"),
    [(-4, -3, [0, -1, -4, -10], 2), (-9, -8, [0, -1, -2, -10], 1), (-7, -5, [0, -1, -2, -10], 1)],
)
def test_without_room_for_another_layer_a_gap_takes_the_thinner_rest_above_it_or_is_closed(low, high, ends, made):
    """Layers 0 to -1 and -2 to -10 (in 1/1024 m) fill a column of two: the gap would be within the second."""
    world = world_of([(FLAT, (0, 0, 0), (1, 0, 0), UP)] * 2, layers=2, cells=(1, 1))
    world.dexels.heights[0, 0] = np.array([0, -1, -2, -10]) / 1024
    world.dexels.names[0, 0, 1:] = NOBODY, 1, 1, NOBODY
    take_out(world.dexels, (0, 0, 2), low / 1024, high / 1024)
    np.testing.assert_array_equal(world.dexels.heights[0, 0] * 1024, ends)
    np.testing.assert_array_equal(world.dexels.names[0, 0, 1:], [NOBODY, 1, made, NOBODY])
    assert world.dexels.lost[0] == 1


def test_a_layer_thinner_than_rounding_is_none():
    world = world_of([(FLAT, (0, 0, 0), (1, 0, 0), UP)] * 3, layers=3, cells=(1, 1))
    take_out(world.dexels, (0, 0, 0), -0.5 * SKIN, np.inf)
    np.testing.assert_array_equal(world.dexels.heights[0, 0, :2], [0.0, -10 * MM])
    take_out(world.dexels, (0, 0, 0), -11 * MM, -10 * MM + 0.5 * SKIN)
    np.testing.assert_array_equal(world.dexels.heights[0, 0, :2], [0.0, -10 * MM])
    take_out(world.dexels, (0, 0, 0), -10 * MM + 0.5 * SKIN, -0.5 * SKIN)
    assert np.isneginf(world.dexels.heights[0, 0, 0])


def test_a_run_follows_the_one_that_left_off_at_its_start_with_its_tool():
    first = (FLAT, (1, 1, -1), (5, 1, -2), UP)
    leans = (0.0, 0.6, 0.8)
    for second, same in (
        ((FLAT, (5, 1, -2), (9, 1, -2), UP), True),
        ((FLAT, (5, 1, -2), (9, 1, -1), UP), True),
        ((FLAT, (5, 1, -2), (9, 1, -2.1), UP), False),
        ((FLAT, (5.001, 1, -2), (9, 1, -2), UP), False),
        ((FLAT, (5, 1.001, -2), (9, 1, -2), UP), False),
        ((FLAT, (5, 1, -1.999), (9, 1, -1), UP), False),
        ((BALL, (5, 1, -2), (9, 1, -2), UP), False),
        ((Cutter("flat", 9 * MM), (5, 1, -2), (9, 1, -2), UP), False),
        ((FLAT, (5, 1, -2), (9, 1, -2), leans), False),
        ((FLAT, (1, 1, -1), (5, 1, -2), UP), False),
    ):
        runs = world_of([first, second]).runs
        assert follows(runs, 2) == same
        assert not follows(runs, 1)


@pytest.mark.parametrize(("one", "other"), [((0.6, 0.0, 0.8), (-0.6, 0.0, 0.8)), ((0.0, 0.6, 0.8), (0.0, -0.6, 0.8))])
def test_a_run_of_another_axis_does_not_follow(one, other):
    for second, same in ((one, True), (other, False)):
        runs = world_of([(FLAT, (1, 1, -1), (5, 1, -2), one), (FLAT, (5, 1, -2), (9, 1, -2), second)]).runs
        assert follows(runs, 2) == same


def test_a_run_grows_by_the_end_of_each_step():
    run = np.zeros(RUN)
    go_on(run, np.array([1.0, 2, 3, 4, 5, 6]), True)
    np.testing.assert_array_equal(run[ENDS:AXIS], [1, 2, 3, 4, 5, 6])
    go_on(run, np.array([4.0, 5, 6, 7, 8, 9]), False)
    np.testing.assert_array_equal(run[ENDS:AXIS], [1, 2, 3, 7, 8, 9])
    np.testing.assert_array_equal(np.delete(run, range(ENDS, AXIS)), 0.0)


def test_points_of_what_is_left_stand_as_deep_as_the_nearest_wall():
    """Three slots in a block: a point is material where no stamp of them covers it and the block held it."""
    moves = [
        (FLAT, (-6, 4, -2), (15, 4, -2), UP),
        (BALL, (6, 2, -3), (16, 13, -3), UP),
        (CUTTERS["bull"], (20, 20, -1), (20, 5, -4), UP),
    ]
    world = world_of(moves)
    for r in range(1, len(world.runs)):
        cut_run(world, r, False)
    points = np.random.default_rng(8).uniform([-1 * MM, -1 * MM, -11 * MM], [25 * MM, 17 * MM, 1 * MM], (600, 3))
    x, y, z = points.T
    floor = np.min([stamped(move, x, y, 601) for move in moves], axis=0)
    held = (x > 0) & (x < 24 * MM) & (y > 0) & (y < 16 * MM) & (z > -10 * MM) & (z < 0)
    truth = held & (z < floor)
    sure = np.abs(z - floor) > 2e-5
    found = np.array([standing(world, tuple(point), 99) for point in points])
    np.testing.assert_array_equal((found > 0.0)[sure], truth[sure])
    assert (found <= 1e-3 + 1e-9).all()
    # Where only the block ends, how deep is the way to its nearest face, a millimetre at most.
    low, high = np.zeros(3) - [0, 0, 10 * MM], np.array([24, 16, 0]) * MM
    way = np.minimum(points - low, high - points).min(axis=1)
    outside = ~held
    np.testing.assert_allclose(found[outside], np.clip(way, -1e-3, 1e-3)[outside], atol=1e-9)
    assert (found[truth] <= way[truth] + 1e-9).all()
    for at, level in zip(points[:200], floor[:200], strict=True):
        inside = 0 < at[0] < 24 * MM and 0 < at[1] < 16 * MM
        top = top_over(world, at[0], at[1])
        if inside:
            assert top == pytest.approx(min(level, 0.0), abs=5e-6)
        else:
            assert top == -np.inf


def test_numbers_in_half_precision_are_the_nearest_that_there_are():
    """No half is nearer than the one chosen; what is a half already stays it, down to the smallest."""
    rng = np.random.default_rng(3)
    exact = np.arange(np.float16(4096.0).view(np.int16), dtype=np.int16).view(np.float16).astype(np.float32)
    between = np.exp2(rng.uniform(-27.0, 12.0, 4000)).astype(np.float32)
    for singles in (exact, between):
        halves = np.empty(len(singles), dtype=np.float16)
        as_halves(singles, singles.view(np.int32), halves.view(np.int16))
        off = np.abs(halves.astype(float) - singles)
        nearest = np.abs(singles.astype(np.float16).astype(float) - singles)
        np.testing.assert_array_equal(off, nearest)


@pytest.mark.parametrize("turn", [100.0, 150.0, 178.0, 180.0, -165.0])
@pytest.mark.parametrize("first", [0.0, 65.0, 180.0])
def test_however_sharply_a_path_turns_back_its_corner_is_cut(first, turn):
    """Two level runs on the middle of the block, whose corner stands 5 mm from where they begin and end."""
    ways = np.radians([first, first + turn])
    corner = np.array([12.0, 8.0, -2.0])
    start, end = (corner + sense * 5.0 * np.array([np.cos(a), np.sin(a), 0.0]) for sense, a in zip((-1, 1), ways))
    world = world_of(walk("flat", [start, corner, end]), cells=(61, 41))
    for r in (1, 2):
        cut_run(world, r, False)
    places = np.stack(centres(world.dexels), axis=-1).reshape(-1, 2) / MM
    away = shapely.distance(shapely.LineString([start[:2], corner[:2], end[:2]]), shapely.points(places))
    sure = np.abs(away - FLAT.radius / MM) > 1e-6
    expected = np.where(away < FLAT.radius / MM, -2 * MM, 0.0)
    np.testing.assert_allclose(world.dexels.heights[..., 0].ravel()[sure], expected[sure], atol=1e-12)
