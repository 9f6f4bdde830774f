"""Set-ups whose programs are corrected, and where their tools really go."""

import numpy as np

import robomill as rm
from robomill.improve.compensation import Compensation
from robomill.io.samples import samples_dir

SLOT = samples_dir() / "paper_flute"
DRILL = "G21 G90\nS6000 M3\nG0 X10 Y10 Z5\nG1 Z-4 F200\nG0 Z5\nG0 X-10 Y5\nG1 Z-4\nG0 Z5\nM2\n"


def silent(text: str) -> str:
    """The program without what it says of itself."""
    return "".join(line for line in text.splitlines(keepends=True) if "robomill" not in line)


def tip_of(setup: rm.SimulationSetup, text: str) -> tuple[np.ndarray, rm.SimulationResult]:
    """(m, 3) m in {W}: where the tool really goes with a program that is simulated as it stands, and says nothing of
    what it was made of."""
    run = rm.simulate(setup.replace(source=rm.GCodeSource(silent(text), "corrected.nc")))
    assert run.ahead is None
    return np.asarray(run.path.p + run.delta @ setup.T_MW[:3, :3]), run


def beside_slot(found: Compensation, setup: rm.SimulationSetup | None = None) -> np.ndarray:
    """(k, 2) m: how far the tip is off the slot's line (Y 0, Z -2 mm) while it cuts, by an ordinary run of the text."""
    tip, run = tip_of(found.setup if setup is None else setup, found.text)
    return np.abs(tip[run.path.cutting] - [0.0, 0.0, -2e-3])[:, 1:]


def own(text: str) -> rm.SimulationSetup:
    block = rm.Stock(lower_mm=(-40, -40, -15), upper_mm=(40, 40, 0))
    return rm.load_setup("pocket_arcs").replace(source=rm.GCodeSource(text, "own.nc"), stock=block)
