"""Speed of corrected programs, and how it grows with their lines, beside the simulation of the same set-ups in one run.

Run with ``pytest -m benchmark -s tests/benchmarks/test_compensation.py``.
"""

import numpy as np
import pytest

import robomill as rm
from tests.benchmarks.clock import fastest

pytestmark = pytest.mark.benchmark

LIMITS = {"paper_flute": 0.5, "samples/paper_flute/setup_process.toml": 0.5, "pocket_arcs": 2.0}  # s
SIMULATIONS = 25.0  # runs with their verdicts, at most, that a correction takes as long as
LINES, SECONDS, GROWTH = 100_000, 60.0, 14.0


def zigzag(lines: int) -> rm.SimulationSetup:
    """A floor finished in lines of 40 um, beside each other by 0.8 mm."""
    x = np.linspace(-40.0, 40.0, 2001)
    row, k = np.divmod(np.arange(lines), 2000)
    along = np.where(row % 2 == 0, x[k + 1], x[1999 - k])
    aside = -20.0 + 0.8 * row + 0.3 * np.sin(along / 7.0)
    text = ["G21 G90", "S12000 M3", "G0 X-40 Y-20 Z5", "G0 Z-1", "G1 F1800"]
    text += [f"X{a:.3f} Y{b:.4f}" for a, b in zip(along, aside, strict=True)]
    source = rm.GCodeSource("\n".join([*text, "G0 Z20", "M2"]) + "\n", "zigzag.nc")
    stock = rm.Stock(lower_mm=[-60, -40, -10], upper_mm=[60, 60, 0])
    return rm.load_setup("paper_flute").replace(source=source, stock=stock)


def other(setup: rm.SimulationSetup) -> rm.SimulationSetup:
    """The same set-up, of which nothing is kept yet."""
    return setup.replace(tolerance_mm=float(np.random.default_rng().uniform(0.3, 0.4)))


@pytest.mark.parametrize("name", LIMITS)
def test_samples_are_corrected_in_a_few_simulations(name):
    setup = rm.load_setup(name)
    rm.compensate(setup)
    ours = fastest(lambda: rm.compensate(other(setup)), 3)
    theirs = fastest(lambda: rm.simulate(other(setup)).verdict, 3)
    print(
        f"\n{setup.name}: corrected in {ours:.3f} s, simulated and judged in {theirs:.3f} s, ratio {ours / theirs:.1f}"
    )
    assert ours < LIMITS[name]
    assert ours < SIMULATIONS * theirs


def test_long_programs_grow_with_their_lines():
    tenth, whole = zigzag(LINES // 10), zigzag(LINES)
    rm.compensate(zigzag(1000))
    short = fastest(lambda: rm.compensate(other(tenth)), 2)
    long = fastest(lambda: rm.compensate(other(whole)), 1)
    theirs = fastest(lambda: rm.simulate(other(whole)).verdict, 1)
    print(f"\n{LINES // 10} lines in {short:.1f} s, {LINES} in {long:.1f} s, simulated and judged in {theirs:.1f} s")
    assert long < SECONDS
    assert long < GROWTH * short
    assert long < theirs
