"""Error field and metrology of a slot whose shift is known."""

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.surface.deviation import deviation
from robomill.surface.removal import EdgeCells
from robomill.surface.sections.groove import groove_sections
from robomill.surface.sections.metrology import compare_profile, fit_groove, fit_line, groove_profile
from robomill.surface.stock import Stock
from robomill.surface.swept import CutPath
from robomill.surface.zmap import ZMap, cut
from tests.telling import told

FLAT = Cutter("flat", 0.008)
STOCK = Stock((-0.02, -0.0103, -0.01), (0.02, 0.0097, 0.002))
P = np.array([[-0.05, 0, 0], [0.05, 0, 0]])
SHIFT = np.array([0, 0.2295e-3, -0.1024e-3])


def surfaces(cell=1e-4, shift=SHIFT):
    return tuple(cut(STOCK, cell, FLAT, p) for p in (P, P + shift))


def test_volumes_of_a_shifted_slot():
    """Excess: a strip of the shift's width on one side; gouge: one on the other and the deeper floor."""
    found = deviation(*surfaces())
    strip = 0.04 * SHIFT[1]
    gouge = strip * (0.002 - SHIFT[2]) + 0.04 * (0.008 - SHIFT[1]) * -SHIFT[2]
    assert found.excess_volume == pytest.approx(strip * 0.002, rel=0.03)
    assert found.gouge_volume == pytest.approx(gouge, rel=0.03)
    assert found.gouge_volume - found.excess_volume == pytest.approx(gouge - strip * 0.002, rel=1e-6)


def test_signed_error_is_the_distance_to_the_ideal_surface():
    found = deviation(*surfaces())
    floor = found.error[:, np.abs(found.y) < 0.003]
    np.testing.assert_allclose(floor, SHIFT[2], atol=1e-12)
    left = found.error[:, (found.y > 0.004) & (found.y < 0.0042)]
    right = found.error[:, (found.y > -0.004) & (found.y < -0.0038)]
    assert (left < 0).all()
    assert (right > 0).all()
    assert found.worst[0] == pytest.approx(SHIFT[1], abs=1e-4)
    assert found.worst[1] == pytest.approx(-SHIFT[1], abs=1e-4)
    assert np.isnan(found.error[:, found.y > 0.006]).all()


def test_no_deflection_is_no_error():
    found = deviation(*surfaces(shift=0 * SHIFT))
    assert found.worst == (0.0, 0.0)
    assert found.rms == found.excess_volume == found.gouge_volume == 0.0


def test_where_nothing_is_cut_there_is_no_error():
    nothing = deviation(surface(np.zeros((2, 2))), surface(np.zeros((2, 2))))
    assert (nothing.worst, nothing.rms) == ((0.0, 0.0), 0.0)


def test_grids_must_agree():
    with pytest.raises(SurfaceError, match="different grids"):
        deviation(surfaces()[0], surfaces(2e-4)[1])


def wavy_profile():
    s = np.linspace(0, 0.1, 401)
    p = np.column_stack([s - 0.05, 0 * s, 0 * s])
    offset = 2e-4 + 1e-3 * (s - 0.05) + 5e-5 * np.sin(2 * np.pi * s / 0.05)
    stock = Stock((-0.06, -0.02, -0.01), (0.06, 0.02, 0.002))
    moved = p + np.column_stack([0 * s, offset, 0 * s])
    stations = np.linspace(0, 0.1, 41)
    return groove_profile(groove_sections(stock, FLAT, CutPath(p, moved, s > 0), stations))


def test_best_fit_separates_shift_turn_and_form():
    fit = fit_groove(wavy_profile())
    s = np.linspace(0, 0.1, 41)
    slope, middle = np.polyfit(s - 0.05, 2e-4 + 1e-3 * (s - 0.05) + 5e-5 * np.sin(2 * np.pi * s / 0.05), 1)
    assert fit.side.offset == pytest.approx(middle, abs=1e-6)
    assert fit.side.rotation == pytest.approx(slope, abs=2e-5)
    assert 0.9e-4 < fit.side.form_error < 1.4e-4
    assert fit.floor.form_error < 1e-12
    with pytest.raises(SurfaceError, match="needs three"):
        fit_line([0, 1, 2], [np.nan, 1.0, 2.0])


def test_comparison_with_a_measured_profile():
    profile = wavy_profile()
    station = np.array([0.01, 0.03, 0.05, 0.2])
    measured = np.interp(station, profile.station, profile.centre_offset) + 2e-5
    found = compare_profile(profile, station, measured)
    assert found.outside == 1
    np.testing.assert_allclose(found.difference, -2e-5, atol=1e-12)
    assert (found.mean, found.rms, found.largest) == pytest.approx((-2e-5, 2e-5, -2e-5))
    assert 0.8 < found.explained < 1.0
    with pytest.raises(SurfaceError, match="must overlap"):
        compare_profile(profile, [0.3], [0.0])


NONE = EdgeCells(np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros((0, 6)))


DX, DY = 1e-3, 1.3e-3


def surface(z, edge=NONE):
    nx, ny = z.shape
    return ZMap(np.arange(nx) * DX, np.arange(ny) * DY, DY, z, edge, np.array(0.0), -0.01)


def nearest_column(ideal, machined, i, j, reach):
    """Signed distance to the ideal surface: in height, or aside to a column (half a cell less) and the rest."""
    error = machined[i, j] - ideal[i, j]
    best = abs(error)
    if best <= DX:
        return error
    for a in range(ideal.shape[0]):
        for b in range(ideal.shape[1]):
            aside = np.hypot((a - i) * DX, (b - j) * DY) - 0.5 * DX
            if (a, b) != (i, j) and aside <= reach:
                rest = max(0.0, np.sign(error) * (machined[i, j] - ideal[a, b]))
                best = min(best, np.hypot(aside, rest))
    return np.sign(error) * best


@pytest.mark.parametrize("reach", [1e-3, 4.2e-3])
def test_error_is_the_way_to_the_nearest_ideal_column(reach):
    rng = np.random.default_rng(3)
    ideal, machined = (np.round(rng.uniform(-8e-3, 0.0, (9, 7)), 6) for _ in range(2))
    ideal[0, :2] = machined[0, :2] = 0.0  # not cut
    found = deviation(surface(ideal), surface(machined), reach=reach)
    expected = np.array([[nearest_column(ideal, machined, i, j, reach) for j in range(7)] for i in range(9)])
    expected[0, :2] = np.nan
    np.testing.assert_allclose(found.error, expected, atol=1e-15)
    values = expected[np.isfinite(expected)]
    assert found.worst == pytest.approx((values.max(), values.min()))
    assert found.rms == pytest.approx(np.sqrt(sum(v * v for v in values) / len(values)))
    assert found.cut.sum() == 61


def test_volumes_count_mean_heights_at_walls():
    """Machined less ideal, cell by cell, where a wall's cell has its mean height instead."""
    ideal, machined = np.full((3, 4), -0.002), np.full((3, 4), -0.002)
    machined[0, 1], machined[2, 3] = -0.001, -0.0045
    walls = EdgeCells(np.array([1 * 4 + 2]), np.array([-0.0004]), np.full((1, 6), np.nan))
    other = EdgeCells(np.array([1 * 4 + 0]), np.array([-0.0013]), np.full((1, 6), np.nan))
    found = deviation(surface(ideal, other), surface(machined, walls))
    mean_machined, mean_ideal = machined.copy(), ideal.copy()
    mean_machined[1, 2], mean_ideal[1, 0] = -0.0004, -0.0013
    difference = mean_machined - mean_ideal
    assert found.excess_volume == pytest.approx(difference[difference > 0].sum() * DX * DY)
    assert found.gouge_volume == pytest.approx(-difference[difference < 0].sum() * DX * DY)
    np.testing.assert_array_equal(surface(machined, walls).mean, mean_machined)
    assert surface(machined, walls).removed_volume == pytest.approx(-mean_machined.sum() * DX * DY)


def test_a_comparison_tells_how_far_it_looks():
    """Ring by ring of the cells around, until nothing nearer can be found."""
    shares = told(lambda: deviation(*surfaces()))["Error of the surface"]
    assert shares[0] == 0.0
    assert np.ptp(np.diff(shares)) < 1e-12
    assert "Error of the surface" not in told(lambda: deviation(*surfaces(shift=0 * SHIFT)))
