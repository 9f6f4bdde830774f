"""The robot in a saved set-up: by its name where it is a preset as it is, written out where anything is changed."""

from __future__ import annotations

import tomllib

from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup, setup_from_toml, setup_to_toml

SETUP = load_setup(samples_dir() / "paper_flute" / "setup.toml")


def robot_of(setup):
    return tomllib.loads(setup_to_toml(setup))["robot"]


def test_a_preset_is_named_with_the_set_of_compliances_in_force() -> None:
    for chosen in SETUP.robot.compliance_sets:
        robot = SETUP.robot.with_compliance_set(chosen)
        assert robot_of(SETUP.replace(robot=robot)) == {"name": robot.name, "compliance_set": chosen}


def test_a_changed_robot_is_written_out_and_comes_back() -> None:
    softer = SETUP.replace(robot=SETUP.robot.replace(C_theta=2.0 * SETUP.robot.C_theta))
    table = robot_of(softer)
    assert set(table) == {"definition"}
    assert setup_from_toml(setup_to_toml(softer)).robot.digest() == softer.robot.digest()


def test_a_robot_of_another_name_is_written_out() -> None:
    assert set(robot_of(SETUP.replace(robot=SETUP.robot.replace(name="ours")))) == {"definition"}
