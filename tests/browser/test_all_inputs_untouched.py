"""Inputs that nobody touched answer nothing while their page comes up, however often its runs are broken off."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from screenshots import served

pytestmark = pytest.mark.browser
LOADS = 6


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    """Address of a page with every kind of input."""
    with served(Path(__file__).with_name("all_inputs.py")) as address:
        yield address


def test_an_untouched_input_takes_nothing(page: Any, url: str) -> None:
    """In the browser an input comes up with its default; ticks that come before its value carry that default."""
    for _ in range(LOADS):
        page.goto(url)
        page.wait_for_selector("text=done; taken")
        page.wait_for_timeout(300)
        assert "taken: nothing" in page.locator("text=done; taken").inner_text()
        boxes = page.get_by_label("box", exact=True).or_(page.get_by_label("optional", exact=True))
        boxes.nth(7).wait_for()
        assert [float(box.input_value()) for box in boxes.all()] == [7.0] * 8
