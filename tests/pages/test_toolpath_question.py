"""A program that somebody brings asks what it cuts; until that is said nothing is green by the force of another."""

from __future__ import annotations

import re

import numpy as np
import pytest
from conftest import box, errors, go, number, store, words
from streamlit.testing.v1 import AppTest

from robomill.io.materials import load_material, sample_materials
from robomill.io.setups.projects import setup_from_toml, setup_to_toml
from robomill.provenance import Provenance
from robomill.simulation.run import simulate
from robomill.toolpath.source import GCodeSource
from robomill.ui.entry.rows import OWN

POCKET = "G21 G90\nG0 X-20 Y0 Z5\nS8000 M3\nG1 Z-1 F300\nG1 X20 F600\nG0 Z20\nM2\n"
SILENT = POCKET.replace("S8000 M3\n", "")
ASKED = "What is it cutting?"


def bring(app: AppTest, text: str, name: str = "own.nc") -> None:
    """Drop a program on the toolpath page."""
    go(app, "5_Toolpath")
    next(b for b in app.file_uploader if b.label.startswith("Program, ")).upload(name, text.encode(), "text/plain")
    app.run()
    assert not app.exception


def verdict(app: AppTest) -> str:
    """What the core says of the project as it stands."""
    return simulate(store(app).project.setup).verdict.level


def test_nobody_is_asked_of_the_paper(app: AppTest) -> None:
    go(app, "5_Toolpath")
    assert ASKED not in words(app)
    assert "rm-tile open" not in words(app)


@pytest.mark.parametrize("page", ["app", "5_Toolpath", "6_Milling"])
def test_a_dropped_program_is_judged_by_nobody_elses_force(app: AppTest, page: str) -> None:
    bring(app, POCKET)
    assert ASKED in words(app)
    go(app, page)
    assert not app.exception
    text = words(app)
    assert "if the tool is pushed with 100 N" in text
    assert "rm-tile open" in text
    assert not any(f"rm-tile {tone}" in text for tone in ("tight", "out")) or page == "5_Toolpath"
    assert "within tolerance" not in text.lower()
    assert store(app).project.setup.engagement


def test_the_answer_is_one_step_and_ends_the_question(app: AppTest) -> None:
    bring(app, POCKET)
    before = len(store(app).past)
    box(app, "Diameter, mm").set_value(6.0).run()
    app.button(key="toolpath.question.answer").click().run()
    assert not app.exception
    assert errors(app) == []
    assert ASKED not in words(app)
    setup = store(app).project.setup
    assert setup.force.kind == "mechanistic"
    assert setup.cutter.diameter == pytest.approx(6e-3)
    assert setup.carried_from == ""
    assert len(store(app).past) == before + 1
    assert verdict(app) in ("ok", "tight", "out")


def test_a_row_of_ones_own_can_be_what_it_cuts(app: AppTest) -> None:
    """Its force is that of the row, its band that of the alloy's other rows, wherever the row was added."""
    sample = load_material("al7075_hss_ref156")
    own = sample.replace(name="mine", title="From my own tests", provenance=Provenance("user", "our dynamometer"))
    store(app).values[OWN] = {own.name: own}
    bring(app, POCKET)
    app.selectbox(key="toolpath.question.material").set_value("mine").run()
    app.button(key="toolpath.question.answer").click().run()
    assert errors(app) == []
    force = store(app).project.setup.force
    assert force.material == own
    assert {row.name for row in force.alternatives} == {
        row.name for row in sample_materials() if (row.alloy, row.kind) == (own.alloy, own.kind)
    }


def test_what_stands_may_be_kept(app: AppTest) -> None:
    bring(app, POCKET.replace("G1 Z-1 F300", "G0 Z-1"))  # what pushes a cut sideways says nothing of a plunge
    digest = store(app).project.setup.digest()
    app.button(key="toolpath.question.keep").click().run()
    assert ASKED not in words(app)
    assert store(app).project.setup.digest() == digest
    assert verdict(app) in ("ok", "tight", "out")


def test_undo_asks_again(app: AppTest) -> None:
    bring(app, POCKET)
    app.button(key="toolpath.question.answer").click().run()
    assert ASKED not in words(app)
    app.button(key="undo").click().run()
    assert ASKED in words(app)


def test_a_speed_that_the_program_does_not_say_is_asked_for(app: AppTest) -> None:
    bring(app, SILENT)
    app.button(key="toolpath.question.answer").click().run()
    assert "Spindle speed: the program names none" in errors(app)[0]
    assert ASKED in words(app)
    box(app, "Spindle speed, min⁻¹").set_value(8000.0).run()
    app.button(key="toolpath.question.answer").click().run()
    assert not app.exception
    assert errors(app) == []
    said = store(app).project.setup
    told = said.replace(source=GCodeSource(POCKET))
    for path in (said.toolpath, told.toolpath):
        assert path.n_s[path.cutting] == pytest.approx(8000 / 60)
    assert simulate(said).max_deviation == pytest.approx(simulate(told).max_deviation, rel=1e-12)


def test_a_force_of_ones_own_is_not_asked_for_again(app: AppTest) -> None:
    bring(app, POCKET)
    app.button(key="toolpath.question.answer").click().run()
    bring(app, POCKET.replace("X20", "X30"), "next.nc")
    assert ASKED not in words(app)


@pytest.mark.parametrize("by", [0, 120])
def test_a_program_brings_its_own_stock(app: AppTest, by: int) -> None:
    """Beyond the paper's blank, which ends at x = 64 mm, or within it: that is the stock of another part."""
    bring(app, POCKET.replace("X-20", f"X{by - 20}").replace("X20", f"X{by + 20}"))
    setup = store(app).project.setup
    assert setup.stock is None
    assert setup.provenance["stock"].kind == "assumed"
    low, high = setup.stock_block.lower[:2] * 1e3, setup.stock_block.upper[:2] * 1e3
    cut_low, cut_high = (np.array([by + end, 0.0]) for end in (-20, 20))
    assert (low < cut_low - 4.0).all() & (low > cut_low - 10.0).all()
    assert (high > cut_high + 4.0).all() & (high < cut_high + 10.0).all()
    assert "Stock: a block around the cuts, assumed" in words(app)
    assert verdict(app) == "unjudged"


def test_a_stock_that_was_typed_by_hand_stays_with_the_next_program(app: AppTest) -> None:
    """As do the numbers of a cutter that was typed."""
    go(app, "6_Milling")
    number(app, "stock.upper[1]:mm").set_value(25.0).run()
    box(app, "Diameter, mm").set_value(6.0).run()
    typed = store(app).project.setup
    assert typed.provenance["stock"].kind == "user"
    bring(app, POCKET)
    setup = store(app).project.setup
    assert setup.stock is not None
    np.testing.assert_array_equal(setup.stock.upper, typed.stock.upper)
    assert setup.cutter.diameter == typed.cutter.diameter
    assert setup.provenance["cutter"].carried_from == ""
    assert "Stock: the one you gave, 110.0" in words(app)


def test_the_question_is_saved_with_the_project(app: AppTest) -> None:
    bring(app, SILENT)
    setup = store(app).project.setup
    again = setup_from_toml(setup_to_toml(setup))
    assert again.carried_from == setup.carried_from != ""
    assert again.digest() == setup.digest()


def test_a_program_of_holes_alone_is_told_alike_on_every_page(app: AppTest) -> None:
    """A force along the path says nothing of a plunge: nothing is judged, all is reached, and it is still asked for."""
    bring(app, "G21 G90\nG0 X0 Y0 Z5\nG81 X10 Y10 Z-5 R2 F100\nX30\nG80\nG0 Z20\nM2\n")
    stock = "Stock: a block around the cuts, assumed, 32.0 × 12.0 × 10.0 mm, its top at Z = 0.0 mm."
    assert stock in words(app).replace("\u00a0", " ")
    for page in ("app", "6_Milling", "7_Improve"):
        go(app, page)
        assert not app.exception
        said = words(app)
        assert "can be reached" not in said
        assert "mend what is named above" not in said
        assert "says nothing of a plunge" in said
        assert [link.proto.label for link in app.get("page_link")].count("Say what it cuts") == 1, page
        assert "Share of walls and floors" not in said


def test_the_block_around_a_path_in_the_air_says_how_high_it_stands(app: AppTest) -> None:
    """Cut 30 mm over part zero the path goes through a block that was made for it, which nobody saw."""
    bring(app, "G21 G90\nS9000 M3\nG0 X0 Y0 Z50\nG1 Z30 F500\nG1 X180 F1500\nG0 Z50\nM2\n")
    assert "Stock: a block around the cuts, assumed, 192.0 × 12.0 × 26.0 mm, its top at Z = 51.0 mm." in words(
        app
    ).replace("\u00a0", " ")


TWO_TOOLS = (
    "G21 G90\nT1 M6\nS8000 M3\nG0 X-20 Y0 Z5\nG1 Z-1 F300\nG1 X20 F600\nG0 Z20\n"
    "T2 M6\nS9000 M3\nG0 X-20 Y12 Z5\nG1 Z-1 F300\nG1 X20 F600\nG0 Z20\nM2\n"
)


def test_each_of_two_tools_is_asked_for_once_and_the_answer_makes_their_table(app: AppTest) -> None:
    """One cutter's size would be no answer: the set-up would be refused for want of a table."""
    bring(app, TWO_TOOLS)
    asked = [each.key.removeprefix("toolpath.question.") for each in app.text_input if "question" in each.key]
    assert asked == ["diameter.1:mm", "flutes.1", "diameter.2:mm", "flutes.2", "tolerance:mm"]
    assert "cuts and nobody has said what it is" not in words(app)  # once is enough
    for name, typed in (("diameter.1:mm", "6"), ("flutes.1", "2"), ("diameter.2:mm", "10,5")):
        app.text_input(key=f"toolpath.question.{name}").set_value(typed).run()
    app.button(key="toolpath.question.answer").click().run()
    assert errors(app)[-1] == "Tool 2: it cuts, and its diameter or its flutes are not said; type both."
    assert app.text_input(key="toolpath.question.diameter.2:mm").value == "10.500"
    app.text_input(key="toolpath.question.flutes.2").set_value("3").run()
    app.button(key="toolpath.question.answer").click().run()
    assert not app.exception
    assert errors(app) == []
    tools = store(app).project.setup.tools
    said = {number: (tool.cutter.diameter, tool.cutter.flutes) for number, tool in tools.items() if tool.cutter}
    assert said == {1: (pytest.approx(6e-3), 2), 2: (pytest.approx(10.5e-3), 3)}
    assert all("flutes" not in tool.assumed and "kind" in tool.assumed for tool in tools.values())
    assert verdict(app) in ("ok", "tight", "out")
    assert not [key for key in store(app).values if key.startswith("toolpath.question")]


def test_improve_says_no_share_of_the_tolerance_before_that_is_said(app: AppTest) -> None:
    bring(app, POCKET.replace("G1 Z-1 F300", "G0 Z-1"))
    assert verdict(app) == "unjudged"
    go(app, "7_Improve")
    assert not app.exception
    title = re.search(r'<h1 class="rm-title">(.*?)</h1>', words(app))
    assert title is not None
    assert "%" not in title[1]
    assert ": wall error of " in title[1] or ": floor error of " in title[1]
    assert "if the tool is pushed with 100 N" in title[1]
