"""Threads are not judged: the lines that lead a tap or a thread cutter are, and no other line."""

import pytest

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.toolpath.source import GCodeSource

SETUP = load_setup(samples_dir() / "pocket_arcs" / "setup.toml").replace(cell=5e-4)
BEFORE = "G21 G90 G17 S300 M3\nG0 X-20 Y10 Z5\nG1 Z-1 F300\nG1 X20\nG0 Z5\nG0 X0 Y-5\n"  # lines 1 to 6
AFTER = "\nG0 Z5\nG0 X-20 Y20\nG1 Z-1 F300\nG1 X20\nG0 Z5\nM2\n"


@pytest.mark.parametrize(
    "lines",
    [
        "G84 Z-6 R2 F300\nG80",
        "M4\nG74 Z-6 R2 F300\nG80\nM3",
        "G33 Z-6 K1\nG0 Z5",
        "G33.1 Z-6 K1",
        "G18 G7\nG76 P0.5 Z-6 I-1 J0.2 K0.8\nG17",
        "G84 Z-6 R2 F300\nX5\nX10\nG80",
    ],
)
def test_lines_that_cut_a_thread_are_not_judged_and_no_others(lines):
    run = rm.simulate(SETUP.replace(source=GCodeSource(BEFORE + lines + AFTER, "part.nc")))
    threads = [7 + i for i, line in enumerate(lines.split("\n")) if "Z-6" in line or line.startswith("X")]
    lost = run.not_judged
    assert sorted(set(run.path.block[lost].tolist())) == threads
    assert not (run.path.thread & ~run.path.cutting).any(), "a rapid cuts no thread"
    assert "thread" in {each.code for each in run.unjudged}
    assert run.verdict.level in ("unjudged", "out")
    rest = run.path.cutting & ~lost & run.conditions.engaged
    assert {3, 4} < set(run.path.block[rest].tolist())
    assert len(set(run.path.block[rest].tolist())) == 4


def test_a_straight_line_after_a_thread_is_a_cut():
    """The mode of a thread lasts until the next word of motion."""
    text = "G21 G90 G17 S12000 M3\nG0 X0 Y0 Z5\nG33 Z-2 K0.1\nG1 X20 F600\nG0 Z5\nM2\n"
    path = GCodeSource(text, "part.nc").read()
    assert sorted(set(path.block[path.thread].tolist())) == [3]


def test_a_stated_force_is_not_that_of_a_tap():
    stated = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    run = rm.simulate(stated.replace(source=GCodeSource(BEFORE + "G84 Z-6 R2 F300\nG80" + AFTER, "part.nc")))
    assert "thread" in {each.code for each in run.unjudged}
