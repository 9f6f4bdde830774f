"""Compliance: nine maps, beside them the selected pose, beneath what a stiffer joint would save; then its report."""

import streamlit as st

from robomill import ui
from robomill.improve.sensitivity import stiffened
from robomill.ui import fields, session
from robomill.ui.cut import middle_of_cut
from robomill.ui.maps import compliance, plane, point, sheets
from robomill.ui.point import default_point, in_hand

project = ui.begin("Compliance")
robot, unit = project.setup.robot, project.view.length
view = session.maps()
title = f"Compliance · {robot.title or robot.name}"

box = ui.attempt(fields.region, robot, view)
known = ui.attempt(fields.overview, robot, view, box) if box is not None else None
if box is None or known is None:
    ui.headline(title, "There is nothing to map yet: see above.")
    ui.tiles(
        [ui.Tile(label, "–") for label in ("At the point", "Largest compliance", "Largest in the region", "Best joint")]
    )
    left, _ = ui.thirds()
    with left:
        plane.controls(robot, view)
    st.stop()

factors = view.stiffening(robot)
now = fields.stiffer(known, factors)
here = default_point(view, box, known, middle_of_cut(project.setup))
old = in_hand(robot, here, view.A, view.B).pose
found = in_hand(stiffened(robot, factors), here, view.A, view.B)

ui.headline(title, point.headline(found, unit))
saved = compliance.saved_by(found, compliance.quiet_result(project), view)
ui.tiles(compliance.tiles(found, old, now, known, saved, view))

left, right = ui.split([1, 2.7], "page")
with left:
    compliance.controls(robot, view, found)
    compliance.what_if(robot, view)
with right, st.container(border=True):
    sheets.picture(found, old)
    compliance.best_joint(found, saved, view)

point.show(found, old, view.component, unit)
