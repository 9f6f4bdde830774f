"""The app in a real browser: one server for the folder, one Chromium for each file (while Playwright runs, its thread
has a running event loop, and other folders start their own)."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Generator, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from screenshots import ARGUMENTS, CHROMIUM, served

from robomill.compiled import prepare

WIDE = {"width": 1440, "height": 1000}
MOST_SHOWN = 3000  # letters
KEPT = "cookies,local_storage,indexeddb,cache_storage"


@pytest.fixture(scope="session")
def url() -> Iterator[str]:
    """Address of the running app, whose kernels are there: what waits is measured, not what is compiled."""
    prepare()
    with served() as address:
        yield address


@pytest.fixture(scope="module")
def started() -> Iterator[Callable[[str], Any]]:
    """The browser of a language, "" for its own: it stays until another is asked for, and so does what it has read of
    Streamlit, which takes a fresh one seconds."""
    sync_api = pytest.importorskip("playwright.sync_api")
    if not Path(CHROMIUM).exists():
        pytest.skip("no Chromium: apt-get install -y chromium")
    with sync_api.sync_playwright() as playwright, ExitStack() as held:
        running: dict[str, Any] = {}

        def browser(language: str = "") -> Any:
            if language not in running:
                held.close()
                running.clear()
                running[language] = playwright.chromium.launch_persistent_context(
                    held.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True)),
                    executable_path=CHROMIUM,
                    args=[*ARGUMENTS, f"--lang={language}"] if language else ARGUMENTS,
                    locale=language or None,
                    viewport=WIDE,
                    accept_downloads=True,
                )
                held.callback(running[language].close)
                running[language].set_default_timeout(60_000)
            return running[language]

        yield browser


@pytest.fixture
def language() -> str:
    """The browser's language, "" for its own."""
    return ""


@pytest.fixture
def browser(started: Callable[[str], Any], language: str) -> Iterator[Any]:
    """A browser that remembers nobody's work, for several pages; they are closed behind it."""
    context = started(language)
    yield context
    seen = [urlsplit(page.url) for page in context.pages]
    last = context.new_page()
    for page in context.pages:
        if page != last:
            page.close()
    forgets = context.new_cdp_session(last)
    for origin in {f"{at.scheme}://{at.netloc}" for at in seen if at.netloc}:
        forgets.send("Storage.clearDataForOrigin", {"origin": origin, "storageTypes": KEPT})
    context.clear_cookies()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, Any, Any]:
    """What its page showed stands beneath a test that fails: another run may show something else."""
    report = yield
    page = getattr(item, "funcargs", {}).get("page")
    if report.failed and report.when == "call" and page is not None and not page.is_closed():
        with suppress(Exception):  # the browser itself may be gone
            state = page.get_attribute('[data-testid="stApp"]', "data-test-script-state", timeout=1000)
            report.sections.append(("the page", f"{page.url}, {state}\n{page.inner_text('body')[:MOST_SHOWN]}"))
    return report


@pytest.fixture
def page(url: str, browser: Any) -> Iterator[Any]:
    """A fresh page in a wide window; errors of the page's own scripts fail the test."""
    made = browser.new_page()
    broken: list[str] = []
    made.on("pageerror", lambda error: broken.append(str(error)))
    made.goto(url)
    yield made
    assert broken == []
