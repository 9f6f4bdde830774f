"""Where the samples lie."""

from __future__ import annotations

from pathlib import Path

import pytest

import robomill as rm
from robomill.errors import ProjectError, RobomillError
from robomill.io import samples
from robomill.io.setups.projects import load_setup

ROOT = Path(__file__).resolve().parents[2]


def test_in_a_checkout_they_lie_beside_the_package() -> None:
    assert samples.app_dir() == ROOT
    assert samples.samples_dir() == ROOT / "samples"
    assert (samples.app_dir() / "app.py").is_file()


def test_in_a_wheel_they_lie_inside_the_package(tmp_path, monkeypatch) -> None:
    package = tmp_path / "site" / "robomill"
    (package / "io").mkdir(parents=True)
    monkeypatch.setattr(samples, "__file__", str(package / "io" / "samples.py"))
    assert samples.app_dir() == tmp_path / "site"
    (package / "_app").mkdir()
    assert samples.app_dir() == package / "_app"
    assert samples.samples_dir() == package / "_app" / "samples"


def test_samples_are_called_as_commands_take_them() -> None:
    assert {"heart", "paper_flute", "paper_flute/setup_process"} <= set(samples.sample_names("set-up"))
    assert "nine_points" in samples.sample_names("load tests")
    assert "slavkovic_5r" in samples.sample_names("robot")
    assert samples.find_sample("program", "heart") == ROOT / "samples" / "heart" / "heart.nc"
    assert samples.find_sample("set-up", "nobody's") is None
    assert samples.find_sample("robot", "heart") is None


def test_every_sample_is_there_once_with_a_title() -> None:
    every = samples.samples()
    assert len({(each.kind, each.name) for each in every}) == len(every)
    assert all((each.path.is_dir() if each.kind == "answers" else each.path.is_file()) and each.title for each in every)
    titles = {each.name: each.title for each in every if each.kind in ("set-up", "robot")}
    assert titles["heart"] == "Heart"
    assert titles["kuka_kr500"] == "KUKA KR 500-3 MT"


def test_what_stands_there_is_no_sample(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "heart").mkdir()
    assert samples.find_sample("set-up", "heart") is None


def test_samples_are_copied_and_other_files_are_never_replaced(tmp_path) -> None:
    copies = samples.copy_samples(tmp_path / "all")
    assert {path.relative_to(tmp_path / "all") for path in copies} == {
        path.relative_to(ROOT / "samples")
        for path in (ROOT / "samples").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert load_setup(tmp_path / "all" / "paper_flute" / "setup_measured_map.toml").measured_map is not None
    some = samples.copy_samples(tmp_path / "some", ["heart", "planar_2r"])
    assert {path.name for path in some} == {"README.md", "expected.toml", "heart.nc", "setup.toml", "planar_2r.toml"}
    assert samples.copy_samples(tmp_path / "some", ["heart", "planar_2r"]) == some
    (tmp_path / "some" / "heart" / "setup.toml").write_text("mine")
    (tmp_path / "some" / "heart" / "heart.nc").unlink()
    with pytest.raises(ProjectError, match=r"setup\.toml: another file stands there already and is not replaced"):
        samples.copy_samples(tmp_path / "some", ["heart"])
    assert (tmp_path / "some" / "heart" / "setup.toml").read_text() == "mine"
    assert not (tmp_path / "some" / "heart" / "heart.nc").exists()
    with pytest.raises(ProjectError, match="there is no such sample"):
        samples.copy_samples(tmp_path, ["hart"])
    (tmp_path / "file").write_text("")
    with pytest.raises(ProjectError, match="cannot write there"):
        samples.copy_samples(tmp_path / "file" / "in", ["heart"])


def test_another_sample_of_the_name_is_said_whatever_its_case() -> None:
    with pytest.raises(RobomillError, match="'grid_45x6' are load tests"):
        rm.load_robot("grid_45x6")
    with pytest.raises(RobomillError, match="'slavkovic_5r' is a robot"):
        rm.load_setup("SLAVKOVIC_5R")
    with pytest.raises(RobomillError, match="did you mean 'slavkovic_5r'"):
        rm.load_robot("SLAVKOVIC_5R")
