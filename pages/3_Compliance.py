"""Compliance: nine maps, beside them the selected pose, beneath what a stiffer joint would save; then its report."""

import streamlit as st

from robomill import ui
from robomill.improve.sensitivity import stiffened
from robomill.ui import fields, push, running, session
from robomill.ui.maps import compliance, plane, point, sheets

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
cut = push.decided(running.quiet(project.setup))
here, at_cut = push.selected(view, box, known, cut)
found, old = here.with_robot(stiffened(robot, factors)), here.pose
pushed = push.in_force(project.view, cut)
of_cut = cut is not None and not pushed.axis
moved = push.Moved.at(found.pose, pushed)
if cut is not None and of_cut and at_cut:
    moved = cut.moved.stiffer(factors)

ui.headline(title, point.headline(found, moved, unit), point.lead(found, moved, cut, at_cut, unit))
saved = compliance.saved_by(cut.moved.stiffer(factors), cut.line) if cut and of_cut else compliance.saved_by(moved, 0)
ui.tiles(compliance.tiles(found, old, now, known, saved, view))

left, right = ui.split([1, 2.7], "page")
with left, st.container(key="inputs-compliance"):
    compliance.controls(robot, view, found)
    compliance.what_if(robot, view)
with right, st.container(border=True):
    sheets.picture(found)
    shares, gains = ui.split([1, 1.2], "joints", gap="medium")
    with shares:
        point.bars(found, old, unit)
    with gains:
        compliance.best_joint(robot.joint_numbers, saved)

point.show(found, old, moved, view.component, unit)
