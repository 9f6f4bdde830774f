"""The lesson for a class: why a robot bends sideways; and what of the paper is reproduced."""

from __future__ import annotations

import streamlit as st

from robomill import ui
from robomill.ui.learn import edge as learn_edge
from robomill.ui.learn import lesson as learn_panel
from robomill.ui.learn import mathematics as learn_mathematics

project = ui.begin("Learn")
robot = project.setup.robot

ui.note(
    f"Why does a robot bend sideways? A lesson with {robot.title or robot.name}; one question, one picture, one reason."
)
found = ui.attempt(learn_panel.stand, robot)
if found is None or not found.reached:
    ui.note(
        "This robot reaches nothing with its tool vertical, so there is no pose to ask about. Choose another robot."
    )
else:
    learn_panel.question(found)
    st.divider()
    learn_edge.edge(found)
    st.divider()
    learn_mathematics.equations(found)
st.divider()
learn_mathematics.reproduced()
