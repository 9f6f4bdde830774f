"""What was typed: how widgets are seeded, refused input that stays with its sentence, how a number was understood,
edits of a page cut off, and what was not typed at all.

What is put into a widget is with the browser a moment later. Until then whatever the browser says (a tick, another
click) holds what stood there before, and Streamlit takes that for typed.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import streamlit as st

from robomill.errors import RobomillError
from robomill.spelled import units_beside
from robomill.ui import session
from robomill.ui.markup import as_markdown

_ROW: ContextVar[list[str] | None] = ContextVar("row", default=None)
BEHIND_S = 5.0  # by then a browser has drawn what it was told
MOST_BEHIND = 8  # values: a slider says many in that time
NOTHING = session.Told(None)
HEARD = "typed.heard"  # kept once an edit was taken that no server had answered


def seed(key: str, current: Any) -> Any:
    """Show ``current`` in the widget ``key``, unless something refused is waiting there to be mended; what it shows."""
    held = session.store()
    waiting = held.refused.get(key)
    known = key in st.session_state and key in held.seeded
    shown = waiting[0] if waiting is not None else current
    # Written only where it differs: a slider that is being dragged would jump otherwise.
    if not unheard(key) and (not known or st.session_state[key] != shown):
        if known:
            _tell(held, key, shown)
        st.session_state[key] = shown
        held.seeded.add(key)
    return shown


def _tell(held: session.Store, key: str, shown: Any) -> None:
    """Note that ``shown`` is put into the widget ``key`` over what it holds."""
    now, last = time.monotonic(), held.told.get(key, NOTHING)
    behind = last.before if last.when > now - BEHIND_S else ()
    held.told[key] = session.Told(shown, (st.session_state[key], *behind)[:MOST_BEHIND], now)


def news(key: str, take: Callable[[], None]) -> Callable[[], None]:
    """``take``, for what was typed into the widget ``key`` and not for what it held before it was given its value."""

    def taken() -> None:
        held = session.store()
        told = held.told.get(key, NOTHING)
        behind = held.said is not None and held.said.get(key, 0.0) < told.when > time.monotonic() - BEHIND_S
        if not (behind and st.session_state[key] in told.before):
            take()

    return taken


def unheard(key: str) -> bool:
    """Whether the page was open before its session, and the browser may hold an edit here that no server took."""
    held = session.store()
    return held.returned and key not in held.seeded


def heard(key: str, shown: Any, take: Callable[[], None]) -> None:
    """Take the edit that was made while the server was gone, if this is one; then the sentence of a refusal."""
    if unheard(key):
        session.store().seeded.add(key)
        if key in st.session_state and st.session_state[key] != shown:
            take()
            session.keep(HEARD, True)
            st.rerun()
    sentence(key)


def sentence(key: str) -> None:
    """The reason why the input at ``key`` was refused, if it was."""
    waiting, row = session.store().refused.get(key), _ROW.get()
    if waiting is not None and row is not None:
        row.append(waiting[1])
    elif waiting is not None:
        _refusal(waiting[1])


@contextmanager
def said_below() -> Iterator[None]:
    """Refusals of the inputs drawn meanwhile stand beneath them all: a narrow column has no room for a sentence."""
    row: list[str] = []
    before = _ROW.set(row)
    try:
        yield
    finally:
        _ROW.reset(before)
    around = _ROW.get()
    for reason in row:
        _refusal(reason) if around is None else around.append(reason)


def _refusal(reason: str) -> None:
    st.error(as_markdown(reason), icon=":material/error:")


def refuse(key: str, typed: Any, reason: str) -> None:
    """Keep refused input and its reason, to be shown under the widget ``key``."""
    session.store().refused[key] = (typed, reason)


def note(key: str, shown: str) -> None:
    """How the number ``shown`` in the widget ``key`` was understood when it was typed, if that is to be said."""
    read_as, words = session.store().read_as.get(key, ("", ""))
    if words and read_as == shown:
        st.caption(as_markdown(words))


def accept(key: str) -> None:
    """Forget an earlier refusal at ``key``."""
    session.store().refused.pop(key, None)


def submit(key: str, typed: Any, action: Callable[[], None]) -> None:
    """Do ``action``; a refusal keeps ``typed`` and its sentence at ``key``, success forgets an earlier one."""
    try:
        with units_beside():
            action()
    except RobomillError as exc:
        refuse(key, typed, str(exc))
    else:
        accept(key)
