"""What a box round moves can reach at most, against its corners and against disks anywhere in it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robomill.surface.contact.block_kernels import Box, depth_in, seen_box, span


def any_axes(rng):
    """k, u of a right-handed frame."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return turn[:, 2], turn[:, 0]


@pytest.mark.parametrize("seed", range(20))
def test_a_box_spans_what_its_corners_span(seed):
    rng = np.random.default_rng(seed)
    k, u = any_axes(rng) if seed else (np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]))
    c, middle, half, R = rng.normal(size=3), rng.normal(size=3), rng.uniform(0.0, 1.5, 3), rng.uniform(0.1, 2.0)
    found = seen_box(np.concatenate([c, k, u]), np.concatenate([middle, half, [R]]))
    signs = np.array([[a, b, d] for a in (-1, 1) for b in (-1, 1) for d in (-1, 1)])
    corners = middle + signs * half - c
    along, aside, up = corners @ u, corners @ np.cross(k, u), corners @ k
    assert (found.u_low, found.u_high, found.low) == pytest.approx((along.min(), along.max(), up.min()), abs=1e-12)
    near = 0.0 if aside.min() <= 0.0 <= aside.max() else np.abs(aside).min()
    assert (found.aside, found.R) == pytest.approx((near, R), abs=1e-12)


@pytest.mark.parametrize(("aside", "R"), [(0.0, 1.0), (0.6, 1.0), (1.0, 1.0), (2.0, 3.0)])
def test_no_disk_of_a_box_covers_more_of_the_line_and_none_less_deep(aside, R):
    """Disks of radius R with their middle at u_low..u_high, and aside or further from the line."""
    box = Box(-0.7, 1.3, aside, 0.0, R)
    low, high = span(box)
    line = np.linspace(-6.0, 6.0, 12_001)
    away = np.hypot(np.maximum(np.maximum(-0.7 - line, line - 1.3), 0.0), aside)  # from the nearest middle
    covered = line[away <= R + 1e-12]
    assert (low, high) == pytest.approx((covered.min(), covered.max()), abs=1.1e-3)
    for out, distance in zip(line[::500], away[::500], strict=True):
        assert depth_in(box, out) == pytest.approx(R - distance, abs=1e-12)


def test_a_box_further_aside_than_its_radius_covers_nothing():
    assert span(Box(-1.0, 1.0, 1.0 + 1e-9, 0.0, 1.0)) == (math.inf, -math.inf)
    assert depth_in(Box(-1.0, 1.0, 1.5, 0.0, 1.0), 0.0) == pytest.approx(-0.5)
