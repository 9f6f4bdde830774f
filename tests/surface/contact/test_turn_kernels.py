"""The angles of a turn: Gauss' rule integrates cubics exactly; rows, gaps and their order are written out by loops."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from robomill.cutting.engaged import PANELS
from robomill.surface.contact.turn_kernels import (
    ANGLES,
    HALF,
    SIDE,
    between_panels,
    gap_end,
    half_turn,
    jumps,
    panel_end,
    turn_row,
)


def test_panels_are_those_of_a_circle_seen_from_the_side_in_both_half_turns():
    """Their ends lie above equal parts of half a circle over (0, pi)."""
    circle = [math.pi / 2 - math.pi / 2 * math.cos(math.pi * k / PANELS) for k in range(PANELS)]
    for n, end in enumerate(circle):
        assert panel_end(n) == pytest.approx(end, abs=1e-14)
        assert panel_end(n + PANELS) == pytest.approx(math.pi + end, abs=1e-14)


@pytest.mark.parametrize("power", range(4))
def test_two_nodes_in_each_panel_integrate_cubics_exactly(power):
    angles = half_turn()
    assert len(angles) == ANGLES == HALF + 1
    assert (np.diff(angles) > 0).all()
    assert (angles[0], angles[-1]) == (SIDE, math.pi - SIDE)
    ends = np.concatenate([[0.0], angles[3:-1:3], [math.pi]])
    total = sum(
        0.5 * (b - a) * (angles[3 * n + 1] ** power + angles[3 * n + 2] ** power)
        for n, (a, b) in enumerate(itertools.pairwise(ends))
    )
    assert total == pytest.approx(math.pi ** (power + 1) / (power + 1), rel=1e-12)


def test_gaps_lie_between_rows_of_one_half_turn():
    rows = [half * ANGLES + row for half in range(2) for row in range(1, ANGLES)]
    assert [gap_end(gap) for gap in range(2 * HALF)] == rows


def test_where_one_panel_ends_the_next_begins():
    shared = {half * ANGLES + 3 * panel for half in range(2) for panel in range(1, PANELS)}
    assert {row for row in range(2 * ANGLES) if between_panels(row)} == shared


def test_a_turn_is_looked_at_panel_by_panel_its_nodes_before_its_beginning():
    order = []
    for first in (0, ANGLES):
        order.append(first)
        for panel in range(PANELS):
            begins = first + 3 * panel if panel else first + ANGLES - 1
            order += [first + 3 * panel + 1, first + 3 * panel + 2, begins]
    assert [turn_row(place) for place in range(2 * ANGLES)] == order
    assert sorted(order) == list(range(2 * ANGLES))


def test_a_fifth_of_the_longer_one_is_no_jump_yet():
    assert not jumps(1.0, 0.8001)
    assert jumps(1.0, 0.7999)
    assert jumps(0.7999, 1.0)
    assert not jumps(0.8001, 1.0)
    assert not jumps(0.0, 0.0)
    assert jumps(0.0, 1e-9)
