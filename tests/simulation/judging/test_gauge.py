"""What a gauge reads: against outlines drawn by another library, and against parts whose errors are plain to see."""

from __future__ import annotations

import dataclasses
from collections import Counter

import numpy as np
import pytest
import shapely

import robomill as rm
from robomill.arrays import FloatArray
from robomill.cutting.forces.along_path import PathForce
from robomill.cutting.tool import Cutter
from robomill.io.samples import samples_dir
from robomill.simulation.judging.gauge import Readings, gauge
from robomill.surface.stock import Stock
from robomill.toolpath.source import GCodeSource

R = 4e-3
BLOCK = Stock([-30e-3, -20e-3, -10e-3], [30e-3, 20e-3, 0.0])
SETUP = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(
    cell=5e-4, step=1e-3, stock=BLOCK, force=PathForce(feed_normal=10.0)
)


def run(*lines: str, **changes):
    text = "\n".join(["G21 G90 S12000 M3", *lines, "M2", ""])
    return rm.simulate(SETUP.replace(source=GCodeSource(text), **changes))


def pushed(result, along=0.0, left=0.0, up=0.0):
    """The run with another deviation (m), given in the axes of the cut: numbers, or one a sample."""
    m = len(result.path)
    d = np.stack([np.broadcast_to(v, (m,)) for v in (along, left, up)], axis=1)
    d = np.where(result.path.cutting[:, None], d, 0.0)
    return dataclasses.replace(result, delta=np.einsum("mij,mj->mi", result.R_MF, d))


def swept(p, cutting, depth) -> shapely.Geometry:
    """What a flat mill covers at a depth, as a polygon of many corners."""
    pieces = []
    for a, b, on in zip(p[:-1], p[1:], cutting[1:], strict=True):
        if on and 0.5 * (a[2] + b[2]) < depth:
            line = shapely.LineString([a[:2], b[:2]]) if np.hypot(*(a - b)[:2]) > 0 else shapely.Point(a[:2])
            pieces.append(line.buffer(R, quad_segs=400))
    return shapely.union_all(pieces)


def beyond(covered, point, u) -> float:
    """How far from a point along u what is covered reaches, where it covers the tool around the point."""
    ray = shapely.LineString([point - 3e-3 * u, point + 3e-3 * u])
    inside = shapely.intersection(covered, ray)
    for piece in getattr(inside, "geoms", [inside]):
        ends = [(np.array(c) - point) @ u for c in piece.coords]
        if min(ends) < -2.9e-3:
            return max(ends)
    return np.nan


def truth(result, depth):
    """Signed wall errors by polygons: (sample, error), left of the feed +."""
    told = swept(result.path.p, result.removes, depth)
    left = swept(result.p_machined, result.removes, depth)
    stock = shapely.box(*BLOCK.lower[:2], *BLOCK.upper[:2])
    found = {}
    for i in np.flatnonzero(result.judged & (result.path.step_length > 0)):
        p = result.path.p
        e = (p[i] - p[i - 1])[:2] / np.linalg.norm((p[i] - p[i - 1])[:2])
        for sign in (1.0, -1.0):
            u = sign * np.array([-e[1], e[0]])
            rim = p[i, :2] + R * u
            beside = shapely.Point(rim + 2e-5 * u)
            if not shapely.contains(stock, beside) or shapely.contains(told, beside):
                continue
            found[i, sign] = sign * (beyond(left, rim, u) - beyond(told, rim, u))
    return found


PARTS = {
    "slot": ["G0 X-40 Y0 Z5", "G0 Z-2", "G1 X20 F1800"],
    "shoulder": ["G0 X-40 Y-18 Z5", "G0 Z-2", "G1 X40 F1800"],
    "rough and finish": ["G0 X-40 Y-1 Z5", "G0 Z-2", "G1 X40 F1800", "G0 Z5", "G0 X-40 Y0", "G0 Z-2", "G1 X40 F1800"],
    "spring pass": ["G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F1800", "G1 X-40"],
    "arc": ["G0 X-20 Y-10 Z5", "G0 Z-2", "G1 X0 F1800", "G3 X0 Y10 J10", "G1 X-20"],
    "crossing": ["G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F1800", "G0 Z5", "G0 X0 Y-30", "G0 Z-2", "G1 Y30"],
    "rib": ["G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F1800", "G0 Z5", "G0 Y9.2", "G0 Z-2", "G1 X-40"],
}


@pytest.mark.parametrize("name", PARTS)
def test_walls_stand_where_the_polygons_end(name):
    result = run(*PARTS[name])
    rng = np.random.default_rng(3)
    s = result.path.s / result.path.s[-1]
    wave = [0.2e-3 * rng.uniform(-1, 1) + 0.1e-3 * np.sin(2 * np.pi * s + 6 * rng.uniform()) for _ in range(2)]
    bent = pushed(result, wave[0], wave[1], -0.05e-3)
    expected = truth(bent, -1.9e-3)
    walls = bent.gauge.walls
    _, ends = (
        (bent.path.cutting & ~np.append(False, bent.path.cutting[:-1])),
        bent.path.cutting & ~np.append(bent.path.cutting[1:], False),
    )
    found = {}
    for i, error, length in zip(walls.sample, walls.error, walls.length, strict=True):
        if length > 0 and not ends[i]:
            found.setdefault(i, []).append(error)
    found = {i: np.unique(np.round(errors, 12)).tolist() for i, errors in found.items()}
    assert sum(map(len, found.values())) > 15
    places = {}
    for (i, _), error in expected.items():
        if not ends[i] and np.isfinite(error):
            places.setdefault(i, []).append(error)
    compared = 0
    for i in set(found) & set(places):
        for error in places[i]:
            compared += min(abs(error - other) for other in found[i]) < 1.5e-6
    assert compared > 0.95 * sum(map(len, places.values()))


def test_a_straight_slot_is_off_by_the_tips_own_deviation():
    bent = pushed(run(*PARTS["slot"]), along=-0.1e-3, left=0.21e-3, up=-0.12e-3)
    verdict = bent.verdict
    assert verdict.wall.value == pytest.approx(0.21e-3, abs=1e-9)
    assert verdict.floor.value == pytest.approx(-0.12e-3, abs=1e-9)
    assert verdict.feed.value == pytest.approx(-0.1e-3, abs=1e-9)
    assert verdict.share == pytest.approx(0.7)
    assert verdict.level == "ok"
    section = bent.groove(30e-3)
    assert section.centre_offset == pytest.approx(verdict.wall.value, abs=1e-7)
    assert section.floor_error == pytest.approx(verdict.floor.value, abs=1e-7)


def test_pure_feed_force_is_green_on_a_straight_groove_and_moves_its_end():
    bent = pushed(run(*PARTS["slot"]), along=-0.9e-3)
    assert bent.max_deviation == pytest.approx(0.9e-3)
    verdict = bent.verdict
    assert (verdict.level, verdict.red) == ("ok", False)
    assert abs(verdict.wall.value) < 1e-9
    assert abs(verdict.floor.value) < 1e-9
    assert verdict.feed.value == pytest.approx(-0.9e-3)
    # it starts in the air and ends in the block
    assert verdict.end.value == pytest.approx(-0.9e-3)
    assert set(bent.gauge.ends.sample.tolist()) == {len(bent.path) - 1}
    three = dataclasses.replace(bent, setup=bent.setup.replace(tolerance={"wall": 0.3e-3, "feed": 0.5e-3}))
    assert three.verdict.level == "out"
    assert three.verdict.share == pytest.approx(1.8)
    through = pushed(run("G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F1800"), along=-0.9e-3)
    assert through.verdict.end.worst == -1


def test_at_a_corner_the_feed_error_is_a_wall_error():
    lines = ["G0 X-40 Y0 Z5", "G0 Z-2", "G1 X10 F1800", "G1 Y40"]
    bent = pushed(run(*lines), along=0.25e-3)
    assert bent.verdict.wall.value == pytest.approx(0.25e-3, abs=2e-6) or bent.verdict.wall.value == pytest.approx(
        -0.25e-3, abs=2e-6
    )
    assert bent.path.p[bent.verdict.wall.worst, :2] == pytest.approx([10e-3, 0.0], abs=1e-9)
    only = pushed(run(*lines), along=np.where(run(*lines).path.block == 4, 0.25e-3, 0.0))
    assert only.verdict.wall.value == pytest.approx(0.25e-3, abs=2e-6)  # straight ahead: along the feed +, as ends are


def test_a_mirrored_part_has_the_same_errors_on_its_other_sides():
    """Corners to both sides, all of it aside: what lies to the left lies to the right in the mirror. Straight ahead and
    behind, at two heights, stay what they are."""
    points = [(-10, -10), (0, 10), (10, -10), (12, 10), (40, 10)]
    found = []
    for side in (1, -1):
        lines = ["G0 X-40 Y" + f"{-10 * side} Z5", "G0 Z-2", *(f"G1 X{x} Y{side * y} F1800" for x, y in points)]
        found.append(pushed(run(*lines), left=side * 0.2e-3).gauge.walls)
    one, other = found
    np.testing.assert_array_equal(np.sort(one.sample), np.sort(other.sample))
    for i in np.unique(one.sample):
        here, there = (
            Counter(np.round(s * each.error[each.sample == i] * 1e8).tolist()) for s, each in zip((1, -1), found)
        )
        assert (here - there).total() <= 4
    assert one.error.min() < -0.1e-3 < 0.1e-3 < one.error.max()


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


def test_facing_leaves_a_floor_and_no_wall():
    wide = SETUP.cutter.replace(diameter=60e-3)
    lines = ["G0 X-80 Y0 Z5", "G0 Z-1", "G1 X80 F1800"]
    bent = pushed(run(*lines, cutter=wide), left=0.5e-3, up=0.02e-3)
    assert bent.verdict.wall.worst == -1
    assert np.isnan(bent.verdict.wall.value)
    assert bent.verdict.floor.value == pytest.approx(0.02e-3)
    assert bent.verdict.level == "ok"


@pytest.mark.parametrize(("y", "side"), [(-18.0, 1), (18.0, -1)])
def test_a_shoulder_has_one_wall_where_material_stays(y, side):
    result = run(f"G0 X-40 Y{y} Z5", "G0 Z-2", "G1 X40 F1800")
    walls = pushed(result, left=side * 0.1e-3).gauge.walls
    assert walls.length.sum() == pytest.approx(60e-3, abs=1.5e-3)
    np.testing.assert_allclose(walls.error, side * 0.1e-3)


def test_what_a_later_pass_removes_is_not_on_the_part():
    """A rough pass 0.2 mm beside and 0.1 mm above what the last one makes; its own error does not reach through."""
    lines = ["G0 X-40 Y-0.2 Z5", "G0 Z-1.9", "G1 X40 F1800", "G0 Z5", "G0 X-40 Y0.2", "G1 Z-1.9", "G1 X40"]
    lines += ["G0 Z5", "G0 X-40 Y-0.4", "G0 Z-2", "G1 X40", "G0 Z5", "G0 X-40 Y0.4", "G0 Z-2", "G1 X40"]
    result = run(*lines)
    rough = result.path.block < 10
    bent = pushed(result, left=np.where(rough, 0.15e-3, 0.02e-3), up=np.where(rough, -0.08e-3, -0.01e-3))
    assert bent.verdict.wall.value == pytest.approx(0.02e-3, abs=1e-8)
    assert bent.verdict.floor.value == pytest.approx(-0.01e-3, abs=1e-8)
    assert bent.max_deviation > 0.15e-3
    # and one that does reach through is seen: 0.35 mm aside where 0.2 mm were left to the last pass
    deep = pushed(result, left=np.where(rough, 0.35e-3, 0.02e-3))
    assert deep.verdict.wall.value == pytest.approx(0.15e-3, abs=1e-8)


def test_a_hole_is_judged_by_where_it_stands():
    result = run("G0 X0 Y0 Z5", "G1 Z-6 F600", "G0 Z5")
    bent = pushed(result, along=0.12e-3, left=0.05e-3, up=0.03e-3)
    assert abs(bent.verdict.wall.value) == pytest.approx(0.13e-3, rel=0.02)
    assert bent.verdict.level == "unjudged"  # a force stated along the path says nothing of a plunge


@pytest.mark.parametrize("steep", [62.0, 75.0, 88.0])
def test_what_a_steep_climb_is_off_along_its_own_way_moves_no_wall(steep):
    """What a cutter covers that is moved along its straight way is the same, but for its ends."""
    rise, way = np.radians(steep), 9.0 / np.sin(np.radians(steep))
    there = f"X{way * np.cos(rise):.6f} Z1"
    result = run("G0 X-40 Y0 Z5", "G0 Z-8", "G1 X0 F1000", f"G1 {there}", "G0 Z5")
    climb = result.conditions.along > 0.5
    assert climb.any()
    for back, left in ((0.2e-3, 0.0), (0.2e-3, 0.05e-3)):
        moved = pushed(result, -back * np.cos(rise) * climb, left * climb, -back * np.sin(rise) * climb)
        walls = gauge(moved).walls
        of = walls.error[climb[walls.sample]]
        assert len(of) > 0
        assert np.abs(of).max() == pytest.approx(left, abs=1e-6)


def test_a_tilted_slot_is_judged_in_the_tools_own_axes():
    """A slot 2 mm deep with the tool leaning 10 degrees along the feed."""
    lines = ["G0 X-40 Y0 Z8 B10", "G0 Z-2", "G1 X20 F1800"]
    bent = pushed(run(*lines), left=0.2e-3, up=-0.05e-3)
    assert bent.path.k[-1] == pytest.approx([np.sin(np.radians(10)), 0, np.cos(np.radians(10))])
    assert bent.verdict.wall.value == pytest.approx(0.2e-3, abs=1e-7)
    # Its heel leaves a floor that is round across the feed: moved aside, it stands a little higher over its middle.
    lifted = np.sin(np.radians(10)) * (R - np.sqrt(R**2 - 0.2e-3**2))
    assert bent.verdict.floor.value == pytest.approx(-0.05e-3 * np.cos(np.radians(10)) + lifted, abs=1e-7)


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


def test_walls_count_by_their_length():
    bent = pushed(run(*PARTS["slot"]), left=0.4e-3)
    assert bent.verdict.wall.share_out == 1.0
    assert bent.verdict.level == "out"
    half = pushed(run(*PARTS["slot"]), left=np.where(run(*PARTS["slot"]).path.p[:, 0] > -5e-3, 0.4e-3, 0.1e-3))
    assert half.verdict.wall.share_out == pytest.approx(0.5, abs=0.03)


@pytest.mark.parametrize("corner", [0.5e-3, 1.5e-3])
def test_a_slot_has_as_much_wall_whatever_the_corner_of_its_cutter(corner):
    """Both sides from the edge of the block to where the cutter's axis stops."""
    bull = Cutter("bull", 2 * R, corner_radius=corner)
    walls = gauge(pushed(run(*PARTS["slot"], cutter=bull), left=0.1e-3)).walls
    assert walls.length.sum() == pytest.approx(2 * 50e-3, abs=2.5e-3)
    assert walls.length[walls.error > 0.09e-3].sum() == pytest.approx(walls.length.sum())


def readings(error: FloatArray, length: FloatArray, height: FloatArray) -> Readings:
    """Readings of which nothing else matters."""
    m, rows = len(error), np.zeros((len(error), 3))
    return Readings(np.arange(m), error, length, height, error, rows, rows, rows, np.ones(m))


def test_a_share_is_of_the_length():
    error = np.array([0.1, -0.3, 0.2, -0.2])
    found = readings(error, np.array([1.0, 2, 4, 8]), np.array([0.5, 3, 0.25, 0.1]))
    assert found.share_out(0.15) == pytest.approx(14 / 15)
    assert found.share_out(0.3) == 0.0
    # A single place that stands for no length of its own is still out: a ten-thousandth, and all where nothing else is.
    single = readings(np.array([0.1, 0.4]), np.array([5.0, 0.0]), np.ones(2))
    assert single.share_out(0.3) == pytest.approx(1e-4)
    assert readings(np.array([0.4]), np.zeros(1), np.ones(1)).share_out(0.3) == 1.0
    assert found.worst == 1


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


def test_the_line_is_that_of_the_pass_that_made_the_surface():
    """One track at two depths: the deeper pass is further off, and both walls and the floor are its work."""
    lines = ["G0 X-40 Y0 Z5", "G0 Z-1.2", "G1 X20 F1800", "G0 Z5", "G0 X-40", "G0 Z-3", "G1 X20"]
    result = run(*lines)
    deep = result.path.block == 8
    bent = pushed(result, left=np.where(deep, 0.278e-3, 0.185e-3), up=np.where(deep, -0.14e-3, -0.05e-3))
    assert bent.verdict.wall.value == pytest.approx(0.278e-3, abs=1e-6)
    assert bent.verdict.floor.value == pytest.approx(-0.14e-3, abs=1e-6)
    assert result.path.block[bent.verdict.wall.worst] == 8
    assert result.path.block[bent.verdict.floor.worst] == 8


def test_the_floor_of_a_leaning_ball_is_its_lowest_point():
    """A ball's lowest point moves as its tip does: the floor is off by the upward part of the deviation."""
    ball = Cutter(kind="ball", diameter=6e-3)
    result = run("G0 X-40 Y0 Z8 A-15", "G0 Z-2", "G1 X20 F1800", cutter=ball)
    shift = np.where(result.path.cutting[:, None], [0.0, 0.2e-3, -0.125e-3], 0.0)
    bent = dataclasses.replace(result, delta=shift @ result.setup.T_MW[:3, :3].T)
    assert bent.verdict.floor.value == pytest.approx(bent.groove(40e-3).floor_error, abs=10e-6)
    assert bent.verdict.floor.value < -0.1e-3


@pytest.mark.parametrize("cycle", ["G81 Z-8 R2 F300", "G83 Z-8 R2 Q3 F300"])
def test_a_drilled_hole_has_a_depth_and_a_place(cycle):
    """The tip of the cone is aside and too high at the bottom only; further up it is elsewhere."""
    drill = Cutter(kind="drill", diameter=8e-3, flutes=2, tip_angle=np.radians(118.0))
    result = run("G0 X0 Y0 Z5", cycle, "G80", cutter=drill)
    deep = -result.path.p[:, 2] / 8e-3
    bent = pushed(result, left=0.1e-3, up=np.where(deep > 0.999, 0.35e-3, 0.05e-3))
    assert bent.verdict.floor.value == pytest.approx(0.35e-3)
    assert abs(bent.verdict.wall.value) == pytest.approx(0.1e-3)
    assert bent.verdict.level == "out"


def test_a_block_drawn_as_a_mesh_is_gauged_as_the_block():
    trimesh = pytest.importorskip("trimesh")
    solid = trimesh.creation.box(bounds=[BLOCK.lower, BLOCK.upper])
    drawn = Stock(BLOCK.lower, BLOCK.upper, np.asarray(solid.triangles))
    lines = ("G0 X-40 Y17 Z5", "G0 Z-3", "G1 X40 F1800", "G0 Z5")  # beside the edge, and out at both ends
    for name in ("walls", "floors", "ends"):
        one, two = (getattr(pushed(run(*lines, stock=stock), left=0.1e-3).gauge, name) for stock in (BLOCK, drawn))
        np.testing.assert_allclose(two.error, one.error, atol=1e-9)
        np.testing.assert_allclose(two.height, one.height, atol=1e-9)


def some_program(seed: int) -> list[str]:
    """Slots, ramps, helices and plunges at several depths that cross each other."""
    rng = np.random.default_rng(seed)
    lines = ["G17", "G0 X-30 Y-25 Z5"]
    for _ in range(int(rng.integers(2, 5))):
        x, y = rng.uniform(-15, 15, 2)
        z, kind = -rng.choice([1, 1.5, 2, 3]), rng.integers(0, 4)
        lines += ["G0 Z5", f"G0 X{x:.2f} Y{y:.2f}"]
        to_x, to_y = np.array([x, y]) + np.clip(rng.uniform(-20, 20, 2), [-17 - x, -17 - y], [17 - x, 17 - y])
        lines += [
            [f"G1 Z{z} F300", f"G1 X{to_x:.2f} Y{to_y:.2f} F900"],
            ["G1 Z0.5 F900", f"G1 X{to_x:.2f} Y{to_y:.2f} Z{z}", f"G1 X{x:.2f} Y{y:.2f}"],
            ["G1 Z0 F900", f"G2 X{x:.2f} Y{y:.2f} Z{z} I2 J0", f"G2 X{x:.2f} Y{y:.2f} I2 J0"],
            [f"G1 Z{z} F300", "G1 Z5"],
        ][kind]
    return [*lines, "G0 Z20"]


@pytest.mark.parametrize("seed", [1, 5, 10, 14, 29])
def test_a_part_that_is_moved_as_a_whole_is_off_by_what_it_was_moved(seed):
    """Where every step is off by the same vector the part is the commanded one, moved: floors stand as high as it went
    up, and no wall is further off than it went sideways, whatever steps and lips lie between the depths."""
    shift = np.random.default_rng(seed).uniform(-1.0, 1.0, 3) * [0.25e-3, 0.25e-3, 0.2e-3]
    made = run(*some_program(seed), stock=Stock([-22e-3, -22e-3, -10e-3], [22e-3, 22e-3, 0.0]))
    cuts = made.path.cutting[:, None]
    made = dataclasses.replace(made, delta=np.where(cuts, SETUP.T_MW[:3, :3] @ shift, 0.0), unjudged=())
    np.testing.assert_allclose(made.gauge.floors.error, shift[2], atol=1e-8)
    walls, aside = made.gauge.walls.error, float(np.hypot(*shift[:2]))
    assert np.abs(walls).max() <= aside + 1e-9
    assert np.abs(walls).max() > 0.8 * aside


def test_a_step_between_two_depths_that_has_moved_aside_is_no_floor():
    """A slot 3 mm deep ends in one 2 mm deep; pulled back 0.2 mm, its last 0.2 mm stay 1 mm too high: the wall of the
    step, not a floor."""
    made = run("G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F900", "G0 Z5", "G0 X-40", "G0 Z-3", "G1 X0", "G0 Z5")
    found = pushed(made, along=np.where(made.path.p[:, 2] < -2.5e-3, -0.2e-3, 0.0), up=10e-6).gauge
    np.testing.assert_allclose(found.floors.error, 10e-6, atol=1e-8)


def test_a_thin_wall_that_two_passes_cut_away_is_off_by_no_more_than_they_are():
    """Two slots 8.1 mm apart leave 0.1 mm between them; each 0.2 mm towards the other takes it away."""
    made = run("G0 X-40 Y4.05 Z5", "G0 Z-2", "G1 X40 F900", "G0 Z5", "G0 X-40 Y-4.05", "G0 Z-2", "G1 X40")
    to_each_other = np.where(made.path.p[:, 1] > 0.0, -0.2e-3, 0.2e-3)
    walls = pushed(made, left=to_each_other).gauge.walls
    assert np.abs(walls.error).max() == pytest.approx(0.2e-3, abs=1e-9)


@pytest.mark.parametrize("y", [0.0, -19.0])
def test_a_cut_through_the_bottom_has_walls_as_high_as_the_stock_and_no_floor(y):
    plate = Stock([*BLOCK.lower[:2], -2e-3], BLOCK.upper)
    result = pushed(run(f"G0 X-40 Y{y} Z5", "G0 Z-2.5", "G1 X40 F900", stock=plate), left=0.2e-3, up=-0.1e-3)
    found = result.gauge
    assert "too deep" not in result.verdict.sentence
    assert "too high" not in result.verdict.sentence
    np.testing.assert_allclose(found.walls.error, 0.2e-3, atol=1e-8)
    np.testing.assert_allclose(found.walls.height, 2e-3, atol=1e-9)
    assert len(found.floors.error) == 0


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


@pytest.mark.parametrize("name", PARTS)
def test_floors_of_a_sample_stand_for_its_length_together_and_so_does_each_wall(name):
    """However many places and heights are looked at."""
    bent = pushed(run(*PARTS[name]), left=0.1e-3, up=-0.05e-3)
    found, length = bent.gauge, bent.path.step_length
    places = np.bincount(found.floors.sample, minlength=len(length))
    assert places.max() > 2
    over = np.bincount(found.floors.sample, found.floors.length, minlength=len(length))
    np.testing.assert_allclose(over[places > 0], length[places > 0], atol=1e-12)
    if name in ("slot", "spring pass", "rib"):  # both walls stand
        beside = np.bincount(found.walls.sample, found.walls.length, minlength=len(length))
        np.testing.assert_allclose(beside[places > 0], 2 * length[places > 0], atol=1e-12)


@pytest.mark.parametrize("kind", ["flat", "chamfer", "ball"])
def test_an_error_goes_with_the_tip_as_its_way_says(kind):
    """By differences: the same slot, which ends in the block, pushed along, to the left and up by 1 um."""
    cutter = Cutter(kind, 2 * R, tip_angle=np.radians(70.0) if kind == "chamfer" else None)
    slot = run("G0 X-40 Y0 Z5", "G0 Z-2", "G1 X3 F600", "G0 Z5", cutter=cutter)
    still = gauge(pushed(slot))
    assert all(len(kind.error) for kind in (still.walls, still.floors, still.ends))
    for axis, name in enumerate(("along", "left", "up")):
        moved = gauge(pushed(slot, **{name: 1e-6}))
        for before, after in zip((still.walls, still.floors, still.ends), (moved.walls, moved.floors, moved.ends)):
            np.testing.assert_array_equal(before.sample, after.sample)
            np.testing.assert_allclose(after.error - before.error, 1e-6 * before.way[:, axis], atol=2e-8)


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


@pytest.mark.parametrize("name", ["slot", "rib"])
def test_a_reading_knows_where_it_was_taken_and_what_was_left_there(name):
    """Pushed left: on the left too much went, on the right material was left; each wall is a radius from the tip."""
    bent = pushed(run(*PARTS[name]), left=0.1e-3, up=-0.05e-3)
    walls, floors = bent.gauge.walls, bent.gauge.floors
    tip = bent.path.p[walls.sample]
    whole = walls.length > 0.0
    np.testing.assert_allclose(np.linalg.norm((walls.place - tip)[whole, :2], axis=1), R, atol=1e-9)
    np.testing.assert_allclose((walls.place - tip)[whole, :2] / R, walls.out[whole, :2], atol=1e-6)
    left_of = np.cross([0.0, 0.0, 1.0], bent.path.p[walls.sample] - bent.path.p[walls.sample - 1])
    on_left = np.einsum("qi,qi->q", walls.out, left_of) > 0.0
    np.testing.assert_array_equal(np.sign(walls.material_left[whole]), np.where(on_left, -1.0, 1.0)[whole])
    np.testing.assert_allclose(floors.place[:, 2], -2e-3, atol=1e-9)
    np.testing.assert_allclose(floors.material_left, -0.05e-3, atol=1e-9)
