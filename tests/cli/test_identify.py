"""Identification and planned tests from the command line."""

from __future__ import annotations

from pathlib import Path

import pytest

from robomill.cli import main
from robomill.io.samples import samples_dir
from tests.cli.asked import record, run


def test_what_made_up_load_tests_gave_stays_marked_so(capsys, tmp_path: Path) -> None:
    file = tmp_path / "ident.toml"
    assert run(capsys, "identify", "slavkovic_5r", "nine_points", "--out", file)[0] == 0
    found = record(capsys, "simulate", "paper_flute", "--robot", file)
    assert "joint compliances (synthetic)" in [each["what"] for each in found["assumed"]]


def test_identify_the_papers_sample(capsys) -> None:
    tests = samples_dir() / "load_tests" / "grid_45x6.csv"
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


@pytest.mark.parametrize("count", ["0", "-1", "100000", "two"])
def test_as_many_tests_as_nobody_does_are_not_planned(capsys, count) -> None:
    with pytest.raises(SystemExit) as left:
        main(["identify", "slavkovic_5r", "tests.csv", "--next", count])
    assert left.value.code == 2
    assert "--next: expected a whole number from 1 to 100" in capsys.readouterr().err


def test_bending_joints_have_to_be_numbers(capsys) -> None:
    tests = samples_dir() / "load_tests" / "nine_points.csv"
    code, _, err = run(capsys, "identify", "slavkovic_5r", tests, "--bending-joints", "")
    assert code == 2
    assert "--bending: expected one or more numbers" in err


def test_named_bending_joints_bend_without_a_word_of_the_model(capsys) -> None:
    """They were left out in silence where --model was not given too."""
    tests = str(samples_dir() / "load_tests" / "tilted_bending_tool.csv")
    found = [
        record(capsys, "identify", "slavkovic_5r", tests, *words)
        for words in ((), ("--bending", "2"), ("--bending", "2", "--model", "joints+bending"), ("--bending", "auto"))
    ]
    assert [each["model"] for each in found][:3] == ["joints", "joints+bending", "joints+bending"]
    assert found[1]["C_theta"] == found[2]["C_theta"]
    assert found[1]["bending_joints"] == [2]
    assert found[1]["C_theta"] != found[0]["C_theta"]
