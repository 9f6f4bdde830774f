"""The toolpath: a table of lines or a program, the part zero, what was found, and whether the arm can follow."""

from __future__ import annotations

import streamlit as st

from robomill import ui
from robomill.report.tables import deviation_columns
from robomill.ui import toolpath_panel as panel
from robomill.viz.arm import arm_figure
from robomill.viz.paths import plan_figure
from robomill.viz.views import arm_scene, plan_view

project = ui.begin("Toolpath")
setup, view, dark = project.setup, project.view, ui.dark()
unit = view.length

path = ui.attempt(lambda: setup.toolpath)
result = ui.attempt(ui.result, setup) if path is not None else None

ui.headline(f"Toolpath · {setup.source.name}", panel.sentence(path, result, unit))
ui.tiles(panel.tiles(path, result, unit))

left, right = ui.thirds()
with left:
    panel.source_inputs(project)
    panel.part_zero(unit)
with right:
    if result is not None:
        with st.container(border=True):
            quantities = panel.QUANTITIES
            shown = panel.quantity()
            plan = plan_view(result, shown, unit)
            ui.figure(
                plan_figure(**plan, dark=dark, height=360), f"plan-{shown}", name="toolpath",
                table=lambda: deviation_columns(result),
                alt="The path from above; points out of reach are marked with crosses.",
                caption=f"From above, coloured by {quantities[shown].lower()}. Crosses: out of reach.",
            )  # fmt: skip
        below, beside = st.columns([1, 1.15], gap="medium")
        with below:
            panel.findings(path)
        with beside, st.container(border=True):
            if result.worst >= 0:
                scene = arm_scene(result, result.worst)
                ui.figure(
                    arm_figure(scene, dark=dark, height=340, revision="path-arm", zoom=0.85), "path-arm",
                    caption="The arm at the worst point of the path. Grey dots: out of reach.",
                    alt="The arm, the part and the path in the robot's frame.",
                )  # fmt: skip
            else:
                ui.note(f"No point of this path can be reached. {result.ik.reason(1)}")
    elif path is not None:
        panel.findings(path)
