"""Milling: force, cutter, stock, tolerance; the machined surface; a dimensioned section; deviation along the path."""

from __future__ import annotations

import streamlit as st

from robomill import ui
from robomill.report.tables import deviation_columns, section_columns
from robomill.ui import milling_panel as panel
from robomill.units import format_si, from_si
from robomill.viz.paths import components_figure, shares_figure
from robomill.viz.sections import section_figure
from robomill.viz.views import section_drawing

project = ui.begin("Milling")
setup, view, dark = project.setup, project.view, ui.dark()
unit = view.length
result = ui.attempt(ui.result, setup)

if result is not None:
    ui.headline(f"Milling · {setup.name}", ui.verdict_sentence(result, unit), result.verdict.sentence)
    ui.tiles(ui.verdict_tiles(result, unit))

left, right = ui.thirds()
with left:
    panel.inputs_column(project)
if result is None:
    right.info("Nothing was computed: mend the value named above. What you typed is kept.")
    st.stop()

length = float(result.path.s[-1])
station = view.station * length
with right:
    with st.container(border=True):
        panel.surface(result, view, station, dark)
    with st.container(border=True):
        panel.station_slider(view, length, unit)
        groove = ui.attempt(ui.groove, setup, station)
        if groove is not None:
            ui.figure(
                section_figure(section_drawing(groove, unit), dark=dark, height=340), "section",
                name="groove-sections", table=lambda: section_columns(result),
                caption=groove.note or f"Section after {format_si(station, unit, 1)} of cut, looking along the feed, "
                "to scale. Dashed: the ideal groove.",
                alt="Cross-section of the groove with its dimensions and the ideal groove dashed.",
            )  # fmt: skip

st.subheader("Deviation along the path")
s, at = from_si(result.path.s, unit), float(from_si(station, unit))
delta = from_si(panel.at_feed(result, result.delta), unit)
whole, shares = ui.split([1, 1], "along")
with whole, st.container(border=True, height="stretch"):
    st.markdown("**Where the tip goes**")
    ui.figure(
        components_figure(s, delta, result.path.block, float(from_si(setup.tolerance, unit)), unit, dark=dark,
                          station=at),
        "components", name="deviation", table=lambda: deviation_columns(result),
        caption="Deflected minus commanded, in the robot's frame {M}.",
        alt="Deviation of the tool tip along the path, by component.",
    )  # fmt: skip
with shares, st.container(border=True, height="stretch"):
    axis = panel.share_axis(view)
    column = "xyz".index(axis)
    parts = from_si(panel.at_feed(result, panel.shares(result, column)), unit)
    ui.figure(
        shares_figure(s, parts, panel.share_names(result), delta[:, column], axis, unit, dark=dark, station=at),
        f"shares-{axis}", name=f"joint-shares-{axis}", table=lambda: deviation_columns(result),
        caption="Which joint gives: shares stack to the total line.",
        alt="Deviation along the path stacked by joint.",
    )  # fmt: skip
panel.downloads(result, view, station)
