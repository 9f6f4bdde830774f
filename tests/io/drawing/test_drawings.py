"""Drawings from files: the same part as DXF and as SVG, units, refusals."""

from __future__ import annotations

import io
import math

import ezdxf
import numpy as np
import pytest

import robomill as rm
from robomill.errors import ToolpathError, UnitAskedError
from robomill.io.drawing.drawings import drawing_from_bytes
from robomill.io.samples import samples_dir

FOLDER = samples_dir() / "drawings"
SLOT = 2 * 40 + 2 * math.pi * 5  # mm, two straight sides and two half circles
LENGTHS = {
    "outline": 2 * (100 + 60) + 2 * math.pi * 10,
    "slots": 2 * SLOT,
    "holes": 2 * 2 * math.pi * 6,
}


@pytest.mark.parametrize("name", ["bracket", "bracket.svg"])
def test_the_bracket_has_the_lengths_of_its_figure(name) -> None:
    drawing = rm.read_drawing(name)
    assert drawing.layers == tuple(LENGTHS)
    assert all(contour.closed for contour in drawing.contours)
    np.testing.assert_allclose(np.array(drawing.extents) * 1e3, [[0, 0], [120, 80]], atol=2e-3)
    for layer, length in LENGTHS.items():
        assert sum(each.length for each in drawing.of_layer(layer)) == pytest.approx(length * 1e-3, rel=1e-4)


@pytest.mark.parametrize("name", ["bracket", "bracket.svg"])
@pytest.mark.parametrize(("side", "radius"), [("inside", 1.0), ("outside", 9.0), ("on", 5.0)])
def test_a_slot_cut_beside_its_line_is_a_slot_of_another_width(name, side, radius) -> None:
    """Each pass of a slot 10 mm wide with a cutter of 8 mm: two straight sides and a full circle of 5 -+ 4 mm."""
    cut = rm.LayerCut("slots", depth_mm=3, feed_mm_min=600, side=side, step_down_mm=1)
    path = rm.read_drawing(name).sketch([cut], diameter_mm=8).toolpath()
    level = path.cutting & (np.abs(np.diff(path.p[:, 2], prepend=path.p[0, 2])) < 1e-12)
    each = 2 * 40 + 2 * math.pi * radius
    assert path.step_length[level].sum() == pytest.approx(2 * 3 * each * 1e-3, rel=2e-4)


def dxf(units: int = 0) -> bytes:
    doc = ezdxf.new("R2000")
    doc.units = units
    doc.modelspace().add_line((0, 0), (100, 0))
    out = io.StringIO()
    doc.write(out)
    return out.getvalue().encode()


def test_a_silent_file_is_asked_for_its_unit_with_the_sizes_that_it_would_have() -> None:
    with pytest.raises(UnitAskedError) as asked:
        drawing_from_bytes(dxf(), "a.dxf")
    assert "100.0 × 0.0 mm in mm, 2540.0 × 0.0 mm in in" in str(asked.value)
    assert drawing_from_bytes(dxf(), "a.dxf", "in").extents[1][0] == pytest.approx(2.54)


def test_what_somebody_says_goes_before_what_a_dxf_says_and_is_noted() -> None:
    drawing = drawing_from_bytes(dxf(1), "a.dxf", "mm")
    assert drawing.extents[1][0] == pytest.approx(0.1)
    assert "the file says that it is drawn in in; it was read in mm" in drawing.findings[0].sentence


def test_a_drawing_of_doubtful_size_is_questioned() -> None:
    assert any(each.code == "drawing-unit" for each in drawing_from_bytes(dxf(6), "a.dxf").findings)


@pytest.mark.parametrize(
    ("data", "name", "unit", "said"),
    [
        (b"x", "a.pdf", "", "expected a drawing that ends in .dxf or .svg"),
        (b"  ", "a.dxf", "", "the file is empty"),
        (b"<svg/>", "a.svg", "furlong", "the unit is 'furlong'"),
        (b"<svg><text>a</text></svg>", "a.svg", "mm", "found no lines .only 1 × text."),
        (b'<svg width="9mm" height="9mm"><line x2="1"/></svg>', "a.svg", "in", "the page says its size in mm"),
    ],
)
def test_refusals(data, name, unit, said) -> None:
    with pytest.raises(ToolpathError, match=said):
        drawing_from_bytes(data.replace(b"<svg", b'<svg xmlns="http://www.w3.org/2000/svg"'), name, unit)


def test_the_files_are_what_their_script_draws(monkeypatch) -> None:
    import importlib.util

    spec = importlib.util.spec_from_file_location("bracket", FOLDER / "generate.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    assert script.svg() == (FOLDER / "bracket.svg").read_text()
    again = drawing_from_bytes(script.dxf().encode(), "bracket.dxf")
    for one, other in zip(again.contours, rm.read_drawing("bracket").contours, strict=True):
        np.testing.assert_allclose(one.points, other.points, atol=1e-12)


def test_a_circle_without_a_radius_is_a_point_and_left_out() -> None:
    page = '<svg xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm" viewBox="0 0 9 9">'
    drawing = drawing_from_bytes(f'{page}<circle r="1e-300"/><line x2="5"/></svg>'.encode(), "a.svg")
    assert [contour.shape for contour in drawing.contours] == ["line"]


def test_a_drawing_of_points_alone_has_no_lines() -> None:
    page = '<svg xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm" viewBox="0 0 9 1e400">'
    with pytest.raises(ToolpathError, match=r"a\.svg: found no lines"):
        drawing_from_bytes(f'{page}<circle r="3"/><line x2="5"/></svg>'.encode(), "a.svg")


@pytest.mark.parametrize(
    ("name", "meant"), [("nope", "are bracket, bracket.svg."), ("brackett", "did you mean 'bracket'?")]
)
def test_a_name_that_is_no_drawing_is_told_with_those_that_there_are(name: str, meant: str) -> None:
    with pytest.raises(ToolpathError, match="no drawing of this name") as caught:
        rm.read_drawing(name)
    assert str(caught.value).endswith(meant)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ('<line x2="5"/>', "1 line drawn twice left out"),
        ('<line y2="0"/>', "1 line without length left out"),
        ('<line y2="0"/><line x2="5"/>', "1 line drawn twice and 1 line without length left out"),
    ],
)
def test_only_what_was_left_out_is_counted(more: str, said: str) -> None:
    page = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm" viewBox="0 0 9 9"><line x2="5"/>{more}</svg>'
    )
    (finding,) = (each for each in drawing_from_bytes(page.encode(), "a.svg").findings if each.code == "drawing-twice")
    assert finding.sentence.rstrip(".") == said
