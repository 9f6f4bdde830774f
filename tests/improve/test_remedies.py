"""What each remedy leaves, against runs and programs made by hand, and how a corrected program is graded."""

from __future__ import annotations

from dataclasses import replace
from typing import get_type_hints

import numpy as np
import pytest

import robomill as rm
from robomill.cutting.forces.along_path import PathForce
from robomill.errors import SetupError
from robomill.improve.advice import Advice, Way
from robomill.improve.errors import Errors
from robomill.improve.remedies import REMEDIES, Stiffened, decides, moved_and_corrected, remedy_of, saves, stiffened
from robomill.report.remedies_told import told, told_of

SLOT = rm.load_setup("paper_flute").replace(step_mm=5, cell_mm=0.5)
NOW = rm.simulate(SLOT)
PROGRAM = rm.compensate(SLOT)


def left(found, now=NOW):
    remedy = remedy_of(found)
    assert remedy is not None
    return remedy.left(found, now)


def test_every_remedy_has_a_code_a_title_and_what_it_makes_of_its_own() -> None:
    for name in ("code", "title", "makes"):
        assert len({getattr(each, name) for each in REMEDIES}) == len(REMEDIES)
    assert remedy_of(NOW) is None


def test_what_joins_others_holds_what_they_make() -> None:
    made = {each.makes for each in REMEDIES}
    assert any(each.joins for each in REMEDIES)
    for each in REMEDIES:
        assert each.joins == bool(made & set(get_type_hints(each.makes).values())), each.code


def test_a_corrected_program_is_graded_by_what_is_left_if_stiffness_or_force_is_20_percent_off() -> None:
    """On the page as in the report: the worse of the two errors, each surface by its own tolerance."""
    softer, stronger = (errors(wall, floor) for wall, floor in ((0.05e-3, 0.06e-3), (0.07e-3, 0.01e-3)))
    setup = SLOT.replace(tolerance=0.1e-3, floor_tolerance=0.065e-3)
    found = replace(PROGRAM, setup=setup, softer=softer, stronger=stronger)
    assert found.doubted is softer  # 0.06 of 0.065 is more than 0.07 of 0.1
    assert found.share == pytest.approx(0.06 / 0.065)
    there = left(found)
    assert (there.level, there.error, there.share) == ("tight", ("floor", pytest.approx(0.06e-3)), found.share)
    (row,) = told(found)
    assert row.verdict == "Within tolerance, tight"
    assert "0.060 mm if stiffness or force is 20 % off" in row.leaves


def errors(wall: float, floor: float) -> Errors:
    return Errors(np.array([wall, wall]), np.array([floor, floor]), np.array([wall, wall]))


def test_a_corrected_program_is_no_better_than_what_is_predicted_of_it() -> None:
    assert PROGRAM.level == "ok"
    led = PROGRAM.led
    off = np.where(led.path.cutting[:, None], 1e-3, 0.0) * np.ones(3)
    assert replace(PROGRAM, led=replace(led, delta=off)).level == "out"


def test_stiffer_joints_halve_an_error_that_keeps_its_tolerance_and_are_judged_by_that_of_the_cut() -> None:
    found = stiffened(SLOT, rm.simulate)
    assert found.half
    there = left(found)
    again = rm.simulate(SLOT.replace(robot=SLOT.robot.replace(C_theta=found.design.C_theta)))
    assert there.share == pytest.approx(again.verdict.share, rel=1e-12)
    assert there.share == pytest.approx(0.5 * NOW.verdict.share, rel=1e-3)
    (row,) = told(found)
    assert row.what.endswith(", which halves what is used of the tolerance")
    assert row.leaves == again.verdict.sentence


@pytest.mark.parametrize(
    "own",
    [
        {"floor_tolerance_mm": 0.125},
        {"floor_tolerance_mm": 0.5},
        {"floor_tolerance_mm": 0.13, "feed_tolerance_mm": 0.01},
    ],
)
def test_with_tolerances_of_their_own_the_largest_share_of_any_is_halved(own: dict[str, float]) -> None:
    setup = SLOT.replace(**own)
    limits = {"wall": 0.3, "floor": own["floor_tolerance_mm"], "feed": own.get("feed_tolerance_mm", np.inf)}

    def largest(run: rm.SimulationResult) -> float:
        """Of the tolerances, by the numbers of each reading."""
        end, feed = (1e3 * abs(getattr(run.verdict, name).value) / limits["feed"] for name in ("end", "feed"))
        read = [1e3 * abs(getattr(run.verdict, name).value) / limits[name] for name in ("wall", "floor")]
        return float(np.nanmax([*read, feed, end]))

    found = stiffened(setup, rm.simulate)
    assert found.half
    assert largest(found.run) == pytest.approx(0.5 * largest(rm.simulate(setup)), rel=1e-3)
    (row,) = told_of(setup, found)
    assert row.leaves == found.run.verdict.sentence
    (row,) = told_of(setup, rm.design(setup, tolerance_mm=0.2))
    assert "to keep 0.2 mm" in row.what


def test_a_corrected_program_is_graded_along_the_feed_too_where_that_has_a_tolerance() -> None:
    """What is pushed along the feed is not corrected: it stays, and is 20 % more where the arm is as much softer."""
    setup = SLOT.replace(force=rm.PathForce(-60.0, 100.0, 0.0), feed_tolerance_mm=0.04)
    found = rm.compensate(setup)
    read = rm.simulate(setup.replace(source=found.source)).verdict
    along = max(abs(read.feed.value), abs(read.end.value))
    assert max(abs(read.wall.value), abs(read.floor.value)) < 0.1 * along
    assert found.after.share(setup) == pytest.approx(along / 0.04e-3, rel=1e-6)
    there = left(found, rm.simulate(setup))
    assert there.share == pytest.approx(1.2 * along / 0.04e-3, rel=1e-3)
    assert there.error == ("feed", pytest.approx(1.2 * along, rel=1e-3))
    assert not there.better
    assert "not-met" in {each.code for each in found.findings}


def test_the_error_that_decides_at_a_place_is_the_one_that_uses_most_of_its_tolerance() -> None:
    setup = SLOT.replace(tolerance_mm=0.5, floor_tolerance_mm=0.11)
    found = rm.place(setup, x_mm=(-100, 100), y_mm=(-1350, -1250), candidates=9)
    run = rm.simulate(found.moved)
    wall, floor = (abs(getattr(run.verdict, name).value) for name in ("wall", "floor"))
    assert wall > floor
    assert floor / 0.11 > wall / 0.5
    assert left(found, rm.simulate(setup)).error == ("floor", pytest.approx(floor))


def test_where_nothing_pushes_or_nothing_is_judged_no_joint_is_made_stiffer() -> None:
    """In words, and not as a tolerance of 0 mm that nobody has asked for."""
    free = SLOT.replace(force=rm.ConstantForce((0.0, 0.0, 0.0)))
    with pytest.raises(SetupError, match="^No error to reduce: the cut is as it was told to be"):
        stiffened(free, rm.simulate)
    plunge = rm.Toolpath.from_points(p_mm=[[0, 0, 2], [0, 0, -2], [40, 0, -2]], feed_mm_min=1800)
    partly = free.replace(source=plunge, force=PathForce())
    assert rm.simulate(partly).verdict.level == "unjudged"
    with pytest.raises(SetupError, match="^There is no number to design for: "):
        stiffened(partly, rm.simulate)


def test_stiffer_joints_keep_a_tolerance_that_is_not_kept() -> None:
    tight = SLOT.replace(tolerance=0.15e-3, floor_tolerance=None)
    found = stiffened(tight, rm.simulate)
    assert not found.half
    np.testing.assert_array_equal(found.design.stiffness_ratio, rm.design(tight).stiffness_ratio)
    assert left(found, rm.simulate(tight)).share <= 1.0
    assert told(found) == told(rm.design(tight)) == told(Stiffened(found.design, found.design.after))


def test_a_program_is_corrected_for_a_better_place_only() -> None:
    place = rm.place(SLOT, x_mm=(-100, 100), y_mm=(-1400, -1300), candidates=20)
    found = moved_and_corrected(place, rm.compensate)
    assert found.program.text == rm.compensate(place.moved).text
    there = left(found)
    assert (there.share, there.level) == (found.program.share, found.program.level)
    np.testing.assert_array_equal(there.then.T_MW, place.moved.T_MW)
    (row,) = told(found)
    assert row.title == "Move the part, then correct"
    assert row.what.startswith("part zero at (")
    with pytest.raises(SetupError, match="correct the program there"):
        moved_and_corrected(replace(place, best=place.now), rm.compensate)


def test_what_saves_next_to_nothing_is_no_remedy() -> None:
    assert saves(0.5, 0.51)
    assert not saves(0.5, 0.504)
    assert not saves(float("nan"), 0.5)


def test_the_truest_way_to_cut_is_what_is_left_of_them_all() -> None:
    ways = tuple(Way(name, name, replace_share(share)) for name, share in (("now", 0.9), ("a", 0.7), ("b", 0.8)))
    found = Advice(SLOT, (*ways, Way("none", "none", None, "refused")))
    assert found.truest.name == "a"
    there = left(found)
    assert (there.share, there.better) == (0.7, True)
    assert left(Advice(SLOT, (ways[1], ways[2]))).better is False


def replace_share(share: float):
    run = rm.simulate(SLOT)
    vars(run)["verdict"] = replace(run.verdict, share=share)
    return run


def test_what_decides_a_run_is_its_verdicts_largest_share_or_the_tip() -> None:
    name, size = decides(NOW)
    assert (name, size) == ("wall", abs(NOW.verdict.wall.value))
