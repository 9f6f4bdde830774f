"""The error field by loops over columns, and the metrology of profiles by least squares done by hand."""

import numpy as np
import pytest

from robomill.surface.deviation import deviation
from robomill.surface.metrology import GrooveProfile, compare_profile, fit_line
from robomill.surface.removal import EdgeCells
from robomill.surface.zmap import ZMap

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
    np.testing.assert_allclose(found.height_error, machined - ideal)
    values = expected[np.isfinite(expected)]
    assert found.worst == pytest.approx((values.max(), values.min()))
    assert found.rms == pytest.approx(np.sqrt(sum(v * v for v in values) / len(values)))
    assert found.cut_area == pytest.approx(61 * DX * DY)
    tolerance = float(np.median(np.abs(values)))
    out = sum(abs(v) > tolerance for v in values)
    assert found.area_out(tolerance) == pytest.approx((out * DX * DY, out / 61))
    at_limit = float(np.sort(np.abs(values))[-1])
    assert found.area_out(at_limit)[0] == 0.0


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


def test_histogram_counts_areas():
    machined = np.full((4, 5), -0.002) + np.arange(20).reshape(4, 5) * 1e-5
    found = deviation(surface(np.full((4, 5), -0.002)), surface(machined))
    edges, area = found.histogram(10)
    np.testing.assert_allclose(edges, np.linspace(-1.9e-4, 1.9e-4, 11))
    for n in range(10):
        last = n == 9
        inside = [v for v in np.arange(20) * 1e-5 if edges[n] <= v + 1e-15 and (v < edges[n + 1] - 1e-15 or last)]
        assert area[n] == pytest.approx(len(inside) * DX * DY)
    edges, area = found.histogram(4, limit=5e-5)
    np.testing.assert_allclose(edges, np.linspace(-5e-5, 5e-5, 5))
    assert area.tolist() == pytest.approx([0.0, 0.0, 3 * DX * DY, 17 * DX * DY])  # what is beyond is in the last
    nothing = deviation(surface(np.zeros((2, 2))), surface(np.zeros((2, 2))))
    assert (nothing.worst, nothing.rms, nothing.cut_area, nothing.area_out(1e-3)) == ((0.0, 0.0), 0.0, 0.0, (0.0, 0.0))


def test_a_line_through_a_profile_solves_the_normal_equations():
    rng = np.random.default_rng(5)
    s, v = np.sort(rng.uniform(0.2, 0.5, 12)), rng.normal(size=12) * 1e-4
    v[3] = np.nan
    fit, known = fit_line(s, v), np.isfinite(v)
    x, y = s[known], v[known]
    n, sx, sy, sxx, sxy = len(x), x.sum(), y.sum(), (x * x).sum(), (x * y).sum()
    slope = (n * sxy - sx * sy) / (n * sxx - sx * sx)
    level = (sy - slope * sx) / n
    assert fit.rotation == pytest.approx(np.arctan(slope))
    assert fit.offset == pytest.approx(level + slope * sx / n)
    left = y - level - slope * x
    np.testing.assert_allclose(fit.residual[known], left, atol=1e-15)
    assert np.isnan(fit.residual[3])
    assert fit.form_error == pytest.approx(left.max() - left.min())
    assert fit.rms == pytest.approx(np.sqrt((left**2).sum() / n))
    assert fit_line([0, 1, 2], [0.0, 1.0, 2.0]).rotation == pytest.approx(np.pi / 4)


def test_a_measured_profile_beside_the_predicted_one():
    s = np.array([0.0, 0.1, 0.2, 0.3])
    offset = np.array([np.nan, 1e-4, 3e-4, 2e-4])
    profile = GrooveProfile(s, offset, offset, offset, offset)
    assert profile.missing == 1
    found = compare_profile(profile, [0.05, 0.1, 0.15, 0.3, 0.31], [9.0, 2e-4, 1e-4, 5e-4, 9.0])
    np.testing.assert_allclose(found.predicted, [1e-4, 2e-4, 2e-4])
    np.testing.assert_allclose(found.difference, [-1e-4, 1e-4, -3e-4])
    assert (found.mean, found.largest, found.outside) == (pytest.approx(-1e-4), pytest.approx(-3e-4), 2)
    assert found.rms == pytest.approx(np.sqrt(11e-8 / 3))
    assert found.explained == pytest.approx(5 / 8)
    np.testing.assert_array_equal(found.station, [0.1, 0.15, 0.3])
    assert np.isnan(compare_profile(profile, [0.1, 0.3], [1e-4, -1e-4]).explained)
