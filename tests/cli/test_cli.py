"""The command line: JSON records, exit codes, refusals on stderr."""

from __future__ import annotations

import json
import os
import pty
import re
import shutil
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

from robomill.cli import main
from robomill.io.robot.robots import load_robot
from robomill.io.robot.writer import robot_to_toml
from robomill.io.samples import samples_dir
from tests.cli.asked import record, run

FLUTE = samples_dir() / "paper_flute"


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


def test_pose_of_six_axes_has_its_determinant(capsys) -> None:
    r = record(capsys, "pose", "kuka_kr500", "--theta-deg", "10,-70,80,20,30,40")
    assert r["det_J"] == pytest.approx(np.linalg.det(np.array(r["J"])))
    assert r["det_J_unit"] == "m3"


def test_a_held_axis_is_left_out_and_the_others_keep_their_numbers(capsys, tmp_path: Path) -> None:
    robot = load_robot("slavkovic_5r")
    held = tmp_path / "held.toml"
    held.write_text(robot_to_toml(robot.replace(blocked=np.array([np.nan, 0.1, np.nan, np.nan, np.nan]))))
    assert record(capsys, "pose", held, "--theta-deg", "0,0,0,0")["joints"] == [1, 3, 4, 5]
    _, text, _ = run(capsys, "pose", held, "--theta-deg", "0,0,0,0")
    assert re.findall(r"of joint (\d)", text) == ["1", "3", "4", "5"]


def test_negative_values_are_values(capsys) -> None:
    assert record(capsys, "ik", "slavkovic_5r", "--pose", "-100,-1300,-50,0,0")["reached"]
    record(capsys, "pose", "planar_2r", "--theta-deg", "-10,20")


def test_a_pose_out_of_reach_says_why(capsys) -> None:
    code, out, _ = run(capsys, "ik", "slavkovic_5r", "--pose", "0,-9000,0,0,0", "--json")
    r = json.loads(out)
    assert code == 1
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


def test_another_tolerance_of_walls_and_floors_leaves_that_along_the_feed(capsys, tmp_path: Path) -> None:
    shutil.copytree(FLUTE, tmp_path, dirs_exist_ok=True)
    setup = tmp_path / "setup.toml"
    three = "tolerance_mm = { wall = 0.3, floor = 0.3, feed = 0.001 }"
    setup.write_text(setup.read_text().replace("tolerance_mm = 0.3", three).replace("feed_N = 0.0", "feed_N = 100.0"))
    code, out, _ = run(capsys, "simulate", setup, "--tol", "0.5", "--json")
    judged = json.loads(out)
    assert [judged[name]["tolerance_mm"] for name in ("wall", "floor", "feed")] == [0.5, 0.5, 0.001]
    assert code == 1, "the ends of the cut lie further along the feed than a micrometre"


SLOT = "G0 X-50 Y0 Z-2\nG1 X50 F1800"
UNKNOWN = {
    "a spindle that turns the wrong way": ("setup_process.toml", f"S12000 M4\n{SLOT}", "spindle_sense"),
    "the same under a stated force": ("setup.toml", f"S12000 M4\n{SLOT}", "spindle_sense"),
    "a spindle at an unknown speed": ("setup_process.toml", f"G96 S200 M3\n{SLOT}", "spindle_speed"),
    "a plunge under a stated force": ("setup.toml", "S12000 M3\nG0 X0 Y0 Z5\nG81 Z-8 R2 F300\nG80", ""),
}


@pytest.mark.parametrize("name", UNKNOWN)
def test_what_has_no_model_exits_with_1_and_says_why(name, capsys, tmp_path: Path) -> None:
    setup, text, reason = UNKNOWN[name]
    program = tmp_path / "part.nc"
    program.write_text(f"G21 G90\n{text}\nM2\n")
    code, out, err = run(capsys, "simulate", FLUTE / setup, "--program", program, "--json")
    assert code == 1, err
    found = json.loads(out)
    assert found["verdict"] == "unjudged"
    assert found["not_judged"]["count"] > 0
    assert found["not_judged"]["blocks"]
    assert reason in found["not_judged"]["reasons"][0]["code"]
    code, out, _ = run(capsys, "simulate", FLUTE / setup, "--program", program, "--out", tmp_path / "out")
    assert code == 1
    assert "not judged" in out


def test_a_force_of_which_a_part_is_not_known_is_never_green(capsys, tmp_path: Path) -> None:
    """A row from turning gives the tangential force alone. Named, it is not judged; with the shares assumed there is a
    number, the same as of a row that holds them, and its range is that of the published shares."""
    shutil.copytree(FLUTE, tmp_path, dirs_exist_ok=True)
    setup, text = tmp_path / "setup_process.toml", (FLUTE / "setup_process.toml").read_text()
    old = 'kind = "mechanistic"\nmaterial = "al7075_t6_carbide_ref190"'
    row = (samples_dir() / "materials" / "al_wrought_cured_kienzle.toml").read_text()

    def simulated(kind: str, radial: float | None = None, axial: float | None = None) -> tuple[int, dict]:
        force = 'kind = "kienzle"\nmaterial = "al_wrought_cured_kienzle"'
        if kind == "row":
            ratios = f"[coefficients]\nradial_ratio = {radial}\naxial_ratio = {axial}"
            (tmp_path / "own.toml").write_text(row.replace("[coefficients]", ratios))
            force = 'kind = "kienzle"\nmaterial = "own.toml"'
        elif kind == "shares":
            force += f"\nradial_share = {radial}" + ("" if axial is None else f"\naxial_share = {axial}")
        setup.write_text(text.replace(old, force))
        code, out, err = run(capsys, "simulate", setup, "--tol", "0.9", "--json")
        assert code in (0, 1), err
        return code, json.loads(out)

    for given in ((), ("shares", 0.4)):
        code, found = simulated(*(given or ("bare",)))
        assert (code, found["verdict"]) == (1, "unjudged")
        assert found["not_judged"]["count"] == found["not_judged"]["of"]
        (reason,) = found["not_judged"]["reasons"]
        assert reason["code"] == "coefficient"
        assert ("radial_ratio" in reason["names"]) == (not given)
        assert "axial_share" in reason["names"]
    code, assumed = simulated("shares", 0.4, 0.1)
    held_code, held = simulated("row", 0.4, 0.1)
    assert (code, assumed["verdict"]) == (held_code, held["verdict"]) == (0, "ok")
    assert assumed["deviation_mm"] == pytest.approx(held["deviation_mm"])
    assert {"assumed-radial-share", "assumed-axial-share"} <= {each["code"] for each in assumed["findings"]}
    largest = [each["max_deviation_mm"] for each in assumed["alloy_spread"]]
    corners = [simulated("row", r, a)[1]["max_deviation_mm"] for r in (0.2, 0.95) for a in (0.04, 0.42)]
    assert largest[1:] == pytest.approx(corners)


def test_a_drilled_hole_has_a_thrust(capsys, tmp_path: Path) -> None:
    """Plunging an end mill in the paper's set-up ended in 0.00 mm and green: now in a thrust, and in a depth error of
    C_zz times it."""
    program = tmp_path / "hole.nc"
    program.write_text("G21 G90 S12000 M3\nG0 X0 Y0 Z5\nG81 Z-8 R2 F300\nG80\nM2\n")
    code, out, err = run(capsys, "simulate", FLUTE / "setup_process.toml", "--program", program, "--json")
    assert code == 1, err
    found = json.loads(out)
    thrust = found["force_component_N"]["axial"]
    assert thrust > 100.0
    assert found["floor"]["value_mm"] == pytest.approx(2.42e-3 * thrust, rel=0.02)
    assert found["floor"]["line"] == 3


@pytest.mark.parametrize("name", ["-", "/dev/stdin", "pipe"])
def test_a_program_that_can_be_read_once(name: str, tmp_path: Path) -> None:
    text = b"G21 G1 X5 F100\nM2\n"
    file = tmp_path / "pipe"
    if name == "pipe":
        os.mkfifo(file)
        threading.Thread(target=file.write_bytes, args=(text,), daemon=True).start()
    command = [sys.executable, "-m", "robomill", "gcode", str(file) if name == "pipe" else name, "--json"]
    done = subprocess.run(command, input=text if name != "pipe" else b"", capture_output=True, check=True, timeout=60)
    assert json.loads(done.stdout)["length_mm"]["feed"] == pytest.approx(5.0)


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
        (("pose", "slavkovic_5r", "--theta-deg", "1_0,0,0,0,0"), "--theta-deg: expected 5 numbers"),
        (("pose", "slavkovic_5r", "--theta-deg", "0,0,0,0,x"), "--theta-deg: expected 5 numbers"),
        (("ik", "slavkovic_5r", "--pose", "0,nan,0,0,0"), "--pose: expected 5 numbers"),
        (("simulate", "nowhere.toml"), "nowhere.toml"),
        (("simulate", FLUTE, "--tol", "0"), "Tolerance"),
        (("simulate", FLUTE, "--program", "nowhere.nc"), "nowhere.nc"),
        (("gcode", "nowhere.nc"), "nowhere.nc"),
        (("simulate", "paper_flut"), "did you mean 'paper_flute'?"),
        (("simulate", "kuka_kr270"), "'kuka_kr270' is a robot."),
        (("gcode", "hart"), "did you mean 'heart'?"),
        (("identify", "slavkovic_5r", "nine_point"), "did you mean 'nine_points'?"),
        (("pose", "KUKA_KR27", "--theta-deg", "0"), "did you mean 'kuka_kr270'?"),
        (("pose", FLUTE / "setup.toml", "--theta-deg", "0"), "this is a set-up, not a robot"),
        (("gcode", FLUTE / "setup.toml"), "setup.toml: this is TOML"),
        (("simulate", ""), "is empty"),
        (("samples", "--copy", ""), "has no name"),
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
    assert "within tolerance" in out
    assert "joint 5" in out


def test_a_joint_beyond_its_limits_is_not_reached(capsys) -> None:
    words = ("pose", "slavkovic_5r", "--theta-deg", "500,0,0,0,0")
    code, out, _ = run(capsys, *words)
    assert code == 1
    assert "not reached: joint 1 is at 500.0°, beyond its limits of −120.0° to 120.0°" in out
    code, out, _ = run(capsys, *words, "--json")
    found = json.loads(out)
    assert (code, found["reached"]) == (1, False)
    assert found["C_um_per_N"][1][1] > 0.0  # what a person asked for is there all the same
    assert record(capsys, "pose", "slavkovic_5r", "--theta-deg", "119,0,0,0,0")["reached"] is True


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


def test_ctrl_c_in_the_midst_of_a_run_ends_it_with_130_and_one_line(tmp_path) -> None:
    """A run of far longer than the terminal takes to be read: 50 000 coupled steps."""
    folder = Path(shutil.copytree(FLUTE, tmp_path / "flute"))
    text = (folder / "setup_process.toml").read_text()
    setup = folder / "long.toml"
    setup.write_text(text.replace("step_mm = 1.0", "step_mm = 0.002\ncoupling = true"))
    command = [sys.executable, "-m", "robomill", "simulate", str(setup)]
    leader, terminal = pty.openpty()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=terminal)
    os.close(terminal)
    said = b""
    while b"step by step: " not in said and process.poll() is None:
        said += os.read(leader, 1000)
    process.send_signal(signal.SIGINT)
    assert process.wait(120) == 130, said
    assert b"Traceback" not in said
    assert process.stdout is not None
    assert process.stdout.read() == b""
    process.stdout.close()
    os.close(leader)


def test_a_pose_farther_than_any_machine_is_refused(capsys) -> None:
    assert main(["ik", "slavkovic_5r", "--pose", "1e308,0,0,0,0"]) == 2
    assert "--pose: it lies" in capsys.readouterr().err


def test_version_and_help_are_no_apps(capsys) -> None:
    for word, said in (("--version", "robomill 0."), ("--help", "simulate")):
        with pytest.raises(SystemExit) as left:
            main([word])
        assert left.value.code == 0
        assert said in capsys.readouterr().out


def test_robots_as_lines(capsys) -> None:
    code, out, _ = run(capsys, "robots")
    assert code == 0
    assert "slavkovic_5r       5 joints  Five-axis machining robot (Slavkovic et al. 2013)" in out.splitlines()


def test_another_compliance_set_gives_its_own_numbers(capsys) -> None:
    words = ("pose", "slavkovic_5r", "--theta-deg", "0,0,0,0,0")
    soft = record(capsys, *words, "--compliance-set", "table_3")
    stiff = record(capsys, *words)
    assert (stiff["compliance_set"], soft["compliance_set"]) == ("table_2", "table_3")
    share = np.array(soft["joint_share_um_per_N"]) / np.array(stiff["joint_share_um_per_N"])
    ratio = np.nanmax(share, axis=(1, 2))  # each joint's share grows as its compliance: Tables 2 and 3
    np.testing.assert_allclose(ratio, np.array([9.03, 11.17, 14.74, 27.65, 97.58]) / [7.14, 10.12, 12.30, 17.32, 91.35])
    code, _, err = run(capsys, *words, "--compliance-set", "table_9")
    assert code == 2
    assert "it has: table_2, table_3" in err


def test_sliding_joints_are_in_millimetres(capsys, tmp_path: Path) -> None:
    turn = "[[joint]]\nalpha_deg = 0\na_mm = 0\nd_mm = 0\ntheta_offset_deg = 0\n"
    text = f'{turn}limits_deg = [-90, 90]\n{turn}type = "prismatic"\nlimits_mm = [0, 500]\n'
    file = tmp_path / "slide.toml"
    file.write_text(text + "[compliance]\nC_theta_SI = [1e-6, 1e-8]\n")
    r = record(capsys, "pose", file, "--theta-deg", "30,250")
    np.testing.assert_allclose(np.array(r["T_MT"])[:3, 3], [0, 0, 0.25], atol=1e-15)
    np.testing.assert_allclose(np.array(r["T_MT"])[0, :2], [np.sqrt(0.75), -0.5])
    np.testing.assert_allclose(r["theta_deg"], [30, 250])
    np.testing.assert_allclose(np.array(r["C_um_per_N"])[2, 2], 1e-8 * 1e6)
    # Turning about Z and going along it: the rows v_z and omega_z exchange the two joint speeds, whatever the length.
    assert (r["det_J"], r["det_J_unit"]) == (pytest.approx(-1.0), "1")


def test_moves_are_written_one_a_line(capsys, tmp_path: Path) -> None:
    out = tmp_path / "moves.jsonl"
    record(capsys, "gcode", FLUTE / "path.nc", "--moves", out)
    assert all(json.loads(line) for line in out.read_text().splitlines())


def test_moves_of_apt_are_written_too(capsys, tmp_path: Path) -> None:
    file, out = tmp_path / "a.apt", tmp_path / "moves.jsonl"
    file.write_text("UNITS/MM\nFROM/0,0,5\nRAPID\nGOTO/1,0,5\nFEDRAT/60,MMPM\nGOTO/1,0,0,0,0.6,0.8\nFINI\n")
    record(capsys, "gcode", file, "--moves", out)
    rapid, cut = (json.loads(line) for line in out.read_text().splitlines())
    assert rapid == {"line": 4, "kind": "traverse", "start": [0, 0, 5], "end": [1, 0, 5], "axis": [0, 0, 1]}
    assert (cut["kind"], cut["line"], cut["feed_mm_min"], cut["end"]) == ("feed", 6, pytest.approx(60), [1, 0, 0])
    assert cut["axis"] == pytest.approx([0, 0.6, 0.8])
