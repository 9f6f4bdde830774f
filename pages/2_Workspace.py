"""The workspace: where the tool can be brought, how able the arm is there, and the largest box to machine in."""

import streamlit as st

from robomill import ui
from robomill.ui import session
from robomill.ui.comparing import other
from robomill.ui.maps import workspace
from robomill.ui.posed import fields

project = ui.begin("Workspace")
robot, unit = project.setup.robot, project.view.length
view = session.maps()

box = ui.attempt(fields.region, robot, view)
known = None
if box is not None:
    grid = ui.attempt(fields.solid, robot, box)
    known = ui.attempt(fields.field, robot, grid, view.A, view.B) if grid is not None else None
if known is not None:
    ui.attempt(fields.proposed, robot, "largest", view.A, view.B)

ui.headline(f"Workspace · {robot.title or robot.name}", workspace.sentence(robot, known))
if known is not None and box is not None:
    other.tiles(workspace.tiles(robot, view, box, known, unit), workspace.tiles_of_b)
else:
    ui.tiles(
        [
            ui.Tile(label, "–")
            for label in (
                "Region in reach",
                "Distance to singularity",
                "Room to joint limits",
                "Largest box in reach",
            )
        ]
    )

left, right = ui.split([1, 2.7], "page")
with left, st.container(key="inputs-workspace"):
    workspace.controls(robot, view)
if known is not None:
    with right:
        with st.container(border=True):
            workspace.picture()
        workspace.box_card(robot, view, unit)
