"""Ends of tools cut only as steeply as the tip really sinks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from robomill.arrays import FloatArray
from robomill.cutting.conditions import CutConditions
from robomill.cutting.engaged import sinks
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.io.materials import load_material
from robomill.simulation.judging.sinking import clear, pressing, sinking, told_to_sink
from robomill.simulation.samples import ways
from robomill.toolpath.path import Toolpath

MILL = Cutter("flat", 8e-3, flutes=3)


def ramp(degrees: float, cutter: Cutter = MILL) -> tuple[CutConditions, Toolpath]:
    """20 mm on the level, then 20 mm down (or up), in steps of 1 mm."""
    x = 1e-3 * np.arange(41)
    z = -1e-3 - np.tan(np.radians(degrees)) * np.maximum(x - 20e-3, 0.0)
    path = Toolpath.from_points(np.column_stack([x, 0.0 * x, z]), 0.03, cutting=np.append(False, np.ones(40, bool)))
    along = ways(path)[:, 2]
    told = CutConditions.steady(0.03, 200.0, 1e-3, along=along, across=np.sqrt(1.0 - along**2), cutting=path.cutting)
    return CutConditions(**{**vars(told), "tooling": Tooling.of(cutter, len(path))}), path


def steep_of(told: CutConditions, path: Toolpath, tips: FloatArray, lift: float) -> FloatArray:
    """How steeply ends sink whose tips go there, where whole ends lift them by so much, m."""
    return np.array(sinking(told, path, tips, None, lambda: np.full_like(tips, lift) * [0.0, 0.0, 1.0]).steep)


def never() -> FloatArray:
    raise AssertionError("nothing lets go: how far an end lifts its tip is not asked")


@pytest.mark.parametrize("degrees", [0.2, 0.5, 3.0])
def test_a_ramp_that_the_tip_follows_is_cut_as_it_is_told_once_it_goes_on_for_the_tools_width(degrees):
    told, path = ramp(degrees)
    steep = sinking(told, path, path.p, None, never).steep
    assert told_to_sink(told)[21:].all()
    np.testing.assert_allclose(steep[29:], told.sinks[29:], atol=1e-9)
    assert (np.diff(steep[20:]) >= -1e-9).all()  # taken up by and by


@pytest.mark.parametrize("deeper", [-4e-3, 3e-3])
def test_a_ramp_after_a_rapid_is_cut_as_if_it_were_the_first(deeper: float) -> None:
    """Wherever the cut before it has ended, and however far the rapid has gone down."""
    x = 1e-3 * np.arange(30)
    fall = 0.1 * np.abs(x - 5e-3)
    alone = np.column_stack([x, 0.0 * x, -1e-3 - fall - deeper])
    before = np.column_stack([x, 0.0 * x + 0.02, -1e-3 - fall])
    found = []
    for points, begins in ((alone, [0]), (np.vstack([before, alone]), [0, 30])):
        told, path = cut_along(points, begins)
        found.append(np.array(sinking(told, path, path.p, None, never).steep)[-29:])
    np.testing.assert_allclose(found[1], found[0], atol=1e-9)
    assert 0.1 < found[0].max()


@pytest.mark.parametrize("deep", [0.5e-3, 3e-3])
def test_a_ramp_after_a_plunge_is_cut_as_if_it_were_the_first(deep: float) -> None:
    """However far the plunge has gone down, within the last diameter of the way or beyond."""
    x, down = 1e-3 * np.arange(30), np.arange(0.0, deep, 0.25e-3)
    alone = np.column_stack([x, 0.0 * x, -1e-3 - 0.01 * x])
    plunge = np.column_stack([0.0 * down, 0.0 * down, deep - 1e-3 - down])
    found = []
    for points in (alone, np.vstack([plunge, alone])):
        told, path = cut_along(points, [0])
        found.append(np.array(sinking(told, path, path.p, None, never).steep)[-29:])
    np.testing.assert_allclose(found[1], found[0], atol=1e-9)
    assert 0.1 < found[0].max()


def cut_along(points: FloatArray, begins: list[int]) -> tuple[CutConditions, Toolpath]:
    """Points (m, 3) m at feed but for rapids to where cuts begin."""
    path = Toolpath.from_points(points, 0.03, cutting=~np.isin(np.arange(len(points)), begins))
    along = ways(path)[:, 2]
    told = CutConditions.steady(0.03, 200.0, 1e-3, along=along, across=np.sqrt(1.0 - along**2), cutting=path.cutting)
    return CutConditions(**{**vars(told), "tooling": Tooling.of(MILL, len(path))}), path


@pytest.mark.parametrize("deeper", [-3e-3, 0.0, 2e-3])
def test_a_slope_is_that_from_the_mean_height_of_half_a_diameter_to_that_of_the_other(deeper: float) -> None:
    """By many heights on the way, where a ramp of 0.4 degrees begins behind another; before it all is level."""
    x, fall = 1e-3 * np.arange(20), np.tan(np.radians(0.4))
    first = np.column_stack([x, 0.0 * x + 0.02, -1e-3 - fall * x])
    told, path = cut_along(np.vstack([first, first - [0.0, 0.02, deeper]]), [0, 20])
    steep = np.array(sinking(told, path, path.p, None, never).steep)
    half = np.linspace(0.0, 4e-3, 20001)
    for at, found in zip(x[1:], steep[21:], strict=True):
        before, after = (np.maximum(at - back + half, 0.0).mean() * fall for back in (8e-3, 4e-3))
        assert found == pytest.approx(min(sinks(-(after - before) / 4e-3), told.sinks[-1]), abs=1e-4)
    np.testing.assert_allclose(steep[1:20], steep[21:], atol=1e-9)


def test_ways_down_that_differ_in_the_fifth_decimal_press_alike() -> None:
    told, _ = ramp(2.0)
    close = replace(told, along=-0.02 + 1e-5 * (np.arange(41) % 5 - 2))
    assert np.unique(pressing(close).along).tolist() == [-0.02]
    apart = replace(told, along=-0.02 - 1e-4 * np.arange(41))
    np.testing.assert_allclose(pressing(apart).along, apart.along, atol=1e-12)


@pytest.mark.parametrize("degrees", [0.2, 3.0])
def test_an_end_that_is_told_down_as_its_arm_is_pushed_up_meets_nothing(degrees):
    told, path = ramp(degrees)
    level = path.p * [1.0, 1.0, 0.0] + [0.0, 0.0, -1e-3]
    assert not sinking(told, path, level, None, never).steep.any()
    assert not clear(told).sinks.any()


def test_where_a_cut_rises_or_goes_level_or_the_tool_has_no_end_nothing_is_asked():
    for told, path in (ramp(-2.0), ramp(0.0), ramp(2.0, Cutter("ball", 8e-3, flutes=2))):
        assert not told_to_sink(told).any()
        assert sinking(told, path, path.p, None, never) is told


def test_half_of_the_slope_taken_back_leaves_the_other_half():
    told, path = ramp(0.4)
    half = path.p * [1.0, 1.0, 0.5] + [0.0, 0.0, -0.5e-3]
    expected = ramp(np.degrees(np.arctan(0.5 * np.tan(np.radians(0.4)))))[0].sinks
    np.testing.assert_allclose(sinking(told, path, half, None, never).steep[29:], expected[29:], atol=1e-4)


@pytest.mark.parametrize("share", [0.3, 0.9, 1.5])
def test_what_a_nose_lifts_its_own_tip_by_takes_nothing_off(share: float) -> None:
    """A bull nose whose tip sinks by less than it is told, or even rises, as its own fall lifts it: as told."""
    told, path = ramp(0.6, Cutter("bull", 8e-3, corner_radius=1e-3, flutes=3))
    fall = -np.diff(path.p[:, 2], prepend=path.p[0, 2])
    tips = path.p + np.outer(np.cumsum(share * fall), [0.0, 0.0, 1.0])
    steep = sinking(told, path, tips, lambda: share * fall, lambda: np.zeros_like(tips)).steep
    np.testing.assert_allclose(steep[29:], told.sinks[29:], atol=1e-9)


def test_a_nose_that_is_told_down_as_its_arm_is_pushed_up_meets_nothing() -> None:
    """Level, though its own fall lifts it by a third of that; and by half of the slope beside its own lift, half."""
    told, path = ramp(0.4, Cutter("bull", 8e-3, corner_radius=1e-3, flutes=3))
    fall = -np.diff(path.p[:, 2], prepend=path.p[0, 2])
    own, none = 0.3 * fall, np.zeros_like(path.p)
    level = path.p * [1.0, 1.0, 0.0] + [0.0, 0.0, -1e-3]
    assert not sinking(told, path, level, lambda: own, lambda: none).steep.any()
    half = path.p * [1.0, 1.0, 0.35] + [0.0, 0.0, -0.65e-3]
    expected = ramp(np.degrees(np.arctan(0.5 * np.tan(np.radians(0.4)))))[0].sinks
    np.testing.assert_allclose(
        sinking(told, path, half, lambda: own, lambda: none).steep[29:], expected[29:], atol=1e-4
    )


@pytest.mark.parametrize("rise", [0.0, 0.2e-3, 0.4e-3, 0.5e-3, 0.51e-3, 0.53e-3, 0.6e-3])
def test_an_end_that_holds_lets_go_once_its_arm_has_sprung_up_by_all_that_it_lifts_the_tip(rise: float) -> None:
    """It lifts it by 0.5 mm, and half way down a ramp on which it has sunk by more the arm springs up on one step."""
    told, path = ramp(6.0)
    free = path.p.copy()
    free[30:, 2] += rise + 1e-3 * np.tan(np.radians(6.0))
    by_slope, held = (steep_of(told, path, free, up) for up in (0.0, 0.5e-3))
    assert held[29] == 1.0
    depth = (0.5e-3 - rise) / (4e-3 * np.tan(np.radians(0.5)))
    assert held[30] == pytest.approx(np.clip(depth, by_slope[30], 1.0), abs=1e-6)
    assert (held >= by_slope).all()
    assert held[-1] == 1.0


def test_an_end_holds_with_no_more_than_it_has_taken_up() -> None:
    """The tip of a corrected program, a few um off a level, however far its end could lift it."""
    told, path = ramp(3.0)
    level = path.p * [1.0, 1.0, 0.0]
    level[:, 2] = 5e-6 * np.sin(1e3 * path.p[:, 0])
    by_slope, held = (steep_of(told, path, level, up) for up in (0.0, 1e-3))
    assert 0.0 < by_slope.max() < 0.2
    assert (held <= np.maximum.accumulate(by_slope)).all()
    assert (held == 0.0)[25:].any()  # once the tip is back at its height nothing holds


def test_what_presses_a_whole_end_is_its_thrust() -> None:
    """In closed form: every radius of the end carries Kr h + Kre along the axis."""
    told, path = ramp(2.0)
    force = MechanisticForce(MILL, load_material("al7075_t6_carbide_ref190"))
    pressed, free = (force.components(each) for each in (pressing(told), clear(pressing(told))))
    h = 0.03 / (200.0 * 3) * np.sin(np.radians(2.0))
    thrust = 3 * 4e-3 * (168.8e6 * h + 26.6e3)
    np.testing.assert_allclose((pressed - free)[21:, 2], thrust, rtol=2e-3)
    np.testing.assert_allclose((pressed - free)[:21], 0.0, atol=1e-9)


@pytest.mark.parametrize("onset", [-0.4e-3, 0.3e-3])
def test_how_far_a_tip_is_off_from_its_first_step_on_is_no_fall(onset: float) -> None:
    """A ramp after a rapid, at whose begin the arm gives way at once: holding and letting go as without that."""
    x = 1e-3 * np.arange(30)
    told, path = cut_along(np.column_stack([x, 0.0 * x, -1e-3 - np.tan(np.radians(6.0)) * x]), [0])
    free = path.p.copy()
    free[12:, 2] = free[11, 2] + 1.2e-3
    off = free + np.outer(path.cutting, [0.0, 0.0, onset])
    steep = steep_of(told, path, free, 2e-3)
    assert (steep[11], steep[-1]) == (1.0, 0.0)
    np.testing.assert_allclose(steep_of(told, path, off, 2e-3), steep, atol=1e-9)


@pytest.mark.parametrize("left", [0.0, 0.2, 0.5, 0.9])
def test_an_end_that_is_hardly_pressed_cuts_by_the_share_of_its_hollow_that_it_has_taken_up(left: float) -> None:
    """On a ramp its tip has sunk by more than the 0.5 mm that the end lifts it by, then springs up and goes level."""
    told, path = ramp(6.0)
    hollow, free = 4e-3 * np.tan(np.radians(0.5)), path.p.copy()
    free[30:, 2] = free[29, 2] + 0.5e-3 - left * hollow
    steep = steep_of(told, path, free, 0.5e-3)
    assert steep[29] == 1.0
    np.testing.assert_allclose(steep[-2:], left, atol=1e-9)


def test_what_stands_still_presses_nothing() -> None:
    told, _ = ramp(2.0)
    i = np.arange(41)
    stopped = replace(told, v_f=np.where(i % 3 == 1, 0.0, told.v_f), n_s=np.where(i % 3 == 2, 0.0, told.n_s))
    np.testing.assert_array_equal(pressing(stopped).a_p > 0.0, (i > 20) & (i % 3 == 0))
