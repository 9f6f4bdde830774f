"""Coupled runs: shoulder cuts against root finding with a force integrated tooth by tooth; brackets; what is said."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.simulation.coupling import (
    AROUND,
    LONGEST,
    MOST,
    NARROW,
    TOLERANCE,
    Coupling,
    Settled,
    _by_bracket,
    settle,
)
from robomill.simulation.run import simulate
from robomill.surface.stock import Stock
from robomill.toolpath.source import GCodeSource

UP = np.array([0.0, 0.0, 1.0])
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


@pytest.mark.parametrize("q", [0.0, 0.5, -0.6, -1.0, -3.0, 0.99, -50.0])
def test_a_straight_law_is_solved_whatever_its_slope(q):
    """Going round and round closes in only for |q| < 1."""
    goal = np.array([1e-4, -2e-4, 0.5e-4])
    found = settle(lambda x: goal + q * (x - goal), np.zeros(3), np.zeros(3), UP)
    assert found.agreed
    np.testing.assert_allclose(found.x, goal, atol=TOLERANCE / abs(1 - q) * 1.01)
    assert found.evaluations < 12
    assert found.gain == pytest.approx(abs(q), rel=1e-6, abs=1e-9)
    ((place, weight),) = found.mix
    assert weight == 1.0
    np.testing.assert_array_equal(place, found.x)


@pytest.mark.parametrize("q", [0.0, -0.6, -3.0])
def test_a_place_that_is_told_beforehand_is_taken_and_one_beside_it_is_left_at_once(q):
    """The first step from anywhere goes to where the force bends the tool from there."""
    goal, asked = np.array([1e-4, -2e-4, 0.5e-4]), []

    def bends(x):
        asked.append(x)
        return goal + q * (x - goal)

    there = settle(bends, goal, np.zeros(3), UP)
    assert (there.agreed, there.evaluations, len(asked)) == (True, 1, 1)
    np.testing.assert_array_equal(there.x, goal)
    assert np.isnan(there.gain)
    beside = goal + np.array([0.0, 0.6e-4, -0.2e-4])
    assert settle(bends, beside, np.zeros(3), UP).agreed
    np.testing.assert_allclose(asked[1:3], [beside, goal + q * (beside - goal)], atol=1e-15)


@pytest.mark.parametrize("seed", range(4))
def test_a_law_of_three_slopes_is_closed_in_upon_in_short_steps(seed):
    """g(x) = goal + A (x - goal) with A of any slopes but 1, the goal some millimetres away."""
    rng = np.random.default_rng(seed)
    goal, axes = rng.normal(size=3) * 2e-3, np.linalg.qr(rng.normal(size=(3, 3)))[0]
    A = axes @ np.diag(rng.uniform(-2.0, 0.7, 3)) @ axes.T
    asked = []

    def bends(x):
        asked.append(x)
        return goal + A @ (x - goal)

    found = settle(bends, np.zeros(3), np.zeros(3), UP)
    assert found.agreed
    np.testing.assert_allclose(found.x, goal, atol=3 * TOLERANCE / 0.3)
    assert found.rest == pytest.approx(np.abs(bends(found.x) - found.x).max(), abs=1e-15)
    assert found.evaluations == len(asked) - 1
    assert np.linalg.norm(np.diff(asked[:-1], axis=0), axis=1).max() <= LONGEST * (1 + 1e-9)


def test_a_force_that_is_no_number_ends_the_bracket_where_it_is_seen():
    """At the tool's own place, or where it is bent to from there: nothing is asked any more."""
    for g in (lambda x: x * np.nan, lambda x: x + 1e-5 if x[0] < 1e-5 else x * np.nan):
        asked = []
        found = _by_bracket(lambda x, g=g, asked=asked: asked.append(x) or g(x), np.zeros(3))
        assert (found.evaluations, len(asked), np.isnan(found.rest), found.agreed) == (2, 2, True, False)
        assert not found.x.any()


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


def test_a_force_that_jumps_is_held_at_the_jump():
    """A wall at 30 um that pushes back 200 um as soon as it is touched: the tool rests on it with a part of that."""

    def bends(x):
        return np.array([50e-6, 10e-6, 0.0]) - (np.array([200e-6, 0.0, 0.0]) if x[0] > 30e-6 else 0.0)

    found = settle(bends, np.zeros(3), np.zeros(3), UP)
    assert found.agreed
    assert found.x[0] == pytest.approx(30e-6, abs=TOLERANCE)
    pushed = sum(weight * bends(place) for place, weight in found.mix)
    np.testing.assert_allclose(pushed, found.x, atol=TOLERANCE)
    assert len(found.mix) == 2


def remains(bends, found):
    """How far the force that acts at the place, of one side or of both by their weights, bends the tool from it."""
    return np.abs(sum(weight * bends(place) for place, weight in found.mix) - found.x).max()


@pytest.mark.parametrize("seed", range(12))
def test_a_wall_that_pushes_sideways_too_holds_the_tool(seed):
    """Free push a, a plane n . x = at, and behind it a + b: so much w of b acts that n . (a + w b) = at."""
    rng = np.random.default_rng(seed)
    a, b, n, at = np.array([50e-6, 10e-6, -20e-6]), np.array([-200e-6, 30e-6, -15e-6]), np.array([1.0, 0.0, 0.0]), 30e-6
    if seed:
        n, across = np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
        a = rng.uniform(30e-6, 200e-6) * n + rng.normal(size=3) * 50e-6
        at = rng.uniform(0.2, 0.9) * (a @ n)
        b = rng.uniform(1.2, 6.0) * (a @ n - at) * (-n + rng.uniform(0.0, 0.6) * across)
    root = a + (at - a @ n) / (b @ n) * b

    def bends(x):
        return a + (b if x @ n > at else 0.0)

    found = settle(bends, np.zeros(3), np.zeros(3), UP)
    assert found.agreed
    assert found.rest == pytest.approx(remains(bends, found), abs=1e-12)
    np.testing.assert_allclose(found.x, root, atol=2 * TOLERANCE)


@pytest.mark.parametrize("seed", range(30))
def test_what_remains_between_force_and_deflection_is_told_agreed_or_not(seed):
    """Two walls at once, each with a push of its own: a place between four forces, which two cannot always hold."""
    rng = np.random.default_rng(seed)
    a, (n, m) = rng.uniform(50e-6, 300e-6, 3), np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
    walls = [
        (u * np.sign(a @ u), rng.uniform(0.2, 0.9) * abs(a @ u), rng.uniform(1.5, 4.0) * abs(a @ u)) for u in (n, m)
    ]

    def bends(x):
        return a - sum((u * back * (1.0 + 0.3 * (n + m)) for u, at, back in walls if x @ u > at), np.zeros(3))

    found = settle(bends, np.zeros(3), np.zeros(3), UP)
    assert found.rest == pytest.approx(remains(bends, found), abs=1e-12)
    assert found.agreed == (remains(bends, found) <= TOLERANCE)


@pytest.mark.parametrize("stiff", [1.0, 3.0, 8.0])
@pytest.mark.parametrize("seed", range(6))
def test_a_bracket_follows_a_push_that_turns_as_it_grows(seed, stiff):
    """Behind a plane the tool is pushed back as far as it has gone in, times ``stiff``, and aside by the root of that:
    how far it goes in is one number's equation."""
    rng = np.random.default_rng(seed)
    n, u, v = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    reach = rng.uniform(50e-6, 300e-6)
    free, at = reach * n + rng.normal(size=3) * 30e-6, rng.uniform(0.2, 0.7) * reach

    def bends(x):
        into = max(x @ n - at, 0.0)
        return free - stiff * into * n + 0.3 * stiff * np.sqrt(into * reach) * (u + 0.5 * v)

    into = brentq(lambda into: free @ n - stiff * into - at - into, 0.0, 1.0, xtol=1e-15)
    found = _by_bracket(bends, np.zeros(3))
    assert found.agreed
    np.testing.assert_allclose(found.x, bends((at + into) * n), atol=2 * TOLERANCE)


@pytest.mark.parametrize("seed", range(20))
def test_an_end_that_rests_on_its_floor_holds_the_tool(seed):
    """Free push a, and b more as soon as the tool is below a floor; just above it some of b comes within 0.7 um. Aside
    the push changes slowly (L). How much of b acts, w, is one number's equation; the rest is linear."""
    rng = np.random.default_rng(seed)
    axis, u, v = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    P, near, touch = np.outer(u, u) + np.outer(v, v), 0.7e-6, 0.4
    a = rng.uniform(-400e-6, -20e-6) * axis + rng.normal(size=3) * 50e-6
    b = rng.uniform(500e-6, 900e-6) * axis + rng.uniform(-400e-6, 400e-6, 2) @ (u, v)
    L, at = rng.uniform(-0.2, 0.2, (3, 3)), a @ axis + rng.uniform(0.05, 0.95) * (b @ axis)

    def bends(x):
        above = x @ axis - at
        acts = 1.0 if above < 0.0 else touch * max(1.0 - above / near, 0.0)
        return a + L @ (P @ x) + acts * b

    def aside(w):
        return np.linalg.solve(np.eye(3) - P @ L, P @ (a + w * b))

    def over(w):
        return (a + L @ aside(w) + w * b) @ axis - at - near * max(1.0 - w / touch, 0.0)

    w = brentq(over, 0.0, 1.0, xtol=1e-15)
    root = aside(w) + (at + near * max(1.0 - w / touch, 0.0)) * axis
    found = settle(bends, np.zeros(3), np.zeros(3), axis)
    assert found.agreed
    np.testing.assert_allclose(found.x, root, atol=2 * TOLERANCE)
    assert found.rest == pytest.approx(remains(bends, found), abs=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_an_edge_of_a_floor_between_three_pushes_holds_the_tool(seed):
    """Above a floor one push, below it another on each side of a line: a share of each holds the tool on the floor's
    edge at x, which is chosen here first, with the shares. Each alone sends it hundreds of micrometres away."""
    rng = np.random.default_rng(seed)
    up, aside, along = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    x, share = rng.uniform(100e-6, 300e-6) * up + rng.normal(size=3) * 50e-6, rng.dirichlet([2, 2, 2])
    lift, turn = rng.uniform(100e-6, 600e-6) * np.array([1.0, rng.uniform(0.5, 1.0)]), rng.uniform(20e-6, 200e-6, 2)
    left, right = (
        lift[i] * up + way * turn[i] * aside + rng.normal() * 100e-6 * along for i, way in enumerate((1.0, -1.0))
    )
    above = -(share[1] * left + share[2] * right) / share[0]

    def bends(y):
        if (y - x) @ up > 0.0:
            return x + above
        return x + (left if (y - x) @ aside < 0.0 else right)

    found = settle(bends, np.zeros(3), np.zeros(3), up)
    assert found.agreed
    assert found.rest == pytest.approx(remains(bends, found), abs=1e-12)
    assert max(np.abs(place - found.x).max() for place, _ in found.mix) <= TOLERANCE * (1 + 1e-9)
    np.testing.assert_allclose([up @ found.x, aside @ found.x], [up @ x, aside @ x], atol=2 * TOLERANCE)


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


def test_one_looks_around_a_place_as_far_to_every_side():
    """The places are the same, seen in a mirror along any axis or with axes exchanged; none of them is asked twice."""
    places = {tuple(place) for place in AROUND.tolist()}
    assert len(places) == len(AROUND)
    for axes in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            assert {tuple(place) for place in (AROUND[:, axes] * signs + 0.0).tolist()} == places
    assert max(map(max, places)) == 1.0


def test_what_pushes_away_from_everywhere_is_told_as_open():
    """Wherever the tool stands it is pushed on by 10 um more: nothing holds it, and what acts there is told."""
    found = settle(lambda x: x + np.array([0.0, 10e-6, 0.0]), np.zeros(3), np.zeros(3), UP)
    assert not found.agreed
    assert found.rest == pytest.approx(10e-6, rel=0.1)
    assert sum(weight for _, weight in found.mix) == pytest.approx(1.0)


def test_what_is_not_a_number_ends_it():
    found = settle(lambda x: np.full(3, np.nan), np.zeros(3), np.zeros(3), UP)
    assert not found.agreed
    assert np.isnan(found.rest)
    assert found.evaluations <= MOST


@pytest.mark.parametrize("seed", range(6))
def test_how_often_the_force_was_asked_for_is_counted(seed):
    """A wall at a random place along the push, and one that is only pushed at: halving the way between until
    it is narrow takes the logarithm of its length, after what going round takes at most."""
    rng = np.random.default_rng(seed)
    push, wall, back = rng.uniform(50e-6, 900e-6), rng.uniform(0.1, 0.9), rng.uniform(1.5, 4.0)
    along = np.linalg.qr(rng.normal(size=(3, 3)))[0][0]
    asked = []

    def bends(x):
        asked.append(x)
        return push * along * (1.0 if x @ along < wall * push else 1.0 - back)

    found = settle(bends, np.zeros(3), np.zeros(3), UP)
    assert found.agreed
    np.testing.assert_allclose(found.x, wall * push * along, atol=TOLERANCE)
    assert found.evaluations == len(asked)
    halvings = np.ceil(np.log2(back * push / NARROW))
    floor = 2 * np.ceil(np.log2(LONGEST / TOLERANCE)) + 2 + halvings  # looked for twice: does the tool rest on one?
    assert found.evaluations <= MOST + 2 * floor + 2 + 2 + halvings
    ((there, low), (here, high)) = found.mix
    assert low + high == pytest.approx(1.0)
    both = (low * bends(there) + high * bends(here)) @ along / push
    assert both == pytest.approx(wall, abs=2e-3)


@pytest.mark.parametrize(("gain", "words"), [(0.0, "its force jumps"), (2.34, "changes 2.3 times as fast")])
def test_what_does_not_agree_says_whether_the_force_jumps_or_is_too_steep(gain: float, words: str) -> None:
    open_ = Settled(np.zeros(3), 0.9e-6, 171, gain, ((np.zeros(3), 1.0),))
    found = Coupling((open_,), (7,), 0.0)
    assert words in found.finding.message
    assert "0.9 µm remain after 171 evaluations" in found.finding.message
