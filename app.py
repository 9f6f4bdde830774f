"""The app. Streamlit serves it as ``app`` says (``robomill/ui/serving/front.py``), and runs this file as start page."""

from pathlib import Path

import streamlit as st
from streamlit.starlette import App

from robomill import ui
from robomill.learn.worked import of_the_run
from robomill.ui.judged.verdict import NOT_COUNTED
from robomill.ui.judged.worked import mathematics
from robomill.ui.posed.arm import arm_at
from robomill.ui.serving import front
from robomill.ui.start import carved, story
from robomill.ui.toolpath.doors import take_file
from robomill.units import format_limit

HEIGHT, ASPECT = 285, 1.1  # of the pictures; of the arm's frame: it is whole in the narrowest column


def start() -> None:
    """What this is, a program to be checked, the reference groove finished before anyone has clicked."""
    project = ui.begin("Start")
    setup, unit, dark = project.setup, project.view.length, ui.dark()
    story.purpose()
    head, waits = st.container(), st.container(key="start-waits")
    with waits:
        result = ui.attempt(ui.result, setup)
    if result is None:
        refused = "Where a number was refused, undo the last change, or mend it on the Robot, Toolpath or Milling page."
        with head:
            ui.headline(f"Start · {setup.name}", "Nothing is computed yet.", refused)
        story.doors(take_file)
        st.stop()

    lead = f"{ui.verdict_beside(result, unit)} {story.cause(result, unit)}".strip()
    with head:
        ui.headline(f"Start · {setup.name}", ui.verdict_headline(result, unit), lead)
        ui.open_question(result)
    ui.verdict_row(result, unit)
    mathematics(lambda: of_the_run(result, result.decided.sample), "start")

    left, middle, right = ui.split([1, 1.2, 0.8], "finished", gap="small")
    with left, st.container(border=True, height="stretch"):
        index = result.decided.sample
        if index >= 0:
            arm_at(result, index, "start-arm", HEIGHT, aspect=ASPECT)
        else:
            ui.note("The arm is drawn where the verdict is decided: nothing of this cut is judged yet.")
    with middle, st.container(border=True, height="stretch"):
        story.groove_picture(result, project.view, HEIGHT, dark)
    with right:
        story.doors(take_file)

    carved.strip(unit, dark)

    with st.expander(story.why(setup, unit), key="start.open.why"):
        left, right = ui.split([1.55, 1], "rests", gap="large")
        with left:
            story.where_from(setup)
        with right:
            story.beside_the_paper(project)
        ui.note(
            f"{NOT_COUNTED} Robot: {setup.robot.title or setup.robot.name}. Tolerance "
            f"{format_limit(setup.tolerance, unit)}. Fingerprint of this run: {setup.digest()[:12]}."
        )


if __name__ == "__main__":
    start()
else:
    app = App(Path(__file__).resolve(), middleware=front.MIDDLEWARE, lifespan=front.opened)
