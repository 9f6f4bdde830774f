"""The part zero from three touched points."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from robomill.errors import ToolpathError
from robomill.toolpath.part_zero import frame_from_points, points_of_frame

unit = st.floats(-1, 1)


def random_frame(rng):
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    Q[:, 2] *= np.sign(np.linalg.det(Q))
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Q, rng.uniform(-2, 2, 3)
    return T


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), u=st.floats(0.01, 2), v=unit, w=st.floats(0.05, 2))
def test_points_in_a_known_frame_give_it_back(seed, u, v, w):
    """Touch the zero, (u, 0, 0) and (v, w, 0) of a random frame: the same frame comes back."""
    T = random_frame(np.random.default_rng(seed))
    zero, on_x, aside = (T[:3, :3] @ q + T[:3, 3] for q in ([0, 0, 0], [u, 0, 0], [v, w, 0]))
    if abs(np.arctan2(w, v)) < 0.05:
        return
    found = frame_from_points(zero, on_x, aside)
    np.testing.assert_allclose(found.T_MW, T, atol=1e-11)
    assert found.base == pytest.approx(u)
    assert found.lever == pytest.approx(w)
    assert found.angle == pytest.approx(np.arctan2(w, v))


def test_three_points_of_a_frame_give_it_back():
    T = random_frame(np.random.default_rng(5))
    np.testing.assert_allclose(frame_from_points(*points_of_frame(T)).T_MW, T, atol=1e-12)


def test_the_stated_tilt_bounds_what_touching_errors_do():
    """Points moved by at most e in any direction turn no axis by more than ``tilt(e)`` (first order, random)."""
    rng = np.random.default_rng(2)
    points = np.array([[0, 0, 0], [0.2, 0, 0], [0.05, 0.1, 0]])
    exact, e = frame_from_points(*points), 1e-4
    for _ in range(300):
        step = rng.normal(size=(3, 3))
        moved = points + e * step / np.linalg.norm(step, axis=1, keepdims=True)
        turned = np.arccos(np.clip(np.diag(exact.T_MW[:3, :3].T @ frame_from_points(*moved).T_MW[:3, :3]), -1, 1))
        assert turned.max() <= exact.tilt(e) * 1.2
    # Nearly so much where the zero is touched too low and both others too high, on axes that stand square.
    square = np.array([[0, 0, 0], [0.2, 0, 0], [0, 0.1, 0]])
    moved = frame_from_points(*(square + e * np.array([[0, 0, -1.0], [0, 0, 1], [0, 0, 1]])))
    turned = np.arccos(moved.T_MW[2, 2])
    assert frame_from_points(*square).tilt(e) == pytest.approx(turned, rel=1e-3)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([[0, 0, 0], [0, 0, 0], [0, 1, 0]], "point on x is 0.000 mm from the zero"),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], "on one line"),
        ([[0, 0, 0], [1, 0, 0], [-2, 1e-3, 0]], "on one line"),
        ([[0, 0, 0], [1, 0, np.inf], [0, 1, 0]], "finite"),
    ],
)
def test_points_that_define_no_frame_are_refused(points, words):
    with pytest.raises(ToolpathError, match=words):
        frame_from_points(*np.array(points, dtype=float))


def test_the_stated_tilt_is_reached_by_the_worst_errors():
    """Zero up, the two others down by e: z turns by 2 e over the base about y and by 2 e over the lever about x."""
    e = 1e-5
    points = np.array([[0, 0, 0], [0.2, 0, 0], [0, 0.08, 0]])
    z = frame_from_points(*(points + np.outer([e, -e, -e], [0, 0, 1]))).T_MW[:3, 2]
    assert frame_from_points(*points).tilt(e) == pytest.approx(np.arctan2(np.hypot(z[0], z[1]), z[2]), rel=1e-3)
