"""Improve: which joint is worth stiffening for the project's cut?"""

import streamlit as st

from robomill import ui
from robomill.ui.improve import stiffen

project = ui.begin("Improve")
setup, unit = project.setup, project.view.length
joints = setup.robot.joint_numbers
title = f"Improve · {setup.name}"

result = ui.attempt(ui.result, setup)
if result is None or result.worst < 0 or result.setup.digest() != setup.digest():
    ui.headline(title, "There is no cut to improve yet.")
    ui.note("The cut has no result: mend what is named above, or bring the path within reach on the Toolpath page.")
    st.stop()
changed = stiffen.changed(result)
heading = st.container()
ranked = ui.attempt(stiffen.found, setup)
with heading:
    if ranked is None:
        ui.headline(title, stiffen.meanwhile(result), changed)
        st.stop()
    ui.headline(title, stiffen.sentence(ranked, joints, unit), f"{stiffen.together(ranked, joints)} {changed}".strip())
ui.tiles(stiffen.tiles(ranked, joints, unit))
left, right = ui.split([1, 1.7], "page", gap="large")
with left, st.container(border=True):
    st.markdown("**Each joint alone twice as stiff**")
    stiffen.remedies(ranked, joints, unit)
with right, st.container(border=True):
    stiffen.ranking(ranked, joints, unit, ui.dark())
