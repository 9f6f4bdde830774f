"""The toolpath: a program, lines, points, a drawing or a sketch; the part zero; whether the arm can follow."""

from functools import partial

import streamlit as st

from robomill import ui
from robomill.learn.worked import of_the_run
from robomill.ui import pieces
from robomill.ui.comparing import other
from robomill.ui.entry import tools
from robomill.ui.judged.worked import mathematics
from robomill.ui.toolpath import details, drawing, question, view
from robomill.ui.toolpath.doors import file_inputs
from robomill.ui.toolpath.lines import lines_inputs
from robomill.ui.toolpath.part_zero import part_zero
from robomill.ui.toolpath.picture import path_figure, stock_note
from robomill.ui.toolpath.program import program_inputs
from robomill.ui.toolpath.reach import board_reach, path_reach
from robomill.ui.toolpath.sketch import sketch_inputs
from robomill.ui.toolpath.sketch_pad import sketch_pad
from robomill.ui.toolpath.sources import kind_switch
from robomill.ui.work.running import path_of

project = ui.begin("Toolpath")
setup, dark, unit = project.setup, ui.dark(), project.view.length
source = setup.source

empty = source.kind == "sketch" and not source.sketch.elements
path = None if empty else ui.attempt(path_of, setup)
reach = ui.attempt(path_reach, setup) if path is not None else None
result = ui.attempt(ui.result, setup) if reach is not None else None

view.headline(source, path, reach, result, unit)
if result is not None:
    ui.open_question(result, on="Toolpath")
other.tiles(view.tiles(source, path, reach, result, unit), view.tiles_of_b)
# there without a result, too: what comes between tiles and board later would push the board from beneath the mouse
mathematics(partial(of_the_run, result, result.decided.sample) if result is not None else tuple, "toolpath")
asked = question.panel(path, "" if result is None else result.verdict.premise)

program = source.kind == "program" and not drawing.shown()
left, right = ui.split([1, 2] if program else [1.2, 1.75] if not drawing.shown() else [1, 1.2], "steps")
with left:
    kind_switch()
    file_inputs(dark)
    if source.kind == "program":
        program_inputs(source, path, dark)
    elif source.kind == "sketch":
        sketch_inputs()
    elif source.kind == "lines":
        lines_inputs(source, project.view)
    if source.kind in ("program", "points"):
        with st.expander("**Tools**", expanded=bool(setup.tools), key="toolpath.open.tools"):
            tools.panel(ask=not asked)
    with st.container(border=True):
        part_zero()

with right:
    if source.kind == "sketch":
        with st.container(border=True, key="toolpath-board"):
            board = ui.attempt(board_reach, setup, -source.sketch.depth, unit)
            sketch_pad(source.sketch, setup.cutter.diameter, board)
    if path is None or reach is None:
        st.stop()
    with st.container(border=True, key="toolpath-picture"):
        path_figure(setup, reach, result, dark)
        words = details.line_words(setup, reach, result, unit)
        if words:
            pieces.said("info", words, "my_location")
        stock_note(setup)
        if result is not None:
            st.page_link("pages/6_Milling.py", label="See the part that comes out", icon=":material/arrow_forward:")
    with st.container(key="toolpath-figures"):
        with st.container(border=True):
            st.markdown("**The path in figures**")
            details.path_facts(setup, unit)
        if source.kind == "program":
            with st.container(border=True):
                details.findings_list(view.findings(path, result))
                details.support_table()
