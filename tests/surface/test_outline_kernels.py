"""Walls and floors, part by part: capsules by their points, slopes by differences, fields of moves one by one."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from scipy.spatial.transform import Rotation

from robomill.cutting.tool import Cutter
from robomill.surface.outline import Outline
from robomill.surface.outline_kernels import Seen, Tracks, furthest, furthest_block, seen_from, squares_near, upright_at

R = 4e-3
FLAT = Cutter("flat", 2 * R)
UP = np.array([0.0, 0.0, 1.0])
T = np.linspace(0.0, 1.0, 20001)


def test_a_move_is_seen_along_u_across_it_and_along_the_axis():
    rng = np.random.default_rng(1)
    for turn in Rotation.random(5, random_state=1).as_matrix():
        c, u, k = rng.normal(size=3), turn[0], turn[2]
        ends = rng.normal(size=6)
        axes = np.stack([u, np.cross(k, u), k])
        seen = seen_from(np.concatenate([c, k, u]), ends)
        np.testing.assert_allclose(seen, [*axes @ (ends[:3] - c), *axes @ (ends[3:] - ends[:3])], atol=1e-12)


MOVES = [
    (0.0, 1e-3, 5e-3, 2e-3),
    (1e-3, -2e-3, -5e-3, 3e-3),
    (-2e-3, 0.5e-3, 3e-3, -4e-3),
    (2e-3, -6e-3, 1e-3, 12e-3),
    (0.0, 3e-3, 4e-3, 0.0),
    (1e-3, -3e-3, -4e-3, 0.0),
    (1e-3, R, 4e-3, 0.0),
    (1e-3, 1.001 * R, 4e-3, 0.0),
    (0.0, 2e-3, 0.0, 0.0),
    (0.0, 5e-3, 0.0, 0.0),
    (0.0, 5e-3, 2e-3, 3e-3),
    (0.0, -5e-3, 2e-3, -3e-3),
    (1e-3, -3e-3, 0.0, 6e-3),
    (3e-3, 3e-3, 0.0, -9e-3),
]


@pytest.mark.parametrize(("u", "v", "du", "dv"), MOVES)
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_capsule_ends_where_the_last_of_its_disks_does(u, v, du, dv, way):
    found = furthest(Seen(u, v, 0.0, du, dv, 0.0), R, way)
    across = v + T * dv
    on_line = np.abs(across) <= R
    if not on_line.any():
        assert math.isnan(found)
        return
    ends = way * (u + T * du)[on_line] + np.sqrt(R**2 - across[on_line] ** 2)
    assert found == pytest.approx(way * ends.max(), abs=2e-7)


def test_squares_around_a_point_are_its_own_and_those_beside_it():
    rng = np.random.default_rng(0)
    tracks = Tracks(None, None, None, None, np.array([1.0, -2.0]), 0.5, np.array([7, 4]))
    centres = np.array([1.25, -1.75])[:, None] + 0.5 * np.arange(7)
    for x, y in rng.uniform([0.6, -2.4], [4.9, 0.4], (200, 2)):
        i, i_end, j, j_end = squares_near(tracks, x, y)
        near = [np.flatnonzero(np.abs(c - at) < 0.75).tolist() for c, at in zip(centres, (x, y), strict=True)]
        near[1] = [n for n in near[1] if n < 4]
        assert ([*range(i, i_end)], [*range(j, j_end)]) == tuple(near)


def field(n=300, seed=3):
    """Short level moves of two mills all over a quarter of a metre, as told and, moved and lifted, as left."""
    rng = np.random.default_rng(seed)
    start = np.column_stack([rng.uniform(0.0, [0.25, 0.15], (n, 2)), rng.choice([-3e-3, -2e-3, -1e-3], n)])
    stop = start + np.column_stack([rng.normal(0.0, 8e-3, (n, 2)), np.zeros(n)])
    told = np.hstack([start, stop])
    aside = np.column_stack([rng.normal(0.0, 1e-3, (n, 2)), rng.choice([-1e-4, 1.2e-3], n)])
    return told, told + np.hstack([aside, aside]), rng.integers(0, 2, n)


CUTTERS = (FLAT, Cutter("flat", 10e-3))


def tracks(ends):
    return shapely.linestrings(ends.reshape(-1, 2, 3)[:, :, :2])


def test_floors_of_a_wide_field_are_those_of_the_lowest_mills_over_the_point():
    told, left, cutter = field()
    radii = np.array([c.radius for c in CUTTERS])[cutter]
    outline = Outline(told, left, CUTTERS, cutter, 1e-3)
    rng, slack = np.random.default_rng(4), np.zeros(1)
    judged = {True: 0, False: 0}
    for n in range(0, len(told), 3):
        tip, angle, offset = 0.5 * (told[n, :3] + told[n, 3:]), rng.uniform(0, 7), 0.98 * radii[n] * rng.uniform(-1, 1)
        u = np.array([np.cos(angle), np.sin(angle), 0.0])
        point = shapely.Point(tip[:2] + offset * u[:2])
        over = [shapely.distance(tracks(ends), point) <= radii for ends in (told, left)]
        heights = told[:, 2] - tip[2], left[:, 2] - tip[2]
        low_told = heights[0][over[0]].min(initial=np.inf)
        low_left = heights[1][over[1]].min(initial=np.inf)
        both = [height[over[0] & over[1]].min(initial=np.inf) for height in heights]
        one = both[0] < np.inf and both[0] - low_told < 1e-6 and both[1] - low_left < 1e-6
        found = outline.floors(np.concatenate([tip, UP, u])[None], np.array([offset]), slack)
        assert found[0][0] == pytest.approx(low_told, abs=1e-9)
        if np.isfinite(low_left):
            assert found[1][0] == pytest.approx(low_left - low_told, abs=1e-9)
        assert found[2][0] == one
        judged[bool(one)] += 1
    assert min(judged.values()) > 3


def test_walls_of_a_wide_field_are_where_the_outlines_of_its_low_moves_end():
    told, left, cutter = field(seed=5)
    radii = np.array([c.radius for c in CUTTERS])[cutter]
    reach, height = 2e-3, 0.6e-3
    outline = Outline(told, left, CUTTERS, cutter, reach)
    rng, judged = np.random.default_rng(6), {True: 0, False: 0}

    def wall(ends, low, tip, u, start):
        """How far from the tip along u the outline of the ``low`` moves goes on without a gap."""
        ray = shapely.LineString([tip[:2] + start * u[:2], tip[:2] + 0.05 * u[:2]])
        near = low & (shapely.distance(tracks(ends), ray) <= radii)
        inside = shapely.union_all(shapely.buffer(tracks(ends[near]), radii[near], quad_segs=200)).intersection(ray)
        for piece in getattr(inside, "geoms", [inside]):
            along = sorted((np.array(q) - tip[:2]) @ u[:2] for q in piece.coords)
            if along and along[0] <= start + 1e-7:
                return along[-1]
        return np.nan

    for n in range(0, len(told), 4):
        tip, angle = 0.5 * (told[n, :3] + told[n, 3:]), rng.uniform(0, 7)
        u, start = np.array([np.cos(angle), np.sin(angle), 0.0]), radii[n] - reach
        low = told[:, 2] < tip[2] + height
        both = low & (left[:, 2] < tip[2] + height)
        truth = wall(told, low, tip, u, start), wall(told, both, tip, u, start), wall(left, both, tip, u, start)
        if np.nanmax([0.0, *truth]) > radii[n] + reach:
            continue  # further off than it is looked for
        asked = np.concatenate([tip, UP, u])[None], np.array([height]), radii[[n]]
        found = [each[0] for each in outline.walls(*asked)]
        np.testing.assert_allclose(found[:2], np.array([truth[0], truth[2]]) - radii[n], atol=1e-6)
        one = abs(truth[1] - truth[0]) < 1e-6
        assert found[2] == one
        judged[one] += 1
    assert min(judged.values()) > 5


def test_the_block_that_may_reach_furthest_is_that_of_the_widest_capsule_round_a_box():
    """Of all boxes near that hold a start of the line: the one from which a disc of the largest radius reaches on
    furthest, by corners and discs; -1 where no box is low and near enough."""
    told, left, cutter = field(seed=8)
    outline = Outline(told, left, CUTTERS, cutter, 1e-3)
    (tracks_told, _), blocks = outline._tracks, outline._blocks
    rng, seen = np.random.default_rng(2), set()
    for n in range(0, len(told), 3):
        angle, height = rng.uniform(0, 7), rng.choice([0.5e-3, -0.5e-3, -2.5e-3])
        u = np.array([np.cos(angle), np.sin(angle), 0.0])
        c, start = 0.5 * (told[n, :3] + told[n, 3:]), 2e-3
        found = furthest_block(tracks_told, blocks, blocks.told, np.concatenate([c, UP, u, [height, start]]))
        i, i_end, j, j_end = squares_near(tracks_told, c[0], c[1])
        squares = [a * tracks_told.squares[1] + b for a in range(i, i_end) for b in range(j, j_end)]
        best, furthest_to = -1, -np.inf
        for square in squares:
            for b in range(blocks.of_square[square], blocks.of_square[square + 1]):
                moves = slice(blocks.first[b], blocks.first[b + 1])
                corners = tracks_told.ends[moves].reshape(-1, 3)
                low, high = corners.min(axis=0), corners.max(axis=0)
                radius = max(CUTTERS[t].radius for t in tracks_told.cutter[moves])
                edges = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])]) - c[:2]
                along, across = edges @ u[:2], edges @ [-u[1], u[0]]
                aside = max(across.min(), -across.max(), 0.0)
                if aside > radius or low[2] - c[2] >= height:
                    continue
                reach = np.sqrt(radius**2 - aside**2)
                if along.min() - reach <= start and along.max() + reach > furthest_to:
                    best, furthest_to = b, along.max() + reach
        assert found == best
        seen.add(found >= 0)
    assert seen == {True, False}


@pytest.mark.parametrize("angle", [60.0, 90.0, 120.0])
@pytest.mark.parametrize("turn", [0.0, 0.3, 2.0])
def test_a_cone_leaves_a_side_as_steep_on_the_very_rim_of_its_track_as_within(angle, turn):
    """The cone's own angle, out to its full radius; beyond that nothing of it lies over the place."""
    cone, way = Cutter("chamfer", 2 * R, tip_angle=np.radians(angle)), np.array([np.cos(turn), np.sin(turn), 0.0])
    ends = np.concatenate([-5e-3 * way, 5e-3 * way])[None]
    outline = Outline(ends, ends, (cone,), np.zeros(1, dtype=int), 1e-3)
    (told, _), blocks = outline._tracks, outline._blocks
    place = np.concatenate([np.zeros(3), UP, [-way[1], way[0], 0.0]])
    for offset in (0.5 * R, R * (1.0 - 1e-13), -R * (1.0 - 1e-13)):
        low = abs(offset) / np.tan(np.radians(0.5 * angle)) + 1e-12
        found = upright_at(told, blocks, place, offset, low)
        assert found == pytest.approx(np.sin(np.radians(0.5 * angle)), abs=1e-6)
