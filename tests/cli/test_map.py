"""Maps from the command line: marks, refusals, and what is not reached."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.cli.asked import record, run


def test_map_marks_what_is_not_reached(capsys, tmp_path: Path) -> None:
    words = ("--quantity", "C_yy,det_J", "--z", "0", "--x", "-600:600:300", "--y", "-3000:-1000:500")
    r = record(capsys, "map", "slavkovic_5r", *words, "--out", tmp_path / "map.csv")
    values = np.array(r["quantities"][0]["values"], dtype=float)
    assert values.shape == (5, 5, 1)
    assert np.isnan(values[:, 0]).all()
    assert np.isfinite(values[:, -1]).all()
    assert r["reached"]["of"] == 25
    assert (tmp_path / "map.csv").read_text().count("\n") == 26


def test_a_map_of_which_nothing_is_reached_is_not_green(capsys) -> None:
    code, out, _ = run(capsys, "map", "slavkovic_5r", "--quantity", "C_yy,C_yy", "--z", "9000", "--x", "0", "--y", "0")
    assert code == 1
    assert "The arm reaches none of these points" in out


@pytest.mark.parametrize("quantity", ["C_yy,det_J", " C_yy , det_J ", "C_yy,det_J,", ",C_yy,,det_J"])
def test_blanks_and_spare_commas_in_a_list_of_quantities_mean_nothing(capsys, quantity: str) -> None:
    r = record(capsys, "map", "slavkovic_5r", "--quantity", quantity, "--z", "0", "--x", "0", "--y", "-1300")
    assert [each["name"] for each in r["quantities"]] == ["C_yy", "det_J"]


@pytest.mark.parametrize("quantity", ["", " ", ","])
def test_a_map_of_nothing_is_refused(capsys, quantity: str) -> None:
    words = ("map", "slavkovic_5r", "--quantity", quantity, "--z", "0", "--x", "0", "--y", "-1300")
    code, _, err = run(capsys, *words)
    assert code == 2
    assert "--quantity: no quantity is named; give C_yy, det_J or another" in err


def test_a_map_says_where_its_last_point_is_and_each_quantity_once(capsys) -> None:
    """With steps of 50 mm from 0 no point falls on 120."""
    words = ("--quantity", "C_yy,C_yy", "--z", "0", "--x", "0:120:50", "--y", "-1300")
    code, out, _ = run(capsys, "map", "slavkovic_5r", *words)
    assert code == 0
    assert "0.0 mm to 100.0 mm" in out
    assert out.count("\nC_yy ") == 1


def test_map_at_the_papers_point(capsys) -> None:
    r = record(capsys, "map", "slavkovic_5r", "--quantity", "C_yy", "--z", "0", "--x", "0", "--y", "-1300")
    assert r["quantities"][0]["values"][0][0][0] == pytest.approx(2.295, abs=5e-4)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--quantity", "C_qq", "--z", "0", "--x", "0", "--y", "-1300"), "C_qq"),
        (
            ("--quantity", "C_yy", "--z", "0", "--x", "0:1", "--y", "-1300"),
            "--x: expected low:high:step or one number, in mm",
        ),
        (("--quantity", "C_yy", "--z", "0", "--x", "0:100:0", "--y", "-1300"), "step above zero"),
    ],
)
def test_bad_maps_are_refused(capsys, words, sentence: str) -> None:
    code, _, err = run(capsys, "map", "slavkovic_5r", *words)
    assert code == 2
    assert sentence in err


def test_a_tilted_map(capsys) -> None:
    words = ("map", "slavkovic_5r", "--quantity", "C_yy", "--z", "0", "--x", "0", "--y", "-1300")
    tilted = record(capsys, *words, "--a-deg", "-10", "--b-deg", "5")
    assert (tilted["a_deg"], tilted["b_deg"]) == (pytest.approx(-10), pytest.approx(5))
    answer = record(capsys, "ik", "slavkovic_5r", "--pose", "0,-1300,0,-10,5")
    pose = record(capsys, "pose", "slavkovic_5r", "--theta-deg", ",".join(map(repr, answer["theta_deg"])))
    assert tilted["quantities"][0]["values"][0][0][0] == pytest.approx(pose["C_um_per_N"][1][1], rel=1e-9)
