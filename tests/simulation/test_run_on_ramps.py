"""The force of ramps that leave the material: the same wherever the part stands and however it is turned, with a thrust
in closed form; in coupled runs it is what holds the tip on the floor that it has left."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from tests.cutting.brute_force import Floats
from tests.simulation.cuts import AL7075, FEED, FLAT, MM, CutCase, Pass, way_out

SLOPE = math.radians(1.0)
R, FLUTES = 4.0 * MM, 3
HOLLOW = R * math.tan(math.radians(0.5))  # the middle of the end over its rim


def out_of_a_block(x: float = 0.0, y: float = 0.0) -> CutCase:
    """Down by ``SLOPE`` through a block 40 mm long and out of it, more than 5 mm deep, begun 10 mm before it."""
    ramp = Pass(((x, y, -4.0), (x + 70.0, y, -4.0 - 70.0 * math.tan(SLOPE))))
    low, high = (x + 10.0, y - 20.0, -12.0), (x + 50.0, y + 20.0, 0.0)
    return replace(way_out("", FLAT, ramp), low=low, high=high)


def forces(case: CutCase, turn: float = 0.0, coupling: bool = False) -> tuple[Floats, Floats, rm.SimulationResult]:
    """How far the tip is beyond the block's edge (n,) m, and the force (n, 3) N in {W}, with the part turned (deg)."""
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    T_MW = np.array([[c, -s, 0, 0], [s, c, 0, -1.3], [0, 0, 1, 0], [0, 0, 0, 1]])
    result = rm.simulate(case.setup(1.0 if coupling else 0.5).replace(T_MW=T_MW, coupling=coupling))
    assert result.ik.reached.all()
    return result.path.p[:, 0] - case.high[0] * MM, result.setup.to_part(result.F), result


def thrust(x: Floats) -> Floats:
    """(n,) N axial on an end whose axis is x (n,) m beyond the edge, 0 < x < R: the points (r, phi) of it that are over
    the material, r cos(phi) > x, all have the chip c sin(slope), and ``integral`` is that of dr dphi over them."""
    root = np.sqrt(R * R - x * x)
    integral = 2.0 * (R * np.arccos(x / R) - x * np.log((R + root) / x))
    h = FEED * math.sin(SLOPE)
    return np.asarray(FLUTES / (2.0 * np.pi) * sum(term.Kr * h**term.exponent for term in AL7075) * integral)


@pytest.mark.parametrize(
    ("turn", "x", "y"),
    [(turn, -30.0, 0.0) for turn in (0.0, 37.0, 90.0, 180.0, 270.0)]
    + [(0.0, -20.0, 0.0), (0.0, -45.0, 0.0), (0.0, 60.0, 25.0), (270.0, -110.0, -40.0)],
)
def test_the_thrust_of_a_ramp_goes_with_the_share_of_the_end_that_is_over_the_material(
    turn: float, x: float, y: float
) -> None:
    beyond, F, _ = forces(out_of_a_block(x, y), turn)
    some = (beyond > 0.1 * MM) & (beyond < 3.0 * MM)
    assert some.sum() >= 5
    np.testing.assert_allclose(F[some, 2], thrust(beyond[some]), rtol=0.02)


def test_a_part_that_is_turned_is_cut_by_the_same_force_from_the_first_whole_cut_to_the_end() -> None:
    beyond, expected, _ = forces(out_of_a_block())
    some = beyond > -34.0 * MM
    size = np.linalg.norm(expected[some], axis=1).max()
    for turn in (37.0, 90.0, 180.0, 270.0):
        _, F, _ = forces(out_of_a_block(), turn)
        np.testing.assert_allclose(F[some], expected[some], atol=0.02 * size)


def test_in_a_coupled_run_the_tip_stays_on_its_floor_where_the_flank_leaves_the_material() -> None:
    """A tip whose end met nothing there would dive by some 0.4 mm, into what stands below it."""
    beyond, F, result = forces(out_of_a_block(), coupling=True)
    height = (result.path.p + result.setup.to_part(result.delta))[:, 2]
    some = (beyond > -5.0 * MM) & (beyond < 0.0) & np.isfinite(height)
    dives = np.maximum.accumulate(height[some]) - height[some]
    assert some.sum() >= 4
    assert dives.max() < HOLLOW + 5.0 * MM * math.tan(SLOPE)
    assert F[some, 2].min() > 50.0
