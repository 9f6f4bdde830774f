"""What is assumed of a force: the verdict against whole runs with the force at the ends of what is assumed."""

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

import robomill as rm
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.materials import PUBLISHED
from robomill.io.materials import load_material
from robomill.simulation.judging.gauge import Readings
from robomill.simulation.origin.assumed import far_share
from robomill.simulation.result import SimulationResult
from robomill.surface.stock import Stock
from tests.simulation.cuts import FLAT, CutCase, along_x, shoulder

SLOT = CutCase("slot", FLAT, (along_x(0, -2),))


def run(case: CutCase, share: float | None, **changes: Any) -> SimulationResult:
    row = load_material("al7075_t6_carbide_ref160")  # gives no axial coefficients
    setup = case.setup(step=1.0, cell=0.2).replace(force=MechanisticForce(FLAT, row, axial_share=share), **changes)
    return rm.simulate(setup)


@pytest.mark.parametrize("case", [SLOT, shoulder(3.0)])
def test_a_verdict_is_not_green_where_the_far_end_of_an_assumed_share_is_out(case: CutCase) -> None:
    low, high = PUBLISHED["axial"]
    floors, walls = zip(*((v.floor.value, v.wall.value) for v in (run(case, s).verdict for s in (low, high))))
    reads, worst = sorted(map(abs, floors))
    share = low if abs(floors[0]) == reads else high  # what is assumed is the better end
    wide, between = 10 * max(map(abs, walls)), 0.95 * worst
    assert reads < 0.75 * between
    found = run(case, share, floor_tolerance=between, tolerance=wide).verdict
    assert found.level == "tight"
    assert found.far == pytest.approx(worst / between, rel=1e-3)
    roomy = run(case, share, floor_tolerance=2 * worst, tolerance=wide).verdict
    assert (roomy.level, roomy.far) == ("ok", pytest.approx(0.5, rel=1e-3))
    assert run(case, share, floor_tolerance=0.9 * reads, tolerance=wide).verdict.level == "out"


def test_where_nothing_of_the_part_is_left_the_tips_own_deviation_is_taken_at_the_ends() -> None:
    """A bar narrower than the cutter, milled away to below its bottom."""
    bar = Stock((-8e-3, -2e-3, -1.5e-3), (8e-3, 2e-3, 0.0))
    low, high = (run(SLOT, share, stock=bar).max_deviation for share in PUBLISHED["axial"])
    found = run(SLOT, PUBLISHED["axial"][0], stock=bar, tolerance=1e-3).verdict
    assert not found.wall.decides
    assert not found.floor.decides
    assert found.far == pytest.approx(max(low, high) / 1e-3, rel=1e-3)


def test_nothing_is_assumed_where_the_row_gives_all() -> None:
    assert np.isnan(rm.simulate(SLOT.setup(step=1.0, cell=0.2)).verdict.far)


def test_a_coupled_run_in_which_nothing_is_judged_does_not_say_that_it_agrees() -> None:
    setup = SLOT.setup(step=1.0, cell=0.2)
    blind = replace(setup.force, material=load_material("al7075_t6_carbide_ref160"))
    nothing = rm.simulate(setup.replace(force=blind, coupling=True))
    assert nothing.verdict.level == "unjudged"
    assert nothing.coupling is not None
    assert nothing.coupling.judged == 0.0
    assert nothing.coupling.finding.message != rm.simulate(setup.replace(coupling=True)).coupling.finding.message


def test_along_the_feed_the_far_end_is_that_of_the_worst_point() -> None:
    """Where the tolerance along the feed is the one that is used up first."""
    low, high = (run(SLOT, share) for share in PUBLISHED["axial"])
    along = [float(np.abs(each.delta_in_cut[each.judged, 0]).max()) for each in (low, high)]
    least = float(np.abs(low.delta_in_cut[low.judged, 0]).min())
    assert least < 0.9 * max(along)
    ends = low.gauge.ends
    without_ends = replace(low.gauge, ends=Readings(*(getattr(ends, each.name)[:0] for each in fields(ends))))
    for found in (low.gauge, without_ends):
        assert far_share(low, found, (np.inf, np.inf, 2.0 * max(along))) == pytest.approx(0.5, rel=1e-3)


@pytest.mark.parametrize("kind", ["walls", "floors"])
def test_of_walls_and_floors_the_far_end_is_that_of_their_own_way(kind: str) -> None:
    """Each alone: walls go with the tip across the feed, floors with it along the tool."""
    low, high = (run(SLOT, share) for share in PUBLISHED["axial"])
    worst = max(abs(getattr(each.verdict, kind[:-1]).value) for each in (low, high))
    limits = (2.0 * worst, np.inf, np.inf) if kind == "walls" else (np.inf, 2.0 * worst, np.inf)
    assert far_share(low, low.gauge, limits) == pytest.approx(0.5, rel=1e-3)
