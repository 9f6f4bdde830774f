"""How corrections are sought, step by step: laws whose fixed point is known, places at which several samples stand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from robomill.improve.correction import Places, _meeting, _Seeking, _settled


@pytest.mark.parametrize(
    ("runs", "last", "enough"),
    [(1, 0.5e-6, True), (1, 0.51e-6, False), (12, 4e-6, False), (13, 4e-6, True), (13, 5.1e-6, False)],
)
def test_half_a_micrometre_is_settled_and_after_twelve_runs_five(runs: int, last: float, enough: bool) -> None:
    assert _settled([1.0] * (runs - 1) + [last]) == enough


def test_a_straight_law_is_settled_by_its_second_change_or_falls_by_its_slope() -> None:
    """asked = goal + q (c - goal): the second change takes 1 / (1 - q) of what is asked, at least a tenth, never more
    than all."""
    q = np.array([-3.0, -1.0, -0.25, 0.5, 0.9, -19.0])
    goal = np.random.default_rng(3).normal(size=(len(q), 3)) * 0.2e-3
    seeking = _Seeking.begin(len(q))
    for n in range(3):
        asked = goal + q[:, None] * (seeking.c - goal)
        rest = np.linalg.norm(seeking.c - goal, axis=1)
        expected = rest * np.abs(1.0 + (1.0 if n == 0 else np.clip(1.0 / (1.0 - q), 0.1, 1.0)) * (q - 1.0))
        assert seeking.change(asked) == pytest.approx((rest * np.abs(q - 1.0)).max())
        seeking = seeking.looked(asked).moved(asked)
        np.testing.assert_allclose(np.linalg.norm(seeking.c - goal, axis=1), expected, atol=1e-15)


def test_what_is_given_up_keeps_the_correction_that_came_closest() -> None:
    """Three samples, two of them at one place; changes asked for by their sizes, in turn."""
    place, way = np.array([0, 1, 1]), np.array([1.0, 0.0, 0.0])
    seeking, at = _Seeking.begin(3), []
    for sizes in ([4e-6, 9e-6, 1e-6], [1e-6, 3e-6, 1e-6], [6e-6, 8e-6, 1e-6]):
        asked = seeking.c + np.outer(sizes, way)
        at.append(seeking.c)
        seeking = seeking.looked(asked).moved(asked)
    np.testing.assert_allclose(seeking.least, [1e-6, 3e-6, 1e-6])
    np.testing.assert_allclose(seeking.best, [at[1][0], at[1][1], at[0][2]])
    first = seeking.giving_up(place)
    assert not first.held.any()  # never looked at before
    later = first.giving_up(place)
    assert later.held.all()  # none has come closer since
    closer = first.looked(first.c + np.outer([0.4e-6, 2e-6, 0.4e-6], way)).giving_up(place)
    assert closer.held.tolist() == [False, True, True]  # and what stands at one place goes together
    half = first.looked(first.c + np.outer([0.45e-6, 1.4e-6, 0.45e-6], way)).giving_up(place)
    assert not half.held.any()
    asked = later.c + np.outer([5e-6, 5e-6, 5e-6], way)
    np.testing.assert_array_equal(later.moved(asked).c, later.best)
    assert later.change(asked) == 0.0
    assert closer.change(closer.c + np.outer([2e-6, 9e-6, 9e-6], way)) == pytest.approx(2e-6)


def test_a_place_that_was_right_once_is_given_up_if_it_never_is_again() -> None:
    """At first nothing pushes there; then what is asked goes to and fro with what its neighbours do."""
    place, way = np.zeros(1, dtype=int), np.array([1.0, 0.0, 0.0])
    seeking = _Seeking.begin(1)
    for n in range(1, 16):
        asked = seeking.c + 0.1e-3 * way * (0.0 if n == 1 else 1.0)
        seeking = seeking.looked(asked)
        if n % 5 == 0:
            seeking = seeking.giving_up(place)
        seeking = seeking.moved(asked)
    assert seeking.held.all()


@pytest.mark.parametrize("turn", [20.0, 90.0, 115.0, 130.0, 150.0])
def test_two_offset_lines_meet_unless_that_is_more_than_twice_as_far_off(turn: float) -> None:
    angles = np.radians([0.0, turn])
    n = np.column_stack([-np.sin(angles), np.cos(angles), np.zeros(2)])
    size = np.array([0.1e-3, 0.1e-3])
    own = size[:, None] * n
    inverse = np.linalg.pinv(np.einsum("mi,mj->ij", n, n), rcond=1e-2, hermitian=True)[None]
    (met,) = _meeting(inverse, own, np.zeros(2, dtype=np.int64))
    if 1.0 / np.cos(np.radians(0.5 * turn)) <= 2.0:
        np.testing.assert_allclose(n @ met, size, atol=1e-15)
        assert met[2] == pytest.approx(0.0, abs=1e-15)
    else:
        np.testing.assert_allclose(met, own.mean(axis=0), atol=1e-15)


def straight(cutting: list[int], place: list[int], steep: list[int] | None = None) -> Places:
    """Samples along x with an upright tool, some of them at one place."""
    m = len(cutting)
    path = SimpleNamespace(
        cutting=np.array(cutting, dtype=bool),
        k=np.tile([0.0, 0.0, 1.0], (m, 1)),
        step_length=1e-3 * np.diff(place, prepend=place[0] - 1),
    )
    down = np.zeros(m, dtype=bool) if steep is None else np.array(steep, dtype=bool)
    return Places(path, np.array(place), np.full(m, -1), down, *np.zeros((4, m), dtype=bool))  # type: ignore[arg-type]


def test_where_the_tool_is_outside_it_has_the_correction_of_the_next_sample_that_is_pushed_else_of_the_last() -> None:
    """In its own cut: two of them, with a rapid between, which arrives where the second one begins."""
    places = straight([0, 1, 1, 1, 1, 1, 0, 0, 1, 1, 1], [0, 1, 2, 3, 4, 5, 6, 7, 7, 8, 9])
    pushed = np.array([0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 1], dtype=bool)
    outside = np.array([1, 1, 0, 0, 0, 1, 1, 1, 1, 0, 0], dtype=bool)
    c = np.column_stack([np.arange(11.0), np.zeros(11), np.zeros(11)])
    found = places.held_outside(c.copy(), pushed, outside)[:, 0]
    # a rapid, before the push, pushed twice, in the stock, behind it; a rapid, its end; before, in the stock, at it
    assert found.tolist() == [0, 2, 2, 3, 4, 3, 6, 10, 10, 9, 10]


def test_on_the_way_out_nothing_is_held() -> None:
    places = straight([1, 1, 1, 1], [0, 1, 2, 3])
    places.out[2:] = True
    c = np.column_stack([np.arange(4.0), np.zeros(4), np.zeros(4)])
    found = places.held_outside(c, np.array([0, 1, 0, 0], dtype=bool), np.array([1, 0, 1, 1], dtype=bool))[:, 0]
    assert found.tolist() == [1, 1, 2, 3]


@pytest.mark.parametrize(("apart", "one"), [(1.9e-6, True), (2.1e-6, False)])
def test_a_plunge_is_corrected_aside_as_one_where_its_own_hardly_differ(apart: float, one: bool) -> None:
    """As its last sample; along the tool each keeps its own."""
    places = straight([1] * 6, list(range(6)), [0, 1, 1, 1, 0, 0])
    c = np.random.default_rng(1).normal(size=(6, 3)) * 1e-3
    c[1:4, :2] = c[3, :2]
    c[1, 1] += apart
    found = places.upright(c.copy())
    expected = c.copy()
    if one:
        expected[1, 1] = c[3, 1]
    np.testing.assert_allclose(found, expected, atol=1e-15)


def test_at_one_place_each_undoes_what_one_for_all_would_leave_by_more_than_a_link() -> None:
    """Two samples pushed aside by 0.1 mm and by so much more; single ones undo their own; the height is the highest."""
    across = np.diag([0.0, 1.0, 1.0])
    for more, shared in ((30e-6, True), (60e-6, False)):
        places = straight([1, 1, 1, 1], [0, 1, 1, 2])
        d = np.array([[7.0, 50.0, 1.0], [7.0, 100.0, -2.0], [7.0, 100.0 + more * 1e6, -3.0], [7.0, -9.0, 4.0]]) * 1e-6
        c = places.one_each(np.tile(across, (4, 1, 1)), d, np.ones(4, dtype=bool))
        np.testing.assert_allclose(c[[0, 3]], -d[[0, 3]] * [0.0, 1.0, 1.0], atol=1e-15)
        mean = -0.5 * (d[1, 1] + d[2, 1])
        np.testing.assert_allclose(c[1:3, 1], [mean, mean] if shared else -d[1:3, 1], atol=1e-15)
        np.testing.assert_allclose(c[1:3, 2], 3e-6, atol=1e-15)
        np.testing.assert_allclose(c[:, 0], 0.0, atol=1e-15)


@pytest.mark.parametrize(("apart", "one"), [(1.9e-6, True), (2.1e-6, False)])
def test_a_plunge_is_corrected_as_its_last_sample_is_which_may_be_its_only_one(apart: float, one: bool) -> None:
    places = straight([1] * 6, list(range(6)), [1, 1, 1, 0, 1, 0])
    c = np.random.default_rng(1).normal(size=(6, 3)) * 1e-3
    c[:3, :2] = c[2, :2]
    c[2, 0] += apart
    expected = c.copy()
    if one:
        expected[:3, :2] = c[2, :2]
    np.testing.assert_allclose(places.upright(c.copy()), expected, atol=1e-15)
