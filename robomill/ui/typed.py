"""What was typed: how widgets are seeded, refused input that stays with its sentence, how a number was understood,
edits of a page cut off."""

from collections.abc import Callable
from typing import Any

import streamlit as st

from robomill.errors import RobomillError
from robomill.ui import session
from robomill.ui.markup import as_markdown

HEARD = "typed.heard"  # kept once an edit was taken that no server had answered


def seed(key: str, current: Any) -> Any:
    """Show ``current`` in the widget ``key``, unless something refused is waiting there to be mended; what it shows."""
    held = session.store()
    waiting = held.refused.get(key)
    known = key in st.session_state and key in held.seeded
    shown = waiting[0] if waiting is not None else current
    # Written only where it differs: a slider that is being dragged would jump otherwise.
    if not unheard(key) and (not known or st.session_state[key] != shown):
        st.session_state[key] = shown
        held.seeded.add(key)
    return shown


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
    waiting = session.store().refused.get(key)
    if waiting is not None:
        st.error(as_markdown(waiting[1]), icon=":material/error:")


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
        action()
    except RobomillError as exc:
        refuse(key, typed, str(exc))
    else:
        accept(key)
