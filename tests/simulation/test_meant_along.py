"""How far along a path the samples of a corrected program were meant to be, and where nobody knows: leg by leg."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from robomill.progress import Progress, watched
from robomill.simulation.meant import LINK, _aligned, _places, _untold


@pytest.mark.parametrize("said", [False, True])
@pytest.mark.parametrize("seed", range(8))
def test_on_a_leg_whose_ends_are_both_sent_the_same_way_along_it_nobody_knows_how_far(seed: int, said: bool) -> None:
    """Legs of one to four steps, one of them down along the tool; their ends are sent along the way on which they are
    left or reached, forwards, backwards or not at all, and anywhere across it."""
    rng = np.random.default_rng(seed)
    legs, k = rng.integers(1, 5, 7), np.array([0.0, 0.0, 1.0])
    angle = np.cumsum(rng.uniform(0.5, 2.5, 7))
    ways = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(7)])
    ways[3] = -k
    ends = np.append(0, np.cumsum(legs))
    way = np.vstack([ways[:1], np.repeat(ways, legs, axis=0)])
    off = rng.normal(size=(len(way), 3)) * 1e-3
    sent = rng.choice([-3.0, -0.5, 0.5, 3.0], (7, 2)) * LINK  # along each leg, where it begins and where it ends
    for n, end in enumerate(ends):
        near = [(leg, side) for leg, side in ((n - 1, 1), (n, 0)) if 0 <= leg < 7]
        rows, asked = np.array([ways[leg] for leg, _ in near]), np.array([sent[each] for each in near])
        off[end] = np.linalg.lstsq(rows, asked, rcond=None)[0]
    meets = np.isin(np.arange(len(way)), ends[1:-1])
    found = _untold(off, way, np.tile(k, (len(way), 1)), meets, said)
    expected = np.zeros(len(way), dtype=bool)
    for n in range(7):
        alike = min(sent[n]) > LINK or max(sent[n]) < -LINK
        expected[ends[n] + 1 : ends[n + 1]] = (said or alike) and n != 3
    np.testing.assert_array_equal(found, expected)
    assert found.any() or not said


@pytest.mark.parametrize("seed", range(12))
def test_samples_belong_where_they_are_along_a_cut_and_the_worst_is_off_it_or_leaves_most_of_it_out(seed: int) -> None:
    """By the geometry of a line on the plan; what is left out before the first sample, and behind the last, counts."""
    rng = np.random.default_rng(seed)
    p = np.column_stack([np.cumsum(rng.uniform(-1.0, 2.0, (9, 2)), axis=0), np.zeros(9)]) * 1e-2
    line = shapely.LineString(p[:, :2])
    asked = np.sort(rng.uniform(0.0, line.length, 5)) + rng.normal(size=5) * 2e-3
    s = [max(asked[: n + 1].max(), 0.0) for n in range(5)]  # none comes before the one ahead of it
    q = np.array([[*line.interpolate(each).coords[0], 0.0] for each in s])
    q += rng.normal(size=q.shape) * rng.choice([1e-4, 2e-2])
    found, worst, at = _places(q, p, np.maximum(asked, 0.0))
    np.testing.assert_allclose(found[:, :2], [line.interpolate(each).coords[0] for each in s], atol=1e-12)
    bad = []
    for n in range(5):
        out = s[n] - (np.linalg.norm(q[n] - q[n - 1]) + s[n - 1] if n else 0.0)
        behind = line.length - s[n] if n == 4 else 0.0
        bad.append(max(float(np.linalg.norm(q[n] - found[n])), out, behind))
    assert worst == pytest.approx(max(bad), abs=1e-12)
    assert at == int(np.argmax(bad))


def test_it_is_told_how_many_samples_have_been_placed(monkeypatch: pytest.MonkeyPatch) -> None:
    """After every fifth of 24."""
    monkeypatch.setattr("robomill.simulation.meant.SAID", 5)
    p, told = np.outer(np.arange(24), [1e-3, 0.0, 0.0]), list[float]()
    way = np.tile([1.0, 0.0, 0.0], (24, 1))
    with watched(Progress(say=lambda progress: told.append(progress.share))):
        np.testing.assert_array_equal(_aligned(p, way, p, way), np.arange(24))
    assert told == pytest.approx([5 / 24, 10 / 24, 15 / 24, 20 / 24])
