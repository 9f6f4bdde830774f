"""The robot: table, limits, tool and compliances, each editable; the arm, what pushes it and which joint gives."""

import streamlit as st

from robomill import ui
from robomill.learn.worked import at_the_pose
from robomill.ui.comparing import other
from robomill.ui.judged.worked import mathematics
from robomill.ui.posed import push
from robomill.ui.posed.arm import arm
from robomill.ui.robot import editors, pose
from robomill.units import format_many, format_times
from robomill.viz.arm import displacement_scale

project = ui.begin("Robot")
robot, view, dark = project.setup.robot, project.view, ui.dark()
cut = push.decided(ui.attempt(ui.result, project.setup))
theta = pose.configuration(project, cut)
now, old = pose.compared(project, theta)
moved, before = pose.moved(project, now, old, cut)

lead = pose.lead(project, moved, cut, view.length)
ui.headline(f"Robot · {robot.title or robot.name}", moved.sentence(view.length), lead)
other.tiles(pose.tiles(view, now, old, (moved, before)), pose.tiles_of_b)
mathematics(lambda: at_the_pose(now, moved.push.F, moved.delta), "robot")

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
        pose.compliance_of_b()
