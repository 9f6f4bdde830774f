"""A fitted point told in the tool's and the flange's frame, and how surely, against draws of it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

from robomill.identification.pull.found_points import FLAT, FoundPoint, point_findings

SHIFT, STATED = np.array([3e-3, -1e-3, 2e-3]), np.array([0.01, 0.02, 0.15])
T_FT = np.eye(4)
T_FT[:3, :3], T_FT[:3, 3] = Rotation.from_rotvec([0.4, -0.9, 0.3]).as_matrix(), [0.1, -0.2, 0.3]
AXES = Rotation.from_rotvec([0.2, 0.5, -0.7]).as_matrix()


def found(sizes, dof=9, shift=SHIFT):
    """Standard errors (3,) m along axes of its own."""
    return FoundPoint("force", shift, AXES @ np.diag(np.square(sizes)) @ AXES.T, STATED, T_FT, dof)


def test_the_place_is_the_stated_one_shifted_and_seen_from_the_flange():
    point = found([1e-4, 2e-4, 3e-4])
    np.testing.assert_allclose(point.in_tool, [0.013, 0.019, 0.152])
    np.testing.assert_allclose(np.append(point.in_flange, 1.0), T_FT @ np.append(point.in_tool, 1.0))
    assert point.off == pytest.approx(np.sqrt(14.0) * 1e-3)


@pytest.mark.parametrize("dof", [3, 40])
def test_intervals_are_those_of_draws(dof):
    """Draws around the place, as normal noise leaves them; Student's t makes them wider by what the noise is known."""
    sizes = np.array([1e-5, 4e-5, 2e-5])
    point = found(sizes, dof)
    drawn = SHIFT + (np.random.default_rng(3).normal(size=(60_000, 3)) * sizes) @ AXES.T
    wide = stats.t.ppf(0.975, dof)
    seen = (STATED + drawn) @ T_FT[:3, :3].T + T_FT[:3, 3]
    np.testing.assert_allclose(point.ci95.mean(axis=1), point.in_flange)
    np.testing.assert_allclose(np.diff(point.ci95)[:, 0], 2.0 * wide * seen.std(axis=0), rtol=0.015)
    assert point.off_half == pytest.approx(wide * np.linalg.norm(drawn, axis=1).std(), rel=0.015)
    assert found(sizes, dof, shift=np.zeros(3)).off_half == 0.0


def test_a_direction_that_is_not_held_is_told():
    t = stats.t.ppf(0.975, 9)
    held, loose = found([1e-3, 0.99 * FLAT / t, 1e-3]), found([1e-3, 1.01 * FLAT / t, 1e-3])
    assert held.flat is None
    np.testing.assert_allclose(np.abs(loose.flat @ AXES), [0.0, 1.0, 0.0], atol=1e-9)
    unseen = FoundPoint("gauge", SHIFT, np.full((3, 3), np.nan), STATED, T_FT, 9)
    assert np.isnan(unseen.flat).all()
    assert np.isinf(unseen.off_half)
    assert np.isinf(unseen.ci95).all()
    assert [each.code for each in point_findings((held, loose, unseen))] == [
        "force-point-not-held",
        "gauge-point-not-held",
    ]
    assert found([1e-3] * 3, dof=0).flat is not None


@pytest.mark.parametrize("dof", [10, 1000])
def test_chance_alone_calls_a_point_off_in_five_of_a_hundred_fits(dof: int) -> None:
    """Three coordinates together, which one interval along the shift itself would call off in 28 of 100."""
    rng = np.random.default_rng(4)
    root = np.array([[20.0, 0.0, 0.0], [8.0, 10.0, 0.0], [-4.0, 3.0, 6.0]]) * 1e-3
    called = 0
    for _ in range(3000):
        shift = root @ rng.normal(size=3)
        spread = rng.chisquare(dof) / dof  # what a fit with so many degrees of freedom takes its noise for
        found = FoundPoint("force", shift, root @ root.T * spread, np.zeros(3), np.eye(4), dof)
        called += found.is_off
    assert 0.038 < called / 3000 < 0.062
    far = FoundPoint("force", np.array([0.15, 0.0, 0.0]), root @ root.T, np.zeros(3), np.eye(4), dof)
    assert far.is_off
    near = FoundPoint("force", np.array([1e-3, 0.0, 0.0]), np.eye(3) * 1e-12, np.zeros(3), np.eye(4), dof)
    assert not near.is_off
