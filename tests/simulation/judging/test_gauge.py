"""What a gauge reads: against outlines drawn by another library, and against parts whose errors are plain to see."""

from __future__ import annotations

import dataclasses
from collections import Counter

import numpy as np
import pytest
import shapely

from robomill.arrays import FloatArray
from robomill.cutting.tool import Cutter
from robomill.simulation.judging.gauge import Readings, gauge
from robomill.surface.stock import Stock
from tests.simulation.judging.pushed_runs import BLOCK, PARTS, SETUP, R, pushed, run


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


def test_a_blind_slot_has_a_wall_behind_its_begin_and_one_ahead_of_its_end():
    """Moved along its feed by 0.1 mm it leaves so much at the one and takes as much too much at the other."""
    ends = pushed(run("G0 X-15 Y0 Z5", "G1 Z-2 F300", "G1 X12 F1800"), along=0.1e-3).gauge.ends
    for x, out, left in ((-15e-3 - R, -1.0, 0.1e-3), (12e-3 + R, 1.0, -0.1e-3)):
        there = np.abs(ends.place[:, 0] - x) < 1e-9
        assert there.any()
        np.testing.assert_allclose(ends.out[there], np.tile([out, 0.0, 0.0], (there.sum(), 1)), atol=1e-12)
        np.testing.assert_allclose(ends.material_left[there], left, atol=1e-12)
    assert len({*np.round(ends.place[:, 0], 9).tolist()}) == 2
    np.testing.assert_allclose(ends.own, 0.1e-3, atol=1e-12)
