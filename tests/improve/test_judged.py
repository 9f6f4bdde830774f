"""How far the judged errors go with the tip, against runs in which it goes there."""

import numpy as np
import pytest

import robomill as rm
from robomill.improve.judged import judged
from robomill.improve.sensitivity import stiffened


@pytest.mark.parametrize("cutter", ["flat", "ball", "chamfer"])
def test_errors_go_with_the_tip_as_told(cutter: str) -> None:
    """A slot, its arm 3 % stiffer in one joint: what a run finds then is what was told, but for the ends of the cut."""
    setup = rm.load_setup("paper_flute").replace(step=2e-3)
    if cutter != "flat":
        angle = {"tip_angle_deg": 90.0, "tip_diameter_mm": 3.0} if cutter == "chamfer" else {}
        setup = setup.replace(cutter=rm.Cutter(cutter, diameter_mm=8, flutes=3, **angle))
    before = rm.simulate(setup)
    told = judged(before)
    for joint in range(5):
        after = rm.simulate(setup.replace(robot=stiffened(setup.robot, np.where(np.arange(5) == joint, 1.03, 1.0))))
        found = judged(after)
        np.testing.assert_array_equal(found.sample, told.sample)
        change = told.along(after.delta_in_cut - before.delta_in_cut)
        inside = (found.sample > found.sample.min()) & (found.sample < found.sample.max())
        some = 0.05 * np.abs(change).max()  # a nose is met at another height as it goes aside
        np.testing.assert_allclose((found.error - told.error)[inside], change[inside], atol=max(5e-7, some))


def test_the_verdict_judges_walls_floors_and_what_has_a_tolerance_along_the_feed() -> None:
    setup = rm.load_setup("paper_flute").replace(step=5e-3)
    result = rm.simulate(setup)
    both = judged(result)
    assert both.share == pytest.approx(result.verdict.share, rel=0.02)  # among equals the verdict names another
    assert len(judged(result, "wall").sample) + len(judged(result, "floor").sample) == len(both.sample)
    along = judged(rm.simulate(setup.replace(feed_tolerance=1e-6)))
    assert along.share == pytest.approx(np.abs(result.delta_in_cut[result.judged, 0]).max() / 1e-6)
    assert judged(result, "tip").share == pytest.approx(result.max_deviation / setup.tolerance)
    assert judged(result, tolerance=1e-3).share == pytest.approx(both.share * 0.3)


def test_the_tip_and_the_way_along_the_feed_go_as_they_do() -> None:
    """By any displacements along feed, feed-normal and axis: all three of them, or the first."""
    setup = rm.load_setup("paper_flute").replace(step=10e-3, feed_tolerance=0.2e-3)
    result = rm.simulate(setup)
    moved = np.random.default_rng(2).normal(size=(len(result.path), 3))
    tip, all_ = judged(result, "tip"), judged(result)
    np.testing.assert_allclose(tip.along(moved), moved[result.judged])
    along = all_.error[-int(result.judged.sum()) :, 0] == result.delta_in_cut[result.judged, 0]
    assert along.all()
    np.testing.assert_allclose(all_.along(moved)[-len(along) :, 0], moved[result.judged, 0])
    np.testing.assert_allclose(all_.tolerance[-len(along) :], 0.2e-3)


@pytest.mark.parametrize("tolerance_mm", [0.3, 0.1])
def test_a_cut_of_which_not_all_is_judged_is_no_number_however_far_out_the_rest_is(tolerance_mm: float) -> None:
    """A force along the path says nothing of the plunge. Out of tolerance the verdict is red for the rest; joints that
    keep the rest in it do not keep what nobody knows, and no probability is known of it."""
    text = "G21 G90\nS12000 M3\nG0 X-40 Y0 Z5\nG1 Z-2 F300\nG1 X40 F1200\nG0 Z10\nM30\n"
    cut = rm.load_setup("paper_flute").replace(source=rm.GCodeSource(text), tolerance_mm=tolerance_mm, step=4e-3)
    run = rm.simulate(cut)
    assert run.verdict.level == ("out" if tolerance_mm < 0.2 else "unjudged")
    assert run.not_judged.any()
    for asked, says in ((rm.design, "no number to design for"), (rm.uncertainty, "no number to be sure of")):
        with pytest.raises(rm.RobomillError, match=f"{says}.*line 4.*says nothing of a plunge"):
            asked(cut)
