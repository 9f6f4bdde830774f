"""The identification page: samples, refusals that keep what was typed, outliers by click, models, words."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from identification_page import GOOD, HEADER, PAGE, bench, click, html, opened, pick, typed
from streamlit.testing.v1 import AppTest

from robomill.errors import LoadTestError
from robomill.files import TABLE
from robomill.identification.fit.estimate import identify
from robomill.identification.fit.models import Model
from robomill.io.measured.load_test_sheets import load_tests_to_csv
from robomill.io.measured.load_tests import read_load_tests
from robomill.io.robot.robots import load_robot
from robomill.io.texts import read_text
from robomill.ui.bench import SAMPLES, sample_text
from robomill.ui.identification import words
from robomill.ui.project import project_from_toml, project_to_toml
from robomill.ui.session import KEY as PROJECT, Store
from tests.identification.cables import Arm, Rig, as_csv, make
from tests.identification.synthetic import simulated_tests


@pytest.fixture
def page() -> AppTest:
    """The identification page, opened first and run once."""
    return opened()


@pytest.fixture
def among_pages(app: AppTest) -> AppTest:
    """The identification page, reached from the start page."""
    return app.switch_page("pages/4_Identification.py").run()


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
