"""What the table of remedies says of each."""

import dataclasses

import numpy as np

import robomill as rm
from robomill.improve.remedies import REMEDIES
from robomill.provenance import Provenance
from robomill.ui.improve.opened import OPENED, level_words, over_spin
from robomill.ui.improve.remedies import FINDS, SHOWN, Found, as_it_is, sentence, shown


def test_a_wall_to_the_right_is_as_large_as_one_to_the_left() -> None:
    """Pushed to -Y the wall error is negative; it is still what is largest at the best place."""
    setup = rm.load_setup("paper_flute").replace(step_mm=5, cell_mm=0.5, force=rm.ConstantForce((0.0, -100.0, 0.0)))
    found = rm.place(setup, x_mm=(-100, 100), y_mm=(-1400, -1300), candidates=20)
    assert found.best.wall < -abs(found.best.floor)
    remedy = next(each for each in REMEDIES if each.code == "place")
    assert shown(remedy, found, rm.simulate(setup), "mm").error == f"wall {-found.best.wall * 1e3:.3f} mm"


def test_a_part_that_lies_best_is_not_said_to_be_moved_by_nothing() -> None:
    setup = rm.load_setup("paper_flute").replace(step_mm=5, cell_mm=0.5)
    found = rm.place(setup, x_mm=(-100, 100), y_mm=(-1400, -1300), candidates=20)
    stays = dataclasses.replace(found, best=found.now)
    remedy = next(each for each in REMEDIES if each.code == "place")
    left = shown(remedy, stays, rm.simulate(setup), "mm")
    assert (left.cost, left.setup) == ("no place is better than where it lies", None)
    turned = dataclasses.replace(found.best, yaw=found.now.yaw + np.deg2rad(30.0))
    assert shown(remedy, dataclasses.replace(found, best=turned), rm.simulate(setup), "mm").cost.endswith(
        "turned by 30°"
    )


def test_the_page_finds_tells_and_opens_every_remedy() -> None:
    codes = [each.code for each in REMEDIES]
    assert list(FINDS) == list(SHOWN) == list(OPENED) == codes


def test_a_map_of_spins_shows_only_what_is_judged_and_its_best_spin_inside() -> None:
    setup = rm.load_setup("paper_flute").replace(robot=rm.load_robot("fanuc_r2000ic"), step_mm=10, cell_mm=0.5)
    found, run = rm.turn(setup), rm.simulate(setup)
    station, angle, share, courses = over_spin(found, run, "mm")
    assert share.shape == (len(station), len(angle)) == (int((found.share > 0.0).any(axis=1).sum()), len(found.angle))
    assert (np.diff(angle) > 0.0).all()
    best = np.rad2deg(found.spin)
    assert angle[0] + 45.0 < (best + 180.0) % 360.0 - 180.0 < angle[-1] - 45.0
    k = int(np.argmin(np.abs((angle - best + 180.0) % 360.0 - 180.0)))
    j = int(np.argmin(np.abs((np.rad2deg(found.angle) - best + 180.0) % 360.0 - 180.0)))
    np.testing.assert_allclose(share[:, k], 100.0 * found.share[(found.share > 0.0).any(axis=1), j])
    assert set(courses) == {"now", "best"}
    np.testing.assert_allclose(np.cos(np.deg2rad(courses["now"][1])), np.cos(run.ik.spin[run.path.cutting]), atol=1e-12)


def test_a_level_is_named_only_where_it_is_drawn() -> None:
    assert level_words(np.array([[40.0, np.nan, 120.0]])) == "White line: all of the tolerance is used."
    assert level_words(np.array([[40.0, np.nan, 90.0]])) == level_words(np.array([[np.nan]])) == ""


def test_a_place_that_is_no_better_is_not_recommended_though_nothing_is_judged() -> None:
    """The best place is where the part lies: nobody is told to move it from 0.231 mm to 0.231 mm."""
    carried = {"force": Provenance("measured", "dynamometer").carried("another part")}
    setup = rm.load_setup("paper_flute").replace(step_mm=5, cell_mm=0.5, provenance=carried)
    run = rm.simulate(setup)
    assert run.verdict.level == "unjudged"
    place = rm.place(setup, x_mm=(-100, 100), y_mm=(-1400, -1300), candidates=20)
    remedy = next(each for each in REMEDIES if each.code == "place")
    now = as_it_is(run, "mm")
    stays = Found(remedy, shown=shown(remedy, dataclasses.replace(place, best=place.now), run, "mm"))
    moved = Found(remedy, shown=shown(remedy, place, run, "mm"))
    assert remedy.title not in sentence([stays], run, now, "mm")
    assert sentence([moved], run, now, "mm").startswith(f"{remedy.title}: ")
