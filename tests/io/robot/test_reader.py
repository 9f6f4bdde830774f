"""Robots as TOML: exact round trip, and one clear sentence for each bad input."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import RobotError
from robomill.io.robot.reader import robot_from_toml
from robomill.io.robot.robots import robot_names
from robomill.io.robot.writer import robot_to_toml
from robomill.io.samples import samples_dir

SAMPLE = (samples_dir() / "robots/slavkovic_5r.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", robot_names())
def test_presets_round_trip_exactly(name):
    robot = rm.load_robot(name)
    assert robot_from_toml(robot_to_toml(robot)) == robot


def test_round_trip_of_awkward_numbers():
    rng = np.random.default_rng(5)
    for _ in range(50):
        n = int(rng.integers(2, 8))
        robot = rm.Robot(
            name='a "quoted" name \\ with ü',
            convention=str(rng.choice(["standard", "modified"])),
            alpha=rng.normal(size=n),
            a=rng.normal(size=n) / 3,
            d=rng.normal(size=n) * 1e-7,
            theta_offset=rng.normal(size=n),
            sign=rng.choice([-1, 1], n),
            prismatic=rng.random(n) < 0.3,
            limits_all=np.sort(rng.normal(size=(n, 2)), axis=1),
            C_theta_all=rng.random(n) * 1e-6,
            blocked=np.where(np.arange(n) == 1, rng.normal(), np.nan),
            compliance_sets={"odd name.1": rng.random(n)},
        )
        assert robot_from_toml(robot_to_toml(robot)).digest() == robot.digest()


@pytest.mark.parametrize("name", robot_names())
def test_every_block_of_a_preset_says_where_it_comes_from(name):
    robot = rm.load_robot(name)
    blocks = {"geometry", "limits", "base", "tool", *(f"compliance.{key}" for key in robot.compliance_sets)}
    assert blocks <= set(robot.provenance)
    assert all(robot.provenance[block].source != "not stated" for block in blocks)


def test_what_the_paper_does_not_print_is_marked_assumed():
    robot = rm.load_robot("slavkovic_5r")
    assert robot.provenance["lengths"].kind == "assumed"
    assert robot.provenance["limits"].kind == "assumed"
    assert robot.provenance["compliance.table_2"].kind == "paper"
    assert robot.compliance_set == "table_2"


BAD = [
    ("a_mm = 1220", "a_mm = nan", "joint 2.*a_mm.*nan"),
    ("a_mm = 1220", "a_mm = inf", "joint 2.*a_mm.*inf"),
    ("a_mm = 1220", 'a_mm = "long"', "joint 2.*a_mm.*expected a number.*long"),
    ("a_mm = 1220\n", "", "joint 2.*a is missing"),
    ("a_mm = 1220", "a_cm = 122", "joint 2.*a_cm"),
    ("a_mm = 1220", "a_mm = 1220\na_m = 1.22", "joint 2.*given twice"),
    (
        "limits_deg = [-120, 120]\n\n[[joint]]\nalpha_deg = 0",
        "limits_deg = [120, -120]\n\n[[joint]]\nalpha_deg = 0",
        "joint 1.*lower limit 120° is not below the upper limit −120°",
    ),
    ("limits_deg = [-110, 70]", "limits_deg = [-110]", "joint 2.*expected .lower, upper."),
    ("limits_deg = [-110, 70]", "limits_deg = [-110, nan]", "joint 2.*nan"),
    ("7.14, 10.12", "-7.14, 10.12", "joint 1: compliance.*expected 0 .*or more"),
    ("7.14, 10.12", "10.12", "expected 5 numbers.*found 4"),
    ('use = "table_2"', 'use = "table_9"', "table_9.*table_2, table_3"),
    ("sign = -1", "sign = 0", "joint 4: sign is 0"),
    ("sign = -1", "sign = true", "joint 4.*sign.*True"),
    ('convention = "standard"', 'convention = "craig"', "craig.*standard.*modified"),
    (
        "rotation = [[0, 0, -1], [0, -1, 0], [-1, 0, 0]]",
        "rotation = [[1, 0, 0], [0, 1, 0], [0, 1, 1]]",
        "tool frame is not a rotation",
    ),
    ("rotation = [[0, 0, -1], [0, -1, 0], [-1, 0, 0]]", "rotation = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]", "mirror"),
    ("xyz_mm = [0, 0, 0]\n\n# z_T", "xyz_mm = [0, 0]\n\n# z_T", "base.*three numbers"),
    ("version = 1", "version = 2", "version"),
    ("alpha_deg = 90\na_mm", "alpha_deg 90\na_mm", "not a readable TOML file"),
    ('kind = "paper", source = "{M}', 'kind = "hearsay", source = "{M}', "provenance.*kind.*hearsay"),
    ("a_mm = 1220", "a_mm = 1220\ncolour = 1", "joint 2, colour: this key is not known here.*a_m, a_mm, alpha_deg"),
    ("a_mm = 1220", 'a_mm = 1220\ntype = "ball"', "joint 2, type: expected one of revolute, prismatic, found 'ball'"),
    ('name = "slavkovic_5r"', 'name = "slavkovic_5r"\nweight_kg = 9', "weight_kg: this key is not known here"),
    ('name = "slavkovic_5r"', "name = 5", "name: expected text in quotes, found 5"),
    ('use = "table_2"', 'use = "table_2"\nwish = 3', "compliance.*wish: this key is not known here"),
    ("7.14, 10.12", '"7", 10.12', "compliance.table_2.*expected a number in 1e-7"),
    (
        '"C_theta_1e-7_rad_per_Nm" = [7.14',
        "C_theta_SI = [1, 1, 1, 1, 1]\nk_theta_Nm_per_rad = [7.14",
        r"table_2\W+(C_theta_SI or k_theta_Nm_per_rad|k_theta_Nm_per_rad or C_theta_SI)\W+give exactly one of",
    ),
    ('"C_theta_1e-7_rad_per_Nm" = [7.14', "# [7.14", r"table_2\W+numbers\W+give exactly one of"),
    (
        '"C_theta_1e-7_rad_per_Nm" = [7.14, 10.12',
        "k_theta_Nm_per_rad = [7.14, 0.0",
        "joint 2: the stiffness is 0; .*above",
    ),
    ("rotation = [[0, 0, -1], [0, -1, 0], [-1, 0, 0]]", "rotation = [[1, 0, 0], [0, 1, 0]]", "3 rows.*found 2"),
    (
        "rotation = [[0, 0, -1], [0, -1, 0], [-1, 0, 0]]",
        "rotation = [[1, 0, 0], [0, 1], [0, 0, 1]]",
        "row 2: expected 3",
    ),
    ('format = "robomill robot"', 'format = "spreadsheet"', "expected format 'robomill robot', version 1; found 'spre"),
]


@pytest.mark.parametrize(("find", "replace", "words"), BAD, ids=[row[2][:30] for row in BAD])
def test_bad_input_gets_one_clear_sentence(find, replace, words):
    assert SAMPLE.count(find) >= 1
    with pytest.raises(RobotError, match=f"(?s){words}") as error:
        robot_from_toml(SAMPLE.replace(find, replace, 1), "mine.toml")
    message = str(error.value)
    assert message.endswith((".", ")."))
    assert "\n" not in message
    assert message.startswith("mine.toml")


def test_zero_joints_and_too_many():
    head = SAMPLE[: SAMPLE.index("# Table 1")]
    tail = SAMPLE[SAMPLE.index("[base]") :]
    with pytest.raises(RobotError, match="no joints"):
        robot_from_toml(head + tail)
    joint = "[[joint]]\nalpha_deg = 0\na_mm = 1\nd_mm = 0\ntheta_offset_deg = 0\nlimits_deg = [-1, 1]\n"
    row = tail.replace("[7.14, 10.12, 12.30, 17.32, 91.35]", str([1] * 8)).replace(
        "[9.03, 11.17, 14.74, 27.65, 97.58]", str([1] * 8)
    )
    with pytest.raises(RobotError, match="1 to 7 joints, found 8"):
        robot_from_toml(head + joint * 8 + row)


def test_all_axes_blocked():
    robot = rm.load_robot("planar_2r")
    with pytest.raises(RobotError, match="every axis is blocked"):
        robot.replace(blocked=[0.0, 0.0])


def test_unknown_name_lists_the_presets(tmp_path):
    with pytest.raises(RobotError, match="slavkovic_5r"):
        rm.load_robot("slavkowic")
    binary = tmp_path / "robot.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(RobotError, match="not a text file"):
        rm.load_robot(binary)


def test_what_may_be_left_out_has_the_usual_value():
    joint = "[[joint]]\nalpha_rad = 0.5\na_m = 1\nd_m = 0.25\ntheta_offset_rad = 0.125\nlimits_rad = [-1, 2]\n"
    slide = joint.replace("limits_rad", 'type = "prismatic"\nsign = -1\nname = "slide"\nblocked_at_mm = 500\nlimits_m')
    robot = robot_from_toml(joint + slide + "[compliance]\nC_theta_SI = [1e-6, 2e-6]\n", "shelf/arm.toml")
    assert (robot.name, robot.title, robot.convention, robot.compliance_set) == ("arm", "", "standard", "user")
    np.testing.assert_array_equal(robot.T_base, np.eye(4))
    np.testing.assert_array_equal(robot.T_tool, np.eye(4))
    np.testing.assert_array_equal(robot.sign, [1, -1])
    np.testing.assert_array_equal(robot.prismatic, [False, True])
    np.testing.assert_array_equal(robot.blocked, [np.nan, 0.5])
    np.testing.assert_array_equal(robot.alpha, [0.5, 0.5])
    np.testing.assert_array_equal(robot.theta_offset, [0.125, 0.125])
    np.testing.assert_array_equal(robot.d, [0.25, 0.25])
    np.testing.assert_array_equal(robot.limits_all, [[-1, 2], [-1, 2]])
    np.testing.assert_array_equal(robot.C_theta_all, [1e-6, 2e-6])


def test_the_first_set_is_in_force_unless_one_is_named():
    text = SAMPLE.replace('use = "table_2"\n', "")
    assert robot_from_toml(text).compliance_set == "table_2"
    own = SAMPLE.replace('use = "table_2"', 'use = "table_3"\nC_theta_SI = [1, 2, 3, 4, 5]')
    with pytest.raises(RobotError, match="compliance set 'table_3' has other numbers than are given"):
        robot_from_toml(own)  # they would pass for the paper's
    unnamed = robot_from_toml(own.replace('use = "table_3"\n', ""))  # numbers beside the sets are the user's own
    assert (unnamed.compliance_set, unnamed.C_theta_all.tolist()) == ("user", [1, 2, 3, 4, 5])
    np.testing.assert_allclose(unnamed.compliance_sets["table_3"] / 1e-7, [9.03, 11.17, 14.74, 27.65, 97.58])
    with pytest.raises(RobotError, match=r"compliance: missing; give \[compliance\] with use"):
        robot_from_toml(SAMPLE[: SAMPLE.index("[compliance]")])


def test_stiffness_reads_as_compliance():
    robot = rm.load_robot("kuka_kr500")
    np.testing.assert_allclose(1 / robot.C_theta, [6.5e6, 7.6e6, 3.08e6, 5e5, 6e5, 4e5], rtol=1e-14)


def test_any_stiffness_above_zero_is_one():
    soft = SAMPLE.replace('"C_theta_1e-7_rad_per_Nm" = [7.14, 10.12', "k_theta_Nm_per_rad = [0.25, 2.0", 1)
    np.testing.assert_array_equal(robot_from_toml(soft).C_theta[:2], [4.0, 0.5])
