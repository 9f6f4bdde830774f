"""The metrology of profiles by least squares done by hand."""

import numpy as np
import pytest

from robomill.errors import SurfaceError
from robomill.surface.sections.metrology import GrooveProfile, compare_profile, fit_line


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


def test_a_groove_that_was_measured_nowhere_is_compared_with_nothing():
    s, lost = np.array([0.0, 0.1]), np.full(2, np.nan)
    with pytest.raises(SurfaceError, match="no section of the predicted groove could be measured"):
        compare_profile(GrooveProfile(s, lost, lost, lost, lost), s, s)
