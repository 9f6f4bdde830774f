"""What a command is given by name: files, samples, standard input."""

from __future__ import annotations

import io
import json
import shutil
import sys
from pathlib import Path

import pytest

from robomill.cli import main
from robomill.io.robot.robots import load_robot
from robomill.io.robot.urdf_writer import robot_to_urdf
from robomill.io.robot.writer import robot_to_toml
from robomill.io.samples import samples_dir

FLUTE = samples_dir() / "paper_flute"
TESTS = samples_dir() / "load_tests" / "nine_points.csv"
POSE = ("--theta-deg", "0,0,0,0,0")


@pytest.fixture
def come_in(monkeypatch):
    """Standard input holds these bytes."""

    def put(data: bytes) -> None:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data)))

    return put


def record(capsys, *words: object) -> dict:
    code = main([*map(str, words), "--json"])
    out, err = capsys.readouterr()
    assert code == 0, err
    return json.loads(out)


def refusal(capsys, *words: object) -> str:
    assert main([*map(str, words)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    return err


def test_a_setup_by_its_name_is_the_samples(capsys) -> None:
    named = record(capsys, "simulate", "paper_flute")
    assert named == record(capsys, "simulate", FLUTE)
    other = record(capsys, "simulate", "paper_flute/setup_measured_map")
    assert other["digest"] == record(capsys, "simulate", FLUTE / "setup_measured_map.toml")["digest"]


def test_what_stands_there_goes_before_a_sample(capsys, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "heart").mkdir()
    assert "heart/setup.toml" in refusal(capsys, "simulate", "heart")


def test_a_program_and_load_tests_by_name(capsys) -> None:
    assert record(capsys, "gcode", "heart") == record(capsys, "gcode", samples_dir() / "heart" / "heart.nc")
    by_name = record(capsys, "simulate", "paper_flute", "--program", "paper_flute")
    assert by_name["deviation_mm"] == record(capsys, "simulate", "paper_flute")["deviation_mm"]
    tests = record(capsys, "identify", "slavkovic_5r", "nine_points")
    assert tests["C_theta"] == record(capsys, "identify", "slavkovic_5r", TESTS)["C_theta"]


def test_a_program_comes_in(capsys, come_in) -> None:
    text = (FLUTE / "path.nc").read_bytes()
    come_in(text)
    assert record(capsys, "gcode", "-")["length_mm"]["feed"] == pytest.approx(100.0)
    come_in(text)
    assert record(capsys, "simulate", "paper_flute", "--program", "-")["max_deviation_mm"] == pytest.approx(0.251, 1e-2)


@pytest.mark.parametrize("start", [b"", b"\xef\xbb\xbf", b"# from the CAM\n\n"])
def test_points_come_in_and_are_told_from_a_program(capsys, come_in, start: bytes) -> None:
    table = start + b"X_mm;Y_mm;Z_mm\n-50;0;-2\n50;0;-2\n"
    come_in(table)
    assert record(capsys, "gcode", "-", "--feed", "1800")["length_mm"]["feed"] == pytest.approx(100.0)
    come_in(table)
    found = record(capsys, "simulate", "paper_flute", "--program", "-", "--feed", "1800")
    assert found["max_deviation_mm"] == pytest.approx(0.251, 1e-2)
    come_in(b"(x,y,z)\nG21 G90\nS9000 M3\nG1 X0 Y0 Z-2 F300\nX50\nM2\n")
    assert "standard input is a program" in refusal(capsys, "gcode", "-", "--feed", "1800")


@pytest.mark.parametrize("name", ["bracket.dxf", "bracket.svg"])
def test_a_drawing_comes_in_as_either_file(name: str, capsys, come_in) -> None:
    file = samples_dir() / "drawings" / name
    come_in(file.read_bytes())
    found, other = record(capsys, "drawing", "-"), record(capsys, "drawing", file)
    assert found["layers"] == other["layers"]
    come_in(b"G1 X0\n")
    assert "stdin.dxf" in refusal(capsys, "drawing", "-")


def test_a_setup_comes_in_with_files_of_the_folder_one_stands_in(capsys, come_in, monkeypatch) -> None:
    monkeypatch.chdir(FLUTE)
    come_in((FLUTE / "setup.toml").read_bytes())
    assert record(capsys, "simulate", "-") == record(capsys, "simulate", "paper_flute")


def test_load_tests_come_in(capsys, come_in) -> None:
    come_in(TESTS.read_bytes())
    found = record(capsys, "identify", "slavkovic_5r", "-")
    assert found["C_theta"] == record(capsys, "identify", "slavkovic_5r", TESTS)["C_theta"]


@pytest.mark.parametrize("write", [robot_to_toml, robot_to_urdf], ids=["toml", "urdf"])
def test_a_robot_comes_in_as_either_file(write, capsys, come_in) -> None:
    robot = load_robot("slavkovic_5r")
    come_in(write(robot).encode())
    T = record(capsys, "pose", "-", *POSE)["T_MT"]
    for row, other in zip(T, record(capsys, "pose", "slavkovic_5r", *POSE)["T_MT"], strict=True):
        assert row == pytest.approx(other, abs=1e-9)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("gcode", "-"), "standard input: nothing came in; expected a program"),
        (("simulate", "-"), "standard input: nothing came in; expected a set-up"),
        (("pose", "-", *POSE), "standard input: nothing came in; expected a robot"),
        (("identify", "slavkovic_5r", "-"), "standard input: nothing came in; expected a CSV table"),
        (("simulate", "-", "--program", "-"), "can be read once"),
        (("simulate", "heart", "--out", "-"), "cannot be written to"),
        (("identify", "-", "-"), "can be read once"),
    ],
)
def test_standard_input_that_cannot_be_is_refused(words, sentence: str, capsys, come_in) -> None:
    come_in(b" \n")
    assert sentence in refusal(capsys, *words)


def test_no_standard_input_at_all(capsys, monkeypatch) -> None:
    monkeypatch.setattr(sys, "stdin", None)
    assert "nothing came in" in refusal(capsys, "gcode", "-")


def test_names_of_bytes_that_are_no_text(capsys, tmp_path: Path) -> None:
    """A file of a Latin-1 system, named in bytes that are no UTF-8: it is read, and its name harms no record."""
    file = tmp_path / "fr\udce4se.nc"
    try:
        file.write_bytes((FLUTE / "path.nc").read_bytes())
    except OSError:
        pytest.skip("this file system takes text only")
    out = tmp_path / "out\udcff"
    found = record(capsys, "simulate", "paper_flute", "--program", file, "--out", out)
    assert found["files"][0]["path"].endswith("out\udcff/setup.toml")
    assert record(capsys, "simulate", out)["digest"] == found["digest"]


@pytest.fixture
def own(tmp_path: Path, monkeypatch) -> Path:
    """A folder with somebody's load tests, robot and program, and a link to the tests."""
    for name, called in (("load_tests/nine_points.csv", "mine.csv"), ("robots/slavkovic_5r.toml", "my.toml")):
        shutil.copyfile(samples_dir() / name, tmp_path / called)
    shutil.copyfile(samples_dir() / "heart" / "heart.nc", tmp_path / "h.nc")
    (tmp_path / "link.csv").symlink_to("mine.csv")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("identify", "my.toml", "mine.csv", "--out", "./mine.csv"), "--out mine.csv: what this run reads"),
        (("identify", "my.toml", "mine.csv", "--out", "my.toml"), "--out my.toml: what this run reads"),
        (("identify", "my.toml", "mine.csv", "--sheet", "link.csv"), "--sheet link.csv: what this run reads"),
        (("identify", "my.toml", "mine.csv", "--out", "o.toml", "--sheet", "o.toml"), "another option writes there"),
        (("gcode", "h.nc", "--moves", "h.nc"), "--moves h.nc: what this run reads"),
        (("gcode", "h.nc", "--moves", " "), "--moves: the name is empty"),
        (("simulate", "paper_flute", "--out", ""), "--out: the name is empty"),
    ],
)
def test_what_is_read_is_never_written_over(own: Path, words, sentence: str, capsys) -> None:
    before = {file.name: file.read_bytes() for file in own.iterdir()}
    assert main(words) == 2
    assert sentence in capsys.readouterr().err
    assert {file.name: file.read_bytes() for file in own.iterdir()} == before


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("identify my.toml mine.csv --out arm.txt", "a robot is written there; give a name that ends in .toml"),
        ("identify my.toml mine.csv --sheet s.toml", "a table is written there; give a name that ends in .csv"),
        ("place paper_flute --out moved.nc", "a set-up is written there; give a name that ends in .toml"),
        ("report paper_flute --out page.pdf", "a page is written there; give a name that ends in .html or .htm"),
        ("grade . --out marks.toml", "a table is written there; give a name that ends in .csv"),
        ("compensate paper_flute --out x.toml", "x.toml: a program is written there; give a name that ends in .nc"),
        ("drawing bracket --out x.svg", "x.svg: a program is written there; give a name that ends in .nc"),
        ("map my.toml --quantity C_yy --x 0 --y 0 --z 0 --out m.toml", "'m.toml' ends in '.toml'; expected .csv"),
        ("place paper_flute --out no/moved.toml", "--out no/moved.toml: the folder no is not there; make it first"),
        ("gcode h.nc --moves no/m.jsonl", "the folder no is not there; make it first"),
        ("compensate paper_flute --out .", "this is a folder; give the name of a file"),
        ("place paper_flute --out .", "this is a folder; give the name of a file"),
        ("grade . --out .", "this is a folder; give the name of a file"),
    ],
)
def test_nothing_is_written_under_a_name_that_says_another_kind(own: Path, words: str, sentence: str, capsys) -> None:
    """Told before anything is computed."""
    before = {file.name for file in own.iterdir()}
    assert sentence in refusal(capsys, *words.split())
    assert {file.name for file in own.iterdir()} == before


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("grade", "", "--out", "m.csv"), "The name of the folder of answers is empty"),
        (("simulate", "paper_flute", "--tip", "flange"), "--tip: it is a link of the URDF that --robot names"),
        (("turn", "paper_flute", "--tip", "flange"), "--tip: it is a link of the URDF that --robot names"),
        (("place", "paper_flute", "--yaw", "-1e9:1e9"), "expected at most two turns to either side"),
        (("--frobnicate",), "There is no option '--frobnicate'; 'robomill --help' lists the verbs"),
        (("-x",), "There is no option '-x'"),
    ],
)
def test_what_would_be_passed_over_is_refused(own: Path, words, sentence: str, capsys) -> None:
    assert sentence in refusal(capsys, *words)
