"""The toolpath page: programs and tables, what is refused is one sentence, what cannot be reached is counted."""

from __future__ import annotations

import dataclasses
import time

import numpy as np
import pytest
from conftest import box, errors, go, store, words
from streamlit.testing.v1 import AppTest

from robomill.toolpath.source import GCodeSource, LinesSource
from robomill.ui.toolpath.reading import BACKGROUND_CHARACTERS
from robomill.ui.work import beside, running


def type_program(app: AppTest, text: str) -> None:
    """Go to the editor and type a program."""
    app.button_group(key="toolpath.mode").set_value("edit").run()
    app.text_area(key="toolpath.text").set_value(text).run()


def test_it_says_what_was_read(app: AppTest) -> None:
    go(app, "5_Toolpath")
    assert not app.exception
    assert (
        "All in reach; the groove is 0.23 mm off in Y and 0.10 mm too deep: within tolerance (77 % of it used)."
        in words(app)
    )
    assert "mm (G21) · 1 cut, 100.0 mm along X." in words(app)


def test_a_pasted_program_is_in_force_everywhere(app: AppTest) -> None:
    go(app, "5_Toolpath")
    type_program(app, "G21 G90\nG0 X-50 Y10 Z-2\nG1 X30 F1200\n")
    assert not app.exception
    assert "80.0" in words(app)
    go(app, "6_Milling")
    assert "Line 3" in words(app)


@pytest.mark.parametrize("text", ["", "   \n", "hello world\n", "G21\nM30\n", "G21 G90\nG2 X10 F100\n", "G1 X1e F10\n"])
def test_a_program_that_cannot_be_read_is_kept_and_explained(app: AppTest, text: str) -> None:
    go(app, "5_Toolpath")
    before = store(app).project.setup.digest()
    type_program(app, text)
    assert not app.exception
    assert len(errors(app)) >= 1
    assert len(errors(app)[0]) > 20
    assert app.text_area(key="toolpath.text").value == text
    if store(app).project.setup.digest() == before:
        go(app, "app")
        assert "0.23 mm off in Y" in words(app)


def test_what_cannot_be_reached_is_counted_and_named(app: AppTest) -> None:
    go(app, "5_Toolpath")
    type_program(app, "G21 G90\nG0 X0 Y0 Z-2\nG1 Y-1500 F1800\n")
    assert not app.exception
    text = words(app)
    assert "mm of the cut cannot be reached" in text
    assert "out of reach at line 3" in text
    go(app, "app")
    assert not app.exception
    assert "Out of reach" in words(app)


def test_part_zero_moves_the_cut(app: AppTest) -> None:
    go(app, "5_Toolpath")
    box(app, "Zero Y, mm").set_value(-1200.0).run()
    box(app, "Turn about Z, °").set_value(90.0).run()
    assert not app.exception
    T_MW = store(app).project.setup.T_MW
    assert T_MW[1, 3] == pytest.approx(-1.2)
    assert T_MW[1, 0] == pytest.approx(1.0)


def test_a_turn_by_more_than_half_is_not_another_one_in_silence(app: AppTest) -> None:
    """1220.5 degrees are three turns and 140.5: what was typed and what it is stand beneath the box."""
    go(app, "5_Toolpath")
    box(app, "Turn about Z, °").set_value("1.220,5").run()
    T_MW = store(app).project.setup.T_MW
    assert np.rad2deg(np.arctan2(T_MW[1, 0], T_MW[0, 0])) == pytest.approx(140.5)
    assert box(app, "Turn about Z, °").value == 140.5
    assert all(number in words(app) for number in ("1220.50", "140.50"))
    box(app, "Turn about Z, °").set_value("90").run()
    assert "1220.50" not in words(app)


def test_program_to_table_and_back(app: AppTest) -> None:
    go(app, "5_Toolpath")
    app.button_group(key="toolpath.kind").set_value("lines").run()
    assert not app.exception
    source = store(app).project.setup.source
    assert isinstance(source, LinesSource)
    assert "0.251" in words(go(app, "app"))
    app.button(key="undo").click().run()
    assert isinstance(store(app).project.setup.source, GCodeSource)


def test_whoever_only_looks_at_the_other_kinds_has_the_program_back(app: AppTest) -> None:
    go(app, "5_Toolpath")
    before = store(app).project
    for kind in ("lines", "sketch", "program"):
        app.button_group(key="toolpath.kind").set_value(kind).run()
        assert store(app).project.setup.source.kind == kind
    after = store(app).project
    assert after.digest() == before.digest()
    assert after.setup.provenance == before.setup.provenance


def test_a_table_that_was_edited_is_not_thrown_away_for_the_program_it_came_from(app: AppTest) -> None:
    go(app, "5_Toolpath")
    app.button_group(key="toolpath.kind").set_value("lines").run()
    setup = store(app).project.setup
    assert isinstance(setup.source, LinesSource)
    longer = dataclasses.replace(setup.source, end=setup.source.end + np.array([0.01, 0.0, 0.0]))
    store(app).project = store(app).project.replace(setup=setup.replace(source=longer))
    app.run()
    app.button_group(key="toolpath.kind").set_value("program").run()
    source = store(app).project.setup.source
    assert isinstance(source, GCodeSource)
    assert source.name == "lines.nc"
    assert source.read().extents[1][0] == pytest.approx(0.06)


def test_what_else_was_changed_meanwhile_stays_when_the_program_comes_back(app: AppTest) -> None:
    go(app, "5_Toolpath")
    given = store(app).project.setup
    app.button_group(key="toolpath.kind").set_value("sketch").run()
    box(app, "Zero Y, mm").set_value(-1250.0).run()
    app.button_group(key="toolpath.kind").set_value("program").run()
    now = store(app).project.setup
    assert now.source == given.source
    assert now.T_MW[1, 3] == pytest.approx(-1.25)


def test_the_program_is_drawn_at_every_run(app: AppTest) -> None:
    go(app, "5_Toolpath")
    for _ in range(2):
        drawn = [element.key for element in app.run().get("bidi_component")]
        assert "toolpath.program" in drawn, "a run that draws nothing takes the program off the page"


def test_a_big_program_is_read_and_run_beside_the_page(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beside, "FIRST_S", 0.0)
    go(app, "5_Toolpath")
    body = "".join(f"G1 X{i % 100} Y{i // 100 % 7}\n" for i in range(180_000))
    text = f"G21 G90\nG0 X0 Y0 Z1\nG1 Z-1 F6000\n{body}M2\n"
    assert len(text) > BACKGROUND_CHARACTERS
    next(b for b in app.file_uploader if b.label.startswith("Program, ")).upload("big.nc", text.encode(), "text/plain")
    app.run()
    for _ in range(60):
        if any(button.key == "run.ask" for button in app.button):  # read, and its reach looked at
            break
        time.sleep(0.2)
        app.run()
    app.button(key="run.ask").click().run()  # with the engagement it takes long
    assert not app.exception
    assert store(app).project.setup.source == GCodeSource(text, "big.nc")
    run = store(app).values[running.PLACE]
    assert not run.done.is_set()
    app.button(key="run.cancel").click().run()
    assert run.done.wait(30)
    assert run.made is None
    assert "not computed yet" in words(app)
    assert app.button(key="run.ask")
    assert not app.exception


def test_a_feed_that_no_cutter_takes_is_a_warning_with_its_line(app: AppTest) -> None:
    go(app, "5_Toolpath")
    type_program(app, "G21 G90 S12000 M3\nG0 X-70 Y0 Z5\nG0 Z-2\nG1 X20 F4500000\nG0 Z5\nM2\n")
    said = words(app)
    assert "line 4: a feed of 4\u202f500\u202f000 mm/min, 375.0 mm a revolution" in said
    assert "every word understood" not in said


def test_a_note_is_no_warning_and_what_is_not_judged_has_no_colour_of_its_deviation(app: AppTest) -> None:
    """Holes alone, pushed by a force along the path: they were drawn as if the tip were off by nothing."""
    go(app, "5_Toolpath")
    assert "Coloured by deviation" in app.selectbox(key="toolpath.colour").options
    type_program(app, "G21 G90\nG0 X0 Y0 Z5\nG81 X10 Y10 Z-5 R2 F100\nX30\nG80\nG0 Z20\nM2\n")
    assert not app.exception
    assert 'Program warnings</div><div class="rm-value">0</div><div class="rm-sub">1 note: ' in words(app)
    assert "Coloured by deviation" not in app.selectbox(key="toolpath.colour").options
    assert app.selectbox(key="toolpath.colour").value == "reach"
