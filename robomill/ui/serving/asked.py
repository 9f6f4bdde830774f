"""The page that a browser asked for last is the one it gets, whatever the page that it has left still says.

From the click on a link until the new page begins, a browser goes on with the old one: a part that ticks, a picture
that looks whether it is drawn, a slider that says its value a moment late. Each such message names the old page, and
Streamlit takes it at its word: it draws the old page once more instead of the new one, or a part of it, for which the
browser puts away what it has of the new one. And what is typed into a part just while the page is drawn anew comes for
a part that is there no more: Streamlit drops it, with what was typed.

A click beside a part that speaks in the same instant comes as that part's own message: Streamlit runs the part alone,
and the click, which stands in it, changes nothing that is drawn. A part that ticks as something is clicked brings the
click too, which then comes by itself a moment later: Streamlit does what was asked for twice. And a part that speaks
just as the whole page has been drawn, while the last of the drawing is still on its way, has that forgotten: Streamlit
starts the part's own run, and hears nothing more of the run before it. The page then stays as it was, or without its
end.

What was clicked or typed is forgotten where the page says something else before Streamlit has called what it does, and
what it does is broken off half way where that comes meanwhile: each look into the session is a place where a run gives
way. Streamlit counts it as heard all the same. (A run that is asked for while another one goes on waits until that one
gives way: ``runner.fastReruns`` is off. On, a run that was told to stop takes what it was asked for with it, and two
runs change one session at a time.)
"""

import asyncio
import time
from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from typing import Any

from streamlit.proto.WidgetStates_pb2 import WidgetStates
from streamlit.runtime.app_session import AppSession
from streamlit.runtime.scriptrunner import get_script_run_ctx
from streamlit.runtime.scriptrunner.script_runner import ScriptRunner
from streamlit.runtime.state.common import user_key_from_element_id

from robomill.ui import session as sessions

ASKED = "_page_asked_for"
LEFT = "_parts_registered_before"
SAID = "_boxes_said_last"
LAST_WORDS_S = 0.002
CLICKS = ("trigger_value", "string_trigger_value", "chat_input_value", "json_trigger_value")


def _is_elsewhere(session: Any, page: str) -> bool:
    """Whether ``page`` is not the one that the browser asked for last; one without a name is."""
    asked = getattr(session, ASKED, "")
    return bool(asked) and page not in ("", asked)


def _is_click(box: Any) -> bool:
    """Whether it is said of a box that it was clicked, and not what stands in it."""
    return box.WhichOneof("value") in CLICKS


def _was_left(session: Any, part: str) -> bool:
    """Whether a part was there before the last way to another page, and that page has no such part so far."""
    return session.has_fragment(part) and part not in session._fragment_storage.ids_registered_after(
        getattr(session, LEFT, 0)
    )


def _clicked_beside(session: Any, said: Any) -> bool:
    """Whether a message of a part holds a click on what stands elsewhere on the page."""
    known = session._session_state._new_widget_state.widget_metadata
    return any(
        _is_click(box) and box.id in known and known[box.id].fragment_id != said.fragment_id
        for box in said.widget_states.widgets
    )


def _without_clicks(said: Any) -> None:
    """Take out of the message of a tick what was clicked: its own message is on its way."""
    boxes = [box for box in said.widget_states.widgets if not _is_click(box)]
    if len(boxes) < len(said.widget_states.widgets):
        del said.widget_states.widgets[:]
        said.widget_states.widgets.extend(boxes)


def _of_clicks(wanted: Any) -> Any:
    """What is ``wanted`` of a run, with nothing said of its boxes but what was clicked."""
    clicks = WidgetStates(widgets=[box for box in wanted.widget_states.widgets if _is_click(box)])
    return replace(wanted, widget_states=clicks)


def _note_news(session: Any, said: Any) -> None:
    """Note of which boxes a browser says something new: those that it last said otherwise. Where that is only what they
    were told, and nothing was clicked, every one of them: one of them is why it speaks."""
    boxes = {box.id: box for box in said.widget_states.widgets if not _is_click(box)}
    clicked = len(boxes) < len(said.widget_states.widgets)
    last = getattr(session, SAID, {})
    setattr(session, SAID, boxes)
    if sessions.KEY not in session._session_state:
        return
    store, now = session._session_state[sessions.KEY], time.monotonic()
    keys = {name: str(user_key_from_element_id(name)) for name in boxes}
    new = {key for name, key in keys.items() if boxes[name] != last.get(name)}
    told = {key for name, key in keys.items() if _as_told(boxes[name], store.told.get(key))}
    if new <= told and not (clicked or said.is_auto_rerun):
        new = set(keys.values())
    store.said = {**(store.said or {}), **dict.fromkeys(new, now)}


def _as_told(box: Any, told: sessions.Told | None) -> bool:
    """Whether a box holds what was put into it."""
    return told is not None and getattr(box, box.WhichOneof("value") or "id") == told.put


def _is_run(session: Any, said: Any) -> bool:
    """Whether what a browser says is to be run; ``said`` becomes what it asks for."""
    if not said.fragment_id and not said.widget_states.widgets:  # only a way to another page comes without both
        setattr(session, ASKED, said.page_script_hash)
        setattr(session, LEFT, session._fragment_storage.registration_sequence())
    elsewhere = _is_elsewhere(session, said.page_script_hash)
    if not said.fragment_id:
        if elsewhere:
            said.page_script_hash = getattr(session, ASKED)
        return True
    if elsewhere or _was_left(session, said.fragment_id):
        return False
    if said.is_auto_rerun:
        _without_clicks(said)
    elif not session.has_fragment(said.fragment_id) or _clicked_beside(session, said):
        said.fragment_id = ""
    return True


def heeding_pages(request: Callable[..., None]) -> Callable[..., None]:
    """``request`` (of a session, for a run that a browser asks for), but for what comes from a page that has been left:
    a part of that page is not run any more, and in place of the whole of it the page that was asked for is run. In
    place of a part that is there no more, or in whose message something beside it was clicked, the whole page is run,
    so that what was typed or clicked is heard."""

    @wraps(request)
    def heeded(session: Any, said: Any) -> None:
        if said is not None:
            _note_news(session, said)
        if said is None or _is_run(session, said):
            request(session, said)

    return heeded


def awaiting_drawing(create: Callable[..., None]) -> Callable[..., None]:
    """``create`` (of a session, for a run that needs a runner of its own), but that a part waits for the last words of
    a run that has ended: they come through the same event loop, and the session lets go of that run behind them. Where
    another run was asked for meanwhile, what stands in its boxes is the newer, and its page the one that is run."""

    @wraps(create)
    def awaited(session: Any, wanted: Any) -> None:
        ended = session._scriptrunner
        if ended is None or not wanted.fragment_id:
            create(session, wanted)
            return

        def later() -> None:
            now = session._scriptrunner
            if now is ended:
                asyncio.get_running_loop().call_later(LAST_WORDS_S, later)
            elif _is_elsewhere(session, wanted.page_script_hash) or not session.has_fragment(wanted.fragment_id):
                return
            elif now is None or not now.request_rerun(_of_clicks(wanted)):
                awaited(session, wanted)

        later()

    return awaited


def hearing_out(give_way: Callable[..., None]) -> Callable[..., None]:
    """``give_way`` (of a runner, to what is asked for meanwhile), but only once what this run was asked for is heard,
    and what it does is done: behind that, before anything is drawn, is time enough."""

    @wraps(give_way)
    def behind(runner: Any) -> None:
        run = get_script_run_ctx(suppress_warning=True)
        if run is None or run.has_script_started:
            give_way(runner)

    return behind


def heed_pages() -> None:
    """Have every session of this server heed them; once is enough."""
    if not hasattr(AppSession.request_rerun, "__wrapped__"):
        AppSession.request_rerun = heeding_pages(AppSession.request_rerun)  # type: ignore[method-assign]
        AppSession._create_scriptrunner = awaiting_drawing(  # type: ignore[method-assign]
            AppSession._create_scriptrunner
        )
        ScriptRunner._maybe_handle_execution_control_request = hearing_out(  # type: ignore[method-assign]
            ScriptRunner._maybe_handle_execution_control_request
        )
