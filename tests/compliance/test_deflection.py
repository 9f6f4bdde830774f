"""Shares of a displacement: each part's shadow on it, by lengths and angles."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.compliance.deflection import shares_along


def test_a_share_is_the_shadow_of_the_part_on_the_whole_over_its_length() -> None:
    """Parts by length and angle to the whole: cos(angle) length / whole; what is square to it has no share."""
    rng = np.random.default_rng(6)
    parts = rng.normal(size=(4, 2, 5, 3)) * 1e-5
    whole = parts.sum(axis=-2)
    found = shares_along(parts, whole)
    assert found.shape == (4, 2, 5)
    for at in np.ndindex(4, 2, 5):
        part, all_of_it = parts[at], whole[at[:2]]
        length = np.linalg.norm(all_of_it)
        angle = np.arctan2(np.linalg.norm(np.cross(part, all_of_it)), part @ all_of_it)
        assert found[at] == pytest.approx(np.linalg.norm(part) * np.cos(angle) / length, abs=1e-12)
    np.testing.assert_allclose(found.sum(axis=-1), 1.0)
    np.testing.assert_array_equal(shares_along(np.eye(3) * 2e-6, np.array([0.0, 4e-6, 0.0])), [0.0, 0.5, 0.0])


def test_of_nothing_every_share_is_nothing() -> None:
    parts = np.array([[1e-6, 0.0, 0.0], [-1e-6, 0.0, 0.0]])
    np.testing.assert_array_equal(shares_along(parts, parts.sum(axis=0)), [0.0, 0.0])
    unknown = shares_along(np.full((2, 3), np.nan), np.full(3, np.nan))
    assert np.isnan(unknown).all()
