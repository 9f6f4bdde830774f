"""The start page: the paper's milling test, finished, before anyone has clicked anything."""

import streamlit as st

from robomill import ui
from robomill.simulation.stations import nearest_judged
from robomill.ui.arm import arm_at
from robomill.ui.start import story
from robomill.ui.verdict import NOT_COUNTED
from robomill.units import format_limit

HEIGHT = 430


project = ui.begin("Start")
setup, unit, dark = project.setup, project.view.length, ui.dark()
result = ui.attempt(ui.result, setup)
if result is None:
    ui.note(
        "Nothing is computed yet. Where numbers above were refused, undo the last change, or mend it on the Robot, "
        "Toolpath or Milling page."
    )
    st.stop()

ui.headline(setup.name, ui.verdict_sentence(result, unit), story.cause(result, unit))
ui.open_question(result)
ui.tiles(ui.verdict_tiles(result, unit))

left, right = ui.split([1, 1.18], "pictures")
with left, st.container(border=True, height="stretch"):
    index = nearest_judged(result, project.view.station * float(result.path.s[-1]))
    if index >= 0:
        arm_at(result, index, "start-arm", HEIGHT)
with right, st.container(border=True, height="stretch"):
    story.groove_picture(result, project.view, HEIGHT, dark)

st.subheader("What this rests on")
left, right = ui.split([1.55, 1], "rests", gap="large")
with left:
    story.where_from(setup)
with right:
    story.beside_the_paper(project)

st.subheader("Where to go from here")
story.doors()
ui.note(
    f"{NOT_COUNTED} Robot: {setup.robot.title or setup.robot.name}. Tolerance {format_limit(setup.tolerance, unit)}. "
    f"Fingerprint of this run: {setup.digest()[:12]}."
)
