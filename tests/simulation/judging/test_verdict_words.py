"""What the sentence of a verdict says of where a groove goes, against slots in every direction."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import ASKED, TableTool, ToolTable
from robomill.cutting.unjudged import Unjudged
from robomill.io.materials import load_material
from robomill.provenance import Provenance
from robomill.simulation.judging.verdict_words import LEVELS, Reading, gauge_end, level_of_share
from robomill.simulation.run import simulate
from robomill.surface.stock import Stock
from robomill.toolpath.source import GCodeSource
from tests.simulation.judging.pushed_runs import pushed, run


@pytest.mark.parametrize(
    ("there", "axis"),
    [((40, 0), "Y"), ((40, 1), "Y"), ((0, 40), "X"), ((1, 40), "X"), ((40, 30), ""), ((30, 40), "")],
)
@pytest.mark.parametrize("back", [False, True])
def test_a_straight_groove_is_off_along_the_axis_that_its_feed_does_not_follow(there, axis, back):
    """Aslant, to the left or the right of its feed."""
    x, y = (-n if back else n for n in there)
    bent = pushed(run(f"G0 X{-x} Y{-y} Z5", "G0 Z-2", f"G1 X{x} Y{y} F1800"), left=0.12e-3)
    said = bent.verdict.sentence
    assert [name for name in ("X", "Y") if f"0.12 mm off in {name}" in said] == [axis] * bool(axis)
    assert ("left" in said) == (not axis)


@pytest.mark.parametrize(("there", "axis"), [((20, 0), "Y"), ((0, 15), "X"), ((15, 15), "")])
@pytest.mark.parametrize("line", [3, 4])
def test_a_groove_that_begins_with_a_plunge_goes_where_its_feed_goes(there, axis, line):
    """Also where its worst wall is the hole's, on line 3, or the groove's first, beside the plunge."""
    x, y = there
    made = run(f"G0 X{-x} Y{-y} Z5", "G1 Z-2 F300", f"G1 X{x} Y{y} F1800")
    known = replace(made, F=np.nan_to_num(made.F), unjudged=())
    first = np.flatnonzero((made.path.block == line) & pushed(known).judged)[0]
    bent = pushed(known, left=np.where(np.arange(len(made.path)) == first, 0.2e-3, 0.0))
    assert bent.path.block[bent.verdict.wall.worst] == line
    said = bent.verdict.sentence
    assert [name for name in ("X", "Y") if f"0.20 mm off in {name}" in said] == [axis] * bool(axis)
    assert ("0.20 mm off to the left" in said) == (not axis)


def test_of_more_than_one_slot_the_lines_of_the_worst_wall_and_floor_are_named():
    """The first is too far left, the second too deep."""
    made = run("G0 X-40 Y-8 Z5", "G0 Z-2", "G1 X40 F1800", "G0 Z5", "G0 X-40 Y10", "G0 Z-1", "G1 X40")
    first = made.path.block < 6
    said = pushed(made, left=0.2e-3 * first, up=-0.05e-3 * ~first).verdict.sentence
    wall, floor = said.split(" are up to ")[1:]
    assert all(word in wall for word in ("0.20 mm", "(line 4)"))
    assert all(word in floor for word in ("0.05 mm", "(line 8)"))


def test_by_a_force_that_was_stated_for_another_path_nothing_is_judged():
    """Neither green nor red; what would be measured stands under the condition."""
    own = pushed(run("G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F1800"), left=0.12e-3)
    carried = {"force": Provenance("measured", "dynamometer").carried("Flute")}
    for tolerance in (0.1e-3, 0.3e-3):
        setup = own.setup.replace(tolerance=tolerance)
        known = replace(own, setup=setup).verdict
        open_ = replace(own, setup=setup.replace(provenance=carried)).verdict
        assert known.level == ("out" if tolerance < 0.12e-3 else "ok")
        assert (open_.level, open_.red) == ("unjudged", True)
        assert open_.share == known.share
        force = float(np.linalg.norm(own.F[own.worst]))
        assert "0.12 mm off in Y" in open_.sentence
        assert f", if the tool is pushed with {force:.0f} N. Nobody has said yet what this path cuts" in open_.sentence
        assert "tolerance" not in open_.sentence


@pytest.mark.parametrize("start", [0, 3000])
def test_a_path_out_of_reach_says_so_and_has_no_grade_by_the_force_of_another_cut(start):
    """Rapids that are reached are no points of a cut, and without a measured map nothing lies outside one."""
    text = f"G21 G90\nS8000 M3\nG0 X{start} Y{start} Z5\nG1 Z-1 F300\nG1 X3200 F3000\nG0 Z20\nM2\n"
    carried = {"force": Provenance("measured", "dynamometer").carried("Flute")}
    setup = rm.load_setup("paper_flute").replace(source=GCodeSource(text), stock=None, step=5e-3, provenance=carried)
    found = simulate(setup).verdict
    assert found.level == "unreached"
    if start:
        assert found.sentence.startswith("No point of the cut can be reached: move the part zero.")
    else:
        assert "points cannot be reached" in found.sentence
        assert "of the rest: the groove is " in found.sentence
        assert ", if the tool is pushed with 100 N. Nobody has said yet what this path cuts" in found.sentence
        assert "tolerance" not in found.sentence


@pytest.mark.parametrize(("count", "more"), [(1, ""), (2, " (and 1 more reason)"), (3, " (and 2 more reasons)")])
def test_of_reasons_why_nothing_is_judged_the_first_is_told_and_the_others_are_counted(result, count, more):
    where = np.zeros(len(result.path), dtype=bool)
    where[np.flatnonzero(result.path.cutting)[[3, 4]]] = True
    reasons = tuple(Unjudged(f"code-{k}", where, f"the reason is {k}.") for k in range(count))
    lost = replace(result, delta=np.where(where[:, None], np.nan, result.delta), unjudged=reasons)
    line, every = int(result.path.block[where][0]), int(result.path.cutting.sum())
    said = f"2 of {every} points of the cut are not judged (line {line}): the reason is 0{more}."
    assert said in lost.verdict.sentence


def test_flutes_that_nobody_has_counted_are_not_judged_by() -> None:
    """A table of a machine says a diameter: 2, 3 or 4 flutes are 93, 110 or 128 N here, within or out of tolerance."""
    own = run("G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F1800")
    program = GCodeSource("\n".join(["G21 G90 T3 M6 S12000 M3", "G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F1800", "M2", ""]))
    material = load_material("al7075_t6_carbide_ref190")
    counted = TableTool(3, Cutter("flat", 8e-3, flutes=4))
    setup = own.setup.replace(source=program, force=MechanisticForce(own.setup.cutter, material), engagement=True)
    levels = {}
    for tool in (counted, replace(counted, cutter=Cutter("flat", 8e-3), assumed=ASKED)):
        found = simulate(setup.replace(tools=ToolTable((tool,)))).verdict
        levels[len(tool.assumed)] = found.level
        assert found.share > 0.5
    assert levels == {0: "out", 3: "unjudged"}
    assert "if tool 3 has 2 flutes. Nobody has said how many flutes tool 3 has" in found.sentence
    stated = setup.replace(tools=ToolTable((tool,)), force=own.setup.force)
    assert simulate(stated).verdict.premise == ""


def test_a_path_beside_a_stock_that_is_hardly_meant_in_its_unit_is_not_judged() -> None:
    """80 mm read as 3; a short block that is really cut, with long ways in and out, is judged."""
    own = run("G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F1800")
    tiny = Stock((-1.6e-3, -0.8e-3, -0.4e-3), (1.6e-3, 0.8e-3, 0.0))
    found = simulate(own.setup.replace(stock=tiny)).verdict
    assert found.level == "unjudged"
    assert "if the unit of the stock is right. The path hardly touches the stock" in found.sentence
    short = Stock((-0.012, -0.02, -0.01), (0.012, 0.02, 0.0))
    assert simulate(own.setup.replace(stock=short)).verdict.premise == ""


def test_an_arm_whose_compliances_nobody_has_given_is_not_judged_until_they_are():
    arm = rm.load_robot("slavkovic_5r")
    table = {name: getattr(arm, name) for name in ("a", "alpha", "d", "theta_offset")}
    bare = rm.Robot.from_dh(
        **table, sign=arm.sign, limits=arm.limits, T_tool=arm.T_tool, T_base=arm.T_base, convention=arm.convention
    )
    assert "compliances assumed" in repr(bare)
    setup = rm.load_setup("paper_flute").replace(robot=bare)
    verdict = rm.simulate(setup).verdict
    assert verdict.level == "unjudged"
    assert "Nobody has given the compliances of this arm's joints: not judged." in verdict.sentence
    given = bare.replace(C_theta=arm.C_theta)
    assert "assumed" not in repr(given)
    assert given.provenance["compliance"].kind == "user"
    said = rm.simulate(setup.replace(robot=given)).verdict
    assert said.level == "ok"
    assert said.wall.value == rm.simulate(setup.replace(robot=arm)).verdict.wall.value


@pytest.mark.parametrize(
    ("share", "end"), [(0.0, 1.25), (0.77, 1.25), (1.0, 1.25), (1.4, 1.47), (5.0, 5.25), (40.0, 6.0)]
)
def test_a_gauge_shows_the_tolerance_and_what_is_used_of_it_up_to_six_times(share, end):
    assert gauge_end(share) == pytest.approx(end)


def test_verdicts_of_equal_runs_are_equal() -> None:
    """What has no number (NaN) is as equal as the rest; a pickled one, too, and it is said on one line."""
    setup = rm.load_setup("paper_flute").replace(step_mm=10, cell_mm=0.5)
    verdict = rm.simulate(setup).verdict
    assert verdict == rm.simulate(setup).verdict
    assert pickle.loads(pickle.dumps(verdict)) == verdict
    assert verdict != rm.simulate(setup.replace(tolerance_mm=0.2)).verdict
    assert repr(verdict).startswith("<Verdict ok: The groove is")


@pytest.mark.parametrize(
    ("share", "level"),
    [
        (0.0, "ok"),
        (0.7999, "ok"),
        (0.8, "tight"),
        (1.0, "tight"),
        (1.0001, "out"),
        (np.inf, "out"),
        (np.nan, "unjudged"),
    ],
)
def test_a_share_of_the_tolerance_has_its_level_and_one_that_nobody_knows_is_not_judged(share, level) -> None:
    assert level_of_share(share) == level


def test_a_grade_is_that_of_its_share_unless_a_wall_is_gone_or_the_force_may_be_larger() -> None:
    verdict = replace(rm.simulate(rm.load_setup("paper_flute")).verdict, far=np.nan, gone=())
    for share in (0.5, 0.9, 1.1):
        graded = replace(verdict, share=share)
        assert graded.grade == level_of_share(share)
        assert replace(graded, gone=(3,)).grade == "out"
        assert replace(graded, far=1.2).grade == max(level_of_share(share), "tight", key=LEVELS.index)


@pytest.mark.parametrize(
    ("worst", "stated", "decides"), [(0, True, True), (7, True, True), (-1, True, False), (0, False, False)]
)
def test_a_reading_decides_where_the_cut_leaves_one_and_its_tolerance_is_its_own(worst, stated, decides) -> None:
    """The first sample of a path is as good as any."""
    value = 1e-4 if worst >= 0 else float("nan")
    assert Reading(worst, value, 3e-4, 0.0, stated).decides is decides
