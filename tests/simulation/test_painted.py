"""What a picture paints on walls: their own error normal to them, however deep they are and whatever a plunge does."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import shapely

import robomill as rm
from robomill.arrays import FloatArray
from robomill.cutting.forces.along_path import PathForce
from robomill.io.samples import samples_dir
from robomill.simulation.enlarged import Enlarged, enlarged, so_far
from robomill.simulation.painted import AROUND, wall_error
from robomill.simulation.result import SimulationResult
from robomill.surface.stock import Stock
from robomill.toolpath.source import GCodeSource

R = 4e-3
INWARDS, UP = 0.12e-3, 0.8e-3
RINGS = [
    line
    for x, y in ((8, 2), (14, 8))
    for line in (f"G1 X{x}", f"G1 Y{y}", f"G1 X-{x}", f"G1 Y-{y}", f"G1 X{x}", "G1 Y0")
]
LAYERS = [line for z in (-2, -4, -6) for line in ("G0 Z2", "G0 X0 Y0", f"G1 Z{z} F300", *RINGS)]


@pytest.fixture(scope="module")
def pocket() -> SimulationResult:
    """A pocket in three layers, its tip pushed to the left of a counter-clockwise feed, inwards, and up in plunges."""
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml")
    text = "\n".join(["G21 G90 S12000 M3", *LAYERS, "M2", ""])
    stock = Stock([-30e-3, -20e-3, -10e-3], [30e-3, 20e-3, 0.0])
    made = rm.simulate(
        setup.replace(source=GCodeSource(text), stock=stock, cell=2e-4, force=PathForce(feed_normal=10.0))
    )
    down, cutting = made.conditions.mostly_axial, made.path.cutting
    pushed = np.zeros((len(made.path), 3))
    pushed[cutting & ~down, 1] = INWARDS
    pushed[cutting & down, 2] = UP
    return dataclasses.replace(made, delta=np.einsum("mij,mi->mj", made.R_MF.transpose(0, 2, 1), pushed))


def covered(p: FloatArray, on: FloatArray) -> shapely.Geometry:
    """What a flat mill covers."""
    ways = [shapely.LineString(p[i - 1 : i + 1, :2]) for i in np.flatnonzero(on)]
    return shapely.union_all([way.buffer(R, quad_segs=200) for way in ways])


def far_from_corners(shown: Enlarged) -> FloatArray:
    """Cells beside the straight parts of three walls; at the fourth the tool comes in and pushes along the wall."""
    x, y = np.meshgrid(shown.drawn.x, shown.drawn.y, indexing="ij")
    return np.asarray((np.abs(x) < 8e-3) | (np.abs(y) < 3e-3) & (x < 0.0))


@pytest.mark.parametrize("times", [1.0, 5.0, 20.0])
def test_the_walls_of_a_deep_pocket_are_painted_with_what_they_are_off(pocket: SimulationResult, times: float) -> None:
    """The ring between the outlines told and drawn is uncut by 6 mm, more than the plunge's 0.8 mm at any scale."""
    shown = enlarged(pocket, times)
    told, moved = (
        covered(p, pocket.removes) for p in (pocket.path.p, pocket.path.p + times * (pocket.p_machined - pocket.path.p))
    )
    x, y = np.meshgrid(shown.drawn.x, shown.drawn.y, indexing="ij")
    cell = 0.75 * shown.drawn.dx
    ring = shapely.contains_xy(told.buffer(-cell), x, y) & ~shapely.contains_xy(moved.buffer(cell), x, y)
    if times > 1.0:
        assert (ring & far_from_corners(shown)).sum() > 100
        assert shown.drawn.z[ring] == pytest.approx(0.0)
    assert shown.error[ring & far_from_corners(shown)] == pytest.approx(INWARDS, abs=2e-6)
    assert np.nanmax(np.abs(shown.error)) < 1.05 * INWARDS, "nowhere is a wall told by its height"


@pytest.mark.parametrize("times", [1.0, 10.0])
def test_a_wall_has_its_own_error_from_its_foot_to_its_top(pocket: SimulationResult, times: float) -> None:
    """Cells on either side of the outline drawn know it; where nothing is steep there is none."""
    shown = enlarged(pocket, times)
    moved = covered(pocket.path.p + times * (pocket.p_machined - pocket.path.p), pocket.removes)
    x, y = np.meshgrid(shown.drawn.x, shown.drawn.y, indexing="ij")
    off = shapely.distance(shapely.boundary(moved), shapely.points(x, y))
    beside = (off < 0.9 * shown.drawn.dx) & far_from_corners(shown)
    heights = shown.drawn.z[beside]
    assert heights.min() < -5e-3
    assert heights.max() == 0.0
    assert shown.wall[beside] == pytest.approx(INWARDS, abs=2e-6)
    assert np.isnan(shown.wall[off > 4.0 * shown.drawn.dx]).all()
    half = so_far(pocket, shown, len(pocket.path) // 2)
    assert np.isnan(half.wall[half.drawn.z != shown.drawn.z]).all()


def test_a_cut_without_walls_paints_none(pocket: SimulationResult) -> None:
    """A face cut all over the block."""
    lines = [line for y in range(-24, 25, 4) for line in (f"G0 X-40 Y{y}", "G0 Z-1", "G1 X40 F900", "G0 Z5")]
    text = "\n".join(["G21 G90 S12000 M3", "G0 Z5", *lines, "M2", ""])
    shown = enlarged(rm.simulate(pocket.setup.replace(source=GCodeSource(text))), 10.0)
    assert np.isfinite(shown.error).all()
    assert np.isnan(shown.wall).all()


def test_each_wall_of_a_terrace_is_painted_with_its_own_error(pocket: SimulationResult) -> None:
    """Two grooves along X, the deeper one 1 mm aside: above it stands a wall of 1 mm, and beyond it another of 4 mm."""
    lines = [line for y, z in ((0, -4), (-1, -5)) for line in ("G0 X-40 Z5", f"G0 Y{y}", f"G0 Z{z}", "G1 X40 F900")]
    text = "\n".join(["G21 G90 S12000 M3", "G0 Z5", *lines, "G0 Z5", "M2", ""])
    made = rm.simulate(pocket.setup.replace(source=GCodeSource(text)))
    pushed = np.zeros((len(made.path), 3))
    pushed[made.path.cutting, 1] = np.where(made.path.p[made.path.cutting, 2] < -4.5e-3, -0.05e-3, 0.1e-3)
    made = dataclasses.replace(made, delta=np.einsum("mij,mi->mj", made.R_MF.transpose(0, 2, 1), pushed))
    shown = enlarged(made, 1.0)
    middle = shown.wall[np.abs(shown.drawn.x) < 10e-3]
    assert (np.isfinite(middle).sum(axis=1) == 3 * 4).all()  # two cells on either side of each
    for y, left in ((4.1e-3, -0.1e-3), (2.95e-3, 0.05e-3), (-5.05e-3, -0.05e-3)):
        beside = middle[:, np.abs(shown.drawn.y - y) < shown.drawn.dx]
        assert beside.size > 50
        assert beside == pytest.approx(left, abs=1e-9)


@pytest.mark.parametrize("times", [1.0, 10.0])
def test_the_sides_of_a_cones_groove_are_painted_with_their_error_along_their_normals(times: float) -> None:
    """As far as it goes aside, by the cosine of their lean, though they are drawn up to a diameter further on."""
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml")
    cone = rm.Cutter("chamfer", 1.5e-3, tip_angle=np.radians(60.0))
    text = "G21 G90 S12000 M3\nG0 X-8 Y0 Z5\nG0 Z-1.2\nG1 X8 F600\nG0 Z5\nM2\n"
    stock = Stock([-5e-3, -3e-3, -4e-3], [5e-3, 8e-3, 0.0])
    made = rm.simulate(
        setup.replace(
            source=GCodeSource(text), stock=stock, cutter=cone, cell=5e-5, step=5e-4, force=PathForce(feed_normal=10.0)
        )
    )
    aside = np.where(made.path.cutting, 0.2e-3, 0.0)
    made = dataclasses.replace(made, delta=aside[:, None] * made.R_MF[:, 1])
    shown = enlarged(made, times)
    x, y = np.meshgrid(shown.drawn.x, shown.drawn.y, indexing="ij")
    told, moved = (np.abs(y - off) < 0.5e-3 for off in (0.0, times * 0.2e-3))
    for sign, cells in ((1.0, told & ~moved), (-1.0, moved & ~told)):
        inner = cells & (np.abs(x) < 3e-3)
        assert inner.sum() > 400
        assert shown.error[inner] == pytest.approx(sign * 0.2e-3 * np.cos(np.radians(30.0)), rel=1e-3)


@pytest.mark.parametrize("times", [1.0, 20.0])
def test_a_slope_whose_tool_lags_behind_is_painted_as_a_floor_that_is_off_in_height(
    pocket: SimulationResult, times: float
) -> None:
    """Down by 1 in 10, 0.1 mm back along its way: 0.01 mm too deep, however much of that is drawn; no wall moves."""
    lines = ["G0 X-35 Y0 Z5", "G0 Z0", "G1 X35 Z-7 F900", "G0 Z5"]
    made = rm.simulate(pocket.setup.replace(source=GCodeSource("\n".join(["G21 G90 S12000 M3", *lines, "M2", ""]))))
    lag = np.where(made.path.cutting, 0.1e-3, 0.0)[:, None] * [-1.0, 0.0, 0.0] @ made.setup.T_MW[:3, :3].T
    shown = enlarged(dataclasses.replace(made, delta=lag), times)
    x, y = np.meshgrid(shown.drawn.x, shown.drawn.y, indexing="ij")
    floor = (np.abs(x) < 15e-3) & (np.abs(y) < 2e-3)
    assert shown.error[floor] == pytest.approx(-0.01e-3, abs=1e-7)


@pytest.mark.parametrize(("dx", "dy"), [(0.1e-3, 0.2e-3), (0.2e-3, 0.1e-3)])
def test_a_step_that_stands_further_from_every_wall_than_a_step_and_four_cells_is_one_between_floors(
    pocket: SimulationResult, dx: float, dy: float
) -> None:
    """Drawn ever further from a wall along X that is read every 1 mm: where one of these is near, it has its error."""
    lines = ["G0 X-35 Y0 Z5", "G0 Z-4", "G1 X35 F900", "G0 Z5"]
    setup = pocket.setup.replace(source=GCodeSource("\n".join(["G21 G90 S12000 M3", *lines, "M2", ""])))
    made, shown = rm.simulate(setup), enlarged(pocket, 1.0)
    error, step = np.where(made.path.cutting, 0.1e-3, 0.0)[:, None], setup.step
    made = dataclasses.replace(made, delta=error * made.R_MF[:, 1])
    x, y = np.arange(-4e-3, 4e-3, dx), np.arange(R, R + 5e-3, dy)
    far = y - R - 0.1e-3
    least, most = (np.sqrt(np.maximum((step + 4.0 * max(dx, dy)) ** 2 - over**2, 0.0)) for over in (0.5 * step, 0.0))
    for edge in range(4, len(y) - 4):
        z = np.where(np.arange(len(y)) < edge, -4e-3, 0.0) * np.ones((len(x), 1))
        found = wall_error(made, dataclasses.replace(shown.drawn, x=x, y=y, z=z), 1.0)
        beside = slice(edge - AROUND, edge + AROUND)
        near, none = (np.abs(far[beside]) < least - 1e-9), (np.abs(far[beside]) > most + 1e-9)
        assert np.isnan(found[:, : edge - AROUND]).all()
        assert np.isnan(found[:, edge + AROUND :]).all()
        assert found[:, beside][:, near] == pytest.approx(-0.1e-3, abs=1e-9)
        assert np.isnan(found[:, beside][:, none]).all()


def test_a_rib_that_two_walls_have_moved_over_has_on_either_side_the_error_of_its_own_wall(
    pocket: SimulationResult,
) -> None:
    """1.2 mm thick, told tenfold: the one moves 1 mm into it, the other 0.4 mm. From the middle of the way of the one
    to where the other has come it is 0.3 mm."""
    lines = [line for y in (0, 9.2) for line in ("G0 X-35 Z5", f"G0 Y{y}", "G0 Z-2", "G1 X35 F900", "G0 Z5")]
    made = rm.simulate(pocket.setup.replace(source=GCodeSource("\n".join(["G21 G90 S12000 M3", *lines, "M2", ""]))))
    aside = np.where(made.path.p[:, 1] < 5e-3, 0.1e-3, -0.04e-3) * made.path.cutting
    shown = enlarged(dataclasses.replace(made, delta=aside[:, None] * made.R_MF[:, 1]), 10.0)
    x, y = np.meshgrid(shown.drawn.x, shown.drawn.y, indexing="ij")
    middle = np.abs(x) < 10e-3
    for low, high, error in ((4.1e-3, 4.6e-3, -0.1e-3), (4.85e-3, 5.1e-3, -0.04e-3)):
        some = middle & (y > low) & (y < high)
        assert some.sum() > 50
        assert shown.error[some] == pytest.approx(error, abs=1e-9)
