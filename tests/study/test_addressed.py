"""Numbers changed by their keys against the same numbers set in code."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import RobomillError, StudyError
from robomill.study.addressed import changed, checked, tables_of


def one(name: str, key: str, value: object) -> rm.SimulationSetup:
    return changed(tables_of(rm.load_setup(name), [key]), {key: value})


def test_keys_of_the_set_up_are_those_of_its_file() -> None:
    assert one("paper_flute/setup_process", "cutter.diameter_mm", 6).cutter.diameter == pytest.approx(6e-3)
    assert one("paper_flute", "part.zero_mm[2]", -1250.0).T_MW[1, 3] == pytest.approx(-1.25)
    assert one("paper_flute", "tolerance_mm", 0.2).tolerance == pytest.approx(2e-4)
    assert one("paper_flute", "numerics.step_mm", 3.0).step == pytest.approx(3e-3)
    assert one("paper_flute", "cutter.stick_out_mm", 40.0).cutter.stick_out == pytest.approx(0.04)
    assert one("paper_flute", "robot.compliance_set", "table_3").robot.compliance_set == "table_3"
    assert one("paper_flute", "force.feed_normal_N", 77.0).force.feed_normal == 77.0


def test_keys_of_the_robot_are_those_of_its_file() -> None:
    was = rm.load_setup("paper_flute").robot
    assert one("paper_flute", "robot.joint[2].a_mm", 1200.0).robot.a.tolist() == [0.0, 1.2, *was.a[2:]]
    for key in ("robot.compliance.table_2.C_theta_1e-7_rad_per_Nm[3]", "robot.compliance.C_theta_1e-7_rad_per_Nm[3]"):
        expected = [*was.C_theta[:2], 20e-7, *was.C_theta[3:]]
        np.testing.assert_allclose(one("paper_flute", key, 20.0).robot.C_theta, expected)
    assert one("paper_flute", "robot.tool.xyz_mm[3]", -5.0).robot.T_tool[2, 3] == pytest.approx(-5e-3)


def test_keys_of_the_material_are_those_of_its_file() -> None:
    name = "paper_flute/setup_process"
    assert one(name, "force.material", "al7075_carbide_ref47").force.material.Ktc == pytest.approx(1319.41e6)
    changed_row = one(name, "force.material.coefficients.Ktc_N_mm2", 900.0).force.material
    assert (changed_row.Ktc, changed_row.Kte) == (pytest.approx(900e6), pytest.approx(27.7e3))
    with pytest.raises(StudyError, match="not computed from a material"):
        one("paper_flute", "force.material.coefficients.Ktc_N_mm2", 900.0)


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("cutter.diametr_mm", "this key is not known here"),
        ("cuter.diameter_mm", "this key is not known here"),
        ("part.zero_mm", "name one number of it, as part.zero_mm\\[1\\]"),
        ("part.zero_mm[4]", "the list has 3 entries"),
        ("part.zero_mm[0]", "counted from 1"),
        ("robot.joint[9].a_mm", "the list has 5 entries"),
        ("robot.joint.a_mm", "name an entry of it, as \\[1\\]"),
        ("cutter..x", "expected a key as"),
        ("cutter.diameter_mm.x", "nothing is within 'x' there"),
    ],
)
def test_a_key_that_no_file_has_is_refused(key: str, words: str) -> None:
    setup = rm.load_setup("paper_flute")
    with pytest.raises(StudyError, match=words):
        checked(tables_of(setup, [key]), key, [1.0])


def test_a_value_out_of_bounds_is_no_wrong_key() -> None:
    data = tables_of(rm.load_setup("paper_flute"), ["cutter.diameter_mm"])
    checked(data, "cutter.diameter_mm", [-1.0, 8.0])
    with pytest.raises(StudyError, match="Diameter"):
        checked(data, "cutter.diameter_mm", [-1.0, -2.0])
    with pytest.raises(RobomillError):
        changed(data, {"cutter.diameter_mm": -1.0})
