"""Numbers typed as a browser's own language has them: read right in cells and boxes, and shown on the page."""

from __future__ import annotations

import re
from typing import Any

import pytest
from screenshots import idle, until

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module", params=["en-US", "de-DE", "fr-FR"])
def language(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def page(page: Any, language: str) -> Any:
    """A page of a browser in another language."""
    page.set_default_timeout(60_000)
    assert page.evaluate("navigator.language") == language
    idle(page)
    return page


def open_page(page: Any, name: str) -> None:
    page.get_by_test_id("stSidebarNavLink").filter(has_text=name).click()
    page.wait_for_selector(f".rm-kicker:has-text('{name}')")
    idle(page)


def grid_of(page: Any) -> Any:
    """The table that is seen: the others stand in tabs that are closed."""
    found = page.locator("[data-testid=stDataFrame]:visible").first
    found.locator("canvas").first.wait_for()
    return found


def cell(page: Any, row: int, column: int) -> str:
    """What a cell shows; rows and columns are counted from 0."""
    name = f"canvas [role=row][aria-rowindex='{row + 2}'] [role=gridcell][aria-colindex='{column + 1}']"
    return str(grid_of(page).locator(name).text_content())


def sees(page: Any, row: int, column: int, text: str) -> None:
    """Wait until a cell shows a text: the table is drawn anew a moment after the page has said what it read."""
    until(page, lambda: cell(page, row, column), text)


def type_into_cell(page: Any, place: tuple[int, int], share: float, text: str, sign: str) -> None:
    """Type into a cell, ``share`` of the table's width from its left, until the page shows ``sign``.

    The table is a canvas, so a cell is found by its place, and a click that comes before it listens is lost.
    """
    row, _ = place
    for _ in range(4):
        table = grid_of(page)
        page.wait_for_timeout(700)
        box = table.bounding_box()
        for _ in range(6):
            page.mouse.click(box["x"] + share * box["width"], box["y"] + 35 * (row + 1.5))
            page.wait_for_timeout(250)
            page.keyboard.press("Enter")
            page.wait_for_timeout(400)
            if page.locator("#portal textarea, #portal input").count():
                break
        page.keyboard.press("Control+A")
        page.keyboard.type(text, delay=30)
        page.wait_for_timeout(300)  # the cell's editor takes a value over a moment after it was typed
        page.keyboard.press("Enter")
        try:
            page.get_by_text(sign).first.wait_for(timeout=6000)
        except Exception:
            page.keyboard.press("Escape")
        else:
            return
    page.get_by_text(sign).first.wait_for(timeout=1000)


def type_into_box(page: Any, label: str, text: str) -> Any:
    """Type into a number box; the box."""
    box = page.locator(f"input[type=text][aria-label='{label}']:visible").first
    box.fill(text)
    box.press("Enter")
    return box


def shows(page: Any, box: Any, text: str) -> None:
    """Wait until a box shows a text."""
    until(page, box.input_value, text)


def test_the_d_h_table_the_limits_and_the_tool(page: Any) -> None:
    open_page(page, "Robot")
    page.get_by_role("tab", name="D-H table").click()
    type_into_cell(page, (1, 2), 0.4, "1220,5", "Joint 2, a: 1220,5 is 1220.5 mm.")
    type_into_cell(page, (2, 2), 0.4, "1/16 in", "Joint 3, a: 1/16 in is 1.5875 mm.")
    sees(page, 1, 2, "1220.5")
    sees(page, 2, 2, "1.5875")
    type_into_cell(page, (2, 2), 0.4, "1,220", "which is 1.220 to some and 1220 to others")
    sees(page, 2, 2, "1.5875")
    page.get_by_role("tab", name="Limits").click()
    type_into_cell(page, (0, 2), 0.85, "150,5", "Joint 1, upper: 150,5 is 150.5 °.")
    page.get_by_role("tab", name="Tool").click()
    shows(page, type_into_box(page, "Tip z, mm", "12,5"), "12.50")
    open_page(page, "Milling")
    open_page(page, "Robot")
    page.get_by_role("tab", name="D-H table").click()
    sees(page, 1, 2, "1220.5")
    page.get_by_role("tab", name="Limits").click()
    sees(page, 0, 2, "150.5")


def test_part_zero_and_the_table_of_lines(page: Any) -> None:
    open_page(page, "Toolpath")
    box = type_into_box(page, "Zero Y, mm", "-1300,5")
    shows(page, box, "-1300.50")
    type_into_box(page, "Zero Y, mm", "1,220")
    page.get_by_text("which is 1.220 to some and 1220 to others").wait_for()
    page.get_by_text(re.compile("It stays [-−]1300.50 mm")).wait_for()
    shows(page, type_into_box(page, "Zero Y, mm", "-1300"), "-1300.00")
    page.get_by_text("Table of lines", exact=True).first.click()
    grid_of(page)
    idle(page)
    type_into_cell(page, (0, 3), 0.5, "12,5", "Row 1, x₁: 12,5 is 12.5 mm.")
    open_page(page, "Robot")
    open_page(page, "Toolpath")
    sees(page, 0, 3, "12.5")


def test_stiffness_typed_beside_the_compliance_changes_both(page: Any) -> None:
    open_page(page, "Robot")
    type_into_cell(page, (0, 2), 0.85, "1000,5", "Joint 1, stiffness: 1000,5 is 1000.5 kN m/rad.")
    sees(page, 0, 1, "9.995")
    sees(page, 0, 2, "1000.5")
    type_into_cell(page, (1, 1), 0.5, "20,5", "Joint 2, compliance: 20,5 is 20.5 ×10⁻⁷ rad/(N m).")
    sees(page, 1, 2, "487.805")
    sees(page, 0, 2, "1000.5")
