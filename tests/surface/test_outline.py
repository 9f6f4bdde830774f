"""Walls and floors at single places: against outlines of polygons, and against stamps of the cutter."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from robomill.cutting.tool import Cutter
from robomill.surface.outline import Outline

FLAT, SMALL, BALL = Cutter("flat", 8e-3), Cutter("flat", 5e-3), Cutter("ball", 8e-3)
UP = np.array([0.0, 0, 1])
RAISED = np.array([0, 0, 1e-6, 0, 0, 1e-6])  # m: ends that are left a little higher than they were told
SLACK = np.zeros(1)


def random_walk(rng, n=12, depth=-2e-3):
    """Moves one after the other in plan, (n, 6) m."""
    p = np.column_stack([np.cumsum(rng.normal(0, 4e-3, (n + 1, 2)), axis=0), np.full(n + 1, depth)])
    return np.hstack([p[:-1], p[1:]])


def covered(ends, radii):
    """Polygon of what round tools cover in plan."""
    return shapely.union_all(
        [
            (shapely.LineString([e[:2], e[3:5]]) if np.any(e[:2] != e[3:5]) else shapely.Point(e[:2])).buffer(
                r, quad_segs=500
            )
            for e, r in zip(ends, radii, strict=True)
        ]
    )


def ray_end(polygon, c, u, start):
    """How far from c along u the polygon goes on without a gap, from ``start`` on."""
    ray = shapely.LineString([c + start * u, c + 0.2 * u])
    inside = shapely.intersection(polygon, ray)
    for piece in getattr(inside, "geoms", [inside]):
        along = sorted((np.array(q) - c) @ u for q in piece.coords)
        if along and along[0] <= start + 1e-7:
            return along[-1]
    return np.nan


@pytest.mark.parametrize("seed", range(6))
def test_walls_are_where_the_polygon_ends(seed):
    rng = np.random.default_rng(seed)
    ends = random_walk(rng)
    cutters = (FLAT, SMALL)
    which = rng.integers(0, 2, len(ends))
    reach = 2e-3
    outline = Outline(ends, ends, cutters, which, reach)
    radii = np.array([c.radius for c in cutters])[which]
    polygon = covered(ends, radii)
    checked = 0
    for n in rng.integers(0, len(ends), 60):
        share, angle = rng.uniform(0, 1), rng.uniform(0, 2 * np.pi)
        c, u = ends[n, :3] + share * (ends[n, 3:] - ends[n, :3]), np.array([np.cos(angle), np.sin(angle), 0])
        R = radii[n]
        found, left, one, _ = outline.walls(np.concatenate([c, UP, u])[None], np.array([1e-3]), np.array([R]))
        truth = ray_end(polygon, c[:2], u[:2], R - min(reach, 0.9 * R)) - R
        if np.isfinite(truth) and truth < reach:
            assert found == pytest.approx(truth, abs=2e-7)
            assert left == found
            assert one
            checked += 1
    assert checked > 3


def test_below_every_tip_there_is_no_wall():
    ends = random_walk(np.random.default_rng(0))
    outline = Outline(ends, ends, (FLAT,), np.zeros(len(ends), dtype=int), 1e-3)
    place = np.concatenate([ends[0, :3], UP, [1.0, 0, 0]])[None]
    assert np.isnan(outline.walls(place, np.array([-1e-4]), np.array([4e-3]))[0])


@pytest.mark.parametrize("cutter", [FLAT, BALL, Cutter("bull", 8e-3, corner_radius=1e-3)], ids=lambda c: c.kind)
@pytest.mark.parametrize("seed", range(3))
def test_floors_are_the_lowest_stamp_and_lean_as_it_does(cutter, seed):
    rng = np.random.default_rng(seed)
    ends = random_walk(rng, 6)
    ends[:, [2, 5]] = rng.uniform(-3e-3, -1e-3, (6, 2))
    outline = Outline(ends, ends + RAISED, (cutter,), np.zeros(6, dtype=int), 1e-3)
    t = np.linspace(0, 1, 3001)[:, None]
    for n in range(6):
        c, angle = 0.5 * (ends[n, :3] + ends[n, 3:]), rng.uniform(0, 2 * np.pi)
        u, offset = np.array([np.cos(angle), np.sin(angle), 0]), rng.uniform(-3.5e-3, 3.5e-3)
        at = c + offset * u
        stamps = []
        for e in ends:
            tips = e[:3] + t * (e[3:] - e[:3])
            r = np.hypot(*(at[:2] - tips[:, :2]).T)
            stamps.append((tips[:, 2] + cutter.profile(np.minimum(r, cutter.radius)))[r < cutter.radius])
        truth = np.concatenate(stamps).min() - c[2]
        height, above = (v[0] for v in outline.floors(np.concatenate([c, UP, u])[None], np.array([offset]), SLACK)[:2])
        assert height == pytest.approx(truth, abs=2e-6)
        assert 0.0 <= above <= RAISED[5] * (1.0 + 1e-9)
        if cutter.kind == "flat":  # what its rim leaves on a ramp is as steep as the ramp, or steeper
            slopes = np.abs(ends[:, 5] - ends[:, 2]) / np.hypot(*(ends[:, 3:5] - ends[:, :2]).T)
            assert above == pytest.approx(RAISED[5]) or above <= RAISED[5] / np.hypot(1.0, slopes.min()) * (1.0 + 1e-9)
    assert outline.floors(np.concatenate([c, UP, u])[None], np.zeros(1), SLACK)[2][0]
    far = np.concatenate([[1.0, 1, 0], UP, [1.0, 0, 0]])[None]
    assert np.isposinf(outline.floors(far, np.zeros(1), SLACK)[0][0])


def test_a_leaning_tool_is_asked_in_its_own_axes():
    """A slot along the tilted level of the tool: everything turned about X is the upright slot."""
    ends = np.array([[-0.02, 0, 0, 0.02, 0, 0.0]])
    a = 0.3
    turn = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    for u in ([0, 1.0, 0], [0, -1.0, 0], [1.0, 0, 0]):
        place = np.concatenate([[5e-3, 0, 0], UP, u])[None]
        leaning = np.concatenate([turn @ place[0, i : i + 3] for i in (0, 3, 6)])[None]
        turned = np.hstack([ends[:, :3] @ turn.T, ends[:, 3:] @ turn.T])
        one, two = (Outline(e, e, (FLAT,), np.zeros(1, dtype=int), 1e-3) for e in (ends, turned))
        for q in (
            one.walls(place, np.array([1e-3]), np.array([4e-3])),
            two.walls(leaning, np.array([1e-3]), np.array([4e-3])),
        ):
            assert q[0][0] == pytest.approx(15e-3 if u[0] else 0.0, abs=1e-12)


@pytest.mark.parametrize(("r", "part"), [(0.0, 1.0), (2e-3, np.sqrt(1 - 0.25)), (3.9e-3, np.sqrt(1 - (3.9 / 4) ** 2))])
def test_the_floor_of_a_ball_leans_as_the_ball(r, part):
    ends = np.array([[-0.02, 0, 0, 0.02, 0, 0.0]])
    place = np.concatenate([[0, 0, 0], UP, [0, 1.0, 0]])[None]
    outline = Outline(ends, ends + RAISED, (BALL,), np.zeros(1, dtype=int), 1e-3)
    height, above, _ = outline.floors(place, np.array([r]), SLACK)
    assert height[0] == pytest.approx(4e-3 - np.sqrt(16e-6 - r * r))
    assert above[0] == pytest.approx(RAISED[5] * part)


def test_squares_are_as_wide_as_what_reaches_into_them_and_as_many_as_are_used():
    """Half the longest move and the way it was moved, a cutter either side, the reach; first and last hold moves."""
    rng = np.random.default_rng(9)
    start = np.column_stack([rng.uniform(-0.2, [0.3, 0.1], (200, 2)), np.full(200, -1e-3)])
    told = np.hstack([start, start + rng.uniform(-5e-3, 5e-3, (200, 3))])
    left = told.copy()
    left[7, 1] += 2e-3
    tracks = Outline(told, left, (FLAT, SMALL), np.zeros(200, dtype=int), 1e-3)._tracks
    longest = np.linalg.norm(told[:, 3:] - told[:, :3], axis=1).max()
    middle = 0.5 * (told[:, :2] + told[:, 3:5])
    for track in tracks:
        assert track.size == pytest.approx(2 * 4e-3 + 2 * 1e-3 + 0.5 * longest + 2e-3)
        where = np.floor((middle - track.corner) / track.size).astype(int)
        np.testing.assert_array_equal(where.min(axis=0), 0)
        np.testing.assert_array_equal(where.max(axis=0), track.squares - 1)
        assert len(track.first) == np.prod(track.squares) + 1
        counts = np.zeros(tuple(track.squares), dtype=int)
        np.add.at(counts, tuple(where.T), 1)
        np.testing.assert_array_equal(np.diff(track.first), counts.ravel())
    order = [np.flatnonzero((told == end).all(axis=1))[0] for end in tracks[0].ends]
    np.testing.assert_array_equal(tracks[1].ends, left[order])


def test_a_field_of_very_many_squares_has_larger_ones(monkeypatch):
    monkeypatch.setattr("robomill.surface.outline.MOST_SQUARES", 50)
    for span in ((3.0, 2.0), (40.0, 0.0), (0.0, 40.0)):
        ends = np.array([[0.0, 0, 0, 1e-3, 0, 0], [*span, 0, span[0] + 1e-3, span[1], 0]])
        track = Outline(ends, ends, (FLAT,), np.zeros(2, dtype=int), 1e-3)._tracks[0]
        assert 30 <= np.prod(track.squares) <= 75


@pytest.mark.parametrize("rise", [0.0, 0.02, -0.02])
@pytest.mark.parametrize("push", [(0.12e-3, 0.0), (-0.12e-3, 0.0), (0.05e-3, -0.08e-3), (-0.02e-3, 0.06e-3)])
@pytest.mark.parametrize("cutter", [BALL, Cutter("chamfer", 10e-3, tip_angle=np.pi / 2), FLAT], ids=lambda c: c.kind)
def test_walls_beside_the_middle_of_a_move_are_those_of_its_stamps_and_carried_with_it(cutter, push, rise):
    """At a height, from above: discs as wide as the cutter is there, one at every place of the tip; pushed aside and
    along the axis. It rises so little that the widest disc is that of the middle, to the thousandth of a millimetre."""
    told = np.array([[-8e-3, 0.0, -8e-3 * rise, 8e-3, 0.0, 8e-3 * rise]])
    outline = Outline(told, told + np.tile([0.0, *push], 2), (cutter,), np.zeros(1, dtype=int), 1e-3)
    x, height, r = np.linspace(-8e-3, 8e-3, 40_001), 2.5e-3, np.linspace(0.0, cutter.radius, 20_001)

    def wall(aside, up):
        """Where the line across through the middle leaves the last disc."""
        over = height - rise * x - up
        radius = np.full(len(x), cutter.radius) if cutter.kind == "flat" else np.interp(over, cutter.profile(r), r)
        inside = radius > np.abs(x)
        return aside + np.sqrt(radius[inside] ** 2 - x[inside] ** 2).max()

    own = wall(0.0, 0.0)
    for side in (1.0, -1.0):
        place = np.concatenate([np.zeros(3), UP, [0.0, side, 0.0]])[None]
        found = outline.walls(place, np.array([height]), np.array([own]))
        moved = wall(side * push[0], push[1]) - own
        assert found.told[0] == pytest.approx(0.0, abs=2e-6)
        assert found.left[0] == pytest.approx(moved, abs=2e-6)
        assert found.one[0]
        assert found.carried[0] == pytest.approx(moved, abs=2e-6)


@pytest.mark.parametrize("rise", [1e-3, -1e-3])
def test_a_move_is_a_wall_at_heights_above_its_middle(rise):
    ends = np.array([[-5e-3, 0.0, -2e-3, 5e-3, 0.0, -2e-3 + rise]])
    outline = Outline(ends, ends, (FLAT,), np.zeros(1, dtype=int), 1e-3)
    for start in (ends[0, :3], ends[0, 3:]):
        middle = -2e-3 + 0.5 * rise - start[2]
        place = np.concatenate([start, UP, [0.0, 1.0, 0.0]])[None]
        for above in (-1e-4, 1e-4):
            found = outline.walls(place, np.array([middle + above]), np.array([4e-3])).told
            np.testing.assert_allclose(found, 0.0 if above > 0.0 else np.nan, atol=1e-12)
