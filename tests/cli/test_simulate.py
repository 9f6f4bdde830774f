"""What ``robomill simulate`` writes to a folder, refuses to replace, and takes in a set-up's stead."""

from __future__ import annotations

import csv
import json
import os
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from robomill.cli import main
from robomill.cli.simulate import NAMES, PICTURES
from robomill.io.meshes import FEW_TRIANGLES
from robomill.io.robot.robots import load_robot
from robomill.io.robot.writer import robot_to_toml
from robomill.io.samples import samples_dir

FLUTE = samples_dir() / "paper_flute"


def run(capsys, *words: object) -> tuple[int, str, str]:
    code = main(["simulate", *map(str, words)])
    out, err = capsys.readouterr()
    return code, out, err


def record(capsys, *words: object) -> dict:
    code, out, err = run(capsys, *words, "--json")
    assert code in (0, 1), err
    return json.loads(out)


def test_what_is_written_is_listed_and_runs_again_from_there(capsys, tmp_path: Path) -> None:
    out = tmp_path / "a" / "result"
    first = record(capsys, FLUTE / "setup_measured_map.toml", "--out", out)
    assert [Path(file["path"]).name for file in first["files"]] == list(NAMES)
    assert sorted(path.name for path in out.iterdir()) == sorted(NAMES)
    assert all(file["bytes"] == Path(file["path"]).stat().st_size for file in first["files"])
    assert not any(file["replaced"] for file in first["files"])
    assert first["not_written"] == []
    elsewhere = shutil.copytree(out, tmp_path / "taken away")
    again = record(capsys, elsewhere)
    for key in ("digest", "deviation_mm", "verdict_sentence", "assumed", "groove"):
        assert again[key] == first[key]
    kept = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert kept["digest"] == first["digest"]


def test_the_lines_name_every_file_and_an_older_one(capsys, tmp_path: Path) -> None:
    out = tmp_path / "result"
    _, said, _ = run(capsys, "paper_flute", "--out", out)
    for name in NAMES:
        assert f"wrote     {out / name}, " in said
    assert "replacing" not in said
    (out / "notes.txt").write_text("mine")
    _, said, _ = run(capsys, "paper_flute", "--tol", "0.5", "--out", out)
    assert said.count("replacing an older one") == len(NAMES)
    assert (out / "notes.txt").read_text() == "mine"
    assert "tolerance_mm = 0.5" in (out / "setup.toml").read_text(encoding="utf-8")


def test_the_solid_is_below_ten_megabytes_unless_every_cell_is_asked_for(capsys, tmp_path: Path) -> None:
    few = record(capsys, "paper_flute", "--out", tmp_path / "few")["files"]
    all_of_it = record(capsys, "paper_flute", "--out", tmp_path / "all", "--full-stl")["files"]
    sizes = [next(f["bytes"] for f in files if f["path"].endswith(".stl")) for files in (few, all_of_it)]
    assert sizes[0] < 10e6 < sizes[1]
    assert sizes[1] > 50 * 4 * FEW_TRIANGLES


def test_the_pictures_show_something(capsys, tmp_path: Path) -> None:
    record(capsys, "paper_flute", "--out", tmp_path)
    for name in PICTURES:
        with Image.open(tmp_path / name) as picture:
            assert picture.size[0] == 1440
            assert len(np.unique(np.asarray(picture.convert("L")))) > 50


def test_without_the_extra_the_rest_is_written_and_it_is_named(capsys, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    code, said, _ = run(capsys, "paper_flute", "--out", tmp_path)
    assert code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(set(NAMES) - set(PICTURES))
    assert f"not written: {', '.join(PICTURES)}. A picture as PNG needs matplotlib" in said
    assert 'pip install "robomill[plot]"' in said
    found = record(capsys, "paper_flute", "--out", tmp_path)
    assert [each["name"] for each in found["not_written"]] == list(PICTURES)


def test_where_nothing_is_reached_there_is_no_section_and_the_rest_is_written(capsys, tmp_path: Path) -> None:
    file = tmp_path / "far.nc"
    file.write_text("G21 G90\nG0 X9000 Y0 Z5\nG1 Z-1 F100\nG1 X9010\nM2\n")
    found = record(capsys, "paper_flute", "--program", file, "--out", tmp_path / "out")
    why = {each["name"]: each["why"] for each in found["not_written"]}
    assert set(why) == {"machined.stl", "section.png"}
    assert "No section can be drawn" in why["section.png"]
    assert why["machined.stl"] == "Nothing is cut: the part would be the stock as it was."
    assert (tmp_path / "out" / "result.json").is_file()


def test_other_work_is_never_replaced(capsys, tmp_path: Path) -> None:
    own = Path(shutil.copytree(FLUTE, tmp_path / "own"))
    before = (own / "setup.toml").read_text()
    link = tmp_path / "link"
    link.symlink_to(own)
    file = tmp_path / "file"
    file.write_text("")
    for setup, out, sentence in (
        (own / "setup.toml", own, "what this run reads stands there and would be replaced; give another"),
        (own / "setup.toml", link, "what this run reads stands there"),
        (own / "setup_process.toml", own, "a set-up stands there that no earlier run wrote (setup.toml)"),
        ("heart", own, "a set-up stands there that no earlier run wrote"),
        ("heart", file, "this is a file; give a folder"),
        ("heart", file / "in", "cannot write there"),
    ):
        code, said, err = run(capsys, setup, "--out", out)
        assert (code, said) == (2, "")
        assert sentence in err
        assert err.count("\n") == 1
    assert (own / "setup.toml").read_text() == before
    code, _, err = run(capsys, own, "--out", own)
    assert code == 2
    assert (own / "setup.toml").read_text() == before


def test_a_full_disk_is_one_sentence(capsys, tmp_path: Path, monkeypatch) -> None:
    def full(*words: object) -> None:
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr(os, "fsync", full)
    code, out, err = run(capsys, "paper_flute", "--out", tmp_path)
    assert (code, out) == (2, "")
    assert "cannot be written (No space left on device); give another place" in err
    assert not list(tmp_path.iterdir())


def test_another_robot_by_name_or_file(capsys, tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(robot_to_toml(load_robot("kuka_kr500")))
    named, from_file = (record(capsys, "paper_flute", "--robot", robot) for robot in ("kuka_kr500", file))
    own = record(capsys, "paper_flute")
    assert named["robot"] == "kuka_kr500"
    assert named["deviation_mm"] == from_file["deviation_mm"] != own["deviation_mm"]
    assert {"tool in the last axis", "joint compliances"} <= {each["what"] for each in named["assumed"]}
    code, _, err = run(capsys, FLUTE / "setup_measured_map.toml", "--robot", "kuka_kr500")
    assert code == 2
    assert "[measured_map]" in err


def test_a_compliance_set_is_that_of_the_robot_in_force(capsys) -> None:
    found = record(capsys, "paper_flute", "--robot", "fanuc_r2000ic", "--compliance-set", "later_fit")
    assert (found["robot"], found["compliance_set"]) == ("fanuc_r2000ic", "later_fit")


def test_who_said_what_goes_along(capsys, tmp_path: Path) -> None:
    """The force of the paper's slot was measured on it: on another program it is an assumption, and says so."""
    out = tmp_path / "out"
    found = record(capsys, "paper_flute", "--program", "heart", "--tol", "0.4", "--out", out)
    why = {each["what"]: each["why"] for each in found["assumed"]}
    assert "carried over from 'Reference groove (Slavkovic 2013)'" in why["force"]
    assert "tolerance" not in why
    assert record(capsys, out)["assumed"] == found["assumed"]
    assert "force" not in {each["what"] for each in record(capsys, "paper_flute")["assumed"]}


def test_json_says_what_was_run_and_what_it_rests_on(capsys) -> None:
    found = record(capsys, "paper_flute", "--program", "heart")
    assert found["program"] == "heart.nc"
    assert found["robomill"]
    rows = {each["what"]: each for each in found["rests_on"]}
    assert rows["Cutter"]["kind"] == "paper"
    assert rows["Force"]["value"]
    assert record(capsys, samples_dir() / "word")["program"] == "word.nc"


def test_tables_are_read_back(capsys, tmp_path: Path) -> None:
    found = record(capsys, "paper_flute", "--out", tmp_path)
    with (tmp_path / "deviation.csv").open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["cutting"] == "1"]
    assert max(float(row["deviation_mm"]) for row in rows) == pytest.approx(found["max_deviation_mm"], rel=1e-6)


@pytest.mark.parametrize("option", [["--feed", "600"], ["--unit", "mm"]])
@pytest.mark.parametrize("program", [[], ["--program", "heart"]])
def test_what_is_said_of_points_is_refused_where_there_are_none(option, program, capsys) -> None:
    """It changed nothing: whoever swept the feed so got the same numbers every time."""
    assert main(["simulate", "paper_flute", *program, *option]) == 2
    assert f"robomill: {option[0]}: this is for a table of points" in capsys.readouterr().err
