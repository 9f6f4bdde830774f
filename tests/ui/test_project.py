"""A saved project reads back to the same set-up and view; a broken one is refused with a reason."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from robomill.arrays import digest
from robomill.errors import CuttingError, ProjectError
from robomill.io.robot.robots import load_robot
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup, setup_to_toml
from robomill.quantities import quantities
from robomill.ui.project import MapView, Project, View, project_from_toml, project_to_toml, read_field, with_field
from robomill.workspace.quantities import map_quantities

ASKED = map_quantities(load_robot("slavkovic_5r")).values()


@pytest.fixture(scope="module")
def project() -> Project:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    view = View(
        units="in",
        joint_unit="kN m/rad",
        exaggeration=5.0,
        station=0.25,
        camera="top",
        theta=(0.1, -0.2, 0.3, 0.0, 1.0),
    )
    return Project(setup.replace(tolerance=0.2e-3), view, "paper_flute")


def test_round_trip(project: Project) -> None:
    again = project_from_toml(project_to_toml(project))
    assert again.setup.digest() == project.setup.digest()
    assert digest(again.view) == digest(project.view)
    assert again.preset == project.preset


@pytest.mark.parametrize("sheet", quantities(MapView)["sheet"].options)
@pytest.mark.parametrize("quantity", [q.name for q in ASKED if q.rests_on == "geometry"])
def test_whatever_the_maps_show_is_opened_again(project: Project, sheet: str, quantity: str) -> None:
    seen = dataclasses.replace(project, maps=MapView("slavkovic_5r/5", sheet=sheet, quantity=quantity))
    assert digest(project_from_toml(project_to_toml(seen)).maps) == digest(seen.maps)


def test_an_edited_robot_round_trips(project: Project) -> None:
    robot = project.setup.robot.replace(C_theta=project.setup.robot.C_theta * 0.5)
    edited = dataclasses.replace(project, setup=project.setup.replace(robot=robot))
    assert project_from_toml(project_to_toml(edited)).setup.digest() == edited.setup.digest()


def test_a_bare_set_up_opens_with_the_view_in_force(project: Project) -> None:
    opened = project_from_toml(setup_to_toml(project.setup), project.view)
    assert opened.setup.digest() == project.setup.digest()
    assert opened.view.units == "in"
    assert opened.preset == ""


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ('format = "robomill-setup"', 'format = "something"', "something"),
        ("version = 1", "version = 99", "99"),
        ('units = "in"', 'units = "furlong"', "furlong"),
        ("station = 0.25", "station = true", "station"),
        ("station = 0.25", "station = 0.25\nwishes = 3", "wishes"),
        ("tolerance_mm", "tolerance_mn", "tolerance_mn"),
        ("tolerance_mm = 0.2", "tolerance_mm = -1.0", "Tolerance"),
    ],
)
def test_a_broken_file_is_refused_with_its_place(project: Project, old: str, new: str, word: str) -> None:
    text = project_to_toml(project)
    assert old in text
    with pytest.raises(ProjectError, match=word):
        project_from_toml(text.replace(old, new, 1))


@pytest.mark.parametrize("text", ["", "not toml at all [", "a = 1", "[view]\nunits = 'mm'\n", "view = 3\n"])
def test_what_is_no_project_is_refused(text: str) -> None:
    with pytest.raises(ProjectError):
        project_from_toml(text)


def test_read_and_write() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    assert read_field(setup, "cutter.diameter") == 0.008
    assert read_field(setup, "T_MW[1,3]") == -1.3
    changed = with_field(setup, "T_MW[1,3]", -1.25)
    assert changed.T_MW[1, 3] == -1.25
    assert setup.T_MW[1, 3] == -1.3
    assert with_field(setup, "cutter.flutes", 2).cutter.flutes == 2
    np.testing.assert_array_equal(with_field(setup, "stock.upper[2]", 0.001).stock.upper, [0.064, 0.02, 0.001])
    with pytest.raises(CuttingError):
        with_field(setup, "cutter.diameter", -1.0)
    with pytest.raises(KeyError):
        read_field(setup, "cutter.(diameter)")


def test_the_looks_of_older_files_are_in_si(project: Project) -> None:
    looks = '[maps]\nrobot = "slavkovic_5r/5"\nA = 0.5\nlower = [-0.5, -1.5, 0]\nstep = 0.05\npair = [0.1, 0.2]\n'
    maps = project_from_toml(setup_to_toml(project.setup) + looks).maps
    assert (maps.A, maps.B, maps.step, maps.point) == (0.5, 0.0, 0.05, None)
    np.testing.assert_array_equal(maps.lower, [-0.5, -1.5, 0.0])
    np.testing.assert_array_equal(maps.pair, [0.1, 0.2])
    with pytest.raises(ProjectError, match=r"\[maps\], lower_mm: expected a list of 3 numbers, found 'far'"):
        project_from_toml(setup_to_toml(project.setup) + '[maps]\nlower = "far"\n')
