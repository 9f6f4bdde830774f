"""The menu says Start first, in groups, and loses no page."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from robomill.ui.serving import menu


@dataclass
class Page:
    """A page as the menu sees it."""

    title: str
    _default: bool = False


@pytest.fixture(autouse=True)
def _plain_pages(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(menu, "_named", lambda page, title: Page(title, True))


def test_every_page_stands_in_its_group_and_a_new_one_at_the_end() -> None:
    pages: list[Any] = [Page("app", True), *(Page(name) for name in ("Robot", "Learn", "Milling", "Brand new"))]
    found = {group: [page.title for page in pages] for group, pages in menu.grouped(pages).items()}
    assert found == {"Result": ["Start", "Milling"], "Set-up": ["Robot"], "Teach": ["Learn"], "": ["Brand new"]}


def test_every_page_has_the_file_that_links_go_to() -> None:
    root = Path(__file__).resolve().parents[3]
    files = {f"pages/{path.name}" for path in (root / "pages").glob("[0-9]_*.py")}
    assert {menu.file_of(title) for title in menu.PAGES} == files
    assert {*menu.PAGES} == {title for titles in menu.GROUPS.values() for title in titles} - {menu.START}
