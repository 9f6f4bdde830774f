"""Milling: how hard does it push, where does the tip go, what will be measured; one scrubber links the three."""

import streamlit as st

from robomill import ui
from robomill.ui.milling import body as panel

project = ui.begin("Milling")
setup, unit, dark = project.setup, project.view.length, ui.dark()
result = ui.attempt(ui.result, setup)

kicker = f"Milling · {setup.name}"
if result is None:
    ui.headline(kicker, "No result yet")
    panel.waiting(dark)
    st.stop()
ui.headline(kicker, ui.verdict_headline(result, unit), ui.verdict_beside(result, unit))
ui.open_question(result, on="Milling")
panel.workbench(dark)
