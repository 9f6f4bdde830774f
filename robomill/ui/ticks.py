"""Ticks of progress that come from a page which has been left are not heeded.

A browser that goes to another page ticks on for the old one until the new one begins. Streamlit folds such a tick into
the request for the new page and takes the tick's page for both, so the click on the new page is lost.
"""

from collections.abc import Callable
from functools import wraps
from typing import Any

from streamlit.runtime.app_session import AppSession

ASKED = "_page_asked_for"


def heeding_pages(request: Callable[..., None]) -> Callable[..., None]:
    """``request`` (of a session, for a run that a browser asks for), but for ticks of a page that has been left."""

    @wraps(request)
    def heeded(session: Any, asked: Any) -> None:
        page = "" if asked is None else asked.page_script_hash
        if page and asked.is_auto_rerun and page != getattr(session, ASKED, page):
            return
        if page and not asked.is_auto_rerun:
            setattr(session, ASKED, page)
        request(session, asked)

    return heeded


def heed_pages() -> None:
    """Have every session of this server heed them; once is enough."""
    if not hasattr(AppSession.request_rerun, "__wrapped__"):
        AppSession.request_rerun = heeding_pages(AppSession.request_rerun)  # type: ignore[method-assign]
