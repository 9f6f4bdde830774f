"""The project lives on beyond the page: which browser and tab this is, what comes back, and what is said about it.

The browser holds an unguessable key in a cookie that only this site gets (SameSite=Strict), so that the first run of a
session knows it. A tab has a name of its own, which it says a moment later: until then a reload has the work of the
tab that was in front, and a new tab that of the one that wrote last. A page says its tab again to a server that has
forgotten it, together with what stands in its boxes.
"""

import logging
import os
import re
import secrets
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import datetime, timedelta, timezone
from functools import partial
from pathlib import Path
from typing import Any

import streamlit as st

from robomill.errors import ProjectError, RobomillError
from robomill.ui import session
from robomill.ui.entry import inputs
from robomill.ui.entry.typed import HEARD
from robomill.ui.keeping.settings import Settings
from robomill.ui.keeping.shelf import KEY, Head, Shelf
from robomill.ui.keeping.writer import Line, Work, Writer
from robomill.ui.markup import as_markdown
from robomill.ui.project import DEFAULT_PRESET, SUFFIX, Project, preset_setup, presets, project_from_toml
from robomill.ui.session import Store

LINE, NOTICE = "autosave.line", "autosave.notice"
KEY_COOKIE, TAB_COOKIE = "robomill_key", "robomill_tab"
OFF = "This server keeps no work beyond the page: Save takes yours away."
NO_COOKIES = "This browser takes no cookies, so nothing is kept beyond the page: Save takes your work away."
SETTLED_S = 0.05  # so long a page waits to hear whether the edit that it shows is kept
CUT_OFF = "This page was cut off from its server."
_page = st.components.v2.component(
    "robomill_tab",
    html="<i></i>",
    css="i { display: none }",
    js=Path(__file__).with_name("autosave.js").read_text(encoding="utf-8"),
)


@dataclass(frozen=True, eq=False)
class Notice:
    """Words shown until they are put away or, where they are about ``project``, until its set-up changes.

    What is about a project is put away with its page, too. ``instead`` is work that can be had in its place,
    ``refused`` a file that could not be opened, to be taken away.
    """

    words: str
    project: Project | None = None
    page: str = ""  # where it was first shown
    instead: Head | None = None
    refused: str = ""


@st.cache_resource(show_spinner=False)
def writer() -> Writer | None:
    """The one that writes for this server; None where nothing is to be kept."""
    try:
        settings = Settings.of(os.environ)
    except ProjectError as exc:
        logging.getLogger(__name__).warning("No work is kept: %s", exc)
        return None
    return Writer(Shelf(settings)) if settings.on else None


def line() -> Line:
    """Where this tab's work is kept."""
    found: Line = session.kept(LINE)
    return found


def trouble() -> str:
    """Why nothing is kept, as long as that lasts; "" where all is well."""
    return (line().trouble if line().trouble == NO_COOKIES else "") if writer() else OFF


def refusal() -> str:
    """Why the last work was not kept, of this tab or, where the store is at fault, of anyone; "" where all is well."""
    keeper, held = writer(), line()
    if keeper is None or not held.key:
        return ""
    keeper.settle(held, SETTLED_S)
    return held.trouble or keeper.trouble


def clock(when: float) -> str:
    """The time of day where the browser is, with the day where that is another one."""
    west = st.context.timezone_offset
    zone = None if west is None else timezone(-timedelta(minutes=west))
    there, now = (datetime.fromtimestamp(each, zone) for each in (when, time.time()))
    return f"{there:%H:%M}" if there.date() == now.date() else f"{there.day} {there:%B}, {there:%H:%M}"


@st.fragment
def take_up() -> None:
    """Bring this tab's work back in the first run of a session, and have it kept from then on."""
    held: Line | None = session.kept(LINE)
    begins = held is None
    if held is None:
        held = Line(key=_cookie(KEY_COOKIE) if writer() else "", shown=session.project())
        if writer() and not KEY.fullmatch(held.key):
            held.key = secrets.token_hex(32)
        session.keep(LINE, held)
        session.store().keeper = partial(_hand, held)
    said = _page(key="autosave.tab", data={"key": held.key, "moved": held.moved}, on_tab_change=lambda: None).tab
    if said == "":  # it could not hold the key
        held.key, held.trouble = "", NO_COOKIES
    met = not held.place and bool(re.fullmatch("[0-9a-f]{16}", said or ""))
    if met:
        held.place = f"tab-{said}"
    if begins:
        _begin(held)
    elif met and held.key:
        _meet(held)


def _begin(held: Line) -> None:
    """The first run of a session: what this tab was at, as far as one knows."""
    if held.place:  # the page was open before its session: the server was restarted, or had forgotten it
        session.store().returned = bool(held.key)
        if held.key and shelf().has(held.key, held.place):
            _bring(held, held.place, CUT_OFF)
        else:
            session.keep(NOTICE, Notice(f"{CUT_OFF} {'Nothing was kept of it.' if held.key else OFF}"))
    elif held.key:
        front = f"tab-{_cookie(TAB_COOKIE)}"
        last = shelf().heads(held.key, "tab")
        if shelf().has(held.key, front):
            _bring(held, front)
        elif last:
            _bring(held, last[0].place)


def _meet(held: Line) -> None:
    """The tab has said which one it is: its own work instead of another's, or a line of its own for a new one."""
    opened = held.opened
    known = shelf().has(held.key, held.place)
    if known and (opened is None or opened.place != held.place):
        _bring(held, held.place)
        st.rerun()
    held.stamp = opened.stamp if known and opened is not None else ""
    notice: Notice | None = session.kept(NOTICE)
    if not known and opened is not None and notice is not None and notice.project is not None:
        words = f"{notice.words} Where another tab has it too, each goes its own way from here."
        session.keep(NOTICE, replace(notice, words=words))
    if session.project() is not held.shown:
        _hand(held, session.store())
    elif not known and opened is not None:
        _hand(held, session.store(), opened.time)
    if session.kept(NOTICE) is not notice:
        st.rerun()


def _bring(held: Line, place: str, before: str = "") -> None:
    """Put the work kept at ``place`` in force and say so, or why it cannot be."""
    texts = [""]
    try:
        head, texts = shelf().get(held.key, place)
        new = project_from_toml(texts[0])
    except RobomillError as exc:
        if texts[0]:
            shelf().set_aside(held.key, place)
        session.keep(NOTICE, Notice(f"{before} Your work could not be opened. {exc}".strip(), refused=texts[0]))
        return
    now = session.store()
    if now.project is held.shown:
        now.project, now.older = new, texts[:0:-1]
    else:  # something was changed meanwhile: undo leads back to it
        session.replace(new)
    now.revision = int(time.time())  # tables start afresh, whatever the page still holds of theirs
    held.opened, held.shown, held.stamp, held.saved = head, new, head.stamp, head.time
    if before or not untouched(new):
        session.keep(NOTICE, Notice(f"{before} Your work of {clock(head.time)} is back.".strip(), new))


def untouched(project: Project) -> bool:
    """Whether a project is a preset as it came."""
    return project.preset in presets() and project.digest() == Project(preset_setup(project.preset)).digest()


def shelf() -> Shelf:
    """Where the work of this server's browsers is kept. Raises ProjectError where nothing is kept."""
    held = writer()
    if held is None:
        raise ProjectError(OFF)
    return held.shelf


def _cookie(name: str) -> str:
    return st.context.cookies.to_dict().get(name, "")


def _hand(held: Line, what: Store, of: float = 0.0) -> None:
    """Have the session's project written, as work ``of`` an earlier time (s) where one is given."""
    keeper = writer()
    if keeper is not None:
        keeper.hand(held, Work(what.project, tuple(what.past), tuple(what.older), of))


def notices() -> None:
    """What is to be said, with what can be done about it."""
    held = line()
    if held.overtaken is not None:
        words = (
            f"Another tab went on with this work at {clock(held.overtaken.time)}; this one goes its own way from here."
        )
        session.keep(NOTICE, Notice(words, instead=held.overtaken))
        held.overtaken = None
    if why := refusal():
        st.markdown(f":material/cloud_off: {as_markdown(f'{why} Save takes it away.')}")
    notice: Notice | None = session.kept(NOTICE)
    if session.drop(HEARD) and notice is not None:
        words = f"{notice.words} The change that was on its way is in it."
        session.keep(NOTICE, notice := replace(notice, words=words, project=session.project()))
    if notice is None or (notice.project is not None and notice.project.setup is not session.project().setup):
        return
    if notice.project is not None and not notice.page:
        session.keep(NOTICE, notice := replace(notice, page=session.store().page))
    elif notice.page and notice.page != session.store().page:
        session.drop(NOTICE)
        return
    with st.container(horizontal=True, vertical_alignment="center", gap="small", key="autosave-notice"):
        st.markdown(f":material/history: {as_markdown(notice.words)}", width="stretch")
        if notice.instead is not None:
            _answer("Take the other", "swap_horiz", bring_kept, notice.instead.place)
        elif notice.project is not None and not untouched(notice.project):
            _answer("Discard", "delete", session.open_preset, DEFAULT_PRESET)
        elif notice.refused:
            file = f"my-work{SUFFIX}"
            st.download_button("Take it away", notice.refused, file, "application/toml", on_click="ignore")
        _answer("OK", "check")


def _answer(label: str, icon: str, do: Callable[..., Any] | None = None, *arguments: Any) -> None:
    def act() -> None:
        if do is not None:
            do(*arguments)
        session.drop(NOTICE)

    key = f"autosave.{icon}"
    inputs.button(label, key, icon, act, type="tertiary")


def bring_kept(place: str) -> None:
    """Open what this browser keeps at ``place``; undo leads back. Raises a RobomillError where it cannot be opened."""
    now = session.project()
    text = shelf().get(line().key, place)[1][0]
    session.open_project(project_from_toml(text, now.view, now.maps, now.bench))
