"""Tables of a robot on the screen to the model and back, in the units people type."""

from __future__ import annotations

import re

import numpy as np
import pytest

from robomill.errors import ProjectError, RobotError
from robomill.io.robot.robots import load_robot
from robomill.robot.model import Robot
from robomill.ui.robot import tables
from robomill.units import to_si


@pytest.fixture(scope="module")
def robot() -> Robot:
    return load_robot("slavkovic_5r")


UNITS = ["1e-7 rad/(N m)", "kN m/rad"]


def shown(robot: Robot, unit: str) -> list[str]:
    """The compliances as their cells show them."""
    values = tables.compliance_frame(robot)["stiffness" if unit == "kN m/rad" else "compliance"]
    return [
        box.written(value, cell=True) for box, value in zip(tables.compliance_boxes(robot, unit), values, strict=True)
    ]


def with_typed(robot: Robot, unit: str, texts: list[str]) -> Robot:
    """The robot with compliances typed one a joint."""
    boxes = tables.compliance_boxes(robot, unit)
    frame = tables.compliance_frame(robot)
    frame["stiffness" if unit == "kN m/rad" else "compliance"] = [
        box.read(text) for box, text in zip(boxes, texts, strict=True)
    ]
    return tables.with_compliance(robot, frame)


def test_an_unchanged_table_changes_nothing(robot: Robot) -> None:
    same = tables.with_compliance(robot, tables.compliance_frame(robot))
    assert same.digest() == robot.digest()
    assert same.compliance_set == "table_2"
    assert tables.with_geometry(robot, tables.geometry_frame(robot)).digest() == robot.digest()
    assert tables.with_limits(robot, tables.limits_frame(robot)).digest() == robot.digest()


@pytest.mark.parametrize("unit", UNITS)
def test_what_is_shown_can_be_typed_again(robot: Robot, unit: str) -> None:
    again = with_typed(robot, unit, shown(robot, unit))
    np.testing.assert_allclose(again.C_theta, robot.C_theta, rtol=1e-9 if unit == UNITS[0] else 5e-6)


def test_the_papers_own_notation_can_be_typed(robot: Robot) -> None:
    texts = shown(robot, UNITS[0])
    assert texts == ["7.14", "10.12", "12.3", "17.32", "91.35"]
    changed = with_typed(robot, UNITS[0], ["7.5", *texts[1:]])
    assert changed.C_theta[0] == to_si(7.5, UNITS[0])
    assert changed.compliance_set == "user"


def test_typing_table_3_is_table_3(robot: Robot) -> None:
    texts = shown(robot.with_compliance_set("table_3"), UNITS[0])
    assert with_typed(robot, UNITS[0], texts).compliance_set == "table_3"


def test_stiffness_is_the_inverse(robot: Robot) -> None:
    changed = with_typed(robot, "kN m/rad", ["1000", "900.0", "800,0", "5e2", " 100 "])
    np.testing.assert_allclose(changed.C_theta, [1e-6, 1 / 0.9e6, 1 / 0.8e6, 2e-6, 1e-5], rtol=1e-12)


@pytest.mark.parametrize(
    ("unit", "text", "word"),
    [
        (UNITS[0], "", "compliance: the box is empty"),
        (UNITS[0], "-1", "compliance: found -1, expected 0 to 1e+07 ×10⁻⁷ rad/(N m)"),
        (UNITS[0], "-7e-7", "compliance: found -7, expected 0 to 1e+07"),
        (UNITS[0], "1e9", "compliance: found 1e+09, expected 0 to 1e+07 ×10⁻⁷ rad/(N m)"),
        (UNITS[0], "1e999", "compliance: found '1e999', expected a number"),
        (UNITS[0], "inf", "compliance: found 'inf', expected a number"),
        (UNITS[0], "7.14e-", "compliance: found '7.14e-', expected a number"),
        (UNITS[0], "7.14 rad", "compliance: found '7.14 rad', expected a number in ×10⁻⁷ rad/(N m)"),
        (UNITS[0], "1,012", "compliance: found '1,012', which is 1.012 to some and 1012 to others"),
        ("kN m/rad", "0", "stiffness: found 0, expected 0.001 or more kN m/rad"),
        ("kN m/rad", "-5", "stiffness: found -5, expected 0.001 or more kN m/rad"),
        ("kN m/rad", "nan", "stiffness: found 'nan', expected a number in kN m/rad"),
        ("kN m/rad", "", "stiffness: the box is empty"),
    ],
)
def test_a_bad_compliance_is_quoted(robot: Robot, unit: str, text: str, word: str) -> None:
    with pytest.raises(ProjectError, match=re.escape(word)):
        tables.compliance_boxes(robot, unit)[1].read(text)


@pytest.mark.parametrize("value", [-1e-7, np.inf, np.nan])
def test_a_compliance_that_cannot_be_names_its_joint(robot: Robot, value: float) -> None:
    frame = tables.compliance_frame(robot)
    frame.loc[1, "compliance"] = value
    with pytest.raises(RobotError, match="joint 2: compliance"):
        tables.with_compliance(robot, frame)


@pytest.mark.parametrize(
    ("typed", "unit", "C"),
    [
        ("7.14", UNITS[0], 7.14e-7),
        ("12,3", UNITS[0], 12.3e-7),
        (" +12. ", UNITS[0], 12e-7),
        (",5", UNITS[0], 0.5e-7),
        ("7.14e-7", UNITS[0], 7.14e-7),
        ("7,14E−07", UNITS[0], 7.14e-7),
        ("0,714 µrad/(N m)", UNITS[0], 7.14e-7),
        ("1,012.5", UNITS[0], 1012.5e-7),
        ("1e1", UNITS[0], 10e-7),
        ("1e-3", UNITS[0], 1e-10),
        ("0.0005", UNITS[0], 5e-11),
        ("0", UNITS[0], 0.0),
        ("1400", "kN m/rad", 1 / 1.4e6),
        ("1.4e3", "kN m/rad", 1 / 1.4e6),
        ("1,4e6 Nm/rad", "kN m/rad", 1 / 1.4e6),
        ("5e-3", "kN m/rad", 1 / 5.0),
        ("∞", "kN m/rad", 0.0),
    ],
)
def test_a_compliance_as_people_write_it(robot: Robot, typed: str, unit: str, C: float) -> None:
    assert tables.compliance_boxes(robot, unit)[0].read(typed) == pytest.approx(C, rel=1e-12, abs=0.0)


def test_a_joint_that_slides_has_its_own_unit() -> None:
    arm = load_robot("slavkovic_5r")
    slides = arm.replace(prismatic=np.array([True, False, False, False, False]))
    first, second = tables.compliance_boxes(slides, UNITS[0])[:2]
    assert (first.unit, second.unit) == ("1e-9 m/N", UNITS[0])
    assert first.read("3e-8") == pytest.approx(3e-8)
    assert first.read("30") == pytest.approx(3e-8)


def test_a_rigid_joint_stays_rigid_in_either_unit(robot: Robot) -> None:
    rigid = robot.replace(C_theta_all=robot.C_theta_all * np.array([1.0, 0.0, 1.0, 1.0, 1.0]))
    for unit, text in (("kN m/rad", "∞"), (UNITS[0], "0")):
        assert shown(rigid, unit)[1] == text
        assert with_typed(rigid, unit, shown(rigid, unit)).C_theta[1] == 0.0


def test_either_column_says_the_compliance(robot: Robot) -> None:
    frame = tables.compliance_frame(robot)
    np.testing.assert_array_equal(frame["compliance"], frame["stiffness"])
    for column in tables.SPOKEN:
        typed = frame.copy()
        typed.loc[3, column] = 2e-6
        changed = tables.with_compliance(robot, typed)
        np.testing.assert_array_equal(changed.C_theta, np.where(np.arange(5) == 3, 2e-6, robot.C_theta))
    rigid = frame.copy()
    rigid.loc[0, "stiffness"] = tables.compliance_boxes(robot, "kN m/rad")[0].read("∞")
    still = tables.with_compliance(robot, rigid)
    assert still.C_theta[0] == 0.0
    assert tables.compliance_frame(still)["joint"][0] == "1, rigid"


def test_lengths_of_the_table_are_typed_in_the_units_of_the_view(robot: Robot) -> None:
    cells = tables.geometry("in")
    assert list(cells.heads) == ["α, °", "a, in", "d, in", "θ₀, °", "sign"]
    frame = tables.geometry_frame(robot, "in")
    frame.loc[1, "a, in"] = cells.boxes()["a, in"].read("48")
    assert tables.with_geometry(robot, frame, "in").a[1] == pytest.approx(1.2192, rel=1e-12)


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
    frame.loc[2, "upper"] = np.radians(-170.0)
    with pytest.raises(RobotError, match="3"):
        tables.with_limits(robot, frame)
