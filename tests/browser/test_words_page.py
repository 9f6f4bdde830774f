"""What a file says is shown as text in a browser: no link, no picture, no style, and nothing is asked of a foreign
host."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from screenshots import idle, served
from words_page import WORDS

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    with served(Path(__file__).with_name("words_page.py")) as address:
        yield address


def test_words_are_text_to_the_letter(page: Any, url: str) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(url)
    page.wait_for_selector(f".st-key-words-{len(WORDS) - 1} strong")
    idle(page)
    for number, words in enumerate(WORDS):
        here = page.locator(f".st-key-words-{number}")
        assert here.locator("a, img, code, b, .katex, em").count() == 0, words
        shown = here.locator("p").all_inner_texts()
        assert [each.replace("\u2060", "") for each in shown] == [words] * 3
    assert not [each for each in asked if "foreign" in each]
