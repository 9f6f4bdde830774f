"""A drawing, from its file to the groove that is left: dropped, cut along, asked what it cuts, simulated."""

from __future__ import annotations

import math
from typing import Any

import pytest
from screenshots import idle

from robomill.io.samples import samples_dir

pytestmark = pytest.mark.browser

BRACKET = samples_dir() / "drawings"
# By hand, in mm: a plate of 120 x 80 with corners of 10, two slots of 50 x 10, two holes of 12.
LINES = 2 * (100 + 60) + 2 * math.pi * 10 + 2 * (2 * 40 + 2 * math.pi * 5) + 2 * 2 * math.pi * 6
PLUNGES = 5 * (2 + 0.5)  # five lines, each from 0.5 mm above the face to 2 mm below it


@pytest.mark.parametrize("name", ["bracket.dxf", "bracket.svg"])
def test_a_bracket_with_slots_from_its_file_to_its_grooves(page: Any, name: str) -> None:
    page.get_by_test_id("stSidebarNavLink").filter(has_text="Toolpath").click()
    page.wait_for_selector(".rm-kicker:has-text('Toolpath')")
    idle(page)
    page.locator('input[type="file"]').first.set_input_files(BRACKET / name)
    page.get_by_text("5 lines within 120.0 × 80.0 mm, drawn in mm.").wait_for(timeout=30_000)
    page.locator("[class*=toolpath-drawing] img").wait_for(timeout=20_000)
    page.get_by_role("button", name="Cut along it").click()
    page.wait_for_selector(".rm-lead:has-text('5 shapes, 120.0 × 80.0')", timeout=30_000)
    idle(page)
    page.get_by_text(f"{LINES + PLUNGES:.1f} mm at feed").wait_for(timeout=30_000)

    page.get_by_role("button", name="This is what it cuts").click()
    idle(page)
    page.get_by_test_id("stSidebarNavLink").filter(has_text="Milling").click()
    page.wait_for_selector(".rm-kicker:has-text('Milling')")
    tile = page.locator(".rm-tile", has_text="Wall error").locator(".rm-value")
    tile.wait_for(timeout=90_000)
    assert "mm" in tile.inner_text(), page.locator(".rm-title, .rm-lead, .rm-tile").all_inner_texts()
