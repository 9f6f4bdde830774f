"""What a round nose leaves between wall and floor, against the distance between two arcs."""

from __future__ import annotations

import dataclasses
from itertools import pairwise

import numpy as np
import pytest

from robomill.arrays import FloatArray
from robomill.cutting.tool import Cutter
from robomill.simulation.judging.places import stock_top
from tests.simulation.judging.pushed_runs import R, pushed, run

NOSES = {"ball": R, "bull": 1.5e-3}


def furthest(rho: float, depth: float, left: float, up: float) -> float:
    """How far an arc of radius rho is from the same one moved by (left, up), anywhere between the floor and the end of
    the nose, or of the material, on either side: by Euclid, from its centre."""
    most = 0.0
    for side in (1.0, -1.0):
        turn = np.linspace(0.0, np.arccos(max(0.0, 1.0 - depth / rho)), 2001)
        at = np.column_stack([side * np.sin(turn), -np.cos(turn)]) * rho
        most = max(most, float(np.abs(np.hypot(*(at - [left, up]).T) - rho).max()))
    return most


@pytest.mark.parametrize("kind", NOSES)
@pytest.mark.parametrize("depth", [1.0e-3, 3.0e-3, 6.0e-3])
@pytest.mark.parametrize(("left", "up"), [(0.1e-3, 0.1e-3), (-0.1e-3, 0.1e-3), (0.06e-3, -0.12e-3), (0.12e-3, 0.03e-3)])
def test_a_nose_is_read_between_wall_and_floor(kind: str, depth: float, left: float, up: float) -> None:
    """It is off most where its surface faces the way that the tip is off; deep slots hid that behind their walls."""
    cutter = Cutter(kind, 2 * R, corner_radius=NOSES[kind])
    result = run("G0 X-40 Y0 Z5", f"G0 Z{-1e3 * depth}", "G1 X40 F1800", cutter=cutter)
    found = pushed(result, left=left, up=up).verdict
    assert max(abs(found.wall.value), abs(found.floor.value)) == pytest.approx(
        furthest(NOSES[kind], depth, left, up),
        rel=0.04,  # it is read up to 95 % of the depth
    )


def test_a_pass_beside_it_takes_the_nose_away() -> None:
    """A second pass, 3 mm to the left, leaves the nose of the first one on the right only."""
    cutter = Cutter("bull", 2 * R, corner_radius=1.5e-3)
    lines = ("G0 X-40 Y0 Z5", "G0 Z-3", "G1 X40 F1800", "G0 Z5", "G0 X-40 Y3", "G0 Z-3", "G1 X40")
    result = run(*lines, cutter=cutter)
    off = np.where(result.path.p[:, 1] > 1e-3, 0.0, 0.1e-3)
    # Up and to the right: further away than either from what stood on the left, which is gone.
    assert abs(pushed(result, left=-off, up=off).verdict.wall.value) == pytest.approx(0.1e-3, rel=0.01)
    assert pushed(result, left=off, up=off).verdict.wall.value == pytest.approx(np.sqrt(2.0) * 0.1e-3, rel=0.03)


@pytest.mark.parametrize("kind", [*NOSES, "flat"])
def test_how_far_a_groove_is_off_in_y_is_not_said_of_what_is_off_normal_to_a_nose(kind: str) -> None:
    """Pushed aside and up by 0.1 mm each, a nose leaves what is 0.14 mm off, its groove is 0.1 mm off in Y."""
    result = run(
        "G0 X-40 Y0 Z5", "G0 Z-3", "G1 X40 F1800", cutter=Cutter(kind, 2 * R, corner_radius=NOSES.get(kind, 0.0))
    )
    sentence = pushed(result, left=0.1e-3, up=0.1e-3).verdict.sentence
    said = "The groove is 0.10 mm off in Y" if kind == "flat" else "Walls are up to 0.14 mm to the left"
    assert sentence.startswith(said)


def test_a_cone_is_read_below_a_rim_that_another_pass_has_cut_away() -> None:
    """A 90 degree mill goes 2 mm deep between grooves whose sides meet its own 1.25 mm above its tip. Up to there its
    sides stand, and are off by (0.1 + 0.1) mm / sqrt(2) where it is pushed aside and up."""
    cutter = Cutter("chamfer", 2 * R, tip_angle=np.radians(90.0), tip_diameter=2e-3)
    lines = ["G0 X-40 Y0 Z5", "G0 Z-2", "G1 X40 F1800", "G0 Z5"]
    for y in (3.5, -3.5):
        lines += [f"G0 X-40 Y{y}", "G0 Z-1", "G1 X40", "G0 Z5"]
    result = run(*lines, cutter=cutter)
    off = np.where(np.abs(result.path.p[:, 1]) < 1e-3, 0.1e-3, 0.0)
    assert abs(pushed(result, left=off, up=off).verdict.wall.value) == pytest.approx(np.sqrt(2.0) * 0.1e-3, rel=0.02)


def ball_wall(p: np.ndarray, x: float, z: float, side: float) -> float:
    """How far from the axis of the path the wall of a ball stands at (x, z), m: where its sphere is widest there, of
    all places that its tip ``p`` (n, 3) goes through in straight lines."""
    share = np.linspace(0.0, 1.0, 1001)[:, None]
    tips = np.concatenate([a + share * (b - a) for a, b in pairwise(p) if abs(a[0] - x) < 2.0 * R])
    square = R * R - (z - tips[:, 2] - R) ** 2 - (x - tips[:, 0]) ** 2
    return float((side * tips[:, 1] + np.sqrt(np.maximum(square, 0.0)))[square > 0.0].max())


@pytest.mark.parametrize("lower", [0.0, 0.1e-3])
@pytest.mark.parametrize("before", [0.2, 0.5, 1.0])
def test_where_a_tool_is_lifted_as_it_enters_the_stock_the_wall_is_that_of_its_way(before: float, lower: float) -> None:
    """Within one step it is pushed aside and then up: a nose has other sides at each height, and moves that were taken
    at the height of their middle read 0.063 mm at the stock's edge where 0.023 mm are."""
    lines = (f"G0 X{-36 - before} Y0 Z5", "G0 Z-1.5", "G1 X36 F1800")
    result = run(*lines, cutter=Cutter("ball", 2 * R))
    x = result.path.p[:, 0]
    rises = np.searchsorted(x, -31e-3 - 1e-6)
    sample = np.arange(len(x))
    left = np.select([sample < rises, sample == rises], [0.0, 0.144e-3], 0.172e-3)
    up = np.select([sample < rises, sample == rises], [0.0, 0.038e-3], 0.167e-3) - lower
    result = pushed(result, left=left, up=up)
    walls, read = result.gauge.walls, 0
    for q in np.flatnonzero((walls.place[:, 0] < -28e-3) & (np.abs(walls.out[:, 1]) > 1.0 - 1e-9)):
        at, side = walls.place[q], np.sign(walls.out[q, 1])
        cut, told = result.p_machined[result.path.cutting], abs(at[1])
        aside = np.linspace(-0.2e-3, 0.2e-3, 41)
        stands = np.array([ball_wall(cut, at[0] + each, at[2], side) for each in aside]) - told
        straight = stands[20]
        nearest = np.sign(straight) * np.hypot(stands, aside).min()  # where the wall runs aslant
        low = R - (at[2] + 1.5e-3)
        across, along = (np.hypot(told + off, low) - R for off in sorted((nearest, straight)))
        assert across - 2.5e-6 <= -walls.material_left[q] <= along + 2.5e-6
        read += 1
    assert read > 4


@pytest.mark.parametrize("digit", [-1e-17, 0.0, 1e-17, 1e-12])
def test_a_place_on_the_edge_of_the_stock_is_read_whatever_its_last_digit(digit: float) -> None:
    result = run("G0 X-36 Y0 Z5", "G0 Z-1.5", "G1 X36 F1800", cutter=Cutter("ball", 2 * R))
    edge = np.array([[-30e-3 - digit, 0.0], [30e-3 + digit, 0.0], [-30e-3 - 2e-9, 0.0]])
    assert np.isfinite(stock_top(result.setup, edge)).tolist() == [True, True, False]


@pytest.mark.parametrize("up", [0.15e-3, -0.1e-3])
def test_a_nose_whose_axis_runs_just_beside_the_edge_is_read_right_next_to_it(up: float) -> None:
    """There what it leaves is all but level: off by as much as the tip is, up or down."""
    result = run("G0 X-40 Y-40 Z5", "G0 Y-20.04", "G0 Z-3.5", "G1 X40 F1800", cutter=Cutter("ball", 2 * R))
    reading = pushed(result, up=up).gauge.floors
    inside = np.abs(result.path.p[reading.sample, 0]) < 20e-3
    assert inside.sum() > 20
    assert np.abs(reading.error[inside]).max() == pytest.approx(abs(up), rel=1e-3)


@pytest.mark.parametrize("lean", ["B20", "A-20", "A15 B-25"])
@pytest.mark.parametrize(
    "to", [(20.0, 0.0, 0.0), (20.0, 8.0, 0.0), (-6.0, 15.0, 0.0), (16.0, 8.0, -2.0), (16.0, 8.0, 2.0)]
)
@pytest.mark.parametrize("off", [(0.15e-3, 0.1e-3, 0.0), (0.0, 0.0, 0.2e-3), (-0.2e-3, 0.1e-3, -0.1e-3)])
def test_a_ball_is_read_alike_however_it_leans(lean: str, to: tuple[float, float, float], off: FloatArray) -> None:
    """Pushed along the axes of the part, against an upright one whose sphere goes the same way."""
    ball = Cutter("ball", 2 * R)
    end = np.array([0.0, 0.0, -3.0]) + to
    leaning = run(f"G0 X0 Y0 Z8 {lean}", "G0 Z-3", "G1 X{:g} Y{:g} Z{:g} F1800".format(*end), cutter=ball)
    low = 1e3 * R * (leaning.path.k[-1] - [0.0, 0.0, 1.0])
    begin, end = ("X{:.9f} Y{:.9f} Z{:.9f}".format(*at) for at in (low - [0.0, 0.0, 3.0], end + low))
    found = []
    for made in (leaning, run("G0 Z8", "G0 " + begin.split(" Z")[0], f"G0 {begin}", f"G1 {end} F1800", cutter=ball)):
        delta = np.where(made.path.cutting[:, None], off, 0.0) @ made.setup.T_MW[:3, :3].T
        bent = dataclasses.replace(made, delta=delta)
        gauge = bent.gauge
        for read in (gauge.walls, gauge.floors, gauge.ends):  # what each makes of its own sample, by the run's own axes
            own = np.einsum("qi,qi->q", bent.delta_in_cut[read.sample], read.way)
            np.testing.assert_allclose(read.own, own, atol=1e-10)
        along = gauge.walls.length > 0.0
        found.append((gauge.floors.error, gauge.walls.error[along], gauge.walls.place[along]))
    assert min(len(each) for each in found[0]) > 10
    for leans, upright in zip(*found, strict=True):
        np.testing.assert_allclose(leans, upright, atol=1e-8)


@pytest.mark.parametrize("kind", ["bull", "chamfer"])
@pytest.mark.parametrize(("left", "up"), [(0.0, 0.05e-3), (0.05e-3, 0.0), (-0.04e-3, 0.06e-3)])
def test_along_the_edge_of_the_stock_what_is_beyond_the_flat_end_is_read_up_to_most_of_the_side(
    kind: str, left: float, up: float
) -> None:
    """The flat end runs outside; what stands over the edge is read in steps of a tenth at most, and is as far off as
    what the moved side leaves is from where each place was told to be, normal to its arc or line."""
    bull = kind == "bull"
    flat, angle = (
        (2.5e-3, {"corner_radius": 1.5e-3}) if bull else (1e-3, {"tip_angle": np.pi / 2, "tip_diameter": 2e-3})
    )
    y, depth = -20e-3 - flat + 1e-5, 2.8e-3
    cutter = Cutter(kind, 2 * R, **angle)
    result = run(f"G0 X-40 Y{1e3 * y:.5f} Z5", f"G0 Z{-1e3 * depth}", "G1 X40 F1800", cutter=cutter)
    read = pushed(result, left=left, up=up).gauge.floors
    assert len(read.error) > 100
    off, over = read.place[:, 1] - y, read.place[:, 2] + depth
    rho, aside = R - flat, off - flat
    np.testing.assert_allclose(np.hypot(aside, over - rho) if bull else over, rho if bull else aside, atol=1e-8)
    normal = (
        np.array([-aside, rho - over]) / rho if bull else np.array([-np.ones(len(off)), np.ones(len(off))]) / np.sqrt(2)
    )
    np.testing.assert_allclose(read.out, np.column_stack([np.zeros(len(off)), *-normal]), atol=0.015)
    np.testing.assert_allclose(read.error, [left, up] @ normal, atol=3e-6)
    share = (off[read.sample == np.median(read.sample)] - flat) / rho
    assert np.diff([0.0, *np.sort(share)]).max() < 0.1 + 1e-9
    assert share.max() > 0.7 - 1e-9
