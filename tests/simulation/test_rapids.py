"""Rapids through material: told where a drawing of block and cutter shows them in it, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.cutting.tool import Cutter
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.simulation.rapids import crashes
from robomill.surface.stock import Stock
from robomill.toolpath.path import Toolpath, toolpath_from_lines
from robomill.toolpath.source import GCodeSource

SETUP = load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(
    stock=Stock([-40e-3, -20e-3, -10e-3], [40e-3, 20e-3, 0.0]), cutter=Cutter("flat", 8e-3), cell=2e-4
)
SLOT = "G1 X-60 Y0 F600\nG1 Z-1\nG1 X60\n"  # lines 3 to 5: outside, down, through


def told(text):
    setup = SETUP.replace(source=GCodeSource(f"G21 G90\nG0 X-60 Y0 Z5\n{text}M2\n", "part.nc"))
    return crashes(setup, setup.source.read()).never


@pytest.mark.parametrize(
    ("way", "lines"),
    [
        ("G0 Z-1\nG0 X60\n", (4,)),  # through the middle
        ("G0 Z0.1\nG0 X60\n", ()),  # over it
        ("G0 Y24.5\nG0 Z-1\nG0 X60\n", ()),  # beside it, by more than the radius
        ("G0 Y23.5\nG0 Z-1\nG0 X60\n", (5,)),
        ("G0 Y-24.5\nG0 Z-1\nG0 X60\n", ()),
        ("G0 Y-23.5\nG0 Z-1\nG0 X60\n", (5,)),
        ("G0 X-44.5\nG0 Z-1\nG0 Y30\n", ()),
        ("G0 X-43.5\nG0 Z-1\nG0 Y30\n", (4, 5)),  # it comes down into the edge, and goes along it
        ("G0 X44.5\nG0 Z-1\nG0 Y30\n", ()),
        ("G0 X0\nG0 Z-1\nG0 Z5\n", (4, 5)),  # straight down, and up again: each alone would be in it
        ("G0 X-60 Z-1\nG0 X-50\nG0 X-60\n", ()),  # towards it, and back
    ],
)
def test_where_the_cutter_would_be_in_the_block(way, lines):
    assert told(way) == lines


@pytest.mark.parametrize(
    ("back", "found"),
    [
        ("G0 X-60\n", False),  # the way it was cut
        ("G0 Z-0.5\nG0 X-60\n", False),
        ("G0 Z-1.1\nG0 X-60\n", True),  # deeper
        ("G0 Y1\nG0 X-60\n", True),  # to the side
        ("G0 Z5\nG0 X0\nG0 Z-0.9\n", False),  # down into the slot
        ("G0 Z5\nG0 X0\nG0 Z-1.2\n", True),
        ("G0 Z5\nG0 X0 Y3\nG0 Z-0.9\n", True),
    ],
)
def test_what_was_cut_before_is_no_material(back, found):
    lines = told(SLOT + back)
    assert (len(lines) > 0) == found
    assert all(line > 5 for line in lines), "feed moves are meant to cut"


@pytest.mark.parametrize(
    ("text", "later"),
    [
        ("G0 X0 Y0\nG0 Z-1\nG1 X60 F600\n", (4,)),  # straight down where the cut begins
        ("G0 X-30 Y0\nG0 Z-1\nG0 X30\nG0 Z5\nG0 X-60\nG0 Z-1\nG1 X60 F600\n", (4, 5, 6)),
        ("G0 X-60 Z-1\nG1 X0 F600\nG0 X5\nG1 X60\nG1 X0\n", (5,)),  # 5 mm on, out of the slot
        ("G0 X-60 Z-1\nG1 X0 F600\nG0 X-5\nG1 X60\n", ()),  # back in the slot
        ("G0 X-60 Z-1\nG1 X60 F600\nG0 Z5\nG0 X-60\nG0 Z-2\nG1 X60\nG0 X-60\n", ()),  # in two depths, and back
        ("G0 X-60 Z-1\nG1 X60 F600\nG0 Z-2\nG0 X-60\nG1 X60\n", (6,)),  # back a pass too deep
    ],
)
def test_what_is_cut_only_later_is_material_until_then(text, later):
    setup = SETUP.replace(source=GCodeSource(f"G21 G90\nG0 X-60 Y0 Z5\n{text}M2\n", "part.nc"))
    found = crashes(setup, setup.source.read())
    assert (found.never, found.early, found.first) == ((), later, 0)


def test_what_is_cut_only_later_is_said_in_the_verdict():
    program = GCodeSource("G21 G90 S12000 M3\nG0 X-30 Y0 Z5\nG0 Z-1\nG1 X60 F600\nG0 Z5\nM2\n", "part.nc")
    run = rm.simulate(SETUP.replace(source=program))
    assert run.early_rapids == (3,)
    assert "(line 3)" in run.verdict.sentence
    assert [note.line for note in run.surface_notes if note.code == "rapid-before-cut"] == [3]


@pytest.mark.parametrize(
    ("first", "line"),
    [
        ("G0 X0 Y0 Z-1", 2),  # there is metal all round, wherever it came from
        ("G0 X0 Y0 Z0", 0),  # on it
        ("G0 X-44.5 Y0 Z-1", 0),  # beside it, by more than the radius
        ("G0 X-43.5 Y0 Z-1", 2),
        ("G1 X0 Y0 Z-1 F600", 0),  # a feed move is meant to cut
    ],
)
def test_where_the_first_rapid_ends_counts(first, line):
    setup = SETUP.replace(source=GCodeSource(f"G21 G90\n{first}\nG1 X60 F600\nM2\n", "part.nc"))
    found = crashes(setup, setup.source.read())
    assert found.first == line
    said = [(note.level, note.line) for note in found.notes() if note.code == "begins-in-material"]
    assert said == [("warning", line)] * (line > 0)


def test_a_table_of_lines_begins_with_a_cut():
    """The rapid back along the first line is in the slot that it cut."""
    lines = toolpath_from_lines(
        [[-60e-3, 0, -1e-3], [-60e-3, 0, -1e-3]], [[60e-3, 0, -1e-3], [-60e-3, 9e-3, -1e-3]], 0.01
    )
    assert crashes(SETUP, lines) == ((), (), 0)
    deeper = toolpath_from_lines(
        [[-60e-3, 0, -1e-3], [-60e-3, 0, -2e-3]], [[60e-3, 0, -1e-3], [-60e-3, 9e-3, -1e-3]], 0.01
    )
    assert crashes(SETUP, deeper).never == (2,)


@pytest.mark.parametrize(("lean", "lines"), [(0.0, ()), (0.2, ()), (0.6, (4,)), (-0.6, ())])
def test_a_leaning_tool_reaches_over_the_block_with_its_body(lean, lines):
    """Its tip goes by 4 mm beside the block's side, 5 mm under its top, and its body of 2 mm leans over the block."""
    axis = np.array([-np.sin(lean), 0.0, np.cos(lean)])
    p = np.array([[44e-3, -40e-3, 5e-3], [44e-3, -30e-3, -5e-3], [44e-3, 30e-3, -5e-3], [44e-3, 30e-3, 9e-3]])
    cutting = np.array([False, False, False, True])
    by = Toolpath(p, axis, np.zeros(4), cutting, np.array([1, 2, 4, 5]), np.zeros(4), np.zeros(4, dtype=int))
    slim = SETUP.replace(cutter=Cutter("flat", 4e-3))
    # At the height of the top a cylinder that leans is R / cos wide to either side.
    inward = 44e-3 - np.tan(lean) * 5e-3 - 2e-3 / np.cos(lean) - 40e-3
    assert (inward < 0.0) == bool(lines)
    assert crashes(slim, by).never == lines


def test_every_bad_line_is_named_once_and_in_order():
    assert told("G0 Z-1\nG0 X60\nG0 Y10\nG0 X-60 Z-2\nG0 Z5\nG0 Y0\nG0 X0\nG0 Z-3\n") == (4, 6, 10)


def test_however_many_bad_lines_are_found():
    """Sixty rapids through the block, back and forth, each deeper than the one before."""
    across = "".join(f"G0 X{(-1) ** n * -60} Z{-1 - 0.05 * n:.2f}\nG0 X{(-1) ** n * 60}\n" for n in range(60))
    lines = told(across)
    assert lines == tuple(range(4, 4 + 2 * 60, 2))
