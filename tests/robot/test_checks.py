"""What cannot be a robot is refused in a sentence that names the joint; what just can be is taken."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import RobotError
from tests.robot.written_otherwise import with_blocked

TABLE = {
    "name": "two",
    "convention": "standard",
    "alpha": [0.0, 0.0],
    "a": [0.5, 0.4],
    "d": [0.0, 0.0],
    "theta_offset": [0.0, 0.0],
    "limits_all": [[-1.0, 1.0], [-2.0, 2.0]],
    "C_theta_all": [1e-6, 2e-6],
}
MIRROR = np.diag([1.0, 1.0, -1.0, 1.0])
STRETCHED = np.diag([1.0 + 1e-7, 1.0, 1.0, 1.0])
SHIFTED = np.diag([1.0, 1.0, 1.0, 1.0 + 1e-3])


@pytest.mark.parametrize(
    ("field", "value", "sentence"),
    [
        ("name", "", "the name is empty"),
        ("name", "  ", "the name is empty"),
        ("name", 3, "name: expected a text, found 3"),
        ("convention", "craig", "convention is 'craig'; expected 'standard' or 'modified'"),
        ("alpha", [], "expected 1 to 7 joints, found none"),
        ("alpha", [0.0] * 8, "expected 1 to 7 joints, found 8"),
        ("alpha", [[0.0, 0.0]], r"α: expected one number a joint, found shape \(1, 2\)"),
        ("a", [0.5], r"a: expected 2 numbers, one a joint, found shape \(1,\)"),
        ("a", [0.5, "long"], "a: expected numbers, found 'long'"),
        ("a", "long", "a: expected numbers, found 'long'"),
        ("d", [0.0, np.nan], r"joint 2: d is NaN \(a missing value\)"),
        ("d", [np.inf, 0.0], "joint 1: d is infinity"),
        ("sign", [1.0, 0.5], "joint 2: sign is 0.5; it must be 1 or -1"),
        ("prismatic", [True], "prismatic: expected True or False for each of 2 joints, found .True."),
        (
            "prismatic",
            ["prismatic", "revolute"],
            "prismatic, joint 1: expected True where it slides or False .* .prismatic.",
        ),
        ("prismatic", "revolute", "prismatic: expected True where it slides or False where it turns, found .revolute."),
        ("prismatic", [0, 2], "prismatic, joint 2: expected True where it slides or False where it turns, found 2"),
        ("limits_all", [[-1.0, 1.0]], r"limits: expected \[lower, upper\] for 2 joints, found shape \(1, 2\)"),
        ("limits_all", "wide", r"limits: expected numbers, found 'wide'"),
        ("limits_all", [[-1.0, 1.0], [np.nan, 2.0]], "joint 2: lower limit is NaN"),
        ("limits_all", [[-1.0, np.inf], [0.0, 2.0]], "joint 1: upper limit is infinity"),
        ("limits_all", [[-1.0, 1.0], [1.0, 1.0]], "joint 2: the lower limit 57.2958° is not below the upper limit"),
        ("limits_all", [[1.0, -1.0], [0.0, 1.0]], "joint 1: the lower limit 57.2958° is not below the upper limit"),
        ("blocked", [np.nan], r"blocked: expected 2 values, NaN for a free joint, found shape \(1,\)"),
        ("blocked", [np.inf, np.nan], "blocked: expected 2 values"),
        ("blocked", [0.0, 0.0], "every axis is blocked; leave at least one free"),
        ("C_theta_all", [1e-6, -1e-6], r"joint 2: compliance is .10 .*; expected 0 .*or more"),
        ("compliance_sets", {"table": [1e-6, -1e-6]}, "joint 2: compliance set 'table' is"),
        ("compliance_sets", {"table": [1e-6]}, "compliance set 'table': expected 2 numbers"),
        ("compliance_set", "table", r"compliance set 'table' is not among its sets \(none\)"),
        ("T_base", np.eye(3), r"the base frame: expected a 4 x 4 matrix of finite numbers, found shape \(3, 3\)"),
        ("T_base", np.full((4, 4), np.nan), "the base frame: expected a 4 x 4 matrix of finite numbers"),
        ("T_base", "eye", "the base frame: expected a 4 x 4 matrix of numbers, found 'eye'"),
        ("T_tool", MIRROR, "the tool frame is not a rotation and a shift .it is a mirror image"),
        ("T_tool", STRETCHED, "the tool frame is not a rotation and a shift .it is off by 2e-07"),
        ("T_tool", -STRETCHED, "the tool frame is not a rotation and a shift .it is off by"),
        ("T_tool", SHIFTED, "the tool frame is not a rotation and a shift"),
    ],
)
def test_refusals(field, value, sentence):
    with pytest.raises(RobotError, match=sentence) as refused:
        rm.Robot(**{**TABLE, field: value})
    assert str(refused.value).startswith("Robot")


def test_units_of_a_refusal_are_those_of_the_joint():
    sliding = {**TABLE, "prismatic": [False, True]}
    with pytest.raises(RobotError, match="joint 2: the lower limit 500 mm is not below the upper limit 200 mm"):
        rm.Robot(**{**sliding, "limits_all": [[-1, 1], [0.5, 0.2]]})
    with pytest.raises(RobotError, match="joint 2: compliance is .*m/N|joint 2: compliance is .*N/"):
        rm.Robot(**{**sliding, "C_theta_all": [0.0, -1e-9]})


def test_what_is_just_allowed():
    robot = rm.Robot(**TABLE)
    assert (robot.n, robot.rows) == (2, 2)
    np.testing.assert_array_equal(robot.sign, 1.0)
    np.testing.assert_array_equal(robot.T_base, np.eye(4))
    np.testing.assert_array_equal(robot.T_tool, np.eye(4))
    assert not robot.prismatic.any()
    assert robot.free.all()
    assert rm.Robot(**{**TABLE, "C_theta_all": [0.0, 0.0]}).C_theta.sum() == 0.0  # rigid
    assert rm.Robot(**{**TABLE, "sign": [-1.0, 1.0]}).sign[0] == -1.0
    seven = {key: np.resize(np.asarray(value, float), 7) for key, value in TABLE.items() if key in ("alpha", "a", "d")}
    rest = {"theta_offset": [0] * 7, "limits_all": [[-1, 1]] * 7, "C_theta_all": [1e-6] * 7}
    assert rm.Robot(**{**TABLE, **seven, **rest}).n == 7
    nearly = np.eye(4)
    nearly[0, 0] += 2e-10
    assert rm.Robot(**{**TABLE, "T_base": nearly}).T_base[0, 0] > 1.0


def test_home_is_zero_or_mid_range():
    limits = [[-1.0, 1.0], [0.5, 2.0]]
    np.testing.assert_allclose(rm.Robot(**{**TABLE, "limits_all": limits}).home, [0.0, 1.25])
    np.testing.assert_allclose(rm.Robot(**{**TABLE, "limits_all": [[0.0, 1.0], [-2.0, 0.0]]}).home, [0.0, 0.0])
    np.testing.assert_allclose(rm.Robot(**{**TABLE, "limits_all": [[-3.0, -1.0], [-2.0, 0.0]]}).home, [-2.0, 0.0])


def test_short_columns_are_filled_up_where_an_axis_is_blocked():
    robot = with_blocked(rm.load_robot("kuka_kr500"), 3, 0.1)
    given = np.arange(1, 6) * 1e-7
    changed = robot.replace(C_theta=given, limits=np.tile([-0.5, 0.7], (5, 1)))
    np.testing.assert_array_equal(changed.C_theta, given)
    assert changed.C_theta_all[2] == robot.C_theta_all[2]
    np.testing.assert_array_equal(changed.limits_all[2], robot.limits_all[2])
    np.testing.assert_array_equal(changed.limits, np.tile([-0.5, 0.7], (5, 1)))
    assert changed.joint_numbers == (1, 2, 4, 5, 6)
    whole = robot.replace(C_theta=np.arange(1, 7) * 1e-7)
    np.testing.assert_array_equal(whole.C_theta_all, np.arange(1, 7) * 1e-7)
    with pytest.raises(RobotError, match="expected 6 numbers"):
        robot.replace(C_theta=[1e-7] * 4)


def test_axes_and_sets_that_are_not_there():
    robot = rm.load_robot("slavkovic_5r")
    for row in (1, 5):
        assert with_blocked(robot, row, 0.0).n == 4
        assert with_blocked(with_blocked(robot, row, 0.0), row, None) == robot
    with pytest.raises(RobotError, match="has no compliance set 'table_9'; it has: .*table_2"):
        robot.with_compliance_set("table_9")
    assert robot != "slavkovic_5r"
    assert robot.replace(title="other") != robot
