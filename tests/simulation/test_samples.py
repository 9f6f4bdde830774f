"""Blocks that do not move: the same program without them is the truth, and whole results are compared with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.simulation.samples import STILL, chosen, clock, moving, sampled, ways
from robomill.surface.stock import Stock
from robomill.toolpath.path import Toolpath
from robomill.toolpath.source import GCodeSource

SLOT = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(cell=4e-4, step=2e-3)
ARRAYS = ("theta", "C", "F", "delta", "delta_joint", "R_MF", "p_machined", "deviation", "judged", "removes")


def toolpath(p, k=(0.0, 0.0, 1.0)):
    m = len(p)
    given = {"v_f": 0.01, "block": np.arange(m), "n_s": 200.0, "tool": 0}
    return Toolpath(p=p, k=k, cutting=np.arange(m) > 0, **given)


def run(*lines: str, **changes):
    """Each line with its own number, so that a line left out does not renumber the others."""
    text = "\n".join(["G21 G90 S12000 M3", *lines, "M2", ""])
    return rm.simulate(SLOT.replace(source=GCodeSource(text), **changes))


CUT = ("G0 X-50 Y0 Z5", "G0 Z-2", "G1 X0 F1800", "G1 X20", "G3 X20 Y12 I0 J6", "G1 X-50", "G0 Z20")
STILLS = {
    "twice": (3, ["G1 X0"]),
    "several": (3, ["G1 X0", "G1 Y0", "G1 X0 Y0", "G1 X0.00001"]),
    "before the first cut": (2, ["G1 Z-2 F900", "G1 X-50"]),
    "at the end": (6, ["G1 X-50", "G1 X-50"]),
    "a dwell": (3, ["G4 P2", "G1 X0"]),
    "a rapid": (3, ["G0 X0"]),
    "before an arc": (4, ["G1 X20"]),
}


def same(found, truth) -> None:
    for name in ARRAYS:
        np.testing.assert_allclose(getattr(found, name), getattr(truth, name), atol=3e-8, rtol=0, err_msg=name)
    for name in ("a_p", "phi_st", "phi_ex"):
        a, b = (getattr(r.conditions, name) for r in (found, truth))
        np.testing.assert_allclose(a, b, atol=3e-8, err_msg=name)
    assert found.worst == truth.worst
    assert found.max_deviation == pytest.approx(truth.max_deviation, abs=1e-12)
    assert found.removes.sum() == truth.removes.sum()
    np.testing.assert_allclose(found.machined.z, truth.machined.z, atol=1e-9)


@pytest.mark.parametrize("name", STILLS)
def test_a_block_that_does_not_move_changes_nothing(name):
    at, still = STILLS[name]
    truth, found = run(*CUT), run(*CUT[:at], *still, *CUT[at:])
    same(found, truth)
    line = truth.worst_block + (len(still) if truth.worst_block > at + 1 else 0)
    assert found.worst_block == line


def test_a_point_twice_in_the_middle_of_an_arc():
    """An arc in two halves, with and without a block that repeats the point between them."""
    halves = ("G3 X26 Y6 I0 J6", "G3 X20 Y12 I-6 J0")
    truth = run(*CUT[:4], *halves, *CUT[5:])
    found = run(*CUT[:4], halves[0], "G1 X26 Y6", "G1 Y6", halves[1], *CUT[5:])
    same(found, truth)


def test_creeping_is_moving():
    """Steps below the limit that add up are kept where they have left it."""
    p = np.zeros((40, 3))
    p[:, 0] = 0.3 * STILL * np.arange(40)
    path = toolpath(p)
    kept = moving(path)
    assert 5 < len(kept) < 20
    assert np.diff(kept.p[:, 0]).max() < 2 * STILL
    assert kept.p[-1, 0] > p[-1, 0] - 1.01 * STILL


@pytest.mark.parametrize("seed", range(4))
def test_a_step_is_kept_where_it_ends_further_than_the_limit_from_where_the_tool_last_moved_to(seed):
    """One by one, on both sides of zero: a long step is always kept, whatever it is measured from."""
    rng = np.random.default_rng(seed)
    p = np.zeros((60, 3))
    p[1:, :2] = np.cumsum(STILL * rng.choice([0.3, 0.7, 1.5], (59, 1)) * rng.choice([-1.0, 1.0], (59, 2)), axis=0)
    kept = [0]
    for i in range(1, 60):
        from_last, step = (np.linalg.norm(p[i] - p[j]) for j in (kept[-1], i - 1))
        if step > STILL or from_last > STILL:
            kept.append(i)
    np.testing.assert_array_equal(moving(toolpath(p)).block, kept)


def test_a_step_of_just_the_limit_is_none():
    p = np.outer([0.0, 0.5, 1.0, 1.5, 3.5], [STILL, 0.0, 0.0])
    assert moving(toolpath(p)).block.tolist() == [0, 3, 4]
    assert moving(toolpath(p[[0, 2, 4]])).block.tolist() == [0, 2]


def test_turning_on_the_spot_is_kept_and_goes_the_way_of_the_step_after_it():
    k = np.array([[0, 0, 1.0], [0, 0, 1.0], [0, np.sin(0.1), np.cos(0.1)], [0, np.sin(0.2), np.cos(0.2)], [0, 0, 1.0]])
    p = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 0], [1, 0, 0], [1, 2, 0]]) * 1e-2
    path = toolpath(p, k)
    assert len(moving(path)) == 5
    np.testing.assert_allclose(ways(path), [[0, 0, 0], [1, 0, 0], *[[0, 1, 0]] * 3], atol=1e-15)


@pytest.mark.parametrize("turn", [-1.0, 1.0])
def test_the_way_through_the_samples_of_an_arc_is_the_arcs(turn):
    """A line, a corner, an arc of its own line, then a line at 5 degrees to it: tangents of the circle at its samples,
    where it begins and ends too; on lines, and at a bend between two of them, the way that ends there."""
    arc = f"G{2.5 + 0.5 * turn:.0f} X10 Y{12 * turn} I0 J{6 * turn}"
    code = ["G21 G90 G17 F100", f"G1 X10 Y{-5 * turn}", "X10 Y0", arc, f"G1 X0 Y{13 * turn}", "X0 Y0", ""]
    path = sampled(rm.read_gcode("\n".join(code)), 0.5e-3)
    way, x = ways(path), (path.p - [10e-3, turn * 6e-3, 0.0]) / 6e-3
    on = path.block == 4
    tangent = turn * np.column_stack([-x[:, 1], x[:, 0], 0.0 * x[:, 0]])
    whole = on & (np.abs(np.linalg.norm(x, axis=1) - 1.0) < 1e-9)
    assert whole.sum() > 50
    np.testing.assert_allclose(way[whole], tangent[whole], atol=1e-6)
    line = path.block == 5
    np.testing.assert_allclose(way[line], np.tile([-10.0, turn, 0.0] / np.hypot(10.0, 1.0), (line.sum(), 1)), atol=1e-9)


def test_the_clock_starts_with_the_first_cut():
    """By hand: what comes before it takes no time, feeds theirs, dwells theirs, a rapid its own or nobody knows."""
    x = np.array([0, 3, 7, 10, 20, 40, 50]) * 1e-3
    given = {"v_f": np.array([0, 0, 0, 0.01, 0.01, 0, 0.02]), "block": np.arange(7), "n_s": 200.0, "tool": 0}
    waits = np.array([0, 5.0, 0, 2.0, 0.25, 0, 0.5])
    path = Toolpath(
        p=np.outer(x, [1, 0, 0]),
        k=(0.0, 0, 1),
        cutting=np.array([0, 0, 0, 1, 1, 0, 1], dtype=bool),
        dwell=waits,
        **given,
    )
    np.testing.assert_allclose(clock(path, 0.1), [0, 0, 0, 0.3, 1.55, 1.75, 2.75])
    np.testing.assert_allclose(clock(path, None), [0, 0, 0, 0.3, 1.55, np.nan, np.nan])


def test_a_cut_without_a_feed_adds_nothing_to_the_clock_as_to_the_time_of_the_path():
    x = np.array([0, 1, 3]) * 1e-3
    given = {"k": (0.0, 0, 1), "block": np.arange(3), "n_s": 200.0, "tool": 0, "dwell": np.zeros(3)}
    path = Toolpath(p=np.outer(x, [1, 0, 0]), v_f=np.array([0, 0.01, 0.0]), cutting=np.array([0, 1, 1], bool), **given)
    np.testing.assert_allclose(clock(path, None), [0.0, 0.1, 0.1])


@pytest.mark.parametrize("seed", range(4))
def test_the_clock_adds_up_block_by_block(seed):
    """Blocks at random, some that stay where they are; added up one by one. A rapid that goes nowhere takes no time,
    whatever the rate."""
    rng = np.random.default_rng(seed)
    m, rate = 40, 0.2
    length, cutting = rng.choice([0.0, 0.004, 0.03], m), rng.random(m) < 0.6
    v_f, dwell = np.where(cutting, rng.uniform(0.005, 0.05, m), 0.0), rng.choice([0.0, 0.0, 1.5], m)
    p = np.outer(np.cumsum(length), [0.6, 0.8, 0.0])
    path = Toolpath(
        p=p, k=(0.0, 0.0, 1.0), cutting=cutting, v_f=v_f, dwell=dwell, block=np.arange(m), n_s=200.0, tool=0
    )
    first = int(np.argmax(cutting))
    for known in (rate, None):
        took, expected = 0.0, []
        for i in range(m):
            step = float(np.linalg.norm(p[i] - p[i - 1])) if i else 0.0
            if i >= first and step > 0.0:
                took += step / v_f[i] if cutting[i] else step / known if known else np.nan
            took += dwell[i] if i > first else 0.0
            expected.append(took)
        np.testing.assert_allclose(clock(path, known), expected, atol=1e-12)


@pytest.mark.parametrize("step", [1e-3, 5e-3])
@pytest.mark.parametrize("thick", [0.4e-3, 2e-3])
def test_material_shorter_than_a_step_is_met(step, thick):
    """A cutter of 1 mm through a thin plate, against the tooth's law summed by hand over the part of the arc that is in
    the plate, as the tip comes by; the plate lies between the samples that the steps would have."""
    low, R, a_p, c = 0.7e-3, 0.5e-3, 2e-3, 50e-6
    mill = SLOT.cutter.replace(diameter=2 * R, flutes=2)
    stock = Stock(np.array([low, -0.01, -0.005]), np.array([low + thick, 0.01, 0.0]))
    lines = ("G0 X-20 Y0 Z5", "G0 Z-2", "G1 X20.5 F1200")
    result = run(*lines, cutter=mill, stock=stock, step=step, cell=1e-4)
    phi = (np.arange(4000) + 0.5) * np.pi / 4000
    x = np.linspace(low - R, low + thick, 400)[:, None] + R * np.sin(phi)
    row, inside = result.setup.force.row, (x > low) & (x < low + thick)
    t, r = row.Ktc * c * np.sin(phi) + row.Kte, row.Krc * c * np.sin(phi) + row.Kre
    feed, left = -(t * np.cos(phi) + r * np.sin(phi)), t * np.sin(phi) - r * np.cos(phi)
    truth = np.hypot(*(np.sum(each * inside, axis=1) * mill.flutes * a_p / 2 / 4000 for each in (feed, left))).max()
    assert np.linalg.norm(result.F[:, :2], axis=1).max() == pytest.approx(truth, rel=0.08)
    far = run("G0 X-20 Y200 Z5", "G0 Z-2", "G1 X20.5 F1200", cutter=mill, stock=stock, step=step, cell=1e-4)
    assert len(far.path) < 60  # away from the part the steps stay as they are told


@pytest.mark.parametrize("seed", range(6))
def test_a_wait_is_before_the_next_move_that_is_kept_and_the_last_waits_at_the_last(seed: int) -> None:
    """Counted sample by sample; none is lost."""
    rng, m = np.random.default_rng(seed), 12
    path = replace(toolpath(rng.uniform(0.0, 0.1, (m, 3))), dwell=rng.uniform(0.1, 2.0, m))
    keep = rng.random(m) < 0.5
    keep[[0, m - 1 - seed % 2]], keep[m - seed % 2 :] = True, False
    waited, so_far = [], 0.0
    for i in range(m):
        so_far += path.dwell[i]
        if keep[i]:
            waited, so_far = [*waited, so_far], 0.0
    waited[-1] += so_far
    found = chosen(path, keep)
    np.testing.assert_allclose(found.dwell, waited)
    np.testing.assert_array_equal(found.p, path.p[keep])
