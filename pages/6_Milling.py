"""Milling: how hard does it push, where does the tip go, what will be measured; one scrubber links the three."""

import streamlit as st

from robomill import ui
from robomill.ui.milling import body as panel

project = ui.begin("Milling")
setup, unit, dark = project.setup, project.view.length, ui.dark()
result = ui.attempt(ui.result, setup)

kicker = f"Milling · {setup.name}"
ui.headline(kicker, "No result yet" if result is None else ui.verdict_headline(result, unit))
if result is None:
    panel.waiting(dark)
    st.stop()
ui.open_question(result, on="Milling")
panel.workbench(dark)
