"""How sure a measured map says it is, against the noise and the bend that were put in."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.identification.map_error import (
    PART_BETWEEN,
    between_points,
    errors_of_tests,
    noise_by_asymmetry,
    noise_of_tests,
    shows_bend,
)


def symmetric(rng, k):
    A = rng.normal(size=(k, 3, 3))
    return A + np.swapaxes(A, 1, 2)


def test_the_noise_of_an_entry_shows_in_what_is_not_symmetric():
    rng = np.random.default_rng(1)
    C = symmetric(rng, 4000)
    assert np.isnan(noise_by_asymmetry(C))
    assert noise_by_asymmetry(C + rng.normal(0.0, 0.03, C.shape)) == pytest.approx(0.03, rel=0.02)


def test_the_noise_of_a_reading_is_shown_or_stated_whichever_is_more():
    """An entry's error is its reading's times what the forces make of it (1/N)."""
    rng = np.random.default_rng(2)
    C, spread = symmetric(rng, 4000), rng.uniform(0.002, 0.02, (4000, 3))
    noisy = C + 0.5 * rng.normal(size=C.shape) * spread[:, None, :]
    silent = np.full(5, np.nan)
    assert noise_of_tests(noisy, spread, silent) == pytest.approx(0.5, rel=0.03)
    assert noise_of_tests(noisy, spread, np.array([0.1, np.nan])) == pytest.approx(0.5, rel=0.03)
    assert noise_of_tests(noisy, spread, np.array([0.9, 0.7, np.nan, 0.8])) == pytest.approx(0.8)
    assert np.isnan(noise_of_tests(C, spread, silent))
    assert noise_of_tests(C, spread, np.array([0.2])) == pytest.approx(0.2)


@pytest.mark.parametrize("share", [0.0, 0.05])
def test_loads_that_err_by_a_share_show_in_what_is_not_symmetric(share):
    """Entries far from 1 in size: an error that is alike leaves the same everywhere, a share of them does not."""
    rng = np.random.default_rng(4)
    C = symmetric(rng, 3000) * 3.0
    spread = rng.uniform(0.5, 2.0, (3000, 3))
    noisy = C * (1.0 + share * rng.normal(size=C.shape)) + 0.1 * rng.normal(size=C.shape) * spread[:, None, :]
    found = errors_of_tests(noisy, spread, np.abs(noisy), np.full(3000, np.nan))
    truth = np.sqrt((0.1 * spread[:, None, :]) ** 2 + (share * C) ** 2)
    assert np.median(found / truth) == pytest.approx(1.0, abs=0.05)
    assert np.mean(np.abs(noisy - C) <= 1.96 * found, axis=0) == pytest.approx(np.full((3, 3), 0.95), abs=0.02)


def test_a_bent_field_is_missed_between_points_by_a_quarter_of_its_gap():
    """c x^2 on a line of points h apart: a straight line between two points misses c h^2 / 4 in the middle."""
    h, c = 0.1, 7.0
    x = h * np.arange(21)[:, None]
    C = np.zeros((21, 3, 3))
    C[:, 1, 2] = c * x[:, 0] ** 2
    found = between_points(x, C, np.zeros_like(C))
    middle = 0.5 * (x[1:] + x[:-1])[:, 0]
    missed = np.interp(middle, x[:, 0], C[:, 1, 2]) - c * middle**2
    assert found[1, 2] == pytest.approx(np.sqrt(np.mean(missed**2)))
    assert found[1, 2] == pytest.approx(PART_BETWEEN * c * h**2)
    assert np.count_nonzero(found) == 1


@pytest.mark.parametrize("counts", [(5, 4), (3, 3), (4, 5, 3)])
def test_in_the_middle_of_a_cell_what_is_missed_along_every_axis_adds_up(counts):
    """Of a paraboloid the mean of a cell's corners misses the middle by the sum over its axes."""
    rng = np.random.default_rng(len(counts))
    h, c = rng.uniform(0.1, 0.6, len(counts)), rng.uniform(1.0, 4.0, len(counts))
    p = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, len(counts)) * h
    p = p[rng.permutation(len(p))]
    C = np.ones((len(p), 3, 3)) * (p**2 @ c)[:, None, None]
    corners = np.stack(np.meshgrid(*([[0.0, 1.0]] * len(counts)), indexing="ij"), axis=-1).reshape(-1, len(counts)) * h
    missed = np.mean(corners**2 @ c) - (h / 2) ** 2 @ c
    assert between_points(p, C, np.zeros_like(C)) == pytest.approx(missed, rel=1e-4)  # lines of a grid are told to 1 um


def test_of_two_unequal_gaps_the_wider_one_is_what_is_missed():
    x = np.array([[0.0], [0.1], [0.4]])
    C = 5.0 * x[:, :, None] ** 2 * np.ones((3, 3))
    missed = (0.1**2 + 0.4**2) / 2 * 5.0 - 0.25**2 * 5.0  # in the middle of the wider one
    assert between_points(x, C, np.zeros_like(C)) == pytest.approx(missed)


def test_points_that_lie_anyhow_show_the_bend_of_both_axes():
    """A square grid turned by 30 degrees is none along the axes; inside, each point's neighbours are as before."""
    h, c = 0.2, 3.0
    p = h * np.stack(np.meshgrid(np.arange(9.0), np.arange(9.0), indexing="ij"), axis=-1).reshape(-1, 2)
    C = c * (p**2).sum(axis=1)[:, None, None] * np.ones((3, 3))
    turn = np.array([[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]])
    assert between_points(p @ turn.T, C, np.zeros_like(C)) == pytest.approx(2 * c * (h / 2) ** 2)


def test_one_point_between_two_shows_a_bend_and_two_points_do_not():
    """c x^2 at -h, 0, h: the middle lies c h^2 off its neighbours' line, and nothing surrounds the ends."""
    h, c = 0.2, 3.0
    x = h * np.array([[-1.0], [0.0], [1.0]])
    C = c * x[:, :, None] ** 2 * np.ones((3, 3))
    assert between_points(x, C, np.zeros_like(C)) == pytest.approx(PART_BETWEEN * c * h**2)
    assert not between_points(x[:2], C[:2], np.zeros_like(C[:2])).any()


def test_noise_is_not_taken_for_a_bend():
    rng = np.random.default_rng(3)
    p = np.stack(np.meshgrid(np.arange(30.0), np.arange(30.0), indexing="ij"), axis=-1).reshape(-1, 2)
    flat = np.broadcast_to((p @ [2.0, -1.0])[:, None, None], (900, 3, 3))
    noisy = flat + rng.normal(0.0, 0.4, flat.shape)
    taken = between_points(p, noisy, np.zeros(flat.shape))  # two axes, at each of which the noise alone bends
    assert taken == pytest.approx(2 * PART_BETWEEN * 0.4 * np.sqrt(1.5), rel=0.1)
    assert between_points(p, noisy, np.full(flat.shape, 0.4)).max() < 0.45 * taken.min()


@pytest.mark.parametrize("p", [np.zeros((4, 0)), np.arange(2.0)[:, None]])
def test_points_that_nothing_surrounds_say_nothing(p):
    C = np.random.default_rng(0).normal(size=(len(p), 3, 3))
    np.testing.assert_array_equal(between_points(p, C, np.zeros_like(C)), 0.0)


def test_what_the_noise_of_each_point_makes_of_a_gap_is_taken_off_it():
    """That of the middle point, and a quarter of the squares of its two neighbours', who count half each."""
    x, own = np.array([[-1.0], [0.0], [1.0]]), np.array([0.3, 0.2, 0.5])
    C = np.abs(x)[:, :, None] * np.ones((3, 3))
    gap = PART_BETWEEN * np.sqrt(1.0 - 0.2**2 - (0.3**2 + 0.5**2) / 4.0)
    assert between_points(x, C, own[:, None, None] * np.ones((3, 3, 3))) == pytest.approx(gap)


@pytest.mark.parametrize(
    ("counts", "shown"),
    [((3,), True), ((2,), False), ((3, 3), True), ((3, 2), False), ((2, 2), False), ((4, 3, 3), True)],
)
def test_a_bend_is_shown_where_a_point_of_each_axis_lies_between_others(counts, shown):
    """By a field that is bent along every axis: what is said to be missed leaves none out just where it is shown."""
    lines = [np.linspace(0.0, 0.1 * n, n) for n in counts]
    p = np.stack([x.ravel() for x in np.meshgrid(*lines, indexing="ij")], axis=1)
    assert shows_bend(p) is shown
    each = [
        between_points(p, np.multiply.outer(p[:, i] ** 2, np.ones((3, 3))), np.zeros((len(p), 3, 3)))
        for i in range(len(counts))
    ]
    assert all(found.all() for found in each) is shown


def test_points_that_lie_anyhow_show_a_bend_where_others_surround_one():
    corners = np.array([[0.0, 0.0], [1.0, 0.1], [0.1, 1.0], [1.1, 1.0]])
    assert not shows_bend(corners)
    assert shows_bend(np.vstack([corners, [[0.55, 0.52]]]))
