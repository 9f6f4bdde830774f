"""The learn page: it asks before it answers, and its equations hold the numbers of now."""

from __future__ import annotations

import re

import numpy as np
from conftest import go, store, words
from streamlit.testing.v1 import AppTest

import robomill as rm

WORKSPACE, COMPLIANCE, LEARN = "2_Workspace", "3_Compliance", "8_Learn"


def test_the_lesson_asks_then_reveals(app: AppTest) -> None:
    go(app, LEARN)
    assert "Where does the tip go?" in words(app)
    assert "<b>0.102 mm</b>" not in words(app)
    app.radio(key="learn.answer").set_value("alone").run()
    app.button(key="learn.reveal").click().run()
    said = words(app)
    assert "<b>0.102 mm</b> down" in said
    assert '<td class="off">−1.024</td>' in said, "the off-diagonal term lights up"
    assert "Look again" in said
    app.radio(key="learn.answer").set_value("-2").run()
    assert "<b>Right.</b> The second column of C says where a push along Y leads." in words(app)
    assert "You said: along Y and down." in words(app)


def test_the_ellipsoid_stretches_towards_the_edge(app: AppTest) -> None:
    go(app, LEARN)
    assert "3.385 <small>µm/N</small>" in words(app), "as on every other page"
    slider = app.select_slider[0]
    slider.set_value(len(slider.options) - 1).run()
    assert not app.exception
    said = words(app)
    assert 6.825 <= float(re.findall(r"([\d.]+) <small>µm/N</small>", said)[-1]) < 6.835
    assert "A singularity: one direction is lost." in said


def test_equations_hold_the_numbers_of_now(app: AppTest) -> None:
    go(app, LEARN)
    tex = "\n".join(e.value for e in app.get("latex")) if app.get("latex") else words(app)
    assert "2.295" in tex
    assert "-1.024" in tex
    assert "229.5" in tex


def test_the_reproduction_table_is_on_the_page(app: AppTest) -> None:
    go(app, LEARN)
    said = words(app)
    for item in ("Table 1", "Table 3", "Fig. 5", "Fig. 16"):
        assert item in said
    assert "0.2644 mm from Table 3" in said


def test_the_mathematics_follows_the_arm_to_the_edge(app: AppTest) -> None:
    """C_yy in the equations against J C_theta J^T where the arm stands, by the product of matrices."""
    go(app, "8_Learn")
    before = [each.value for each in app.get("latex")]
    robot, slider = store(app).project.setup.robot, app.select_slider[0]
    slider.set_value(len(slider.options) - 8).run()
    assert not app.exception
    out = store(app).values["learn.lesson"].out
    found = rm.inverse_kinematics(robot, rm.pose_from_world(np.array([0.0, -out, 0.0, 0.0, 0.0])))
    J = rm.geometric_jacobian(robot, found.theta)[:3]
    C_yy = 1e6 * float((J @ np.diag(robot.C_theta) @ J.T)[1, 1])
    after = [each.value for each in app.get("latex")]
    assert after != before
    assert f"{C_yy:.3f}" in "\n".join(after)
    assert f"The mathematics, {1e3 * out:.0f} mm from the base" in [each.value for each in app.header]


def test_the_mathematics_pushes_where_the_question_does(app: AppTest) -> None:
    go(app, "1_Robot")
    app.selectbox(key="robot.name").set_value("kuka_kr270").run()
    go(app, LEARN)
    asked = next(axis for axis in "XYZ" if f"Push the tool along {axis}." in words(app))
    tex = "\n".join(e.value for e in app.get("latex")) if app.get("latex") else words(app)
    assert f"C_{{{2 * asked.lower()}}}" in tex
    force = " \\\\ ".join("100" if axis == asked else "0" for axis in "XYZ")
    assert force in tex


def test_a_button_leads_to_the_virtual_laboratory(app: AppTest) -> None:
    go(app, LEARN)
    app.button(key="learn.reveal").click().run()
    app.button(key="learn.laboratory").click().run()
    assert not app.exception
    assert app.button_group(key="identification.section").value == "laboratory"
