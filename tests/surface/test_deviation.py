"""Error field and metrology of a slot whose shift is known."""

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.surface.deviation import deviation
from robomill.surface.groove import groove_sections
from robomill.surface.metrology import compare_profile, fit_groove, fit_line, groove_profile
from robomill.surface.stock import Stock
from robomill.surface.swept import CutPath
from robomill.surface.zmap import cut

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
    assert found.height_error.max() == pytest.approx(0.002)
    assert np.isnan(found.error[:, found.y > 0.006]).all()


def test_no_deflection_is_no_error():
    found = deviation(*surfaces(shift=0 * SHIFT))
    assert found.worst == (0.0, 0.0)
    assert found.rms == found.excess_volume == found.gouge_volume == 0.0
    assert found.area_out(1e-5) == (0.0, 0.0)


def test_area_out_of_tolerance_and_histogram():
    found = deviation(*surfaces())
    assert found.area_out(1e-3) == (0.0, 0.0)
    area, share = found.area_out(0.05e-3)
    assert share > 0.95  # all but cells right at the ideal wall
    assert area == pytest.approx(0.04 * (0.008 + SHIFT[1]), rel=0.03)
    edges, areas = found.histogram(40)
    assert len(edges) == 41
    assert areas.sum() == pytest.approx(found.cut_area)
    assert edges[np.argmax(areas)] <= SHIFT[2] <= edges[np.argmax(areas) + 1]
    for tolerance in (0.0, -1.0, np.nan):
        with pytest.raises(SurfaceError, match="Tolerance"):
            found.area_out(tolerance)


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
