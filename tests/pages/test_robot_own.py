"""A robot of one's own on the robot page: files opened, joints added and taken out, tables rewritten, frames turned."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from conftest import PAGES, Grid, errors, go, number, store, words
from streamlit.testing.v1 import AppTest

import robomill as rm
from robomill.io.robot.reader import robot_from_toml
from robomill.io.robot.writer import robot_to_toml
from robomill.kinematics.transforms import rotation_x, rotation_y, rotation_z
from robomill.robot.model import Robot
from robomill.ui.project import project_from_toml, project_to_toml
from robomill.ui.work import beside

# ABB's public description of an IRB 120: origin of each joint in its parent link, m, and its axis.
IRB_120: list[Any] = [
    ((0.0, 0.0, 0.0), (0, 0, 1), (-2.87979, 2.87979)),
    ((0.0, 0.0, 0.29), (0, 1, 0), (-1.91986, 1.91986)),
    ((0.0, 0.0, 0.27), (0, 1, 0), (-1.91986, 1.22173)),
    ((0.0, 0.0, 0.07), (1, 0, 0), (-2.79253, 2.79253)),
    ((0.302, 0.0, 0.0), (0, 1, 0), (-2.094395, 2.094395)),
    ((0.072, 0.0, 0.0), (1, 0, 0), (-6.98132, 6.98132)),
]
TEMPLATE = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="a"><xacro:macro name="b"/></robot>'
TOOL = (0.0, 1.57079632679, 0.0)


def urdf(joints: list[Any], more: str = "") -> str:
    """A URDF of revolute joints (origin, axis, limits), a turned tool0 at the end, and ``more`` links and joints."""
    links = ["base_link", *(f"link_{i + 1}" for i in range(len(joints))), "tool0"]
    text = "".join(f'<link name="{link}"/>' for link in links)
    for i, ((parent, child), (origin, axis, (low, high))) in enumerate(zip(pairwise(links[:-1]), joints, strict=True)):
        x, y, z = origin
        text += (
            f'<joint name="joint_{i + 1}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{x} {y} {z}" rpy="0 0 0"/><axis xyz="{axis[0]} {axis[1]} {axis[2]}"/>'
            f'<limit lower="{low}" upper="{high}" effort="0" velocity="1"/></joint>'
        )
    text += (
        f'<joint name="flange" type="fixed"><parent link="{links[-2]}"/><child link="tool0"/>'
        f'<origin xyz="0 0 0" rpy="{TOOL[0]} {TOOL[1]} {TOOL[2]}"/></joint>'
    )
    return f'<robot name="irb120">{text}{more}</robot>'


def by_hand(joints: list[Any], theta: np.ndarray) -> np.ndarray:
    """Pose of tool0 by walking the joints: Rodrigues' formula at every axis."""
    R, p = np.eye(3), np.zeros(3)
    for (origin, axis, _), angle in zip(joints, theta, strict=True):
        p = p + R @ np.array(origin)
        x, y, z = axis
        K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], dtype=float)
        R = R @ (np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K)
    T = np.eye(4)
    T[:3, :3] = R @ rotation_z(TOOL[2]) @ rotation_y(TOOL[1]) @ rotation_x(TOOL[0])
    T[:3, 3] = p
    return T


def robot_of(app: AppTest) -> Robot:
    return store(app).project.setup.robot


def drop(app: AppTest, name: str, text: str) -> None:
    """Open a robot file on the robot page."""
    box = next(b for b in app.file_uploader if b.label.startswith("A robot file"))
    box.upload(name, text.encode(), "text/plain").run()


def test_a_urdf_dropped_in_stands_as_its_own_description_says(app: AppTest) -> None:
    go(app, "1_Robot")
    drop(app, "irb120.urdf", urdf(IRB_120))
    assert not app.exception
    assert errors(app) == []
    robot = robot_of(app)
    assert robot.n == 6
    for theta in np.random.default_rng(3).uniform(*robot.limits.T, (20, 6)):
        np.testing.assert_allclose(rm.tool_pose(robot, theta), by_hand(IRB_120, theta), atol=1e-10)
    for i, angle in enumerate((10, -20, 30, 40, -50, 60)):
        number(app, f"pose.box.{i}:deg").set_value(angle).run()
    tip = by_hand(IRB_120, np.radians([10, -20, 30, 40, -50, 60]))[:3, 3]
    shown = ", ".join(f"{1e3 * v:.1f}".replace("-", "−") for v in tip)
    assert f"Tip at ({shown}) mm" in words(app)
    said = words(app)
    assert "joint_4" in said
    assert "1 fixed joint is part of the links" in said
    assert "A URDF holds no stiffness" in said
    assert "Type what your joints give, or identify it from load tests." in said
    app.button(key="undo").click().run()
    assert robot_of(app).name == "slavkovic_5r"


def test_the_tip_of_a_urdf_with_two_arms_is_asked(app: AppTest) -> None:
    more = (
        '<link name="probe"/><joint name="arm_2" type="revolute"><parent link="link_3"/><child link="probe"/>'
        '<axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>'
    )
    go(app, "1_Robot")
    drop(app, "two.urdf", urdf(IRB_120, more))
    assert robot_of(app).name == "slavkovic_5r", "nothing is guessed"
    assert "two.urdf has several ends (tool0, probe): choose the link that holds the tool." in words(app)
    app.selectbox(key="robot.tip_link").set_value("probe").run()
    assert robot_of(app).n == 4
    app.selectbox(key="robot.tip_link").set_value("tool0").run()
    assert robot_of(app).n == 6
    assert not app.exception


@pytest.mark.parametrize(
    ("name", "text", "sentence"),
    [
        ("a.urdf", "<robot", "this is not a URDF that can be read"),
        ("a.urdf", urdf([*IRB_120, *IRB_120[:2]]), "expected 1 to 7 joints, found 8"),
        ("a.urdf", urdf(IRB_120).replace('name="joint_2" type="revolute"', 'name="joint_2" type="planar"'), "'planar'"),
        ("a.urdf", urdf(IRB_120).replace("<axis xyz", '<mimic joint="joint_1"/><axis xyz', 2), "mimics another"),
        (
            "a.xacro",
            '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="a"><xacro:macro name="b"/></robot>',
            "this is a xacro template",
        ),
        ("a.toml", "name = 3", "a.toml"),
        ("a.txt", "hello", "a.txt"),
    ],
)
def test_a_file_that_is_no_robot_is_refused_once_and_the_robot_stays(
    app: AppTest, name: str, text: str, sentence: str
) -> None:
    go(app, "1_Robot")
    before = robot_of(app)
    drop(app, name, text)
    assert not app.exception
    assert len(errors(app)) == 1
    assert sentence in errors(app)[0]
    assert robot_of(app) == before


def test_a_robot_file_is_saved_and_opened_again(app: AppTest) -> None:
    go(app, "1_Robot")
    own = rm.load_robot("kuka_kr270").replace(name="mine", title="My arm")
    drop(app, "mine.robot.toml", robot_to_toml(own))
    assert robot_of(app) == own
    assert "Robot · My arm" in words(app)
    assert app.selectbox(key="robot.name").value == "edited"
    assert robot_from_toml(robot_to_toml(robot_of(app))) == own
    app.text_input(key="robot.title").set_value("Hall 3").run()
    assert "Robot · Hall 3" in words(app)


def test_from_one_joint_to_seven_no_page_breaks(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> None:
    go(app, "1_Robot")
    monkeypatch.setattr(beside, "FIRST_S", 2.0)  # an arm that is solved numerically is looked at while it computes
    held = store(app)
    for n in (6, 7, 6, 5, 4, 3, 2, 1):
        now = robot_of(app)
        key = "robot.joint.add.slides" if n > now.n else "robot.joint.remove"
        app.button(key=key).click().run()
        assert robot_of(app).n == n, errors(app)
        again = project_from_toml(project_to_toml(held.project))
        assert again.setup.robot == robot_of(app)
        if n == 7:
            assert app.button(key="robot.joint.add.turns").disabled
            assert app.button(key="robot.joint.add.slides").disabled
        for page in PAGES:
            go(app, page)
            crashed = [f"{n} joints, {page}: {e.message[:300]}" for e in app.exception]
            assert not crashed
            assert len(set(errors(app))) == len(errors(app)), f"{n} joints, {page}: {errors(app)}"
            if page == "6_Milling" and n < 4:
                assert "No point of the cut can be reached: move the part zero." in words(app)
                assert errors(app) == []
        go(app, "1_Robot")
    assert app.button(key="robot.joint.remove").disabled
    for _ in range(8):
        app.button(key="undo").click().run()
    assert robot_of(app) == rm.load_robot("slavkovic_5r")


def test_joints_are_moved_with_their_numbers(app: AppTest) -> None:
    go(app, "1_Robot")
    before = robot_of(app)
    app.selectbox(key="robot.joint").set_value(2).run()
    app.button(key="robot.joint.up").click().run()
    order = [0, 2, 1, 3, 4]
    np.testing.assert_array_equal(robot_of(app).C_theta, before.C_theta[order])
    np.testing.assert_array_equal(robot_of(app).limits, before.limits[order])
    np.testing.assert_array_equal(robot_of(app).a, before.a[order])
    assert app.selectbox(key="robot.joint").value == 1, "the joint in hand is the one that was moved"
    assert "(edited)" in app.selectbox(key="robot.name").options[0]


def test_the_table_is_rewritten_or_read_otherwise(app: AppTest) -> None:
    go(app, "1_Robot")
    before = robot_of(app)
    theta = np.random.default_rng(0).uniform(*before.limits.T, (200, 5))
    app.button(key="robot.rewrite").click().run()
    after = robot_of(app)
    assert after.convention == "modified"
    np.testing.assert_allclose(rm.tool_pose(after, theta), rm.tool_pose(before, theta), atol=1e-12)
    assert "Convention: modified (Craig) Denavit-Hartenberg" in [e.label for e in app.expander]
    app.button(key="undo").click().run()
    app.button(key="robot.reread").click().run()
    other = robot_of(app)
    np.testing.assert_array_equal(other.a, before.a)
    assert other.convention == "modified"
    assert np.abs(rm.tool_pose(other, theta) - rm.tool_pose(before, theta)).max() > 0.1


def test_the_tool_and_the_base_are_turned(app: AppTest) -> None:
    go(app, "1_Robot")
    before = robot_of(app)
    for axis, angle in zip("ABC", (20.0, -30.0, 40.0), strict=True):
        number(app, f"robot.base_turn[{'ABC'.index(axis)}]:deg").set_value(angle).run()
    turns = np.radians([20.0, -30.0, 40.0])
    R = rotation_x(turns[0]) @ rotation_y(turns[1]) @ rotation_z(turns[2])
    np.testing.assert_allclose(robot_of(app).T_base[:3, :3], R, atol=1e-10)
    number(app, "robot.base[2]:mm").set_value(750.0).run()
    assert robot_of(app).T_base[2, 3] == pytest.approx(0.75)
    number(app, "robot.tool_turn[2]:deg").set_value(90.0).run()
    spun = np.linalg.inv(before.T_tool[:3, :3]) @ robot_of(app).T_tool[:3, :3]
    assert robot_of(app).provenance["base"].kind == "user"
    np.testing.assert_allclose(spun[2, 2], 1.0, atol=1e-12)
    for page in PAGES:
        go(app, page)
        assert not app.exception, page


def typed(app: AppTest, grid: Grid, row: int, column: str, text: str) -> None:
    grid.typed = ("compliance", row, column, text)
    app.run()


def test_compliance_and_stiffness_stand_side_by_side(app: AppTest, grid: Grid) -> None:
    go(app, "1_Robot")
    typed(app, grid, 0, "stiffness", "1000")
    assert robot_of(app).C_theta[0] == pytest.approx(1e-6, rel=1e-12)
    app.run()
    assert float(grid.shown["compliance"].loc[0, "compliance"]) == 10.0
    typed(app, grid, 1, "compliance", "20")
    app.run()
    assert float(grid.shown["compliance"].loc[1, "stiffness"]) == pytest.approx(500.0, rel=1e-6)
    assert robot_of(app).C_theta[0] == pytest.approx(1e-6, rel=1e-12)
    typed(app, grid, 2, "compliance", "0")
    app.run()
    assert grid.shown["compliance"].loc[2, "stiffness"] == "∞"
    assert robot_of(app).C_theta[2] == 0.0
    assert robot_of(app).compliance_set == "user"


@pytest.mark.parametrize(
    ("column", "text", "sentence"),
    [
        ("compliance", "1e9", "Joint 2, compliance: found 1e+09, expected 0 to 1e+07 ×10⁻⁷ rad/(N m). It stays 10.12"),
        ("stiffness", "1e-9", "Joint 2, stiffness: found 1e-09, expected 0.001 or more kN m/rad. It stays 988.142"),
    ],
)
def test_a_joint_softer_than_any_is_refused_in_a_sentence(
    app: AppTest, grid: Grid, column: str, text: str, sentence: str
) -> None:
    go(app, "1_Robot")
    before = robot_of(app)
    typed(app, grid, 1, column, text)
    assert [sentence in said for said in errors(app)] == [True]
    assert robot_of(app) == before


def test_theta_2_of_999_is_refused_in_a_sentence_and_the_arm_stays(app: AppTest) -> None:
    go(app, "1_Robot")
    before = store(app).project.view.theta
    number(app, "pose.box.1:deg").set_value(999).run()
    assert len(errors(app)) == 1
    assert "θ₂: found 999, expected" in errors(app)[0]
    assert "It stays" in errors(app)[0]
    assert store(app).project.view.theta == before


@pytest.mark.parametrize("name", ["kuka_kr270", "fanuc_r2000ic", "slavkovic_5r", "planar_2r"])
def test_det_j_is_one_number_on_every_page(app: AppTest, name: str) -> None:
    """The determinant by numpy of the rows of J in which the arm moves."""
    go(app, "1_Robot")
    app.selectbox(key="robot.name").set_value(name).run()
    robot = robot_of(app)
    theta = np.clip(np.full(robot.n, 0.4), *robot.limits.T)
    for i, angle in enumerate(theta):
        number(app, f"pose.box.{i}:deg").set_value(float(np.degrees(angle))).run()
    J = rm.geometric_jacobian(robot, np.array(store(app).project.view.theta))
    task = rm.task_jacobian(robot, np.array(store(app).project.view.theta)) if robot.n == 5 else J[: robot.n]
    det = f"{np.linalg.det(task):.3f}".replace("-", "−")
    assert "not square" not in words(app)
    assert det in words(app)
