"""The page that a browser asked for last is the one it gets, whatever the page that it has left still says.

From the click on a link until the new page begins, a browser goes on with the old one: a part that ticks, a picture
that looks whether it is drawn, a slider that says its value a moment late. Each such message names the old page, and
Streamlit takes it at its word: it draws the old page once more instead of the new one, or a part of it, for which the
browser puts away what it has of the new one. And what is typed into a part just while the page is drawn anew comes for
a part that is there no more: Streamlit drops it, with what was typed.
"""

from collections.abc import Callable
from functools import wraps
from typing import Any

from streamlit.runtime.app_session import AppSession

ASKED = "_page_asked_for"


def heeding_pages(request: Callable[..., None]) -> Callable[..., None]:
    """``request`` (of a session, for a run that a browser asks for), but for what comes from a page that has been left:
    a part of that page is not run any more, and in place of the whole of it the page that was asked for is run. In
    place of a part that is there no more the whole page is run, so that what was typed into it is heard."""

    @wraps(request)
    def heeded(session: Any, said: Any) -> None:
        if said is not None:
            if not said.fragment_id and not said.widget_states.widgets:  # only a way to another page comes without both
                setattr(session, ASKED, said.page_script_hash)
            asked = getattr(session, ASKED, "")
            if asked and said.page_script_hash not in ("", asked):
                if said.fragment_id:
                    return
                said.page_script_hash = asked
            if said.fragment_id and not said.is_auto_rerun and not session.has_fragment(said.fragment_id):
                said.fragment_id = ""
        request(session, said)

    return heeded


def heed_pages() -> None:
    """Have every session of this server heed them; once is enough."""
    if not hasattr(AppSession.request_rerun, "__wrapped__"):
        AppSession.request_rerun = heeding_pages(AppSession.request_rerun)  # type: ignore[method-assign]
