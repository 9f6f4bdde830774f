"""Coupled runs: shoulder cuts against root finding with a force integrated tooth by tooth; ramps; what is said."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.simulation.coupling import TOLERANCE, Coupling, Settled
from robomill.simulation.run import simulate
from robomill.surface.stock import Stock
from robomill.toolpath.source import GCodeSource

R, FEED, SPEED = 4e-3, 0.03, 200.0
BLOCK = Stock([-20e-3, 0.0, -10e-3], [20e-3, 30e-3, 0.0])
SETUP = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(stock=BLOCK, coupling=True)


def shoulder_force(setup, a_e: float, a_p: float, left: bool) -> np.ndarray:
    """Mean force on the tool (feed, left, axial) of a shoulder, by adding up teeth over a turn; the material's own
    coefficients, a flat mill whose right-hand helix pulls it towards the part."""
    cutter = setup.cutter
    width = float(np.clip(a_e, 0.0, 2 * R))
    arc = np.arccos(1.0 - width / R)
    low, high = (0.0, arc) if left else (np.pi - arc, np.pi)
    n = 4000
    phi = low + (np.arange(n) + 0.5) * (high - low) / n
    c = FEED / (SPEED * cutter.flutes)
    F = np.zeros(3)
    for term in setup.force.material.terms:
        h = (c * np.sin(phi)) ** term.exponent
        tangential, radial, axial = term.Kt * h, term.Kr * h, term.Ka * h
        F[0] += (-tangential * np.cos(phi) - radial * np.sin(phi)).mean()
        F[1] += (tangential * np.sin(phi) - radial * np.cos(phi)).mean()
        F[2] += -axial.mean()
    return F * max(a_p, 0.0) * cutter.flutes * (high - low) / (2 * np.pi)


def shoulder(a_e: float, left: bool, a_p: float = 2e-3):
    """A pass along the block's edge, with the material to the left (conventional) or right (climb) of the feed."""
    y = 1e3 * (a_e - R)
    ends = (-30, 30) if left else (30, -30)
    text = f"G21 G90 S12000 M3\nG0 X{ends[0]} Y{y:.6f} Z5\nG0 Z-{1e3 * a_p:g}\nG1 X{ends[1]} F1800\nG0 Z5\nM2\n"
    return simulate(SETUP.replace(source=GCodeSource(text)))


@pytest.mark.parametrize("left", [True, False], ids=["conventional", "climb"])
@pytest.mark.parametrize("a_e", [0.4e-3, 2e-3, 5e-3, 6.5e-3])
def test_shoulders_agree_with_root_finding(a_e, left):
    run = shoulder(a_e, left)
    assert run.coupling.converged
    for at in (-10e-3, 0.0, 10e-3):
        i = int(np.argmin(np.abs(run.path.p[:, 0] - at) + 1.0 * ~run.path.cutting))
        C, axes = run.C[i], run.R_MF[i]

        def remains(d, C=C, axes=axes):
            into = d[1] if left else -d[1]
            F = shoulder_force(run.setup, a_e + into, 2e-3 - d[2], left)
            return axes.T @ (C @ (axes @ F)) - d

        truth, _, found, _ = fsolve(remains, np.zeros(3), full_output=True, xtol=1e-12)
        if found != 1 or np.abs(remains(truth)).max() > 1e-9:  # from another start, where it does not close in
            truth, _, found, _ = fsolve(remains, run.delta_in_cut[i], full_output=True, xtol=1e-12)
        assert np.abs(remains(truth)).max() < 1e-9
        np.testing.assert_allclose(run.delta_in_cut[i], truth, atol=1e-6)


def test_a_climb_cut_pushed_off_its_wall_becomes_narrower():
    """Climb, 5 mm wide and 2 mm deep, with Table 3 of the paper: 245 um uncoupled. The tool goes left,
    away from the metal on its right, and up: 228 um. (252 um is the root where the width grows instead.)"""
    C_theta = np.array([9.03, 11.17, 14.74, 27.65, 97.58]) * 1e-7
    run = shoulder(5e-3, False)
    run = simulate(run.setup.replace(robot=run.setup.robot.replace(C_theta=C_theta)))
    i = int(np.argmin(np.abs(run.path.p[:, 0]) + 1.0 * ~run.path.cutting))
    C, axes = run.C[i], run.R_MF[i]

    def left(width: float, rises: float) -> float:
        def remains(d):
            F = shoulder_force(run.setup, 5e-3 + width * d[1], 2e-3 - rises * d[2], False)
            return axes.T @ (C @ (axes @ F)) - d

        return float(fsolve(remains, np.zeros(3), xtol=1e-12)[1])

    assert left(0.0, 0.0) == pytest.approx(245e-6, abs=0.5e-6)
    assert left(+1.0, 0.0) == pytest.approx(252.5e-6, abs=0.5e-6)
    assert run.delta_in_cut[i, 1] == pytest.approx(left(-1.0, 1.0), abs=1e-6)
    assert run.delta_in_cut[i, 1] == pytest.approx(228e-6, abs=0.5e-6)


def test_coupling_matters_and_says_how_much():
    run, plain = shoulder(5e-3, False), simulate(shoulder(5e-3, False).setup.replace(coupling=False))
    assert run.coupling.difference == pytest.approx(float(np.nanmax(np.abs(run.delta - plain.delta))), abs=1e-9)
    assert run.coupling.difference > 3e-6
    assert [note.level for note in run.notes if note.code == "coupling"] == ["info"]


def test_a_later_pass_meets_what_a_deflected_one_has_left():
    """The same shoulder cut twice: where the first pass was pushed out of the material, the second finds the rest, and
    its own deflection is the root of the smaller cut."""
    a_e, y = 2e-3, 1e3 * (2e-3 - R)
    cut = f"G0 X-30 Y{y:.6f}\nG0 Z-2\nG1 X30 F1800\nG0 Z5\n"
    run = simulate(SETUP.replace(source=GCodeSource(f"G21 G90 S12000 M3\n{cut}{cut}M2\n")))
    assert run.coupling.converged
    first, second = (
        int(np.argmin(np.abs(run.path.p[:, 0]) + 1.0 * ~(run.path.cutting & (run.path.block == block))))
        for block in (4, 8)
    )
    gone = run.delta_in_cut[first]
    C, axes = run.C[second], run.R_MF[second]
    assert gone[1] > 0.0  # into the material, deeper than told: the second pass meets a floor only where it is deeper

    def remains(push):
        d = axes.T @ (C @ (axes @ shoulder_force(run.setup, max(push - gone[1], 0.0), 2e-3, True)))
        return d[1] - push

    assert remains(0.0) <= 0.0 or brentq(remains, 0.0, 1e-3) < gone[1]
    assert np.linalg.norm(run.F[second]) < 0.2 * np.linalg.norm(run.F[first])
    assert a_e > 0


def test_the_pocket_sample_is_solved_at_every_step():
    setup = rm.load_setup(samples_dir() / "pocket_arcs")
    run = simulate(setup.replace(coupling=True, step=2e-3))
    assert run.coupling.converged
    assert not run.not_judged.any()
    bent = np.einsum("mij,mj->mi", run.C, run.F)
    np.testing.assert_allclose(run.delta[run.judged], bent[run.judged], atol=1e-12)


def test_evaluations_are_counted_over_all_steps():
    def took(evaluations, rest=0.0):
        return Settled(np.zeros(3), rest, evaluations, 1.0, ())

    assert (Coupling((), (), 0.0).iterations, Coupling((), (), 0.0).mean_iterations) == (0, 0.0)
    some = Coupling((took(3), took(8), took(4)), (), 0.0)
    assert (some.iterations, some.mean_iterations, some.converged) == (8, 5.0, True)
    assert not Coupling((took(3), took(40, 1e-6)), (7,), 0.0).converged
    assert [took(1, rest).agreed for rest in (0.0, TOLERANCE, 1.001 * TOLERANCE, np.nan)] == [True, True, False, False]


def test_what_is_said_of_steps_that_do_not_agree_is_the_worst_of_them():
    """Not of those that agree, though they took more and rest on a steeper force."""
    some = (
        Settled(np.zeros(3), 0.5 * TOLERANCE, 37, 9.9, ()),
        Settled(np.zeros(3), 2.5e-6, 21, 1.4, ()),
        Settled(np.zeros(3), 7.5e-6, 22, 1.6, ()),
        Settled(np.zeros(3), 4.5e-6, 23, 1.8, ()),
    )
    found = Coupling(some, (4, 9), 0.0).finding
    assert (found.level, found.code) == ("warning", "coupling")
    for words in ("on line 4", "9", "7.5", "after 22 ", "1.6 times"):
        assert words in found.message
    for share, level, words in (
        (0.0, "info", "no step"),
        (0.5, "info", "that is judged"),
        (1.0, "info", "every step ("),
    ):
        found = Coupling(some[:1], (), 3.4e-6, share).finding
        assert (found.level, words in found.message) == (level, True)
        assert ("37.0 evaluations a step, at most 37" in found.message) == (share > 0.0)
        assert ("3.4" in found.message) == (share > 0.0)


@pytest.mark.parametrize(("D", "flutes", "angle"), [(6, 2, 1), (8, 3, 3), (10, 4, 2), (12, 3, 5)])
def test_a_ramp_into_the_full_is_solved_at_every_step(D, flutes, angle):
    """The end touches, presses and rests on what it has cut: each step has an answer, which bends the tool to it."""
    length = min(2.0 / np.tan(np.radians(angle)), 60.0)
    deep = 0.3 - length * np.tan(np.radians(angle))
    cutter = rm.Cutter("flat", diameter_mm=D, flutes=flutes)
    way = f"G0 X{-length / 2} Y0 Z5\nG0 Z0.3\nG1 X{length / 2} Z{deep} F{240 * flutes}\nG1 X{-length / 2}\nG0 Z20\n"
    run = simulate(
        SETUP.replace(
            source=GCodeSource(f"G21 G90\nS8000 M3\n{way}M2\n"),
            cutter=cutter,
            force=rm.process_force("al7075_t6_carbide_ref190", cutter),
            stock=Stock([-60e-3, -30e-3, -15e-3], [60e-3, 30e-3, 0.0]),
        )
    )
    assert run.coupling.converged
    bent = np.einsum("mij,mj->mi", run.C, run.F)
    np.testing.assert_allclose(run.delta[run.judged], bent[run.judged], atol=1e-12)
    assert run.verdict.level in ("ok", "tight", "out")


@pytest.mark.parametrize(("D", "flutes", "step"), [(8, 3, 2e-3), (6, 2, 1e-3), (12, 4, 2e-3)])
def test_a_ramp_that_is_sent_again_is_solved_at_every_step(D, flutes, step):
    """At its foot the end meets two floors at once, of the ramp and of the level cut: more than two forces hold it."""
    cutter = rm.Cutter("flat", diameter_mm=D, flutes=flutes)
    once = "G1 X10 Z-1.5\nG1 X25\nG0 Z5\nG0 X-20\nG0 Z0\n"
    text = f"G21 G90\nS12000 M3\nG0 X-20 Y0 Z5\nG0 Z0\nF{480 * flutes}\n{once}{once}G0 Z20\nM2\n"
    run = simulate(
        SETUP.replace(
            source=GCodeSource(text),
            cutter=cutter,
            force=rm.process_force("al7075_t6_carbide_ref190", cutter),
            stock=Stock([-60e-3, -30e-3, -15e-3], [60e-3, 30e-3, 0.0]),
            step=step,
            part_zero_mm=(0, -1300, 0),
        )
    )
    assert run.coupling.converged
    for each in (one for one in run.coupling.settled if len(one.mix) > 2):
        assert sum(weight for _, weight in each.mix) == pytest.approx(1.0)
        assert max(np.abs(place - each.x).max() for place, _ in each.mix) <= TOLERANCE * (1 + 1e-9)
        assert np.abs(run.delta - each.x).max(axis=1).min() <= 2 * TOLERANCE, "and that is where C F leads"


@pytest.mark.parametrize(("gain", "words"), [(0.0, "its force jumps"), (2.34, "changes 2.3 times as fast")])
def test_what_does_not_agree_says_whether_the_force_jumps_or_is_too_steep(gain: float, words: str) -> None:
    open_ = Settled(np.zeros(3), 0.9e-6, 171, gain, ((np.zeros(3), 1.0),))
    found = Coupling((open_,), (7,), 0.0)
    assert words in found.finding.message
    assert "0.9 µm remain after 171 evaluations" in found.finding.message


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 2, 1, 0), (1, 3, 0, 2)])
def test_what_is_told_of_steps_that_do_not_agree_is_that_of_the_worst(order):
    """Whatever stands beside it: steps that agree, that are nearer, and that have no number at all."""
    worst = Settled(np.zeros(3), 30e-6, 40, 2.5, ())
    others = [Settled(np.zeros(3), rest, 7, 9.0, ()) for rest in (np.nan, 0.0, 2.0 * TOLERANCE)]
    told = [*others, worst]
    alone = Coupling((worst,), (3,), 0.0).why
    assert Coupling(tuple(told[n] for n in order), (3,), 0.0).why == alone
    assert "after 40 evaluations" in alone
    assert "2.5 times as fast" in alone
