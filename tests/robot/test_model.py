"""The robot as a value: replacement, blocked axes, conventions, digest."""

import pickle

import numpy as np
import pytest

import robomill as rm
from robomill.errors import RobotError
from tests.robot.written_otherwise import with_blocked, with_convention


def test_replace_checks_and_keeps_the_original():
    robot = rm.load_robot("slavkovic_5r")
    softer = robot.replace(C_theta=robot.C_theta * 2)
    assert softer.compliance_set == "user"
    assert robot.compliance_set == "table_2"
    assert softer != robot
    assert softer.with_compliance_set("table_2") == robot
    with pytest.raises(TypeError, match="no 'colour'; it takes name, "):
        robot.replace(colour="red")
    with pytest.raises(ValueError, match="read-only"):
        robot.C_theta[0] = 1.0


def test_digest_and_pickle():
    robot = rm.load_robot("slavkovic_5r")
    assert pickle.loads(pickle.dumps(robot)) == robot
    assert robot.digest() == rm.load_robot("slavkovic_5r").digest()
    assert hash(robot) == hash(pickle.loads(pickle.dumps(robot)))


@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500", "fanuc_r2000ic", "planar_3r"])
def test_conversion_between_conventions_keeps_every_pose(name):
    robot = rm.load_robot(name)
    theta = np.random.default_rng(0).uniform(-3, 3, (200, robot.n))
    for convention in ("standard", "modified"):
        other = with_convention(robot, convention)
        np.testing.assert_allclose(rm.tool_pose(other, theta), rm.tool_pose(robot, theta), atol=1e-12)
        back = with_convention(other, robot.convention)
        np.testing.assert_allclose(rm.tool_pose(back, theta), rm.tool_pose(robot, theta), atol=1e-12)


def test_a_modified_table_read_as_standard_shows_in_the_pose():
    robot = rm.load_robot("kuka_kr500")
    wrong = robot.replace(convention="standard")
    assert np.abs(rm.tool_pose(wrong, robot.home) - rm.tool_pose(robot, robot.home)).max() > 0.1


@pytest.mark.parametrize("row", [1, 3, 6])
def test_a_blocked_axis_neither_moves_nor_gives(row):
    robot = rm.load_robot("kuka_kr500")
    held = with_blocked(robot, row, 0.3)
    theta = np.random.default_rng(row).uniform(-1, 1, (20, 6))
    theta[:, row - 1] = 0.3
    free = np.delete(theta, row - 1, axis=1)
    assert held.n == 5
    assert row not in held.joint_numbers
    np.testing.assert_allclose(rm.tool_pose(held, free), rm.tool_pose(robot, theta), atol=1e-12)
    np.testing.assert_allclose(
        rm.geometric_jacobian(held, free), np.delete(rm.geometric_jacobian(robot, theta), row - 1, axis=2), atol=1e-12
    )
    rigid = robot.replace(C_theta=np.where(np.arange(6) == row - 1, 0.0, robot.C_theta))
    np.testing.assert_allclose(rm.cartesian_compliance(held, free), rm.cartesian_compliance(rigid, theta), atol=1e-18)
    assert with_blocked(held, row, None) == robot


def test_replace_takes_free_or_all_rows_of_a_blocked_arm():
    held = with_blocked(rm.load_robot("kuka_kr500"), 6, 0.0)
    changed = held.replace(C_theta=held.C_theta * 3)
    assert changed.C_theta_all[5] == held.C_theta_all[5]
    np.testing.assert_array_equal(changed.C_theta, held.C_theta * 3)
    assert held.replace(C_theta=held.C_theta_all * 3).C_theta_all[5] == held.C_theta_all[5] * 3


def test_table_1_of_the_paper_at_zero():
    robot = rm.load_robot("slavkovic_5r")
    # PAPER: the tip at (0, -d_4, a_2 - a_5), the tool pointing down: the axes of {T} are those of {M}.
    np.testing.assert_allclose(
        rm.tool_pose(robot, np.zeros(5)),
        [[1, 0, 0, 0], [0, 1, 0, -1.1], [0, 0, 1, 1.22 - 0.3], [0, 0, 0, 1]],
        atol=1e-15,
    )


def test_free_joints_are_given_in_degrees_and_those_that_slide_in_millimetres():
    arm = rm.load_robot("planar_3r")
    slides = arm.replace(prismatic=np.array([False, True, False]))
    assert slides.joint_units == ("deg", "mm", "deg")
    assert arm.joint_units == ("deg",) * 3
    assert with_blocked(slides, 1, 0.1).joint_units == ("mm", "deg")


def test_a_row_of_the_table_is_a_joint_in_the_units_that_it_names():
    """Written out by hand: of the joint that slides mm and 1e-9 m/N, of the others degrees and 1e-7 rad/(N m)."""
    robot = rm.Robot.from_dh(
        alpha_deg=[90, 0, -30],
        a_mm=[100, 0, 50],
        d_mm=[400, 20, 0],
        theta_offset_deg=[0, 15, 0],
        sign=[1, 1, -1],
        prismatic=[False, True, False],
        limits_deg=[(-170, 160), None, (-90, 80)],
        limits_mm=[None, (-50, 700), None],
        C_theta=[2.5e-7, 3e-8, 4e-7],
    )
    table = with_blocked(robot, 3, 0.1).columns()
    expected = {
        "joint": [1, 2, 3],
        "alpha_deg": [90, 0, -30],
        "a_mm": [100, 0, 50],
        "d_mm": [400, 20, 0],
        "theta_offset_deg": [0, 15, 0],
        "sign": [1, 1, -1],
        "free": [True, True, False],
        "lower": [-170, -50, -90],
        "upper": [160, 700, 80],
        "compliance": [2.5, 30, 4],
    }
    for name, values in expected.items():
        np.testing.assert_allclose(table[name], values, rtol=1e-12, atol=1e-12, err_msg=name)
    assert table["limit_unit"].tolist() == ["deg", "mm", "deg"]
    assert table["compliance_unit"].tolist() == ["1e-7 rad/(N m)", "1e-9 m/N", "1e-7 rad/(N m)"]
    said = [repr(rm.Robot.from_dh(a_mm=[500, 400])), repr(robot), repr(with_blocked(robot, 3, 0.1))]
    assert "2 joints, standard D-H, compliances assumed" in said[0]
    assert "3 joints, 1 sliding, standard" in said[1]
    assert "3 joints, 1 sliding, 1 of them held, standard" in said[2]


def test_compliances_of_a_set_come_with_it_and_one_number_is_for_all_free_joints():
    paper = rm.load_robot("slavkovic_5r")
    other = {**paper.compliance_sets, "mine": np.arange(1.0, 6.0) * 1e-7}
    changed = paper.replace(compliance_sets=other, compliance_set="mine")
    np.testing.assert_array_equal(changed.C_theta, np.arange(1.0, 6.0) * 1e-7)
    np.testing.assert_array_equal(changed.replace(compliance_set="table_2").C_theta, paper.C_theta)
    held = with_blocked(rm.load_robot("kuka_kr500"), 2, 0.0).replace(C_theta=5e-7)
    np.testing.assert_array_equal(held.C_theta, [5e-7] * 5)
    assert held.C_theta_all[1] == rm.load_robot("kuka_kr500").C_theta_all[1]


def sliding_arm_with_its_first_joint_held() -> rm.Robot:
    """Rows that turn, slide, turn and turn; the first stands still."""
    robot = rm.Robot.from_dh(
        a_mm=[100, 200, 300, 400],
        prismatic=[False, True, False, False],
        limits_deg=[(-11, 11), None, (-33, 33), (-44, 44)],
        limits_mm=[None, (0, 22), None, None],
        C_theta=[1e-7, 2e-7, 3e-7, 4e-7],
    )
    return with_blocked(robot, 1, 0.0)


@pytest.mark.parametrize(
    ("changes", "limits"),
    [
        ({"limits_deg": [None, (-50, 60), None]}, [None, None, (-50, 60), None]),
        ({"limits_mm": [(5, 70), None, None]}, [None, (5, 70), None, None]),
        ({"limits_mm": [(5, 70), None, None], "limits_deg": [None, None, (1, 2)]}, [None, (5, 70), None, (1, 2)]),
        ({"limits_deg": [(-5, 5), None, None, (-9, 8)]}, [(-5, 5), None, None, (-9, 8)]),
        ({"limits_mm": [None, (5, 70), None, None]}, [None, (5, 70), None, None]),
        ({"limits_deg": (-50, 60)}, [None, None, (-50, 60), (-50, 60)]),
        ({"limits_deg": (-50, 60), "limits_mm": (5, 70)}, [None, (5, 70), (-50, 60), (-50, 60)]),
    ],
)
def test_limits_by_a_unit_are_of_the_free_joints_or_of_all_rows(changes, limits):
    """Written out by row: what is None stays, degrees go to what turns, millimetres to what slides."""
    robot = sliding_arm_with_its_first_joint_held()
    table, old = robot.replace(**changes).columns(), robot.columns()
    for row, pair in enumerate(limits):
        expected = pair or (old["lower"][row], old["upper"][row])
        assert (table["lower"][row], table["upper"][row]) == pytest.approx(expected), row


@pytest.mark.parametrize(
    ("changes", "compliances"),
    [
        ({"k_theta_kNm_per_rad": [2000, 4000, 5000]}, [1e-7, 5e-7, 2.5e-7, 2e-7]),
        ({"k_theta_Nm_per_rad": [1e6, 2e6, 4e6, 5e6]}, [1e-6, 5e-7, 2.5e-7, 2e-7]),
        ({"C_theta_1e_7_rad_per_Nm": [6, 7, 8]}, [1e-7, 6e-7, 7e-7, 8e-7]),
        ({"C_theta": [6e-7, 7e-7, 8e-7]}, [1e-7, 6e-7, 7e-7, 8e-7]),
        ({"C_theta": [5e-7, 6e-7, 7e-7, 8e-7]}, [5e-7, 6e-7, 7e-7, 8e-7]),
        ({"C_theta": 6e-7}, [1e-7, 6e-7, 6e-7, 6e-7]),
        ({"k_theta_kNm_per_rad": 2000}, [1e-7, 5e-7, 5e-7, 5e-7]),
        ({"C_theta_1e_7_rad_per_Nm": 6.0}, [1e-7, 6e-7, 6e-7, 6e-7]),
    ],
)
def test_one_compliance_is_for_all_free_joints_and_a_held_one_keeps_its_own_by_whatever_name(changes, compliances):
    robot = sliding_arm_with_its_first_joint_held()
    np.testing.assert_allclose(robot.replace(**changes).C_theta_all, compliances)


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize(
    "wrong",
    [
        {"limits": None},
        {"limits": [(-1, 1, 2)] * 3},
        {"limits": [(-1, 1)] * 2},
        {"limits": [("a", "b")] * 3},
        {"limits_deg": [(-1, 1)] * 2},
        {"C_theta": None},
        {"C_theta": [[1e-7, 2e-7]] * 3},
        {"C_theta": [1e-7, 2e-7]},
        {"k_theta_kNm_per_rad": [1000, 2000]},
        {"k_theta_kNm_per_rad": [1000, 2000, 3000, 4000, 5000]},
    ],
)
def test_what_has_another_shape_is_refused_of_an_arm_with_a_held_axis_too(held, wrong):
    robot = sliding_arm_with_its_first_joint_held()
    with pytest.raises(RobotError, match="expected"):
        (robot if held else with_blocked(robot, 1, None)).replace(**wrong)
