"""Long runs on a screen: thinned, and what can be clicked."""

from __future__ import annotations

import numpy as np

from robomill.viz.along import MAX_PICKS, MAX_POINTS, add_picks, thin
from robomill.viz.surfaces import MAX_CELLS, thinned
from robomill.viz.theme import figure


def test_large_runs_are_thinned_for_the_screen_only() -> None:
    keep = thin(1_000_000, [123_457])
    assert len(keep) <= MAX_POINTS + 1
    assert 123_457 in keep
    x, y = np.arange(1000.0), np.arange(900.0)
    _, _, z = thinned(x, y, np.zeros((1000, 900)))
    assert z.size <= MAX_CELLS


def test_what_can_be_clicked_is_thinned_and_finite() -> None:
    fig = figure(dark=False, height=200)
    s = np.arange(5000.0)
    add_picks(fig, s, np.where(s > 100, 1.0, np.nan), [str(v) for v in s])
    assert len(fig.figure.data[0].x) == MAX_PICKS
    assert fig.figure.data[0].x.min() > 100
    assert fig.figure.layout.clickmode == "event+select"
