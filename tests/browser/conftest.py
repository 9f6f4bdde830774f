"""The app in a real browser: one server and one Chromium for the folder."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from screenshots import ARGUMENTS, CHROMIUM, served

from robomill.compiled import prepare


@pytest.fixture(scope="session")
def url() -> Iterator[str]:
    """Address of the running app, whose kernels are there: what waits is measured, not what is compiled."""
    prepare()
    with served() as address:
        yield address


@pytest.fixture
def language() -> str:
    """The browser's language, "" for its own."""
    return ""


@pytest.fixture
def page(url: str, language: str) -> Iterator[Any]:
    """A fresh page in a wide window; errors of the page's own scripts fail the test."""
    sync_api = pytest.importorskip("playwright.sync_api")
    if not Path(CHROMIUM).exists():
        pytest.skip("no Chromium: apt-get install -y chromium")
    with sync_api.sync_playwright() as playwright, tempfile.TemporaryDirectory() as home:
        context = playwright.chromium.launch_persistent_context(
            home,
            executable_path=CHROMIUM,
            args=[*ARGUMENTS, f"--lang={language}"] if language else ARGUMENTS,
            locale=language or None,
            viewport={"width": 1440, "height": 1000},
            accept_downloads=True,
        )
        made = context.new_page()
        broken: list[str] = []
        made.on("pageerror", lambda error: broken.append(str(error)))
        made.goto(url)
        yield made
        context.close()
        assert broken == []
