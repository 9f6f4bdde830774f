"""What goes into a run beside its laws: depths as told, where a moved path goes, what of a force is suspected."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomill.cutting.forces.measured import ForceRecord, MeasuredForce
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.provenance import Finding
from robomill.simulation.cut import (
    SEEN,
    SUSPECTED,
    cut_notes,
    moved_points,
    over_stock,
    rotary_asked,
    steps_in_stock,
    suspicions,
    told_conditions,
    unknown_material,
)
from robomill.simulation.run import simulate
from robomill.surface.stock import Stock
from robomill.toolpath.path import ROTARY_ASKED, Toolpath

SETUP = load_setup(samples_dir() / "paper_flute" / "setup.toml")
PROCESS = load_setup(samples_dir() / "paper_flute" / "setup_process.toml")


def path_of(p, cutting, **changes):
    m = len(p)
    given = {"k": (0.0, 0.0, 1.0), "v_f": 0.03, "block": np.arange(1, m + 1), "n_s": 200.0, "tool": 0, **changes}
    return Toolpath(p=np.array(p, float), cutting=np.array(cutting, bool), **given)


def recorded(frame="path"):
    return MeasuredForce(ForceRecord(np.arange(4.0), np.ones((4, 3)), frame=frame))


def test_a_slot_is_told_as_deep_as_the_tip_stands_below_the_top():
    top = SETUP.stock_block.upper[2]
    path = path_of([[0, 0, top + 5e-3], [0, 0, top - 2e-3], [0.01, 0, top - 2e-3], [0.02, 0, top]], [0, 1, 1, 1])
    told = told_conditions(SETUP, path, np.array([True, True, False, True]))
    np.testing.assert_allclose(told.a_p, [0.0, 2e-3, 2e-3, 0.0], atol=1e-15)
    np.testing.assert_array_equal(told.cutting, [False, True, False, True])
    np.testing.assert_allclose(told.along[1:3], [-1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(told.across[1:3], [0.0, 1.0], atol=1e-12)
    np.testing.assert_array_equal(told.block, path.block)


def leaning(rng, m):
    k = np.column_stack([rng.normal(size=(m, 2)) * 0.7, np.ones(m)])
    return k / np.linalg.norm(k, axis=1, keepdims=True)


def test_no_step_that_meets_the_stock_is_longer_than_a_quarter_of_the_tool():
    """Tools that lean and moves about the block, from afar and from above: points all over the body at some places of
    the way, up to above the block, asked whether one is in it."""
    high = SETUP.replace(stock=Stock([-30e-3, -20e-3, -60e-3], [30e-3, 20e-3, 0.0]))
    rng, block, width = np.random.default_rng(2), high.stock_block, high.cutter.diameter
    m, size = 400, block.upper - block.lower
    p, k = rng.uniform(block.lower - 0.7 * size, block.upper + 0.7 * size, (m, 3)), leaning(rng, m)
    p[:, 2] = rng.uniform(block.lower[2] - width, block.upper[2] + width, m)
    p[1::2] = p[::2] + rng.normal(size=(m // 2, 3)) * width
    longest = steps_in_stock(high, path_of(p, np.ones(m), k=k))
    meets = np.zeros(m, dtype=bool)
    for i in range(1, m):
        e1 = np.cross(k[i], [1.0, 0.0, 0.0]) / np.linalg.norm(np.cross(k[i], [1.0, 0.0, 0.0]))
        rim = [np.cos(a) * e1 + np.sin(a) * np.cross(k[i], e1) for a in np.arange(0.0, 6.2, 0.4)]
        disc = np.vstack([np.zeros(3), np.array(rim) * 0.499 * width])
        up = np.linspace(0.0, 3.0 * (size[2] + 2.0 * width), 90)[:, None] * k[i]
        body = (up[:, None] + disc).reshape(-1, 3)
        for share in (0.0, 0.5, 1.0):
            at = body + p[i - 1] + share * (p[i] - p[i - 1])
            meets[i] |= ((at > block.lower) & (at < block.upper)).all(axis=1).any()
    assert 50 < meets.sum() < m - 50
    np.testing.assert_array_equal(longest[meets], width / SEEN)
    assert set(longest) == {width / SEEN, np.inf}


@pytest.mark.parametrize("lean", [0.0, 0.3])
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("side", [1, -1])
def test_steps_beside_and_above_the_stock_may_be_of_any_length(lean, axis, side):
    """Two widths from the block, and as much more as the tool leans over from its tip up to the block's top; what is
    less than half a width away is near."""
    block, width = SETUP.stock_block, SETUP.cutter.diameter
    middle, deep = 0.5 * (block.lower + block.upper), 6e-3
    middle[2] = block.upper[2] - deep
    near, far = middle.copy(), middle.copy()
    edge = (block.upper if side > 0 else block.lower)[axis]
    if axis == 2:
        far[2], near[2] = block.upper[2] + 2.0 * width, block.upper[2] + 0.5 * width * (side > 0)
    else:
        far[axis] = edge + side * (2.0 * width + deep * np.tan(lean))
        near[axis] = edge + side * 0.4 * width
    aside = np.eye(3)[1 - axis if axis < 2 else 0] * 0.3 * width  # along the block, so as not to come nearer
    k = [np.sin(lean), 0.0, np.cos(lean)]
    path = path_of([far, far + aside, far, near, near + aside], np.ones(5), k=k)
    np.testing.assert_array_equal(steps_in_stock(SETUP, path)[1:] < np.inf, [False, False, True, True])


def test_a_rapid_arrives_where_the_cut_after_it_begins_and_what_is_not_reached_stays():
    turn = Rotation.from_rotvec([0.3, -0.2, 1.0]).as_matrix()
    T_MW = np.eye(4)
    T_MW[:3, :3], T_MW[:3, 3] = turn, [1.0, 2.0, 3.0]
    path = path_of(np.arange(18).reshape(6, 3) * 1e-2, [0, 1, 1, 0, 0, 1])
    delta = np.random.default_rng(0).normal(size=(6, 3)) * 1e-4
    delta[2] = np.nan
    reached = np.array([True, True, False, True, True, True])
    moved = (moved_points(T_MW, path, reached, delta) - path.p) @ turn.T
    np.testing.assert_allclose(moved, np.nan_to_num(delta)[[1, 1, 2, 3, 5, 5]], atol=1e-15)
    np.testing.assert_array_equal(moved_points(T_MW, path, np.zeros(6, bool), np.ones((6, 3))), path.p)


@pytest.mark.parametrize(("along", "suspected"), [(-20.0, False), (0.0, False), (9.0, False), (13.0, True)])
def test_a_measured_force_that_pulls_along_the_feed_is_suspected(along, suspected):
    """By more than a tenth of its mean size, about 100 N."""
    pull = np.array([[along, 100.0, 0.0], [along, -100.0, 0.0]])
    found = suspicions(SETUP.replace(force=recorded()), pull)
    assert [(each.code, each.line) for each in found] == [("force-pulls", 0)] * suspected
    assert suspicions(SETUP, pull) == ()  # a stated force is a person's
    assert suspicions(SETUP.replace(force=recorded()), pull[:0]) == ()
    assert SUSPECTED == 0.1


@pytest.mark.parametrize(("frame", "turned", "suspected"), [("M", True, True), ("M", False, False), ("W", True, False)])
def test_axes_of_a_sensor_that_may_have_turned_with_the_part_are_asked_for(frame, turned, suspected):
    T_MW = np.array(SETUP.T_MW)
    T_MW[:3, :3] = Rotation.from_euler("z", 0.5 if turned else 0.0).as_matrix()
    found = suspicions(SETUP.replace(force=recorded(frame), T_MW=T_MW), np.array([[-1.0, 100.0, 0.0]]))
    assert [(each.code, each.line) for each in found] == [("force-axes", 0)] * suspected


def test_a_full_slot_everywhere_is_said_of_forces_that_follow_the_cut():
    path = path_of([[0, 0, -2e-3], [0.01, 0, -2e-3]], [0, 1])
    for setup, engagement, said in ((PROCESS, False, True), (PROCESS, True, False), (SETUP, False, False)):
        chosen = setup.replace(engagement=engagement)
        told = told_conditions(chosen, path, np.ones(2, bool))
        notes = cut_notes(chosen, told, np.ones(2, bool))
        assert [(each.code, each.line) for each in notes if each.code == "full-slot"] == [("full-slot", 0)] * said
        assert all(each.line >= 0 for each in notes)


def test_notes_of_the_cutter_are_of_what_is_engaged():
    short = SETUP.replace(cutter=SETUP.cutter.replace(flute_length=1e-3))
    top = short.stock_block.upper[2]
    path = path_of([[0, 0, top - 2e-3], [0.01, 0, top - 2e-3]], [0, 1])
    told = told_conditions(short, path, np.ones(2, bool))
    assert "beyond-flutes" in {each.code for each in cut_notes(short, told, np.ones(2, bool))}
    air = replace(told, a_p=np.zeros(2))
    assert "beyond-flutes" not in {each.code for each in cut_notes(short, air, np.ones(2, bool))}


def test_no_cut_is_judged_of_a_program_that_turns_far_until_somebody_says_what_turns():
    met = simulate(PROCESS.replace(cell=1e-3, step=5e-3)).conditions
    path = path_of([[0, 0, 0], [0.01, 0, 0]], [0, 1])
    assert rotary_asked(path, met) == ()
    asked = replace(path, findings=(Finding("warning", "A turns", 2, code=ROTARY_ASKED),))
    (found,) = rotary_asked(asked, met)
    assert found.code == ROTARY_ASKED
    np.testing.assert_array_equal(found.where, met.cutting)


def test_steps_before_which_the_material_is_not_known_are_not_judged_where_they_cut():
    met = simulate(PROCESS.replace(cell=1e-3, step=5e-3)).conditions
    cuts = np.flatnonzero(met.cutting)
    for lost in ([], [cuts[3]], [cuts[3], cuts[5]], [np.flatnonzero(~met.cutting)[0]], range(len(met))):
        known = ~np.isin(np.arange(len(met)), lost)
        found = unknown_material(replace(met, part=replace(met.part, known=known)))
        told = [i for i in cuts if i in lost]
        assert [each.code for each in found] == ["layers"] * bool(told)
        for each in found:
            np.testing.assert_array_equal(np.flatnonzero(each.where), told)
    assert unknown_material(replace(met, part=None)) == ()


@pytest.mark.parametrize("lean", [0.0, 20.0, 50.0])
def test_a_tool_that_leans_reaches_into_the_block_from_further_beside_it(lean: float) -> None:
    """By its radius, and by how far its axis goes aside up to the top; what stands above the top reaches nothing."""
    block, R = SETUP.stock_block, SETUP.cutter.radius
    k = np.array([np.sin(np.radians(lean)), 0.0, np.cos(np.radians(lean))])
    for depth in (4e-3, 1e-3, -1e-3):
        reach = R + max(depth, 0.0) * np.tan(np.radians(lean))
        off = np.array([-5e-3, 0.0, 0.5 * reach, 0.999 * reach, 1.001 * reach, 2.0 * reach])
        for axis, side in ((0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)):
            p = np.tile(0.5 * (block.lower + block.upper), (6, 1))
            p[:, axis] = (block.upper if side > 0.0 else block.lower)[axis] + side * off
            p[:, 2] = block.upper[2] - depth
            found = over_stock(SETUP, path_of(p, np.ones(6), k=np.tile(k, (6, 1))))
            np.testing.assert_array_equal(found, (off < reach) & (depth > 0.0))
