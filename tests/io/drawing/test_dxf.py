"""DXF: each kind of line against its formula, blocks, layers and units."""

from __future__ import annotations

import math

import ezdxf
import numpy as np
import pytest

from robomill.errors import UnitAskedError
from robomill.io.drawing.drawings import drawing_from_bytes
from robomill.io.drawing.dxf import Dxf
from tests.io.drawing.made import data, drawn

BULGE = math.tan(math.radians(90) / 4)


def only(draw):
    read = drawn(draw).read(1e-3)
    (piece,) = read.pieces
    return piece


SPLINE = [(0, 0, 0), (10, 20, 0), (30, -20, 0), (40, 0, 0)]


@pytest.mark.parametrize(
    ("draw", "shape", "length"),
    [
        (lambda d, m: m.add_line((0, 0), (30, 40)), "line", 50.0),
        (lambda d, m: m.add_circle((5, 5), 10), "circle", 20 * math.pi),
        (lambda d, m: m.add_arc((0, 0), 10, 350, 80), "arc", 10 * math.pi / 2),
        (lambda d, m: m.add_arc((0, 0), 10, 20, 380), "circle", 20 * math.pi),
        (lambda d, m: m.add_lwpolyline([(0, 0), (30, 0), (30, 40)]), "polyline", 70.0),
        (lambda d, m: m.add_lwpolyline([(0, 0), (30, 0), (30, 40)], close=True), "polyline", 120.0),
        (lambda d, m: m.add_lwpolyline([(0, 0, 1), (20, 0, 0)], format="xyb"), "polyline", 10 * math.pi),
        (lambda d, m: m.add_polyline2d([(0, 0, BULGE), (10, 10, 0)], format="xyb"), "polyline", 5 * math.pi),
        (lambda d, m: m.add_polyline3d([(0, 0, 5), (30, 0, 5), (30, 40, 9)]), "polyline", 70.0),
    ],
)
def test_lines_arcs_and_polylines_have_their_length(draw, shape, length) -> None:
    piece = only(draw)
    assert piece.shape == shape
    assert piece.length == pytest.approx(length * 1e-3, rel=2e-4)


def test_a_bulge_is_to_the_right_where_it_is_positive() -> None:
    piece = only(lambda d, m: m.add_lwpolyline([(0, 0, 1), (20, 0, 0)], format="xyb"))
    assert piece.points[:, 1].min() == pytest.approx(-0.01, abs=1e-9)
    assert piece.points[:, 1].max() == pytest.approx(0.0, abs=1e-9)


def test_an_ellipse_has_the_length_of_its_integral() -> None:
    t = np.linspace(0.0, 2.0 * math.pi, 200_001)
    length = np.hypot(np.diff(20 * np.cos(t)), np.diff(10 * np.sin(t))).sum()
    piece = only(lambda d, m: m.add_ellipse((0, 0), (20, 0), 0.5))
    assert piece.length == pytest.approx(length * 1e-3, rel=1e-4)


def test_a_spline_is_the_bezier_curve_that_its_control_points_say() -> None:
    piece = only(lambda d, m: m.add_open_spline(SPLINE, degree=3))
    t = np.linspace(0.0, 1.0, 20_001)[:, None]
    p = [np.array(point[:2]) for point in SPLINE]
    curve = (1 - t) ** 3 * p[0] + 3 * t * (1 - t) ** 2 * p[1] + 3 * t**2 * (1 - t) * p[2] + t**3 * p[3]
    away = [np.hypot(*(curve - corner * 1e3).T).min() for corner in piece.points]
    assert max(away) < 5e-3  # mm: the sampling of the formula
    assert piece.length == pytest.approx(np.hypot(*np.diff(curve, axis=0).T).sum() * 1e-3, rel=1e-4)


@pytest.mark.parametrize("weights", [None, [1, 2, 3, 1.5, 1, 2, 3]])
def test_a_closed_spline_is_drawn_between_the_knots_where_it_is_defined_alone(weights) -> None:
    """Cubic over even knots, as a closed curve of control points: each piece by the matrix of the uniform spline."""
    around = [(0, 0, 0), (20, 0, 0), (20, 10, 0), (0, 10, 0)]
    control = [*around, *around[:3]]

    def draw(doc, space):
        spline = space.add_spline()
        spline.set_closed(around, degree=3)
        if weights:
            spline.weights = weights

    t, w = np.linspace(0.0, 1.0, 5_001)[:, None], weights or [1.0] * 7
    shares = [(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3]
    pieces = []
    for k in range(4):
        below = sum(share * w[k + i] for i, share in enumerate(shares))
        pieces.append(sum(share * w[k + i] * np.array(control[k + i][:2]) for i, share in enumerate(shares)) / below)
    curve = np.vstack(pieces)
    piece = only(draw)
    assert max(np.hypot(*(curve - corner * 1e3).T).min() for corner in piece.outline()) < 5e-3
    assert piece.length == pytest.approx(np.hypot(*np.diff(curve, axis=0).T).sum() * 1e-3, rel=1e-4)
    if weights is None:
        np.testing.assert_allclose(piece.outline()[0], piece.outline()[-1], atol=1e-12)


def test_blocks_are_opened_turned_mirrored_and_scaled_on_the_layer_of_their_insert() -> None:
    def draw(doc, space):
        block = doc.blocks.new("B")
        block.add_line((0, 0), (10, 0))
        block.add_line((0, 0), (0, 5), dxfattribs={"layer": "own"})
        space.add_blockref("B", (100, 0), dxfattribs={"layer": "there", "rotation": 90, "xscale": -2, "yscale": 1})

    first, second = drawn(draw).read(1e-3).pieces
    assert (first.layer, second.layer) == ("there", "own")
    np.testing.assert_allclose(first.points * 1e3, [[100, 0], [100, -20]], atol=1e-9)
    np.testing.assert_allclose(second.points * 1e3, [[100, 0], [95, 0]], atol=1e-9)


def test_a_circle_seen_from_behind_is_mirrored_and_one_scaled_unevenly_is_an_ellipse() -> None:
    mirrored = only(lambda d, m: m.add_circle((10, 0), 5, dxfattribs={"extrusion": (0, 0, -1)}))
    np.testing.assert_allclose(mirrored.points[0] * 1e3, [-10, 0])

    def draw(doc, space):
        doc.blocks.new("B").add_circle((0, 0), 5)
        space.add_blockref("B", (0, 0), dxfattribs={"xscale": 2})

    ellipse = only(draw)
    np.testing.assert_allclose(np.ptp(ellipse.points, axis=0) * 1e3, [20, 10], atol=1e-2)


def test_the_frame_that_a_curve_was_fitted_to_is_not_drawn() -> None:
    """A parabola y = x (20 - x) / 20, 5 mm high; the corner of its frame is at twice that height."""

    def fitted(spline: bool):
        def draw(doc, space):
            line = space.add_polyline2d([(0, 0), (10, 10), (20, 0)], format="xy")
            line.dxf.flags = 4 if spline else 2
            for vertex in line.vertices:
                vertex.dxf.flags = 16 if spline else 0
            for x in np.linspace(0.0, 20.0, 101):
                line.append_vertex((x, x * (20.0 - x) / 20.0))
                line.vertices[-1].dxf.flags = 8 if spline else 1
            if not spline:
                del line.vertices[:3]

        return draw

    x = np.linspace(0.0, 20.0, 100_001)
    length = float(np.hypot(np.diff(x), np.diff(x * (20.0 - x) / 20.0)).sum())
    for spline in (True, False):
        piece = only(fitted(spline))
        assert piece.points[:, 1].max() == pytest.approx(5e-3)
        assert piece.length == pytest.approx(length * 1e-3, rel=1e-4)


@pytest.mark.parametrize(
    ("outer", "inner", "ends"),
    [
        ({"xscale": 2}, {"rotation": 90}, [20 + 5j, 20 + 6j]),
        ({"xscale": 2, "yscale": 2}, {"rotation": 90}, [20 + 10j, 20 + 12j]),
        ({"xscale": -1, "rotation": 90}, {"rotation": 90}, [-5 - 10j, -6 - 10j]),
        ({"xscale": 2}, {"rotation": 90, "extrusion": (0, 0, -1)}, [-20 + 5j, -20 + 6j]),
        ({"yscale": 3, "rotation": 180}, {"rotation": -90}, [-10 + 15j, -10 + 18j]),
    ],
)
def test_a_turned_block_in_a_block_of_unequal_scales_is_where_both_put_it(outer, inner, ends) -> None:
    """Worked out by hand: the inner insert takes 5..6 along X to (10, 5..6); the outer one scales, then turns."""

    def draw(doc, space):
        doc.blocks.new("A", base_point=(2, 3)).add_line((7, 3), (8, 3))
        doc.blocks.new("B").add_blockref("A", (10, 0), dxfattribs=inner)
        space.add_blockref("B", (0, 0), dxfattribs=outer)

    found = only(draw).points * 1e3
    np.testing.assert_allclose(found, [[z.real, z.imag] for z in ends], atol=1e-9)


@pytest.mark.parametrize("angle", [30.0, 45.0, 200.0])
def test_arcs_of_a_sheared_block_lie_on_the_curve_that_their_formula_goes_through(angle) -> None:
    """Half a circle of 5 mm, an ellipse, and a bulge: turned by the inner insert, then 3 times as wide by the outer."""

    def draw(doc, space):
        block = doc.blocks.new("A")
        block.add_arc((1, 2), 5, 0, 180)
        block.add_lwpolyline([(6, 2, 1), (-4, 2, 0)], format="xyb")
        block.add_ellipse((1, 2), (5, 0), 0.999999)
        doc.blocks.new("B").add_blockref("A", (10, 0), dxfattribs={"rotation": angle})
        space.add_blockref("B", (0, 0), dxfattribs={"xscale": 3})

    turn = np.exp(1j * math.radians(angle))
    for piece, upward in zip(drawn(draw).read(1e-3).pieces, (True, True, None), strict=True):
        x, y = piece.outline().T * 1e3
        own = (x / 3.0 + 1j * y - 10.0) / turn - (1 + 2j)
        np.testing.assert_allclose(np.abs(own), 5.0, atol=1e-3)
        if upward is not None:
            assert (own.imag > -1e-6).all()
        between = 0.5 * (own[1:] + own[:-1])
        assert np.abs(between).min() > 5.0 - 2e-3


def test_circles_stay_circles_where_two_uneven_scales_make_an_even_one() -> None:
    def draw(doc, space):
        block = doc.blocks.new("A")
        block.add_circle((1, 0), 5)
        block.add_arc((0, 0), 4, 0, 90)
        doc.blocks.new("B").add_blockref("A", (0, 10), dxfattribs={"yscale": 2, "rotation": 90})
        space.add_blockref("B", (0, 0), dxfattribs={"yscale": 2})

    ring, arc = drawn(draw).read(1e-3).pieces
    assert (ring.shape, arc.shape) == ("circle", "arc")
    np.testing.assert_allclose(ring.points[0] * 1e3, [0, 22], atol=1e-9)
    assert np.linalg.norm(ring.points[1] - ring.points[0]) * 1e3 == pytest.approx(10.0)
    np.testing.assert_allclose(arc.points[[0, 2]] * 1e3, [[0, 28], [-8, 20]], atol=1e-9)


def test_a_block_whose_insert_leans_is_seen_from_above() -> None:
    """Its normal along X: its own X is along the drawing's Y, its own Y along Z, which is not seen."""

    def draw(doc, space):
        block = doc.blocks.new("A")
        block.add_line((0, 0), (10, 4))
        block.add_line((3, 0, 0), (3, 0, 7))
        space.add_blockref("A", (0, 0), dxfattribs={"extrusion": (1, 0, 0)})

    first, second = drawn(draw).read(1e-3).pieces
    np.testing.assert_allclose(first.points * 1e3, [[0, 0], [0, 10]], atol=1e-9)
    np.testing.assert_allclose(second.points * 1e3, [[0, 3], [7, 3]], atol=1e-9)


def test_an_array_of_a_block_is_all_of_it() -> None:
    def draw(doc, space):
        doc.blocks.new("B").add_circle((0, 0), 1)
        grid = {"row_count": 2, "column_count": 3, "row_spacing": 10, "column_spacing": 20}
        space.add_blockref("B", (0, 0), dxfattribs=grid)

    centres = sorted(tuple(np.round(each.points[0] * 1e3, 9)) for each in drawn(draw).read(1e-3).pieces)
    assert centres == [(x, y) for x in (0, 20, 40) for y in (0, 10)]


@pytest.mark.parametrize(("code", "unit"), [(0, ""), (1, "in"), (4, "mm"), (6, "m"), (10, "yd")])
def test_the_unit_is_that_of_insunits(code, unit) -> None:
    assert drawn(lambda d, m: m.add_line((0, 0), (1, 0)), code).unit == unit


def test_what_is_no_line_is_counted_by_its_name_and_hidden_layers_are_named() -> None:
    def draw(doc, space):
        doc.layers.add("off").off()
        space.add_line((0, 0), (1, 0), dxfattribs={"layer": "off"})
        space.add_text("10 mm")
        space.add_point((0, 0))

    read = drawn(draw).read(1e-3)
    assert read.left_out == {"TEXT": 1, "POINT": 1}
    assert read.hidden == {"off"}


@pytest.mark.parametrize(
    ("code", "length"),
    [(3, 1_609_344.0), (7, 1e6), (10, 914.4), (12, 1e-6), (14, 100.0), (15, 1e4), (21, 304.8006096), (22, 25.4000508)],
)
def test_units_that_few_draw_in_are_read_as_long_as_they_are(code, length) -> None:
    """Yard and mile as of 1959; the US survey foot is 1200/3937 m, printed here to ten digits."""
    file = drawn(lambda d, m: m.add_line((0, 0), (1e-3, 0)), code)
    (piece,) = file.read(file.scale(file.unit)).pieces
    assert piece.points[1, 0] == pytest.approx(length * 1e-6, rel=1e-9)


@pytest.mark.parametrize("code", [17, 20, 99])
def test_a_unit_that_no_part_is_drawn_in_is_asked_about_by_its_number(code) -> None:
    doc = ezdxf.new("R2000")
    doc.header["$INSUNITS"] = code
    doc.modelspace().add_line((0, 0), (5, 0))
    with pytest.raises(UnitAskedError, match=rf"says by \$INSUNITS {code} that it is drawn in"):
        drawing_from_bytes(data(doc), "a.dxf")
    assert drawing_from_bytes(data(doc), "a.dxf", "mm").extents[1][0] == pytest.approx(5e-3)


@pytest.mark.parametrize("head", ["", "0\nSECTION\n2\nHEADER\n0\nENDSEC\n"])
def test_a_file_without_a_header_does_not_say_its_unit(head) -> None:
    """As small programs write it, with ENTITIES alone; the unit that ezdxf supposes then (metres) is nobody's."""
    line = "0\nLINE\n8\n0\n10\n0\n20\n0\n11\n5\n21\n0\n"
    text = f"{head}0\nSECTION\n2\nENTITIES\n{line}0\nENDSEC\n0\nEOF\n".encode()
    with pytest.raises(UnitAskedError, match="the drawing does not say its unit"):
        drawing_from_bytes(text, "a.dxf")
    assert drawing_from_bytes(text, "a.dxf", "mm").extents[1][0] == pytest.approx(5e-3)


def test_what_is_off_frozen_or_invisible_is_told_and_part_zero_is_that_of_what_is_seen() -> None:
    """What a block on a frozen layer holds is on that layer, whatever its own says: it hides all of it."""
    doc = ezdxf.new("R2000", units=4)
    doc.layers.add("OFF").off()
    doc.layers.add("FRZ").freeze()
    block, space = doc.blocks.new("B"), doc.modelspace()
    block.add_line((0, 0), (1, 0), dxfattribs={"layer": "PART"})
    space.add_blockref("B", (-50, 0), dxfattribs={"layer": "FRZ"})
    space.add_blockref("B", (0, -50), dxfattribs={"layer": "OFF"})
    space.add_line((-90, 0), (0, 0), dxfattribs={"layer": "OFF"})
    space.add_line((2, 3), (4, 9), dxfattribs={"layer": "PART"})
    space.add_line((0, 0), (-1, 0), dxfattribs={"layer": "PART", "invisible": 1})
    space.add_blockref("B", (-7, 0), dxfattribs={"invisible": 1})
    drawing = drawing_from_bytes(data(doc), "a.dxf")
    counts = {layer: len(drawing.of_layer(layer)) for layer in drawing.layers}
    assert counts == {"FRZ": 1, "PART": 2, "OFF": 1}
    assert drawing.hidden == {"FRZ", "OFF"}
    np.testing.assert_allclose(np.array(drawing.extents) * 1e3, [[0, -50], [4, 9]], atol=1e-9)
    told = {each.code: each.sentence for each in drawing.findings}
    assert "1 × INSERT, 1 × LINE" in told["drawing-unseen"]
    assert "FRZ and OFF" in told["drawing-hidden"]


def test_an_entity_that_nobody_knows_is_counted_by_its_name() -> None:
    data = "0\nSECTION\n2\nENTITIES\n0\nLWPO[]LYLINE\n5\nA1\n8\nL\n10\n1\n20\n1\n"
    data += "0\nLINE\n8\n0\n10\n0\n20\n0\n11\n5\n21\n0\n"
    read = Dxf(f"{data}0\nENDSEC\n0\nEOF\n".encode(), "x.dxf").read(1e-3)
    assert (len(read.pieces), dict(read.left_out)) == (1, {"LWPO[]LYLINE": 1})
