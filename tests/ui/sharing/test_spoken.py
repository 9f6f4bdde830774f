"""The screen as a command and as Python: pasted, each gives the fingerprint of what was on the screen."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import numpy as np
import pytest

from robomill.cli import main
from robomill.io.robot.robots import load_robot
from robomill.toolpath.source import GCodeSource
from robomill.ui.project import Project, preset_setup, presets, project_to_toml, with_field
from robomill.ui.sharing.spoken import spoken

FLUTE = Project(preset_setup("paper_flute"))
FILE = "mine.robomill.toml"


def changed(**fields: object) -> Project:
    return FLUTE.replace(setup=FLUTE.setup.replace(**fields))


ROBOT = FLUTE.setup.robot
STATES = {
    **{name: Project(preset_setup(name), preset=name) for name in presets()},
    "tolerance": changed(tolerance_mm=0.4321),
    "set": changed(robot=ROBOT.with_compliance_set("table_3")),
    "set and tolerance": changed(robot=ROBOT.with_compliance_set("table_3"), tolerance_mm=0.2),
    "compliances": changed(robot=ROBOT.replace(C_theta=ROBOT.C_theta * np.array([1, 1, 0.5, 1, 1]))),
    "part zero": FLUTE.replace(setup=with_field(FLUTE.setup, "T_MW[1,3]", -1.25)),
    "cutter": FLUTE.replace(setup=with_field(FLUTE.setup, "cutter.diameter", 10e-3)),
    "floors": changed(floor_tolerance=5e-4),
    "another robot": changed(robot=load_robot("kuka_kr270")),
    "another program": changed(source=GCodeSource("G21 G90\nG0 Z5\nG1 Z-1 F100\nG1 X40 F600\nM2\n", "own.nc")),
    "a file of one's own": FLUTE.replace(preset=""),
}


@pytest.mark.parametrize("name", STATES)
def test_the_command_runs_as_pasted(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    project = STATES[name]
    monkeypatch.chdir(tmp_path)
    Path(FILE).write_text(project_to_toml(project), encoding="utf-8")
    said = spoken(project, "Milling", FILE)
    words = shlex.split(said.command)
    assert words[:2] == ["robomill", "simulate"]
    assert main([*words[1:], "--json"]) in (0, 1)
    assert json.loads(capsys.readouterr().out)["digest"] == project.setup.digest()


@pytest.mark.parametrize("name", STATES)
def test_the_python_runs_as_pasted(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    project = STATES[name]
    monkeypatch.chdir(tmp_path)
    Path(FILE).write_text(project_to_toml(project), encoding="utf-8")
    names: dict = {}
    exec(spoken(project, "Milling", FILE).python, names)  # as who pastes it does
    assert names["setup"].digest() == project.setup.digest()
    assert capsys.readouterr().out.strip() == names["result"].verdict.sentence


def test_only_what_neither_can_say_takes_a_file() -> None:
    by_file = {name: spoken(project, "Milling", FILE) for name, project in STATES.items()}
    assert by_file["paper_flute"].command == "robomill simulate paper_flute"
    assert by_file["set and tolerance"].command == "robomill simulate paper_flute --compliance-set table_3 --tol 0.2"
    assert [name for name in STATES if FILE in by_file[name].python] == ["another program", "a file of one's own"]
    assert not by_file["set"].by_file
    assert by_file["compliances"].by_file  # for the command


def test_improve_asks_what_its_page_asks() -> None:
    assert spoken(FLUTE, "Improve", FILE).command == "robomill advise paper_flute"
    assert "rm.advise(setup)" in spoken(FLUTE, "Improve", FILE).python
