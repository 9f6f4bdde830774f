"""A page with every kind of input, drawn while ticks break its runs off: what nobody has touched may take nothing."""

from __future__ import annotations

import time
from functools import partial
from typing import Any

import streamlit as st

from robomill.ui.entry import inputs
from robomill.ui.entry.box import NumberBox

OPTIONS = {name: name for name in "abc"}
BROKEN_OFF = (3, 7, 11)  # ticks at which the whole page is drawn anew
taken: list[str] = st.session_state.setdefault("taken", [])


def take(name: str, known: Any, new: Any) -> None:
    if new != known:  # what is known already changes no project
        taken.append(f"{name}: {new}")


@st.fragment(run_every=0.02)
def tick() -> None:
    st.session_state.ticks = st.session_state.get("ticks", 0) + 1
    if st.session_state.ticks in BROKEN_OFF:
        st.rerun()
    done = st.session_state.ticks > max(BROKEN_OFF) + 10
    st.caption(f"{'done' if done else 'on'}; taken: {'; '.join(taken) or 'nothing'}")


tick()
time.sleep(0.05)
for i in range(4):
    _, left, right = st.columns([0.14, 1, 0.5])
    with left:
        inputs.slider("slider", f"slider{i}", inputs.Span(-180.0, 180.0, 0.5), 0.0, partial(take, "slider", 0.0))
        inputs.value(f"box{i}", NumberBox("box"), 7.0, partial(take, "box", 7.0))
        inputs.value(f"optional{i}", NumberBox("optional", optional=True), 7.0, partial(take, "optional", 7.0))
        inputs.text("text", f"text{i}", "typed", partial(take, "text", "typed"))
        inputs.text("lines", f"lines{i}", "typed", partial(take, "lines", "typed"), lines=3)
        inputs.stops("stops", f"stops{i}", OPTIONS, "b", partial(take, "stops", "b"))
    with right:
        inputs.switch("switch", f"switch{i}", True, partial(take, "switch", True))
        inputs.choice("row", f"row{i}", OPTIONS, "b", partial(take, "row", "b"))
        inputs.choice("list", f"list{i}", OPTIONS, "b", partial(take, "list", "b"), inputs.LISTED)
        inputs.choice("stack", f"stack{i}", OPTIONS, "b", partial(take, "stack", "b"), inputs.Look(stacked=True))
        inputs.several("several", f"several{i}", OPTIONS, ["b"], partial(take, "several", ["b"]))
        inputs.several("pills", f"pills{i}", OPTIONS, ["b"], partial(take, "pills", ["b"]), inputs.PLAIN)
    time.sleep(0.02)
