"""No page asks another host for anything: a shop may have no way out, and visits are nobody else's business."""

from __future__ import annotations

from typing import Any
from urllib.parse import urlsplit

import pytest
from screenshots import idle, page_paths

pytestmark = pytest.mark.browser


def test_every_request_of_every_page_goes_to_the_server_itself(page: Any, url: str) -> None:
    asked: set[str] = set()
    page.on("request", lambda request: asked.add(request.url))
    page.on("websocket", lambda socket: asked.add(socket.url))
    for path in page_paths().values():
        page.goto(url + path)
        page.wait_for_selector("[data-testid='stSidebarNavLink']", timeout=60_000)
        idle(page)
        page.wait_for_timeout(1500)
    own = urlsplit(url).netloc
    foreign = {each for each in asked if urlsplit(each).scheme not in ("data", "blob") and urlsplit(each).netloc != own}
    assert len(asked) > 20
    assert foreign == set()
    icon = page.locator("link[rel='shortcut icon'], link[rel='icon']").first.get_attribute("href")
    assert icon.startswith(("data:image/svg", "/media/", f"{url}/media/")), "our own, not Streamlit's"
