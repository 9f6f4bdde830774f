"""Where the tip of a corrected program springs: by the deflections of a plain run where the force jumps."""

import numpy as np
import pytest
import shapely

import robomill as rm
from robomill.improve.springs import _beside, springs

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


def test_how_far_a_tip_is_beside_two_lines_that_meet() -> None:
    """From a corner at (10, 0) back along x to 0 and on along y to 10: by Pythagoras from the nearest of both."""
    path = rm.Toolpath.from_points(p_mm=[[0, 0, 0], [10, 0, 0], [10, 10, 0]], feed_mm_min=600)
    at = int(np.flatnonzero(np.linalg.norm(path.p - [0.01, 0.0, 0.0], axis=1) < 1e-9)[0])
    for tip, off in (
        ((4, -3, 0), 3),
        ((13, 6, 0), 3),
        ((-3, 4, 0), 5),
        ((13, -4, 0), 5),
        ((10, 13, 4), 5),
        ((10, 0, 0), 0),
    ):
        assert _beside(np.array([tip]) * 1e-3, path, np.array([at]))[0] == pytest.approx(off * 1e-3, abs=1e-12)
    for tip, off in (((7, 3, 0), 3), ((13, 14, 0), 5)):  # at the end of the path there is one line
        assert _beside(np.array([tip]) * 1e-3, path, np.array([len(path) - 1]))[0] == pytest.approx(off * 1e-3)


def test_a_corner_springs_on_its_link_as_far_as_a_plain_run_of_the_same_text_is_off_the_lines() -> None:
    """A force that follows the path jumps in a corner; the text run as any other, in steps of 0.02 mm, and measured to
    what was meant. (At the ends of steps of 1 mm alone the tip is 0.19 mm off, in truth 0.25.)"""
    corners = [(-60, 0), (-20, 0), (-20, -12)]
    text = "G21 G90 S12000 M3\nG0 X-60 Y0 Z5\nG0 Z-2\nG1 X-20 F300\nG1 Y-12\nG0 Z5\nM2\n"
    corrected = rm.compensate(SLOT.replace(source=rm.GCodeSource(text, "x.nc")))
    (found,) = springs(corrected.led)
    plain = rm.simulate(SLOT.replace(source=rm.GCodeSource(corrected.text, "y.nc"), step=2e-5))
    tips = 1e3 * (plain.path.p + plain.delta @ SLOT.T_MW[:3, :3])
    line = shapely.LineString(corners)
    beside = np.array([line.distance(shapely.Point(*tip[:2])) for tip in tips])
    off = np.hypot(beside, tips[:, 2] + 2.0) * plain.path.cutting
    assert (found.kind, found.count, found.lines) == ("link", 1, (int(plain.path.block[off.argmax()]),))
    assert found.size == pytest.approx(off.max() * 1e-3, rel=0.02)


def test_an_arc_that_ends_beyond_its_corner_is_a_link_from_there_only() -> None:
    """Between two corrections the tip is off by no more than it is pushed anywhere, 0.1 mm; the whole of the arc,
    measured against the two lines that meet at its end, would be off by 3 mm."""
    arm = rm.load_robot("fanuc_r2000ic")
    ball = rm.Cutter("ball", diameter_mm=8, flutes=2)
    text = "G21 G90 S9000 M3\nG0 X-22 Y4.218 Z4\nG0 Z-1.699\nG1 X-5 F900\n"
    text += "G3 X3.369 I4.1845\nG1 Z-0.792\nX9.438 Z-0.488\nG0 Z20\nM2\n"
    setup = rm.SimulationSetup(
        robot=arm.replace(C_theta=0.620 * arm.C_theta),
        source=rm.GCodeSource(text, "x.nc"),
        part_zero_mm=(1500, 0, 400),
        cutter=ball,
        force=rm.process_force("al6082_t6_carbide_ref189", ball),
        stock=rm.Stock(lower_mm=(-16, -20, -10), upper_mm=(40, 20, 0)),
        engagement=True,
    )
    corrected = rm.compensate(setup)
    link = next(each for each in corrected.sprung if each.kind == "link")
    pushed = np.linalg.norm(corrected.wanted.delta[corrected.wanted.path.cutting], axis=1).max()
    assert 0.0 < link.size < pushed
