"""The two axes across the tool that the rows of the task Jacobian are taken about."""

import itertools

import numpy as np
import pytest

from robomill.kinematics.jacobian import task_rows, tilt_axes, twists


@pytest.mark.parametrize("seed", range(3))
def test_axes_across_the_tool_are_square_to_it_and_turn_with_its_tilt(seed):
    """With k a right-handed frame; the first one lies in the plane of k and X, as after a turn about X and then Y."""
    k = np.random.default_rng(seed).normal(size=(4, 5, 3))
    k /= np.linalg.norm(k, axis=-1, keepdims=True)
    axes = tilt_axes(k)
    frame = np.concatenate([axes, k[..., None, :]], axis=-2)
    np.testing.assert_allclose(frame @ np.swapaxes(frame, -1, -2), np.broadcast_to(np.eye(3), (4, 5, 3, 3)), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(frame), 1.0, atol=1e-12)
    np.testing.assert_allclose(axes[..., 1, 0], 0.0, atol=1e-12)  # the second is square to X


def test_a_tool_axis_that_is_not_known_in_one_part_has_no_axes_across_it():
    for known in itertools.product((True, False), repeat=3):
        k = np.where(known, [0.6, 0.0, 0.8], np.nan)
        assert np.isfinite(tilt_axes(k)).all() == all(known)
        assert np.isnan(tilt_axes(k)).all() == (not all(known))


def test_rows_of_the_task_are_velocity_and_the_turn_about_the_two_axes():
    rng = np.random.default_rng(2)
    T, J = np.tile(np.eye(4), (3, 1, 1)), rng.normal(size=(3, 6, 5))
    k = rng.normal([0.0, 0.0, 3.0], size=(3, 3))
    T[:, :3, 2] = k / np.linalg.norm(k, axis=1, keepdims=True)
    rows = task_rows(T, J)
    for n in range(3):
        x, y = tilt_axes(T[n, :3, 2])
        np.testing.assert_array_equal(rows[n, :3], J[n, :3])
        np.testing.assert_allclose(rows[n, 3], [x @ J[n, 3:, j] for j in range(5)])
        np.testing.assert_allclose(rows[n, 4], [y @ J[n, 3:, j] for j in range(5)])


def test_twists_of_batches_are_those_one_by_one():
    """z x r and z where a joint turns, z alone where it slides; axes, reaches and kinds of joint broadcast."""
    rng = np.random.default_rng(5)
    axis, reach, slides = (
        rng.normal(size=(2, 4, 3)),
        rng.normal(size=(6, 1, 4, 3)),
        np.array([True, False, True, False]),
    )
    found = twists(axis, reach, slides)
    assert found.shape == (6, 2, 4, 6)
    for i, j, k in itertools.product(range(6), range(2), range(4)):
        z, r = axis[j, k], reach[i, 0, k]
        expected = [*z, 0, 0, 0] if slides[k] else [*np.cross(z, r), *z]
        np.testing.assert_allclose(found[i, j, k], expected, atol=1e-15)
    assert twists(reach, axis).shape == (6, 2, 4, 6)
