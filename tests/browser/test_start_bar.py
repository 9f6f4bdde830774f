"""The bar stays at the top of every page while one scrolls, at any width, and nothing in it is cut."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest
from screenshots import idle, page_paths, served

pytestmark = pytest.mark.browser

LOOK = """() => {
  const bar = document.querySelector('.st-key-bar'), box = bar.getBoundingClientRect();
  const middle = document.elementFromPoint(box.left + box.width / 2, box.top + 6);
  const cut = [...bar.querySelectorAll('.rm-cell:not(.rm-name) b, .rm-scale span')].filter((each) => {
    const it = each.getBoundingClientRect();
    return it.width > 0 && (each.scrollWidth > each.clientWidth + 1 && getComputedStyle(each).display !== 'inline'
      || it.right > window.innerWidth || it.bottom > box.bottom + 2);
  }).map((each) => each.textContent);
  const parts = [...bar.querySelectorAll('.rm-cell, .rm-gauge, .st-key-bar-worst')].map((each) =>
    [each.textContent, each.getBoundingClientRect()]).filter(([, it]) => it.width > 0);
  const over = parts.flatMap(([name, it], i) => parts.slice(i + 1).filter(([, that]) =>
    it.left < that.right - 1 && that.left < it.right - 1 && it.top < that.bottom - 1 && that.top < it.bottom - 1
  ).map(([other]) => `${name} / ${other}`));
  return { over, top: box.top, height: box.height, seen: bar.contains(middle) || middle.contains(bar), cut,
    bars: document.querySelectorAll('.rm-top').length, heads: document.querySelectorAll('h1').length };
}"""


def scrolled(page: Any) -> None:
    page.evaluate("document.querySelector('[data-testid=\"stMain\"]').scrollTo(0, 600)")
    page.wait_for_timeout(150)


@pytest.mark.parametrize(("width", "most"), [(1440, 48), (1024, 92), (800, 92), (390, 92)])
def test_the_bar_stays_on_every_page(page: Any, url: str, width: int, most: int) -> None:
    page.set_viewport_size({"width": width, "height": 850})
    some = ("Start", "Milling") if width in (1024, 800) else tuple(page_paths())
    for name, path in page_paths().items():
        if name not in some:
            continue
        page.goto(url + path)
        page.wait_for_selector(".rm-top", timeout=60_000)
        idle(page)
        for move in (lambda _page: None, scrolled):
            move(page)
            found = page.evaluate(LOOK)
            assert 0 <= found["top"] <= 1, (name, found)
            assert 44 <= found["height"] <= most, (name, found)
            assert found["seen"], (name, found)
            assert found["cut"] == [], (name, found)
            assert found["over"] == [], (name, found)
            assert found["bars"] == 1, name


@pytest.mark.parametrize("preset", ["heart", "paper_flute"])
def test_nothing_in_the_bar_lies_over_anything_else(page: Any, url: str, preset: str) -> None:
    """A verdict in many words ("within tolerance, tight") and a force that is computed leave no room for a link."""
    page.goto(f"{url}/?preset={preset}")
    page.wait_for_selector(".st-key-bar-worst", timeout=60_000)
    idle(page)
    for width in (1440, 1200, 1024, 900, 800, 600, 390):
        page.set_viewport_size({"width": width, "height": 800})
        page.wait_for_timeout(300)
        found = page.evaluate(LOOK)
        assert (found["over"], found["cut"]) == ([], []), width


def test_a_deep_link_on_a_fresh_server_has_its_page_its_bar_and_the_named_menu(page: Any) -> None:
    with served() as fresh:
        page.goto(f"{fresh}/Robot")
        page.wait_for_selector(".rm-kicker:has-text('Robot ·')", timeout=60_000)
        idle(page)
        links = page.get_by_test_id("stSidebarNavLink").all_inner_texts()
        assert links[:2] == ["Start", "Milling"]
        assert len(links) == len(page_paths())
        assert page.locator(".rm-top").count() == 1
        page.get_by_test_id("stSidebarNavLink").first.click()
        page.wait_for_url(f"{fresh}/", timeout=30_000)
        page.goto("about:blank")


def test_go_to_worst_leads_to_milling_from_another_page(page: Any, url: str) -> None:
    page.goto(f"{url}/Compliance")
    page.wait_for_selector(".rm-top", timeout=60_000)
    idle(page)
    page.get_by_role("button", name="Go to worst: line 7").click()
    page.wait_for_selector(".rm-kicker:has-text('Milling ·')", timeout=60_000)
    assert page.url.endswith("/Milling")


def test_small_print_is_paler_once_and_parts_of_a_page_follow_its_title(page: Any, url: str) -> None:
    idle(page)
    caption = page.locator("[data-testid=stSidebar] [data-testid=stCaptionContainer]").first
    assert caption.evaluate("each => getComputedStyle(each).opacity") == "1"
    page.goto(f"{url}/Learn")
    page.get_by_role("heading", name="The paper, reproduced").wait_for(timeout=60_000)
    levels = page.evaluate("[...document.querySelectorAll('h1, h2, h3, h4')].map(each => Number(each.tagName[1]))")
    assert all(later <= before + 1 for before, later in pairwise(levels)), levels
