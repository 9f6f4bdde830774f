"""The other sections of the identification page: the measured map and the laboratory."""

from __future__ import annotations

import re

import pytest
from conftest import number
from identification_page import click, exercise, html, opened, pick
from streamlit.testing.v1 import AppTest

from robomill.identification.laboratory import MAX_LOAD
from robomill.ui.bench import sample_text
from robomill.ui.identification.laboratory import Trial
from robomill.ui.session import KEY as PROJECT


@pytest.fixture
def page() -> AppTest:
    """The identification page, opened first and run once."""
    return opened()


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
