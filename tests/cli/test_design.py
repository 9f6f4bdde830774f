"""``robomill design``: its answer for people and programs, and its exit codes."""

import json
from pathlib import Path

import numpy as np
import pytest

import robomill as rm
from robomill.cli import main


def asked(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, dict]:
    code = main(["design", *words, "--json"])
    return code, json.loads(capsys.readouterr().out)


def test_the_record_tells_joints_cost_and_the_cut_before_and_then(capsys: pytest.CaptureFixture[str]) -> None:
    code, record = asked(capsys, "paper_flute", "--tolerance-mm", "0.1")
    assert code == 0
    assert record["feasible"] is True
    assert record["reason"] is None
    robot = rm.load_robot("slavkovic_5r")
    C_theta = [c / ratio for c, ratio in zip(robot.C_theta, record["stiffness_ratio"], strict=True)]
    assert record["C_theta"] == pytest.approx(C_theta)
    setup = rm.load_setup("paper_flute")
    run = rm.simulate(setup.replace(robot=robot.replace(C_theta=record["C_theta"])))
    assert record["max_deviation_mm"] == pytest.approx(run.max_deviation * 1e3)
    assert max(record["wall_mm"], record["floor_mm"]) <= 0.1
    assert record["before"]["max_deviation_mm"] == pytest.approx(rm.simulate(setup).max_deviation * 1e3)
    assert any("lengths" in each["what"] for each in record["assumed"])


def test_what_cannot_be_met_exits_1_and_says_which_joint(capsys: pytest.CaptureFixture[str]) -> None:
    code, record = asked(capsys, "paper_flute", "--tolerance-mm", "0.01")
    assert (code, record["feasible"]) == (1, False)
    assert record["reason"].startswith("joint 3 alone leaves")
    assert main(["design", "paper_flute", "--tolerance-mm", "0.01"]) == 1
    assert capsys.readouterr().out.startswith("Cannot be met: joint 3 alone leaves")


@pytest.mark.parametrize(
    "words",
    [
        ("paper_flute", "--tolerance-mm", "0"),
        ("paper_flute", "--tolerance-mm", "nan"),
        ("paper_flute", "--most", "0.5"),
        ("paper_flute/setup_measured_map",),
        ("nobody",),
    ],
)
def test_what_cannot_be_asked_exits_2_with_a_sentence(
    words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["design", *words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.strip().splitlines()) == 1


def test_a_cut_that_leaves_no_wall_says_none_of_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A face cut by a mill wider than the part: floors, and no wall."""
    path = rm.Toolpath.from_points(p_mm=[[-20, 0, -1], [20, 0, -1]], feed_mm_min=600)
    stock = rm.Stock(lower_mm=[-10, -3, -5], upper_mm=[10, 3, 0])
    setup = rm.load_setup("paper_flute").replace(source=path, stock=stock)
    rm.write_setup(tmp_path / "face.toml", setup)
    main(["design", str(tmp_path / "face.toml"), "--tolerance-mm", "0.2"])
    said = capsys.readouterr().out
    assert "wall none, floor 0." in said
    assert "nan" not in said


BOX = ["--box=-300,-1500,-100:300,-1100,100", "--force=60,100,-30"]


def test_over_a_box_every_point_keeps_the_tolerance(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "paper_flute", *BOX, "--tolerance-mm", "0.2", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["feasible"]
    assert record["points"] == record["reached"] == 7 * 5 * 3
    robot = rm.load_setup("paper_flute").robot.replace(C_theta=record["C_theta"])
    x = [each * 1e-3 for each in record["worst_at_mm"]]
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([*x, 0.0, 0.0])).theta
    pushed = np.linalg.norm(rm.cartesian_compliance(robot, theta) @ [60.0, 100.0, -30.0])
    assert record["max_deviation_mm"] == pytest.approx(pushed * 1e3, rel=1e-6) == pytest.approx(0.2, rel=1e-5)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (BOX[:1], "--force FX,FY,FZ in N; one of them is not given"),
        ([*BOX, "--measure", "wall"], "in a box there is no part"),
        (["--box=100,0,0:0,0,0", BOX[1]], "its x ends before it begins"),
        ([BOX[0], "--force=1,2"], "--force"),
        ([*BOX, "--every", "0"], "step"),
    ],
)
def test_a_box_that_is_not_one_is_refused(capsys: pytest.CaptureFixture[str], options: list[str], words: str) -> None:
    assert main(["design", "paper_flute", *options]) == 2
    assert words in capsys.readouterr().err


def test_over_a_box_that_cannot_be_met_it_says_where_and_exits_1(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "paper_flute", *BOX, "--tolerance-mm", "0.05", "--most", "2"]) == 1
    assert capsys.readouterr().out.startswith("Cannot be met:")
