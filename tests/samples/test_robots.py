"""The presets of real arms against public descriptions of the same arms, walked link by link as a URDF is read."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import robomill as rm

ARMS = json.loads(Path(__file__).with_name("public_descriptions.json").read_text())["arms"]
SAME = [
    ("kuka_kr500", "kr360_r2830"),
    ("kuka_kr500", "kr600_r2830"),
    ("fanuc_r2000ic", "r2000ic165f"),
    ("fanuc_r2000ic", "r2000ic210f"),
]


def described_flange(arm: str, q: np.ndarray) -> np.ndarray:
    """(4, 4): origin (xyz, then rpy about fixed axes), then a turn about the joint's axis, link by link."""
    T, angles = np.eye(4), iter(q)
    for link in ARMS[arm]["chain"]:
        step = np.eye(4)
        step[:3, :3] = Rotation.from_euler("xyz", link["rpy"]).as_matrix()
        step[:3, 3] = link["xyz"]
        T = T @ step
        if link["type"] == "revolute":
            turn = np.eye(4)
            turn[:3, :3] = Rotation.from_rotvec(next(angles) * np.array(link["axis"])).as_matrix()
            T = T @ turn
    return T


def limits(arm: str) -> np.ndarray:
    return np.array([[link["lower"], link["upper"]] for link in ARMS[arm]["chain"] if link["type"] == "revolute"])


@pytest.mark.parametrize(("preset", "arm"), SAME)
def test_flange_and_tip_stand_where_the_maker_says(preset, arm):
    robot = rm.load_robot(preset)
    flange = robot.replace(T_tool=np.eye(4))
    low, high = limits(arm).T
    for q in np.random.default_rng(10).uniform(low, high, (300, 6)):
        expected = described_flange(arm, q)
        np.testing.assert_allclose(rm.tool_pose(flange, q), expected, atol=1e-9)
        np.testing.assert_allclose(rm.tool_pose(robot, q), expected @ robot.T_tool, atol=1e-9)


def test_the_pendant_angles_that_were_379_mm_off():
    robot = rm.load_robot("kuka_kr500")
    q = np.radians([10, -80, 95, 30, 40, -20])
    expected = described_flange("kr360_r2830", q) @ robot.T_tool
    np.testing.assert_allclose(rm.tool_pose(robot, q), expected, atol=1e-9)
    turned = robot.replace(sign=np.array([-1.0, 1, 1, 1, 1, 1]))
    assert np.linalg.norm((rm.tool_pose(turned, q) - expected)[:3, 3]) == pytest.approx(0.379, abs=1e-3)


def test_limits_are_the_described_ones_or_the_file_says_which_are_not():
    for preset, arm in SAME:
        robot = rm.load_robot(preset)
        other = np.flatnonzero(np.abs(robot.limits - limits(arm)).max(axis=1) > 1e-6) + 1
        # The KR 500-3 MT has its own axes 3 and 5; its source says how they differ.
        assert list(other) == ([3, 5] if preset == "kuka_kr500" else [])
    np.testing.assert_allclose(np.degrees(limits("kr360_r2830")[[2, 4]]), [[-100, 144], [-120, 120]], atol=1e-4)
    words = rm.load_robot("kuka_kr500").provenance["limits"].source
    assert all(number in words for number in ("-100..144", "120 deg"))


def test_todays_kr_500_is_another_arm():
    q = np.radians([10, -80, 95, 30, 40, -20])
    off = described_flange("kr500_r2800_2", q) - described_flange("kr360_r2830", q)
    assert np.linalg.norm(off[:3, 3]) > 0.05


def axes_at_zero(arm: str) -> np.ndarray:
    """(6, 3): the direction about which each joint turns, by small turns of the described chain."""
    still, found = described_flange(arm, np.zeros(6))[:3, :3], []
    for i in range(6):
        moved = described_flange(arm, 1e-3 * np.eye(6)[i])[:3, :3]
        found.append(Rotation.from_matrix(moved @ still.T).as_rotvec() / 1e-3)
    return np.array(found)


def test_the_senses_of_the_270_are_those_of_every_described_kuka():
    robot = rm.load_robot("kuka_kr270")
    still = rm.tool_pose(robot, np.zeros(6))[:3, :3]
    ours = [
        Rotation.from_matrix(rm.tool_pose(robot, 1e-3 * step)[:3, :3] @ still.T).as_rotvec() / 1e-3
        for step in np.eye(6)
    ]
    for arm in ("kr360_r2830", "kr500_r2800_2", "kr210_r2700_2"):
        np.testing.assert_allclose(ours, axes_at_zero(arm), atol=1e-9)
    assert robot.provenance["geometry"].kind == "assumed"


def test_fanucs_pendant_shows_the_forearms_angle_as_j3():
    """J3 of the pendant = joint 3 - joint 2: the forearm keeps its slope while J2 alone is moved."""
    robot = rm.load_robot("fanuc_r2000ic")
    slopes = []
    for j2 in np.radians([-40.0, 0.0, 30.0]):
        j3 = np.radians(-25.0)
        theta = np.array([0.0, j2, j3 + j2, 0.0, 0.0, 0.0])
        forearm = described_flange("r2000ic165f", theta)[:3, 2]  # at J5 = 0 the flange looks along the forearm
        np.testing.assert_allclose(rm.tool_pose(robot.replace(T_tool=np.eye(4)), theta)[:3, 2], forearm, atol=1e-12)
        slopes.append(np.degrees(np.arcsin(forearm[2])))
    np.testing.assert_allclose(slopes, -25.0, atol=1e-9)


def test_fanucs_drill_points_along_the_flanges_y():
    """The tip lies 245.3 mm along +Y, and z_T, out of the part, looks the other way; two fits of the same tests."""
    robot = rm.load_robot("fanuc_r2000ic")
    for q in np.random.default_rng(3).uniform(-1, 1, (20, 6)):
        flange = described_flange("r2000ic210f", q)
        tool = rm.tool_pose(robot, q)
        np.testing.assert_allclose(tool[:3, 2], -flange[:3, 1], atol=1e-9)
        np.testing.assert_allclose(flange[:3, :3].T @ (tool - flange)[:3, 3], [0.0069, 0.2453, 0.3193], atol=1e-9)
    stiffness = {name: 1 / C for name, C in robot.compliance_sets.items()}
    ratio = stiffness["later_fit"] / stiffness["published"]
    assert ratio[1] == pytest.approx(1.45, abs=0.005)
    assert 1 / ratio[5] == pytest.approx(3.5, abs=0.02)
