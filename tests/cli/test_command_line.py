"""The command line: JSON records, exit codes, refusals on stderr."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from robomill.cli import main
from robomill.io.samples import samples_dir

FLUTE = samples_dir() / "paper_flute"


def run(capsys, *words: object) -> tuple[int, str, str]:
    code = main([str(w) for w in words])
    out, err = capsys.readouterr()
    return code, out, err


def record(capsys, *words: object) -> dict:
    code, out, err = run(capsys, *words, "--json")
    assert code == 0, err
    return json.loads(out)


def test_robots(capsys) -> None:
    names = [r["name"] for r in record(capsys, "robots")["robots"]]
    assert {"slavkovic_5r", "planar_2r"} <= set(names)


def test_pose_at_zero_is_the_papers_reference(capsys) -> None:
    r = record(capsys, "pose", "slavkovic_5r", "--theta-deg", "0,0,0,0,0")
    T = np.array(r["T_MT"])
    assert T[:3, 3] == pytest.approx([0, -1.1, 0.92], abs=1e-12)
    assert T[:3, 2] == pytest.approx([0, 0, 1], abs=1e-12)
    assert np.array(r["J"]).shape == (6, 5)
    assert np.array(r["joint_share_um_per_N"]).sum(axis=0) == pytest.approx(np.array(r["C_um_per_N"]))


def test_ik_and_back(capsys) -> None:
    r = record(capsys, "ik", "slavkovic_5r", "--pose", "0,-1300,0,0,0")
    assert r["reached"]
    assert r["residual_m"] <= 1e-9
    theta = ",".join(map(repr, r["theta_deg"]))
    p = record(capsys, "pose", "slavkovic_5r", "--theta-deg", theta)
    assert p["C_um_per_N"][1][1] == pytest.approx(2.295, abs=5e-4)
    assert abs(p["det_J"]) == pytest.approx(1.134, abs=5e-4)


def test_negative_values_are_values(capsys) -> None:
    assert record(capsys, "ik", "slavkovic_5r", "--pose", "-100,-1300,-50,0,0")["reached"]
    record(capsys, "pose", "planar_2r", "--theta-deg", "-10,20")


def test_a_pose_out_of_reach_says_why(capsys) -> None:
    r = record(capsys, "ik", "slavkovic_5r", "--pose", "0,-9000,0,0,0")
    assert not r["reached"]
    assert r["theta_deg"] == [None] * 5
    assert "beyond reach" in r["reason"]


def test_simulate(capsys) -> None:
    r = record(capsys, "simulate", FLUTE / "setup.toml")
    keys = {
        "max_deviation_mm",
        "rms_deviation_mm",
        "deviation_mm",
        "joint_share_mm",
        "force_N",
        "worst_block",
        "reached",
        "groove",
        "verdict",
        "tolerance_mm",
        "digest",
    }
    assert keys <= set(r)
    assert {"station_mm", "width_mm", "depth_mm", "centre_offset_mm", "floor_error_mm"} <= set(r["groove"][0])
    assert np.array(r["joint_share_mm"]).shape == (5, 3)
    assert r["force_N"] == pytest.approx([0, 100, 0], abs=1e-9)


def test_a_red_verdict_exits_with_1(capsys) -> None:
    code, out, _ = run(capsys, "simulate", FLUTE / "setup.toml", "--tol", "0.1")
    assert code == 1
    assert "out of tolerance" in out


def test_files_are_written(capsys, tmp_path: Path) -> None:
    code, _, err = run(capsys, "simulate", FLUTE, "--out", tmp_path / "run")
    assert code == 0, err
    assert {f.name for f in (tmp_path / "run").iterdir()} == {
        "result.json",
        "deviation.csv",
        "sections.csv",
        "machined.stl",
    }
    assert json.loads((tmp_path / "run" / "result.json").read_text())["verdict"] == "tight"
    assert (tmp_path / "run" / "machined.stl").stat().st_size > 10_000


def test_gcode(capsys) -> None:
    r = record(capsys, "gcode", FLUTE / "path.nc")
    assert r["ok"]
    assert r["units"] == "mm"
    assert r["moves"]["feed"] == 1
    assert r["length_mm"]["feed"] == pytest.approx(100.0)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("pose", "robbie", "--theta-deg", "0"), "robbie"),
        (("pose", "slavkovic_5r", "--theta-deg", "0,0"), "--theta-deg: expected 5 numbers"),
        (("pose", "slavkovic_5r", "--theta-deg", "0,0,0,0,x"), "--theta-deg: expected 5 numbers"),
        (("ik", "slavkovic_5r", "--pose", "0,nan,0,0,0"), "--pose: expected 5 numbers"),
        (("simulate", "nowhere.toml"), "nowhere.toml"),
        (("simulate", FLUTE, "--tol", "0"), "Tolerance"),
        (("simulate", FLUTE, "--program", "nowhere.nc"), "nowhere.nc"),
        (("gcode", "nowhere.nc"), "nowhere.nc"),
    ],
)
def test_refusals_exit_with_2_and_one_sentence(capsys, words, sentence: str) -> None:
    code, out, err = run(capsys, *words)
    assert code == 2
    assert out == ""
    assert sentence in err
    assert err.count("\n") == 1


def test_a_bad_program_names_its_line(capsys, tmp_path: Path) -> None:
    file = tmp_path / "bad.nc"
    file.write_text("G21 G90\nG1 X10 F100\nG1 Q\nM2\n")
    code, _, err = run(capsys, "simulate", FLUTE, "--program", file)
    assert code == 2
    assert "ine 3" in err


def test_text_output_reads_like_a_report(capsys) -> None:
    code, out, _ = run(capsys, "simulate", FLUTE)
    assert code == 0
    assert "within tolerance, tight" in out
    assert "joint 5" in out


def test_map_marks_what_is_not_reached(capsys, tmp_path: Path) -> None:
    words = ("--quantity", "C_yy,det_J", "--z", "0", "--x", "-600:600:300", "--y", "-3000:-1000:500")
    r = record(capsys, "map", "slavkovic_5r", *words, "--out", tmp_path / "map.csv")
    values = np.array(r["quantities"][0]["values"], dtype=float)
    assert values.shape == (5, 5, 1)
    assert np.isnan(values[:, 0]).all()
    assert np.isfinite(values[:, -1]).all()
    assert r["reached"]["of"] == 25
    assert (tmp_path / "map.csv").read_text().count("\n") == 26


def test_map_at_the_papers_point(capsys) -> None:
    r = record(capsys, "map", "slavkovic_5r", "--quantity", "C_yy", "--z", "0", "--x", "0", "--y", "-1300")
    assert r["quantities"][0]["values"][0][0][0] == pytest.approx(2.295, abs=5e-4)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--quantity", "C_qq", "--z", "0", "--x", "0", "--y", "-1300"), "C_qq"),
        (("--quantity", "C_yy", "--z", "0", "--x", "0:1", "--y", "-1300"), "--x: expected 3 numbers"),
        (("--quantity", "C_yy", "--z", "0", "--x", "0:100:0", "--y", "-1300"), "step above zero"),
    ],
)
def test_bad_maps_are_refused(capsys, words, sentence: str) -> None:
    code, _, err = run(capsys, "map", "slavkovic_5r", *words)
    assert code == 2
    assert sentence in err


def test_identify_the_papers_sample(capsys) -> None:
    tests = sorted((samples_dir() / "load_tests").glob("*.csv"))[0]
    r = record(capsys, "identify", "slavkovic_5r", tests, "--model", "joints")
    keys = {
        "C_theta",
        "stderr",
        "ci95",
        "correlation",
        "condition",
        "residual_rms_mm",
        "cv_relative_error",
        "outliers",
        "unseen_joints",
        "model",
    }
    assert keys <= set(r)
    assert len(r["C_theta"]) == 5


def test_an_apt_file_is_read_too(capsys, tmp_path: Path) -> None:
    file = tmp_path / "part.apt"
    file.write_text("UNITS/MM\nFEDRAT/600,MMPM\nGOTO/0,0,0,0,0,1\nGOTO/100,0,0,0,0,1\nFINI\n")
    r = record(capsys, "gcode", file)
    assert r["length_mm"]["feed"] == pytest.approx(100.0)
    assert r["units"] == "mm"


def test_a_program_in_place_of_a_setup_is_told_apart(capsys) -> None:
    code, _, err = run(capsys, "simulate", FLUTE / "path.nc")
    assert code == 2
    assert "this is a program, not a set-up" in err


def test_a_letter_o_for_a_zero_is_guessed(capsys, tmp_path: Path) -> None:
    file = tmp_path / "typed.nc"
    file.write_text("G21 G90\nG1 X5O.0 F100\nM2\n")
    code, _, err = run(capsys, "gcode", file)
    assert code == 2
    assert "letter O among its digits; write the digit 0" in err
    assert "ine 2" in err
