"""Single steps with lines of pull, in closed form: lines laid out by hand, decisions at their limits."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import robomill as rm
from robomill.identification.fit.confidence import bisquare
from robomill.identification.load_test import LoadTests
from robomill.identification.pull.lines_of_pull import (
    LinesOfPull,
    _good,
    _grouped,
    _held,
    _judged,
    _Lines,
    _parallel,
    lines_of_pull,
)

MEDIAN = np.sqrt(2.0 * np.log(2.0))  # of the length of two standard normals


def lines(u, p, R=None):
    """Lines through p (m, 3) m along u (m, 3), of tools that stand as R (m, 3, 3) says."""
    made = object.__new__(_Lines)
    made.u = np.asarray(u) / np.linalg.norm(u, axis=1)[:, None]
    made.p = np.asarray(p, dtype=float)
    made.R = np.tile(np.eye(3), (len(made.u), 1, 1)) if R is None else R
    made.across = np.eye(3) - made.u[:, :, None] * made.u[:, None, :]
    return made


def towards(pulleys, which, spread, rng, turned=True):
    """Lines from places around the origin to the pulley of each, missed by about ``spread`` m."""
    m = len(which)
    p = rng.uniform(-0.5, 0.5, (m, 3))
    R = np.linalg.qr(rng.normal(size=(m, 3, 3)))[0] if turned else None
    return lines(np.asarray(pulleys)[which] + spread * rng.standard_normal((m, 3)) - p, p, R)


@pytest.mark.parametrize(("count", "free", "spare"), [(1, False, 37), (1, True, 34), (2, False, 34), (2, True, 31)])
def test_the_typical_gap_is_the_median_ones_by_what_is_spare(count, free, spare):
    """Twenty lines have two gaps each, a pulley and a load point take three."""
    rng = np.random.default_rng(count)
    which = np.arange(20) % count
    gap, chosen, scale = towards([[0, 0, 4.0], [3.0, 0, 0]], which, 0.01, rng).settled(which, free)
    np.testing.assert_array_equal(chosen, which)
    assert scale == pytest.approx(float(np.median(gap)) / MEDIAN * np.sqrt(40 / spare), rel=1e-6)


def test_two_lines_past_each_other_have_half_their_distance_each():
    """Along x and along y, 20 mm apart: four gaps, three numbers of a pulley, one to spare."""
    gap, _, scale = lines([[1.0, 0, 0], [0, 1.0, 0]], [[-1, 0, 0.01], [0, -1, -0.01]]).settled(np.zeros(2, int), False)
    np.testing.assert_allclose(gap, 0.01, rtol=1e-9)
    assert scale == pytest.approx(0.01 / MEDIAN * 2.0)


@pytest.mark.parametrize("free", [False, True])
def test_what_has_settled_is_the_fit_by_its_own_weights(free):
    """Four of twenty-four lines go elsewhere; the fit with the weights that its gaps give has the same gaps."""
    rng, which = np.random.default_rng(5), np.zeros(24, dtype=int)
    made = towards([[0, 0, 1.0], [1.0, 0.5, 1.0]], np.arange(24) // 20, 0.005, rng)
    gap, _, scale = made.settled(which, free)
    shift, pulley, _ = made.fit(which, bisquare(gap / scale), free)
    np.testing.assert_allclose(made.gaps(shift, pulley)[:, 0], gap, atol=1e-5 * scale)
    assert gap[20:].min() > 5 * gap[:20].max() > 0
    alone = lines(made.u[:20], made.p[:20], made.R[:20])
    np.testing.assert_allclose(pulley, alone.fit(which[:20], np.ones(20), free)[1], atol=0.01)


@pytest.mark.parametrize(("first", "sorted_out"), [(4, True), (3, False)])
def test_rows_choose_the_pulley_that_they_pass_unless_it_leaves_another_less_than_four(first, sorted_out):
    rng, right = np.random.default_rng(3), np.repeat([0, 1], [first, 16])
    made = towards([[0, 0, 4.0], [3.0, 0, 0]], right, 0.0, rng)
    start = right.copy()
    start[-1] = 0
    assert np.array_equal(made.settled(start, False)[1], right) == sorted_out


def test_a_pulley_and_a_load_point_are_found_with_their_covariance():
    """Against the normal equations of gaps told by two directions across each line, with and without the point."""
    rng, which = np.random.default_rng(7), np.arange(20) % 2
    made, weight = towards([[0, 0, 4.0], [3.0, 0, 0]], which, 0.01, rng), rng.uniform(0.2, 2.0, 20)
    rows, told = [], []
    for k in range(20):
        for across in np.linalg.svd(made.u[k][None])[2][1:]:
            row = np.zeros(9)
            row[:3], row[3 + 3 * which[k] : 6 + 3 * which[k]] = -across @ made.R[k], across
            rows.append(np.sqrt(weight[k]) * row)
            told.append(np.sqrt(weight[k]) * across @ made.p[k])
    for free, used in ((True, slice(None)), (False, slice(3, None))):
        A = np.array(rows)[:, used]
        z = np.linalg.lstsq(A, np.array(told), rcond=None)[0]
        shift, pulley, covariance = made.fit(which, weight, free)
        np.testing.assert_allclose(np.concatenate([shift, pulley.ravel()])[used], z, rtol=1e-8)
        assert free or not shift.any()
        np.testing.assert_allclose(covariance[used, used], np.linalg.inv(A.T @ A), rtol=1e-8, atol=1e-12)
        assert free or np.isinf(covariance[:3]).all()


def test_gaps_are_distances_of_points_from_lines():
    rng = np.random.default_rng(8)
    made, shift, pulley = (
        towards([[0, 0, 4.0]], np.zeros(5, int), 0.1, rng),
        rng.normal(size=3),
        rng.normal(size=(2, 3)),
    )
    for k in range(5):
        for g in range(2):
            to = pulley[g] - made.p[k] - made.R[k] @ shift
            assert made.gaps(shift, pulley)[k, g] == pytest.approx(np.linalg.norm(np.cross(made.u[k], to)))


@pytest.mark.parametrize(("alike", "said"), [(8, True), (7, False)])
@pytest.mark.parametrize("apart", [0.0, 0.0024])
def test_forces_are_parallel_where_more_than_seven_in_ten_are(alike, apart, said):
    """Within 5 mrad of each other, whichever way they point; the rest each for itself."""
    u = np.linalg.qr(np.random.default_rng(1).normal(size=(10, 3)))[0]
    u = u / np.linalg.norm(u, axis=1)[:, None]
    u[:alike] = [0.0, 0.0, 1.0]
    u[:alike:2] = [np.sin(2 * apart), 0.0, -np.cos(2 * apart)]
    assert _parallel(u) == said


def test_pairs_and_directions_more_than_five_mrad_apart_are_not_parallel():
    """Two of a direction are no crowd, three are."""
    for times, said in ((2, False), (3, True)):
        u = np.repeat(np.random.default_rng(2).normal(size=(6, 3)), times, axis=0)
        assert _parallel(u / np.linalg.norm(u, axis=1)[:, None]) == said
    for step, said in ((0.0049, True), (0.0051, False)):
        angle = step * np.array([0.0, 1.0, 0.5])
        u = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1)
        assert _parallel(u[[0, 0, 1, 1]]) == said


@pytest.mark.parametrize(("metre", "held"), [(249.0, True), (251.0, False), (np.inf, False)])
@pytest.mark.parametrize("at", [0, 2])
def test_a_load_point_is_held_where_two_gaps_of_a_millimetre_move_it_less_than_half_a_metre(at, metre, held):
    unit = np.diag([1.0, 1.0, 1.0, 1e9, 1e9, 1e9])
    unit[at, at] = metre**2
    asked = []
    fake = SimpleNamespace(fit=lambda which, weight, free: (asked.append((weight.tolist(), free)), None, unit))
    assert _held(fake, np.zeros(4, dtype=int)) == held
    assert asked == [([1.0] * 4, True)]


@pytest.mark.parametrize(
    ("scale", "less", "strays", "better"),
    [
        (3.01, 1.0, (0, 0), True),  # less than a third of the scatter
        (2.99, 1.0, (0, 0), False),
        (1.0, 1.9, (4, 0), True),  # four rows fewer astray, for a scatter less than twice as large
        (1.0, 1.9, (3, 0), False),
        (1.0, 1.9, (7, 3), True),
        (1.0, 1.9, (6, 3), False),
        (1.0, 2.1, (9, 0), False),
    ],
)
def test_more_pulleys_are_taken_where_they_are_clearly_better(scale, less, strays, better):
    """A row is astray from 4.685 times the scatter on, where the weight of a bisquare ends."""
    guessed = np.arange(20) % 2
    found = np.arange(20) // 10

    def settled(which, free):
        assert free
        one = not which.any()
        size, astray = (scale, strays[0]) if one else (less, strays[1])
        gap = np.where(np.arange(20) < astray, 4.69, 4.68) * size
        return gap, which if one else found, size

    fake = SimpleNamespace(u=np.zeros((20, 3)), guess=lambda free: guessed, settled=settled)
    np.testing.assert_array_equal(_grouped(fake, True), found if better else np.zeros(20))
    fake.guess = lambda free: np.zeros(20, dtype=int)
    np.testing.assert_array_equal(_grouped(fake, True), np.zeros(20))


def test_a_good_gap_is_what_chance_allows_any_row_once_in_a_hundred_times():
    """Of n rows whose two gaps are normal; twice as much of a force twice as weak for its way; 1 mm at least."""
    far = np.array([1.0, 1.0, 1.0, 2.0, 0.5, 1.0, 1.0])
    limit = 0.01 * np.sqrt(2.0 * np.log(7 / 0.01))
    for share, said in ((0.999, True), (1.001, False)):
        gap = share * limit * np.array([1.0, 1.0, 1.0, 2.0, 1.0, 1.0, 1.0])
        assert (_good(gap, 0.01, far) == said).all()
        assert (_good(np.full(7, share * 1e-3), 1e-6, far) == said).all()


def judged(gap, way, good, free=True, unit=1e-6, m=12):
    """What is made of m rows at one pulley; of the fit with the stated point all gaps are 7 m."""
    nothing = LinesOfPull("parallel", np.arange(1, m + 1), np.empty((0, 3)), np.full(m, -1), np.nan, np.nan)
    asked = []

    def fit(which, weight, freed):
        asked.append((weight.tolist(), freed))
        covariance = unit * np.eye(6)
        covariance[: 0 if freed else 3] = np.inf
        return np.full(3, 0.2) * freed, np.ones((1, 3)), covariance

    fake = SimpleNamespace(
        fit=fit,
        gaps=lambda shift, pulley: (np.asarray(gap) if shift.any() or not free else np.full(m, 7.0))[:, None],
        ways=lambda shift, pulley, which: np.asarray(way),
    )
    found = _judged(fake, nothing, np.zeros(m, dtype=int), free, np.asarray(good))
    assert asked == [(np.asarray(good, dtype=float).tolist(), free), (np.asarray(good, dtype=float).tolist(), False)]
    return found


@pytest.mark.parametrize(("free", "dof"), [(True, 14), (False, 17)])
def test_the_covariance_is_that_of_the_good_gaps(free, dof):
    """Ten good rows of two gaps each; the pulley takes three numbers, the load point three more."""
    gap, good = np.full(12, 0.01), np.arange(12) < 10
    gap[10:], way = 0.5, np.full(12, 4.0)
    way[[2, 11]] = -4.0
    found = judged(gap, way, good, free)
    assert (found.says, found.dof) == ("met", dof)
    assert found.suspects == (11, 12)
    assert found.pushes == (3,), "a suspect is no push"
    np.testing.assert_array_equal(found.gap, gap)
    if not free:
        assert found.shift is found.covariance is None
        return
    np.testing.assert_array_equal(found.gap_stated, 7.0)
    np.testing.assert_allclose(found.covariance, 1e-6 * 10 * 0.01**2 / dof * np.eye(3))
    np.testing.assert_array_equal(found.shift, 0.2)


@pytest.mark.parametrize(
    ("gap", "bad", "says"), [(0.199, 0, "met"), (0.201, 0, "apart"), (0.01, 4, "met"), (0.01, 5, "apart")]
)
def test_lines_are_apart_by_a_twentieth_of_their_way_or_where_a_third_misses(gap, bad, says):
    way = np.where(np.arange(12) % 2 == 0, 4.0, -4.0)
    found = judged(np.full(12, gap), way, np.arange(12) >= bad)
    assert found.says == says
    assert (found.shift is None) == (says == "apart")
    assert len(found.suspects) == (bad if says == "met" else 0)
    assert bool(found.pushes) == (says == "met")


@pytest.mark.parametrize("away", [2.0, 10.0])
def test_pulleys_are_guessed_by_gaps_over_the_way_to_them(away):
    """Lines that miss by a hundredth of their way, however far their pulleys are."""
    rng, which = np.random.default_rng(4), np.arange(20) % 2
    made = towards([[0, 0, away], [away, 0, 0]], which, 0.005 * away, rng)
    found = made.guess(False)
    np.testing.assert_array_equal(found[:, None] == found, which[:, None] == which)


def test_cables_that_are_aimed_by_calculation_say_nothing_and_others_beside_them_do():
    """Five of twenty-four rows are aimed at a pulley that is stated, somewhere else."""
    robot, rng = rm.load_robot("slavkovic_5r"), np.random.default_rng(6)
    theta = rng.uniform(robot.limits[:, 0], robot.limits[:, 1], (24, 5))
    F = np.array([1.5, -3.0, 0.5]) - rm.tool_pose(robot, theta)[:, :3, 3]
    stated = np.where((np.arange(24) % 5 == 2)[:, None], [5.0, 5.0, 5.0], np.nan)
    found = lines_of_pull(robot, LoadTests(F, F, theta=theta, pulley=stated))
    assert found.says == "met"
    np.testing.assert_array_equal(found.row, np.flatnonzero(np.arange(24) % 5 != 2) + 1)
    np.testing.assert_allclose(found.pulley, [[1.5, -3.0, 0.5]], atol=1e-6)
    assert lines_of_pull(robot, LoadTests(F, F, theta=theta, pulley=np.full((24, 3), 5.0))).says == "aimed"
