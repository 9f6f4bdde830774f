"""``robomill report``: the page, its record, and what ``--remedies`` adds to both."""

from __future__ import annotations

import html
import json
import re
from pathlib import Path

import pytest

import robomill as rm
from robomill.cli import main
from robomill.simulation.band import worst_half


def record_of(capsys: pytest.CaptureFixture[str], *words: object) -> dict:
    code = main(["report", *map(str, words), "--json"])
    found = json.loads(capsys.readouterr().out)
    return found | {"code": code}


def test_the_record_is_that_of_the_run_with_the_page_it_wrote(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    out = tmp_path / "report.html"
    found = record_of(capsys, "paper_flute", "--out", out)
    assert main(["simulate", "paper_flute", "--json"]) == found.pop("code") == 0
    run = json.loads(capsys.readouterr().out)
    assert found.pop("remedies") == []
    (file,) = found.pop("files")
    assert file == {"path": str(out), "bytes": out.stat().st_size, "replaced": False}
    assert run.pop("files") == []
    assert found == run


def test_remedies_stand_in_record_page_and_lines_with_the_numbers_of_the_library(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """A cut of five joints: each way to mend it, and of the turn of a spindle why it is none."""
    out, cut = tmp_path / "report.html", "paper_flute/setup_process"
    found = record_of(capsys, cut, "--remedies", "--tol", "0.2", "--out", out)
    assert found["code"] == 1
    setup = rm.load_setup(cut).replace(tolerance_mm=0.2, floor_tolerance=None)
    titles = [each["title"] for each in found["remedies"]]
    corrected = found["remedies"][titles.index("Correct the program")]
    left = rm.compensate(setup).after.max
    assert f"{left * 1e3:.4f} mm at most" in corrected["leaves"]
    stiffer = found["remedies"][titles.index("Stiffen joints")]
    assert f"{max(rm.design(setup).stiffness_ratio):.2f}" in stiffer["what"]
    turned = found["remedies"][titles.index("Turn the spindle")]
    assert "an arm of 5 joints holds the tool in one way" in turned["leaves"]
    page = " ".join(html.unescape(re.sub(r"<[^>]+>", " ", out.read_text(encoding="utf-8"))).split())
    for each in found["remedies"]:
        assert each["title"] in page
        assert " ".join(each["leaves"].split()) in page
    assert main(["report", cut, "--remedies", "--tol", "0.2", "--out", str(out)]) == 1
    said = capsys.readouterr().out
    assert said.count("\nremedy    ") == len(titles)
    assert "replacing an older one" in said


def test_what_the_set_up_knows_of_its_compliances_stands_in_simulate_and_report(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    bare = rm.load_setup("paper_flute")
    fit = rm.identify(bare.robot, "nine_points")
    setup = bare.replace(robot=fit.applied_to(bare.robot), knowledge=fit)
    file = rm.write_setup(tmp_path / "mine.toml", setup)
    assert main(["simulate", str(file), "--out", str(tmp_path / "run")]) == 0
    (line,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("sure ")]
    assert "(95 % band, identified)" in line
    found = record_of(capsys, tmp_path / "run", "--out", tmp_path / "report.html")  # the copy knows it, too
    (band,) = [each for each in found["ranges"] if each["kind"] == "measured"]
    low, high = band["tip_mm"]
    assert f"tip {low:.3f} mm to {high:.3f} mm" in line
    half = 0.5e-3 * (high - low)
    assert half == pytest.approx(worst_half(rm.simulate(setup), setup.known), rel=1e-6)
    assert "95 % band, identified" in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert main(["simulate", "paper_flute"]) == 0
    assert "\nsure " not in capsys.readouterr().out
