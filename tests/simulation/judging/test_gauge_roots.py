"""The root of a V groove where another groove meets it, against the lowest point across the groove of a swept cone."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.simulation.result import SimulationResult
from tests.simulation.judging.pushed_runs import R, pushed, run

ACROSS = np.arange(-0.8e-3, 0.8e-3, 5e-6)


def lowest_across(result: SimulationResult, tips, half: float, stations, ways):
    """(s,) m: the lowest height that a cone about ``tips`` (m, 3) cuts, on lines across ``ways`` (s, 2)."""
    path, balls = result.path, []
    for i in np.flatnonzero(result.removes):
        share = np.linspace(0.0, 1.0, 2 + int(path.step_length[i] / 1e-6))[:, None]
        balls.append(tips[i - 1] + share * (tips[i] - tips[i - 1]))
    tip, low = np.concatenate(balls), []
    for at, way in zip(stations, ways, strict=True):
        near = tip[np.hypot(*(tip[:, :2] - at).T) < 1e-3]
        x, y = at[:, None] + np.outer([-way[1], way[0]], ACROSS)
        r = np.hypot(x[:, None] - near[:, 0], y[:, None] - near[:, 1])
        low.append((near[:, 2] + r / np.tan(half)).min())
    return np.array(low)


@pytest.mark.parametrize("step", [2.0, 0.5, 0.05])
@pytest.mark.parametrize(("angle", "turn"), [(60.0, 90.0), (90.0, 90.0), (60.0, 150.0), (60.0, 30.0)])
def test_at_a_corner_a_root_is_as_high_as_the_lowest_point_across_whatever_the_step(angle, turn, step):
    """Where the next leg comes by within the shift, its side stands over the told root, but the root is beside it."""
    half, a = np.radians(0.5 * angle), np.radians(turn)
    end = 20.0 * np.cos(a), 20.0 * np.sin(a)
    cone = Cutter("chamfer", 2 * R, tip_angle=2.0 * half)
    lines = ["G0 X-20 Y0 Z5", "G0 Z-2", "G1 X0 F900", f"G1 X{end[0]:.6f} Y{end[1]:.6f}"]
    made = run(*lines, cutter=cone, step=step * 1e-3)
    second = made.path.block == made.path.block[made.path.cutting].max()
    bent = pushed(made, *(np.where(second, b, a) * 1e-3 for a, b in ((0.05, -0.1), (-0.12, 0.25), (0.1, 0.15))))
    far = np.concatenate([np.arange(0.025, 1.0, 0.05), np.arange(1.0, 5.0)]) * 1e-3
    legs = np.array([[1.0, 0.0], [np.cos(a), np.sin(a)]])
    stations, ways = np.vstack([-far[:, None] * legs[0], far[:, None] * legs[1]]), np.repeat(legs, len(far), axis=0)
    error = lowest_across(bent, bent.p_machined, half, stations, ways) + 2e-3
    assert bent.verdict.floor.value == pytest.approx(error.max(), rel=0.02)


@pytest.mark.parametrize("step", [2.0, 0.5, 0.05])
def test_where_a_deeper_groove_crosses_a_root_is_read_up_to_its_edge(step):
    """The told root ends where the deeper groove begins; pushed 0.2 mm aside and 0.1 mm up none is higher than that."""
    cone = Cutter("chamfer", 2 * R, tip_angle=np.radians(60.0))
    lines = ["G0 X-20 Y0 Z5", "G0 Z-2", "G1 X20 F900", "G0 Z5", "G0 X0.37 Y-15", "G0 Z-3", "G1 Y15"]
    bent = pushed(run(*lines, cutter=cone, step=step * 1e-3), left=0.2e-3, up=0.1e-3)
    assert bent.gauge.floors.error.max() == pytest.approx(0.1e-3, abs=1e-8)


@pytest.mark.parametrize("apart", [0.3, 0.5, 3.0])
def test_a_raster_of_grooves_that_moves_aside_keeps_its_roots(apart):
    """Pushed 0.2 mm aside and 0.1 mm up, each root stands 0.1 mm too high, beside where it was told."""
    cone = Cutter("chamfer", 2 * R, tip_angle=np.radians(60.0))
    rows = [(f"G0 X-20 Y{k * apart:g} Z5", "G0 Z-2", "G1 X20 F900", "G0 Z5") for k in range(6)]
    bent = pushed(run(*(line for row in rows for line in row), cutter=cone), left=0.2e-3, up=0.1e-3)
    np.testing.assert_allclose(bent.gauge.floors.error, 0.1e-3, atol=1e-8)


DEEPER = {
    "across": ["G0 X0.37 Y-3", "G0 Z-3", "G1 Y3"],
    "askew": ["G0 X-3 Y-1", "G0 Z-3", "G1 X3 Y1.3"],
    "0.5 mm beside": ["G0 X-4 Y0.5", "G0 Z-3", "G1 X4"],
    "0.8 mm beside": ["G0 X-4 Y0.8", "G0 Z-3", "G1 X4"],
}


@pytest.mark.parametrize("step", [2.0, 0.05])
@pytest.mark.parametrize("other", DEEPER)
def test_each_of_two_grooves_that_meet_is_off_by_its_own_root_or_has_none_left(other, step):
    """Two roots are lines that move with their tips: whatever the sides of the other groove cover, no place of either
    is off by anything but what its own tip is off, upwards."""
    cone = Cutter("chamfer", 2 * R, tip_angle=np.radians(60.0))
    made = run("F900", "G0 X-5 Y0 Z5", "G0 Z-2", "G1 X5", "G0 Z5", *DEEPER[other], cutter=cone, step=step * 1e-3)
    first = np.isclose(made.path.p[:, 2], -2e-3)
    for left, up in (((0.2, 0.2), (0.1, -0.1)), ((0.2, -0.1), (0.1, 0.05)), ((-0.15, 0.2), (-0.05, 0.1))):
        aside, lift = (np.where(first, *pair) * 1e-3 for pair in (left, up))
        floors = pushed(made, left=aside, up=lift).gauge.floors
        np.testing.assert_allclose(floors.error, lift[floors.sample], atol=1e-8)
        assert (~first[floors.sample]).any()


@pytest.mark.parametrize("diameter", [0.5e-3, 2e-3, 8e-3])
def test_the_groove_of_a_ball_is_as_deep_as_its_bottom_line_however_small_the_ball(diameter):
    """Pushed aside its bottom is a line beside the told one, over which its side stands."""
    made = run("F900", "G0 X-5 Y0 Z5", "G0 Z-0.4", "G1 X5", cutter=Cutter("ball", diameter, flutes=2), cell=1e-4)
    for left, up in ((0.15e-3, 0.05e-3), (-0.2e-3, -0.05e-3), (0.15e-3, 0.0)):
        floors = pushed(made, left=left, up=up).gauge.floors
        assert len(floors.error) > 5
        np.testing.assert_allclose(floors.error, up, atol=1e-8)


@pytest.mark.parametrize("up", [-0.05e-3, 0.05e-3])
@pytest.mark.parametrize("left", [-0.2e-3, 0.2e-3])
def test_a_root_stays_one_where_deeper_grooves_are_three_times_as_far_as_it_goes_aside(left, up):
    """Its neighbours 0.3 mm beside it narrow it on both sides, deeper ones 0.6 mm beside it leave it where it is."""
    cone = Cutter("chamfer", 2 * R, tip_angle=np.radians(90.0))
    cuts = [(0.0, -2.0), (0.3, -1.95), (-0.3, -1.95), (0.6, -2.1), (-0.6, -2.1)]
    lines = [line for y, z in cuts for line in (f"G0 X-4 Y{y} Z5", f"G0 Z{z}", "G1 X4 F1800", "G0 Z5")]
    made = run(*lines, cutter=cone)
    floors = pushed(made, left=left, up=up).gauge.floors
    of_root = np.abs(made.path.p[floors.sample, 1]) < 1e-5
    assert of_root.sum() > 5
    np.testing.assert_allclose(floors.error[of_root], up, atol=1e-8)


def test_a_slope_of_grooves_is_read_alike_whichever_way_they_are_cut():
    """Seven grooves in steps, falling from the middle on; cut backwards, and pushed to the same side of the part."""
    cone, found = Cutter("chamfer", 2 * R, tip_angle=np.radians(90.0)), []
    for way in (1, -1):
        lines = []
        for k in range(7):
            ends = [(-1.5, -2 + 0.05 * k), (0.0, -2 + 0.05 * k), (1.5, -2.15 + 0.05 * k)][::way]
            lines += [f"G0 X{ends[0][0]} Y{0.1 * k:g} Z5", f"G0 Z{ends[0][1]:g}"]
            lines += [*(f"G1 X{x} Z{z:g} F1800" for x, z in ends[1:]), "G0 Z5"]
        made = run(*lines, cutter=cone, step=0.1e-3)
        floors = pushed(made, left=-way * 0.2e-3).gauge.floors
        at = np.round(made.path.p[floors.sample, :2] * 1e7).astype(int)
        # in the bend itself a sample belongs to the move before it
        found.append({(x, y): e for (x, y), e in zip(at.tolist(), floors.error, strict=True) if 1 < abs(x) < 14500})
    assert found[0].keys() == found[1].keys()
    assert len(found[0]) > 100
    for place, error in found[0].items():
        assert error == pytest.approx(found[1][place], abs=1e-8)


@pytest.mark.parametrize("side", [1, -1])
def test_a_root_is_none_where_its_tip_has_gone_into_a_deeper_groove(side: int) -> None:
    """0.8 mm beside it one is 1 mm deeper: where the tip went, 0.3 mm nearer and 0.2 mm up, that cuts lower by 0.3 mm;
    0.3 mm further away its side stands above."""
    cone = Cutter("chamfer", 2 * R, tip_angle=np.radians(60.0))
    lines = ["F900", "G0 X-5 Y0 Z5", "G0 Z-2", "G1 X5", "G0 Z5", f"G0 X-5 Y{0.8 * side}", "G0 Z-3", "G1 X5"]
    made = run(*lines, cutter=cone)
    first = np.isclose(made.path.p[:, 2], -2e-3)
    for left, some in ((0.3e-3, False), (-0.3e-3, True)):
        bent = pushed(made, left=np.where(first, side * left, 0.0), up=np.where(first, 0.2e-3, 0.0))
        assert first[bent.gauge.floors.sample].any() == some
