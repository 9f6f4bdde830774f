"""What a run without coupling leaves out, against the place where brute force and the arm's compliance agree."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import root

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.simulation.uncoupled import met_where_pushed
from tests.cutting.brute_force import Cut, Floats, Move, box
from tests.cutting.test_brute_force import AL7075, UPRIGHT

LOW, HIGH = np.array([-30.0, -20.0, -10.0]), np.array([30.0, 20.0, 0.0])
FEED = np.array([1500.0 / 3 / 12000.0, 0.0, 0.0]) * 1e-3  # of a tooth
DEPTH, REACH = 1.5, 1.0


def run_of(
    cutter: rm.Cutter, passes: int, *, force: rm.ForceModel | None = None, **given: object
) -> rm.SimulationResult:
    way = [[-36.0, 0.0, -DEPTH], [36.0, 0.0, -DEPTH], [36.0, 0.0, 5.0], [-36.0, 0.0, 5.0]] * passes
    feeds = [0.0, 1500.0, 0.0, 0.0] * passes
    setup = rm.SimulationSetup(
        robot=rm.load_robot("slavkovic_5r"),
        source=rm.Toolpath.from_points(p_mm=way[:-2], feed_mm_min=feeds[:-2], spindle_1_min=12000),
        cutter=cutter,
        force=force or rm.process_force("al7075_t6_carbide_ref190", cutter),
        stock=rm.Stock(lower_mm=LOW, upper_mm=HIGH),
        part_zero_mm=(0, -1300, 0),
        engagement=True,
        tolerance_mm=0.3,
        **given,  # type: ignore[arg-type]
    )
    return rm.simulate(setup)


def told_of(run: rm.SimulationResult) -> list[rm.Finding]:
    return [each for each in run.notes if each.code == "uncoupled"]


def off_by_brute_force(run: rm.SimulationResult, passes: int) -> Floats:
    """(3,) m in {W}: where the tip stands in the middle of its last pass, each in what the ones before have left."""
    cutter, C = run.setup.cutter, run.C[int(np.argmin(np.abs(run.path.p[:, 0])))]
    cut = Cut(box(LOW * 1e-3, HIGH * 1e-3), reach=(DEPTH + REACH) * 1e-3, points=20_000)
    tip, before, off = np.array([0.0, 0.0, -DEPTH]) * 1e-3, [], np.zeros(3)
    for _ in range(passes):
        so_far = Cut(cut.stock, tuple(before), cut.reach, cut.points)

        def rest(x: Floats, so_far: Cut = so_far) -> Floats:
            there = tip + x * 1e-3
            own = Move(cutter, there - [0.01, 0.0, 0.0], there, UPRIGHT)
            met = Cut(so_far.stock, (*so_far.before, own), so_far.reach, so_far.points)
            return np.asarray(C @ met.mean_force(cutter, AL7075, there, FEED) * 1e3 - x)

        off = root(rest, off * 1e3, tol=1e-4).x * 1e-3
        before.append(Move(cutter, tip + off - [0.03, 0.0, 0.0], tip + off + [0.03, 0.0, 0.0], UPRIGHT))
    return off


@pytest.mark.parametrize(("kind", "passes", "told"), [("ball", 2, True), ("ball", 1, False), ("flat", 1, False)])
def test_what_an_earlier_pass_has_left_is_told(kind: str, passes: int, told: bool) -> None:
    """A ball nose sent once more along its slot meets what its first pass, pushed up by 0.16 mm, has left."""
    run = run_of(rm.Cutter(kind, diameter_mm=8, flutes=3), passes)
    truth = max(np.abs(off_by_brute_force(run, passes)[1:])) / 0.3e-3
    assert (truth > run.verdict.share + 0.1) == told
    notes = told_of(run)
    assert bool(notes) == told
    if told:
        (note,) = notes
        assert note.level == "warning"
        assert note.message.count("%") == 2
        assert "(point 6)" in note.message
        share = float(note.message.split("about ")[1].split(" %")[0]) / 100.0
        assert truth == pytest.approx(share, abs=0.15)
        assert math.isclose(run.verdict.share, 0.076, abs_tol=0.006), "by its sphere on its way into the stock"


@pytest.mark.parametrize("tolerance_mm", [0.3, 0.1, 0.05])
def test_what_would_be_red_where_it_is_pushed_is_not_green(tolerance_mm: float) -> None:
    """Twice along one slot the ball is 0.1 mm off: of 0.3 mm that is green, of 0.1 mm it is all of it."""
    run = run_of(rm.Cutter("ball", diameter_mm=8, flutes=3), 2)
    truth = max(np.abs(off_by_brute_force(run, 2)[1:]))
    setup = run.setup.replace(tolerance=tolerance_mm * 1e-3)
    verdict = rm.simulate(setup).verdict
    assert verdict.red == (truth > 0.9e-3 * tolerance_mm), "0.1 mm is on the limit of what is there"
    assert verdict.level == ("unjudged" if verdict.red else "ok")
    assert bool(verdict.premise) == verdict.red
    assert verdict.wall.value == pytest.approx(run.verdict.wall.value, abs=1e-9), "its numbers are what they were"


def test_a_coupled_run_and_a_stated_force_are_told_nothing() -> None:
    ball = rm.Cutter("ball", diameter_mm=8, flutes=3)
    assert not told_of(run_of(ball, 2, coupling=True))
    assert not told_of(run_of(ball, 2, force=rm.PathForce(feed_normal=100.0)))


@pytest.mark.parametrize(("depth", "tolerance_mm", "told"), [(2, 0.05, True), (5, 0.05, True), (2, 0.3, False)])
def test_a_corrected_program_is_told_what_the_depth_that_it_is_sent_to_leaves_out(
    depth: int, tolerance_mm: float, told: bool
) -> None:
    """It is sent 0.1 mm higher than it cuts, and pushed by as much less; a coupled run meets the full depth."""
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(
        source=rm.GCodeSource(f"G21 G90\nS12000 M3\nG0 X-40 Y0 Z10\nG0 Z-{depth}\nG1 X0 F600\nG0 Z20\nM2\n"),
        tolerance=tolerance_mm * 1e-3,
    )
    corrected = setup.replace(source=rm.compensate(setup).source)
    run, truth = rm.simulate(corrected), rm.simulate(corrected.replace(coupling=True)).verdict.share
    assert (truth > run.verdict.share + 0.1) == told
    notes = told_of(run)
    assert bool(notes) == told
    for note in notes:
        share = float(note.message.split("about ")[1].split(" %")[0]) / 100.0
        assert share == pytest.approx(truth, rel=0.1)


def test_what_a_corrected_program_meets_is_that_of_its_depth_up_to_the_last_sample_of_a_steady_cut() -> None:
    """A program that ends in its slot, 2 mm deep: sent less deep it was told the force of that; pushed down it meets
    that of the slot, all along, but for where the mill enters."""
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(
        source=rm.GCodeSource("G21 G90\nS12000 M3\nG0 X-70 Y0 Z10\nG0 Z-2\nG1 X0 F1800\nM2\n"), step=5e-3
    )
    run, wanted = rm.simulate(setup.replace(source=rm.compensate(setup).source)), rm.simulate(setup)
    F = met_where_pushed(run)[1]
    assert run.path.cutting[-1]
    told, met, slot = (np.linalg.norm(each[-3:], axis=1) for each in (run.F, F, wanted.F))
    np.testing.assert_allclose(met, slot, rtol=3e-3)
    assert np.all(np.abs(told - slot) > 0.02 * slot)
