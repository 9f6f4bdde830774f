"""Every folder of samples/ runs, and the numbers in its expected.toml hold."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path

import pytest

from robomill.io.setups.projects import load_setup, setup_from_toml, setup_to_toml
from robomill.io.robot.robots import load_robot, robot_names
from robomill.io.samples import samples_dir
from robomill.report.records import jsonable
from robomill.report.simulation_record import simulation_record
from robomill.simulation.run import simulate

SETUPS = sorted(samples_dir().glob("*/setup*.toml"))
CASES = [
    pytest.param(file.parent, row, id=f"{file.parent.name}: {row['at']} {row.get('compliance_set', '')}".strip())
    for file in sorted(samples_dir().glob("*/expected.toml"))
    for row in tomllib.loads(file.read_text()).get("number", [])
]


@cache
def record(setup_file: Path, compliance_set: str) -> dict:
    setup = load_setup(setup_file)
    if compliance_set:
        setup = setup.replace(robot=setup.robot.with_compliance_set(compliance_set))
    return jsonable(simulation_record(simulate(setup)))


def at(tree, place: str):
    for word in place.split("."):
        tree = tree[int(word)] if isinstance(tree, list) else tree[word]
    return tree


@pytest.mark.parametrize(("folder", "row"), CASES)
def test_expected_numbers(folder: Path, row: dict) -> None:
    found = record(folder / row["setup"], row.get("compliance_set", ""))
    value = at(found, row["at"])
    assert row["why"], "a golden number carries its reason"
    if "is" in row:
        assert value == row["is"], row["why"]
    elif "equals" in row:
        assert value == at(found, row["equals"]), row["why"]
    else:
        assert abs(value - row["value"]) <= row["within"], (
            f"{value} is not {row['value']} +- {row['within']}: {row['why']}"
        )


@pytest.mark.parametrize("file", SETUPS, ids=lambda f: f"{f.parent.name}/{f.name}")
def test_every_setup_is_checked_and_survives_saving(file: Path) -> None:
    assert (file.parent / "expected.toml").is_file(), f"{file.parent.name} states no expected numbers"
    assert (file.parent / "README.md").is_file()
    setup = load_setup(file)
    again = setup_from_toml(setup_to_toml(setup), where="saved")
    assert again.digest() == setup.digest()


@pytest.mark.parametrize("name", robot_names())
def test_every_robot_loads_with_a_source_for_every_block(name: str) -> None:
    robot = load_robot(name)
    assert robot.provenance
    assert all(p.source for p in robot.provenance.values())
