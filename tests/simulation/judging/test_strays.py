"""Where the tip strays most, and whether the part remembers: marks drawn by hand, passes pushed by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.toolpath.source import GCodeSource

SETUP = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(cell=4e-4)
SLOT = ("G0 X-60 Y0 Z10", "G0 Z-2", "G1 X60 F1800", "G0 Z20")


def pushed(lines, *moves):
    """A program whose tip is pushed along (feed, left, up) mm at ``moves`` {line: push}, and nowhere else; lines count
    from the first of ``lines``."""
    source = GCodeSource("\n".join(["G21 G90 S12000 M3", *lines, "M2", ""]))
    run = rm.simulate(SETUP.replace(source=source))
    delta = np.zeros_like(run.delta)
    for line, push in moves:
        here = run.path.block == line + 1
        delta[here] = np.einsum("mij,j->mi", run.R_MF[here], 1e-3 * np.array(push))
    return replace(run, delta=delta)


def beside(y, z=-2.0):
    return (f"G0 X-60 Y{y} Z10", f"G0 Z{z}", "G1 X60 F1800", "G0 Z20")


def test_a_single_slot_keeps_the_mark_of_its_push():
    found = pushed(SLOT, (3, (0.0, 0.2, 0.0))).stray
    assert (found.mark, found.fate) == ("wall", "stays")
    assert found.size == pytest.approx(0.2e-3, abs=1e-9)
    assert found.left == pytest.approx(0.2e-3, abs=1e-7)
    assert "stays on the part" in found.words


def test_what_is_left_is_read_at_its_own_place_not_at_another():
    """Of two slots apart the tip strays most in one, and the wall of the other is as far off as its own push."""
    lines = (*SLOT, *beside(15.0))
    run = pushed(lines, (3, (0.15, 0.1, 0.0)), (7, (0.0, 0.17, 0.0)))
    assert run.stray.left == pytest.approx(0.1e-3, abs=1e-7)
    assert pushed(lines, (3, (0.0, 0.1, 0.0)), (7, (0.0, 0.17, 0.0))).stray.left == pytest.approx(0.17e-3, abs=1e-7)


def test_a_later_pass_on_either_side_takes_the_mark_of_a_wall_away():
    both = (*SLOT, *beside(3.0), *beside(-3.0))
    assert pushed(both, (3, (0.0, 0.2, 0.0))).stray.fate == "cleaned"
    one = (*SLOT, *beside(3.0))
    assert pushed(one, (3, (0.0, 0.2, 0.0))).stray.fate == "stays"  # the wall on the other side keeps it


def test_an_earlier_pass_is_none_that_cleans_up():
    lines = (*beside(3.0), *beside(-3.0), *SLOT)
    found = pushed(lines, (11, (0.0, 0.2, 0.0))).stray
    assert found.fate == "none"  # both walls were gone when it came
    assert pushed((*beside(20.0), *SLOT), (7, (0.0, 0.2, 0.0))).stray.fate == "stays"


def test_a_floor_too_high_is_cleaned_up_by_the_same_cut_made_again_and_one_too_deep_is_not():
    again = (*SLOT, *SLOT)
    assert pushed(again, (3, (0.0, 0.0, 0.2))).stray.fate == "cleaned"
    assert pushed(again, (3, (0.0, 0.0, -0.2))).stray.fate == "stays"
    deeper = (*SLOT, *beside(0.0, -3.0))
    assert pushed(deeper, (3, (0.0, 0.0, -0.2))).stray.fate == "cleaned"


def test_a_push_along_the_feed_leaves_no_mark_and_air_nothing():
    assert pushed(SLOT, (3, (0.2, 0.05, 0.0))).stray.fate == "feed"
    assert pushed(("G0 X-60 Y0 Z10", "G0 Z5", "G1 X60 F1800")).stray is None
