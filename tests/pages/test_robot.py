"""The robot page: what is typed is kept across pages, undo and redo work, refusals are one sentence."""

from __future__ import annotations

import re

import numpy as np
import pytest
from conftest import errors, go, number, store, words
from streamlit.testing.v1 import AppTest

from robomill.io.robot.robots import load_robot
from robomill.robot.tool_frame import TOOL_AXES, tool_axis, with_tool_axis
from robomill.simulation.run import deviation_over_spin
from robomill.simulation.samples import sampled
from robomill.ui import session
from robomill.ui.project import Project
from robomill.ui.robot import tables
from robomill.ui.robot.frames import CHOSEN
from robomill.units import to_si


def halve_joint_5(app: AppTest) -> None:
    """What the table editor's callback does; AppTest cannot type into a table."""
    kept = store(app)
    robot = kept.project.setup.robot
    frame = tables.compliance_frame(robot)
    frame.loc[4, "compliance"] = 45.675e-7
    new = kept.project.setup.replace(robot=tables.with_compliance(robot, frame))
    kept.past, kept.project = [kept.project], Project(new, kept.project.view, kept.project.preset)


def test_it_runs_and_shows_the_compliance_at_the_cut(app: AppTest) -> None:
    go(app, "1_Robot")
    assert not app.exception
    text = words(app)
    assert "2.295" in text
    assert "−1.024" in text
    assert "1.134" in text
    assert not np.signbit(number(app, "pose.box.0:deg").value), "no -0.00 from the last bits"


def test_an_edit_reaches_the_start_page_and_undo_takes_it_back(app: AppTest) -> None:
    go(app, "1_Robot")
    halve_joint_5(app)
    app.run()
    assert '<span class="rm-was">0.251 mm</span> · −0.037 mm' in words(app)
    go(app, "app")
    assert "0.19 mm off in Y" in words(app)
    tiles = dict(re.findall(r'<div class="rm-label">([^<]*)</div>(.*?)(?=<div class="rm-label">|$)', words(app)))
    for label, note in (("Wall error", "to the left · "), ("Tip off its path", "most at line ")):
        assert 'class="rm-was"' in tiles[label], "what was stands beside what is said of the number, not in its place"
        assert note in tiles[label]
    app.button(key="undo").click().run()
    assert "0.23 mm off in Y" in words(app)
    app.button(key="redo").click().run()
    assert "0.19 mm off in Y" in words(app)
    app.button(key="back").click().run()
    assert "0.23 mm off in Y" in words(app)


def test_slider_and_box_show_the_same_angle_and_it_survives_a_page_change(app: AppTest) -> None:
    go(app, "1_Robot")
    number(app, "pose.box.1:deg").set_value(-40.0).run()
    assert app.slider(key="pose.slider.1").value == -40.0
    app.slider(key="pose.slider.0").set_value(12.5).run()
    assert number(app, "pose.box.0:deg").value == 12.5
    go(app, "6_Milling")
    go(app, "1_Robot")
    assert number(app, "pose.box.1:deg").value == -40.0
    theta = np.array(store(app).project.view.theta)
    np.testing.assert_allclose(theta[:2], [to_si(12.5, "deg"), to_si(-40.0, "deg")])
    app.button(key="pose.cut").click().run()
    assert store(app).project.view.theta is None


def test_table_3_is_one_click(app: AppTest) -> None:
    go(app, "1_Robot")
    app.button_group(key="robot.compliance_set").set_value("table_3").run()
    assert not app.exception
    assert store(app).project.setup.robot.compliance_set == "table_3"
    go(app, "app")
    assert "0.26 mm off in Y" in words(app)


def test_every_robot_of_the_samples_opens(app: AppTest) -> None:
    go(app, "1_Robot")
    for name in app.selectbox(key="robot.name").options:
        assert name
    app.selectbox(key="robot.name").set_value("planar_2r").run()
    assert not app.exception
    assert store(app).project.setup.robot.name == "planar_2r"


def test_edited_blocks_become_the_users_own(app: AppTest) -> None:
    go(app, "1_Robot")
    number(app, "robot.tip[2]:mm").set_value(5.0).run()
    robot = store(app).project.setup.robot
    assert robot.T_tool[2, 3] == 0.005
    assert robot.provenance["tool"].kind == "user"
    assert robot.provenance["lengths"].kind == "assumed"
    app.button(key="undo").click().run()
    assert store(app).project.setup.robot.provenance["tool"].kind == "paper"


def test_each_typed_value_is_one_step_back(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> None:
    go(app, "1_Robot")
    monkeypatch.setattr(session, "ONE_GESTURE_S", 0.0)
    for value in (5.0, 6.0):
        number(app, "robot.tip[2]:mm").set_value(value).run()
    app.button(key="undo").click().run()
    assert store(app).project.setup.robot.T_tool[2, 3] == 0.005


def test_an_angle_beyond_its_limit_is_refused_in_a_sentence(app: AppTest) -> None:
    go(app, "1_Robot")
    before = store(app).project.view.theta
    number(app, "pose.box.1:deg").set_value(400.0).run()
    assert not app.exception
    assert any("found 400, expected" in e for e in errors(app))
    assert store(app).project.view.theta == before
    number(app, "pose.box.1:deg").set_value(-40.0).run()
    assert errors(app) == []


def test_the_spin_of_a_six_axis_arm_is_chosen_and_its_influence_said(app: AppTest) -> None:
    kept = store(app)
    T_MW = np.eye(4)
    T_MW[:3, 3] = [1.7, 0.3, 0.5]
    setup = kept.project.setup.replace(robot=load_robot("fanuc_r2000ic"), T_MW=T_MW, step=5e-3)
    kept.project = Project(setup, kept.project.view, kept.project.preset)
    go(app, "1_Robot")
    assert not app.exception
    assert app.selectbox(key="robot.spin_rule").value == "least_motion"
    app.button(key="robot.spin_range").click().run()
    over = deviation_over_spin(setup, sampled(setup.toolpath, 5e-3))
    low, high = (f"{1e3 * value:.3f}" for value in over.range)
    assert f"between {low} and {high} mm" in words(app)
    app.selectbox(key="robot.spin_rule").set_value("given").run()
    number(app, "robot.spin:deg").set_value(30.0).run()
    assert store(app).project.setup.spin == pytest.approx(np.pi / 6)


@pytest.mark.parametrize("axis", TOOL_AXES)
def test_the_tools_direction_is_a_choice(axis: str) -> None:
    robot = with_tool_axis(load_robot("fanuc_r2000ic"), axis, CHOSEN)
    k = np.eye(3)["xyz".index(axis[1])] * (1 if axis[0] == "+" else -1)
    np.testing.assert_allclose(robot.T_tool[:3, 2], k)
    np.testing.assert_allclose(robot.T_tool[:3, 3], [0.0069, 0.2453, 0.3193])
    assert np.linalg.det(robot.T_tool) == pytest.approx(1.0)
    assert tool_axis(robot) == axis
    assert robot.provenance["tool"].kind == ("paper" if axis == "-y" else "user")
