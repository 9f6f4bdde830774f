"""Angles between directions against directions turned by known angles; nearest places against a fine walk."""

import numpy as np
import pytest

from robomill.vectors import angle_between, nearest_on


def test_the_angle_is_the_one_it_was_turned_by():
    rng = np.random.default_rng(1)
    for angle in (0.0, 1e-12, 1e-7, 0.3, 1.5, 3.0, np.pi - 1e-9, np.pi):
        x, other = rng.standard_normal((2, 50, 3))
        y = np.cross(x, other)
        x, y = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (x, y))
        turned = np.cos(angle) * x + np.sin(angle) * y
        np.testing.assert_allclose(angle_between(3.0 * x, 0.2 * turned), angle, rtol=1e-3, atol=1e-15)
    assert angle_between([0, 0, 1.0], [[0, 0, 2.0], [0, 5.0, 0], [0, 0, -1.0]]).tolist() == [0.0, np.pi / 2, np.pi]


@pytest.mark.parametrize("shape", [(3,), (5, 3), (2, 4, 3), (2, 1, 3, 3)])
def test_angles_of_batches_are_those_one_by_one(shape) -> None:
    a, b = np.random.default_rng(1).normal(size=(2, *shape))
    found = angle_between(a, b)
    assert found.shape == shape[:-1]
    for i in np.ndindex(*shape[:-1]):
        assert found[i] == pytest.approx(np.arccos(a[i] @ b[i] / np.linalg.norm(a[i]) / np.linalg.norm(b[i])))


@pytest.mark.parametrize("k", [2, 3])
def test_the_nearest_place_on_a_way_is_that_of_a_fine_walk_along_it(k: int) -> None:
    q, a, b = np.random.default_rng(2).normal(size=(3, 40, k))
    b[0] = a[0]  # a way of no length
    walk = np.linspace(0.0, 1.0, 20_001)
    share, off = nearest_on(q, a, b)
    for n in range(len(q)):
        far = np.linalg.norm(a[n] + walk[:, None] * (b[n] - a[n]) - q[n], axis=1)
        assert off[n] == pytest.approx(far.min(), abs=1e-7)
        assert share[n] == pytest.approx(walk[far.argmin()], abs=1e-4)
