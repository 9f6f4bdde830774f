"""Coupled ways down against the differential equation that they solve, by forces and an integration of their own.

A stiff path and an arm that is pushed up: the tip stands where its force holds it, and its force is that of the chips
which it cuts by sinking. So how fast it sinks follows from where it stands, and where it will stand from that.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.simulation.marching import WayDown
from robomill.surface.stock import Stock
from robomill.toolpath.source import GCodeSource

FLUTES, R, SPEED = 3, 4e-3, 200.0
DISH, PRESSED = np.tan(np.radians([0.5, 0.05]))  # assumed, as the app says: how hollow an end is, what it does not feel
BEGINS = -12e-3  # m: where the ramps do
BLOCK = Stock([-30e-3, -20e-3, -12e-3], [30e-3, 20e-3, 0.0])
MILL = rm.Cutter("flat", diameter_mm=2e3 * R, flutes=FLUTES)
MATERIAL = "al7075_t6_carbide_ref190"
TERMS = rm.load_material(MATERIAL).terms


def coupled(text: str, step: float, cutter: rm.Cutter = MILL) -> rm.SimulationResult:
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml")
    return rm.simulate(
        setup.replace(
            source=GCodeSource(f"G21 G90\nS12000 M3\n{text}G0 Z20\nM2\n"),
            cutter=cutter,
            force=rm.process_force(MATERIAL, cutter),
            stock=BLOCK,
            step=step,
            coupling=True,
            part_zero_mm=(0, -1300, 0),
        )
    )


def ramp(slope: float, step: float, length: float = 16e-3) -> rm.SimulationResult:
    """From the top of the block down, out of a rapid."""
    x, to = 1e3 * BEGINS, 1e3 * (BEGINS + length)
    return coupled(f"G0 X{x} Y0 Z5\nG0 Z0\nG1 X{to} Z{-1e3 * slope * length:.6f} F1800\n", step)


@cache
def flank() -> np.ndarray:
    """Force (3,) N for each metre of depth of a slot, for a chip of the whole feed, by angles of the turn."""
    p, F = (np.arange(2000) + 0.5) * np.pi / 2000, np.zeros(3)
    for term in TERMS:
        h = (30e-3 / (SPEED * FLUTES) * np.sin(p)) ** term.exponent
        t, r, a = term.Kt * h, term.Kr * h, term.Ka * h
        F += np.array([-t * np.cos(p) - r * np.sin(p), t * np.sin(p) - r * np.cos(p), -a]).mean(axis=1)
    return F * FLUTES / 2.0


@cache
def end(falls: float) -> np.ndarray:
    """Force (3,) N of the end of a mill that falls by so much for each metre that it goes: by places of the end. One
    cuts where its rim, when it passed there, has left more than the end is ground hollow there."""
    phi, r = np.meshgrid((np.arange(360) + 0.5) * np.pi / 180, (np.arange(100) + 0.5) * R / 100, indexing="ij")
    ahead = np.sqrt(R * R - (r * np.cos(phi)) ** 2) - r * np.sin(phi)
    felt = (falls - PRESSED) * DISH / (DISH - PRESSED)
    cuts = np.where(ahead * felt > (R - r) * DISH, 1.0, 0.0)
    F = np.zeros(3)
    for term in TERMS:
        h = (30e-3 / (SPEED * FLUTES) * falls) ** term.exponent
        t, a = term.Kt * h, term.Ka * h
        each = np.array([-t * np.cos(phi) - a * np.sin(phi), t * np.sin(phi) - a * np.cos(phi), 0 * phi + term.Kr * h])
        F += (each * cuts).mean(axis=(1, 2))
    return F * FLUTES * R


def sunk(C: np.ndarray, slope: float, length: float, n: int = 160) -> tuple[np.ndarray, np.ndarray]:
    """Places (n,) m along a ramp and deflections (n, 3) m there, by the method of Heun."""
    falls = 2.0 * slope * np.linspace(0.0, 1.0, 161)[1:] ** 2
    forces = np.array([end(float(each)) for each in falls])

    def pushed(fall: float, depth: float) -> np.ndarray:
        level = max(depth, 0.0) * flank()
        return C @ (level + [np.interp(fall, np.append(0.0, falls), np.append(0.0, forces[:, i])) for i in range(3)])

    def rate(x: float, z: float) -> float:
        off = z + slope * x
        if pushed(1e-12, -z)[2] >= off:
            return 0.0
        return brentq(lambda fall: pushed(fall, -z)[2] - off, 1e-12, 2.0 * slope, xtol=1e-12)

    x, z, found = np.linspace(0.0, length, n), 0.0, []
    for a, b in zip(x, np.append(x[1:], length), strict=True):
        first = rate(a, z)
        found.append(pushed(first, -z))
        z -= 0.5 * (first + rate(b, z - first * (b - a))) * (b - a)
    return x, np.array(found)


@pytest.mark.parametrize("step", [2e-3, 0.5e-3])
@pytest.mark.parametrize("slope", [0.02, 0.05, 0.09])
def test_a_ramp_sinks_as_its_force_grows(slope: float, step: float) -> None:
    """Within 2 % of the steady deflection and what the tip sinks by in half a step."""
    run = ramp(slope, step)
    on = np.flatnonzero(run.path.cutting & (np.diff(run.path.p[:, 0], prepend=0.0) > 0.0))
    middle = on[len(on) // 2]
    axes = run.R_MF[middle]
    x, delta = sunk(axes.T @ run.C[middle] @ axes, slope, 16e-3)
    for i in on:
        truth = [np.interp(run.path.p[i, 0] - BEGINS, x, delta[:, n]) for n in range(3)]
        size = 0.02 * np.abs(delta).max() + 0.05 * slope * step
        np.testing.assert_allclose(run.delta_in_cut[i], truth, atol=size)
    assert run.coupling.converged


def test_where_a_ramp_is_does_not_depend_on_the_step() -> None:
    """Of 0.8 mm that are reached, a long step misses a little where the force ends to grow. (Chips that were as thick
    as told at once held the tip at one height, from which it sank by what rounding left at every step: 0.2 mm apart.)
    """
    runs, x = [ramp(0.0875, step) for step in (2e-3, 1e-3, 0.25e-3)], BEGINS + np.arange(2e-3, 15e-3, 2e-3)
    at = [np.interp(x, run.path.p[2:, 0], run.delta_in_cut[2:, 2]) for run in runs]
    np.testing.assert_allclose(at[0], at[2], atol=40e-6)
    np.testing.assert_allclose(at[1], at[2], atol=10e-6)


def test_an_end_that_sinks_by_nanometres_a_step_meets_its_floor() -> None:
    """Steps of 0.02 mm, on which the tip sinks by some 20 nm. (Looked at a micrometre back along the way that was told,
    it met its floor from 87 nm on: held between nothing and too much, it stood 8 to 20 um aside.)"""
    run = ramp(0.0875, 0.02e-3, 0.6e-3)
    on = np.flatnonzero(run.path.cutting)[2:]
    axes = run.R_MF[on[0]]
    x, delta = sunk(axes.T @ run.C[on[0]] @ axes, 0.0875, 0.6e-3)
    truth = np.stack([np.interp(run.path.p[on, 0] - BEGINS, x, delta[:, n]) for n in range(3)], axis=1)
    np.testing.assert_allclose(run.delta_in_cut[on], truth, atol=1e-6)
    assert run.coupling.converged
    assert run.coupling.mean_iterations < 120


@pytest.mark.parametrize("step", [1e-3, 0.25e-3])
@pytest.mark.parametrize("drills", [False, True], ids=["mill", "drill"])
def test_a_plunge_sinks_as_its_thrust_grows(drills: bool, step: float) -> None:
    """Straight down: what is cut of the whole end is as thick as it sinks. A drill's lips lean by half its point."""
    half, flutes = (np.radians(59.0), 2) if drills else (0.5 * np.pi, FLUTES)
    cutter = rm.Cutter("drill", diameter_mm=8, flutes=2, tip_angle_deg=118) if drills else MILL
    run = coupled("G0 X0 Y0 Z5\nG0 Z0\nG1 Z-6 F600\n", step, cutter)
    on = np.flatnonzero(run.path.cutting)
    C_zz = run.C[on[-1], 2, 2]
    chip = 10e-3 / (SPEED * flutes) * np.sin(half)

    def thrust(share: float) -> float:
        """Each edge R long; on a lip half the tangential force pushes along the normal (a handbook's thrust)."""
        normal = [(chip * share) ** term.exponent * (0.5 * term.Kt if drills else term.Kr) for term in TERMS]
        return flutes * R * sum(normal)

    point = R / np.tan(half) if drills else 1e-9  # m: until it is in, a drill cuts with a part of its lips
    z, down = 0.0, np.linspace(0.0, 6e-3, 801)
    found = np.zeros(len(down))
    for n, told in enumerate(down):
        off, lips = z + told, np.clip(-z / point, 1e-9 if drills else 1.0, 1.0)
        found[n] = off
        if lips * C_zz * thrust(1e-9) < off:
            most = 1.0 + off / (down[1] - down[0])  # as fast as to where nothing pushes
            over = lips * C_zz * thrust(most) - off
            share = (
                most if over < 0.0 else brentq(lambda q, off=off, lips=lips: lips * C_zz * thrust(q) - off, 0.0, most)
            )
            z -= share * (down[1] - down[0])
    truth = np.interp(-run.path.p[on, 2], down, found)
    at = run.delta_in_cut[on, 2]
    np.testing.assert_allclose(at[1:], truth[1:], atol=0.03 * found.max() + 0.04 * step)


@pytest.mark.parametrize("seed", range(8))
def test_a_way_down_goes_aside_as_it_is_told_and_sinks_as_steeply_as_its_tip_really_falls(seed: int) -> None:
    """Told 1 in 100 along a heading across a leaning axis; the tip falls from a tenth of that to fifty times as much,
    and beside that it may have gone anywhere. A tip that rises does not sink."""
    rng = np.random.default_rng(seed)
    k, heading, aside = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    way = (heading - 0.01 * k) / np.hypot(1.0, 0.01)
    start, length = rng.normal(size=3) * 20e-3, rng.uniform(0.1e-3, 2e-3)
    down = WayDown(start, k, way, length)
    level = length * np.hypot(1.0, 0.01) / (1.0 + 0.01**2)  # of the step, across the tool
    for slope in (0.0005, 0.001, 0.003, 0.008, 0.02, 0.5):
        tip = start - slope * level * k + rng.normal(size=2) * 30e-6 @ (heading, aside)
        goes, steep = down.to(tip)
        np.testing.assert_allclose(goes * length, level * heading - slope * level * k, atol=1e-12)
        assert steep == pytest.approx(np.clip((slope - PRESSED) / (DISH - PRESSED), 0.0, 1.0), abs=1e-6)
        assert down.to(start + slope * level * k)[1] == 0.0
    for told, whole in ((-k, 1.0), (heading, 0.0)):
        goes, steep = WayDown(start, k, told, 0.0).to(start - 1e-3 * k)
        np.testing.assert_array_equal(goes, told)
        assert steep == whole
