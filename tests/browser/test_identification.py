"""From an uploaded file to a band: load tests in, compliances in force, the deviation with its uncertainty."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from screenshots import idle

from robomill.io.samples import samples_dir

pytestmark = pytest.mark.browser


def open_identification(page: Any) -> None:
    page.wait_for_selector(".rm-tiles", timeout=60_000)
    idle(page)
    page.get_by_test_id("stSidebarNavLink").filter(has_text="Identification").click()
    page.wait_for_selector(".rm-kicker:has-text('Identification ·')")
    idle(page)


def upload(page: Any, path: Path) -> None:
    page.locator("[data-testid='stMain'] input[type=file]").first.set_input_files(str(path))


def choose(page: Any, name: str) -> None:
    page.get_by_role("radio", name=name, exact=True).or_(
        page.get_by_role("button", name=name, exact=True)
    ).first.click()
    idle(page)


def own_tests(tmp_path: Path, change: str = "") -> Path:
    """Every second row of the grid sample: a file of one's own."""
    lines = (samples_dir() / "load_tests" / "grid_45x6.csv").read_text().splitlines()
    kept = [line for line in lines if not line.startswith("#")]
    path = tmp_path / "our-robot.csv"
    path.write_text("\n".join([kept[0], *kept[1:200], *([change] if change else [])]) + "\n")
    return path


def test_from_upload_to_band(page: Any, tmp_path: Path) -> None:
    open_identification(page)
    upload(page, own_tests(tmp_path))
    page.wait_for_selector(".rm-kicker:has-text('our-robot.csv')")
    idle(page)
    assert "199 tests" in page.locator("[data-testid='stMain']").inner_text()
    page.get_by_role("button", name="Use these compliances in the project").click()
    page.get_by_role("button", name="In use in the project").wait_for()
    choose(page, "In the cut")
    page.locator(".js-plotly-plot .legendtext", has_text="95 % band").wait_for()
    tile = page.locator(".rm-tile", has_text="Largest deviation in the cut").locator(".rm-value").inner_text()
    assert re.match(r"0\.29\d* ± 0\.0\d+\s*mm", tile), tile
    said = page.get_by_text("off its path, with 95 % probability").inner_text()
    assert "from the compliances" in said

    page.get_by_test_id("stSidebarNavLink").first.click()
    page.locator(".rm-tile .rm-value", has_text=re.compile(r"0\.29\d* ± 0\.0\d+\s*mm")).wait_for()
    page.get_by_test_id("stSidebarNavLink").filter(has_text="Identification").click()
    choose(page, "In the cut")

    page.get_by_role("textbox", name=re.compile("Force known to")).fill("10")
    page.keyboard.press("Enter")
    page.get_by_text("from the force").wait_for()
    wider = page.locator(".rm-tile", has_text="Largest deviation in the cut").locator(".rm-value").inner_text()
    # 10 % of 0.29 mm, twice, against what the compliances leave: their noise and the model's error.
    assert float(wider.partition("±")[2].split("mm")[0]) > 4 * float(tile.partition("±")[2].split("mm")[0])

    page.get_by_role("button", name="Undo").click()
    page.get_by_text("from the force").wait_for(state="detached")
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("button", name="Use these compliances in the project").wait_for()


def test_a_refused_file_is_named_by_row_and_column_and_mended_in_place(page: Any, tmp_path: Path) -> None:
    open_identification(page)
    upload(page, own_tests(tmp_path, "0,-1300,0,0,0,0,250,0,0.01,soft,-0.25"))
    page.get_by_text("Row 201, column dy_mm: found 'soft', expected a number").wait_for()
    box = page.get_by_role("textbox", name="Header with units")
    assert "soft" in box.input_value()
    box.fill(box.input_value().replace("soft", "0.57"))
    page.keyboard.press("Control+Enter")
    page.get_by_text("200 tests").wait_for()
    assert page.get_by_test_id("stAlert").filter(has_text="soft").count() == 0


def test_a_second_file_takes_the_place_of_the_first(page: Any, tmp_path: Path) -> None:
    """The browser says the entry of one's own file by the name that it had: nobody chose the file before."""
    open_identification(page)
    first, second = own_tests(tmp_path), tmp_path / "mended.csv"
    second.write_text(first.read_text())
    for path in (first, second):
        upload(page, path)
        page.wait_for_selector(f".rm-kicker:has-text('{path.name}')")
        idle(page)
    assert page.get_by_role("combobox", name="Load tests").input_value() == second.name
    assert page.get_by_test_id("stAlertContentError").count() == 0
