"""A program, from its file to the corrected one that is taken away; and every remedy read whole in any window."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from screenshots import idle

from robomill.toolpath.gcode import read_gcode

pytestmark = pytest.mark.browser

ROWS = "\n".join(f"G0 X10 Y{y}\nG1 Z-3 F300\nG1 X90 F1500\nG0 Z5" for y in (10, 22, 34))
PROGRAM = f"G21 G90 G17\nT1 M6\nS9000 M3\nG0 X0 Y0 Z10\nG0 Z5\n{ROWS}\nG0 Z20\nM30\n"
# What of a table stands beyond its edge, and whether the titles of cells stand over them.
BEYOND = """() => [...document.querySelectorAll('.rm-wide')].filter(each => each.scrollWidth > each.clientWidth + 1)
  .map(each => each.textContent.slice(0, 80))"""
TITLES = """() => [...document.querySelectorAll('.rm-titled tr:nth-child(2) td:not(:empty)')]
  .map(each => getComputedStyle(each, '::before').content)"""


def page_of(page: Any, name: str) -> None:
    page.get_by_test_id("stSidebarNavLink").filter(has_text=name).click()
    page.wait_for_selector(f".rm-kicker:has-text('{name}')")


def known(page: Any) -> None:
    """Every remedy is computed."""
    waits = "/is (being computed|computed next)/.test(document.body.innerText)"
    page.wait_for_function(f"() => document.querySelector('.rm-titled') && !{waits}", timeout=120_000)
    idle(page)


def test_from_the_dropped_program_to_the_corrected_one(page: Any, tmp_path: Path) -> None:
    idle(page)
    file = tmp_path / "PART.NC"
    file.write_text(PROGRAM)
    began = time.monotonic()
    page.locator(".st-key-doors input[type=file]").first.set_input_files(file)
    page.get_by_role("button", name="This is what it cuts").wait_for(timeout=30_000)
    idle(page)
    tolerance = page.get_by_label("Tolerance", exact=False).last
    tolerance.fill("0,25")
    tolerance.press("Enter")
    page.get_by_role("button", name="This is what it cuts").click()
    page.wait_for_selector(".rm-top:not(.open):not(.unjudged) .rm-said b", timeout=60_000)
    page_of(page, "Milling")
    page.get_by_role("link", name="What would fix it?").click(timeout=60_000)
    page.wait_for_selector(".rm-kicker:has-text('Improve')")
    remedy = page.get_by_role("radiogroup", name="Remedy").get_by_role("radio", name="Correct the program")
    remedy.wait_for(timeout=60_000)
    remedy.click()
    with page.expect_download() as found:
        page.get_by_role("button", name="Corrected program").click()
    took = time.monotonic() - began
    meant, corrected = (read_gcode(each) for each in (PROGRAM, Path(found.value.path()).read_text()))
    assert "0.25 mm" in page.locator(".rm-top").inner_text()
    lows = [path.p[path.cutting].min(axis=0) for path in (meant, corrected)]
    assert 0.02e-3 < np.abs(lows[1] - lows[0]).max() < 2e-3, "led against the push, by no more than it can be"
    print(f"from the dropped program to the corrected one: {took:.0f} s; 60 s are the aim on a quiet machine")


def test_every_remedy_is_read_whole_in_any_window(page: Any) -> None:
    page_of(page, "Improve")
    known(page)
    assert page.evaluate(BEYOND) == []
    assert set(page.evaluate(TITLES)) == {"none"}, "columns beside each other in a wide window"
    strong = page.locator(".rm-strong td").first
    assert int(strong.evaluate("each => getComputedStyle(each).fontWeight")) >= 600
    for width in (1024, 390):
        page.set_viewport_size({"width": width, "height": 900})
        page.wait_for_timeout(500)
        assert page.evaluate(BEYOND) == []
        titles = page.evaluate(TITLES)
        assert '"Error then"' in titles
        assert '"What it takes"' in titles or '"Verdict then"' in titles
    legend = page.locator("[class*=st-key-improve-corrected] .legendtext").all_text_contents()
    assert legend == [
        "across the feed, before",
        "along the axis, before",
        "across the feed, after",
        "along the axis, after",
    ]
