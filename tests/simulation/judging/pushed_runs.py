"""Runs of short programs in one block, and the same with another deviation."""

from __future__ import annotations

import dataclasses

import numpy as np

import robomill as rm
from robomill.cutting.forces.along_path import PathForce
from robomill.io.samples import samples_dir
from robomill.surface.stock import Stock
from robomill.toolpath.source import GCodeSource

R = 4e-3
BLOCK = Stock([-30e-3, -20e-3, -10e-3], [30e-3, 20e-3, 0.0])
SETUP = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(
    cell=5e-4, step=1e-3, stock=BLOCK, force=PathForce(feed_normal=10.0)
)
PARTS = {
    "slot": ["G0 X-40 Y0 Z5", "G0 Z-2", "G1 X20 F1800"],
    "shoulder": ["G0 X-40 Y-18 Z5", "G0 Z-2", "G1 X40 F1800"],
    "rough and finish": ["G0 X-40 Y-1 Z5", "G0 Z-2", "G1 X40 F1800", "G0 Z5", "G0 X-40 Y0", "G0 Z-2", "G1 X40 F1800"],
    "spring pass": ["G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F1800", "G1 X-40"],
    "arc": ["G0 X-20 Y-10 Z5", "G0 Z-2", "G1 X0 F1800", "G3 X0 Y10 J10", "G1 X-20"],
    "crossing": ["G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F1800", "G0 Z5", "G0 X0 Y-30", "G0 Z-2", "G1 Y30"],
    "rib": ["G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F1800", "G0 Z5", "G0 Y9.2", "G0 Z-2", "G1 X-40"],
}


def run(*lines: str, **changes):
    text = "\n".join(["G21 G90 S12000 M3", *lines, "M2", ""])
    return rm.simulate(SETUP.replace(source=GCodeSource(text), **changes))


def pushed(result, along=0.0, left=0.0, up=0.0):
    """The run with another deviation (m), given in the axes of the cut: numbers, or one a sample."""
    m = len(result.path)
    d = np.stack([np.broadcast_to(v, (m,)) for v in (along, left, up)], axis=1)
    d = np.where(result.path.cutting[:, None], d, 0.0)
    return dataclasses.replace(result, delta=np.einsum("mij,mj->mi", result.R_MF, d))
