"""The start page shows the paper's milling test, finished, without a click."""

from __future__ import annotations

import dataclasses

import pytest
from conftest import errors, go, store, words
from streamlit.testing.v1 import AppTest


def test_the_first_screen_says_the_papers_numbers(app: AppTest) -> None:
    assert not app.exception
    text = words(app)
    assert "The groove is 0.23 mm off in Y and 0.10 mm too deep: within tolerance (77 % of it used)." in text
    for word in ("Wall error", "Floor error", "Tip off its path", "Verdict"):
        assert word in text
    assert "I design robots" in text
    assert "I mill parts" in text
    assert "I teach" in text


def test_paper_and_assumed_numbers_are_marked(app: AppTest) -> None:
    text = words(app)
    for kind in ("paper", "measured", "assumed", "computed"):
        assert f"rm-{kind}" in text
    assert "are not printed" in text
    assert "100 N left of the feed" in text
    for number in ("0.23 mm", "0.26 mm", "0.29 mm", "0.30 mm"):
        assert number in text


def test_no_graphics_library_is_said_at_the_picture_with_the_command(app: AppTest) -> None:
    assert words(go(app, "app")).count("apt-get") == 1
    assert not app.exception
    assert app.get("plotly_chart")


def test_inch_changes_every_number_on_the_page(app: AppTest) -> None:
    app.button_group(key="view.units").set_value("in").run()
    assert not app.exception
    assert "The groove is 0.0090 in off in Y" in words(app)
    assert store(app).project.view.units == "in"


def test_the_fingerprint_is_shown(app: AppTest) -> None:
    assert store(app).project.setup.digest()[:12] in words(app)


def test_the_sidebar_shows_the_units_on_every_page(app: AppTest) -> None:
    app.button_group(key="view.units").set_value("in").run()
    for page in ("1_Robot", "5_Toolpath", "6_Milling", "app"):
        go(app, page)
        assert app.button_group(key="view.units").value in ("in", ["in"]), page
        assert app.selectbox(key="view.joint_unit").value == "1e-7 rad/(N m)"


def test_a_broken_project_is_refused_where_it_was_opened(app: AppTest) -> None:
    before = store(app).project.setup.digest()
    box = next(b for b in app.file_uploader if b.label.startswith("A project"))
    box.set_value(("mine.toml", b"format = [", "text/plain"))
    app.run()
    assert not app.exception
    # Once inside the popover, once in the side bar for when the popover is closed.
    said = [e for e in errors(app) if e.startswith("mine.toml was not opened.")]
    assert len(said) == 2
    assert said[0] == said[1]
    assert store(app).project.setup.digest() == before


def test_a_program_dropped_on_the_first_screen_is_asked_what_it_cuts(app: AppTest) -> None:
    box = next(b for b in app.file_uploader if b.label == "Check my program")
    box.set_value(("PART.NC", b"G21 G90\nG0 X0 Y0 Z5\nG1 Z-1 F300\nG1 X40\nG0 Z5\nM30\n", "text/plain"))
    app.run()
    assert not app.exception
    assert store(app).page == "Toolpath"
    assert store(app).project.setup.source.name == "PART.NC"
    assert app.selectbox(key="toolpath.question.material").value
    assert 'class="rm-top open"' in words(app), "hatched until somebody has said what is cut"


def test_what_is_no_program_is_refused_on_the_first_screen(app: AppTest) -> None:
    box = next(b for b in app.file_uploader if b.label == "Check my program")
    box.set_value(("part.docx", b"x", "text/plain"))
    app.run()
    assert store(app).page == "Start"
    assert any(said.startswith("part.docx: expected a program") for said in errors(app))


def test_the_first_screen_says_what_this_is_and_counts_what_the_result_rests_on(app: AppTest) -> None:
    assert "predicts how far a milling robot is pushed off its path" in words(app)
    assert app.expander[0].label == "Why believe this? It rests on 11 inputs: 5 published, 5 assumed, 1 measured"
    assert words(app).count("<h1") == 1


def test_the_door_of_a_designer_opens_at_stiffer_joints(app: AppTest) -> None:
    app.button(key="start.stiffen").click().run()
    assert not app.exception
    (picked,) = (each for each in app.get("button_group") if each.key == "improve.remedy")
    assert picked.value == "stiffen"
    assert "twice as stiff" in words(app)


def test_a_carved_sample_opens_with_a_click(app: AppTest) -> None:
    app.button(key="start.open.heart").click().run()
    assert not app.exception
    assert store(app).project.preset == "heart"
    assert "0.26 mm" in words(app)


@pytest.mark.parametrize("picked", ["", None])
def test_a_project_of_no_example_is_ones_own_file_until_an_example_is_picked(app: AppTest, picked: str | None) -> None:
    kept = store(app)
    kept.project = own = dataclasses.replace(kept.project, preset="")
    examples = app.run().selectbox(key="project.preset")
    assert examples.options[0] == "Your file"
    examples.set_value(picked)
    app.run()
    assert errors(app) == []
    assert store(app).project is own
    assert app.selectbox(key="project.preset").value == ""
    app.selectbox(key="project.preset").set_value("heart").run()
    assert store(app).project.preset == "heart"
    assert "Your file" not in app.selectbox(key="project.preset").options
