"""How far along a path the samples of a corrected program were meant to be, and where nobody knows: leg by leg."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.simulation.meant import LINK, _untold


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
