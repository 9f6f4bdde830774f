"""What a checker of accessibility (axe-core) finds on the pages: nothing serious and nothing critical."""

from __future__ import annotations

from typing import Any

import pytest
from screenshots import idle, page_paths

from robomill.learn.lesson import COUNT

pytestmark = pytest.mark.browser

NAMED = '[data-testid="stSidebarNavItems"][role]'  # the menu's groups have their names once the page's script has run
GRAVE = ("serious", "critical")
LESSONS = {f"lesson {n}": f"/Learn?lesson={n}&step=4" for n in range(1, COUNT + 1)}
MORE = {
    "exercises": "/Learn?lesson=exercises",
    "projector": "/Learn?lesson=1&step=2&projector=1",
}


def found(page: Any) -> dict[str, list[str]]:
    """What is grave on the page as it stands: rule -> where."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    return {
        each["id"]: [node["html"][:160] for node in each["nodes"]]
        for each in axe.run(page).response["violations"]
        if each["impact"] in GRAVE
    }


@pytest.mark.parametrize(("scheme", "width"), [("light", 1440), ("dark", 390)])  # no colour is of one width alone
def test_no_page_has_a_serious_finding(page: Any, url: str, scheme: str, width: int) -> None:
    page.set_default_timeout(60_000)
    page.emulate_media(color_scheme=scheme)
    page.set_viewport_size({"width": width, "height": 900})
    places = page_paths() | (LESSONS if scheme == "light" else {}) | MORE
    grave = {}
    for name, path in places.items():
        page.goto(url + path)
        idle(page)
        page.locator(".rm-title, .rm-ask").first.wait_for()
        page.locator(NAMED).wait_for(state="attached")
        page.wait_for_timeout(600)
        if each := found(page):
            grave[name] = each
    assert grave == {}


def test_two_projects_side_by_side_have_no_serious_finding(page: Any) -> None:
    page.set_default_timeout(60_000)
    page.get_by_text("0.23 mm off in Y").first.wait_for()
    idle(page)
    page.get_by_role("button", name="Keep and compare").click()
    page.get_by_role("combobox", name="Compare with").click()
    page.get_by_role("option").filter(has_text="Heart").click()
    page.get_by_role("region", name="Verdict of B").wait_for()
    idle(page)
    page.get_by_role("button", name="Show the mathematics").click()
    page.get_by_text("As LaTeX").wait_for()
    page.locator(NAMED).wait_for(state="attached")
    page.wait_for_timeout(600)
    assert found(page) == {}
