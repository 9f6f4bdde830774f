"""The improve page: joints ranked, the best one used and undone, several together where one is not enough, and an
empty state where the cut has no result."""

from __future__ import annotations

import dataclasses
import html
import re

import numpy as np
import pytest
from conftest import go, store, words
from streamlit.testing.v1 import AppTest

import robomill as rm
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.errors import CompensationError
from robomill.improve.design import design
from robomill.improve.stiffening import Stiffening, some_stiffer
from robomill.io.compensated import compensate
from robomill.io.materials import load_material, sample_materials
from robomill.io.robot.robots import load_robot
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.simulation.run import simulate
from robomill.simulation.stations import joint_shares
from robomill.toolpath.source import GCodeSource
from robomill.ui.improve.stiffen import meanwhile
from robomill.ui.project import preset_setup
from robomill.viz.shares import gain_bars


def opened(app: AppTest, remedy: str) -> None:
    next(g for g in app.get("button_group") if g.key == "improve.remedy").set_value(remedy).run()


def test_the_best_joint_can_be_used_and_taken_back(app: AppTest) -> None:
    go(app, "7_Improve")
    assert not app.exception
    before = store(app).project.setup
    result = simulate(before)
    left = np.linalg.norm(result.delta[:, None] - 0.5 * result.delta_joint, axis=-1)[result.judged].max(axis=0)
    best = before.robot.joint_numbers[int(left.argmin())]
    opened(app, "stiffen")
    assert f"Joint {best} twice as stiff: a wall error of 0.230 mm becomes 0." in words(app)
    assert "Verdict then" in words(app)
    assert "Correct the program: wall error of 0.230 mm becomes 0.000 to 0.046 mm" in words(app)
    app.button(key=f"improve.use.{best}").click().run()
    assert not app.exception
    assert "of the tolerance is used, 77 % before it: within tolerance. Undo leads back." in words(app)
    used = store(app).project.setup
    assert abs(simulate(used).max_deviation - left.min()) < 1e-9 * left.min()
    app.button(key="undo").click().run()
    assert store(app).project.setup.digest() == before.digest()


def test_where_one_joint_is_not_enough_the_best_ones_together_are_told_and_can_be_used(app: AppTest) -> None:
    kept = store(app)
    kept.project = kept.project.replace(setup=kept.project.setup.replace(tolerance=0.15e-3))
    before = kept.project.setup
    share = simulate(before.replace(robot=some_stiffer(before.robot, [2, 4]))).verdict.share
    go(app, "7_Improve")
    assert not app.exception
    opened(app, "stiffen")
    assert "No joint alone brings the cut within tolerance: joint 3 twice as stiff still uses 104 %" in words(app)
    assert f"Joints 3 and 5 together twice as stiff: within tolerance, {100 * share:.0f} %" in words(app)
    app.button(key="improve.use.3.5").click().run()
    assert not app.exception
    assert abs(simulate(store(app).project.setup).verdict.share - share) < 1e-12
    assert f"{100 * share:.0f} % of the tolerance is used, 153 % before it: within tolerance" in words(app)


def test_where_not_even_all_joints_are_enough_the_page_says_what_else_there_is(app: AppTest) -> None:
    kept = store(app)
    kept.project = kept.project.replace(setup=kept.project.setup.replace(tolerance=0.05e-3))
    go(app, "7_Improve")
    opened(app, "stiffen")
    assert "No joint alone brings the cut within tolerance" in words(app)
    assert "a smaller cut (Milling), another place of the part (Toolpath)" in words(app)


def test_before_the_ranking_is_there_the_joints_that_make_the_error_are_named() -> None:
    result = simulate(preset_setup("paper_flute"))
    kind, _, i = result.decided
    share = joint_shares(result, i, kind.axis)
    assert kind.error == "wall error"
    np.testing.assert_allclose(share.sum(), 1.0, rtol=1e-12)
    assert meanwhile(result).startswith(f"The wall error at line 7 comes {100 * share[2]:.0f} % from joint 3 and ")


def test_a_cut_that_is_not_judged_is_not_called_good_with_a_stiffer_joint(app: AppTest) -> None:
    kept = store(app)
    source = GCodeSource("G21 G90 S12000 M3\nG0 X0 Y0 Z5\nG1 Z-2 F300\nG1 X20 F1800\nG0 Z5\nG33 Z-8 K1\nG0 Z5\nM2\n")
    kept.project = kept.project.replace(setup=kept.project.setup.replace(source=source))
    go(app, "7_Improve")
    assert not app.exception
    assert "met with that joint" not in words(app)
    assert "Not judged" in words(app)


def test_what_is_not_judged_is_said_once_and_not_in_every_row(app: AppTest) -> None:
    kept = store(app)
    source = GCodeSource("G21 G90 S12000 M3\nG0 X0 Y0 Z5\nG1 Z-2 F300\nG1 X20 F1800\nG0 Z5\nG33 Z-8 K1\nG0 Z5\nM2\n")
    setup = kept.project.setup.replace(source=source)
    kept.project = kept.project.replace(setup=setup)
    sentence = simulate(setup).verdict.sentence
    with pytest.raises(CompensationError, match=re.escape(sentence)):
        compensate(setup)
    go(app, "7_Improve")
    said = html.unescape(words(app))
    assert said.count("prediction is not to be trusted.") == 2, "of the corrected program, here and at the best place"
    (table,) = (each for each in re.findall("<table.*?</table>", said, re.DOTALL) if "Verdict then" in each)
    assert sentence not in table
    assert sentence in said
    assert "There is no number to design for." in table


@pytest.mark.parametrize("page", ["5_Toolpath", "6_Milling", "7_Improve"])
def test_where_the_force_is_not_known_no_page_has_a_number_and_all_say_what_to_do(app: AppTest, page: str) -> None:
    kept = store(app)
    setup, row = kept.project.setup, load_material("al6061_t6_carbide_ref160")
    blind = setup.replace(force=MechanisticForce(setup.cutter, row), engagement=True)
    kept.project = kept.project.replace(setup=blind)
    go(app, page)
    assert not app.exception
    told = words(app)
    assert f"annot be judged: the axial force of {row.title} is not known" in told
    assert not [each for each in ("up to 0.0", "0.000 mm", "of it used", "ithin tolerance") if each in told]
    assert ("No error to reduce: nothing of this cut is judged." in told) == (page == "7_Improve")
    if page == "6_Milling":
        (listed,) = [each for each in app.selectbox if each.label == "Material"]
        marked = {title for title in listed.options if title.endswith("force not known")}
        mechanistic = [each for each in sample_materials() if each.kind == row.kind]
        assert len(marked) == sum(None in (each.Kac, each.Kae) for each in mechanistic) > 0
        assert len(listed.options) == len(mechanistic)


def test_a_cut_out_of_reach_has_nothing_to_improve(app: AppTest) -> None:
    kept = store(app)
    T_MW = np.array(kept.project.setup.T_MW)
    T_MW[0, 3] = 50.0
    kept.project = kept.project.replace(setup=kept.project.setup.replace(T_MW=T_MW))
    go(app, "7_Improve")
    assert not app.exception
    assert "There is no cut to improve yet." in words(app)


def test_a_joint_that_makes_it_worse_is_not_said_to_change_nothing() -> None:
    verdict = simulate(preset_setup("paper_flute")).verdict
    after = tuple(dataclasses.replace(verdict, share=share) for share in (0.5, 0.9, 0.7653))
    ranked = Stiffening(dataclasses.replace(verdict, share=0.7653), after, np.zeros(4))
    fig = gain_bars(100.0 * ranked.saved, "%", 0, (1, 2, 3), dark=False, height=200)
    assert fig.traces[0]["text"] == ["27 %", "0", "−13 %"]


def test_every_remedy_has_a_row_with_what_it_leaves_or_why_it_does_not_apply(app: AppTest) -> None:
    go(app, "7_Improve")
    said = words(app)
    for title in (
        "As it is",
        "Correct the program",
        "Stiffen joints",
        "Move the part",
        "Turn the spindle",
        "Cut otherwise",
    ):
        assert title in said
    assert "State a force from the material first." in said
    assert "nothing is left to turn." in said
    stiffer = design(store(app).project.setup, 0.5 * 0.22953604512e-3)
    assert f"wall {stiffer.after.verdict.wall.value * 1e3:.3f} mm" in said


def test_joints_of_least_stiffening_are_used_and_taken_back(app: AppTest) -> None:
    kept = store(app)
    kept.project = kept.project.replace(setup=kept.project.setup.replace(tolerance=0.15e-3))
    before = kept.project.setup
    go(app, "7_Improve")
    opened(app, "stiffen")
    app.button(key="improve.do.Use these joints").click().run()
    assert not app.exception
    now = store(app).project.setup
    assert simulate(now).verdict.share <= 1.0
    np.testing.assert_allclose(now.robot.C_theta, design(before).C_theta)
    app.button(key="undo").click().run()
    assert store(app).project.setup.digest() == before.digest()


def test_the_part_is_moved_to_where_it_was_found_to_be_better(app: AppTest) -> None:
    go(app, "7_Improve")
    before = simulate(store(app).project.setup)
    opened(app, "place")
    assert not app.exception
    app.button(key="improve.do.Move the part there").click().run()
    assert not app.exception
    now = simulate(store(app).project.setup)
    assert now.verdict.share < before.verdict.share - 0.1
    np.testing.assert_array_equal(now.setup.robot.C_theta, before.setup.robot.C_theta)


def test_another_way_to_cut_is_used(app: AppTest) -> None:
    kept = store(app)
    setup = load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(step=4e-3, cell=5e-4)
    kept.project = kept.project.replace(setup=setup)
    before = simulate(kept.project.setup)
    go(app, "7_Improve")
    opened(app, "cut")
    assert not app.exception
    assert "In 2 passes" in words(app)
    app.selectbox(key="improve.way").set_value("2 passes").run()
    app.button(key="improve.way.use").click().run()
    assert not app.exception
    now = simulate(store(app).project.setup)
    assert now.verdict.share < 0.6 * before.verdict.share
    assert now.path.t[-1] > 1.9 * before.path.t[-1]


def test_the_tool_is_turned_about_its_axis_on_an_arm_of_six(app: AppTest) -> None:
    kept = store(app)
    setup = kept.project.setup.replace(robot=load_robot("fanuc_r2000ic"), step=10e-3, cell=5e-4)
    kept.project = kept.project.replace(setup=setup)
    before = simulate(setup).verdict.share
    go(app, "7_Improve")
    assert not app.exception
    opened(app, "turn")
    app.button(key="improve.do.Turn it so, all the way").click().run()
    assert not app.exception
    assert simulate(store(app).project.setup).verdict.share < before - 0.01


def test_remedies_are_judged_by_what_95_percent_of_the_draws_keep_and_what_is_typed_counts(app: AppTest) -> None:
    """The numbers are those of the library, for the cut as it is and with the corrected program."""
    go(app, "7_Improve")
    assert not app.exception
    setup = store(app).project.setup
    assert "95 % of the draws keep" in words(app)
    next(g for g in app.get("button_group") if g.key == "improve.by").set_value("sure").run()
    assert not app.exception
    assert_judged(app, setup, rm.Spread())
    assert {"improve-draws", "improve-tornado"} <= {figure.key for figure in app.get("plotly_chart")}
    app.text_input(key="improve.spread.compliance:%").set_value("30").run()
    assert not app.exception
    assert_judged(app, setup, rm.Spread(compliance=0.3))
    app.text_input(key="improve.spread.force:%").set_value("-5").run()
    assert "Force: found -5" in words(app)
    assert store(app).values["improve.spread"] == rm.Spread(compliance=0.3)


def assert_judged(app: AppTest, setup: rm.SimulationSetup, spread: rm.Spread) -> None:
    """Whether the page says what the library draws."""
    corrected = setup.replace(source=rm.compensate(setup).source)
    now, then = (1e3 * rm.uncertainty(each, spread).quantile(0.95) for each in (setup, corrected))
    assert f"in 95 % of the draws the error is at most {then:.3f} mm instead of {now:.3f} mm" in words(app)


def test_a_program_is_corrected_for_the_best_place_of_the_part_as_the_library_does(app: AppTest) -> None:
    """Both together: placed by the library, compensated there, and what is left if stiffness is 20 % off."""
    kept = store(app)
    kept.project = kept.project.replace(setup=load_setup("paper_flute/setup_process"))
    setup = kept.project.setup
    go(app, "7_Improve")
    assert not app.exception
    found = rm.compensate(rm.place(setup).moved)
    wrong = max(found.softer.max, found.stronger.max)
    assert wrong < rm.compensate(setup).softer.max
    assert "Move the part, then correct" in words(app)
    opened(app, "both")
    assert not app.exception
    assert f"{1e3 * found.before.max:.3f} mm" in words(app)
    assert f"{1e3 * wrong:.3f} mm" in words(app)
    app.button(key="improve.do.Move the part there").click().run()
    assert not app.exception
    np.testing.assert_allclose(store(app).project.setup.T_MW, rm.place(setup).moved.T_MW)
