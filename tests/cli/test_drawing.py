"""``robomill drawing``, and points in the place of a program."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

import robomill as rm
from robomill.cli import main

CUT = ("drawing", "bracket.svg", "--cut", "slots:inside:3", "--step-down", "1", "--feed", "600", "--diameter", "8")


def test_the_layers_of_a_drawing_and_their_lengths(capsys) -> None:
    assert main(["drawing", "bracket", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    found = {each["layer"]: each for each in record["layers"]}
    assert found["holes"]["contours"] == found["holes"]["closed"] == 2
    assert found["holes"]["length_mm"] == pytest.approx(24 * math.pi, rel=1e-4)


def test_a_program_that_cuts_along_the_lines_of_a_layer(tmp_path, capsys) -> None:
    file = tmp_path / "slots.nc"
    assert main([*CUT, "--out", str(file)]) == 0
    assert "slots.nc" in capsys.readouterr().out
    path = rm.read_gcode(file)
    level = path.cutting & (np.abs(np.diff(path.p[:, 2], prepend=0.0)) < 1e-12)
    assert path.step_length[level].sum() == pytest.approx(6 * (80 + 2 * math.pi) * 1e-3, rel=2e-4)
    assert path.p[:, 2].min() == pytest.approx(-3e-3)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("drawing", "bracket", "--cut", "slots"), "expected a depth in mm, as slots:on:3, or --depth for all."),
        (("drawing", "bracket", "--cut", "slots:by:3"), "expected LAYER:SIDE:DEPTH"),
        (("drawing", "bracket", "--cut", "slots:on:3"), "--feed: say how fast"),
        (("drawing", "bracket", "--out", "x.nc"), "--out: say what is cut"),
        (("drawing", "nothing.dxf"), "cannot be opened"),
        (("simulate", "paper_flute", "--program", "x.dxf"), "this is a drawing; make a program of it"),
    ],
)
def test_refusals_say_which_option(words, said, capsys) -> None:
    assert main(list(words)) == 2
    assert said in capsys.readouterr().err


def test_points_in_the_place_of_a_program(tmp_path, capsys) -> None:
    file = Path(tmp_path / "p.CSV")
    file.write_text("X,Y,Z\n0,0,0.05\n0,0,-0.05\n2,0,-0.05\n")
    assert main(["gcode", str(file)]) == 2
    assert "name no unit" in capsys.readouterr().err
    assert main(["gcode", str(file), "--unit", "in", "--feed", "600", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["length_mm"]["feed"] == pytest.approx(2.1 * 25.4)
    assert main(["simulate", "paper_flute", "--program", str(file), "--unit", "in", "--feed", "600", "--json"]) in (
        0,
        1,
    )
