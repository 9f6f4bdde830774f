"""The robot: table, limits, tool and compliances, each editable; the arm, det(J) and C at a pose."""

import dataclasses

import streamlit as st

from robomill import ui
from robomill.ui.arm import arm
from robomill.ui.point import FORCE
from robomill.ui.robot import editors, pose
from robomill.units import format_many, format_si
from robomill.viz.arm import ArmScene

project = ui.begin("Robot")
robot, view, dark = project.setup.robot, project.view, ui.dark()
result = ui.attempt(ui.result, project.setup)
theta = pose.configuration(project, result)
now, old = pose.compared(project, theta)
push = now.delta([0.0, FORCE, 0.0])

ui.headline(
    f"Robot · {robot.title or robot.name}",
    f"At this pose {format_si(FORCE, 'N', 0)} along Y moves the tip {format_si(abs(push[1]), view.length, 3)} in Y "
    f"and {format_si(abs(push[2]), view.length, 3)} in Z.",
)
tip = ui.Tile("Tip off its path", "not computed") if result is None else ui.tip_tile(result, view.length)
ui.tiles(
    [
        dataclasses.replace(tip, label="Deviation of the tip in the cut"),
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
    pose.controls(project, theta, result)
with right:
    picture, numbers = ui.split([2.3, 1], "pose")
    with picture, st.container(border=True):
        tip = format_many(now.T_MT[:3, 3], view.length, 1, with_unit=False)
        caption = f"Tip at ({tip}) {view.length} in the robot frame {{M}}. Foot and tube sizes are for the eye only."
        scene = ArmScene(
            frames=now.frames,
            joints=now.robot.joint_numbers,
            ghost=pose.ghost(now, old),
            aspect=0.9,
        )
        arm(scene, "robot-arm", (caption, f"The arm at the chosen joint angles, its tip at {tip} {view.length}."), 500)
    with numbers:
        pose.compliance_matrix(now, old)
        pose.share_bars(now, dark)
