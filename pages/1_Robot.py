"""The robot: table, limits, tool and compliances, each editable; the arm, det(J) and C at a pose."""

from __future__ import annotations

import numpy as np
import streamlit as st

from robomill import ui
from robomill.ui.robot import editors as robot_panel
from robomill.ui.robot.pose import pose_now, pose_sliders, poses_compared, tip_words
from robomill.units import format_si
from robomill.viz.arm import ArmScene, arm_figure

project = ui.begin("Robot")
robot, view, dark = project.setup.robot, project.view, ui.dark()
result = ui.attempt(ui.result, project.setup)
theta = pose_now(project, result)
now, old = poses_compared(project, theta)

ui.headline(
    f"Robot · {robot.title or robot.name}",
    f"At this pose 100 N along Y move the tip {format_si(100 * abs(now.C[1, 1]), view.length, 3)} in Y "
    f"and {format_si(100 * abs(now.C[2, 1]), view.length, 3)} in Z.",
)
cut = ui.verdict_tiles(result, view.length)[0] if result is not None else ui.Tile("Max deviation", "not computed")
stiff = float(np.sqrt(np.linalg.eigvalsh(now.C)[-1] ** 2))
ui.tiles(
    [
        ui.Tile("Max deviation of the cut", cut.value, cut.note, cut.was, cut.change, kind="computed"),
        ui.Tile(
            "C_yy at this pose",
            format_si(now.C[1, 1], "um/N", 3),
            "direct compliance along Y",
            format_si(old.C[1, 1], "um/N", 3) if old else "",
        ),
        ui.Tile(
            "Softest direction",
            format_si(stiff, "um/N", 3),
            robot_panel.direction_words(now.C),
            format_si(float(np.linalg.eigvalsh(old.C)[-1]), "um/N", 3) if old else "",
        ),
        ui.Tile(
            "det(J)",
            format_si(now.det, "m3", 3) if np.isfinite(now.det) else "not square",
            robot_panel.det_words(now),
            format_si(old.det, "m3", 3) if old and np.isfinite(old.det) else "",
        ),
    ]
)

left, right = ui.split([5, 9], "page", gap="large")
with left:
    robot_panel.editors(project)
    pose_sliders(project, theta, result)
with right:
    pose, numbers = ui.split([2.3, 1], "pose")
    with pose, st.container(border=True):
        scene = ArmScene(frames=now.frames, ghost=old.frames if old and old.moved else None)
        before = old.frames.tobytes() if old and old.moved else b""
        arm = ui.kept_figure(
            "robot-arm",
            (now.frames.tobytes(), before, dark),
            lambda: arm_figure(scene, dark=dark, height=500, revision="robot-arm", zoom=0.8),
        )
        ui.figure(
            arm,
            "robot-arm",
            alt="The arm at the chosen joint angles.",
            caption=f"{tip_words(robot, theta, view.length)}. Foot and tube sizes are for the eye only.",
        )
    with numbers:
        robot_panel.compliance_matrix(now, old)
        robot_panel.share_bars(robot, theta, dark)
