"""The process engineer's first minute by keyboard alone: Tab, Enter and the arrow keys, with the focus to be seen."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import pytest
from screenshots import idle

pytestmark = pytest.mark.browser

PROGRAM = "G21 G90\nG0 X-30 Y0 Z5\nS8000 M3\nG1 Z-1 F300\nG1 X30 F600\nG2 X30 Y12 I0 J6\nG1 X-30\nG0 Z20\nM8\nM2\n"
MOST = 170  # stops of the Tab key on the way to anything

NAME = """() => { let e = document.activeElement;
  while (e && e.shadowRoot && e.shadowRoot.activeElement) e = e.shadowRoot.activeElement;
  const label = e.labels && e.labels.length ? e.labels[0].innerText : '';
  return [e.tagName, e.getAttribute('aria-label') || label || e.innerText || ''].join(' ').trim(); }"""
BOX = """() => { const e = document.activeElement, b = e.getBoundingClientRect();
  return [b.x, b.y, b.width, b.height]; }"""


def focused(page: Any) -> str:
    """What has the focus: its tag and its name."""
    return " ".join(str(page.evaluate(NAME)).split())[:80]


def tab_to(page: Any, name: str, back: bool = False) -> None:
    """Tab until what has the focus is called so; and it is seen to have it."""
    seen = []
    for _ in range(MOST):
        page.keyboard.press("Shift+Tab" if back else "Tab")
        seen.append(focused(page))
        if name in seen[-1]:
            assert focus_is_seen(page), seen[-1]
            return
    raise AssertionError(f"{name} was not met: {seen}")


def focus_is_seen(page: Any) -> bool:
    """Whether what has the focus looks otherwise than without it."""
    from PIL import Image, ImageChops

    page.wait_for_timeout(350)  # colours fade in
    x, y, w, h = page.evaluate(BOX)
    high, wide = page.viewport_size["height"], page.viewport_size["width"]
    clip = {"x": max(x - 8, 0), "y": max(y - 8, 0)}
    clip |= {"width": min(w + 16, wide - clip["x"]), "height": min(h + 16, high - clip["y"])}
    if min(clip.values()) < 0 or clip["width"] < 4 or clip["height"] < 4:
        return False
    page.evaluate("document.activeElement.style.caretColor = 'transparent'")
    with_it = Image.open(io.BytesIO(page.screenshot(clip=clip))).convert("RGB")
    held = page.evaluate_handle("document.activeElement")
    page.evaluate("document.activeElement.blur()")
    page.wait_for_timeout(350)
    without = Image.open(io.BytesIO(page.screenshot(clip=clip))).convert("RGB")
    held.evaluate("e => e.focus({ preventScroll: true, focusVisible: true })")
    page.wait_for_timeout(150)
    return ImageChops.difference(with_it, without).getbbox() is not None


def chosen(page: Any) -> Any:
    """The chooser of files that the upload opens. A picture that comes late may draw the page anew in between: again
    then."""
    from playwright.sync_api import TimeoutError as NoneCame

    for patience in (15_000, 15_000, 60_000):
        tab_to(page, "BUTTON upload Upload")
        try:
            with page.expect_file_chooser(timeout=patience) as asked:
                page.keyboard.press("Enter")
        except NoneCame:
            idle(page)
        else:
            return asked.value
    raise AssertionError("the upload opens no chooser of files")


def test_a_program_is_checked_by_keyboard_alone(page: Any, tmp_path: Path) -> None:
    part = tmp_path / "PART.NC"
    part.write_text(PROGRAM)
    page.set_default_timeout(60_000)
    page.get_by_text("0.23 mm off in Y").first.wait_for()
    idle(page)
    chosen(page).set_files(str(part))
    page.wait_for_selector(".rm-kicker:has-text('Toolpath')")
    page.get_by_text("What is it cutting?").wait_for()
    idle(page)

    tab_to(page, "INPUT Diameter, mm")
    _typed(page, "8")
    tab_to(page, "INPUT Flutes")
    _typed(page, "3")
    tab_to(page, "INPUT Tolerance")
    _typed(page, "0,30")
    tab_to(page, "This is what it cuts")
    page.keyboard.press("Enter")
    page.get_by_text("What is it cutting?").wait_for(state="hidden")
    idle(page)

    tab_to(page, "Go to worst")
    page.keyboard.press("Enter")
    page.wait_for_selector(".rm-kicker:has-text('Milling')")
    page.locator(".rm-tile", has_text="Wall error").wait_for()
    idle(page)
    tab_to(page, "What would fix it?")
    page.keyboard.press("Enter")
    page.wait_for_selector(".rm-kicker:has-text('Improve')")


def _typed(page: Any, text: str) -> None:
    page.keyboard.press("Control+A")
    page.keyboard.type(text)
    page.keyboard.press("Enter")
    page.wait_for_timeout(300)
    idle(page)
