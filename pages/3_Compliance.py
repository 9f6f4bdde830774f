"""Compliance: the nine maps, the joints' shares, what a stiffer joint would buy, and the full report of any pose."""

from __future__ import annotations

import streamlit as st

from robomill import ui
from robomill.improve.sensitivity import stiffened
from robomill.ui import fields as maps_fields
from robomill.ui import session
from robomill.ui.maps import compliance as panel
from robomill.ui.maps import inputs as maps_inputs
from robomill.ui.maps import point as point_panel
from robomill.ui.maps import sheets
from robomill.ui.point import default_point, report

project = ui.begin("Compliance")
robot, unit = project.setup.robot, project.view.length
view = session.maps()
title = f"Compliance · {robot.title or robot.name}"

box = ui.attempt(maps_fields.region, robot, view)
known = ui.attempt(maps_fields.overview, robot, view, box) if box is not None else None
if box is None or known is None:
    ui.headline(title, "There is nothing to map: mend what is named above.")
    ui.tiles([ui.Tile(label, "none") for label in ("At the point", "Softest direction", "Softest place", "Pays most")])
    left, _ = ui.thirds()
    with left:
        maps_inputs.where(robot, view, unit)
    st.stop()

now = panel.fields(robot, view, known)
point = default_point(view, box, known)
old = report(robot, point, view.A, view.B)
found = report(stiffened(robot, view.stiffening(robot)), point, view.A, view.B)

ui.headline(title, point_panel.headline(found, unit))
ui.tiles(panel.tiles(found, old, now, known, view, unit))

left, right = ui.thirds()
with left:
    panel.controls(robot, view, found, unit)
    panel.what_if(robot, view)
with right, st.container(border=True):
    sheets.picture()

point_panel.show(found, old, view.component, unit)
st.subheader("Where does stiffness pay?")
panel.where_it_pays(found, now, panel.quiet_result(project), view, unit)
