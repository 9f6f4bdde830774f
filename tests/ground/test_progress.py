"""Long work says how far it is and ends soon after it is given up; unwatched, nothing changes."""

from __future__ import annotations

import numpy as np
import pytest

from robomill import progress
from robomill.progress import Cancelled, Progress, checkpoint, gathered, slices, watched


def test_pieces_cover_everything_once_in_order_watched_or_not() -> None:
    for count in (0, 1, 15, 16, 17, 1000, 12_345):
        assert [i for some in slices(count, "a") for i in range(count)[some]] == list(range(count))
        with watched(Progress()):
            assert [i for some in slices(count, "a") for i in range(count)[some]] == list(range(count))


def test_pieces_grow_where_they_are_quick_and_shrink_where_they_are_slow(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])

    def sizes(cost: float, count: int) -> list[int]:
        found = []
        with watched(Progress()):
            for some in slices(count, "a"):
                found.append(some.stop - some.start)
                now[0] += cost * found[-1]
        return found

    quick = sizes(1e-6, 1_000_000)
    assert max(quick) * 1e-6 <= 0.1
    assert len(quick) < 100
    slow = sizes(0.03, 50)
    assert slow[0] * 0.03 < 0.5  # the first piece is not known yet
    assert max(slow[1:]) <= 1
    assert sizes(0.0, 10_000_000)[-2] <= 1 << 20


def test_most_bounds_a_piece_though_nobody_waits() -> None:
    assert max(some.stop - some.start for some in slices(1000, "a", most=64)) == 64


def test_what_is_given_up_ends_at_the_next_checkpoint_and_says_how_far_it_was() -> None:
    said: list[tuple[str, float]] = []
    begun: list[int] = []

    def work() -> None:
        begun.extend(some.start for some in slices(10_000_000, "Cutting"))

    now = Progress(lambda: len(begun) > 2, lambda now: said.append((now.stage, now.share)))
    with watched(now), pytest.raises(Cancelled):
        work()
    assert len(begun) == 3
    assert said[0] == ("Cutting", 0.0)
    assert 0.0 < said[-1][1] < 1.0
    checkpoint(0.5, "nobody listens any more")
    assert len(said) == 4


def test_watching_within_watching_is_the_inner_one_s() -> None:
    outer, inner = Progress(), Progress()
    with watched(outer):
        with watched(inner):
            checkpoint(0.5, "inner")
        checkpoint(0.25, "outer")
    assert (inner.stage, inner.share) == ("inner", 0.5)
    assert (outer.stage, outer.share) == ("outer", 0.25)


def test_what_is_gathered_is_what_one_piece_would_be() -> None:
    for count in (0, 1, 16, 17, 1000):
        expected = np.stack([np.arange(count), np.arange(count) ** 2], axis=1)
        for progress_ in (None, Progress()):
            with watched(progress_):
                found = gathered(count, "Squares", lambda some, whole=expected: whole[some].copy())
            np.testing.assert_array_equal(found, expected)
            assert found.dtype == expected.dtype


def test_a_part_of_the_work_says_no_share_and_a_new_stage_begins_at_nothing() -> None:
    said: list[tuple[str, float]] = []
    with watched(Progress(say=lambda now: said.append((now.stage, now.share)))):
        checkpoint(0.5, "Map")
        assert [some.stop for some in slices(3, "")] == [3]
        checkpoint()
        checkpoint(stage="Surface")
    assert said == [("Map", 0.5), ("Map", 0.5), ("Map", 0.5), ("Surface", 0.0)]


def test_at_an_even_pace_what_is_left_is_known_from_what_was_spent(monkeypatch: pytest.MonkeyPatch) -> None:
    """Eighty seconds, then a stage of ten; nothing is said of the first two hundredths."""
    now = [1000.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    told = Progress(began=now[0])
    for stage, whole in (("Slow", 80.0), ("Quick", 10.0)):
        begun = now[0]
        for spent in (0.0, 0.01 * whole, 0.05 * whole, 0.5 * whole, whole):
            now[0] = begun + spent
            told.reach(spent / whole, stage)
            left = whole - spent if spent > 0.02 * whole else float("nan")
            assert told.left_s == pytest.approx(left, abs=1e-9, nan_ok=True)


def test_a_share_never_falls_and_never_exceeds_the_whole() -> None:
    told, shares = Progress(), []
    for share in (0.3, 0.2, None, 0.7, 1.2, 0.9):
        told.reach(share, "Work")
        shares.append(told.share)
    assert shares == [0.3, 0.3, 0.3, 0.7, 1.0, 1.0]
    told.reach(None, "More")
    assert told.share == 0.0
