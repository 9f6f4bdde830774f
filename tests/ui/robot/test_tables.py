"""Tables of a robot on the screen to the model and back, in the units people type."""

from __future__ import annotations

import re

import numpy as np
import pytest

from robomill.errors import RobotError
from robomill.io.robots import load_robot
from robomill.robot.model import Robot
from robomill.ui.robot import tables
from robomill.units import to_si


@pytest.fixture(scope="module")
def robot() -> Robot:
    return load_robot("slavkovic_5r")


@pytest.mark.parametrize("unit", ["1e-7 rad/(N m)", "kN m/rad"])
def test_an_unchanged_table_changes_nothing(robot: Robot, unit: str) -> None:
    same = tables.with_compliance(robot, tables.compliance_frame(robot, unit), unit)
    np.testing.assert_allclose(same.C_theta, robot.C_theta, rtol=1e-9)
    assert same.compliance_set == "table_2"
    assert tables.with_geometry(robot, tables.geometry_frame(robot)).digest() == robot.digest()
    assert tables.with_limits(robot, tables.limits_frame(robot)).digest() == robot.digest()


def test_the_papers_own_notation_can_be_typed(robot: Robot) -> None:
    frame = tables.compliance_frame(robot, "1e-7 rad/(N m)")
    assert frame["value"].tolist() == ["7.14", "10.12", "12.3", "17.32", "91.35"]
    frame.loc[0, "value"] = "7.5"
    changed = tables.with_compliance(robot, frame, "1e-7 rad/(N m)")
    assert changed.C_theta[0] == to_si(7.5, "1e-7 rad/(N m)")
    assert changed.compliance_set == "user"


def test_typing_table_3_is_table_3(robot: Robot) -> None:
    frame = tables.compliance_frame(robot.with_compliance_set("table_3"), "1e-7 rad/(N m)")
    assert tables.with_compliance(robot, frame, "1e-7 rad/(N m)").compliance_set == "table_3"


def test_stiffness_is_the_inverse(robot: Robot) -> None:
    frame = tables.compliance_frame(robot, "kN m/rad")
    frame["value"] = ["1000", "900.0", "800,0", "5e2", " 100 "]
    changed = tables.with_compliance(robot, frame, "kN m/rad")
    np.testing.assert_allclose(changed.C_theta, [1e-6, 1 / 0.9e6, 1 / 0.8e6, 2e-6, 1e-5], rtol=1e-12)


@pytest.mark.parametrize(
    ("unit", "value", "word"),
    [
        ("1e-7 rad/(N m)", None, "Joint 2: the compliance is missing"),
        ("1e-7 rad/(N m)", float("nan"), "Joint 2: the compliance is missing"),
        ("1e-7 rad/(N m)", "", "Joint 2: the compliance is missing"),
        ("1e-7 rad/(N m)", "-1", "Joint 2: the compliance is -1; expected a finite number, 0 or more"),
        ("1e-7 rad/(N m)", "-7e-7", "Joint 2: the compliance is -7e-7"),
        ("1e-7 rad/(N m)", "1e999", "Joint 2: the compliance is 1e999"),
        ("1e-7 rad/(N m)", "inf", "Joint 2: the compliance 'inf' is not a number"),
        ("1e-7 rad/(N m)", "∞", "Joint 2: the compliance '∞' is not a number"),
        ("1e-7 rad/(N m)", "7.14e-", "Joint 2: the compliance '7.14e-' is not a number"),
        ("1e-7 rad/(N m)", "7.14 rad", "Joint 2: the compliance '7.14 rad' is not a number"),
        ("1e-7 rad/(N m)", "1,012.5", "Joint 2: the compliance '1,012.5' is not a number"),
        ("kN m/rad", "0", "Joint 2: the stiffness is 0; expected a finite number greater than 0 kN m/rad"),
        ("kN m/rad", "nan", "Joint 2: the stiffness 'nan' is not a number"),
        ("kN m/rad", None, "Joint 2: the stiffness is missing"),
    ],
)
def test_a_bad_compliance_names_its_joint(robot: Robot, unit: str, value: object, word: str) -> None:
    frame = tables.compliance_frame(robot, unit)
    frame.loc[1, "value"] = value
    with pytest.raises(RobotError, match=re.escape(word)):
        tables.with_compliance(robot, frame, unit)


@pytest.mark.parametrize(
    ("typed", "unit", "C"),
    [
        ("7.14", "1e-7 rad/(N m)", 7.14e-7),
        ("12,3", "1e-7 rad/(N m)", 12.3e-7),
        (" +12. ", "1e-7 rad/(N m)", 12e-7),
        (",5", "1e-7 rad/(N m)", 0.5e-7),
        ("7.14e-7", "1e-7 rad/(N m)", 7.14e-7),
        ("7,14E−07", "1e-7 rad/(N m)", 7.14e-7),
        ("1e1", "1e-7 rad/(N m)", 10e-7),
        ("1e-3", "1e-7 rad/(N m)", 1e-10),
        ("0.0005", "1e-7 rad/(N m)", 5e-11),
        ("0", "1e-7 rad/(N m)", 0.0),
        ("3e-8", "1e-9 m/N", 3e-8),
        ("30", "1e-9 m/N", 3e-8),
        ("1400", "kN m/rad", 1 / 1.4e6),
        ("1.4e3", "kN m/rad", 1 / 1.4e6),
        ("5e-4", "kN m/rad", 1 / 0.5),
        ("∞", "kN m/rad", 0.0),
    ],
)
def test_a_compliance_as_people_write_it(typed: str, unit: str, C: float) -> None:
    assert tables.compliance_from_text(typed, unit, "Joint 1") == pytest.approx(C, rel=1e-12, abs=0.0)


def test_a_rigid_joint_stays_rigid_in_either_unit(robot: Robot) -> None:
    rigid = robot.replace(C_theta_all=robot.C_theta_all * np.array([1.0, 0.0, 1.0, 1.0, 1.0]))
    for unit, shown in (("kN m/rad", "∞"), ("1e-7 rad/(N m)", "0")):
        frame = tables.compliance_frame(rigid, unit)
        assert frame["value"].iloc[1] == shown
        np.testing.assert_allclose(tables.with_compliance(rigid, frame, unit).C_theta, rigid.C_theta, rtol=1e-9)


def test_a_bad_table_cell_names_joint_and_column(robot: Robot) -> None:
    frame = tables.geometry_frame(robot).astype(object)
    frame.loc[3, "d, mm"] = None
    with pytest.raises(RobotError, match="Joint 4: d is missing"):
        tables.with_geometry(robot, frame)
    frame = tables.geometry_frame(robot)
    frame.loc[3, "sign"] = 0.5
    with pytest.raises(RobotError, match="sign"):
        tables.with_geometry(robot, frame)
    frame = tables.limits_frame(robot)
    frame.loc[2, "upper"] = -170.0
    with pytest.raises(RobotError, match="3"):
        tables.with_limits(robot, frame)
