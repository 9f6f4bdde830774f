"""Where the tip of a corrected program springs: by the deflections of a plain run where the force jumps."""

import numpy as np
import pytest

import robomill as rm
from robomill.improve.springs import springs

SLOT = rm.load_setup("paper_flute")
CUT = SLOT.replace(force=rm.process_force("al7075_t6_carbide_ref190", SLOT.cutter), engagement=True)


def led(body: str) -> rm.SimulationResult:
    """A run of a program that was corrected by nothing."""
    text = f"G21 G90 S12000 M3\nG0 X0 Y0 Z5\n{body}G0 Z5\nM2\n"
    return rm.simulate(CUT.replace(source=rm.GCodeSource(text, "x.nc", wanted=rm.GCodeSource(text, "wanted.nc"))))


def test_a_plunge_springs_aside_as_it_first_touches_and_nowhere_else() -> None:
    """Aside of its axis alone, and once: the steps below the first are led."""
    run = led("G1 Z-2 F300\nG1 X10\n")
    (found,) = springs(run)
    first = int(np.flatnonzero(np.linalg.norm(run.F, axis=1) > 0)[0])
    axis = SLOT.T_MW[:3, 2]
    aside = run.delta[first] - (run.delta[first] @ axis) * axis
    assert (found.kind, found.count, found.lines) == ("touch", 1, (3,))
    assert found.size == pytest.approx(np.linalg.norm(aside), rel=1e-9)


def test_a_cut_that_is_entered_from_the_side_springs_at_no_touch() -> None:
    run = led("G0 X-70\nG0 Z-2\nG1 X-40 F300\n")
    assert np.linalg.norm(run.F, axis=1).max() > 50.0
    assert springs(run) == ()
