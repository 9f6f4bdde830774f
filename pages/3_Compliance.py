"""Compliance: nine maps, beside them the selected pose, beneath what a stiffer joint would save; then its report."""

import streamlit as st

from robomill import ui
from robomill.learn.worked import at_the_pose
from robomill.ui import session
from robomill.ui.comparing import other
from robomill.ui.judged.worked import mathematics
from robomill.ui.maps import compliance, plane, point, sheets

project = ui.begin("Compliance")
robot, unit = project.setup.robot, project.view.length
view = session.maps()
title = f"Compliance · {robot.title or robot.name}"

now = ui.attempt(compliance.looked, project)
if now is None:
    ui.headline(title, "There is nothing to map yet: see above.")
    ui.tiles(
        [ui.Tile(label, "–") for label in ("At the point", "Largest compliance", "Largest in the region", "Best joint")]
    )
    left, _ = ui.thirds()
    with left:
        plane.controls(robot, view)
    st.stop()

found, old, moved, saved = now.found, now.here.pose, now.moved, now.saved
ui.headline(title, point.headline(found, moved, unit), point.lead(found, moved, now.cut, now.at_cut, unit))
other.tiles(now.tiles(), lambda theirs: compliance.looked(theirs).tiles())
mathematics(lambda: at_the_pose(found.pose, moved.push.F, moved.delta), "compliance")

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
