"""What a path may come in, on the toolpath page: points, drawings, odd endings, and a tool table for a program."""

from __future__ import annotations

import io
import math

import ezdxf
import numpy as np
import pytest
from conftest import Grid, errors, go, store, words
from streamlit.testing.v1 import AppTest

from robomill.io.samples import samples_dir
from robomill.toolpath.path import Toolpath

BRACKET = samples_dir() / "drawings"
POINTS = b"X_mm,Y_mm,Z_mm,feed_mm_min\n-50,0,5,0\n-50,0,-2,300\n50,0,-2,1800\n"
SIDED = "G21 G90\nS9000 M3\nG0 X-40 Y0 Z5\nG0 Z-1\nG41 D1 G1 X-30 F600\nX30\nG40 X40\nM2\n"


def bring(app: AppTest, data: bytes, name: str) -> AppTest:
    go(app, "5_Toolpath")
    next(b for b in app.file_uploader if b.label.startswith("Program, ")).upload(name, data, "text/plain")
    app.run()
    assert not app.exception
    return app


def cut(app: AppTest) -> Toolpath:
    app.button(key="toolpath.drawing.cut").click().run()
    assert not app.exception
    return store(app).project.setup.toolpath


def level(path: Toolpath) -> float:
    """m at feed without plunges."""
    flat = path.cutting & (np.abs(np.diff(path.p[:, 2], prepend=path.p[0, 2])) < 1e-12)
    return float(path.step_length[flat].sum())


@pytest.mark.parametrize("name", ["bracket.dxf", "bracket.svg"])
def test_a_drawing_is_cut_layer_by_layer_as_the_table_says(app: AppTest, grid: Grid, name: str) -> None:
    bring(app, (BRACKET / name).read_bytes(), name)
    assert "5 lines within 120.0 × 80.0 mm, drawn in mm." in words(app)
    assert store(app).project.setup.source.kind == "program", "until somebody says what is cut"
    table = "toolpath.drawing.layers:mm"
    assert list(grid.shown[table]["side"]) == ["on"] * 3
    grid.typed = (table, 1, "side", "inside")
    app.run()
    assert not errors(app)
    kept = store(app).values["toolpath.drawing.cuts"]
    slots = kept["slots"][1].replace(depth_mm=3, step_down_mm=1, feed_mm_min=600)
    store(app).values["toolpath.drawing.cuts"] = {**{name: (False, cut) for name, (_, cut) in kept.items()}} | {
        "slots": (True, slots)
    }
    path = cut(app)
    assert store(app).project.setup.source.kind == "sketch"
    assert store(app).project.setup.name == "bracket"
    assert level(path) == pytest.approx(2 * 3 * (2 * 40 + 2 * math.pi * 1) * 1e-3, rel=2e-4), "a cutter of 8 mm"
    assert path.p[:, 2].min() == pytest.approx(-3e-3)
    assert "What is it cutting?" in words(app)
    app.button(key="toolpath.drawing.leave").click().run()
    assert "5 lines within" not in words(app)


def test_a_drawing_that_is_silent_is_asked_for_its_unit(app: AppTest) -> None:
    doc = ezdxf.new("R2000")
    doc.units = 0
    doc.modelspace().add_line((-2, 0), (2, 0))
    out = io.StringIO()
    doc.write(out)
    bring(app, out.getvalue().encode(), "SILENT.DXF")
    assert "the drawing does not say its unit; it would be 4.0 × 0.0 mm in mm, 101.6 × 0.0 mm in in" in words(app)
    app.selectbox(key="toolpath.drawing.unit.choice").set_value("in").run()
    assert level(cut(app)) == pytest.approx(4 * 25.4e-3)


def test_a_cutter_that_does_not_fit_is_refused_beneath_the_button(app: AppTest, grid: Grid) -> None:
    bring(app, (BRACKET / "bracket.dxf").read_bytes(), "bracket.dxf")
    grid.typed = ("toolpath.drawing.layers:mm", 2, "side", "inside")
    app.run()
    held = store(app)
    setup = held.project.setup
    held.project = held.project.replace(setup=setup.replace(cutter=setup.cutter.replace(diameter_mm=14)))
    app.button(key="toolpath.drawing.cut").click().run()
    assert not app.exception
    assert any("a cutter of 14.00 mm does not fit" in text for text in errors(app))
    assert store(app).project.setup.source.kind == "program"


def test_points_become_the_path(app: AppTest) -> None:
    bring(app, POINTS, "Path.CSV")
    source = store(app).project.setup.source
    assert (source.kind, source.name) == ("points", "Path.CSV")
    assert level(source.read()) == pytest.approx(0.1)
    assert "3 points from a file" in words(app)


def test_points_that_are_silent_are_asked_for_unit_and_feed(app: AppTest) -> None:
    bring(app, b"X,Y,Z\n-2,0,-0.1\n2,0,-0.1\n", "p.csv")
    assert "X, Y, Z name no unit" in words(app)
    app.button_group(key="toolpath.points.unit").set_value("in").run()
    app.text_input(key="toolpath.points.feed:mm/min").set_value("600").run()
    app.button(key="toolpath.points.take").click().run()
    assert not app.exception
    path = store(app).project.setup.toolpath
    assert level(path) == pytest.approx(4 * 25.4e-3)
    assert path.v_f[1] == pytest.approx(10e-3)
    assert "name no unit" not in words(app)


@pytest.mark.parametrize("name", ["O1234", "PART.MPF", "part.001", "part.PRG", "part.h.NC"])
def test_programs_end_as_they_do_in_the_field(app: AppTest, name: str) -> None:
    bring(app, b"G21 G90\nG0 X-20. Y0. Z5.\nG1 Z-1. F300.\nX20.\nM2\n", name)
    assert not errors(app)
    assert store(app).project.setup.source.name == name


@pytest.mark.parametrize(
    ("data", "name", "said"),
    [
        (b"%PDF", "part.pdf", "expected a program"),
        (b"not a drawing", "a.dxf", "a.dxf: "),
        (b"<svg", "a.svg", "this is no SVG file"),
        (b"a;b\n1;2\n", "a.csv", "no column is known"),
        (b"PAR1", "a.parquet", "this is no Parquet file"),
    ],
)
def test_what_is_none_of_these_is_refused_and_the_path_stays(app: AppTest, data: bytes, name: str, said: str) -> None:
    bring(app, data, name)
    assert any(said in text for text in errors(app))
    assert store(app).project.setup.source.name == "path.nc"


def test_a_program_with_cutter_compensation_is_taken_once_there_is_a_tool_table(app: AppTest) -> None:
    bring(app, SIDED.encode(), "sided.nc")
    assert any("sided.nc was not taken" in text for text in errors(app))
    table = next(b for b in app.file_uploader if b.label.startswith("Tool table"))
    table.set_value(("mill.tbl", b"T1 P1 D8.0 Z60\n", "text/plain"))
    app.run()
    assert not app.exception
    assert store(app).project.setup.tools
    assert not errors(app)
    setup = store(app).project.setup
    assert setup.source.name == "sided.nc"
    along = setup.toolpath.p[np.flatnonzero(setup.toolpath.cutting)]
    assert along[:, 1].max() == pytest.approx(4e-3), "beside the line by the radius of the tool"


def test_a_refused_program_is_shown_also_where_the_path_is_no_program(app: AppTest) -> None:
    bring(app, POINTS, "p.csv")
    bring(app, b"G2 X10 Y0\n", "bad.nc")
    assert any("bad.nc was not taken" in text for text in errors(app))
