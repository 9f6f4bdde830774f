"""SVG: commands, transforms, page sizes, layers against formulas, and files that mean harm."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

from robomill.errors import ToolpathError
from robomill.io.drawing.svg import Svg
from tests.io.drawing.made import PAGE, SPACES, svg


def pieces(body: str, head: str = PAGE):
    file = svg(body, head)
    return file.read(file.scale(file.unit or "px")).pieces


@pytest.mark.parametrize(
    ("body", "shape", "length"),
    [
        ('<path d="M0 0 l30 40"/>', "line", 50.0),
        ('<path d="m10,10 h30 v40 H10 z"/>', "polyline", 140.0),
        ('<path d="M10 10 A 5 5 0 0 1 20 10"/>', "polyline", 5 * math.pi),
        ('<path d="M10 10 a 5 5 0 1 0 5 5"/>', "polyline", 7.5 * math.pi),
        ('<circle cx="20" cy="20" r="7"/>', "circle", 14 * math.pi),
        ('<path d="M10 10 a5 5 0 1 0 10 0 a5 5 0 1 0 -10 0 z"/>', "circle", 10 * math.pi),
        ('<rect x="5" y="5" width="30" height="10" rx="5"/>', "polyline", 40 + 10 * math.pi),
        ('<polyline points="0,0 10,0 10,10"/>', "polyline", 20.0),
        ('<polygon points="0,0 30,0 30,40"/>', "polyline", 120.0),
        ('<line x1="0" y1="0" x2="30" y2="40"/>', "line", 50.0),
        ('<g transform="translate(50 10) rotate(30) scale(2)"><line x2="10"/></g>', "line", 20.0),
        ('<g transform="matrix(0 2 -2 0 50 50)"><circle r="3"/></g>', "circle", 12 * math.pi),
        ('<line x2="30" transform="skewX(45)" y2="10"/>', "line", math.hypot(40, 10)),
    ],
)
def test_every_shape_has_its_length(body, shape, length) -> None:
    (piece,) = pieces(body)
    assert piece.shape == shape
    assert piece.length == pytest.approx(length * 1e-3, rel=2e-4)


@pytest.mark.parametrize(
    "d",
    [
        "M0 0 C 10 20 30 -20 40 0",
        "M0 0 Q 20 30 40 0",
        "M0 0 c 10 20 20 20 20 0 s 10 -20 20 0",
        "M0 0 q10 20 20 0 t20 0",
    ],
)
def test_bezier_curves_lie_on_their_polynomials(d) -> None:
    def bezier(*p):
        t = np.linspace(0.0, 1.0, 20_001)[:, None]
        n = len(p) - 1
        return sum(math.comb(n, i) * (1 - t) ** (n - i) * t**i * np.array(q) for i, q in enumerate(p))

    said = {
        "C": [((0, 0), (10, 20), (30, -20), (40, 0))],
        "Q": [((0, 0), (20, 30), (40, 0))],
        "c": [((0, 0), (10, 20), (20, 20), (20, 0)), ((20, 0), (20, -20), (30, -20), (40, 0))],
        "q": [((0, 0), (10, 20), (20, 0)), ((20, 0), (30, -20), (40, 0))],
    }[d[5]]
    curve = np.vstack([bezier(*p) for p in said]) * [1, -1] + [0, 80]
    (piece,) = pieces(f'<path d="{d}"/>')
    corners = piece.points * 1e3
    for points in (corners, 0.5 * (corners[1:] + corners[:-1])):
        assert max(np.hypot(*(curve - p).T).min() for p in points) < 3e-3  # mm: the sampling of the formula


def test_y_points_up_from_the_lower_edge_of_the_page() -> None:
    (piece,) = pieces('<line x1="10" y1="70" x2="20" y2="60"/>')
    np.testing.assert_allclose(piece.points * 1e3, [[10, 10], [20, 20]], atol=1e-9)


@pytest.mark.parametrize(
    ("head", "unit", "radius"),
    [
        (PAGE, "mm", 5.0),
        ('width="4in" height="3in" viewBox="0 0 400 300"', "in", 5 * 0.254),
        ('width="200mm" viewBox="0 0 100 80"', "mm", 10.0),
        ('width="10cm" height="8cm"', "cm", 5 * 25.4 / 96),
        ('width="96px" height="1in"', "in", 5 * 25.4 / 96),
        ('width="100mm" height="4in"', "mm", 5 * 25.4 / 96),
        ('width="96" height="2in" viewBox="0 0 96 192"', "in", 5 * 25.4 / 96),
        ('width="300" height="200"', "", 5 * 25.4 / 96),
        ('width="300px" height="200px" viewBox="0 0 30 20"', "", 50 * 25.4 / 96),
        ('width="100%" height="100%" viewBox="0 0 100 80"', "", 5 * 25.4 / 96),
        ('viewBox="0 0 100 80"', "", 5 * 25.4 / 96),
        ("", "", 5 * 25.4 / 96),
    ],
)
def test_the_page_says_the_unit_or_it_is_silent(head, unit, radius) -> None:
    assert svg('<circle r="5"/>', head).unit == unit
    (piece,) = pieces('<circle r="5"/>', head)
    assert np.linalg.norm(piece.points[1] - piece.points[0]) * 1e3 == pytest.approx(radius)


def test_layers_are_those_of_inkscape_else_the_groups_of_the_page() -> None:
    body = (
        '<g inkscape:groupmode="layer" inkscape:label="cut"><g id="x"><line x2="9"/></g>'
        '<g inkscape:groupmode="layer" inkscape:label="deep"><line x2="8"/></g></g>'
        '<g id="plain"><line x2="7"/></g><line x2="6"/>'
    )
    assert [piece.layer for piece in pieces(body)] == ["cut", "deep", "plain", "drawing"]


def test_what_is_not_drawn_is_not_cut_and_uses_are_placed() -> None:
    body = (
        '<defs><circle id="h" r="2"/></defs><use href="#h" x="10" y="20"/><use xlink:href="#h" transform="scale(2)"/>'
        '<symbol id="s"><circle r="1"/></symbol><clipPath id="c"><circle r="9"/></clipPath>'
        '<style>.off{display:none}</style><circle class="off" r="3"/><g style="display:none"><circle r="4"/></g>'
    )
    first, second = pieces(body)
    np.testing.assert_allclose(first.points * 1e3, [[10, 60], [12, 60]], atol=1e-9)
    np.testing.assert_allclose(second.points * 1e3, [[0, 80], [4, 80]], atol=1e-9)


def test_words_and_pictures_are_counted_and_nothing_outside_is_read() -> None:
    body = '<text>10</text><image href="/etc/hosts"/><use href="other.svg#a"/><line x2="1"/>'
    file = svg(body)
    assert file.read(1e-3).left_out == {"text": 1, "image": 1, "use of another file": 1}


NESTED = '<defs><g id="a0"><circle r="1"/></g>' + "".join(
    f'<g id="a{k}">' + f'<use href="#a{k - 1}"/>' * 10 + "</g>" for k in range(1, 12)
)


CHAIN = "".join(f'<use id="a{k}" href="#a{k + 1}"/>' for k in range(900)) + '<line id="a900" x2="1"/>'
TWICE = '<line id="z" x2="1"/>' + "".join(
    f'<g id="p{k}">' + f'<use href="#p{k + 1}" xlink:href="#z"/>' * 50 + "</g>" for k in range(3)
)
TWICE += '<line id="p3" x2="1"/>'
AROUND = f'<g transform="{"scale(1)" * 100}">' * 50 + '<line x2="1"/>' * 1_000 + "</g>" * 50


@pytest.mark.parametrize(
    ("body", "before", "said"),
    [
        ("<text>&a;</text>", '<!DOCTYPE svg [<!ENTITY a "x">]>', "declares entities"),
        (f'{NESTED}</defs><use href="#a11"/>', "", "more than 20.000 elements"),
        ('<g id="a"><use href="#a"/></g>', "", "an element uses itself"),
        ("<g>" * 300 + "</g>" * 300, "", "nested deeper than 200"),
        ('<path d="M0 0 ' + "L 10 10 L 5 6 " * 100_000 + '"/>', "", "more than 20.000 elements"),
        ('<path d="M0 0 L10"/>', "", "cannot be read"),
        ('<path d="M0 0 L 1e400 5"/>', "", "cannot be read"),
        ('<g transform="rotate(x)"><path d="M0 0 L 1 5"/></g>', "", "cannot be read"),
        ("<style>" + ".a{display:inline}" * 10_000 + "</style>" + '<line class="a"/>' * 2_000, "", "its styles are"),
        (
            '<g transform="' + "scale(1) " * 1_000 + '"/>',
            "",
            "the transform of an element has more than",
        ),
        ('<svg width="' + "1" * 100_000 + '!"/>', "", "the width of an element has more than"),
        (CHAIN, "", "others do deeper than can be followed"),
        ('<path d="M0 0' + "h1" * 490_000 + '"/>', "", "more than 20.000 elements"),
        ('<path d="M0 0' + "A1e6 1e6 0 1 1 1e6 1e6" * 9 + '"/>', "", "more than 100.000 points"),
        ('<circle r="1e9"/>', "", "goes farther than 10 km"),
        ("<a/>" * 110_000, "", "more than 20.000 elements"),
        (TWICE, "", "more than 20.000 elements"),
        (AROUND, "", "one in another, are too long"),
    ],
)
def test_harmful_and_broken_files_are_refused_in_a_sentence(body, before, said) -> None:
    with pytest.raises(ToolpathError, match=said):
        svg(body, before=before).read(1e-3)


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"G1 X0\n", "this is no SVG file"),
        (b"<html/>", "holds <html>, expected <svg>"),
        (b"\0\1", "a binary file"),
        (f"<svg {SPACES}>".encode(), "this is no SVG file"),
    ],
)
def test_what_is_no_svg_is_refused(data, said) -> None:
    with pytest.raises(ToolpathError, match=said):
        Svg(data, "x.svg")


@pytest.mark.parametrize(
    ("sheet", "drawn"),
    [
        ("x" * 400_000, 1),
        ("a{" * 200_000, 1),
        ("/*" * 200_000, 1),
        ("line{display:none}", 0),
        ("/* line{display:none} */ line{stroke:red}", 1),
        (".b, line , .c { stroke: red; display : none }", 0),
    ],
)
def test_a_style_sheet_hides_lines_and_costs_no_time(sheet, drawn) -> None:
    began = time.process_time()
    read = svg(f'<style>{sheet}</style><line x2="1"/><circle r="1"/>').read(1e-3)
    assert len(read.pieces) == 1 + drawn
    assert time.process_time() - began < 2.0


TEN = '<rect width="10" height="10"/>'
NESTED_SVG = '<svg x="10" y="20" width="50" height="50" {}>{}</svg>'
SYMBOL = '<symbol id="s" viewBox="0 0 10 10" {}>' + TEN + '</symbol><use href="#s" {}/>'


@pytest.mark.parametrize(
    ("body", "box"),  # mm, Y down from the upper edge of the page, as the file counts: x from, to, y from, to
    [
        (NESTED_SVG.format('viewBox="0 0 10 10"', TEN), (10, 60, 20, 70)),
        (NESTED_SVG.format("", TEN), (10, 20, 20, 30)),
        (NESTED_SVG.format('viewBox="5 5 10 10"', '<rect x="5" y="5" width="10" height="10"/>'), (10, 60, 20, 70)),
        (NESTED_SVG.format('viewBox="0 0 10 20"', TEN), (22.5, 47.5, 20, 45)),
        (NESTED_SVG.format('viewBox="0 0 10 20" preserveAspectRatio="xMaxYMin"', TEN), (35, 60, 20, 45)),
        (NESTED_SVG.format('viewBox="0 0 10 20" preserveAspectRatio="none"', TEN), (10, 60, 20, 45)),
        (NESTED_SVG.format('viewBox="0 0 10 20" preserveAspectRatio="xMidYMax slice"', TEN), (10, 60, -30, 20)),
        (NESTED_SVG.format('viewBox="0 0 10 10"', '<rect width="50%" height="20%"/>'), (10, 35, 20, 30)),
        (NESTED_SVG.format('viewBox="0 0 10 10"', '<rect style="width:50%;height:20%"/>'), (10, 35, 20, 30)),
        (
            NESTED_SVG.format("", '<svg x="50%" width="50%" height="10" viewBox="0 0 10 10">' + TEN + "</svg>"),
            (42.5, 52.5, 20, 30),
        ),
        (NESTED_SVG.format("", "") + '<rect width="50%" height="10%"/>', (0, 50, 0, 8)),
        ('<svg x="10%" y="50%" width="50%" height="50%">' + TEN + "</svg>", (10, 20, 40, 50)),
        (SYMBOL.format("", 'x="50" y="50" width="20" height="20"'), (50, 70, 50, 70)),
        (SYMBOL.format("", 'x="50" y="50" width="20" height="20" transform="scale(.5)"'), (25, 35, 25, 35)),
        (SYMBOL.format('style="display:none"', 'x="5" width="20" height="10"'), (10, 20, 0, 10)),
        (SYMBOL.format('width="30" height="30"', ""), (0, 30, 0, 30)),
        (SYMBOL.format("", ""), (10, 90, 0, 80)),
        (
            '<symbol id="o" viewBox="0 0 2 2"><use href="#i" x="1" width="50%" height="1"/></symbol><symbol id="i" '
            f'viewBox="0 0 10 10">{TEN}</symbol><use href="#o" x="10" y="20" width="40" height="40"/>',
            (30, 50, 20, 40),
        ),
        (
            f'<defs><svg id="n" x="1" width="5" height="5" viewBox="0 0 10 10">{TEN}</svg></defs>'
            '<use href="#n" x="10" width="20" height="20"/>',
            (11, 31, 0, 20),
        ),
        (f'<defs><g id="g">{TEN}</g></defs><use href="#g" x="7" width="99" height="99"/>', (7, 17, 0, 10)),
        ('<g x="50" y="50" rx="3" r="9"><circle cx="20" cy="20" r="5"/></g>', (15, 25, 15, 25)),
        ('<ellipse cx="50%" cy="40" rx="10"/>', (40, 60, 30, 50)),
        (f'<rect height="10"/><rect/><circle cx="5"/><path/><polyline/>{TEN}', (0, 10, 0, 10)),
    ],
)
def test_viewports_stand_where_browsers_show_them(body, box) -> None:
    (piece,) = pieces(body)
    points = piece.points * 1e3
    if piece.shape == "circle":
        points = points[0] + np.linalg.norm(points[1] - points[0]) * np.array([[-1, -1], [1, 1]])
    (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
    np.testing.assert_allclose([x0, x1, 80 - y1, 80 - y0], box, atol=1e-3)


def test_a_place_in_letters_is_refused() -> None:
    with pytest.raises(ToolpathError, match="found '2em' where a length should be"):
        pieces('<svg width="2em"><line x2="1"/></svg>')


@pytest.mark.parametrize(
    ("body", "lengths"),
    [
        ('<g visibility="hidden"><line x2="5"/><line visibility="visible" x2="6"/></g>', [6]),
        ('<g style="visibility:hidden"><g><line x2="5"/></g></g><line x2="7"/>', [7]),
        ('<style>.v{visibility:collapse}</style><line class="v" x2="5"/><line x2="8"/>', [8]),
        ('<g display="none"><line visibility="visible" x2="5"/></g><line x2="9"/>', [9]),
        ('<defs><line id="u" x2="5"/></defs><use href="#u" visibility="hidden"/><use href="#u"/>', [5]),
        ('<switch><line x2="3"/><line x2="4"/></switch>', [3]),
        (
            '<switch><line x2="3" systemLanguage="de, fr"/><g><line x2="4"/><line y2="2"/></g><line x2="9"/></switch>',
            [4, 2],
        ),
        ('<switch><foreignObject requiredExtensions="a"/><line id="w" x2="4"/></switch><use href="#w"/>', [4, 4]),
        ('<switch><line x2="4"/><line id="w" x2="3"/></switch><use href="#w" y="5"/>', [4, 3]),
    ],
)
def test_what_is_hidden_and_all_of_a_switch_but_what_it_shows_is_not_drawn(body, lengths) -> None:
    assert [piece.length * 1e3 for piece in pieces(body)] == pytest.approx(lengths)


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ('<path d="M0 0 L10 0 L bad 5"/>', "has 'b', which is no command"),
        ('<path d="M0 0 L9 0 X 5 5"/>', "has 'X', which is no command"),
        ('<path id="k" d="M0 0 L5"/>', "the path of k, .*found 'L5', where L takes 2 numbers"),
        ('<g transform="matrix(1 0)"><line x2="5"/></g>', r'transform="matrix\(1 0\)" cannot be read'),
    ],
)
def test_what_is_wrong_in_a_page_is_shown(body, said) -> None:
    with pytest.raises(ToolpathError, match=said):
        pieces(body)


def test_a_layer_that_is_not_displayed_is_told() -> None:
    file = svg('<g style="fill:none;display: none"><line x2="5"/></g><line display="none" x2="6"/><line x2="7"/>')
    read = file.read(file.scale("mm"))
    assert (len(read.pieces), read.unseen) == (1, {"g": 1, "line": 1})


@pytest.mark.parametrize(
    ("hidden", "unseen"),
    [
        ('<line style="display:none !important" x2="5"/>', 1),
        ('<line style="DISPLAY: none!important" x2="5"/>', 1),
        ('<line style="visibility:hidden !important" x2="5"/>', 1),
        ('<g visibility="hidden"><line visibility="inherit" x2="5"/></g>', 1),
        ('<line style="fill:red;display : none" x2="5"/>', 1),
        ('<line display="none" style="display:inline" x2="5"/>', 0),  # a style counts before an attribute
    ],
)
def test_what_is_said_to_be_left_out_is_left_out(hidden, unseen) -> None:
    file = svg(f'{hidden}<line x2="7"/>')
    read = file.read(file.scale("mm"))
    assert (len(read.pieces), sum(read.unseen.values())) == (2 - unseen, unseen)
