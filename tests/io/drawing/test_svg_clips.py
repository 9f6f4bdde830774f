"""Clipping paths: what they hide wholly is left out, what they hide in part is told, and the rest is as it was."""

from __future__ import annotations

import math

import pytest

from robomill.io.drawing.drawings import drawing_from_bytes
from tests.io.drawing.made import svg

LEFT = '<clipPath id="c"><rect width="50" height="80"/></clipPath>'
LINE = '<line x1="{}" y1="10" x2="{}" y2="10" {}/>'


def seen(body: str) -> tuple[int, int, int]:
    """Lines taken, of which so many are hidden in part, and lines left out."""
    read = svg(body).read(1e-3)
    return len(read.pieces), sum(read.partly.values()), read.unseen["clipped line"]


@pytest.mark.parametrize(
    ("body", "counts"),
    [
        (LEFT + LINE.format(10, 40, 'clip-path="url(#c)"'), (1, 0, 0)),
        (LEFT + LINE.format(10, 50, 'clip-path="url(#c)"'), (1, 0, 0)),  # to its very edge
        (LEFT + LINE.format(10, 60, 'clip-path="url(#c)"'), (1, 1, 0)),
        (LEFT + LINE.format(60, 70, "style=\"clip-path:url('#c')\"") + LINE.format(1, 2, ""), (1, 0, 1)),
        (LEFT + f'<g clip-path="url(#c)">{LINE.format(10, 40, "")}{LINE.format(60, 70, "")}</g>', (1, 0, 1)),
        # Its place is that of the element: moved with it, and by what is around it.
        (LEFT + LINE.format(10, 40, 'clip-path="url(#c)" transform="translate(60)"'), (1, 0, 0)),
        (LEFT + f'<g transform="scale(2)"><g clip-path="url(#c)">{LINE.format(10, 48, "")}</g></g>', (1, 0, 0)),
        (LEFT + f'<g clip-path="url(#c)"><g transform="translate(60)">{LINE.format(0, 9, "")}</g></g>', (0, 0, 1)),
        (
            '<clipPath id="c" transform="translate(60)"><rect width="50" height="80"/></clipPath>'
            + LINE.format(65, 70, 'clip-path="url(#c)"'),
            (1, 0, 0),
        ),
        # One in another: both hold.
        (
            LEFT + '<clipPath id="d"><rect x="20" width="80" height="80"/></clipPath>'
            f'<g clip-path="url(#d)">{LINE.format(25, 45, "clip-path=" + chr(34) + "url(#c)" + chr(34))}</g>',
            (1, 0, 0),
        ),
        (
            LEFT + '<clipPath id="d"><rect x="20" width="80" height="80"/></clipPath>'
            f'<g clip-path="url(#d)">{LINE.format(2, 15, "clip-path=" + chr(34) + "url(#c)" + chr(34))}</g>',
            (0, 0, 1),
        ),
        # What is clipped itself, or holds letters, is not followed.
        (
            LEFT
            + '<clipPath id="d"><rect width="9" height="80" clip-path="url(#c)"/></clipPath>'
            + LINE.format(1, 2, 'clip-path="url(#d)"'),
            (1, 1, 0),
        ),
        ('<clipPath id="c"><text>A</text></clipPath>' + LINE.format(1, 2, 'clip-path="url(#c)"'), (1, 1, 0)),
        # A clipping path that is empty hides all, one that is not there nothing is known of.
        ('<clipPath id="c"/>' + LINE.format(1, 2, 'clip-path="url(#c)"'), (0, 0, 1)),
        (LINE.format(1, 2, 'clip-path="url(#no)"'), (1, 1, 0)),
        (LINE.format(1, 2, 'clip-path="none" mask="none"'), (1, 0, 0)),
        (LINE.format(1, 2, 'mask="url(#m)"'), (1, 1, 0)),
        (LINE.format(1, 2, 'clip-path="circle(5px)"'), (1, 1, 0)),
        ("<style>.k line{clip-path:url(#c)}</style>" + LEFT + f'<g class="k">{LINE.format(60, 70, "")}</g>', (0, 0, 1)),
        (
            LEFT + f'<g id="w" clip-path="url(#c)">{LINE.format(10, 40, "")}</g>'
            '<use href="#w" transform="translate(60)"/>',
            (2, 0, 0),
        ),
        (
            '<clipPath id="c"><rect width="5" height="5" visibility="hidden"/></clipPath>'
            + LINE.format(1, 2, 'clip-path="url(#c)"'),
            (0, 0, 1),
        ),
        (
            '<rect id="r" width="50" height="80"/><clipPath id="c"><use href="#r"/></clipPath>'
            + LINE.format(60, 70, 'clip-path="url(#c)"'),
            (1, 0, 1),
        ),
    ],
)
def test_what_is_seen_of_a_line(body, counts) -> None:
    assert seen(body) == counts


RING = "M0 0H40V40H0Z M10 10{}Z"  # inner ring 20 x 20 px


@pytest.mark.parametrize(
    ("inner", "rule", "hole"),
    [("H30V30H10", "", False), ("V30H30V10", "", True), ("H30V30H10", 'clip-rule="evenodd"', True)],
)
def test_a_hole_is_one_by_the_rule_of_the_clipping_path(inner, rule, hole) -> None:
    body = f'<clipPath id="c"><path d="{RING.format(inner)}" {rule}/></clipPath><circle cx="20" cy="20" r="5" {{}}/>'
    assert seen(body.format('clip-path="url(#c)"')) == ((0, 0, 1) if hole else (1, 0, 0))


def test_circles_within_a_circle_are_whole_and_stay_circles() -> None:
    body = '<clipPath id="c"><circle cx="50" cy="40" r="30"/></clipPath><g clip-path="url(#c)">{}</g>'
    for x, partly in ((69.9, 0), (70.0, 0), (71.0, 1)):
        file = svg(body.format(f'<circle cx="{x}" cy="40" r="10"/><circle cx="50" cy="40" r="2"/>'))
        read = file.read(file.scale("mm"))
        assert [piece.shape for piece in read.pieces] == ["circle", "circle"]
        assert sum(read.partly.values()) == partly
        assert read.pieces[0].length == pytest.approx(math.tau * 0.01, rel=1e-3)


def test_what_is_hidden_in_part_is_told() -> None:
    page = f'<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80">{LEFT}'
    page += LINE.format(10, 60, 'clip-path="url(#c)"') + "</svg>"
    found = {finding.code: finding for finding in drawing_from_bytes(page.encode(), "p.svg").findings}
    assert found["drawing-clipped"].level == "warning"
