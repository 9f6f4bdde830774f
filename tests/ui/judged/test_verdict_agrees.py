"""Every place that speaks of tolerance agrees: sentence, tiles, bar, shares of walls and floors, record, lines."""

from __future__ import annotations

import re

import numpy as np
import pytest

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.report.plain import simulation_lines
from robomill.report.simulation_record import simulation_record
from robomill.simulation.judging.verdict_words import KINDS, WORDS as JUDGED
from robomill.simulation.result import SimulationResult
from robomill.toolpath.source import GCodeSource
from robomill.ui.judged import verdict
from robomill.ui.milling.metrology import share_out_words
from robomill.units import format_share

SAMPLES = ("paper_flute/setup", "paper_flute/setup_process", "pocket_arcs/setup", "two_tools/setup")
FLUTE = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(cell=4e-4)
PROCESS = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(cell=4e-4)


def heart() -> list[str]:
    """A heart-shaped pocket in rings from the middle outwards, 36 mm wide."""
    t, lines = np.linspace(0.0, 2.0 * np.pi, 60), ["G0 X0 Y0 Z5", "G1 Z-1.5 F300"]
    for size in (0.25, 0.5, 0.75, 1.0):
        x = size * 16.0 * np.sin(t) ** 3
        y = size * (13.0 * np.cos(t) - 5.0 * np.cos(2 * t) - 2.0 * np.cos(3 * t) - np.cos(4 * t))
        lines += [f"G1 X{a:.3f} Y{b:.3f} F1800" for a, b in zip(x, y, strict=True)]
    return lines


def rows(ys: list[float], z: float, x: float = 40.0) -> list[str]:
    """Passes along x."""
    lines = []
    for n, y in enumerate(ys):
        a, b = (-x, x) if n % 2 == 0 else (x, -x)
        lines += [f"G0 X{a} Y{y} Z5", f"G1 Z{z} F300", f"G1 X{b} F1800", "G0 Z5"]
    return lines


PROGRAMS = {
    "slot": rows([0.0], -2.0, 60.0),
    "there and back": [*rows([0.0], -2.0), "G1 Z-2 F300", "G1 X-40 F1800"],
    "heart": heart(),
    "rows of a pocket": rows([-10.0, -5.0, 0.0, 5.0, 10.0], -2.0),
    "face": rows([-20.0, -14.0, -8.0, -2.0, 4.0, 10.0, 16.0, 20.0], -0.5, 60.0),
    "holes": ["G81 X-20 Y0 Z-4 R2 F300", "X0", "X20", "G80"],
    "circle": ["G0 X15 Y0 Z5", "G1 Z-1 F300", "G3 X15 Y0 I-15 J0 F1800"],
    "square": ["G0 X-15 Y-15 Z5", "G1 Z-2 F300", "G1 X15 F1800", "G1 Y15", "G1 X-15", "G1 Y-15"],
    "edge of the stock": rows([20.0], -2.0, 60.0),
    "ramp": ["G0 X-40 Y0 Z1", "G1 X40 Z-3 F900", "G1 X-40 F1800"],
    "rough and finish": rows([0.0, 1.0, -1.0], -2.0),
    "through": rows([0.0], -11.0),
}


def run_of(name: str, tolerance: float) -> SimulationResult:
    base = PROCESS if name == "heart" else FLUTE
    source = GCodeSource("\n".join(["G21 G90 S12000 M3", *PROGRAMS[name], "M2", ""]))
    return rm.simulate(base.replace(source=source, tolerance=tolerance, floor_tolerance=None))


@pytest.mark.parametrize("tolerance", [0.3e-3, 0.12e-3])
@pytest.mark.parametrize("name", PROGRAMS)
def test_a_program_is_judged_once(name: str, tolerance: float) -> None:
    agrees(run_of(name, tolerance))


@pytest.mark.parametrize("name", SAMPLES)
def test_a_sample_is_judged_once(name: str) -> None:
    agrees(rm.simulate(rm.load_setup(samples_dir() / f"{name}.toml")))


def agrees(run: SimulationResult) -> None:
    found, record = run.verdict, simulation_record(run)
    lines = "\n".join(simulation_lines(record))
    assert (record["verdict"], record["verdict_sentence"]) == (found.level, found.sentence)
    assert found.sentence in lines
    out = [
        reading for reading in (found.wall, found.floor, found.feed, found.end) if reading.decides and reading.share > 1
    ]
    measured = any(reading.decides for reading in (found.wall, found.floor, found.end))
    if found.level in JUDGED and measured:
        assert (found.level == "out") == bool(out or found.gone)
        assert [words for words in JUDGED.values() if f": {words} (" in found.sentence] == [JUDGED[found.level]]
        assert f"({format_share(found.share)} of it used" in found.sentence
        assert verdict.share_words(found).startswith(format_share(found.share))
        assert (found.share > 1.0) == bool(out)
        assert found.deciding is not None
        assert found.deciding[1].share == found.share
    for name in ("wall", "floor"):
        reading = getattr(found, name)
        assert (record[name]["length_out_of_tolerance_share"] > 0.0) == (reading.share > 1.0)
        assert (share_out_words(reading.share_out) == "none") == (not reading.share > 1.0)
        told = verdict.reading_tile(KINDS[name], found, None, "mm")
        if reading.worst >= 0:
            assert format_share(reading.share) in told.note
            assert re.search(rf"^{name} .*{re.escape(format_share(reading.share))}", lines, re.MULTILINE)
        else:
            assert told.value == "–"
    share = record["surface"]["area_out_of_tolerance_share"]
    assert (share > 0.0) == any(reading.share > 1.0 for reading in (found.wall, found.floor))
    if run.stray is not None:
        assert run.stray.words in lines
        assert not run.stray.left > max(abs(each.value) for each in (found.wall, found.floor, found.end)) + 1e-9 or (
            np.isnan([found.wall.value, found.floor.value, found.end.value]).any()
        )
