"""The toolpath: a program, a table of lines or a sketch; the part zero; what was found; whether the arm can follow."""

from __future__ import annotations

import streamlit as st

from robomill import ui
from robomill.simulation.stations import nearest_judged
from robomill.ui.toolpath import details
from robomill.ui.toolpath import view as shown
from robomill.ui.toolpath.lines import lines_inputs
from robomill.ui.toolpath.part_zero import part_zero
from robomill.ui.toolpath.program import program_inputs
from robomill.ui.toolpath.reach import board_reach, path_reach
from robomill.ui.toolpath.sketch import sketch_inputs
from robomill.ui.toolpath.sketch_pad import sketch_pad
from robomill.ui.toolpath.sources import kind_switch
from robomill.viz.arm import arm_figure
from robomill.viz.toolpath import plan_picture, turnable_picture
from robomill.viz.views import arm_scene

project = ui.begin("Toolpath")
setup, dark, unit = project.setup, ui.dark(), project.view.length
source = setup.source
drawing = source.kind == "sketch"
HEIGHT = 300 if drawing else 420

empty = source.kind == "sketch" and not source.sketch.elements
path = None if empty else ui.attempt(lambda: setup.toolpath)
reach = ui.attempt(path_reach, setup) if path is not None else None
result = ui.attempt(shown.simulated, setup) if reach is not None else None

shown.headline(source, path, reach, result, unit)
shown.tiles(path, reach, result, unit, source.kind)

left, right = ui.thirds() if source.kind == "program" else ui.split([1.2, 1.75], "page", gap="large")
with left:
    kind_switch()
    if source.kind == "program":
        program_inputs(source, path, dark)
    elif source.kind == "sketch":
        sketch_inputs()
    else:
        lines_inputs(source, project.view)
    with st.container(border=True):
        part_zero()

with right:
    if source.kind == "sketch":
        with st.container(border=True):
            board = board_reach(setup, -source.sketch.depth, unit)
            sketch_pad(source.sketch, setup.cutter.diameter, board)
    if path is None or reach is None:
        st.stop()
    with st.container(border=True):
        colour, seen = shown.picture_choices(result is not None)
        picture = shown.picture(setup, reach, result, colour, unit)
        key = f"path-{seen}"
        thinned = f" {picture.caption}" if picture.caption else ""
        if seen == "plan":
            ui.figure(
                plan_picture(picture, dark=dark, height=HEIGHT),
                key,
                name="toolpath",
                table=lambda: shown.path_columns(reach, result),
                on_select=lambda: shown.take_pick(key),
                caption=f"From above; a click shows the line. Crosses: out of reach.{thinned}",
                alt="The path from above; points out of reach are marked with crosses.",
            )
        elif seen == "turn":
            figure, times = turnable_picture(picture, dark=dark, height=HEIGHT)
            ui.figure(
                figure,
                key,
                name="toolpath",
                table=lambda: shown.path_columns(reach, result),
                caption=f"Heights shown × {times:g}, parallel projection.{thinned}",
                alt="The path in space, to be turned.",
            )
        elif result is not None:
            index = result.worst if result.worst >= 0 else nearest_judged(result, 0.0)
            ui.figure(
                arm_figure(arm_scene(result, index), dark=dark, height=HEIGHT, revision="path-arm", zoom=0.85),
                key,
                caption="The arm at the worst point of the path. Grey dots: out of reach.",
                alt="The arm, the part and the path in the robot's frame.",
            )
        words = details.line_words(setup, reach, result, unit)
        if words:
            st.info(words, icon=":material/my_location:")
        shown.stock_note(setup)
        if result is None:
            shown.ask_button(setup)
    with st.container(border=True):
        st.markdown("**The path in figures**")
        details.path_facts(setup, unit)
    if source.kind == "program":
        with st.container(border=True):
            details.findings_list(path.findings)
            details.support_table()
