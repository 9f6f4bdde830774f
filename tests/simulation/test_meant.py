"""Where the samples of a corrected program were meant to be, against paths offset by hand."""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

import robomill as rm
from robomill.errors import ToolpathError
from robomill.simulation.meant import _aligned, _nearest, _places, _stepped, linked, meant, straight_on
from robomill.toolpath.sampling import resample

STEP = 1e-3
TURNED = LEFT_OUT = 2e-3  # m: what is left out, or turned, counts as being so far off


def cut(*points_mm: tuple[float, float]) -> rm.Toolpath:
    """A cut at Z -2 through points in mm, with a rapid to its begin."""
    p = [(*points_mm[0], 5.0), *((x, y, -2.0) for x, y in points_mm)]
    feeds = [0.0, 0.0, *[600.0] * (len(points_mm) - 1)]
    return rm.Toolpath.from_points(p_mm=p, feed_mm_min=feeds)


def places(corrected: rm.Toolpath, wanted: rm.Toolpath) -> np.ndarray:
    """(m, 2) mm: where the samples at feed were meant to be."""
    path = resample(corrected, STEP)
    found = meant(path, resample(wanted, STEP), STEP)[0]
    return np.column_stack([path.p, found.p])[path.cutting][:, [0, 1, 3, 4]] * 1e3


def test_beside_a_line_every_sample_belongs_to_its_foot() -> None:
    found = places(cut((0, 0.2), (60, 0.3)), cut((0, 0), (60, 0)))
    np.testing.assert_allclose(found[:, 2], found[:, 0], atol=1e-9)
    np.testing.assert_allclose(found[:, 3], 0.0, atol=1e-12)


@pytest.mark.parametrize("step", [0.3e-3, 0.35e-3, 0.8e-3])
def test_between_two_samples_of_the_path_there_are_places_up_to_its_very_end(step: float) -> None:
    path = resample(cut((0, 0.2), (20, 0.2)), step)
    found = meant(path, resample(cut((0, 0), (20, 0)), STEP), STEP)[0]
    np.testing.assert_allclose(
        found.p[path.cutting] - path.p[path.cutting], [[0.0, -0.2e-3, 0.0]] * path.cutting.sum(), atol=1e-9
    )


def test_round_a_corner_each_leg_belongs_to_its_own_and_the_link_to_the_corner() -> None:
    """The first leg's correction points along the second one, on which its end lies all the same."""
    corrected = cut((0, 0.3), (40, 0.3), (39.7, 0), (39.7, 40))
    found = places(corrected, cut((0, 0), (40, 0), (40, 40)))
    first = found[:, 1] == 0.3
    np.testing.assert_allclose(found[first][:-1, 3], 0.0, atol=1e-9)
    second = (found[:, 0] == 39.7) & (found[:, 1] > 1.0)
    np.testing.assert_allclose(found[second][:, 2], 40.0, atol=1e-9)
    np.testing.assert_allclose(found[second][:, 3], found[second][:, 1], atol=1e-9)


def test_there_and_back_along_one_line_are_not_taken_for_each_other() -> None:
    found = places(cut((0, 0.2), (50, 0.2), (50, -0.2), (0, -0.2)), cut((0, 0), (50, 0), (0, 0)))
    np.testing.assert_allclose(found[:, 2], np.clip(found[:, 0], 0.0, 50.0), atol=1e-9)
    assert (np.abs(np.diff(found[:, 2])) <= 1.0 + 1e-9).all()


def legs_moved(
    corners: list[tuple[float, float]], normal: float, feed: float
) -> tuple[list[tuple[float, float]], np.ndarray]:
    """Each leg moved to its right and along itself, mm, with straight lines across at the corners; and the corner or
    leg that each of the points was meant for."""
    points, at = [], []
    for a, b in pairwise(np.array(corners)):
        u = (b - a) / np.linalg.norm(b - a)
        c = normal * np.array([u[1], -u[0]]) + feed * u
        points += [tuple(a + c), tuple(b + c)]
        at += [a, b]
    return points, np.array(at)


@pytest.mark.parametrize("normal", [-0.3, 0.05, 0.25])
@pytest.mark.parametrize("feed", [-0.15, -0.0025, 0.0, 0.0025, 0.15])
def test_the_ends_of_legs_belong_to_their_corners_however_far_they_fall_short(normal: float, feed: float) -> None:
    """Around a rectangle and on from it to a larger one: through places and in directions where it has been before."""
    rectangle = [(30.0, -20.0), (30.0, 20.0), (-30.0, 20.0), (-30.0, -20.0), (30.0, -20.0)]
    larger = [(1.5 * x, 1.5 * y) for x, y in rectangle]
    corners = [(0.0, 0.0), *rectangle, *larger]
    points, meant_for = legs_moved(corners, normal, feed)
    path = resample(cut(*points), STEP)
    found = meant(path, resample(cut(*corners), STEP), STEP)[0]
    places = np.column_stack([path.p, found.p])[path.cutting][:, [0, 1, 3, 4]] * 1e3
    after = 0
    for point, corner in zip(points[1:-1], meant_for[1:-1], strict=True):
        i = after + int(np.argmax(np.abs(places[after:, :2] - point).max(axis=1) < 1e-9))
        np.testing.assert_allclose(places[i, :2], point, atol=1e-9)
        np.testing.assert_allclose(places[i, 2:], corner, atol=1e-6)
        after = i
    assert linked(path, found).sum() >= len(corners) - 2


@pytest.mark.parametrize("seed", range(5))
def test_each_sample_is_come_to_from_the_cheapest_before_it(seed: int) -> None:
    """All of them tried: what is left out between two costs as its length, and nothing is gone back."""
    rng = np.random.default_rng(seed)
    for _ in range(20):
        n = int(rng.integers(1, 40))
        s = np.cumsum(rng.choice([0.0, 0.3e-3, 1e-3], n))
        far = rng.choice([0.0, 0.4e-3, 1.2e-3, 5e-3], n)
        total = np.where(rng.random(n) < 0.2, np.inf, rng.uniform(0.0, 1e-5, n))
        total[0] = 0.0
        least, source = _stepped(total, s, far)
        for i in range(n):
            costs = [total[j] + LEFT_OUT * max(s[i] - s[j] - far[i], 0.0) for j in range(i + 1)]
            assert least[i] == pytest.approx(min(costs), abs=1e-11)
            assert costs[source[i]] == pytest.approx(min(costs), abs=1e-11)


@pytest.mark.parametrize("m", [6, 40, 300])
def test_the_first_belongs_to_the_first_and_the_last_to_the_last(m: int) -> None:
    """Though the samples begin two steps later and end two steps earlier; none belongs before the one ahead of it."""
    p = np.column_stack([np.arange(m) * 1e-3, 0.5e-3 * np.sin(np.arange(m)), np.zeros(m)])
    u = np.gradient(p, axis=0)
    u /= np.linalg.norm(u, axis=1)[:, None]
    at = _aligned(p[2:-2] + np.array([0.0, 1e-4, 0.0]), u[2:-2], p, u)
    assert (at[0], at[-1]) == (0, m - 1)
    assert (np.diff(at) >= 0).all()
    if m > 40:
        np.testing.assert_array_equal(at[20:-20], np.arange(22, m - 22))


@pytest.mark.parametrize("seed", range(6))
def test_of_all_ways_to_belong_the_one_that_costs_least_is_taken(seed: int) -> None:
    """Off it and turned from it, squared, and what is left out beyond what a sample, or a step of the path, goes on:
    every sample with every place before it, on a path that winds."""
    rng, m = np.random.default_rng(seed), 40
    p = np.cumsum(rng.uniform(-0.3e-3, 1e-3, (m, 3)) * [1.0, 1.0, 0.0], axis=0)
    q = np.delete(p, rng.choice(np.arange(1, m - 1), 14, replace=False), axis=0) + rng.normal(size=(m - 14, 3)) * 2e-4
    u, t = (np.gradient(each, axis=0) for each in (p, q))
    u, t = (each / np.linalg.norm(each, axis=1)[:, None] for each in (u, t))
    s = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1)))
    goes = np.append(0.0, np.linalg.norm(np.diff(q, axis=0), axis=1))

    def own(i: int, j: int) -> float:
        return float(np.sum((q[i] - p[j]) ** 2) + TURNED**2 * (1.0 - t[i] @ u[j]))

    def left_out(i: int, a: int, b: int) -> float:
        return float(LEFT_OUT * max(s[b] - s[a] - max(goes[i], s[b] - s[b - 1] if b else 0.0), 0.0))

    least = [0.0] + [np.inf] * (m - 1)
    for i in range(1, len(q)):
        least = [min(least[a] + left_out(i, a, b) for a in range(b + 1)) + own(i, b) for b in range(m)]
    at = _aligned(q, t, p, u)
    found = sum(left_out(i, at[i - 1], at[i]) + own(i, at[i]) for i in range(1, len(q)))
    assert found == pytest.approx(least[-1], abs=1e-11)


@pytest.mark.parametrize("seed", range(4))
def test_a_place_is_the_nearest_on_the_two_steps_about_its_sample(seed: int) -> None:
    """On a path that bends by up to 20 degrees a sample, begin and end too, as another library measures lines."""
    rng, m = np.random.default_rng(seed), 30
    way = np.exp(1j * np.cumsum(rng.uniform(-0.35, 0.35, m)))
    z = (30.0 - 40.0j) * 1e-3 * way[0] + np.append(0.0, np.cumsum(rng.uniform(0.3e-3, 1e-3, m - 1) * way[1:]))
    at = np.arange(m)
    q = z + 1e-4 * (rng.normal(size=m) + 1j * rng.normal(size=m))
    p, q, t = (np.column_stack([each.real, each.imag, 0.0 * each.real]) for each in (z, q, way))
    s = np.append(0.0, np.cumsum(np.abs(np.diff(z))))
    found = _nearest(q, t, p, at)
    for i in range(m):
        first = max(i - 1, 0)
        about = shapely.LineString(p[first : i + 2, :2])
        assert found[i] == pytest.approx(s[first] + about.project(shapely.Point(q[i, :2])), abs=1e-10)


@pytest.mark.parametrize(("angle", "on_it"), [(0.0, True), (55.0, True), (65.0, False), (90.0, False), (180.0, False)])
def test_what_goes_another_way_than_a_step_stays_at_its_sample(angle: float, on_it: bool) -> None:
    """Beside the middle of a step: on it where it goes less than 60 degrees another way, whatever is nearer."""
    p = np.column_stack([np.arange(4) * 1e-3, np.zeros(4), np.zeros(4)])
    t = np.array([[np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0]])
    for x, at in ((1.4e-3, 1), (1.4e-3, 2)):
        found = _nearest(np.array([[x, 0.1e-3, 0.0]]), t, p, np.array([at]))
        assert found[0] == pytest.approx(x if on_it else at * 1e-3, abs=1e-12)


@pytest.mark.parametrize(("last", "at", "worst"), [(10e-3, 6, 0.4e-3), (7e-3, 9, 3e-3), (9.3e-3, 9, 0.7e-3)])
def test_what_is_left_out_at_the_end_is_of_the_last_sample(last: float, at: int, worst: float) -> None:
    """Ten samples beside a line of 10 mm, one of which is 0.4 mm off."""
    s = np.linspace(0.0, last, 10)
    p = np.column_stack([np.linspace(0.0, 10e-3, 5), np.zeros(5), np.zeros(5)])
    q = np.column_stack([s, np.full(10, 0.1e-3), np.zeros(10)])
    q[6, 1] = 0.4e-3
    found, far, which = _places(q, p, s)
    np.testing.assert_allclose(found, q * [1.0, 0.0, 0.0], atol=1e-12)
    assert (far, which) == (pytest.approx(worst), at)


def test_a_ring_cut_twice_belongs_turn_by_turn() -> None:
    angle = np.linspace(0.0, 4.0 * np.pi, 721)
    ring = [(20.0 * np.cos(a), 20.0 * np.sin(a)) for a in angle]
    wide = [(1.01 * x, 1.01 * y) for x, y in ring]
    path = resample(cut(*wide), STEP)
    found = meant(path, resample(cut(*ring), STEP), STEP)[0]
    turned = np.unwrap(np.arctan2(found.p[path.cutting][:, 1], found.p[path.cutting][:, 0]))
    assert (np.diff(turned) > -1e-9).all()
    assert turned[-1] - turned[0] == pytest.approx(4.0 * np.pi, rel=0.01)
    np.testing.assert_allclose(np.hypot(*found.p[path.cutting][:, :2].T), 20e-3, atol=2e-6)


def test_a_long_path_is_followed_in_a_time_that_grows_with_it_alone() -> None:
    zigzag = [(x * 100.0, y * 5.0) for y in range(40) for x in ((0, 1) if y % 2 == 0 else (1, 0))]
    found = places(cut(*[(x + 0.1, y - 0.2) for x, y in zigzag]), cut(*zigzag))
    off = found[:, :2] - found[:, 2:]
    assert np.linalg.norm(off, axis=1).max() < 0.3
    assert len(found) > 4000


@pytest.mark.parametrize(
    ("corrected", "words"),
    [
        (cut((0, 5), (60, 5)), "5.000 mm off"),
        (cut((0, 0), (30, 0)), "off it, and a corrected one at most 2 mm"),
    ],
)
def test_another_path_is_refused_by_the_place_where_it_leaves(corrected: rm.Toolpath, words: str) -> None:
    with pytest.raises(ToolpathError, match=words):
        places(corrected, cut((0, 0), (60, 0)))


@pytest.mark.parametrize(("spur", "refused"), [(10.0, True), (1.5, True), (0.6, False)])
def test_a_program_that_leaves_out_more_than_two_millimetres_on_the_way_is_refused(spur: float, refused: bool) -> None:
    """A spur that the path goes up and comes back on, and the program does not."""
    program, wanted = cut((0, 0), (60, 0)), cut((0, 0), (30, 0), (30, spur), (30, 0), (60, 0))
    if refused:
        with pytest.raises(ToolpathError, match="give the path that it was corrected for"):
            places(program, wanted)
    else:
        np.testing.assert_allclose(places(program, wanted)[:, 3], 0.0, atol=spur)


def test_a_path_with_other_cuts_is_refused_by_their_number() -> None:
    two = rm.Toolpath.from_points(
        p_mm=[[0, 0, 5], [0, 0, -2], [20, 0, -2], [20, 0, 5], [40, 0, 5], [40, 0, -2], [60, 0, -2]],
        feed_mm_min=[0, 0, 600, 0, 0, 0, 600],
    )
    with pytest.raises(ToolpathError, match="2 cuts between rapids, and the program 1 cut"):
        places(cut((0, 0), (60, 0)), two)


def test_a_rapid_that_goes_nowhere_parts_no_cut() -> None:
    """As a canned cycle leaves one, or a line with a tool's length alone."""
    p = [[0, 0, 5], [0, 0, -2], [30, 0, -2], [30, 0, -2], [60, 0, -2]]
    path = resample(rm.Toolpath.from_points(p_mm=p, feed_mm_min=[0, 0, 600, 0, 600]), STEP)
    assert (~path.cutting).sum() == 3
    aside = replace(path, p=path.p + np.array([0.0, 0.2e-3, 0.0]))
    found = meant(aside, resample(cut((0, 0), (60, 0)), STEP), STEP)[0]
    np.testing.assert_allclose(found.p[found.cutting], path.p[path.cutting], atol=1e-9)
    back = meant(resample(cut((0, 0.2), (60, 0.2)), STEP), path, STEP)[0]
    np.testing.assert_allclose(back.p[back.cutting][:, 1], 0.0, atol=1e-12)


@pytest.mark.parametrize("stops", [(), (0,), (1,), (0, 1)])
def test_a_plunge_at_feed_belongs_to_the_one_that_was_meant_at_the_same_height_above_its_end(stops: tuple) -> None:
    """Wherever one of them, or both, stand still on the way down."""

    def plunged(x: float, deep: float, stop: bool) -> rm.Toolpath:
        p = [(x, 0.0, 5.0), (x, 0.0, 1.0), *[(x, 0.0, -0.6)] * (2 * stop), (x, 0.0, -deep), (40.0, 0.0, -deep)]
        return rm.Toolpath.from_points(p_mm=p, feed_mm_min=[0.0, 0.0, *[300.0] * (len(p) - 3), 600.0])

    path = resample(plunged(0.02, 2.05, 0 in stops), STEP)
    found = meant(path, resample(plunged(0.0, 2.0, 1 in stops), STEP), STEP)[0]
    plunge = path.cutting & (np.abs(path.p[:, 0] - 0.02e-3) < 1e-9)
    assert plunge.sum() > 2
    np.testing.assert_allclose(found.p[plunge, :2], 0.0, atol=1e-9)
    np.testing.assert_allclose(found.p[plunge, 2], np.minimum(path.p[plunge, 2] + 0.05e-3, 1e-3), atol=1e-9)


def test_of_two_plunges_in_one_cut_each_belongs_to_its_own() -> None:
    """The second goes on down where the first has led; both ends are 0.05 mm too deep."""

    def stairs(x: float, deeper: float) -> rm.Toolpath:
        p = [
            (x, 0, 5),
            (x, 0, 1),
            (x, 0, -2 - deeper),
            (40 + x, 0, -2 - deeper),
            (40 + x, 0, -6 - deeper),
            (60, 0, -6 - deeper),
        ]
        return rm.Toolpath.from_points(p_mm=p, feed_mm_min=[0, 0, 300, 600, 300, 600])

    path = resample(stairs(0.02, 0.05), STEP)
    found = meant(path, resample(stairs(0.0, 0.0), STEP), STEP)[0]
    for x, top in ((0.0, 1e-3), (40e-3, -2e-3)):
        down = path.cutting & (np.abs(path.p[:, 0] - x - 0.02e-3) < 1e-9)
        assert down.sum() > 3
        np.testing.assert_allclose(found.p[down, 0], x, atol=1e-9)
        np.testing.assert_allclose(found.p[down, 2], np.minimum(path.p[down, 2] + 0.05e-3, top), atol=1e-9)


TURNING = [(0, 0), (10, 0), (10, 0), (20, 0), (20, 0), (20, 10), (20, 10)]
RING = [(0, 0), (10, 0), (10, 10), (-10, 10), (-10, 0), (0, 0)]
BENT = [(0, 0), (10, 0), (10, 0), (20, 0.1), (20, 0.1), (30, 9)]


@pytest.mark.parametrize(
    ("points", "rapids", "expected"),
    [
        (TURNING, [], [2]),  # and neither at the corner nor at the end
        (TURNING, [1], []),  # a cut begins
        (TURNING, [2], []),
        (BENT, [0], [2]),
        (RING, [], []),  # its end is not before its begin
    ],
)
def test_a_move_of_no_length_goes_straight_on_where_its_two_neighbours_do(
    points: list[tuple[float, float]], rapids: list[int], expected: list[int]
) -> None:
    p = np.array([(x + 200.0, y - 300.0, -2.0) for x, y in points]) * 1e-3
    path = rm.Toolpath.from_points(p, 0.01, cutting=~np.isin(np.arange(len(p)), rapids))
    assert np.flatnonzero(straight_on(path, path)).tolist() == expected


def steps(points: list[tuple[float, float]], cutting: list[int]) -> rm.Toolpath:
    """A path through points (x, y) mm as ``linked`` sees one."""
    p = np.array([(x, y, 0.0) for x, y in points]) * 1e-3
    length = np.linalg.norm(np.diff(p, axis=0, prepend=p[:1]), axis=1)
    return SimpleNamespace(p=p, step_length=length, cutting=np.array(cutting, dtype=bool))  # type: ignore[return-value]


WANTED = [(0, 0), (10, 0), (10, 0), (10, 0), (10, 0), (10, 10)]


@pytest.mark.parametrize(
    ("told", "cutting", "inside"),
    [
        ([(0, 0), (10, 0), (10.1, 0), (10.1, 0.1), (10, 0), (10, 10)], [1, 1, 1, 1, 1, 1], [2, 3]),
        (
            [(0, 0), (10, 0), (10.005, 0), (10.005, 0.005), (10, 0), (10, 10)],
            [1, 1, 1, 1, 1, 1],
            [],
        ),  # shorter than a link
        (
            [(0, 0), (10, 0), (10.1, 0), (10.1, 0.1), (10, 0), (10, 10)],
            [1, 1, 0, 1, 1, 1],
            [],
        ),  # a rapid, and behind it
        ([(0, 0), (10, 0), (10.1, 0), (10.1, 0.1), (10, 0), (10, 10)], [1, 1, 1, 0, 1, 1], [2]),
    ],
)
def test_links_are_what_stands_between_two_cuts_at_one_place(
    told: list[tuple[float, float]], cutting: list[int], inside: list[int]
) -> None:
    found = linked(steps(told, cutting), steps(WANTED, cutting))
    assert np.flatnonzero(found).tolist() == inside


def test_on_its_way_nobody_knows_how_far_along_a_program_was_meant_to_be_that_is_corrected_along_its_feed() -> None:
    """Around a corner, moved along each leg: known are the ends of the legs. By what it says, or by both ends of a leg
    sent the same way; a program that says that its feed was not corrected is known all along."""
    corners = [(0.0, 0.0), (40.0, 0.0), (40.0, 30.0)]
    for feed, said, legs in (
        (0.1, ("normal", "feed"), 2),
        (0.0, ("feed",), 2),
        (0.1, (), 2),
        (0.015, (), 0),
        (0.1, ("normal", "axial"), 0),
    ):
        path = resample(cut(*legs_moved(corners, 0.2, feed)[0]), STEP)
        found, untold = meant(path, resample(cut(*corners), STEP), STEP, said)
        ends = {tuple(corner) for corner in corners}
        known = np.array([tuple(np.round(p[:2] * 1e3, 6)) in ends for p in found.p])
        assert not untold[~path.cutting].any()
        assert (untold | known)[path.cutting].all() == (legs == 2)
        assert untold.any() == (legs == 2)
        for corner in corners:  # at each end a sample is known
            assert (~untold & (np.abs(found.p[:, :2] * 1e3 - corner).max(axis=1) < 1e-6)).any()
