"""The menu of pages: named and grouped by what one wants of them.

Streamlit makes it of the names of the files, in their order, and calls the first page "app". Its own menu is kept (the
links are there before a page has run, and a screen reader knows it as navigation); what it is made of is handed to it
in groups.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from typing import Any

import streamlit as st
from streamlit.commands import navigation
from streamlit.navigation.page import StreamlitPage

from robomill.ui import session

START, BOUND = "Start", "menu.bound"
GROUPS = {
    "Result": (START, "Milling"),
    "Set-up": ("Robot", "Toolpath"),
    "Analyse": ("Workspace", "Compliance", "Identification", "Improve"),
    "Teach": ("Learn",),
}

PAGES = ("Robot", "Workspace", "Compliance", "Identification", "Toolpath", "Milling", "Improve", "Learn")
"""In the order of their files."""


def file_of(title: str) -> str:
    """The file of a page, as links and changes of page want it."""
    return f"pages/{PAGES.index(title) + 1}_{title}.py"


def head_for(title: str) -> None:
    """Another page next: what a button says, and what was clicked is not half done where the page is left meanwhile."""
    session.keep(BOUND, title)


def go_on(title: str) -> None:
    """From the page ``title`` to where its person is bound; a part of it that holds such a button calls it, too."""
    bound = session.kept(BOUND, title)
    if bound != title:
        st.switch_page(file_of(bound))
    session.drop(BOUND)


def grouped(pages: Sequence[StreamlitPage]) -> Mapping[str, list[StreamlitPage]]:
    """The pages in their groups, the first one named; a page of no group comes last, under no heading."""
    left = {START if page._default else page.title: page for page in pages}
    groups: dict[str, list[StreamlitPage]] = {}
    for group, titles in {**GROUPS, "": tuple(left)}.items():
        found = [left.pop(title) for title in titles if title in left]
        if found:
            groups[group] = [_named(page, START) if page._default else page for page in found]
    return groups


def _named(page: Any, title: str) -> StreamlitPage:
    return st.Page(page._page, title=title, default=True)


def in_groups(make: Callable[..., Any]) -> Callable[..., Any]:
    """``make`` (of the menu, from a list of pages) with the pages in their groups."""

    @wraps(make)
    def made(pages: Any, **more: Any) -> Any:
        own = isinstance(pages, list) and any(page.title == "Milling" for page in pages)
        return make(grouped(pages) if own else pages, **more)

    return made


def group_pages() -> bool:
    """Have the menus of this server made so. True where they were not yet: the page in hand was made with the other
    one."""
    make = getattr(navigation, "_navigation", None)  # another Streamlit may not have it: its own menu is as good
    if make is None or hasattr(make, "__wrapped__"):
        return False
    navigation._navigation = in_groups(make)
    return True
