"""Pages that go on speaking until they are gone, in a part and as a whole, and one that takes its time to come."""

from __future__ import annotations

import time

import streamlit as st

from robomill.ui import session
from robomill.ui.entry import inputs
from robomill.ui.serving.asked import heed_pages

heed_pages()
SPEAKS = """
export default function ({ setTriggerValue }) {
  const timer = setInterval(() => setTriggerValue('said', 1), 30);
  return () => clearInterval(timer);
}
"""
ECHOES = """
export default function ({ setTriggerValue }) {
  const say = () => { for (const wait of [0, 3, 12, 40]) setTimeout(() => setTriggerValue('said', 1), wait); };
  document.addEventListener('click', say, true);
  return () => document.removeEventListener('click', say, true);
}
"""
echo = st.components.v2.component("echo", html="<i></i>", js=ECHOES)
speak = st.components.v2.component("speak", html="<i></i>", js=SPEAKS)


def _speaks() -> None:
    speak(key="speak", on_said_change=lambda: None)
    st.caption("speaking")


def whole() -> None:
    """Each word of this page asks for the whole of it."""
    _speaks()


@st.fragment
def part() -> None:
    """Each word of this page asks for this part of it."""
    _speaks()


def other() -> None:
    """A page of some length."""
    for number in range(15):
        time.sleep(0.02)
        st.caption(f"other {number}")


def _clicks(looks: int = 0) -> int:
    """A button, and how often what it does was done; that looks into the session so often, and takes 5 ms for each."""

    def more() -> None:
        for _ in range(looks):
            time.sleep(0.005)
            st.session_state["looks"] = st.session_state.get("looks", 0) + 1
        st.session_state["count"] = st.session_state.get("count", 0) + 1

    st.button("more", on_click=more)
    return int(st.session_state.get("count", 0))


def clicked() -> None:
    """A part that speaks, beside a button that is heard by the whole page."""
    part()
    count = _clicks()
    for number in range(6):
        time.sleep(0.01)
        st.caption(f"click {count}, line {number}")


@st.fragment(run_every=0.01)
def _ticks() -> None:
    st.caption("ticking")


def ticking() -> None:
    """A part that ticks, as a progress bar does, beside a button."""
    _ticks()
    st.caption(f"done {_clicks()} times")


def slow() -> None:
    """A page that speaks as a whole on each click, beside a button whose work takes its time."""
    echo(key="echo", on_said_change=lambda: None)
    st.caption(f"done {_clicks(looks=20)} times")


def typed() -> None:
    """A page that speaks as a whole on each click, beside a box: what was typed is said again."""
    echo(key="echo", on_said_change=lambda: None)

    def take() -> None:
        time.sleep(0.01)
        st.session_state["taken"] = [*st.session_state.get("taken", []), st.session_state["box"]]

    st.text_input("box", key="box", on_change=take)
    st.button("less", on_click=lambda: None)
    st.caption("taken " + " ".join(st.session_state.get("taken", [])))


def put() -> None:
    """A page that speaks as a whole on each click, beside a box into which a button puts another number. What was typed
    into it is said."""
    echo(key="echo", on_said_change=lambda: None)
    st.button("more", on_click=lambda: session.keep("number", session.kept("number", 0) + 1))
    number = session.kept("number", 0)
    inputs.text("box", "box", str(number), lambda text: session.keep("typed", [*session.kept("typed", []), text]))
    for line in range(6):
        time.sleep(0.01)
        st.caption(f"number {number}, line {line}")
    st.caption("typed: " + " ".join(session.kept("typed", [])))


st.navigation(
    [
        st.Page(other, default=True),
        st.Page(whole),
        st.Page(part),
        st.Page(clicked),
        st.Page(ticking),
        st.Page(slow),
        st.Page(typed),
        st.Page(put),
    ]
).run()
