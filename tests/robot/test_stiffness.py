"""A joint as compliance and as stiffness: one over the other, in units of joints that turn and that slide."""

import numpy as np
import pytest

from robomill.robot.stiffness import JOINT_UNITS, is_stiffness, meant, of_joint, shown

FACTORS = {"1e-7 rad/(N m)": 1e-7, "1e-9 m/N": 1e-9, "kN m/rad": 1e3, "N/um": 1e6}  # to SI, by hand


def test_two_units_are_stiffnesses_and_each_has_one_for_joints_that_slide():
    assert {unit for unit in FACTORS if is_stiffness(unit)} == {"kN m/rad", "N/um"}
    assert set(JOINT_UNITS) == {of_joint(unit, False) for unit in JOINT_UNITS}
    for unit in JOINT_UNITS:
        assert is_stiffness(of_joint(unit, True)) == is_stiffness(unit)
        assert of_joint(unit, True) in set(FACTORS) - set(JOINT_UNITS)


@pytest.mark.parametrize("unit", FACTORS)
def test_what_is_shown_is_what_was_meant(unit):
    for typed in (0.25, 1.0, 437.0):
        compliance = 1.0 / (typed * FACTORS[unit]) if "/rad" in unit or "/um" in unit else typed * FACTORS[unit]
        assert meant(typed, unit) == pytest.approx(compliance, rel=1e-12)
        assert shown(compliance, unit) == pytest.approx(typed, rel=1e-12)
    some = np.array([[1e-7, 2e-7], [4e-6, 8e-6]])
    back = np.vectorize(lambda value: meant(value, unit))(shown(some, unit))
    np.testing.assert_allclose(back, some, rtol=1e-12)


@pytest.mark.parametrize("unit", ["kN m/rad", "N/um"])
def test_a_rigid_joint_has_no_end_of_stiffness(unit):
    assert shown(0.0, unit) == np.inf
    assert meant(np.inf, unit) == 0.0
    assert meant(0.0, unit) == np.inf
