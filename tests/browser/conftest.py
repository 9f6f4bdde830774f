"""The app in a real browser: one server and one Chromium for the folder."""

from __future__ import annotations

import tempfile
from collections.abc import Generator, Iterator
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


class Browsers:
    """One Chromium for all files of the folder, in the language that was asked for last: a fresh one takes seconds to
    start, and seconds more to read what it is served. While Playwright runs, its thread has a running event loop, and
    other folders start their own."""

    def __init__(self) -> None:
        self._held = ExitStack()
        self._running: dict[str, Any] = {}

    def browser(self, language: str) -> Any:
        """The browser of a language, "" for its own."""
        if language not in self._running:
            self.close()
            sync_api = pytest.importorskip("playwright.sync_api")
            if not Path(CHROMIUM).exists():
                pytest.skip("no Chromium: apt-get install -y chromium")
            self._running[language] = self._held.enter_context(
                self._held.enter_context(sync_api.sync_playwright()).chromium.launch_persistent_context(
                    self._held.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True)),
                    executable_path=CHROMIUM,
                    args=[*ARGUMENTS, f"--lang={language}"] if language else ARGUMENTS,
                    locale=language or None,
                    viewport=WIDE,
                    accept_downloads=True,
                )
            )
            self._running[language].set_default_timeout(60_000)
        return self._running[language]

    def close(self) -> None:
        """End it, and Playwright with it."""
        self._running.clear()
        self._held.close()


BROWSERS = Browsers()


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item: pytest.Item, nextitem: pytest.Item | None) -> None:
    """It ends with the last test of the folder."""
    if nextitem is None or Path(__file__).parent not in nextitem.path.parents:
        BROWSERS.close()


@pytest.fixture
def language() -> str:
    """The browser's language, "" for its own."""
    return ""


@pytest.fixture
def browser(language: str) -> Iterator[Any]:
    """A browser that remembers nobody's work, for several pages; they are closed behind it."""
    context = BROWSERS.browser(language)
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
