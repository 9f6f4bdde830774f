"""Style sheets: what a selector, the cascade and a medium make of which lines are drawn, as CSS 2.1 has it."""

from __future__ import annotations

import time

import pytest

from robomill.errors import ToolpathError
from tests.io.drawing.made import svg

LINES = '<g class="a b" id="g"><line id="one" x2="5"/><g><line class="c" id="two" x2="7"/></g></g><line x2="9"/>'


@pytest.mark.parametrize(
    ("sheet", "drawn"),
    [
        ("g line {display:none}", [9]),
        ("g > g > line {display:none}", [5, 9]),
        (".a.b>line{display:none}", [7, 9]),
        ("svg > line{visibility:hidden}", [5, 7]),
        ("#g .c, g + line{visibility:collapse}", [5]),
        ("line ~ g line{display:none}", [5, 9]),
        ('[x2="9"]{display:none}', [5, 7]),
        ("line:not(.c):nth-child(1){display:none}", [7, 9]),
        ("*{visibility:hidden} #two{visibility:visible}", [7]),
        ("#one{display:inline} .a line{display:none}", [5, 9]),  # an id weighs more, wherever it stands
        (".a line{display:none} g line{display:inline}", [9]),  # a class weighs more than a name
        ("line{display:none} line{display:inline}", [5, 7, 9]),  # of two alike the later
        ("line{display:none !important} #one{display:inline}", []),
        ("g{visibility:hidden} .c{visibility:visible} .c{visibility:inherit}", [9]),
        ("@media print{line{display:none}}", [5, 7, 9]),
        ("@media screen , print{.c{display:none}}", [5, 9]),
        ("@import url(x.css); /* line{} */ .c{DISPLAY:NONE}", [5, 9]),
        ("line:hover{display:none} line::before{display:none} line!{display:none}", [5, 7, 9]),
        (".c{fill:url(a;display:none)}", [5, 7, 9]),
    ],
)
def test_a_rule_holds_for_what_its_selector_picks(sheet, drawn) -> None:
    file = svg(f"<style>{sheet.replace('>', '&gt;')}</style>{LINES}")
    read = file.read(file.scale("mm"))
    assert sorted(round(piece.points[1, 0] * 1e3) for piece in read.pieces) == drawn


@pytest.mark.parametrize(
    ("sheet", "line", "drawn"),
    [
        (".n{display:none}", '<line class="n" style="display:inline" x2="5"/>', 1),
        (".n{display:none!important}", '<line class="n" style="display:inline" x2="5"/>', 0),
        (".n{display:none!important}", '<line class="n" style="display:inline!important" x2="5"/>', 1),
        (".n{display:inline}", '<line class="n" display="none" x2="5"/>', 1),
        ("", """<line style="font-family:'a;display:none';fill:url(b;display:none)" x2="5"/>""", 1),
        ("", '<line style="fill:url(#b);Display : NONE ! Important" x2="5"/>', 0),
        ("", '<line style="/* display:inline; */display:none" x2="5"/>', 0),
        ("g .n{display:none}", '<g><line id="u" class="n" x2="5"/></g><use href="#u"/>', 0),
        (".n{transform:translate(3px,4px)}", '<line class="n" x2="5"/>', 1),
    ],
)
def test_sheet_own_style_and_attribute_hold_in_their_order(sheet, line, drawn) -> None:
    assert len(svg(f"<style>{sheet}</style>{line}").read(1e-3).pieces) == drawn


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("<style>" + ".a{display:inline}" * 20_000 + "</style>", "its styles are 360.000 characters long"),
        ("<style>g g g g g g line{display:none}</style>" + "<g>" * 100 + "</g>" * 100, "too often"),
        ("<style>a~a~a~a{display:none}</style>" + "<a/>" * 1_000, "too often"),
    ],
)
def test_sheets_that_would_take_long_are_refused(body, said) -> None:
    began = time.process_time()
    with pytest.raises(ToolpathError, match=said):
        svg(body)
    assert time.process_time() - began < 4.0


def test_a_font_in_a_sheet_is_nothing_to_read() -> None:
    font = "@font-face{src:url(data:font/woff;base64," + "A" * 1_000_000 + ")}"
    assert len(svg(f"<style>{font} .n{{display:none}}</style>{LINES}").read(1e-3).pieces) == 3


@pytest.mark.parametrize("style", ["((" * 1_000_000, "'(" * 1_000_000, "display:inline;" * 100])
def test_styles_of_many_elements_cost_no_time(style) -> None:
    began = time.process_time()
    assert len(
        svg(f'<line style="display:inline;{style}" x2="5"/>' * (1 if len(style) > 2000 else 600)).read(1e-3).pieces
    )
    assert time.process_time() - began < 4.0
