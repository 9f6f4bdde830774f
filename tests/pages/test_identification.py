"""The identification page: samples, refusals that keep what was typed, outliers by click, use in the project, bands."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import number
from streamlit.testing.v1 import AppTest

from robomill.compliance.springs.joint_bending import JointBending
from robomill.errors import LoadTestError, ProjectError
from robomill.files import TABLE
from robomill.identification.fit.estimate import identify
from robomill.identification.fit.models import Model, Parameter
from robomill.identification.knowledge import Knowledge
from robomill.identification.laboratory import MAX_LOAD
from robomill.identification.load_test import LoadTests
from robomill.io.measured.load_test_sheets import load_test_template, load_tests_to_csv
from robomill.io.measured.load_tests import read_load_tests
from robomill.io.robot.robots import load_robot
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.io.texts import read_text
from robomill.provenance import Kind, Provenance
from robomill.simulation.run import simulate
from robomill.ui import session
from robomill.ui.bench import SAMPLES, Bench, sample_text
from robomill.ui.identification import words
from robomill.ui.identification.inputs import adopted
from robomill.ui.identification.laboratory import KEY, Exercise, Trial
from robomill.ui.judged import uncertainty
from robomill.ui.project import Project, project_from_toml, project_to_toml
from robomill.ui.session import KEY as PROJECT, Store
from tests.identification.cables import Arm, Rig, as_csv, make
from tests.identification.synthetic import simulated_tests

PAGE = Path(__file__).resolve().parents[2] / "pages" / "4_Identification.py"
HEADER = "theta1_deg,theta2_deg,theta3_deg,theta4_deg,theta5_deg,Fx_N,Fy_N,Fz_N,dx_mm,dy_mm,dz_mm"
GOOD = "-20.556045,-41.011425,6.666809,0,34.344616,250,0,0,0.6803,-0.0547,-0.1071"


@pytest.fixture
def page() -> AppTest:
    """The identification page, opened first and run once."""
    return AppTest.from_file(str(PAGE), default_timeout=60).run()


@pytest.fixture
def among_pages(app: AppTest) -> AppTest:
    """The identification page, reached from the start page."""
    return app.switch_page("pages/4_Identification.py").run()


def bench(page: AppTest) -> Bench:
    return page.session_state[PROJECT].project.bench  # type: ignore[no-any-return]


def exercise(page: AppTest) -> Exercise:
    return page.session_state[PROJECT].values[KEY]  # type: ignore[no-any-return]


def html(page: AppTest) -> str:
    """What stands on the page; a number and its unit are held together on it by a space of their own."""
    return "\n".join(element.proto.body for element in page.get("html")).replace("\u00a0", " ")


def typed(page: AppTest, text: str) -> AppTest:
    return page.text_area(key="identification.rows").set_value(text).run()


def pick(page: AppTest, key: str, value: str) -> AppTest:
    return next(g for g in page.get("button_group") if g.key == key).set_value(value).run()


def click(page: AppTest, key: str) -> AppTest:
    return page.button(key=key).click().run()


# ---- what is there at once -----------------------------------------------------------------------------------------
def test_it_opens_with_a_finished_result(page: AppTest) -> None:
    assert not page.exception
    shown = html(page)
    assert (
        "These synthetic tests predict poses they have not seen to 1.0 %; joint 4 is the least certain, to ± 53 %."
        in shown
    )
    assert "cross-validated; 0.9 % on the data it was fitted to" in shown
    assert "15.72 to 50.99 ×10⁻⁷ rad/(N m)" in shown
    assert "0.292 ± 0.003" in shown  # 2 x 4 um of each reading at 250 N, by 100 N
    assert "synthetic" in shown
    assert any("Joint 4 is known to ± 53 %" in i.value for i in page.info)
    assert len(page.get("plotly_chart")) == 2


@pytest.mark.parametrize("sample", list(SAMPLES))
def test_every_sample_runs_in_every_view(page: AppTest, sample: str) -> None:
    page.selectbox(key="identification.sample").set_value(sample).run()
    for view in ("compliances", "residuals", "models", "next", "cut"):
        pick(page, "identification.view", view)
        assert not page.exception
        assert [e.value for e in page.error] == []
    assert bench(page).sample == sample


@pytest.mark.parametrize("section", ["map", "laboratory"])
def test_the_other_sections_run(page: AppTest, section: str) -> None:
    pick(page, "identification.section", section)
    assert not page.exception
    assert not page.error


# ---- bad input: one sentence, and what was typed stays -------------------------------------------------------------
def _rows(*rows: str) -> str:
    return "\n".join([HEADER, *rows]) + "\n"


def _nine(change: Callable[[list[str]], list[str]]) -> str:
    lines = [line for line in sample_text("nine_points").splitlines() if not line.startswith("#")]
    return "\n".join([lines[0], *change(lines[1:])]) + "\n"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (_rows(GOOD), "3 measured numbers for 5 unknown compliances"),
        (_rows(GOOD, GOOD.replace("250,0,0", "0,250,0")), "one pose"),
        (_rows(GOOD, GOOD.replace("250,0,0", "0,0,0")), "Row 3: the force is zero"),
        (_rows(GOOD).replace(",dx_mm,dy_mm,dz_mm", "").replace(",0.6803,-0.0547,-0.1071", ""), "columns are missing"),
        (_rows(GOOD).replace("dx_mm", "dx_furlong"), "unit 'furlong' is not known; write one of"),
        (_rows(GOOD, GOOD.replace("0.6803", "nan")), "Row 3, column dx_mm"),
        (_rows(GOOD, GOOD.replace("0.6803", "")), "Row 3, column dx_mm: the cell is empty"),
        (_rows(GOOD, GOOD.replace("0.6803", "soft")), "Row 3, column dx_mm: found 'soft', expected a number"),
        (_rows(GOOD, GOOD.replace("-20.556045", "-200")), "Row 3, theta1"),
        ("", "the file is empty"),
        (HEADER, "only a header"),
        ("/etc/hostname", "no column is known"),
    ],
)
def test_bad_input_is_one_sentence_and_stays_in_its_box(page: AppTest, text: str, sentence: str) -> None:
    typed(page, text)
    assert not page.exception
    assert len(page.error) == 1
    if "no column" not in sentence:
        assert sentence in page.error[0].value
    assert "\n" not in page.error[0].value
    assert page.text_area(key="identification.rows").value == text
    assert "Nothing can be identified from these load tests yet." in html(page)


def test_refused_rows_survive_a_visit_elsewhere(among_pages: AppTest) -> None:
    page = among_pages
    text = _rows(GOOD, GOOD.replace("0.6803", "soft"))
    typed(page, text)
    page.switch_page("pages/1_Robot.py").run()
    page.switch_page("pages/4_Identification.py").run()
    assert page.text_area(key="identification.rows").value == text
    assert len(page.error) == 1


def test_a_typed_file_name_is_a_text_and_never_opens_a_file(page: AppTest) -> None:
    typed(page, "/etc/hostname")
    assert "only a header" in page.error[0].value or "no column" in page.error[0].value


def test_fewer_equations_than_unknowns_is_said_and_nothing_breaks(page: AppTest) -> None:
    typed(page, _nine(lambda rows: [rows[0].rsplit(",", 2)[0] + ",,", rows[5]]))
    assert not page.exception
    assert len(page.error) == 1


def test_a_copied_row_and_a_turned_sign_are_suspected_aloud(page: AppTest) -> None:
    typed(page, _nine(lambda rows: [*rows, rows[3]]))
    assert any("repeats row" in w.value for w in page.warning)

    def turned(rows: list[str]) -> list[str]:
        cells = [row.split(",") for row in rows]
        return [",".join([*c[:8], *(f"{-float(v):g}" for v in c[8:])]) for c in cells]

    typed(page, _nine(turned))
    assert not page.exception
    assert any("sign of the displacements" in w.value for w in page.warning)


def test_micrometres_taken_for_millimetres_are_suspected(page: AppTest) -> None:
    typed(page, sample_text("nine_points").replace("dx_mm,dy_mm,dz_mm", "dx_um,dy_um,dz_um"))
    assert any("times smaller" in w.value for w in page.warning)


def test_a_file_that_is_no_text_is_refused() -> None:
    with pytest.raises(LoadTestError, match=r"sheet.xlsx: this is not a text file"):
        read_text(b"PK\x03\x04\xff\xfe\x00", LoadTestError, TABLE, "sheet.xlsx")


def test_the_bench_survives_a_visit_elsewhere(among_pages: AppTest) -> None:
    page = among_pages
    page.selectbox(key="identification.model").set_value("joints+tool").run()
    pick(page, "identification.view", "models")
    page.switch_page("pages/6_Milling.py").run()
    page.switch_page("pages/4_Identification.py").run()
    assert page.selectbox(key="identification.model").value == "joints+tool"
    assert next(g for g in page.get("button_group") if g.key == "identification.view").value == "models"


# ---- outliers ------------------------------------------------------------------------------------------------------
def test_an_outlier_is_used_until_a_click_leaves_it_out(page: AppTest) -> None:
    def spoilt(rows: list[str]) -> list[str]:
        rows[7] = rows[7].rsplit(",", 1)[0] + ",1.5"
        return rows

    typed(page, _nine(spoilt))
    pick(page, "identification.view", "residuals")
    assert any("row 9" in w.value and "until you leave them out" in w.value for w in page.warning)
    assert bench(page).excluded == ()
    click(page, "identification.leave_these_out")
    assert bench(page).excluded == (9,)
    assert "1.0 %" in html(page)
    click(page, "identification.use_all")
    assert bench(page).excluded == ()


# ---- models --------------------------------------------------------------------------------------------------------
def test_models_are_ranked_and_the_absorbed_bending_is_said(page: AppTest) -> None:
    page.selectbox(key="identification.sample").set_value("tilted_bending_tool").run()
    pick(page, "identification.view", "models")
    assert any("have absorbed what is not in the joints" in i.value for i in page.info)
    click(page, "identification.take_best")
    assert bench(page).model == "joints+bending"


# ---- plan ----------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("goal", ["joint", "all", "path"])
def test_three_more_tests_shrink_joint_4_by_a_third(page: AppTest, goal: str) -> None:
    pick(page, "identification.view", "next")
    page.selectbox(key="identification.goal").set_value(goal).run()
    assert not page.exception
    said = next(m.value for m in page.markdown if "more tests should narrow" in m.value).replace("\u00a0", " ")
    if goal == "joint":
        assert "joint 4 by 83 %" in said
    if goal == "path":
        assert "the path's predicted deviation from" in said


def test_the_measuring_sheet_is_read_back_after_filling_in(page: AppTest) -> None:
    from robomill.identification.plan import box_candidates, next_best
    from robomill.io.measured.load_test_sheets import measuring_sheet

    robot = load_robot("slavkovic_5r")
    tests = read_load_tests(sample_text("nine_points"), robot)
    assert isinstance(tests, LoadTests)
    fit = identify(robot, tests)
    plan = next_best(robot, tests, fit, box_candidates(robot, np.array([-0.6, -1.6, 0]), np.array([0.6, -1, 0.1])))
    sheet = measuring_sheet(plan, "nine_points.csv")
    with pytest.raises(LoadTestError, match="the cell is empty"):
        read_load_tests(sheet, robot)
    filled = read_load_tests(sheet.replace(",,,", ",0.1,0.2,0.3\n").replace(",,", ",0.1,0.2,0.3"), robot)
    assert isinstance(filled, LoadTests)
    np.testing.assert_allclose(filled.theta, plan.theta, atol=1e-6)


def test_a_filled_sheet_joins_the_tests_and_narrows_joint_4(page: AppTest) -> None:
    """The loop closed: plan, measure (here: compute from Table 3), bring the sheet back."""
    from robomill.io.measured.load_test_sheets import measuring_sheet
    from robomill.ui.identification.bench import fit_of
    from robomill.ui.identification.plan import joined, plan_of

    robot = load_robot("slavkovic_5r")
    kept = Bench(goal="joint", goal_joint=4)
    before = fit_of(kept, robot)
    plan = plan_of(kept, robot, before)
    measured = simulated_tests(robot.with_compliance_set("table_3"), plan.theta, plan.F, noise=4e-6, seed=8)
    kept = kept.with_tests(*joined(kept, robot, load_tests_to_csv(measured), "sheet.csv"), robot.name)
    after = fit_of(kept, robot)
    widths = [float(np.ptp(fit.ci95[3])) for fit in (before, after)]
    assert widths[1] < 2 / 3 * widths[0], f"from {widths[0]:.3g} to {widths[1]:.3g} rad/(N m)"
    assert after.ci95[3, 0] <= 27.65e-7 <= after.ci95[3, 1]
    with pytest.raises(LoadTestError, match="the cell is empty"):
        joined(kept, robot, measuring_sheet(plan, "x"), "blank.csv")
    with pytest.raises(LoadTestError, match="bring both to the same columns"):
        joined(kept, robot, sample_text("grid_45x6"), "grid.csv")


@pytest.mark.parametrize("protocol", ["joints", "world", "joint by joint", "compliances"])
def test_every_template_says_what_is_missing_rather_than_breaking(page: AppTest, protocol: str) -> None:
    typed(page, load_test_template(protocol, 5))
    assert not page.exception


@pytest.mark.parametrize(
    ("key", "value"),
    [("identification.count", 0.0), ("identification.load:N", -5.0), ("identification.tilt:deg", 400.0)],
)
def test_a_refused_plan_number_stays_with_its_bounds(page: AppTest, key: str, value: float) -> None:
    pick(page, "identification.view", "next")
    number(page, key).set_value(value).run()
    assert not page.exception
    assert "expected" in page.error[0].value
    assert number(page, key).value == value


# ---- use in the project, and the band ------------------------------------------------------------------------------
def test_using_the_compliances_puts_them_and_their_band_in_force(page: AppTest) -> None:
    before = page.session_state[PROJECT].project.setup
    assert page.session_state[PROJECT].project.known is None
    click(page, "identification.use")
    assert not page.exception
    setup = page.session_state[PROJECT].project.setup
    fit = identify(load_robot("slavkovic_5r"), read_load_tests(sample_text("nine_points"), load_robot("slavkovic_5r")))
    np.testing.assert_allclose(setup.robot.C_theta, fit.C_theta, rtol=1e-12)
    assert setup.robot.compliance_set == "identified"
    assert setup.robot.provenance["compliance.identified"].kind == "synthetic"  # as the sample is
    assert "27 load tests (nine_points.csv)" in setup.robot.provenance["compliance.identified"].source
    known = page.session_state[PROJECT].project.known
    np.testing.assert_allclose(known.covariance, fit.covariance)
    assert page.button(key="identification.use").disabled
    page.button(key="undo").click().run()
    assert page.session_state[PROJECT].project.setup.digest() == before.digest()
    assert page.session_state[PROJECT].project.known is None, "undo takes the band along"
    assert not page.button(key="identification.use").disabled
    page.button(key="redo").click().run()
    again = page.session_state[PROJECT].project.known
    assert again is not None, "and redo brings it back"
    np.testing.assert_array_equal(again.covariance, known.covariance)


def test_springs_come_along_and_give_way_to_the_next_identification() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    robot = setup.robot
    tests = read_load_tests(sample_text("tilted_bending_tool"), robot)
    rich = adopted(setup, robot, identify(robot, tests, "joints+bending+tool"), "a.csv")
    assert len(rich.springs) == 3
    again = adopted(rich, rich.robot, identify(robot, tests, "joints+bending+tool"), "b.csv")
    assert len(again.springs) == 3
    plain = adopted(rich, rich.robot, identify(robot, tests), "c.csv")
    assert plain.springs == ()


@pytest.mark.parametrize(
    ("kind", "before", "stays"), [("measured", False, True), ("measured", True, False), ("user", True, True)]
)
def test_a_spring_gives_way_only_where_an_earlier_identification_measured_it(
    kind: Kind, before: bool, stays: bool
) -> None:
    """One's own springs stay, and so does one that was measured before anything was identified here."""
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    robot = setup.robot
    fit = identify(robot, read_load_tests(sample_text("nine_points"), robot))
    spring = JointBending(3, 1e-7, 2e-7, provenance=Provenance(kind, "a source that says nothing"))
    start = (adopted(setup, robot, fit, "a.csv") if before else setup).replace(springs=(spring,))
    assert adopted(start, robot, fit, "b.csv").springs == ((spring,) if stays else ())


def test_bands_are_laid_into_the_path_plot_only_where_something_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    import streamlit as st

    from robomill.viz.theme import figure

    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    monkeypatch.setattr(st, "session_state", {PROJECT: session.Store(Project(setup))})
    fit = identify(setup.robot, read_load_tests(sample_text("nine_points"), setup.robot))
    used = adopted(setup, setup.robot, fit, "a.csv")
    result = simulate(used)
    fig = figure(dark=False, height=200)
    assert not uncertainty.banded(fig, result, "mm", dark=False)
    session.change(robot=used.robot, springs=used.springs)
    session.know(Knowledge.of(fit, setup.robot, "from 27 load tests"))
    assert uncertainty.banded(fig, result, "mm", dark=False)
    assert len(fig.traces) == 4
    assert uncertainty.band_caption(used) == "Shaded: 95 % band, from 27 load tests."
    assert session.known(used.replace(tolerance=1e-4)) is not None, "another tolerance changes no compliance"
    assert session.known(setup) is None


@pytest.mark.parametrize(("units", "joint_unit"), [("in", "kN m/rad"), ("in", "1e-7 rad/(N m)")])
def test_every_section_runs_in_every_unit(page: AppTest, units: str, joint_unit: str) -> None:
    pick(page, "view.units", units)
    page.selectbox(key="view.joint_unit").set_value(joint_unit).run()
    page.selectbox(key="identification.model").set_value("joints+bending+tool").run()
    for view in ("compliances", "residuals", "models", "next", "cut"):
        pick(page, "identification.view", view)
        assert not page.exception
    for section in ("map", "laboratory"):
        pick(page, "identification.section", section)
        assert not page.exception
        assert not page.error


def test_what_shifts_is_shown_in_the_pages_unit_and_joints_in_theirs() -> None:
    shift, joint = Parameter("entry", axis="xy"), Parameter("joint", 2)
    assert words.unit_of(shift, "kN m/rad", "mm") == "um/N"
    assert words.unit_of(shift, "kN m/rad", "in") == "uin/N"
    assert words.unit_of(joint, "kN m/rad", "in") == "kN m/rad"


def test_what_is_known_goes_through_the_project_file() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    robot = setup.robot
    fit = identify(robot, read_load_tests(sample_text("tilted_bending_tool"), robot), "joints+bending")
    used = adopted(setup, robot, fit, "a.csv")
    known = Knowledge.of(fit, robot, "from 72 load tests").widened(robot, force=3.0, length=1e-3)
    project = Project(used, knowledge=known.held_by(used.robot, used.springs))
    text = project_to_toml(project)
    again = project_from_toml(text).known
    assert again is not None
    np.testing.assert_array_equal(again.covariance, known.covariance)
    np.testing.assert_array_equal(again.F, np.diag([9.0, 9.0, 9.0]))
    np.testing.assert_array_equal(again.lengths, np.full(2 * robot.rows, 1e-3))
    assert "[uncertainty]" not in project_to_toml(project.replace(setup=setup)), "known of other compliances"
    assert project_from_toml(project_to_toml(Project(used))).known is None
    for broken in ('model = "rubber"', "dof = []"):
        name = broken.partition(" ")[0]
        damaged = re.sub(rf"^{name} = .*$", broken, text[text.index("[uncertainty]") :], flags=re.M)
        with pytest.raises(ProjectError, match=r"\[uncertainty\]"):
            project_from_toml(text[: text.index("[uncertainty]")] + damaged)


@pytest.mark.parametrize(
    ("value", "half", "unit", "text"),
    [
        (2.3e-4, 2e-5, "mm", "0.23 ± 0.02 mm"),
        (2.916e-4, 1.3e-6, "mm", "0.292 ± 0.001 mm"),
        (2.9162e-4, 3e-7, "mm", "0.2916 ± 0.0003 mm"),
        (1.2e-3, 4e-4, "mm", "1.20 ± 0.40 mm"),
        (2.54e-4, 2.54e-5, "in", "0.0100 ± 0.0010 in"),
    ],
)
def test_digits_follow_the_half_width(value: float, half: float, unit: str, text: str) -> None:
    assert uncertainty.band_text(value, half, unit) == text


def test_without_an_identification_no_tile_has_a_band(page: AppTest) -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    assert uncertainty.tile_text(simulate(setup)) == ""


# ---- the measured map ----------------------------------------------------------------------------------------------
def test_the_map_shows_both_methods_and_their_difference(page: AppTest) -> None:
    pick(page, "identification.section", "map")
    assert len(page.get("plotly_chart")) == 4
    shown = html(page)
    assert "differ by 14.7 % on average; the measured ones are higher" in shown
    assert "0.290" in shown
    page.selectbox(key="identification.map.component").set_value("C_yz").run()
    page.selectbox(key="identification.map.sample").set_value("nine_points_compliances").run()
    assert not page.exception
    assert len(page.get("plotly_chart")) == 4


def test_the_map_agrees_with_the_joint_model_it_was_made_from(page: AppTest) -> None:
    click(page, "identification.use")
    pick(page, "identification.section", "map")
    assert re.search(r"differ by (0\.[5-9]|1\.[0-4]) % on average", html(page))


def test_a_map_with_a_direction_missing_is_one_sentence(page: AppTest) -> None:
    lines = sample_text("grid_45x6").splitlines()
    held = page.session_state[PROJECT]
    held.project = held.project.replace(bench=held.project.bench.with_map("\n".join(lines[:-1]), "mine.csv"))
    pick(page, "identification.section", "map")
    assert not page.exception
    assert "not fully measured" in page.error[0].value


# ---- the laboratory ------------------------------------------------------------------------------------------------
def test_a_student_measures_fits_and_is_scored(page: AppTest) -> None:
    pick(page, "identification.section", "laboratory")
    for x, y, b in ((0.0, -1300.0, 30.0), (400.0, -1500.0, -30.0), (-400.0, -1100.0, 20.0), (500.0, -1200.0, 0.0)):
        for name, value in (("tip[0]:mm", x), ("tip[1]:mm", y), ("tilt[1]:deg", b)):
            number(page, f"identification.lab.{name}").set_value(value).run()
        click(page, "identification.lab.three")
    assert not page.exception
    assert exercise(page).laboratory.budget == 0
    assert page.button(key="identification.lab.measure").disabled
    assert "truth" not in html(page).lower() or not exercise(page).handed_in
    click(page, "identification.lab.hand_in")
    assert "of 100 points" in html(page)
    page.button(key="identification.lab.begin").click().run()
    assert exercise(page).laboratory.budget == 12
    assert not exercise(page).handed_in


@pytest.mark.parametrize("load", [0.0, -50.0, MAX_LOAD + 1])
def test_a_load_that_cannot_be_hung_on_is_refused_at_its_box(page: AppTest, load: float) -> None:
    pick(page, "identification.section", "laboratory")
    number(page, "identification.lab.load:N").set_value(load).run()
    assert page.error[0].value == f"Load: found {load:g} N; expected more than 0 N to {MAX_LOAD:g} N.".replace("-", "−")
    assert number(page, "identification.lab.load:N").value == load
    assert exercise(page).trial.load == Trial.load, "what was asked for stays the last good one"


def test_a_new_exercise_has_what_was_asked_for(page: AppTest) -> None:
    pick(page, "identification.section", "laboratory")
    for name, value in (("seed", 7), ("noise:um", 2.5), ("budget", 30)):
        number(page, f"identification.lab.{name}").set_value(value).run()
    lab = exercise(click(page, "identification.lab.begin")).laboratory
    assert (lab.seed, lab.budget) == (7, 30)
    assert lab.noise == pytest.approx(2.5e-6)


def test_a_pose_out_of_reach_costs_nothing_and_is_explained(page: AppTest) -> None:
    pick(page, "identification.section", "laboratory")
    number(page, "identification.lab.tip[0]:mm").set_value(5000.0).run()
    click(page, "identification.lab.measure")
    assert not page.exception
    assert "not reached" in page.error[0].value
    assert exercise(page).laboratory.budget == 12
    assert number(page, "identification.lab.tip[0]:mm").value == 5000.0


# ---- words ---------------------------------------------------------------------------------------------------------
def test_a_sample_keeps_its_robot_when_the_project_has_another(among_pages: AppTest) -> None:
    page = among_pages
    page.switch_page("pages/1_Robot.py").run()
    page.selectbox(key="robot.name").set_value("kuka_kr270").run()
    page.switch_page("pages/4_Identification.py").run()
    assert not page.exception
    assert not page.error
    assert page.selectbox(key="identification.robot").value == "slavkovic_5r"
    for section in ("map", "laboratory"):
        pick(page, "identification.section", section)
        assert not page.exception


def test_stiffness_turns_intervals_over() -> None:
    low, high = words.interval(np.array([8e-7, 1e-6]), "kN m/rad")
    assert low == pytest.approx(1000.0)
    assert high == pytest.approx(1250.0)


def test_the_constant_model_has_no_joint_to_show() -> None:
    robot = load_robot("slavkovic_5r")
    fit = identify(robot, read_load_tests(sample_text("nine_points"), robot), "constant")
    tiles = words.tiles(fit, "1e-7 rad/(N m)", ("no joints", ""))
    assert tiles[1].value == "none"
    drawn = words.intervals(fit, robot, "1e-7 rad/(N m)")
    assert len(drawn) == 1
    assert not drawn[0].logarithmic


def test_another_robot_is_measured_without_touching_the_project(page: AppTest) -> None:
    robot = load_robot("kuka_kr270")
    rng = np.random.default_rng(4)
    low, high = robot.limits[:, 0], robot.limits[:, 1]
    theta = 0.5 * (low + high) + 0.2 * rng.uniform(-1, 1, (12, robot.n)) * (high - low)
    tests = simulated_tests(
        robot, np.repeat(theta, 3, axis=0), np.tile(np.eye(3) * 500, (12, 1)), noise=1e-6, model=Model("joints")
    )
    before = page.session_state[PROJECT].project.setup.digest()
    page.selectbox(key="identification.robot").set_value("kuka_kr270").run()
    assert len(page.error) == 1
    assert "5 joint columns for a robot of 6 joints" in page.error[0].value
    typed(page, load_tests_to_csv(tests, digits=6))
    assert not page.exception
    assert not page.error
    for view in ("compliances", "residuals", "models", "next", "cut"):
        pick(page, "identification.view", view)
        assert not page.exception
    assert page.session_state[PROJECT].project.setup.digest() == before


def test_a_load_point_that_is_off_is_offered_and_fitted_by_a_click(page: AppTest) -> None:
    """Cable tests whose stated load point is 150 mm off, from the independent simulator."""
    arm, rig = Arm.of("kuka_kr500"), Rig()
    off = 0.150 * np.array([0.6, 0.64, -0.48])
    text = as_csv(arm, make(arm, rig, 43, seed=10), rig.load_point + off, rig.gauge_point)
    page.selectbox(key="identification.robot").set_value("kuka_kr500").run()
    typed(page, text)
    pick(page, "identification.view", "points")
    assert not page.exception
    assert bench(page).fit_points == "none"
    assert any("lines of pull" in info.value for info in page.info)
    click(page, "identification.offer")
    assert not page.exception
    assert bench(page).fit_points == "force"
    assert "Load point, fitted" in html(page)
    click(page, "identification.stated")
    assert bench(page).fit_points == "none"


def test_what_is_decided_about_the_tests_is_undone_and_saved(page: AppTest) -> None:
    page.selectbox(key="identification.model").set_value("joints+tool").run()
    page.selectbox(key="identification.sample").set_value("tilted_bending_tool").run()
    typed(page, sample_text("grid_45x6"))
    saved = project_to_toml(page.session_state[PROJECT].project)
    assert (bench(page).name, bench(page).model) == ("pasted rows", "joints+tool")
    for sample in ("tilted_bending_tool", "nine_points"):
        click(page, "undo")
        assert page.selectbox(key="identification.sample").value == bench(page).sample == sample
    click(page, "undo")
    assert page.selectbox(key="identification.model").value == "joints"
    again = AppTest.from_file(str(PAGE), default_timeout=60)
    again.session_state[PROJECT] = Store(project_from_toml(saved))
    again.run()
    assert not again.exception
    assert again.selectbox(key="identification.model").value == "joints+tool"
    assert again.text_area(key="identification.rows").value == sample_text("grid_45x6")
