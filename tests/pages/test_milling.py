"""The milling page: inputs reach the result, refusals keep what was typed, every page takes the same bad values."""

from __future__ import annotations

import pytest
from conftest import errors, go, looked, number, store, words
from streamlit.testing.v1 import AppTest

from robomill.toolpath.source import GCodeSource
from robomill.ui.project import Project


def test_it_runs_with_every_figure(app: AppTest) -> None:
    go(app, "6_Milling")
    assert not app.exception
    assert len(app.get("plotly_chart")) == 4
    assert [b.label for b in app.get("download_button") if b.label in ("Surface STL", "Deviation CSV", "Picture PNG")]


def test_force_reaches_the_tiles(app: AppTest) -> None:
    go(app, "6_Milling")
    number(app, "force.feed_normal:N").set_value(200.0).run()
    assert "0.503" in words(app)
    assert "Out of tolerance" in words(app)
    assert store(app).project.setup.provenance["force"].kind == "user"


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("tolerance:mm", 0.0, "Tolerance: found 0 mm; expected more than 0 mm to 50 mm."),
        ("step:mm", -1.0, "Step along the path: found −1 mm; expected more than 0 mm."),
        ("cutter.diameter:mm", 0.0, "Cutter, Diameter: found 0 mm"),
        ("cutter.flutes", 0, "Cutter, Flutes: found 0"),
        ("stock.lower[0]:mm", 99.0, "Stock in X"),
    ],
)
def test_a_refused_value_stays_in_its_box_with_one_sentence(
    app: AppTest, key: str, value: float, sentence: str
) -> None:
    go(app, "6_Milling")
    before = store(app).project.setup.digest()
    number(app, key).set_value(value).run()
    assert not app.exception
    assert len(errors(app)) == 1
    assert sentence in errors(app)[0]
    assert number(app, key).value == value
    assert store(app).project.setup.digest() == before
    go(app, "1_Robot")
    go(app, "6_Milling")
    assert number(app, key).value == value
    assert len(errors(app)) == 1


def test_a_cell_too_small_names_the_size_that_fits(app: AppTest) -> None:
    go(app, "6_Milling")
    number(app, "cell:mm").set_value(0.001).run()
    assert not app.exception
    assert errors(app)
    assert "cell" in errors(app)[0].lower()
    assert number(app, "cell:mm").value == pytest.approx(0.001)


def test_stock_beside_the_path_is_one_sentence_and_nothing_is_lost(app: AppTest) -> None:
    go(app, "6_Milling")
    number(app, "stock.upper[1]:mm").set_value(300.0).run()
    number(app, "stock.lower[1]:mm").set_value(200.0).run()
    assert not app.exception
    assert "never touches the stock" in words(app)
    assert number(app, "stock.lower[1]:mm").value == 200.0
    go(app, "app")
    assert not app.exception
    assert "never touches the stock" in words(app)


def test_cutter_kinds_and_force_kinds_switch(app: AppTest) -> None:
    go(app, "6_Milling")
    for kind in ("ball", "bull", "chamfer", "flat"):
        app.button_group(key="cutter.kind").set_value(kind).run()
        assert not app.exception
        assert store(app).project.setup.cutter.kind == kind
    app.selectbox(key="force.kind").set_value("constant").run()
    assert not app.exception
    assert number(app, "force.vector_M[1]:N").value == pytest.approx(100.0)
    assert "0.23 mm off in Y" in words(app)


def test_the_view_survives_pages(app: AppTest) -> None:
    go(app, "6_Milling")
    looked(app, camera="top", station=0.2)
    go(app, "app")
    go(app, "6_Milling")
    assert not app.exception
    assert store(app).project.view.camera == "top"
    assert store(app).project.view.station == pytest.approx(0.2)
    assert "(−30.00, 0.00, −2.00)" in words(app)


def test_the_papers_test_is_shown_beside_the_papers_path_alone(app: AppTest) -> None:
    go(app, "6_Milling")
    assert "The paper's test beside this calculation" in [s.value for s in app.header]
    kept = store(app)
    setup = kept.project.setup.replace(source=GCodeSource("G21 G90\nG0 X-20 Y0 Z-2\nG1 X20 F1200\n", "mine.nc"))
    kept.project = Project(setup, kept.project.view, kept.project.preset)
    app.run()
    assert not app.exception
    assert "The paper's test beside this calculation" not in [s.value for s in app.header]
    assert "Downloads" in [s.value for s in app.header]


def test_a_small_cell_is_shown_as_it_is(app: AppTest) -> None:
    go(app, "6_Milling")
    assert app.text_input(key="cell:mm").value.partition(".")[2] == f"{store(app).project.setup.cell * 1e3:.4f}"[2:]


def test_a_program_without_a_speed_keeps_its_last_picture_and_is_asked_for_the_speed(app: AppTest) -> None:
    go(app, "6_Milling")
    kept, shown = store(app), store(app).values["milling.live.sent"]
    app.selectbox(key="force.kind").set_value("mechanistic").run()
    setup = kept.project.setup.replace(source=GCodeSource("G21 G90\nG0 X-20 Y0 Z-2\nG1 X20 F1200\n", "no_speed.nc"))
    kept.project = kept.project.replace(setup=setup)
    app.run()
    assert not app.exception
    assert "No result yet" in words(app)
    assert any("source.n_s" in (box.key or "") for box in app.text_input)
    assert kept.values["milling.live.sent"] != ""
    number(app, next(box.key for box in app.text_input if "source.n_s" in (box.key or ""))).set_value(12000).run()
    assert not app.exception
    assert "No result yet" not in words(app)
    assert kept.values["milling.live.sent"] != shown


@pytest.mark.parametrize("gone", ["cell:mm", "tolerance:mm", "force.feed_normal:N", "cutter.diameter:mm"])
def test_an_emptied_box_leaves_the_picture(app: AppTest, gone: str) -> None:
    go(app, "6_Milling")
    shown = store(app).values["milling.live.sent"]
    app.text_input(key=gone).set_value("").run()
    assert not app.exception
    assert store(app).values["milling.live.sent"] == shown
    assert "No result yet" not in words(app)


def test_an_exaggeration_of_ones_own_is_drawn_too(app: AppTest) -> None:
    go(app, "6_Milling")
    held = store(app)
    assert held.project.view.camera == "iso"
    looked(app, camera="front", exaggeration=37.0, station=1.0)
    assert not app.exception
    assert held.project.view.exaggeration == 37.0


def test_an_angle_beyond_its_bounds_is_refused_in_the_unit_of_its_box(app: AppTest) -> None:
    go(app, "6_Milling")
    box = next(b for b in app.text_input if b.label == "Helix angle, °")
    box.set_value("1220,5").run()
    assert errors(app) == ["Cutter, Helix angle: found 1220.5°; expected 0° to less than 85°."]


def test_a_station_in_a_plunge_is_of_the_line_that_the_picture_tells(app: AppTest) -> None:
    """The force stated along the path says nothing of the plunge in line 3; the sample that is judged is of line 4."""
    kept = store(app)
    text = "G21 G90 S9000 M3\nG0 X-40 Y0 Z3\nG1 Z-2 F300\nG1 X0 F900\nM2\n"
    kept.project = kept.project.replace(setup=kept.project.setup.replace(source=GCodeSource(text, "plunge.nc")))
    go(app, "6_Milling")
    looked(app, station=0.05)
    assert "Line 3</b> is not judged here; what follows is of the nearest point that is, line 4" in words(app)
    looked(app, station=0.5)
    assert "is not judged here" not in words(app)
    assert "<b>Line 4</b> · the tip stands at" in words(app)
