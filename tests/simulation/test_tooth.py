"""Mean and tooth: springs under the force of each instant of a turn, summed tooth by tooth."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.springs.joint_bending import JointBending
from robomill.compliance.springs.spindle import SpindleSpring
from robomill.compliance.springs.tool_bending import ToolBending
from robomill.io.samples import samples_dir
from robomill.report.simulation_record import simulation_record
from robomill.simulation.tooth import tooth

STRAIGHT = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml")
SETUP = STRAIGHT.replace(cell=4e-4, step=5e-3, cutter=STRAIGHT.cutter.replace(helix_angle=0.0))
SPINDLE = SpindleSpring(0.05e-6, 0.02e-6)
BENDING = ToolBending(8e-3, 30e-3)


def turn_of_forces(setup) -> np.ndarray:
    """(q, 2) N along feed and to its left at instants of a turn: straight teeth in a full slot, one by one."""
    cutter, c = setup.cutter, 0.03 / (200.0 * setup.cutter.flutes)
    turn = np.linspace(0.0, 2 * np.pi, 14400, endpoint=False)
    F = np.zeros((len(turn), 2))
    for n in range(cutter.flutes):
        phi = (turn + 2 * np.pi * n / cutter.flutes) % (2 * np.pi)
        inside = phi < np.pi
        for term in setup.force.material.terms:
            h = np.where(inside, (c * np.maximum(np.sin(phi), 0.0)) ** term.exponent, 0.0) * 2e-3
            F[:, 0] += -h * (term.Kt * np.cos(phi) + term.Kr * np.sin(phi))
            F[:, 1] += h * (term.Kt * np.sin(phi) - term.Kr * np.cos(phi))
    return F


def test_the_wall_moves_with_each_tooth_by_the_light_springs_alone():
    run = rm.simulate(SETUP.replace(springs=(SPINDLE, BENDING, JointBending(2, 1e-8, 1e-8))))
    found, i = tooth(run), run.verdict.wall.worst
    F = turn_of_forces(run.setup)
    soft = SPINDLE.lateral + BENDING.lateral
    lowest, highest = F[:, 1].min() - F[:, 1].mean(), F[:, 1].max() - F[:, 1].mean()
    i = len(run.path) // 2
    mean = run.R_MF[i, :, 1] @ run.delta[i]
    assert found.mean[i, 1] == pytest.approx(mean)
    assert found.low[i, 1] - mean == pytest.approx(soft * lowest, rel=0.05)
    assert found.high[i, 1] - mean == pytest.approx(soft * highest, rel=0.05)


def test_without_a_light_spring_or_a_turn_there_is_nothing_to_say():
    assert tooth(rm.simulate(SETUP)) is None
    assert tooth(rm.simulate(SETUP.replace(springs=(JointBending(2, 1e-8, 1e-8),)))) is None
    stated = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(springs=(SPINDLE,), step=5e-3)
    assert tooth(rm.simulate(stated)) is None


def test_the_record_has_both_and_says_what_is_left_out():
    run = rm.simulate(SETUP.replace(springs=(SPINDLE,)))
    record = simulation_record(run)
    wall = record["tooth"]["wall"]
    assert wall["low"] < wall["mean"] < wall["high"]
    assert wall["mean"] == pytest.approx(1e3 * run.delta_in_cut[run.verdict.wall.worst, 1])
    assert len(record["left_out"]) == 3
    assert simulation_record(dataclasses.replace(run, setup=SETUP))["tooth"] is None
