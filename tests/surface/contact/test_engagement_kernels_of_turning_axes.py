"""What cuts, and how it faces its way, where the axis of the tool turns as it goes: by turning the tool a little."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomill.arrays import FloatArray
from robomill.cutting.profile_kernels import END, FLANK, NOSE, on_profile, stretch_ends
from robomill.cutting.tool import DISH, Cutter
from robomill.surface.contact.engagement_kernels import cutting_end, faces_of
from robomill.surface.contact.step_kernels import Step, rim_turns, step_at

R, SHARE = 4e-3, 1e-4  # m; m of the way that is gone to either side
FLAT = Cutter("flat", 2 * R)
MILLS = (
    FLAT,
    Cutter("bull", 2 * R, corner_radius=1e-3),
    Cutter("ball", 2 * R),
    Cutter("chamfer", 2 * R, tip_angle=1.5),
)


def turning(rng: np.random.Generator, dives: float, turns: float) -> tuple[Step, FloatArray, FloatArray]:
    """A step of a tool that leans anyhow, its way v and the rotation w of its axis, rad/m."""
    k = Rotation.random(random_state=rng).as_matrix()[2]
    across, w = np.cross(k, rng.normal(size=3)), np.cross(k, rng.normal(size=3))
    v = np.sqrt(1.0 - dives**2) * across / np.linalg.norm(across) + dives * k
    w *= turns / np.linalg.norm(w)
    return step_at(np.zeros(3), k, v, np.zeros(3), (0.0, 1), np.cross(w, k)), v, w


def on_its_way(step: Step, v: FloatArray, w: FloatArray, place: FloatArray) -> FloatArray:
    """How a place (3,) m of the tool goes for each metre of the way: by where it is a little later and before."""
    turned = (Rotation.from_rotvec(sense * SHARE * w).apply(place) for sense in (1.0, -1.0))
    return v + np.subtract(*turned) / (2 * SHARE)


def about(step: Step, angle: float) -> tuple[FloatArray, FloatArray]:
    """The direction across the axis at an angle from the left of the feed, and the axis."""
    return np.sin(angle) * np.array(step[3:6]) + np.cos(angle) * np.array(step[6:9]), np.array(step[9:12])


@pytest.mark.parametrize("seed", range(3))
def test_a_flat_end_cuts_where_its_places_go_down_by_more_than_its_teeth_are_ground_hollow(seed: int) -> None:
    rng, seen = np.random.default_rng(seed), {True: 0, False: 0}
    for n in range(60):
        step, v, w = turning(rng, rng.uniform(-2.0, 1.0) * DISH, rng.uniform(1.2, 6.0) * DISH / R)
        assert rim_turns(step, R)
        angle = rng.uniform(0.0, 2 * np.pi)
        e, k = about(step, angle)
        begin, stop = cutting_end(FLAT.solid, step, np.sin(angle), np.cos(angle))
        for r in rng.uniform(0.0, R, 20):
            down = -on_its_way(step, v, w, r * e) @ k - DISH
            if abs(down) > 1e-6:
                assert (begin < r < stop) == (down > 0.0), n
                seen[down > 0.0] += 1
    assert min(seen.values()) > 100


def test_an_end_that_goes_straight_down_cuts_on_either_side_of_what_it_turns_about() -> None:
    """There no place goes otherwise than its axis: all of that radius cut, or none."""
    for dives, truth in ((-2.0 * DISH, (0.0, R)), (-0.5 * DISH, (R, R))):
        v, turn = np.array([np.sqrt(1.0 - dives**2), 0.0, dives]), np.array([2.0 * DISH / R, 0.0, 0.0])
        step = step_at(np.zeros(3), np.array([0.0, 0.0, 1.0]), v, np.zeros(3), (0.0, 1), turn)
        assert cutting_end(FLAT.solid, step, 0.0, 1.0) == truth


@pytest.mark.parametrize("cutter", MILLS)
def test_places_face_their_way_as_they_go_with_the_turning_tool(cutter: Cutter) -> None:
    """By the normal of the place and where the place goes; on the flank and on cones in the middle of a piece."""
    rng, shape, most = np.random.default_rng(2), cutter.solid, 0.0
    for _ in range(40):
        step, v, w = turning(rng, rng.uniform(-0.5, 0.5), rng.uniform(1.0, 40.0))
        angle = rng.uniform(0.0, 2 * np.pi)
        e, k = about(step, angle)
        for stretch in (END, NOSE, FLANK):
            begin, stop = stretch_ends(shape, stretch, 9e-3)
            if stop <= begin:
                continue
            s, half = rng.uniform(begin, stop), 1e-4
            low, at, high = (on_profile(shape, stretch, each) for each in (s - half, s, s + half))
            middle = at.radius, low.height, high.height
            a, b = faces_of(shape, step, stretch, (np.sin(angle), np.cos(angle)), middle)
            way = on_its_way(step, v, w, at.radius * e + at.height * k)
            truth = way @ (at.sine * e - at.cosine * k)
            assert a * at.sine - b * at.cosine == pytest.approx(truth, abs=1e-6)
            most = max(most, abs(way - v).max())
    assert most > 0.1
