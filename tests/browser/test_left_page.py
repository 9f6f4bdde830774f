"""A click counts, whatever the page still says."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from screenshots import idle, served

pytestmark = pytest.mark.browser
CLICKS = 5


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    """Address of pages that go on speaking until they are gone."""
    with served(Path(__file__).with_name("left_page.py")) as address:
        yield address


@pytest.mark.parametrize("speaking", ["part", "whole"])
def test_a_page_that_was_clicked_comes_and_stays(page: Any, url: str, speaking: str) -> None:
    for _ in range(CLICKS):
        page.goto(f"{url}/{speaking}")
        page.get_by_text("speaking").wait_for()
        page.get_by_test_id("stSidebarNavLink").filter(has_text="other").click()
        page.get_by_text("other 14").wait_for()
        idle(page)
        page.wait_for_timeout(300)
        assert page.get_by_text("other 14").is_visible()
        assert page.get_by_text("speaking").count() == 0


def test_a_click_beside_a_part_that_speaks_is_heard_and_drawn(page: Any, url: str) -> None:
    """Without our care one click in ten stood in a message of the part, or its drawing was forgotten."""
    page.goto(f"{url}/clicked")
    for click in range(60):
        page.get_by_text(f"click {click}, line 5").wait_for()
        page.get_by_role("button", name="more").click()
    page.get_by_text("click 60, line 5").wait_for()


def test_a_click_beside_a_part_that_ticks_is_done_once(page: Any, url: str) -> None:
    """Without our care 149 clicks were done 169 times."""
    page.goto(f"{url}/ticking")
    for click in range(60):
        page.get_by_text(f"done {click} times").wait_for()
        page.get_by_role("button", name="more").click()
        page.wait_for_timeout(100)
    page.get_by_text("done 60 times").wait_for()


def test_a_click_whose_work_takes_a_while_is_done_whatever_the_page_says_meanwhile(page: Any, url: str) -> None:
    """Without our care each word of the page ends that work half way, and the click is forgotten."""
    page.goto(f"{url}/slow")
    for click in range(20):
        page.get_by_text(f"done {click} times").wait_for()
        page.get_by_role("button", name="more").click()
    page.get_by_text("done 20 times").wait_for(timeout=20_000)


def test_what_is_typed_is_taken_once_whatever_the_page_says_meanwhile(page: Any, url: str) -> None:
    """Each value, also where a click follows at once."""
    page.goto(f"{url}/typed")
    for value in range(30):
        page.get_by_role("textbox", name="box").fill(str(value))
        if value % 2:
            page.get_by_role("button", name="less").click()
        else:
            page.keyboard.press("Enter")
        page.wait_for_timeout(20 * (value % 5))
    page.get_by_text("taken " + " ".join(map(str, range(30)))).wait_for(timeout=10_000)


def test_what_a_button_puts_into_a_box_is_not_taken_back_by_what_the_page_says_meanwhile(page: Any, url: str) -> None:
    """Until the browser has drawn it, every word of the page says of the box what it was. Without our care that was
    taken for typed. What is typed then is taken, the number from before as well."""
    page.goto(f"{url}/put")
    box, typed = page.get_by_role("textbox", name="box"), page.get_by_text("typed:")
    for number in range(CLICKS * 3):
        page.get_by_text(f"number {number}, line 5").wait_for()
        page.get_by_role("button", name="more").click()
    page.get_by_text(f"number {CLICKS * 3}, line 5").wait_for()
    idle(page)
    assert box.input_value() == str(CLICKS * 3)
    assert typed.inner_text() == "typed:"
    box.fill(str(CLICKS * 3 - 1))
    box.press("Enter")
    page.get_by_text(f"typed: {CLICKS * 3 - 1}").wait_for()
