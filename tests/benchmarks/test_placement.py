"""Speed of a placement over a thousand places of the slot, beside a loop over full simulations in the same run.

Run with ``pytest -m benchmark -s tests/benchmarks/test_placement.py``.
"""

import numpy as np
import pytest

import robomill as rm
from tests.benchmarks.clock import fastest

pytestmark = pytest.mark.benchmark

SECONDS, LOOP_RATIO, GROWTH = 2.0, 4.0, 4.0


def test_a_thousand_places_of_the_slot():
    setup = rm.load_setup("paper_flute")
    found = rm.place(setup)
    places = np.random.default_rng(0).uniform([-0.39, -1.69, 0.002], [0.39, -0.91, 0.002], (40, 3))

    def loop():
        return [rm.simulate(setup.replace(part_zero=p)).verdict.share for p in places]

    ours = fastest(lambda: rm.place(setup), 3)
    fewer = fastest(lambda: rm.place(setup, candidates=250), 3)
    theirs = fastest(loop, 3) / len(places) * found.tried
    print(f"\nPlacement over {found.tried} places of the slot, best, now, median and worst by full simulations")
    for name, value in (
        ("robomill", f"{ours:9.2f} s"),
        ("a loop over simulate, without refinement", f"{theirs:9.2f} s"),
        ("ratio", f"{theirs / ours:9.1f}"),
        ("growth from 250 places", f"{ours / fewer:9.1f}"),
    ):
        print(f"  {name:<64} {value}")
    assert ours < SECONDS
    assert theirs >= LOOP_RATIO * ours
    assert ours <= GROWTH * fewer
