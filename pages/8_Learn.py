"""Lessons for a class: why a robot bends sideways, eight lessons, exercises; and what of the paper is reproduced."""

import streamlit as st

from robomill import ui
from robomill.ui.learn import edge, exercises, lesson, mathematics, steps

project = ui.begin("Learn")
robot = project.setup.robot
now = steps.where()

stood = ui.attempt(lesson.stand, project)
place = "" if stood is None or not stood[0].pose.reached else stood[1]
found = None if stood is None else stood[0]
if not now.number and not now.projector:
    where = f" The arm stands {place}." if place else ""
    name = robot.title or robot.name
    ui.note(f"Why does a robot not go where it is pushed? The robot of these lessons: {name}.{where}")
steps.row(now)
if now.number < 0:
    exercises.show(robot.name)
elif found is None or not found.pose.reached:
    ui.note(
        "This robot reaches nothing with its tool vertical, so there is no pose to ask about. Choose another robot."
    )
elif now.number:
    steps.show(found, now)
    steps.to_hand_out(found, place, now)
else:
    lesson.question(found)
    st.divider()
    edge.edge(found)
    st.divider()
    steps.to_hand_out(found, place, now)
if not now.number:
    st.divider()
    mathematics.reproduced()
