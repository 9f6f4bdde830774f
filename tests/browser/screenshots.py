"""Pictures of every page, light and dark, wide and narrow.

Usage: ``python tests/browser/screenshots.py FOLDER [URL] [PAGE ...]``.

Without a URL the app is started for the time it takes. Look at the pictures; nothing here judges them.
"""

from __future__ import annotations

import contextlib
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from server import Server

ROOT = Path(__file__).resolve().parents[2]
CHROMIUM = "/usr/bin/chromium"
ARGUMENTS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
WIDTHS = {"wide": 1440, "narrow": 800}
TAB_PAGES = {"Robot": ("D-H table", "Limits", "Tool")}


def page_paths() -> dict[str, str]:
    """Name -> path of every page."""
    names = [p.stem.partition("_")[2] for p in sorted((ROOT / "pages").glob("[0-9]*_*.py"))]
    return {"Start": "/", **{name: f"/{name}" for name in names}}


@contextlib.contextmanager
def served(page: Path | None = None) -> Iterator[str]:
    """The app (or one ``page``) on a free port of this machine, with its work kept in a folder that goes with it."""
    with tempfile.TemporaryDirectory() as folder:
        server = Server(Path(folder), page=page)
        server.start()
        try:
            yield server.url
        finally:
            server.stop()


def idle(page: Any) -> None:
    """Wait until the page has run."""
    page.wait_for_selector('[data-testid="stApp"][data-test-script-state="notRunning"]', timeout=60_000)


def boxes(*places: Any) -> list[dict[str, float]]:
    """Where each stands (x, y, width, height in px of the window), of one instant: a page that grows moves all of them
    together, and boxes asked for one after another would differ by what has grown between."""
    page, nodes = places[0].page, [place.first.element_handle() for place in places]
    return list(page.evaluate("nodes => nodes.map(node => node.getBoundingClientRect().toJSON())", nodes))


def until(page: Any, shown: Callable[[], object], wanted: object) -> None:
    """Wait until that is shown: a machine that does much else draws late, and is no fault of the page."""
    for _ in range(130):
        if shown() == wanted:
            return
        page.wait_for_timeout(150)
    assert shown() == wanted


def settle(page: Any) -> None:
    """Wait until the script has run and the pictures are drawn."""
    idle(page)
    with contextlib.suppress(Exception):  # a page without tiles is drawn all the same
        page.wait_for_selector(".rm-tiles, [data-testid='stAlert']", timeout=10_000)
    page.wait_for_timeout(1800)


def take(folder: Path, url: str, wanted: list[str]) -> None:
    """Save ``<page>-<theme>-<width>.png`` of the whole page."""
    from playwright.sync_api import sync_playwright

    folder.mkdir(parents=True, exist_ok=True)
    pages = {k: v for k, v in page_paths().items() if not wanted or k.lower() in wanted}
    with sync_playwright() as playwright:
        for theme in ("light", "dark"):
            for size, width in WIDTHS.items():
                with tempfile.TemporaryDirectory() as home:
                    context = playwright.chromium.launch_persistent_context(
                        home,
                        executable_path=CHROMIUM,
                        args=ARGUMENTS,
                        color_scheme=theme,
                        viewport={"width": width, "height": 1000},
                    )
                    page = context.new_page()
                    for name, path in pages.items():
                        page.set_viewport_size({"width": width, "height": 1000})
                        page.goto(url + path)
                        settle(page)
                        _whole(page, width)
                        page.screenshot(path=folder / f"{name}-{theme}-{size}.png")
                        if size == "wide":
                            for tab in TAB_PAGES.get(name, ()):
                                page.get_by_role("tab", name=tab).click()
                                page.wait_for_timeout(1200)
                                page.screenshot(path=folder / f"{name}-{theme}-{tab.split()[0]}.png")
                    context.close()


def _whole(page: object, width: int) -> None:
    """Make the window as tall as the page, so that one picture holds all of it."""
    height = page.evaluate("document.querySelector('[data-testid=\"stMain\"]').scrollHeight")
    page.set_viewport_size({"width": width, "height": min(max(int(height) + 20, 700), 2600)})
    page.wait_for_timeout(900)


def main() -> None:
    """Command line."""
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    folder, rest = Path(sys.argv[1]), sys.argv[2:]
    wanted = [name.lower() for name in rest if not name.startswith("http")]
    urls = [name for name in rest if name.startswith("http")]
    if urls:
        take(folder, urls[0].rstrip("/"), wanted)
        return
    with served() as url:
        take(folder, url, wanted)


if __name__ == "__main__":
    main()
