"""The sample load tests: what they say of themselves, what must be found in them, and that they can be made again."""

from __future__ import annotations

import importlib.util
import tomllib

import numpy as np
import pytest

import robomill as rm
from robomill.identification.fit.comparison import compare_models
from robomill.identification.fit.estimate import identify
from robomill.io.measured.load_tests import read_findings
from robomill.io.samples import samples_dir
from robomill.units import from_si, to_si

FOLDER = samples_dir() / "load_tests"
FILES = sorted(FOLDER.glob("*.csv"))
EXPECTED = tomllib.loads((FOLDER / "expected.toml").read_text(encoding="utf-8"))["identification"]
ROBOT = rm.load_robot("slavkovic_5r")


def robot_of(row):
    return rm.load_robot(row["robot"]) if "robot" in row else ROBOT


@pytest.mark.parametrize("row", EXPECTED, ids=lambda row: row["file"])
def test_expected_identification(row):
    robot = robot_of(row)
    chosen = {key: row[key] for key in ("fit_points", "bending") if key in row}
    result = identify(robot, rm.read_load_tests(FOLDER / row["file"], robot), row["model"], **chosen)
    truth = to_si(np.array(row["truth"]), "1e-7 rad/(N m)")
    assert ((result.ci95[:, 0] <= truth) & (truth <= result.ci95[:, 1])).all(), row["why"]
    assert result.cv_relative_error < row["cv_below"]
    assert [u.joint for u in result.unseen_joints] == row["unseen"]
    assert result.outliers == ()
    for point in result.points:
        low, high = from_si(point.ci95, "mm").T
        true = np.array(row[f"{point.point}_point_flange_mm"])
        assert ((low <= true) & (true <= high)).all(), row["why"]
    if "bends_at" in row:
        assert list(result.choice.bending_joints) == row["bends_at"]
    if "noise_um" in row:
        assert from_si(result.noise, "um") == pytest.approx(row["noise_um"], rel=0.15)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_every_file_says_that_it_is_synthetic_and_looks_sound(file):
    (robot,) = {row.get("robot"): robot_of(row) for row in EXPECTED if row["file"] == file.name}.values()
    tests = rm.read_load_tests(file, robot)
    assert tests.provenance.kind == "synthetic"
    for word in ("Synthetic", "Truth", "Noise", "seed"):
        assert word in tests.provenance.source
    assert [f for f in read_findings(tests, robot) if f.level in ("suspicious", "warning", "ignored")] == []


def test_the_files_can_be_made_again(tmp_path, monkeypatch):
    spec = importlib.util.spec_from_file_location("sample_load_tests_generator", FOLDER / "generate.py")
    generator = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(generator)
    monkeypatch.setattr(generator, "HERE", tmp_path)
    generator.main()
    for file in FILES:
        (robot,) = {row.get("robot"): robot_of(row) for row in EXPECTED if row["file"] == file.name}.values()
        made, kept = rm.read_load_tests(tmp_path / file.name, robot), rm.read_load_tests(file, robot)
        assert made.provenance.source.splitlines()[1:] == kept.provenance.source.splitlines()[1:]
        names = ("torque", "angle") if hasattr(kept, "torque") else ("wrench", "displacement")
        for name in names:  # to the last printed digit or so, on any machine
            np.testing.assert_allclose(getattr(made, name), getattr(kept, name), atol=2.1e-7)


def test_bending_is_found_in_the_tilted_sample_and_the_joints_alone_absorb_it():
    comparison = compare_models(ROBOT, rm.read_load_tests(FOLDER / "tilted_bending_tool.csv"))
    by_name = {result.model: result for result in comparison.results}
    assert comparison.best.model == "joints+bending+tool"
    assert by_name["joints"].cv_relative_error > 3 * comparison.best.cv_relative_error
    assert by_name["joints"].C_theta[0] > to_si(14.0, "1e-7 rad/(N m)")
    assert "absorbed" in comparison.absorbed()
