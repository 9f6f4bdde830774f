"""Two pages that go on speaking until they are gone, in a part and as a whole, and one that takes its time to come."""

from __future__ import annotations

import time

import streamlit as st

from robomill.ui.serving.asked import heed_pages

heed_pages()
SPEAKS = """
export default function ({ setTriggerValue }) {
  const timer = setInterval(() => setTriggerValue('said', 1), 30);
  return () => clearInterval(timer);
}
"""
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


st.navigation([st.Page(other, default=True), st.Page(whole), st.Page(part)]).run()
