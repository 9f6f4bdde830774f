"""Tells Python when the person changes between light and dark, which Streamlit by itself does not."""

from __future__ import annotations

import streamlit as st

KEY = "theme.watch"
# What the page looks like is read off the page: the figures must match what is seen. A change asks for one rerun,
# and the rerun carries the new theme. Nothing is sent while nothing changes.
_JS = """
export default function (component) {
  const { setTriggerValue } = component;
  const page = document.querySelector('[data-testid="stApp"]');
  if (!page) return;
  const look = () => getComputedStyle(page).backgroundColor;
  let seen = look();
  const timer = setInterval(() => {
    const now = look();
    if (now !== seen) { seen = now; setTriggerValue('changed', now); }
  }, 400);
  return () => clearInterval(timer);
}
"""

_component = st.components.v2.component("robomill_theme_watch", html="<i></i>", css="i { display: none }", js=_JS)


def theme_watch() -> None:
    """Mount the watch; it takes no room."""
    _component(key=KEY, on_changed_change=lambda: None, height=1)
