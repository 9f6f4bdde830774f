"""Two tools, a spindle that turns the wrong way: what the pages ask for, and what they do not judge."""

from __future__ import annotations

import pytest
from conftest import errors, go, number, store, words
from streamlit.testing.v1 import AppTest

from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.toolpath.source import GCodeSource

PROGRAM = """G21 G90
T1 M6
S12000 M3
G0 X-40 Y-10 Z20
G0 Z-1
G1 X40 F1800
G0 Z20
T2 M6
S12000 M3
G0 X-40 Y10
G0 Z-1
G1 X40 F1800
G0 Z20
M2
"""


@pytest.fixture
def two_tools(app: AppTest) -> AppTest:
    """The milling page with the program open and no table."""
    held = store(app)
    held.project = held.project.replace(setup=held.project.setup.replace(source=GCodeSource(PROGRAM), stock=None))
    return go(app, "6_Milling")


def test_two_tools_without_a_table_are_asked_for_by_number(two_tools: AppTest) -> None:
    app = two_tools
    assert not app.exception
    assert [number for number in (1, 2, 3) if f"Tool {number} cuts" in words(app)] == [1, 2]
    assert any("T1, T2" in text for text in errors(app))
    app.text_input(key="milling.tools.ask.1:mm").set_value("8").run()
    app.text_input(key="milling.tools.ask.2:mm").set_value("12").run()
    assert not app.exception
    tools = store(app).project.setup.tools
    assert {number: tool.cutter.diameter for number, tool in tools.items() if tool.cutter} == {1: 8e-3, 2: 12e-3}
    assert "cuts and nobody has said" not in words(app)
    assert "flutes 2" in words(app).lower()


def test_a_table_comes_from_a_file_in_its_unit_and_goes_again(two_tools: AppTest) -> None:
    app = two_tools
    box = next(b for b in app.file_uploader if b.label.startswith("Tool table"))
    box.set_value(("mill.tbl", b"T1 P1 D0.3 Z2\nT2 P2 D0.5 Z2.4\n", "text/plain"))
    app.run()
    assert not app.exception
    assert [tool.length for tool in store(app).project.setup.tools.tools] == pytest.approx([0.002, 0.0024])
    app.button_group(key="milling.tools.unit").set_value("in").run()
    assert [tool.length for tool in store(app).project.setup.tools.tools] == pytest.approx([0.0508, 0.06096])
    app.button(key="milling.tools.clear").click().run()
    assert not store(app).project.setup.tools
    assert number(app, "cutter.diameter:mm").value == 8.0


def test_a_table_begins_with_the_cutter_in_force(app: AppTest) -> None:
    go(app, "6_Milling")
    app.button(key="milling.tools.make").click().run()
    assert not app.exception
    (tool,) = store(app).project.setup.tools.tools
    assert tool.cutter == store(app).project.setup.cutter
    assert "The groove is 0.23 mm off in Y and 0.10 mm too deep: within tolerance (77 % of it used)." in words(app)


@pytest.mark.parametrize("page", ["app", "6_Milling", "7_Improve"])
def test_a_cut_that_is_not_judged_is_said_on_every_page(app: AppTest, page: str) -> None:
    """M4 with a right-hand cutter does not cut: never green, no traceback, and no number."""
    held = store(app)
    program = "G21 G90\nS12000 M4\nG0 X-50 Y0 Z20\nG0 Z-2\nG1 X50 F1800\nG0 Z20\nM2\n"
    setup = load_setup(samples_dir() / "paper_flute" / "setup_process.toml")
    held.project = held.project.replace(setup=setup.replace(source=GCodeSource(program)))
    app.selectbox(key="view.joint_unit").set_value("kN m/rad").run()  # any change runs the page
    go(app, page)
    assert not app.exception
    text = words(app)
    assert "rm-tile ok" not in text
    if page != "7_Improve":
        assert "not judged" in text
