"""Robots from a D-H table given in code, against textbook products of matrices and the robot files."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import RobotError
from robomill.robot.joints import with_joints, with_new_joint

PUMA = {  # Craig, Introduction to Robotics, 3rd ed., fig. 3.21: the Unimation PUMA 560, modified table, in inches here
    "alpha_deg": [0, -90, 0, -90, 90, -90],
    "a_mm": [0, 0, 431.8, 20.3, 0, 0],
    "d_mm": [0, 0, 124.5, 431.8, 0, 0],
}


def rot_x(t: float) -> np.ndarray:
    c, s = np.cos(t), np.sin(t)
    return np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1.0]])


def rot_z(t: float) -> np.ndarray:
    c, s = np.cos(t), np.sin(t)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def shift(x: float, y: float, z: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_poses_are_the_textbook_product(convention) -> None:
    """Standard: Rz Tz Tx Rx a row; modified (Craig): Rx Tx Rz Tz a row; base before, tool behind."""
    rng = np.random.default_rng(3)
    robot = rm.Robot.from_dh(
        **PUMA,
        theta_offset_deg=[0, 10, 0, -20, 0, 5],
        convention=convention,
        base_xyz_mm=[1, 2, 3],
        tool_xyz=[0, 0, 0.2],
    )
    for theta in rng.uniform(-2, 2, (5, 6)):
        T = shift(0.001, 0.002, 0.003)
        for i in range(6):
            turn = rot_z(theta[i] + np.deg2rad([0, 10, 0, -20, 0, 5][i]))
            up, out = shift(0, 0, PUMA["d_mm"][i] / 1e3), shift(PUMA["a_mm"][i] / 1e3, 0, 0)
            bend = rot_x(np.deg2rad(PUMA["alpha_deg"][i]))
            T = T @ (turn @ up @ out @ bend if convention == "standard" else bend @ out @ turn @ up)
        np.testing.assert_allclose(rm.tool_pose(robot, theta), T @ shift(0, 0, 0.2), atol=1e-14)


def test_a_table_by_either_unit_is_the_same_robot() -> None:
    in_mm = rm.Robot.from_dh(**PUMA, limits_deg=(-170, 170), C_theta_1e_7_rad_per_Nm=3.0)
    in_si = rm.Robot.from_dh(
        alpha=np.deg2rad(PUMA["alpha_deg"]),
        a=np.array(PUMA["a_mm"]) * 1e-3,
        d=np.array(PUMA["d_mm"]) * 1e-3,
        limits=np.deg2rad([[-170, 170]] * 6),
        C_theta=[3.0 * 1e-7] * 6,
    )
    assert in_mm == in_si


def test_a_robot_made_in_code_is_its_file() -> None:
    """The paper's arm, typed again: the numbers of samples/robots/slavkovic_5r.toml."""
    paper = rm.load_robot("slavkovic_5r").with_compliance_set("table_2")
    typed = rm.Robot.from_dh(
        alpha=paper.alpha,
        a=paper.a,
        d=paper.d,
        theta_offset=paper.theta_offset,
        limits=paper.limits_all,
        C_theta=paper.C_theta_all,
        sign=paper.sign,
        T_base=paper.T_base,
        T_tool=paper.T_tool,
        convention=paper.convention,
    )
    theta = np.random.default_rng(1).uniform(-1, 1, (4, 5))
    assert np.array_equal(rm.tool_pose(typed, theta), rm.tool_pose(paper, theta))
    assert np.array_equal(rm.cartesian_compliance(typed, theta), rm.cartesian_compliance(paper, theta))


def test_a_stiffness_is_one_over_a_compliance() -> None:
    for given in ({"k_theta_Nm_per_rad": [8e5, 5e5]}, {"k_theta_kNm_per_rad": [800, 500]}):
        np.testing.assert_allclose(rm.Robot.from_dh(a_mm=[500, 400], **given).C_theta, [1.25e-6, 2e-6], rtol=1e-15)
    assert rm.Robot.from_dh(a_mm=[500, 400], k_theta_kNm_per_rad=[np.inf, 500]).C_theta[0] == 0.0
    assert rm.Robot.from_dh(a_mm=[500, 400], C_theta=[0, 2e-6]).C_theta[0] == 0.0


def test_joints_that_slide_have_limits_in_mm() -> None:
    robot = rm.Robot.from_dh(
        a_mm=[0, 500], prismatic=[True, False], limits_mm=[(0, 30_000), None], limits_deg=[None, (-90, 90)]
    )
    np.testing.assert_allclose(robot.limits, [[0, 30], [-np.pi / 2, np.pi / 2]])
    np.testing.assert_allclose(rm.tool_pose(robot, [25.0, 0.0])[:3, 3], [0.5, 0, 25.0])


def test_one_pair_in_degrees_is_for_what_turns_and_one_in_mm_for_what_slides() -> None:
    robot = rm.Robot.from_dh(
        a_mm=[0, 500], prismatic=[True, False], limits_deg=(-90, 90), limits_mm=(0, 300), C_theta=[1e-11, 1e-7]
    )
    np.testing.assert_allclose(robot.limits, [[0, 0.3], [-np.pi / 2, np.pi / 2]])
    assert robot.C_theta[0] == 1e-11, "a rail may be stiffer than any gear"


def test_one_joint_alone_may_turn_by_a_few_degrees() -> None:
    """Of an arm all of whose joints are held within three degrees somebody meant radians; of one joint nobody did."""
    assert rm.Robot.from_dh(a_mm=[500], limits_deg=(-3, 3)).limits[0, 1] == pytest.approx(np.pi / 60)
    with pytest.raises(RobotError, match="limits_deg is in degrees"):
        rm.Robot.from_dh(a_mm=[500, 400], limits_deg=(-3, 3))


def test_what_nobody_gave_is_assumed_and_says_so() -> None:
    bare = rm.Robot.from_dh(a_mm=[500, 400])
    assert {block: said.kind for block, said in bare.provenance.items()} == {
        "geometry": "user",
        "limits": "assumed",
        "base": "user",
        "tool": "user",
        "compliance": "assumed",
    }
    np.testing.assert_allclose(bare.limits, [[-np.pi, np.pi]] * 2)
    given = rm.Robot.from_dh(a_mm=[500, 400], limits_deg=(-90, 90), C_theta=1e-6)
    assert {said.kind for said in given.provenance.values()} == {"user"}


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"alpha": [90, 0, -90]}, "found 90 rad, .*alpha in rad, or alpha_deg"),
        ({"theta_offset": [0, 90], "a": [0.5, 0.4]}, "theta_offset_deg"),
        ({"a": [0, 1200, 300]}, "found 1200 m, .*a in m, or a_mm"),
        ({"a_mm": [500, 400], "limits": (-170, 170)}, "joint 1: limit: found 170 rad, .*limits_deg"),
        ({"a_mm": [500, 0], "prismatic": [0, 1], "limits": [(-1, 1), (0, 500)]}, "joint 2: .* limits_mm"),
        (
            {"a_mm": [500, 400], "C_theta": [2.5, 3.1]},
            "joint 1: C_theta=2.5 makes a stiffness of 0.4 N m/rad, expected 1000 to 1e.09",
        ),
        ({"a_mm": [500, 400], "C_theta_1e_7_rad_per_Nm": [3.0, 3e-7]}, "joint 2: .* stiffness of 3.33e"),
        ({"a_mm": [500, 400], "k_theta_Nm_per_rad": [800, 500]}, "stiffness of 800 N m/rad"),
        ({"a_mm": [500, 400], "k_theta_kNm_per_rad": [2.1e6, 1e6]}, "stiffness of 2.1e"),
        ({"a_mm": [500, 400], "tool_xyz": [0, 0, 150]}, "tool_xyz in m, or tool_xyz_mm"),
        ({"a_mm": [500, 400], "C_theta": 1e-6, "k_theta_Nm_per_rad": 1e6}, "given twice"),
        ({"a_mm": [500, 400], "a": [0.5, 0.4]}, "a and a_mm"),
        ({"a_mm": [500, 400], "alpha_deg": [0, 90, 0]}, "differ in length .a_mm 2, alpha_deg 3."),
        ({"a_mm": 500}, "no list of numbers"),
        ({"a_mm": [500, 400], "prismatic": [1, 0]}, "joint 1 slides and has no limits"),
        ({"a_mm": [500, 400], "limits_deg": [(-1, 1)]}, "for each of 2 joints"),
        ({"a_mm": [500, 400], "limits_deg": (90, -90)}, "lower limit"),
        ({"a_mm": ["x", 400]}, "a_mm: expected a number"),
        ({"a_mm": [500, 400], "k_theta_Nm_per_rad": [0, 1e6]}, "stiffness is above 0"),
        ({"a_mm": [500, 400], "T_tool": np.eye(4), "tool_xyz": [0, 0, 0]}, "T_tool and tool_xyz"),
    ],
)
def test_what_cannot_be_meant_is_refused(given, words: str) -> None:
    with pytest.raises(RobotError, match=words):
        rm.Robot.from_dh(**given)


def test_an_axis_of_many_turns_is_given_in_degrees() -> None:
    """A wrist of +-96 turns is real; plainly such a number is doubted, in degrees it is not."""
    robot = rm.Robot.from_dh(a_mm=[500, 400], limits_deg=(-34_560, 34_560))
    assert robot.limits[0, 1] == pytest.approx(96 * 2 * np.pi)
    assert rm.tool_pose(robot, [600.0, 0.0]).shape == (4, 4)


def test_a_changed_robot_is_asked_the_same() -> None:
    robot = rm.load_robot("slavkovic_5r")
    assert np.array_equal(robot.replace(a_mm=[0, 1000, 0, 0, 0]).a, [0, 1, 0, 0, 0])
    for wrong in ({"C_theta": [2.5] * 5}, {"alpha": [90, 0, 0, 0, 0]}):
        with pytest.raises(RobotError, match="is meant, give"):
            robot.replace(**wrong)


@pytest.mark.parametrize("joint", [1, 3, 5])
def test_a_compliance_as_papers_print_it_is_refused_by_its_joint(joint: int) -> None:
    C_theta = np.where(np.arange(1, 6) == joint, 7.14, 7.14e-7)
    with pytest.raises(RobotError, match=f"joint {joint}, compliance: found 7.14"):
        rm.load_robot("slavkovic_5r").replace(C_theta=C_theta)


def test_columns_and_limits_of_a_data_frame_are_numbers() -> None:
    """Of a table its rows count; its columns' names were taken for the limits of joint 1."""
    pd = pytest.importorskip("pandas")
    table = pd.DataFrame({"a": [500, 400], "lower": [-170, -150], "upper": [170, 150]})
    robot = rm.Robot.from_dh(a_mm=table["a"], limits_deg=table[["lower", "upper"]])
    assert robot == rm.Robot.from_dh(a_mm=[500, 400], limits_deg=[(-170, 170), (-150, 150)])


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"alpha_deg": [1.57, 0], "a_mm": [500, 400]}, "largest twist is 1.57.?°, in radians that is 90.?°"),
        ({"alpha_deg": [0, -3.14], "a_mm": [500, 400]}, "in radians that is 180.?°"),
        ({"alpha_deg": [0.5 * np.pi * 1.0029, 0], "a_mm": [500, 400]}, "is 90.?°"),
        ({"alpha_deg": [0.5 * np.pi * 1.0031, 0], "a_mm": [500, 400]}, None),
        ({"alpha_deg": [np.pi * 1.0029, 0], "a_mm": [500, 400]}, "is 180.?°"),
        ({"alpha_deg": [np.pi * 1.0031, 0], "a_mm": [500, 400]}, None),
        ({"alpha_deg": [0.0, 0.0], "a_mm": [500, 400]}, None),
        ({"alpha": [np.deg2rad(1.5708), 0], "a_mm": [500, 400]}, None),
        ({"theta_offset_deg": [1.574, 0], "a_mm": [500, 400]}, None),
        ({"a_mm": [500, 400], "limits_deg": 90}, "expected .lower, upper. for each of 2 joints"),
        ({"a_mm": [500, 400], "limits_deg": ["ab", "cd"]}, "joint 1: limits: expected two numbers"),
        ({"a_mm": [500, 400], "C_theta": [1e-3, 1e-9]}, None),
        ({"a_mm": [500, 400], "C_theta": [1e-7, 1.001e-3]}, "joint 2: C_theta=.* 999 N m/rad"),
        ({"a_mm": [500, 400], "C_theta": [0.999e-9, 1e-7]}, "joint 1: C_theta=.* 1e.09 N m/rad"),
        ({"a_mm": [500, 400], "T_tool": np.eye(3)}, "tool frame: expected a 4 x 4"),
        ({"a_mm": [500, 400], "T_tool": shift(0, 0, 150)}, "tool frame: found 150 m"),
        ({"a_mm": [500, 400], "T_base": shift(0, 0, -1500)}, "base frame: found .*1500 m"),
        ({"a_mm": [500, 400], "T_tool": shift(0, 0, 0.15), "T_base": shift(0, 1.5, 0)}, None),
        ({"a_mm": [5, 4], "prismatic": [0, 1], "limits_deg": [None, None]}, "joint 2 slides and has no limits"),
        ({"a_mm": [500, 400], "k_theta_kNm_per_rad": [1000, 0]}, "joint 2: k_theta_kNm_per_rad: found 0; a stiffness"),
        ({"a_mm": [500, 400], "k_theta_kNm_per_rad": [-1000, 500]}, "joint 1: k_theta_kNm_per_rad: found -1000; a "),
        ({"a_mm": [500, 400], "T_base": [[1, 0], [0, 1]]}, "base frame: expected a 4 x 4"),
        ({"alpha_deg": [4.7, 0], "a_mm": [500, 400]}, None),
        ({"alpha_deg": [0.78, 0], "a_mm": [500, 400]}, None),
        ({"a_mm": [20, 29.9]}, "a_mm: all links together are 49.9 mm long, expected at least 50"),
        ({"a_mm": [20, -29.9], "d_mm": [0.05, 0.0]}, "a_mm and d_mm: all links together are 49.95 mm long"),
        ({"a_mm": [20, 30.1]}, None),
        ({"a_mm": [5, 4.9], "tool_xyz_mm": [0, 0, 60]}, "9.9 mm long, expected at least 10"),
        ({"a_mm": [5, 5.1], "tool_xyz_mm": [0, 0, 60]}, None),
        ({"a_mm": [5, 5.1], "tool_xyz_mm": [0, 0, 40]}, "expected at least 50"),
        ({"a_mm": [20, 20], "tool_xyz_mm": [0, 0, 50]}, None),
        ({"a_mm": [5, 5.1], "prismatic": [1, 0], "limits_mm": [(0, 9), None]}, None),
        ({"a": [0.005, 0.0051]}, None),
        ({"a_mm": [500, 400], "limits_deg": [(-3.1, 3.1), (-2, 6.284)]}, "no joint could turn beyond 6.284.?°"),
        ({"a_mm": [500, 400], "limits_deg": [(-3.1, 3.1), (-2, 6.285)]}, None),
        ({"a_mm": [500, 400], "limits": [(-3, 3), None], "limits_deg": [(-90, 90), None]}, "joint 1: .* given twice"),
        ({"a_mm": [500, 400], "limits": [(-3, 3), None], "limits_deg": [None, (-90, 90)]}, None),
        ({"a_mm": [500, 400], "limits": (-10 * np.pi, 10 * np.pi)}, None),
        ({"a_mm": [500, 400], "limits": (-31.5, 3)}, "found 31.5 rad, expected at most 31.4; was 31.5.?° meant"),
        ({"a_mm": [500, 400], "limits_deg": "wide"}, "expected .lower, upper. for each of 2 joints"),
        ({"a_mm": [500, 400], "limits_deg": [("a", "b"), None]}, "joint 1: limits: expected two numbers"),
        ({"a_mm": [[500, 400]]}, "a: expected one number, or one a joint; found shape .1, 2."),
        ({"a_mm": [500, 400], "C_theta": [1e-6, 1e-6, 1e-6]}, "differ in length .a_mm 2, C_theta 3."),
        ({"a_mm": [500, 400], "tool_xyz_mm": [0, 100]}, "tool_xyz: expected three numbers, found 2"),
    ],
)
def test_where_numbers_become_another_unit_s_and_where_they_do_not_yet(given, words) -> None:
    """Right angles in radians, links in m and limits in radians among columns in degrees and mm, at their bounds."""
    if words is None:
        assert rm.Robot.from_dh(**given).n == 2
    else:
        with pytest.raises(RobotError, match=words):
            rm.Robot.from_dh(**given)


@pytest.mark.parametrize("title", ["", "The arm by the window"])
def test_a_refusal_names_the_arm_by_its_title_or_by_its_name_where_it_has_none(title: str) -> None:
    robot = rm.Robot.from_dh(a_mm=[500, 400], name="arm_7", title=title)
    full = with_new_joint(rm.load_robot("kuka_kr500").replace(name="arm_7", title=title), 0)
    who = f"^Robot '{title or 'arm_7'}'"
    for refused in (
        lambda: rm.Robot.from_dh(a_mm=[500, "x"], name="arm_7", title=title),
        lambda: rm.Robot.from_dh(a_mm=[500, 400], k_theta_kNm_per_rad=1e5, name="arm_7", title=title),
        lambda: robot.replace(limits_deg="wide"),
        lambda: robot.replace(sign=[1, 2]),
        lambda: with_joints(robot, []),
        lambda: with_new_joint(full, 0),
    ):
        with pytest.raises(RobotError, match=who):
            refused()
