"""What is assumed of a robot, a set-up, a program, load tests."""

from __future__ import annotations

import json

import numpy as np
import pytest

from robomill.cli import main
from robomill.compliance.gravity import LinkMasses
from robomill.compliance.springs.spindle import SpindleSpring
from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import TableTool, ToolTable
from robomill.io.measured.load_tests import read_load_tests
from robomill.io.robot.robots import load_robot, read_robot
from robomill.io.robot.urdf_writer import robot_to_urdf
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.provenance import Provenance
from robomill.simulation.origin.assumptions import (
    assumed_of_program,
    assumed_of_robot,
    assumed_of_setup,
    assumed_of_tests,
    assumed_of_tools,
)
from robomill.toolpath.apt import read_apt
from robomill.toolpath.gcode import interpret

PAPER = ["link lengths a_2, d_4, a_5", "joint limits"]


def names(found) -> list[str]:
    return [each.what for each in found]


def test_of_the_papers_arm_the_lengths_and_limits_that_it_does_not_print() -> None:
    found = assumed_of_robot(load_robot("slavkovic_5r"))
    assert names(found) == PAPER
    assert found[0].value == "1220, 1100, 300 mm"
    assert "not printed" in found[0].why


def test_of_a_urdf_the_compliances_until_somebody_states_them() -> None:
    robot = read_robot(robot_to_urdf(load_robot("kuka_kr500")).encode(), "arm.urdf")
    assert "joint compliances" in names(assumed_of_robot(robot))
    assert "joint compliances" not in names(assumed_of_robot(robot, compliances=False))
    stated = robot.replace(provenance={**robot.provenance, "compliance": Provenance("user", "typed")})
    assert "joint compliances" not in names(assumed_of_robot(stated))


def test_only_the_set_in_force_counts() -> None:
    robot = load_robot("slavkovic_5r")
    said = {**robot.provenance, "compliance.table_3": Provenance("assumed", "guessed")}
    robot = robot.replace(provenance=said, compliance_set="table_2", C_theta_all=robot.C_theta_all)
    assert names(assumed_of_robot(robot)) == PAPER
    assert names(assumed_of_robot(robot.with_compliance_set("table_3"))) == ["joint compliances", *PAPER]


def test_of_a_setup_everything_it_rests_on() -> None:
    setup = load_setup(samples_dir() / "paper_flute")
    assert names(assumed_of_setup(setup)) == [*PAPER, "stock", "tolerance"]
    springs = (SpindleSpring(2e-8, 1e-8),)
    masses = LinkMasses(np.ones(5), np.zeros((5, 3)), Provenance("assumed", "steel"))
    said = {**setup.provenance, "cutter": Provenance("assumed", "usual"), "force": Provenance("assumed", "carried")}
    other = setup.replace(stock=None, springs=springs, links=masses, provenance={**said, "stock": said["path"]})
    found = assumed_of_setup(other)
    assert names(found)[:5] == [*PAPER, "cutter", "force", "tolerance"]
    assert {"stock", "link masses", *(f"spring {spring.name}" for spring in springs)} <= set(names(found))
    assert next(each for each in found if each.what == "stock").why.startswith("none is given")


def test_of_a_map_that_nobody_measured() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup_measured_map.toml")
    assert "measured map" in names(assumed_of_setup(setup))
    own = setup.replace(provenance={**setup.provenance, "measured_map": Provenance("measured", "mine")})
    assert "measured map" not in names(assumed_of_setup(own))


def test_of_tools_what_their_table_does_not_say() -> None:
    told = TableTool(1, Cutter("flat", 8e-3, flutes=2), assumed=("flutes", "helix_angle"))
    tools = ToolTable((told, TableTool(2, Cutter("flat", 8e-3), assumed=("flutes",)), TableTool(3, None)))
    found = assumed_of_tools(tools, [1, 3, 9])
    assert names(found) == ["flutes of tool 1", "helix angle of tool 1"]
    assert found[0].value == "2"


def test_of_a_program_its_unit_where_it_says_none() -> None:
    assert names(assumed_of_program(interpret(b"G0 X5\nG1 X9 F100\nM2\n").findings)) == ["unit of the program"]
    assert not assumed_of_program(interpret(b"G21 G1 X9 F100\nM2\n").findings)
    by_feed = read_apt("FEDRAT/10,IPM\nGOTO/0,0,1\nGOTO/2,0,0\nFINI\n")
    np.testing.assert_allclose(by_feed.extents[1][0], 2 * 25.4e-3)
    assert [(each.what, each.value) for each in assumed_of_program(by_feed.findings)] == [
        ("unit of the program", "that of its feeds")
    ]


def test_of_load_tests_that_they_are_made_up() -> None:
    (found,) = assumed_of_tests(read_load_tests(samples_dir() / "load_tests" / "nine_points.csv"))
    assert found.what == "load tests (synthetic)"


@pytest.mark.parametrize(
    "line",
    [
        "robots",
        "pose slavkovic_5r --theta-deg 0,0,0,0,0",
        "ik slavkovic_5r --pose 0,-1300,0,0,0",
        "map slavkovic_5r --quantity C_yy --z 0 --x 0 --y -1300",
        "identify slavkovic_5r nine_points",
        "simulate paper_flute",
        "reproduce",
    ],
)
def test_every_verb_says_what_it_assumes_in_lines_and_in_json(line: str, capsys) -> None:
    assert main(line.split()) == 0
    lines = capsys.readouterr().out
    assert main([*line.split(), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    found = record["robots"][-1]["assumed"] if line == "robots" else record["assumed"]
    assert set(PAPER) <= {each["what"] for each in found}
    assert all(each["why"] for each in found)
    assert f"assumed   {'; '.join(each['what'] for each in found)}" in lines


@pytest.mark.parametrize("compliances", [True, False])
def test_where_compliances_are_not_used_they_alone_are_left_out(compliances: bool) -> None:
    robot = load_robot("slavkovic_5r")
    guessed = dict.fromkeys(robot.provenance, Provenance("assumed", "guessed"))
    found = names(assumed_of_robot(robot.replace(provenance=guessed), compliances=compliances))
    of_all = ["joint compliances", "D-H table", PAPER[0], "joint limits"]
    assert [each for each in found if each in of_all] == of_all[not compliances :]
