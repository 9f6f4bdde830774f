"""The toolpath page's sketch, program and part zero: table, pad and project are the same data."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from conftest import box, errors, go, number, store, words
from streamlit.testing.v1 import AppTest

from robomill.errors import ToolpathError
from robomill.toolpath.sketch import Element, Sketch
from robomill.toolpath.sketch_presets import PRESETS, preset
from robomill.toolpath.source import GCodeSource, SketchSource
from robomill.toolpath.text import split_lines
from robomill.ui.toolpath.part_zero import frame_points, points_frame
from robomill.ui.toolpath.program_view import window
from robomill.ui.toolpath.sketch_table import pad_elements, sketch_frame, sketch_from_frame, sketch_from_pad
from robomill.units import to_si

UNITS = [("mm", "mm/min"), ("in", "in/min")]


@pytest.fixture
def sketching(app: AppTest) -> AppTest:
    """The toolpath page with the sketch chosen."""
    go(app, "5_Toolpath")
    app.button_group(key="toolpath.kind").set_value("sketch").run()
    assert not app.exception
    return app


def sketch_of(app: AppTest) -> Sketch:
    source = store(app).project.setup.source
    assert isinstance(source, SketchSource)
    return source.sketch


def test_the_program_becomes_a_sketch_of_the_same_slot(sketching: AppTest) -> None:
    elements = sketch_of(sketching).elements
    assert [e.shape for e in elements] == ["line"]
    np.testing.assert_allclose(elements[0].points, [[-0.05, 0], [0.05, 0]])
    assert elements[0].depth == pytest.approx(2e-3)
    assert elements[0].v_f == pytest.approx(30e-3)
    assert "+0.230" in words(sketching)
    sketching.button(key="undo").click().run()
    assert isinstance(store(sketching).project.setup.source, GCodeSource)


@pytest.mark.parametrize("name", PRESETS)
def test_every_ready_made_sketch_is_drawn_and_simulated(sketching: AppTest, name: str) -> None:
    sketching.selectbox(key="toolpath.preset").set_value(name).run()
    sketching.button(key="toolpath.draw").click().run()
    assert not sketching.exception
    assert not errors(sketching)
    expected = preset(name, sketch_of(sketching), store(sketching).project.setup.cutter.diameter)
    assert sketch_of(sketching).toolpath().digest() == expected.toolpath().digest()
    assert "All in reach; " in words(sketching)


def test_a_word_that_cannot_be_cut_is_kept_and_explained(sketching: AppTest) -> None:
    sketching.selectbox(key="toolpath.preset").set_value("word").run()
    sketching.text_input(key="toolpath.word").set_value("€").run()
    assert any("no strokes for '€'" in e for e in errors(sketching))
    assert len(sketch_of(sketching).elements) == 1, "the sketch before stays"
    sketching.text_input(key="toolpath.word").set_value("HI").run()
    assert not errors(sketching)
    assert len(sketch_of(sketching).elements) == 6


def test_feed_and_depth_of_new_shapes_are_no_step_to_undo(sketching: AppTest) -> None:
    steps, digest = len(store(sketching).past), store(sketching).project.setup.digest()
    box(sketching, "Depth, mm").set_value(1.5).run()
    box(sketching, "Feed, mm/min").set_value(600.0).run()
    assert sketch_of(sketching).depth == pytest.approx(1.5e-3)
    assert "that is 10.0 mm/s" in words(sketching)
    assert (len(store(sketching).past), store(sketching).project.setup.digest()) == (steps, digest)
    sketching.button(key="toolpath.all").click().run()
    assert sketch_of(sketching).elements[0].depth == pytest.approx(1.5e-3)
    assert len(store(sketching).past) == steps + 1


def test_a_feed_of_nothing_is_refused_beside_its_box(sketching: AppTest) -> None:
    box(sketching, "Feed, mm/min").set_value(0.0).run()
    assert any("Feed: found 0 mm/min" in e for e in errors(sketching))
    assert sketch_of(sketching).v_f == pytest.approx(30e-3)


def test_an_empty_sketch_leaves_the_board(sketching: AppTest) -> None:
    kept = store(sketching)
    setup = kept.project.setup
    kept.project = type(kept.project)(setup.replace(source=SketchSource(Sketch())), kept.project.view)
    sketching.run()
    assert not sketching.exception
    assert "There is no path yet." in words(sketching)
    assert not errors(sketching)


def test_sketches_survive_the_project_file(sketching: AppTest) -> None:
    from robomill.ui.project import project_from_toml, project_to_toml

    project = store(sketching).project
    again = project_from_toml(project_to_toml(project))
    assert again.setup.digest() == project.setup.digest()


def shapes() -> Sketch:
    rng = np.random.default_rng(3)
    count = {"line": 2, "polyline": 7, "polygon": 5, "rectangle": 2, "arc": 3, "circle": 2}
    return Sketch(
        tuple(
            Element(shape, rng.uniform(-0.3, 0.3, (n, 2)).round(5), depth, 0.01 + depth)  # type: ignore[arg-type]
            for (shape, n), depth in zip(count.items(), np.linspace(1e-3, 6e-3, 6), strict=True)
        )
    )


@pytest.mark.parametrize(("unit", "feed"), UNITS)
def test_pad_and_table_give_the_sketch_back(unit: str, feed: str) -> None:
    """The pad in display units; a table that is not touched keeps every bit."""
    sketch = shapes()
    from_table = sketch_from_frame(sketch_frame(sketch, unit), sketch, unit)
    sent = {"elements": pad_elements(sketch, unit, feed), "grid": 0.1}
    from_pad = sketch_from_pad(sent, sketch, unit, feed)
    for found, tolerance in ((from_table, 0.0), (from_pad, 3e-8)):
        for a, b in zip(found.elements, sketch.elements, strict=True):
            assert a.shape == b.shape
            np.testing.assert_allclose(a.points, b.points, atol=tolerance)
            assert (a.depth, a.v_f) == pytest.approx((b.depth, b.v_f), rel=0.0, abs=tolerance)
    assert from_pad.grid == pytest.approx(to_si(0.1, unit))


@pytest.mark.parametrize(
    ("points", "found"),
    [
        ("0 0; 10 5", [[0, 0], [10, 5]]),
        ("(0, 0); (10, −5)", [[0, 0], [10, -5]]),
        ("1e1,.5;\n-2.,+3 ;", [[10, 0.5], [-2, 3]]),
        ("1 in, 1/2 in; 0,0", [[25.4, 12.7], [0, 0]]),
        ("1 220, 5; 12,5 7,25", [[1220, 5], [12.5, 7.25]]),
    ],
)
def test_points_are_typed_in_many_ways(points: str, found: list[list[float]]) -> None:
    frame = pd.DataFrame([{"line": None, "shape": None, "points": points, "depth": None, "feed": None}])
    sketch = sketch_from_frame(frame, Sketch(), "mm")
    assert sketch.elements[0].shape == "line"
    assert sketch.elements[0].depth == Sketch().depth
    np.testing.assert_allclose(sketch.elements[0].points, np.array(found) * 1e-3)


@pytest.mark.parametrize(
    ("shape", "points", "says"),
    [
        ("line", "", "Row 1: points are missing"),
        ("line", "1,5; 2,5; 3", "Row 1: '3' is not a point"),
        ("line", "0; 5 1", "Row 1: '0' is not a point"),
        ("line", "a b; 1 2", "Row 1: 'a b' is not a point"),
        ("line", "1,220 5; 1 2", "Row 1: '1,220 5' is not a point"),
        ("line", "5 N, 3; 1 2", "Row 1: '5 N, 3' is not a point"),
        ("circle", "0 0; 0 0", "Row 1: Sketch: points 1 and 2 of the circle are the same"),
        ("blob", "0 0; 1 1", "Row 1: 'blob' is not a shape"),
    ],
)
def test_points_that_are_none_are_refused_by_row(shape: str, points: str, says: str) -> None:
    frame = pd.DataFrame([{"line": None, "shape": shape, "points": points, "depth": 1e-3, "feed": 0.1}])
    with pytest.raises(ToolpathError) as refusal:
        sketch_from_frame(frame, Sketch(), "mm")
    assert str(refusal.value).startswith(says)


def test_long_shapes_are_kept_though_their_points_are_not_typed() -> None:
    sketch = preset("spiral", Sketch(), 8e-3)
    frame = sketch_frame(sketch, "mm")
    assert frame["points"][0] == f"{len(sketch.elements[0].points)} points"
    frame.loc[0, "depth"] = 3e-3
    found = sketch_from_frame(frame, sketch, "mm")
    np.testing.assert_array_equal(found.elements[0].points, sketch.elements[0].points)
    assert found.elements[0].depth == pytest.approx(3e-3)


def test_three_points_of_the_table_give_the_frame_back(app: AppTest) -> None:
    go(app, "5_Toolpath")
    T_MW = store(app).project.setup.T_MW
    frame = points_frame(T_MW)
    points = frame_points(frame)
    from robomill.toolpath.part_zero import frame_from_points

    np.testing.assert_allclose(frame_from_points(*points).T_MW, T_MW, atol=1e-7)
    frame.loc[1, "Y"] = None
    with pytest.raises(ToolpathError, match="on \\+x: Y is missing"):
        frame_points(frame)
    app.button_group(key="toolpath.way").set_value("points").run()
    assert not app.exception
    assert "Touch the zero" in words(app)


BAD = b"G21 G90\nG0 X0 Y0 Z1\nG1 Z-1 F100\nG2 X10 Y0 I3 J0\nM2\n"
GOOD = b"%\nO1001 (PART)\nG21 G90\nT1 M6\nM8\nG0 X0 Y0 Z1\nG1 Z-1 F120\nX20\nM30\n%\n"


def drop(app: AppTest, data: bytes, name: str) -> AppTest:
    """A file dropped on the page."""
    box = next(b for b in app.file_uploader if b.label.startswith("Program, "))
    box.upload(name, data, "text/plain") if hasattr(box, "upload") else box.set_value((name, data, "text/plain"))
    return app.run()


def test_a_dropped_program_is_read_and_its_dialect_said(app: AppTest) -> None:
    go(app, "5_Toolpath")
    drop(app, GOOD, "PART.NC")
    assert not app.exception
    source = store(app).project.setup.source
    assert isinstance(source, GCodeSource)
    assert source.name == "PART.NC"
    assert "Read as Fanuc-like code, guessed" in words(app)
    app.selectbox(key="toolpath.dialect").set_value("linuxcnc").run()
    assert "as you chose" in words(app) or errors(app)


def test_a_program_that_is_refused_is_shown_at_its_line(app: AppTest) -> None:
    go(app, "5_Toolpath")
    before = store(app).project.setup.digest()
    drop(app, BAD, "bad.nc")
    assert not app.exception
    assert any(e.startswith("bad.nc was not taken. Line 4") for e in errors(app))
    assert store(app).project.setup.digest() == before
    app.button(key="toolpath.mend").click().run()
    assert "I3 J0" in str(app.text_area(key="toolpath.text").value)
    app.text_area(key="toolpath.text").set_value(BAD.decode().replace("I3", "I5")).run()
    assert not errors(app)
    assert store(app).project.setup.digest() != before


def test_a_line_is_pointed_at_by_its_number(app: AppTest) -> None:
    go(app, "5_Toolpath")
    assert app.text_input(key="toolpath.go-to").value == "", "no line is pointed at, and none is called 0"
    number(app, "toolpath.go-to").set_value(7).run()
    assert not app.exception
    assert any("Line 7: N50 G1 X50 F1800 — 1 move, 100.00 mm at 1800 mm/min (30.0 mm/s)" in i.value for i in app.info)


@pytest.mark.parametrize(
    ("colour", "seen"),
    [("reach", "plan"), ("deviation", "turn"), ("limits", "plan"), ("feed", "turn"), ("depth", "arm")],
)
def test_every_way_to_look_at_the_path(app: AppTest, colour: str, seen: str) -> None:
    go(app, "5_Toolpath")
    app.selectbox(key="toolpath.colour").set_value(colour).run()
    app.button_group(key="toolpath.seen").set_value(seen).run()
    assert not app.exception
    assert not errors(app)
    assert len(app.get("plotly_chart")) == 1


def test_a_long_program_is_shown_around_the_selected_line() -> None:
    text = "\r\n".join(f"G1 X{i}" for i in range(20_000))
    lines = split_lines(text)
    assert len(lines) == 20_000
    first, shown = window(lines, 12_345)
    assert first <= 12_345 < first + len(shown)
    assert len(shown) <= 1300
    assert shown[12_345 - first] == lines[12_344]
    assert window(lines, 12_346)[0] == first, "neighbours share their window"
    assert window(lines[:10], 3) == (1, list(lines[:10]))
