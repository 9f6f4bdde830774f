"""Links and reports in a browser: what one sends opens at another's, and one's own work is asked for."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from screenshots import idle

pytestmark = pytest.mark.browser
WAIT = 60_000


def shared(page: Any) -> list[str]:
    """Link, command and Python, as they stand in the panel."""
    page.get_by_role("button", name="Share", exact=True).click()
    panel = page.get_by_role("dialog")
    panel.get_by_text("import robomill").wait_for(timeout=WAIT)
    found = [" ".join(each.split()) for each in panel.get_by_test_id("stCode").all_inner_texts()]
    page.keyboard.press("Escape")
    panel.wait_for(state="hidden", timeout=WAIT)
    return found


def headline(page: Any, words: str) -> None:
    page.locator(".rm-kicker", has_text=words).wait_for(timeout=WAIT)


def test_a_link_opens_at_anothers_and_asks_before_it_takes_the_place_of_work(page: Any, url: str) -> None:
    page.goto(f"{url}/Milling?preset=heart")
    headline(page, "Heart")
    assert "preset" not in page.url
    link, command, python = shared(page)
    assert command == "robomill simulate heart"
    assert 'rm.load_setup("heart")' in python
    assert link == f"{url}/Milling?preset=heart"
    box = page.get_by_label("Tolerance, mm").first
    box.fill("0.44")
    box.press("Enter")
    page.get_by_role("region", name="Verdict of the cut").get_by_text("0.44 mm").first.wait_for(timeout=WAIT)
    (changed, command, _) = shared(page)
    assert command == "robomill simulate heart --tol 0.44"
    page.goto(f"{url}/Milling?preset=spiral")
    page.get_by_text("The link holds another project").wait_for(timeout=WAIT)
    headline(page, "Heart")
    page.get_by_role("button", name="Open it").click()
    headline(page, "Spiral")
    page.get_by_role("button", name="Undo").click()
    headline(page, "Heart")
    stranger = page.context.browser.new_context() if page.context.browser else None
    if stranger is not None:
        other = stranger.new_page()
        other.goto(changed)
        headline(other, "Heart")
        assert shared(other)[1] == command
        stranger.close()


@pytest.mark.parametrize(
    ("at", "buttons", "leads_to"),
    [
        ("Robot", ["Go to worst"], "Milling"),
        ("", ["Stiffen a joint"], "Improve"),
        ("Learn", ["Show where it goes", "Measure it in the virtual laboratory"], "Identification"),
    ],
)
def test_a_button_leads_to_its_page_and_one_can_go_back(
    page: Any, url: str, at: str, buttons: list[str], leads_to: str
) -> None:
    page.goto(f"{url}/{at}")
    for name in buttons:
        page.get_by_role("button", name=name).click()
    page.wait_for_url(f"**/{leads_to}", timeout=WAIT)
    idle(page)
    page.get_by_test_id("stSidebarNavLink").filter(has_text=at or "Start").click()
    page.wait_for_url(f"**/{at}", timeout=WAIT)
    idle(page)
    page.wait_for_timeout(500)
    assert page.url == f"{url}/{at}"


def test_what_is_shared_is_copied_by_keyboard_and_by_touch(page: Any) -> None:
    """The symbol that copies is no mouse's alone: Tab leads to it, and where nothing hovers it is in sight."""
    page.get_by_role("button", name="Share", exact=True).click()
    panel = page.get_by_role("dialog")
    panel.get_by_text("import robomill").wait_for(timeout=WAIT)
    panel.get_by_test_id("stCode").first.focus()
    page.wait_for_timeout(500)  # it fades in
    page.keyboard.press("Tab")
    assert "Copy to clipboard" in page.evaluate("document.activeElement.outerHTML")
    page.keyboard.press("Escape")
    panel.wait_for(state="hidden", timeout=WAIT)
    touched = page.context.new_cdp_session(page)
    touched.send("Emulation.setTouchEmulationEnabled", {"enabled": True})
    touched.send("Emulation.setEmulatedMedia", {"features": [{"name": "hover", "value": "none"}]})
    assert page.evaluate("matchMedia('(hover: none)').matches")
    page.get_by_role("button", name="Share", exact=True).click()
    panel.get_by_text("import robomill").wait_for(timeout=WAIT)
    for each in panel.get_by_label("Copy to clipboard").all():
        each.wait_for(state="visible", timeout=WAIT)


def test_the_report_is_taken_away(page: Any, url: str, tmp_path: Path) -> None:
    page.goto(f"{url}/Milling")
    headline(page, "Reference groove")
    with page.expect_download(timeout=WAIT) as taken:
        page.get_by_role("button", name="Report", exact=True).click()
    file = tmp_path / taken.value.suggested_filename
    taken.value.save_as(file)
    assert file.name == "reference-groove-slavkovic-2013-report.html"
    text = file.read_text(encoding="utf-8")
    assert "within tolerance (77 % of it used)" in text
    assert re.search(r"Fingerprint</dt><dd>[0-9a-f]{12}<", text)


def test_a_link_to_the_start_page_opens_its_example_there(page: Any, url: str) -> None:
    page.goto(f"{url}/?preset=heart")
    headline(page, "Start · Heart")
    assert "preset" not in page.url
