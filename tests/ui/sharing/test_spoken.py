"""The screen as a command and as Python: pasted, each gives the fingerprint of what was on the screen."""

from __future__ import annotations

import dataclasses
import json
import shlex
from pathlib import Path

import numpy as np
import pytest

import robomill as rm
from robomill.cli import main
from robomill.io.robot.robots import load_robot
from robomill.toolpath.source import GCodeSource
from robomill.ui.posed import fields as plane
from robomill.ui.project import Project, preset_setup, presets, project_to_toml, with_field
from robomill.ui.sharing.questions import NINE
from robomill.ui.sharing.spoken import spoken
from robomill.units import from_si

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
    "force": changed(force=rm.PathForce(feed_normal=150.0, axial=-30.0)),
    "force in the robot's frame": changed(force=rm.ConstantForce([0.0, 120.0, -5.0])),
    "no stock": changed(stock=None),
    "stock": changed(stock=rm.Stock([-0.05, -0.02, -0.01], [0.07, 0.02, 0.0])),
    "springs": changed(springs=(rm.ToolBending(8e-3, 0.04), rm.SpindleSpring(1e-8), rm.JointBending(3, 1e-8, 2e-8))),
    "points": changed(source=rm.Toolpath.from_points([[-0.05, 0, -0.002], [0.05, 0, -0.002]], 0.03)),
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
    by_file_alone = ["points", "another program", "a file of one's own"]
    assert [name for name in STATES if FILE in by_file[name].python] == by_file_alone
    assert not by_file["set"].by_file
    assert by_file["compliances"].by_file  # for the command


def test_improve_asks_what_its_page_asks() -> None:
    assert spoken(FLUTE, "Improve", FILE).command == "robomill advise paper_flute"
    assert "rm.advise(setup)" in spoken(FLUTE, "Improve", FILE).python


BENCHES = {
    "as it comes": {},
    "a cable": {"sample": "cable_six_axis", "fit_points": "force"},
    "choices": {
        "robust": True,
        "weights": "size",
        "excluded": tuple(rm.read_load_tests("nine_points").row[3:5].tolist()),
        "leave_out": "neighbours",
    },
    "bending": {"sample": "tilted_bending_tool", "model": "joints+bending", "bending": (3,)},
}
MAPS = {
    "as it comes": ({}, NINE),
    "tilted and stiffer": ({"A": np.deg2rad(10.0), "normal": "y", "at": -1.25, "factors": [1, 1, 2, 1, 1]}, NINE),
    "one map": ({"region": "own", "lower": [-0.2, -1.4, -0.1], "upper": [0.2, -1.2, 0.1], "sheet": "one"}, ("C_soft",)),
}


def pasted(python: str) -> dict:
    names: dict = {}
    exec(python, names)  # as who pastes it does
    return names


@pytest.mark.parametrize("name", BENCHES)
def test_identification_asks_what_its_page_asks(name: str, capsys) -> None:
    bench = FLUTE.bench.replace(**BENCHES[name])
    said = spoken(FLUTE.replace(bench=bench), "Identification", FILE)
    robot = load_robot("kuka_kr270") if name == "a cable" else ROBOT
    found = rm.identify(robot, bench.sample, bench.model, bench.treatment)
    assert pasted(said.python)["found"] == found
    capsys.readouterr()
    if name == "bending":
        assert said.command == "", "other joints bend before or after them, as the command reads them"
        return
    assert main([*shlex.split(said.command)[1:], "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    np.testing.assert_allclose(record["C_theta"], found.C_theta * record["C_theta"][0] / found.C_theta[0], rtol=1e-9)
    assert record["cv_relative_error"] == pytest.approx(found.cv_relative_error, rel=1e-9)


@pytest.mark.parametrize("name", MAPS)
def test_a_page_of_maps_asks_for_the_plane_that_it_shows(name: str, capsys) -> None:
    fields, quantities = MAPS[name]
    view = dataclasses.replace(FLUTE.maps.of(ROBOT), **fields)
    for page in ("Compliance", "Workspace"):
        said = spoken(FLUTE.replace(maps=view), page, FILE)
        cells = pasted(said.python)["cells"]
        box = plane.region(ROBOT, view)
        grid = plane.plane(ROBOT, view, box, *plane.plane_at(ROBOT, view, box))
        softer = 1.0 / view.stiffening(ROBOT) if page == "Compliance" else np.ones(5)
        shown = rm.compliance_map(ROBOT.replace(C_theta=ROBOT.C_theta * softer), grid, view.A, view.B)
        names = quantities if page == "Compliance" else (view.quantity,)
        capsys.readouterr()
        for each in names:
            np.testing.assert_allclose(cells.values(each), shown.values(each), rtol=1e-12)
        if page == "Compliance" and name == "tilted and stiffer":
            assert said.command == "", "no option tries a stiffer joint"
            continue
        assert main([*shlex.split(said.command)[1:], "--json"]) == 0
        record = json.loads(capsys.readouterr().out)
        assert [each["name"] for each in record["quantities"]] == list(names)
        for each in record["quantities"]:
            assert each["max"] == pytest.approx(from_si(np.nanmax(cells.values(each["name"])), each["unit"]), rel=1e-9)
