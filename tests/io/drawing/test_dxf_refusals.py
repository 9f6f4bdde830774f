"""DXF files that mean harm or are none: each is refused in a sentence and soon."""

from __future__ import annotations

import math
import time
from contextlib import nullcontext

import pytest

from robomill.errors import ToolpathError
from robomill.io.drawing import dxf
from robomill.io.drawing.drawings import drawing_from_bytes
from robomill.io.drawing.dxf import MOST_ENTITIES
from robomill.units import format_count
from tests.io.drawing.made import drawn


def bomb(doc, space) -> None:
    doc.blocks.new("B0").add_line((0, 0), (1, 0))
    for k in range(1, 12):
        block = doc.blocks.new(f"B{k}")
        for _ in range(10):
            block.add_blockref(f"B{k - 1}", (0, 0))
    space.add_blockref("B11", (0, 0))


MANY = {"row_count": 30_000, "column_count": 30_000, "row_spacing": 1, "column_spacing": 1}


def array(doc, space) -> None:
    doc.blocks.new("B").add_line((0, 0), (1, 0))
    space.add_blockref("B", (0, 0), dxfattribs=MANY)


def circle(doc, space) -> None:
    block = doc.blocks.new("B")
    block.add_blockref("B", (1, 1))
    space.add_blockref("B", (0, 0))


def tilted(doc, space) -> None:
    space.add_circle((0, 0), 1e12, dxfattribs={"extrusion": (1, 0, 0.1)})


def through(doc, space) -> None:
    space.add_spline([(k % 7, k % 5) for k in range(1_500)])


def endless(doc, space) -> None:
    space.add_ellipse((0, 0), (1e300, 0), 0.5)


def bent(doc, space) -> None:
    space.add_lwpolyline([(1e4 * (k % 7), 1e4 * (k % 5), 1) for k in range(4_000)], format="xyb")


def nowhere(doc, space) -> None:
    doc.blocks.new("B").add_line((0, 0), (1, 0))
    space.add_blockref("B", (0, 0), dxfattribs={"xscale": math.inf})


def far(doc, space) -> None:
    space.add_lwpolyline([(0, 0, 1e-3), (1e15, 0, 1e-3)], format="xyb")


@pytest.mark.parametrize(
    ("draw", "said"),
    [
        (tilted, "a radius of more than 10 km"),
        (through, "a spline through 1500 points"),
        (endless, "the ELLIPSE on layer 0 has a point that is no number, or far away"),
        (bent, "more than 100.000 points"),
        (nowhere, "the block B is inserted with a place, a turn or a scale that is none"),
        (far, "goes farther than 10 km"),
        (bomb, f"more than {format_count(MOST_ENTITIES)} entities"),
        (array, "a block is inserted 900.000.000 times"),
        (circle, "blocks are nested deeper than 16, or hold themselves"),
    ],
)
def test_bombs_are_refused_in_a_sentence_and_soon(draw, said) -> None:
    file = drawn(draw)
    began = time.monotonic()
    with pytest.raises(ToolpathError, match=said):
        file.read(1e-3)
    assert time.monotonic() - began < 20.0


def test_another_drawing_is_not_followed() -> None:
    def draw(doc, space):
        doc.add_xref_def("/etc/hosts", "X")
        space.add_blockref("X", (0, 0))
        space.add_line((0, 0), (1, 0))

    read = drawn(draw).read(1e-3)
    assert len(read.pieces) == 1
    assert "reference to another drawing, or to a block that is not there" in read.left_out


@pytest.mark.parametrize(
    "junk", [b"\0\1\2" * 100, b"AutoCAD Binary DXF\r\n\x1a\0" + b"\5" * 50, b"%PDF-1.4\n%\xe2\xe3"]
)
def test_what_is_no_dxf_is_refused(junk) -> None:
    with pytest.raises(ToolpathError, match=r"x\.dxf: (this is no DXF file|found no lines)"):
        drawing_from_bytes(junk, "x.dxf")


LINE = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{}\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n{}\n20\n0\n"
LINE += "11\n5\n21\n0\n0\nENDSEC\n0\nEOF\n"


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (LINE.format("1e400", "1"), "this is no DXF file"),
        (LINE.format("4", "1,5"), 'invalid floating point value "1,5"'),
        ("0\n0\n" * 300_000, "300.000 entities and other records, at most 200.000"),
        ("999\nx\n" * 1_100_000, "1.100.000 values, at most 1.000.000"),
    ],
)
def test_what_ezdxf_stumbles_over_or_would_mend_unasked_is_refused(data, said) -> None:
    with pytest.raises(ToolpathError, match=said):
        drawing_from_bytes(data.encode(), "x.dxf")


def test_as_many_entities_as_are_said_are_read(monkeypatch) -> None:
    monkeypatch.setattr(dxf, "MOST_ENTITIES", 300)
    for count, refused in ((300, False), (301, True)):
        file = drawn(lambda doc, space, count=count: [space.add_line((0, k), (1, k)) for k in range(count)])
        with pytest.raises(ToolpathError, match="more than 300 entities") if refused else nullcontext():
            assert len(file.read(1e-3).pieces) == count
