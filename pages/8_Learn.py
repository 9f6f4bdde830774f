"""The lesson for a class: why a robot bends sideways; and what of the paper is reproduced."""

import streamlit as st

from robomill import ui
from robomill.ui.learn import edge, lesson, mathematics

project = ui.begin("Learn")
robot = project.setup.robot

stood = ui.attempt(lesson.stand, project)
where = f" The arm stands {stood[1]}." if stood is not None and stood[0].pose.reached else ""
ui.note(f"Why does a robot not go where it is pushed? A lesson with {robot.title or robot.name}.{where}")
found = None if stood is None else stood[0]
if found is None or not found.pose.reached:
    ui.note(
        "This robot reaches nothing with its tool vertical, so there is no pose to ask about. Choose another robot."
    )
else:
    lesson.question(found)
    st.divider()
    edge.edge(found)
    st.divider()
    mathematics.equations(found.pose, lesson.Push.of(found.pose.C))
st.divider()
mathematics.reproduced()
