"""The area that readings stand for: against polygons of another library, whatever comes by how often."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

import robomill as rm
from robomill.arrays import FloatArray
from robomill.cutting.forces.along_path import PathForce
from robomill.cutting.tool import Cutter
from robomill.io.samples import samples_dir
from robomill.simulation.judging.finished import Finished, Spread, _bend, _swept
from robomill.simulation.result import SimulationResult
from robomill.surface.stock import Stock
from robomill.toolpath.source import GCodeSource

R = 4e-3
BLOCK = Stock([-40e-3, -30e-3, -10e-3], [40e-3, 30e-3, 0.0])
SETUP = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(
    cell=5e-4, step=1e-3, stock=BLOCK, force=PathForce(feed_normal=10.0)
)


def rings(*sizes: tuple[float, float]) -> list[str]:
    """Rectangles about the middle, from the inside outwards."""
    return [
        line for x, y in sizes for line in (f"G1 X{x} Y0", f"G1 Y{y}", f"G1 X-{x}", f"G1 Y-{y}", f"G1 X{x}", "G1 Y0")
    ]


def layers(*depths: float, sizes: tuple[tuple[float, float], ...]) -> list[str]:
    """A pocket in layers, each entered by a plunge in the middle."""
    return [line for z in depths for line in ("G0 Z2", "G0 X0 Y0", f"G1 Z-{z} F300", *rings(*sizes))]


POCKET = ((3, 2), (6, 5), (9, 8), (12, 11), (16, 14))
ROUND = ["G1 X12 Y14 F900", "G3 X16 Y10 R4", "G1 Y-10", "G2 X18 Y-12 R2", "G1 X30"]
CUTS = {
    "pocket in one layer": (layers(3, sizes=POCKET), 3.0),
    "pocket in three layers": (layers(1, 2, 3, sizes=POCKET), 3.0),
    "pocket with a spring pass": (layers(1.5, 3, 3, sizes=POCKET), 3.0),
    "slot to and fro": (["G0 X-60 Y3 Z5", "G0 Z-2", "G1 X60 F900", "G1 X-60"], 2.0),
    "slot round bends": (["G0 X-20 Y14 Z5", "G1 Z-2 F300", *ROUND], 2.0),
    "slot round bends in layers": (
        ["G0 X-20 Y14 Z5", "G1 Z-2 F300", *ROUND, "G0 Z5", "G0 X-20 Y14", "G1 Z-4 F300", *ROUND],
        4.0,
    ),
    "side": (["G0 X-60 Y28 Z5", "G0 Z-3", "G1 X60 F900"], 3.0),
    "ring": (["G0 X15 Y0 Z5", "G1 Z-2 F300", "G2 I-15 J0 F900"], 2.0),
}


def run(*lines: str, **changes: object) -> SimulationResult:
    text = "\n".join(["G21 G90 S12000 M3", *lines, "M2", ""])
    return rm.simulate(SETUP.replace(source=GCodeSource(text), **changes))


def pushed(result: SimulationResult, left: FloatArray | float, up: float = 0.0) -> SimulationResult:
    """The run with another deviation at feed, m."""
    d = np.zeros((len(result.path), 3))
    d[:, 1], d[:, 2] = left, up
    d[~result.path.cutting] = 0.0
    return dataclasses.replace(result, delta=np.einsum("mij,mi->mj", result.R_MF.transpose(0, 2, 1), d))


def swept(result: SimulationResult) -> shapely.Geometry:
    """What a flat mill covers of the block, in plan."""
    p, steps = result.path.p, np.flatnonzero(result.removes)
    pieces = [shapely.LineString(p[i - 1 : i + 1, :2]).buffer(R, quad_segs=100) for i in steps]
    return shapely.intersection(shapely.union_all(pieces), shapely.box(*BLOCK.lower[:2], *BLOCK.upper[:2]))


@pytest.mark.parametrize("name", CUTS)
def test_floors_and_walls_have_the_area_of_the_part_that_is_left(name: str) -> None:
    """Of a level cut: what is covered, and its outline within the block times its depth."""
    lines, deep = CUTS[name]
    result = run(*lines)
    covered = swept(result)
    rim = shapely.box(*BLOCK.lower[:2], *BLOCK.upper[:2]).exterior.buffer(1e-6)
    walls = shapely.difference(shapely.boundary(covered), rim).length * deep * 1e-3
    found = result.finished
    assert found.floors.area.sum() == pytest.approx(covered.area, rel=0.03)
    # The round ends of a slot are walls across the end of a cut, which are not among these.
    ends = {"slot round bends": 2, "slot round bends in layers": 2}.get(name, 0) * np.pi * R * deep * 1e-3
    assert found.walls.area.sum() == pytest.approx(walls - ends, rel=0.06)
    assert result.area_out[1] == pytest.approx(found.floors.area.sum() + found.walls.area.sum())


def test_the_layers_of_a_pocket_have_each_their_slice_of_the_wall() -> None:
    """Pushed inwards by 0.1, 0.2 and 0.3 mm in layers that are 1, 2 and 3 mm high."""
    result = run(*layers(1, 3, 6, sizes=POCKET))
    z, level = result.path.p[:, 2], result.path.cutting & ~result.conditions.mostly_axial
    aside = np.where(z > -1.5e-3, 0.1e-3, np.where(z > -3.5e-3, 0.2e-3, 0.3e-3)) * level
    walls = pushed(result, aside).finished.walls
    straight, corners = 2 * (32e-3 + 28e-3), 2 * np.pi * R
    assert walls.area.sum() == pytest.approx(6e-3 * (straight + corners), rel=0.05)
    for error, high in ((0.1e-3, 1e-3), (0.2e-3, 2e-3), (0.3e-3, 3e-3)):
        area = walls.area[np.abs(walls.error - error) < 5e-6].sum()
        assert 0.88 * straight * high < area < (straight + corners) * high  # beside a corner less is read


def test_a_drilled_hole_has_its_floor_and_its_wall_once() -> None:
    result = run("G0 X0 Y0 Z5", "G1 Z-3 F300", "G0 Z1", "G0 Z-2.9", "G1 Z-6 F300")
    found = dataclasses.replace(result, delta=np.zeros((len(result.path), 3)), unjudged=()).finished
    assert found.floors.area.sum() == pytest.approx(np.pi * R**2, rel=0.03)
    assert found.walls.area.sum() == pytest.approx(2 * np.pi * R * 6e-3, rel=0.1)


def test_a_cut_through_the_block_has_walls_and_no_floor() -> None:
    found = run("G0 X-60 Y0 Z5", "G0 Z-11", "G1 X60 F900").finished
    assert found.floors.area.sum() == 0.0
    assert found.walls.area.sum() == pytest.approx(2 * 80e-3 * 10e-3, rel=0.03)


def test_every_cutter_has_its_own_width() -> None:
    """A ball leaves a floor beneath it as wide as it is, a larger flat mill one of its own."""
    for cutter, width in ((Cutter("ball", 6e-3), 6e-3), (Cutter("flat", 12e-3), 12e-3)):
        found = run("G0 X-60 Y0 Z5", "G0 Z-2", "G1 X60 F900", cutter=cutter).finished
        assert found.floors.area.sum() == pytest.approx(width * 80e-3, rel=0.02)


def test_the_histogram_of_a_straight_slot_is_its_two_walls_and_its_floor() -> None:
    """Pushed left by 0.1 mm and down by 0.05 mm: the 2 x 80 mm of wall, 2 mm high, and 80 x 8 mm of floor."""
    found = pushed(run("G0 X-60 Y0", "G0 Z-2", "G1 X60 F600"), 1e-4, -5e-5).finished
    edges = np.array([-2e-4, -7.5e-5, -2.5e-5, 7.5e-5, 1.25e-4])
    walls, floors = found.walls.histogram(edges), found.floors.histogram(edges)
    assert walls == pytest.approx([0.0, 0.0, 0.0, 2 * 80e-3 * 2e-3], rel=0.02)
    assert floors == pytest.approx([0.0, 80e-3 * 8e-3, 0.0, 0.0], rel=0.02)
    assert found.walls.histogram(edges / 4)[-1] == walls[-1], "what is beyond is in the outer bin"
    area = walls[-1] + floors[1]
    assert found.rms == pytest.approx(np.sqrt((1e-8 * walls[-1] + 2.5e-9 * floors[1]) / area), rel=1e-6)


def spread(*cells: int) -> Spread:
    """Readings of (error in um, area) each."""
    error, area = np.array(cells, dtype=float).reshape(-1, 2).T
    return Spread(error * 1e-6, area)


def test_walls_and_floors_are_spread_by_area() -> None:
    """Each reading as many times as it has square metres: a plain root of the mean square of all of them."""
    walls, floors = spread(40, 6, -25, 4), spread(-90, 10)
    found = Finished(walls, floors)
    every = 1e-6 * np.repeat([40.0, -25.0, -90.0], [6, 4, 10])
    assert found.rms == pytest.approx(np.sqrt(np.mean(every**2)))
    assert np.isnan(Finished(spread(), spread()).rms)
    for tolerance, limit in ((20e-6, 60e-6), (50e-6, 94.5e-6), (85e-6, 97.75e-6)):
        edges = found.edges(tolerance, 10)
        np.testing.assert_allclose(edges, np.linspace(-limit, limit, 11), atol=1e-18)
        assert walls.histogram(edges).sum() + floors.histogram(edges).sum() == pytest.approx(20.0)


def test_what_is_out_has_its_area_and_is_never_nothing() -> None:
    found = spread(100, 5, -300, 60, 200, 10, -200, 8)
    assert found.out(300e-6) == pytest.approx((0.0, 83.0))
    assert found.out(250e-6) == pytest.approx((60.0, 83.0))
    assert found.out(150e-6) == pytest.approx((78.0, 83.0))
    # A place between samples that stands for no area of its own is still out: a ten-thousandth.
    assert spread(100, 5, 400, 0).out(300e-6) == pytest.approx((5e-4, 5.0))


def test_a_path_bends_at_its_corners_half_before_and_half_after() -> None:
    """To the left +; not where a cut begins or ends, nor between two cuts, whichever way they go, nor in a plunge."""
    made = rm.simulate(
        SETUP.replace(
            source=GCodeSource(
                "G21 G90 S12000 M3\nG0 X-20 Y-10 Z5\nG1 Z-2 F300\nG1 X0 F1800\nY10\nX-10 Y20\nG0 Z5\n"
                "G0 X20 Y0\nG0 Z-2\nG1 X10\nX20 Y-10\nM2\n"
            )
        )
    )
    bend, block = np.degrees(_bend(made)), made.path.block
    for line, first, last in ((4, 0.0, 45.0), (5, 45.0, 22.5), (6, 22.5, 0.0), (10, 0.0, 67.5), (11, 67.5, 0.0)):
        on = bend[(block == line) & (made.path.step_length > 0.0)]
        assert (on[0], on[-1]) == pytest.approx((first, last), abs=1e-6)
        np.testing.assert_allclose(on[1:-1], 0.0, atol=1e-6)
    assert not bend[~np.isin(block, (4, 5, 6, 10, 11))].any()


@pytest.mark.parametrize("seed", range(6))
def test_what_is_swept_is_what_two_moves_pass_over_to_and_from_the_nearest_sample_and_its_own_place(seed: int) -> None:
    """Of steps longer than the cutters are wide, by distances to lines; some of the steps cut nothing."""
    rng, m = np.random.default_rng(seed), 12
    p = np.cumsum(rng.normal(0.0, 6e-3, (m, 3)), axis=0)
    removes, radius = np.append(False, rng.random(m - 1) < 0.8), rng.choice([2e-3, R], m)
    sample = np.unique(np.append(rng.permutation(m)[:8], [0, m - 1]))
    xy = rng.uniform(p[:, :2].min(axis=0) - R, p[:, :2].max(axis=0) + R, (1500, 2))
    points, expected = shapely.points(xy), np.zeros(len(xy), dtype=bool)
    for wide in np.unique(radius[sample]):
        own = sample[radius[sample] == wide]
        off = np.array([shapely.distance(points, shapely.Point(p[i, :2])) for i in own])
        for n, i in enumerate(own):
            nearest = np.argmin(off, axis=0) == n
            moves = [end for end in (i, i + 1) if 0 < end < m and removes[end]]
            ways = [shapely.LineString(p[end - 1 : end + 1, :2]) for end in moves]
            near = shapely.distance(points, shapely.GeometryCollection([shapely.Point(p[i, :2]), *ways])) <= wide
            expected |= nearest & near
    made = SimpleNamespace(path=SimpleNamespace(p=p), removes=removes)
    np.testing.assert_array_equal(_swept(made, sample, radius, xy), expected)  # type: ignore[arg-type]
    assert 100 < expected.sum() < 1400
