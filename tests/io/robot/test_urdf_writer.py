"""A robot written as URDF: its poses by walking the file's own joints here, and read back."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pytest

import robomill as rm
from robomill.io.robot.urdf import read_urdf, tips_of_urdf
from robomill.io.robot.urdf_writer import robot_to_urdf
from robomill.robot.model import Robot


def turned(axis: np.ndarray, angle: float) -> np.ndarray:
    K = np.cross(np.eye(3), axis)  # K v is axis x v
    return np.asarray(np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K)


def walked(text: str, theta: np.ndarray) -> np.ndarray:
    """Pose of the last link by the URDF standard: origin (xyz, then Rz Ry Rx), then the joint about its axis."""
    T, q = np.eye(4), iter(theta)
    for joint in ElementTree.fromstring(text).iter("joint"):
        said = joint.find("origin")
        assert said is not None
        xyz, (r, p, y) = ([float(v) for v in said.get(key, "").split()] for key in ("xyz", "rpy"))
        step = np.eye(4)
        step[:3, :3] = turned(np.eye(3)[2], y) @ turned(np.eye(3)[1], p) @ turned(np.eye(3)[0], r)
        step[:3, 3] = xyz
        T = T @ step
        if joint.get("type") != "fixed":
            about = joint.find("axis")
            assert about is not None
            axis, step = np.array([float(v) for v in about.get("xyz", "").split()]), np.eye(4)
            if joint.get("type") == "prismatic":
                step[:3, 3] = axis * next(q)
            else:
                step[:3, :3] = turned(axis, next(q))
            T = T @ step
    return np.asarray(T)


def check(robot: Robot) -> None:
    text = robot_to_urdf(robot)
    again = read_urdf(text.encode(), where="arm.urdf")
    for theta in np.random.default_rng(2).uniform(*robot.limits.T, (25, robot.n)):
        np.testing.assert_allclose(walked(text, theta), rm.tool_pose(robot, theta), atol=1e-12)
        np.testing.assert_allclose(rm.tool_pose(again, theta), rm.tool_pose(robot, theta), atol=1e-12)
    np.testing.assert_array_equal(again.limits, robot.limits)
    np.testing.assert_array_equal(again.prismatic, robot.prismatic[robot.free])
    assert again.provenance["compliance"].kind == "assumed"


@pytest.mark.parametrize("name", ["slavkovic_5r", "fanuc_r2000ic", "kuka_kr500", "planar_2r"])
def test_every_pose_and_limit_is_in_the_file(name: str) -> None:
    robot = rm.load_robot(name)
    check(robot)
    written = [each for joint in ElementTree.fromstring(robot_to_urdf(robot)).iter("joint") for each in joint.iter()]
    said = " ".join(value for each in written for value in each.attrib.values())
    assert "-0.0" not in said.split(), "zero has no sign"


def test_a_held_axis_becomes_a_part_of_its_link_and_a_name_is_no_markup() -> None:
    robot = rm.load_robot("slavkovic_5r")
    held = robot.replace(name='a "b" & <c>', blocked=[np.nan, 0.3, np.nan, np.nan, np.nan])
    check(held)
    assert read_urdf(robot_to_urdf(held).encode(), where="arm.urdf").name == 'a "b" & <c>'


def test_a_joint_that_slides() -> None:
    n = 3
    check(
        Robot(
            name="gantry",
            convention="modified",
            alpha=[0.3, 1.2, -0.4],
            a=[0.1, 0.2, 0.3],
            d=[0.4, -0.5, 0.6],
            theta_offset=[0.7, 0.8, -0.9],
            sign=[-1.0, 1.0, -1.0],
            prismatic=[False, True, True],
            limits_all=np.tile([-1.0, 1.5], (n, 1)),
            C_theta_all=np.full(n, 1e-6),
        )
    )


def test_the_tips_of_a_file_with_two_branches() -> None:
    joints = "".join(
        f'<joint name="j_{child}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        '<axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>'
        for parent, child, kind in (("a", "b", "revolute"), ("b", "c", "fixed"), ("b", "d", "revolute"))
    )
    links = "".join(f'<link name="{link}"/>' for link in "abcd")
    found = tips_of_urdf(f'<robot name="two">{links}{joints}</robot>'.encode(), "two.urdf")
    assert found.ends == ("c", "d")
    assert [joint.name for joint in found.chains["d"]] == ["j_b", "j_d"]
    assert "a" not in found.chains
    assert found.only == "d", "a branch of fixed parts is no branch"
    ground = '<joint name="j_e" type="revolute"><parent link="b"/><child link="e"/></joint>'
    both = tips_of_urdf(f'<robot name="two">{links}<link name="e"/>{joints}{ground}</robot>'.encode(), "two.urdf")
    assert both.only is None
