"""What a gauge reads on floors: of slots, slopes, ledges and plunges, and along edges."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

import robomill as rm
from robomill.cutting.tool import Cutter
from robomill.simulation.judging.gauge import ACROSS, AROUND, BESIDE_ROOT, CROWN, LOOK, ON_NOSES, RIM, _under, gauge
from robomill.surface.outline import Outline
from robomill.surface.stock import Stock
from tests.simulation.judging.pushed_runs import R, pushed, run


@pytest.mark.parametrize("kind", ["flat", "ball", "bull"])
@pytest.mark.parametrize("rise", [5.0, 15.0, 30.0, 45.0])
@pytest.mark.parametrize("down", [False, True])
def test_a_slope_is_measured_along_its_normal(kind, rise, down):
    """Whatever leaves it; the whole path is moved by one vector, so the plane moves by its part along the normal."""
    b, heading = np.radians(rise), np.radians(35.0)
    run_out = min(16e-3 / np.tan(b), 25e-3)
    way = run_out * np.array([np.cos(heading), np.sin(heading)])
    low, high = (
        np.append(-way / 2, -0.006 - run_out * np.tan(b) / 2),
        np.append(way / 2, -0.006 + run_out * np.tan(b) / 2),
    )
    ends = [" ".join(f"{a}{v * 1e3:.6f}" for a, v in zip("XYZ", end)) for end in ((high, low) if down else (low, high))]
    cutter = Cutter(kind, 2 * R, corner_radius={"flat": 0.0, "ball": R, "bull": 1e-3}[kind])
    stock = Stock((-0.04, -0.04, -0.05), (0.04, 0.04, 0.02))
    made = run(
        f"G0 {ends[0][: ends[0].index('Z')]} Z40",
        f"G1 {ends[0]} F300",
        f"G1 {ends[1]} F600",
        cutter=cutter,
        stock=stock,
    )
    shift = np.array([0.03e-3, 0.02e-3, 0.09e-3])
    cut = np.where(made.path.cutting[:, None], shift, 0.0)
    moved = dataclasses.replace(made, delta=cut @ made.setup.T_MW[:3, :3].T, F=np.nan_to_num(made.F), unjudged=())
    normal = np.array([-np.sin(b) * np.cos(heading), -np.sin(b) * np.sin(heading), np.cos(b)])
    middle = np.abs(
        moved.path.s[moved.gauge.floors.sample] - moved.path.s[-1] + 0.5 * np.hypot(run_out, run_out * np.tan(b))
    )
    nearest = moved.gauge.floors.error[np.argmin(middle)]
    assert nearest == pytest.approx(shift @ normal, abs=5e-7)


def test_a_plunge_that_a_slot_follows_leaves_the_slots_floor():
    result = run("G0 X-10 Y0 Z5", "G1 Z-2 F600", "G1 X10 F1800")
    down = result.path.block == 3
    bent = pushed(result, up=np.where(down, 0.5e-3, -0.04e-3))
    assert bent.verdict.floor.value == pytest.approx(-0.04e-3, abs=1e-8)
    plunged = pushed(result, up=np.where(down, -0.2e-3, -0.04e-3))
    assert plunged.verdict.floor.value == pytest.approx(-0.2e-3, abs=1e-8)


def test_metal_left_over_the_whole_width_is_the_floors_error():
    """A ramp whose tip is lifted by more than it is deep: no wall reads more than the tip is aside."""
    result = run("G0 X-40 Y0 Z5", "G0 Z0", "G1 X0 Z-2 F900", "G1 X28")
    ramp = result.path.block == 4
    bent = pushed(result, left=np.where(ramp, 0.3e-3, 0.05e-3), up=np.where(ramp, 0.8e-3, 0.0))
    assert np.abs(bent.gauge.walls.error).max() <= 0.3e-3 + 2e-6
    assert bent.verdict.wall.value == pytest.approx(0.3e-3, abs=2e-6)
    assert bent.verdict.floor.value == pytest.approx(0.8e-3, rel=0.02)


def test_the_floor_of_a_leaning_ball_is_its_lowest_point():
    """A ball's lowest point moves as its tip does: the floor is off by the upward part of the deviation."""
    ball = Cutter(kind="ball", diameter=6e-3)
    result = run("G0 X-40 Y0 Z8 A-15", "G0 Z-2", "G1 X20 F1800", cutter=ball)
    shift = np.where(result.path.cutting[:, None], [0.0, 0.2e-3, -0.125e-3], 0.0)
    bent = dataclasses.replace(result, delta=shift @ result.setup.T_MW[:3, :3].T)
    assert bent.verdict.floor.value == pytest.approx(bent.groove(40e-3).floor_error, abs=10e-6)
    assert bent.verdict.floor.value < -0.1e-3


def test_a_step_between_two_depths_that_has_moved_aside_is_no_floor():
    """A slot 3 mm deep ends in one 2 mm deep; pulled back 0.2 mm, its last 0.2 mm stay 1 mm too high: the wall of the
    step, not a floor."""
    made = run("G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F900", "G0 Z5", "G0 X-40", "G0 Z-3", "G1 X0", "G0 Z5")
    found = pushed(made, along=np.where(made.path.p[:, 2] < -2.5e-3, -0.2e-3, 0.0), up=10e-6).gauge
    np.testing.assert_allclose(found.floors.error, 10e-6, atol=1e-8)


@pytest.mark.parametrize("wide", [0.3, 1.0, 2.0, 3.9])
@pytest.mark.parametrize("radius", [4e-3, 10e-3])
def test_the_floor_of_a_narrow_ledge_is_told(wide, radius):
    """The ledge that a side pass leaves stands as much too high as the tip does, however narrow it is."""
    y = -20.0 + wide - radius * 1e3
    result = run("G0 X-45 Y-40 Z5", f"G0 Y{y}", "G0 Z-2", "G1 X45 F1800", cutter=Cutter("flat", 2.0 * radius, flutes=2))
    floors = pushed(result, left=0.05e-3, up=0.2e-3).gauge.floors
    assert floors.error[floors.worst] == pytest.approx(0.2e-3, abs=1e-9)


@pytest.mark.parametrize("place", ["X0 Y-21", "X0 Y21", "X31.5 Y3", "X-31 Y0", "X5 Y5"])
def test_the_bottom_of_a_plunge_beside_the_block_is_a_floor(place):
    result = run("G0 X0 Y-40 Z5", f"G0 {place}", "G1 Z-3 F300")
    floors = pushed(result, along=0.1e-3, up=0.2e-3).gauge.floors
    assert floors.error[floors.worst] == pytest.approx(0.2e-3, abs=1e-9)


@pytest.mark.parametrize("rise", [0.3, -0.3, 1.0, -2.0, 3.0])
@pytest.mark.parametrize("wide", [0.5, 2.0, 3.9])
def test_the_floor_beside_a_shoulder_is_told_on_slopes_too(rise, wide):
    """The ledge that a side pass leaves goes with the tip: as far, where it is pushed up or down alone, as that is
    along the normal of the slope."""
    y, b = -20.0 + wide - R * 1e3, np.radians(rise)
    ends = (-3.0 - 45.0 * np.tan(b), -3.0 + 45.0 * np.tan(b))
    result = run("G0 X-45 Y-40 Z5", f"G0 Y{y}", f"G0 Z{ends[0]:.6f}", f"G1 X45 Z{ends[1]:.6f} F1800")
    for up in (0.2e-3, -0.2e-3):
        floors = pushed(result, up=up).gauge.floors
        inner = np.abs(result.path.p[floors.sample, 0]) < 20e-3
        assert inner.sum() > 10
        upright = np.einsum("i,ij->j", [0.0, 0.0, 1.0], result.setup.T_MW[:3, :3]) @ result.R_MF[-1][:, 2]
        assert upright == pytest.approx(1.0)
        np.testing.assert_allclose(floors.error[inner], up * np.cos(b), rtol=0.12)


def test_a_floor_over_an_earlier_hole_is_that_of_the_ledges_beside_it():
    """A deeper groove of another tool lies beneath the axis: what this pass leaves stands to both sides of it."""
    tools = [rm.TableTool(1, Cutter("flat", 4e-3)), rm.TableTool(2, Cutter("flat", 10e-3))]
    lines = ["T1 M6", "S12000 M3", "G0 X-40 Y0 Z5", "G0 Z-4", "G1 X40 F900", "G0 Z5"]
    lines += ["T2 M6", "S12000 M3", "G0 X-40 Y0", "G0 Z-1.8", "G1 X40 Z-2.2 F1800"]
    result = run(*lines, tools=rm.ToolTable(tools))
    second = result.path.tool == 2
    floors = pushed(result, left=0.1e-3, up=np.where(second, -0.15e-3, 0.05e-3)).gauge.floors
    of_second = second[floors.sample]
    assert of_second.sum() > 50
    np.testing.assert_allclose(floors.error[of_second], -0.15e-3, atol=4e-6)
    np.testing.assert_allclose(floors.error[~of_second], 0.05e-3, atol=1e-9)


@pytest.mark.parametrize("y", [0.3, 1.0, 2.0])
@pytest.mark.parametrize("push", [(0.0, 0.15e-3), (0.0, -0.15e-3), (0.1e-3, 0.05e-3), (-0.05e-3, 0.1e-3)])
def test_a_ball_along_the_edge_is_off_normal_to_what_it_leaves(y, push):
    """Its axis runs beside the block, and its flank alone cuts: each place goes by the tip's part along its normal, the
    line from there to the ball's centre."""
    ball = Cutter("ball", 2 * R)
    result = run("G0 X-40 Y-40 Z5", f"G0 Y{-20 - y}", "G0 Z-3.5", "G1 X40 F1800", cutter=ball)
    left, up = push
    reading = pushed(result, left=left, up=up).gauge
    found = reading.floors.error[np.abs(result.path.p[reading.floors.sample, 0]) < 20e-3]
    offset = np.linspace(y * 1e-3, 0.7 * R, 200)  # left of the axis, where the block is
    normal = np.column_stack([-offset, np.sqrt(R**2 - offset**2)]) / R
    errors = normal @ np.array([left, up])
    assert len(found) > 20
    assert found.min() > errors.min() - 5e-6
    assert found.max() < errors.max() + 5e-6
    size = 5e-6 + 0.35 * (errors.max() - errors.min())  # read at a few places, not at every one
    assert abs(np.abs(found).max() - np.abs(errors).max()) < size


def test_a_floor_is_looked_for_as_far_to_both_sides_within_what_is_cut_flat():
    assert sorted(ACROSS) == sorted(-share for share in ACROSS)
    assert max(map(abs, (*ACROSS, RIM))) < 1.0


@pytest.mark.parametrize("left", [0.02e-3, -0.1e-3, 0.15e-3])
def test_a_tool_that_has_gone_aside_by_a_part_of_its_radius_has_its_floor_where_it_still_cuts(left):
    """0.4 mm wide, from a slot along X: nothing is read beside what it was told to cut and did."""
    made = pushed(run("G0 X-31 Y0 Z5", "G0 Z-0.2", "G1 X-26 F600", cutter=Cutter("flat", 0.4e-3)), left=left)
    floors = made.gauge.floors
    beside = np.abs(floors.place[:, 1])
    assert beside.max() <= 0.2e-3 - abs(left)
    assert (beside.max() > 0.1e-3) == (abs(left) < 0.1e-3)
    np.testing.assert_allclose(floors.error, 0.0, atol=1e-9)


def test_noses_are_looked_at_from_their_flat_end_to_their_rim_and_what_stands_in_every_direction():
    assert np.all(np.diff([0.0, *ON_NOSES]) > 0.0)
    assert ON_NOSES[-1] < 1.0
    assert np.diff(ON_NOSES).max() < 0.11
    np.testing.assert_allclose(BESIDE_ROOT, np.linspace(1.0, 2.0, len(BESIDE_ROOT)))
    for angles in (AROUND, LOOK):
        np.testing.assert_allclose(np.diff([*angles, angles[0] + 2.0 * np.pi]), 2.0 * np.pi / len(angles))


@pytest.mark.parametrize("slope", [0.0, 0.3, 0.7, 1.2, 2.0])
def test_beside_the_axis_a_floor_is_looked_for_where_the_tool_still_cuts_and_the_heel_has_not_rounded_it(slope):
    """So far aside as CROWN is of the slope's length, at most; nowhere but beneath the axis where nothing is flat."""
    flat, aside = np.array([4e-3, 4e-3, 1e-3, 0.0, 0.2e-3]), np.array([0.0, 1.8e-3, 0.05e-3, 0.0, 0.13e-3])
    way, none = np.tile([1.0, 0.0, 0.0], (5, 1)), np.zeros(5, dtype=bool)
    at = SimpleNamespace(
        i=np.arange(5), bottoms=none, steep=none, slope=np.full(5, slope), feed=way, left_of=way[:, [1, 0, 2]]
    )
    q, offset, u = _under(at, flat, aside)
    even = CROWN / np.hypot(slope, CROWN)
    for n in range(5):
        rim = min(RIM, even) * max(flat[n] - aside[n], 0.0)
        asked = [share * flat[n] for share in ACROSS if share] + [rim, -rim]
        seen = [each for each in asked if abs(each) + aside[n] < flat[n] and abs(each) <= even * flat[n]]
        np.testing.assert_allclose(sorted(offset[q == n]), sorted([0.0, *seen]), atol=1e-15)
    np.testing.assert_array_equal(u, at.left_of[q])


@pytest.mark.parametrize("kind", ["flat", "ball"])
def test_from_a_tool_into_the_part_floors_lie_beneath_it_and_what_noses_leave_beside_an_edge_beneath_and_aside(kind):
    """A slot on the level; a ball along the edge of the block, whose axis is beside it."""
    slot = run("G0 X-40 Y0 Z5", "G0 Z-2", "G1 X20 F1800", cutter=Cutter(kind, 8e-3)).gauge.floors
    np.testing.assert_allclose(slot.out, np.tile([0.0, 0.0, -1.0], (len(slot.out), 1)), atol=1e-9)
    if kind == "ball":
        beside = run("G0 X-40 Y21 Z5", "G0 Z-2", "G1 X20 F1800", cutter=Cutter(kind, 8e-3)).gauge.floors
        middle = np.array([0.0, 21e-3, 2e-3])
        way = (beside.place - middle) * [0.0, 1.0, 1.0]
        np.testing.assert_allclose(beside.out, way / np.linalg.norm(way, axis=1, keepdims=True), atol=1e-4)
        assert len(beside.out)


@pytest.mark.parametrize("slope", [0.0, 0.01, 0.05, 0.09, 0.2, 0.7])
def test_a_slope_that_has_gone_aside_is_one_floor_up_to_how_steep_its_heel_is_at_the_rim(
    slope: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By differences of what the heel of a flat end leaves on its way up, slope (x + sqrt(R^2 - y^2)); no more than
    CROWN, and where the path is steeper than that as much as the path."""
    y, step = np.array([RIM * R, RIM * R + 1e-9, RIM * R - 1e-9]), 2e-9
    heel = np.sqrt(R**2 - y**2)
    steepest = slope * np.hypot(1.0, (heel[2] - heel[1]) / step)
    asked, floors = [], Outline.floors

    def spied(self: Outline, places: object, offset: object, slack: np.ndarray) -> object:
        asked.append(slack)
        return floors(self, places, offset, slack)  # type: ignore[arg-type]

    monkeypatch.setattr(Outline, "floors", spied)
    made = run("G0 X-40 Y0 Z60", f"G0 Z{-3.0 - 40.0 * slope}", f"G1 X40 Z{-3.0 + 40.0 * slope} F1800")
    gauge(pushed(made, left=0.03e-3))
    expected = slope if slope >= CROWN else min(steepest, CROWN)
    assert len(asked[0]) > 20
    np.testing.assert_allclose(asked[0], 0.03e-3 * expected, rtol=1e-5)
