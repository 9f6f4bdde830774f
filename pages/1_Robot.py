"""The robot: table, limits, tool and compliances, each editable; the arm, what pushes it and which joint gives."""

import streamlit as st

from robomill import ui
from robomill.ui import push
from robomill.ui.arm import arm
from robomill.ui.robot import editors, pose
from robomill.units import format_many, format_si, format_times
from robomill.viz.arm import displacement_scale

project = ui.begin("Robot")
robot, view, dark = project.setup.robot, project.view, ui.dark()
cut = push.decided(ui.attempt(ui.result, project.setup))
theta = pose.configuration(project, cut)
now, old = pose.compared(project, theta)
moved, before = pose.moved(project, now, old, cut)

ui.headline(f"Robot · {robot.title or robot.name}", moved.sentence(view.length), pose.lead(project, moved, cut))
ui.tiles(
    [
        pose.tip_tile(moved, before, view.length),
        ui.Tile(
            "C_yy at this pose",
            format_si(now.component("yy"), view.of("um/N"), 3),
            "direct compliance along Y",
            format_si(old.component("yy"), view.of("um/N"), 3) if old else "",
        ),
        ui.Tile(
            "Largest compliance",
            format_si(now.principal[0][-1], view.of("um/N"), 3),
            f"in direction ({format_many(now.principal[1][:, -1], '1', 2)}) of the robot frame",
            format_si(old.principal[0][-1], view.of("um/N"), 3) if old else "",
        ),
        ui.Tile(
            "Distance to singularity, det(J)",
            pose.det_value(now, view.of),
            pose.det_words(now),
            pose.det_value(old, view.of),
        ),
    ]
)

left, right = ui.split([5, 9], "page", gap="medium")
with left:
    editors.editors(project)
    pose.controls(project, theta, cut)
with right:
    with st.container(border=True):
        tip = format_many(now.T_MT[:3, 3], view.length, 1, with_unit=False)
        caption = (
            f"Blue: {moved.push.words}. Orange: displacement, shown "
            f"{format_times(displacement_scale(moved.delta, now.frames))}. Tip at ({tip}) {view.length} in the robot "
            "frame {M}; foot and tube sizes are for the eye only."
        )
        said = f"The arm at the chosen joint angles, its tip at {tip} {view.length}. {moved.sentence(view.length)}"
        arm(pose.scene(now, old, moved, view.length), "robot-arm", (caption, said), 400)
    shares, numbers = ui.split([1.25, 1], "pose")
    with shares:
        push.choice()
        pose.share_bars(moved, dark)
    with numbers:
        pose.compliance_matrix(now, old)
