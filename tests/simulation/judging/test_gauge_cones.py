"""What a gauge reads on the sides and at the roots of grooves that cones cut."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from tests.simulation.judging.pushed_runs import PARTS, R, pushed, run


@pytest.mark.parametrize("angle", [60.0, 90.0, 120.0])
def test_a_wall_that_leans_is_off_by_less_than_its_cutter_goes_aside(angle):
    """A V groove of which one half is 0.3 mm aside and one 0.06 mm: normal to its sides that is less by the cosine of
    half the angle between them."""
    cone = Cutter("chamfer", 2 * R, tip_angle=np.radians(angle))
    result = run(*PARTS["slot"], cutter=cone)
    x, lean = result.path.p[:, 0], np.cos(np.radians(0.5 * angle))
    walls = pushed(result, left=np.where(x < -5e-3, 0.3e-3, 0.06e-3)).gauge.walls
    along = walls.length > 0.0
    for aside, here in ((0.3e-3, x < -8e-3), (0.06e-3, (x > -2e-3) & (x < 18e-3))):
        found = walls.error[along & here[walls.sample]]
        assert len(found) > 10
        np.testing.assert_allclose(found, aside * lean, atol=2e-7)


@pytest.mark.parametrize("tip", [0.0, 0.1e-3])
@pytest.mark.parametrize("angle", [60.0, 90.0, 120.0])
def test_a_groove_with_the_sides_of_a_cone_is_as_deep_as_its_root(angle, tip):
    """Pushed 0.2 mm aside and 0.1 mm down or up: where its root was to be, its side stands, but a gauge finds the root.
    Each side is off along its normal, and the sections, which see the surface alone, say so, too."""
    cone = Cutter("chamfer", 2 * R, tip_angle=np.radians(angle), tip_diameter=tip)
    result = run(*PARTS["slot"], cutter=cone)
    half = np.radians(0.5 * angle)
    for left, up in ((0.2e-3, -0.1e-3), (-0.2e-3, -0.1e-3), (0.2e-3, 0.1e-3), (0.0, -0.1e-3)):
        bent = pushed(result, left=left, up=up)
        np.testing.assert_allclose(bent.gauge.floors.error, up, atol=1e-9)
        assert bent.groove(0.03).floor_error == pytest.approx(up, abs=1e-6)
        off = [left * np.cos(half) - up * np.sin(half), left * np.cos(half) + up * np.sin(half)]  # left and right of it
        found = bent.gauge.walls.error[bent.gauge.walls.length > 0.0]
        assert np.isclose(found[:, None], off, atol=1e-8).any(axis=1).all()
        assert np.isclose(found[:, None], off, atol=1e-8).any(axis=0).all()


def test_a_slope_that_cones_leave_in_steps_is_off_where_it_has_gone_aside():
    """Thirteen passes 0.1 mm beside and 0.05 mm above each other: pushed 0.2 mm down their slope, each place is as much
    too high as the pass two further up was told to be, which no root of its own tells."""
    cone = Cutter("chamfer", 2 * R, tip_angle=np.radians(90.0))
    lines = [
        line
        for k in range(13)
        for line in (f"G0 X-40 Y{0.1 * k:g} Z5", f"G0 Z{-2 + 0.05 * k:g}", "G1 X20 F1800", "G0 Z5")
    ]
    result = run(*lines, cutter=cone)
    found = pushed(result, left=-0.2e-3).gauge.floors
    inner = (result.path.p[found.sample, 1] > 0.15e-3) & (result.path.p[found.sample, 1] < 0.95e-3)
    assert inner.sum() > 100
    np.testing.assert_allclose(found.error[inner], 0.1e-3, atol=1e-6)


@pytest.mark.parametrize("z", [-3.0, -1.0])
def test_a_cones_groove_on_a_slope_is_off_normal_to_its_root(z):
    """Its root is a line, which moves with the tip: what of that is normal to the line, beneath it or above."""
    cone = Cutter("chamfer", 2 * R, tip_angle=np.radians(90.0))
    result = run("G0 X-40 Y0 Z5", "G0 Z-2", f"G1 X-36 Z{z} F1800", f"G1 X-10 Z{z}", f"G1 X20 Z{z - 3}", cutter=cone)
    line = np.array([30.0, 0.0, -3.0]) / np.hypot(30.0, 3.0)
    for d in ([0.1e-3, 0.2e-3, -0.1e-3], [-0.1e-3, -0.2e-3, 0.05e-3]):
        found = pushed(result, *d).gauge.floors
        on = result.path.p[found.sample, 0] > -5e-3
        normal = np.array([-line[2], 0.0, line[0]])
        assert on.sum() > 10
        np.testing.assert_allclose(found.error[on], np.array(d) @ normal, atol=2e-7)


@pytest.mark.parametrize("angle", [60.0, 90.0, 120.0])
@pytest.mark.parametrize("rise", [0.5, -1.0, 3.0, -3.0])
def test_the_walls_of_a_cones_groove_on_a_slope_are_off_along_their_normals(angle, rise):
    """The sides that a cone makes on its way down or up are planes, |y| = T (z - s x) / sqrt(1 - s^2 T^2): what the tip
    goes aside and down, along their normals."""
    cone, b, T = (
        Cutter("chamfer", 2 * R, tip_angle=np.radians(angle)),
        np.radians(rise),
        np.tan(np.radians(0.5 * angle)),
    )
    ends = (-1.4 - 15.0 * np.tan(b), -1.4 + 15.0 * np.tan(b))
    result = run("G0 X-25 Y0 Z5", f"G0 Z{ends[0]:.6f}", f"G1 X5 Z{ends[1]:.6f} F1800", cutter=cone, step=0.5e-3)
    s, left, up = np.tan(b), 0.2e-3, -0.1e-3
    flat = T / np.sqrt(1.0 - (s * T) ** 2)
    expected = np.array([side * (side * left - flat * up) for side in (1.0, -1.0)]) / np.hypot(
        1.0, flat * np.hypot(1.0, s)
    )
    walls = pushed(result, left=left, up=up).gauge.walls
    here = (walls.length > 0.0) & (np.abs(result.path.p[walls.sample, 0] + 10e-3) < 12e-3)
    found = walls.error[here]
    assert here.sum() > 40
    near = np.abs(found[:, None] - expected)
    assert (near.min(axis=1) < 6e-6).all(), (found.min(), found.max(), expected)
    assert (near.min(axis=0) < 6e-6).all()
