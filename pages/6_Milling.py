"""Milling: how hard does it push, where does the tip go, what will be measured; one scrubber links the three."""

import streamlit as st

from robomill import ui
from robomill.ui.milling import body as panel

project = ui.begin("Milling")
setup, unit, dark = project.setup, project.view.length, ui.dark()
result = ui.attempt(ui.result, setup)
spread = None if result is None else ui.attempt(panel.spread_of, result)

if result is None or spread is None:
    left, right = ui.thirds()
    with left:
        panel.inputs_column(result)
    right.info("Nothing is computed yet: where a value is named above, mend it. What you typed is kept.")
    st.stop()

with st.container(gap=None):
    ui.headline(f"Milling · {setup.name}", ui.verdict_sentence(result, unit))
    panel.verdict_link(result)
    ui.open_question(result)
ui.tiles(panel.tiles(result, ui.verdict_tiles(result, unit)))
panel.workbench(setup.digest(), dark)
