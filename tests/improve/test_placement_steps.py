"""Single steps of the search for a place: where it starts, what lies around, what is written, by loops over all."""

from __future__ import annotations

from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest

from robomill.improve import placement as module
from robomill.improve.area import grid
from robomill.improve.placed import FINE, KEPT_OUT, NO_ROOM, SINGULAR, UNKNOWN, UNREACHED, WHY
from robomill.improve.placement import STARTS, _Search, _spacing, _worst_samples
from robomill.improve.screening import Standing
from robomill.kinematics.dexterity import NEAR

AXES = (np.arange(4) * 0.1, np.arange(5) * 0.05, np.array([0.01]), np.radians(np.arange(3) * 30.0))


def search(lower: list[float], upper: list[float], **given: object) -> SimpleNamespace:
    box = SimpleNamespace(lower=np.array(lower), upper=np.array(upper), meets=lambda at: at[:, 0] < 0.05)
    own = SimpleNamespace(area=box, room=0.1, **given)
    own._written = lambda at: _Search._written(own, at)  # type: ignore[arg-type]
    return own


def test_neighbours_stand_apart_by_the_widest_gap_of_each_axis() -> None:
    axes = (np.array([0.0, 0.1, 0.3]), np.array([2.0]), np.array([0.0, 0.5]), np.array([-1.0, -0.25, 0.0]))
    np.testing.assert_allclose(_spacing(axes), [0.2, 0.0, 0.5, 0.75])


@pytest.mark.parametrize("seed", range(5))
def test_a_search_starts_at_the_best_places_that_are_no_neighbours_of_a_better_one(seed: int) -> None:
    rng, numbers = np.random.default_rng(seed), list(product(*(range(len(axis)) for axis in AXES)))
    share = rng.uniform(0.2, 2.0, len(numbers))
    share[rng.random(len(numbers)) < (0.2, 0.2, 0.2, 0.98, 1.0)[seed]] = np.nan
    chosen: list[tuple[int, ...]] = []
    for _, number in sorted((each, number) for each, number in zip(share, numbers, strict=True) if each == each):
        if all(max(abs(a - b) for a, b in zip(number, other, strict=True)) > 1 for other in chosen):
            chosen.append(number)
    found = _Search._starts(search([0.0] * 4, [1.0] * 4), AXES, share)  # type: ignore[arg-type]
    expected = [[axis[i] for axis, i in zip(AXES, number, strict=True)] for number in chosen[:STARTS]]
    assert len(found) == len(expected)
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one, other)
    assert len(grid(AXES)) == len(numbers)


def test_around_a_place_lie_its_neighbours_in_every_direction_that_is_free() -> None:
    own = search([0.0, -1.0, 0.02, 0.0], [1.0, 1.0, 0.02, 1.0])
    at, size = np.array([0.5, 0.0, 0.02, 0.5]), np.array([0.1, 0.2, 0.3, np.radians(1.0)])
    found = {tuple(np.round(each - at, 12)) for each in _Search._around(own, at, size)}  # type: ignore[arg-type]
    assert len(found) == 26
    for step in found:
        assert step[2] == 0.0
        for k in (0, 1):
            assert min(abs(abs(step[k]) - size[k]), abs(step[k])) < 1e-9
        turn = np.round(np.degrees(0.5 + step[3]), 9) - 28.6478897565
        assert min(abs(abs(turn) - 1.0), abs(turn)) < 0.011  # what is written is rounded


def test_a_place_is_written_in_tenths_of_a_millimetre_and_hundredths_of_a_degree_within_its_box() -> None:
    rng, own = np.random.default_rng(8), search([-0.5, -0.5, 0.01234, -1.0], [0.5, 0.5, 0.01234, 1.0])
    for at in rng.uniform(-0.49, 0.49, (50, 4)):
        found = _Search._written(own, at)  # type: ignore[arg-type]
        mm, degrees = found[:2] / 1e-4, np.degrees(found[3]) / 0.01
        assert np.abs(mm - np.round(mm)).max() < 1e-6
        assert abs(degrees - np.round(degrees)) < 1e-6
        assert np.abs(found - at)[:2].max() <= 0.5e-4 + 1e-12
        assert abs(found[3] - at[3]) <= np.radians(0.005) + 1e-12
        assert found[2] == 0.01234
    written = _Search._written(own, np.array([0.9, -0.9, 0.01, 2.0]))  # type: ignore[arg-type]
    np.testing.assert_allclose(written, [0.5, -0.5, 0.01234, 1.0])
    between = search([-0.5, -0.5, 0.0, -1.0], [0.5, 0.5, 0.1, 1.0])
    assert _Search._written(between, np.array([0.0, 0.0, 0.01234, 0.0]))[2] == pytest.approx(0.0123)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("known", "room", "det", "x", "allowed"),
    [
        (True, 0.1, 0.5, 0.1, True),
        (False, 0.1, 0.5, 0.1, False),
        (True, 0.09, 0.5, 0.1, False),
        (True, 0.1, 1e-9, 0.1, False),
        (True, 0.1, 0.5, 0.04, False),
    ],
)
def test_a_place_is_allowed_that_is_known_with_room_far_from_singular_and_outside_what_is_kept_out(
    known: bool, room: float, det: float, x: float, allowed: bool
) -> None:
    found = SimpleNamespace(known=known, room=room, det=det)
    assert bool(_Search.allows(search([0.0] * 4, [1.0] * 4), found, np.array([x, 0.0, 0.0, 0.0]))) == allowed  # type: ignore[arg-type]


@pytest.mark.parametrize(("seed", "kept"), [(0, 0), (1, 4), (2, 11), (3, 12)])
def test_of_places_none_of_which_is_allowed_the_nearest_misses_least_and_of_those_has_most_room(
    seed: int, kept: int
) -> None:
    """One in a keep-out box is none of them; and how many there are for which reason is told."""
    rng = np.random.default_rng(seed)
    places = np.column_stack([rng.uniform(-1.0, 1.0, (12, 3)), np.zeros(12)])
    missed, room = rng.integers(0, 3, 12), rng.uniform(-0.5, 0.5, 12)
    room[5] = np.nan
    why = np.where(missed > 0, UNREACHED, NO_ROOM)
    why[rng.permutation(12)[:kept]] = KEPT_OUT
    asked = []

    def simulated(at: np.ndarray) -> tuple[SimpleNamespace, None]:
        asked.append(at)
        return SimpleNamespace(reason="too far", room=0.01), None

    stands = SimpleNamespace(room=room, missed=missed)
    words = str(_Search._nowhere(SimpleNamespace(simulated=simulated), places, stands, why))  # type: ignore[arg-type]
    counts = [(code, int((why == code).sum())) for code in (UNREACHED, NO_ROOM, KEPT_OUT)]
    assert ", ".join(f"{count} {WHY[code]}" for code, count in counts if count) in words
    open_ = [i for i in range(12) if why[i] != KEPT_OUT]
    assert len(asked) == bool(open_)
    if open_:
        nearest = min(open_, key=lambda i: (missed[i], -room[i] if room[i] == room[i] else 9.0))
        np.testing.assert_array_equal(asked[0], places[nearest])


def test_a_run_is_worst_where_its_readings_and_its_tip_are_and_where_it_is_first_missed() -> None:
    """The first sample of a path may be one of them; of what has no reading there is none."""
    wall, floor, feed, end = (SimpleNamespace(worst=worst) for worst in (0, 7, -1, 3))
    run = SimpleNamespace(verdict=SimpleNamespace(wall=wall, floor=floor, feed=feed, end=end), worst=5)
    for lost, first in (([], []), ([4, 9], [4]), ([0], [0])):
        run.missed = np.isin(np.arange(12), lost)
        assert sorted(_worst_samples(run)) == sorted([0, 7, 3, 5, *first])  # type: ignore[arg-type]


@pytest.mark.parametrize(("start", "end"), [(0.3, 0.25), (0.25, 0.25), (0.1, 0.25), (0.26, 0.25)])
def test_a_place_is_refined_to_where_none_beside_it_is_better_and_allowed(start: float, end: float) -> None:
    """The larger x the better, but none beyond 0.25 m is allowed, where the start may lie; y is best in the middle."""
    own = search([0.0, -1.0, 0.01, 0.0], [1.0, 1.0, 0.01, 0.0])
    own.measure = own.setup = None

    def look(looking: object, places: np.ndarray) -> tuple[SimpleNamespace, np.ndarray]:
        share = 2.0 - places[:, 0] + places[:, 1] ** 2
        return SimpleNamespace(share=lambda *_: share), np.where(places[:, 0] > 0.25, NO_ROOM, FINE)

    own._look, own._around = look, lambda at, size: _Search._around(own, at, size)  # type: ignore[arg-type]
    axes = (np.linspace(0.0, 1.0, 5), np.linspace(-1.0, 1.0, 5), np.array([0.01]), np.array([0.0]))
    found = _Search._refined(own, None, np.array([start, 0.3, 0.01, 0.0]), axes)  # type: ignore[arg-type]
    np.testing.assert_allclose(found, [end, 0.0, 0.01, 0.0], atol=2e-3)
    assert found[0] <= 0.25


@pytest.mark.parametrize("seed", range(20))
def test_where_a_part_lies_its_turn_is_counted_as_the_range_of_yaw_has_it(
    monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    """By whole turns, of which one leads into the range if its own turn, or that and some whole ones, is in it."""
    rng, seen = np.random.default_rng(seed), []
    now, low = rng.uniform(-np.pi, np.pi), rng.uniform(-4.0 * np.pi, 2.0 * np.pi)
    high = low + rng.choice([0.0, 1.0, 3.0, 2.0 * np.pi])
    if seed < 4:
        low = now + 2.0 * np.pi * (seed - 2)  # just at the begin of the range
        high = low + 1.0
    run = SimpleNamespace(verdict=SimpleNamespace(level="ok"))
    monkeypatch.setattr(module, "today", lambda setup: np.array([0.1, 0.2, 0.3, now]))
    monkeypatch.setattr(module, "simulate", lambda setup: run)
    there = SimpleNamespace(reason="", known=True)
    monkeypatch.setattr(module, "place_of", lambda result, at, measure: seen.append(at) or there)
    own = search([0.0, 0.0, 0.0, low], [1.0, 1.0, 1.0, high], setup=SimpleNamespace(coupling=False), measure="verdict")
    here, found, base = _Search._now(own)  # type: ignore[arg-type]
    turns = [now + 2.0 * np.pi * n for n in range(-4, 5)]
    inside = [turn for turn in turns if low - 1e-9 <= turn <= high + 1e-9]
    assert here[3] == pytest.approx(inside[0] if inside else now, abs=1e-9)
    assert here[:3].tolist() == [0.1, 0.2, 0.3]
    np.testing.assert_array_equal(seen[0], here)
    assert (found.known, base) == (True, run)


@pytest.mark.parametrize(
    ("x", "missed", "room", "det", "share", "why"),
    [
        (0.1, 0, 0.1, 0.5, 3.0, FINE),
        (0.1, 0, 0.1, 0.5, np.nan, UNKNOWN),
        (0.1, 0, 0.2, 2.0 * NEAR, 0.5, FINE),
        (0.1, 0, 0.2, NEAR, 0.5, SINGULAR),
        (0.1, 0, 0.2, -0.5, 0.5, SINGULAR),
        (0.1, 0, 0.2, -0.5 * NEAR, np.nan, SINGULAR),
        (0.1, 0, 0.2, np.nan, 0.5, SINGULAR),
        (0.1, 0, 0.0999, -0.5, 0.5, NO_ROOM),
        (0.1, 0, np.nan, 0.5, 0.5, NO_ROOM),
        (0.1, 1, 0.0, 0.0, np.nan, UNREACHED),
        (0.0, 1, 0.0, 0.0, np.nan, KEPT_OUT),
        (0.0, 0, 0.2, 0.5, 0.5, KEPT_OUT),
    ],
)
def test_a_place_is_not_allowed_for_the_first_reason_that_it_has(
    x: float, missed: int, room: float, det: float, share: float, why: int
) -> None:
    """It meets a box, is not reached, has no room, is singular or on both sides of that, or has no number."""
    own = search([0.0] * 4, [1.0] * 4, measure="verdict", setup=None)
    own.area.T_MW = lambda places: places
    stands = Standing(np.array([missed]), np.array([room]), np.array([det]))
    screened = SimpleNamespace(standing=stands, share=lambda *_: np.array([share]))
    looking = SimpleNamespace(over=lambda T_MW: screened)
    found, reasons = _Search._look(own, looking, np.array([[x, 0.0, 0.0, 0.0]]))  # type: ignore[arg-type]
    assert found is screened
    assert reasons.tolist() == [why]
