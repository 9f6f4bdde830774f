"""Fixed points against closed forms: offset lines that meet, springs whose force is known."""

import numpy as np
import pytest

import robomill as rm
from robomill.improve.correction import correct, directions
from robomill.io.samples import samples_dir
from robomill.simulation.result import SimulationResult

SLOT = rm.load_setup(samples_dir() / "paper_flute")
BOTH = ("normal", "axial")


def run_of(text: str, **more: object) -> SimulationResult:
    return rm.simulate(SLOT.replace(source=rm.GCodeSource(text, "x.nc"), **more))


def test_directions_are_projections_across_the_way_and_along_it_where_asked() -> None:
    run = run_of(
        "G21 G90\nG0 X0 Y0 Z5\nG1 Z-2 F600\nG1 X20\nG1 Y10 Z-1\nG0 Z5\nM2\n", force=rm.ConstantForce((0, 50.0, 0))
    )
    way = np.diff(run.path.p, axis=0, prepend=run.path.p[:1])
    cut = np.flatnonzero(run.path.cutting & (run.path.step_length > 0))
    normal, axial, feed = (directions(run, (name,)) for name in ("normal", "axial", "feed"))
    P = directions(run, BOTH)
    np.testing.assert_allclose(P @ P, P, atol=1e-12)
    np.testing.assert_allclose(P, normal + axial, atol=1e-12)
    level = cut[run.conditions.across[cut] > 0.5]
    np.testing.assert_allclose(np.einsum("mij,mj->mi", P[level], way[level]), 0.0, atol=1e-12)
    np.testing.assert_allclose((P + feed)[level], np.broadcast_to(np.eye(3), (len(level), 3, 3)), atol=1e-12)
    plunge = cut[run.conditions.across[cut] < 0.5]
    np.testing.assert_allclose(P[plunge], np.broadcast_to(np.eye(3), (len(plunge), 3, 3)), atol=1e-12)


@pytest.mark.parametrize("turn", [30.0, 60.0, 90.0, -90.0, 120.0])
def test_at_a_sharp_corner_both_cuts_keep_to_their_lines_up_to_it(turn: float) -> None:
    """Each undoes its own deflection, along it too, since its end has the other's wall; a link leads across."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    text = f"G21 G90\nG0 X0 Y0 Z5\nG0 Z-2\nG1 X20 F600\nG1 X{20 + 20 * c:.6f} Y{20 * s:.6f}\nG0 Z5\nM2\n"
    run = run_of(text)
    found = correct(SLOT, run, ("normal",))
    corner = int(np.flatnonzero(run.path.block == 4)[-1])
    assert np.abs(found.error[[corner, corner + 1], :2]).max() < 1e-6
    assert np.abs(found.c[corner, :2] - found.c[corner + 1, :2]).max() > 0.05e-3


def test_two_cuts_that_hardly_turn_meet_where_their_offset_lines_cross() -> None:
    """Pushed off by 11 um, at a turn of 60 degrees."""
    c, s = np.cos(np.radians(60.0)), np.sin(np.radians(60.0))
    text = f"G21 G90\nG0 X0 Y0 Z5\nG0 Z-2\nG1 X20 F600\nG1 X{20 + 20 * c:.6f} Y{20 * s:.6f}\nG0 Z5\nM2\n"
    run = run_of(text, force=rm.PathForce(feed_normal=5.0))
    found = correct(SLOT, run, ("normal",))
    corner = int(np.flatnonzero(run.path.block == 4)[-1])
    assert np.array_equal(found.c[corner], found.c[corner + 1])
    error = found.error[[corner, corner + 1]]
    assert abs(error[0] @ [0.0, 1.0, 0.0]) < 0.5e-6
    assert abs(error[1] @ [-s, c, 0.0]) < 0.5e-6


def test_a_cut_that_turns_back_on_itself_is_linked_across() -> None:
    """Pushed to its left both ways, the tool is off to either side in turn: no one place does for both."""
    run = run_of("G21 G90\nG0 X0 Y0 Z5\nG0 Z-2\nG1 X20 F600\nG1 X0\nG0 Z5\nM2\n")
    found = correct(SLOT, run, ("normal",))
    turn = int(np.flatnonzero(run.path.block == 4)[-1])
    np.testing.assert_allclose(found.c[turn, 1], -found.c[turn + 1, 1], rtol=0.01)
    assert np.abs(found.error[run.path.cutting][:, 1]).max() < 1e-6


def test_nothing_is_sent_deeper_on_its_way_down_than_the_cut_that_goes_on_from_there() -> None:
    """End teeth push the tool up by most of a millimetre: where the plunge ends, that push ends, too."""
    setup = rm.load_setup("heart")
    run = rm.simulate(setup)
    found = correct(setup, run, BOTH)
    q = run.path.p + found.c
    assert np.abs(run.delta[:, 2]).max() > 0.5e-3
    assert q[run.path.cutting, 2].min() > run.path.p[:, 2].min() - 0.15e-3


def test_the_change_falls_with_every_iteration_of_a_level_slot() -> None:
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml")
    found = correct(setup, rm.simulate(setup), BOTH)
    assert found.settled
    assert found.iterations == len(found.change)
    assert all(b < 0.2 * a for a, b in zip(found.change, found.change[1:], strict=False))
