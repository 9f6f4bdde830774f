"""Poses and tool axes, put together another way."""

import numpy as np
import pytest

from robomill.rigid import axis_from_tilt, transform


def test_a_pose_turns_a_point_and_then_shifts_it() -> None:
    rng = np.random.default_rng(1)
    R, p, x = rng.normal(size=(4, 3, 3)), rng.normal(size=(2, 1, 3)), rng.normal(size=3)
    T = transform(R, p)
    assert T.shape == (2, 4, 4, 4)
    for i, k in np.ndindex(2, 4):
        np.testing.assert_allclose(T[i, k] @ [*x, 1.0], [*(R[k] @ x + p[i, 0]), 1.0], rtol=1e-14)


@pytest.mark.parametrize("tilt", [(0.0, 0.0), (0.3, -0.7), (-2.0, 1.2), (0.0, np.pi / 2)])
def test_a_tilted_axis_is_z_turned_about_x_and_the_new_y(tilt: tuple[float, float]) -> None:
    A, B = np.array(tilt)
    about_x = np.array([[1, 0, 0], [0, np.cos(A), -np.sin(A)], [0, np.sin(A), np.cos(A)]])
    about_y = np.array([[np.cos(B), 0, np.sin(B)], [0, 1, 0], [-np.sin(B), 0, np.cos(B)]])
    np.testing.assert_allclose(axis_from_tilt(A, B), (about_x @ about_y)[:, 2], atol=1e-15)


def test_tilts_are_batches() -> None:
    A, B = np.linspace(-1, 1, 5)[:, None], np.linspace(-1, 1, 3)
    k = axis_from_tilt(A, B)
    assert k.shape == (5, 3, 3)
    np.testing.assert_allclose(np.linalg.norm(k, axis=-1), 1.0, rtol=1e-15)
