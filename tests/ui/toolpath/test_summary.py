"""What the toolpath page says about a program: its units and who said them, its moves, counted plainly."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.provenance import Finding
from robomill.toolpath.source import GCodeSource
from robomill.ui.toolpath.summary import (
    finding_words,
    move_words,
    size_words,
    worst_first,
    written_in,
)

CUTS = """G21 G90
S1000 M3
G0 Z5
G1 Z-1 F600
X3 Y1
X9 Y4
X2 Y7
G0 Z5
X0
G1 Z-1
Y-3
G0 Z5
M2
"""
APT = "PARTNO/X\n{}FEDRAT/600\nFROM/0,0,10\nGOTO/0,0,0\nGOTO/10,0,0\nFINI\n"


@pytest.mark.parametrize(
    ("text", "short", "long"),
    [
        ("G21 G90\nG1 X50 F600\nM2\n", "mm (G21)", "millimetres (G21)"),
        ("G20 G90\nG1 X2 F20\nM2\n", "in (G20)", "inches (G20)"),
        ("G90\nG1 X50 F600\nM2\n", "mm, assumed (no G20 or G21)", "millimetres, assumed (no G20 or G21)"),
        (APT.format("UNITS/MM\n"), "mm (UNITS)", "millimetres (UNITS)"),
        (APT.format(""), "mm, assumed (no UNITS)", "millimetres, assumed (no UNITS)"),
    ],
)
def test_units_are_said_with_who_said_them(text: str, short: str, long: str) -> None:
    source = GCodeSource(text)
    assert written_in(source, source.read()) == short
    assert written_in(source, source.read(), long=True) == long


def test_an_arc_is_one_move() -> None:
    path = GCodeSource("G21 G90\nG0 X0 Y0 Z2\nG1 Z-1 F300\nG1 X20\nG3 X20 Y10 J5\nG1 X0\nG0 Z5\nM2\n").read()
    assert len(path) > 12
    assert path.counts is not None
    assert move_words(path) == "6 moves, 1 arc"
    straight = GCodeSource("G21 G90\nG0 X0 Y0 Z-1\nG1 X20 F300\nM2\n").read()
    assert move_words(straight).endswith(", no arcs")


@pytest.mark.parametrize(
    ("size", "said"),
    [
        ((0.1, 0.0, 0.0), "100.0 mm along X"),
        ((0.06, 0.04, 0.0), "60.0 × 40.0 mm along X and Y"),
        ((0.06, 0.04, 0.002), "60.0 × 40.0 × 2.0 mm along X, Y and Z"),
        ((0.0, 0.0, 0.0), "in one place"),
    ],
)
def test_a_path_is_as_large_as_along_the_axes_that_it_moves_along(size: tuple[float, float, float], said: str) -> None:
    assert size_words(np.array(size), "mm") == said


def test_a_finding_fits_its_tile_and_the_worst_is_first() -> None:
    mild = Finding("ignored", "M8 is left out: it moves nothing", 3)
    assert finding_words(mild) == "line 3: M8 is left out: it moves nothing"
    long = Finding("suspicious", "the part is 4.0 x 2.0 mm across; if the program means inches, it is 101.6 x 50.8 mm")
    assert worst_first([mild, long])[0] is long
    said = finding_words(long)
    assert said == "the part is 4.0 x 2.0 mm across; if the program means inches …"
    assert len(said) <= 66
