"""The range of the force over a revolution against brute force: every point of an edge where the helix has it."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from tests.simulation.cuts import AL7075, CASES, FEED, MM

BY_NAME = {case.name: case for case in CASES}


NAMES = (
    "slot",
    "right flat, climb, a_e 5.0",
    "right flat, conventional, a_e 0.5",
    "left flat, climb, a_e 3.0",
    "right half open to half depth",
    "flat slot, A 0 B 10",
    "flat slot, A 8 B 5",
    "flat slot, A 0 B -5",
    "ball slot, A 10 B 0",
    "ball slot, A 0 B -10",
    "ball, third pass of three",
    "bull slot, A 0 B 6",
    "chamfer slot, A 5 B 0",
    "ramp down",
    "ramp down, ball",
    "plunge",
    "plunge, half over the edge",
    "T profile",
    "over a cavity",
    "ball over a cavity",
    "tilted over a cavity",
)


@pytest.mark.parametrize("name", NAMES)
def test_range_over_a_revolution(name: str) -> None:
    case = BY_NAME[name]
    result = rm.simulate(case.setup(1.0))
    peak = result.setup.force.peak(result.conditions)
    assert peak is not None
    cut, last = case.before(60_000)
    s = np.mean(case.span)
    truth = cut.over_pitch(case.cutter, AL7075, last.start + s * MM * last.way, FEED * last.way, last.k)
    across = last.way - (last.way @ last.k) * last.k
    across = across / np.linalg.norm(across) if across.any() else np.array([1.0, 0.0, 0.0])
    truth = truth @ np.array([across, np.cross(last.k, across), last.k]).T
    i = np.argmin(np.linalg.norm(result.path.p - (last.start + (s + 0.5) * MM * last.way), axis=1))
    room = 0.05 * np.linalg.norm(truth, axis=1).max()
    np.testing.assert_allclose(peak.low[i], truth.min(axis=0), atol=room)
    np.testing.assert_allclose(peak.high[i], truth.max(axis=0), atol=room)
