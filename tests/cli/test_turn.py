"""``robomill turn``: its answer for people and programs, and its exit codes."""

import json

import pytest

import robomill as rm
from robomill.cli import main


def test_the_record_tells_now_the_best_spin_and_the_best_course(capsys: pytest.CaptureFixture[str], tmp_path) -> None:
    setup = rm.load_setup("paper_flute").replace(
        robot=rm.load_robot("fanuc_r2000ic"), part_zero=(1.2, 0.0, 0.3), cell_mm=0.5, step_mm=5
    )
    file = rm.write_setup(tmp_path / "six.toml", setup)
    code = main(["turn", str(file), "--json"])
    record = json.loads(capsys.readouterr().out)
    assert code == 0
    assert record["now"]["max_deviation_mm"] == pytest.approx(rm.simulate(rm.load_setup(file)).max_deviation * 1e3)
    run = rm.simulate(rm.load_setup(file).replace(spin_deg=record["spin_deg"]))
    assert record["constant"]["max_deviation_mm"] == pytest.approx(run.max_deviation * 1e3)
    assert record["course"]["share"] <= record["constant"]["share"] <= record["now"]["share"]
    assert len(record["map"]["share"]) == len(record["map"]["way_mm"])
    assert len(record["spins"]["way_mm"]) == len(record["spins"]["spin_deg"])
    assert main(["turn", str(file), "--rate", "0.5"]) == 0
    assert capsys.readouterr().out.startswith("course    from")


def test_an_arm_of_five_axes_is_told_that_nothing_is_left(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["turn", "paper_flute"]) == 2
    assert "an arm of 5 joints holds the tool in one way; nothing is left to turn" in capsys.readouterr().err
