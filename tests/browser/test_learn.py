"""Learn in a browser: lessons by their address; question and picture side by side; all of the arm in its frame."""

from __future__ import annotations

from typing import Any

import pytest
from screenshots import boxes, idle

from robomill.ui.learn.lesson import ASPECT
from robomill.viz.rendered.framing import FILL

pytestmark = pytest.mark.browser


@pytest.mark.parametrize("width", [900, 1024, 1180, 1440])
def test_question_and_picture_stand_side_by_side(page: Any, url: str, width: int) -> None:
    page.set_default_timeout(60_000)
    page.set_viewport_size({"width": width, "height": 900})
    page.goto(f"{url}/Learn")
    idle(page)
    answers = page.locator("[class*=st-key-learn-answers]")
    picture = page.locator(".st-key-learn-push .js-plotly-plot")
    picture.locator("canvas").first.wait_for()
    page.wait_for_timeout(1500)
    asked, drawn = boxes(answers, picture)
    assert asked["x"] >= drawn["x"] + drawn["width"] - 1, "beside each other"
    assert abs(asked["y"] - drawn["y"]) < 60
    assert asked["x"] + asked["width"] <= width
    size = answers.locator("label p").first.evaluate("node => getComputedStyle(node).fontSize")
    assert float(size.removesuffix("px")) >= 20.0
    assert drawn["width"] >= FILL * ASPECT * drawn["height"], "the frame is as wide as the arm needs"
    page.get_by_role("button", name="Show where it goes").click()
    idle(page)
    back = page.get_by_role("button", name="Hide it again")
    back.wait_for()
    assert back.evaluate("node => getComputedStyle(node).borderTopWidth") == "2px"


@pytest.mark.parametrize("width", [1440, 390])
def test_an_address_leads_to_a_step_of_a_lesson_in_large_type_and_without_the_menu(
    page: Any, url: str, width: int
) -> None:
    page.set_default_timeout(60_000)
    page.set_viewport_size({"width": width, "height": 900})
    page.goto(f"{url}/Learn?lesson=2&step=2&projector=1")
    idle(page)
    page.get_by_text("Joint 3 gives 70 % of the displacement.").wait_for()
    size = page.evaluate("getComputedStyle(document.documentElement).fontSize")
    assert float(size.removesuffix("px")) == pytest.approx(1.4 * 16)
    assert not page.locator('[data-testid="stSidebar"]').is_visible()
    # Nothing stands beyond the edge, once the components have their width.
    page.wait_for_function("w => document.querySelector('[data-testid=stMain]').scrollWidth <= w", arg=width)
    page.get_by_role("button", name="Why?").click()
    idle(page)
    page.wait_for_function("new URL(location).searchParams.get('step') === '3'")
    page.reload()
    idle(page)
    page.get_by_text("What joint 3 gives is its compliance times its lever arm squared").wait_for()
