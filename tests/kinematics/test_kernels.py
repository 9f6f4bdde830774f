"""Compiled pieces against the libraries: sine and cosine, arc tangent, determinant, distance of two frames."""

import numpy as np
import pytest
from numba import njit
from numba.extending import register_jitable

import robomill as rm
from robomill.kinematics import kernels
from robomill.kinematics.choice import turn
from robomill.kinematics.trig_kernels import arc_tangent, sin_cos


@pytest.fixture(scope="module")
def trig():
    for law in (sin_cos, arc_tangent):
        register_jitable(law)

    @njit
    def many(x, y, out):
        for i in range(len(x)):
            out[0, i], out[1, i] = sin_cos(x[i])
            out[2, i] = arc_tangent(y[i], x[i])

    return many


def test_sine_cosine_and_arc_tangent(trig):
    rng = np.random.default_rng(0)
    x = np.concatenate([rng.uniform(-7, 7, 20_000), np.arange(-40, 41) * np.pi / 4, rng.uniform(-1e4, 1e4, 2000)])
    y = rng.uniform(-7, 7, len(x)) * 10.0 ** rng.integers(-8, 8, len(x))
    out = np.empty((3, len(x)))
    trig(x, y, out)
    np.testing.assert_allclose(out[0], np.sin(x), atol=1e-12)
    np.testing.assert_allclose(out[0, :20_000], np.sin(x[:20_000]), atol=4e-16)
    np.testing.assert_allclose(out[1, :20_000], np.cos(x[:20_000]), atol=4e-16)
    np.testing.assert_allclose(out[2], np.arctan2(y, x), rtol=4e-16, atol=4e-16)
    axes = np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, 1], [-1, -1], [1, -1], [-0.0, 0.0]], float)
    out = np.empty((3, len(axes)))
    trig(np.ascontiguousarray(axes[:, 0]), np.ascontiguousarray(axes[:, 1]), out)
    expected = np.pi / 4 * np.array([0, 0, 4, 2, -2, 1, 3, -3, -1, 0])
    np.testing.assert_allclose(out[2], expected, atol=1e-15)


@pytest.mark.parametrize("n", [1, 2, 3, 5, 6])
def test_determinant_by_elimination(n):
    rng = np.random.default_rng(n)
    A = rng.normal(size=(60, n, n))
    A[:20] *= rng.random((20, n, n)) < 0.6  # zeros where the pivot would stand
    A[20, :, 0] = 0.0
    A[21] = np.eye(n)[::-1]
    det = np.empty(60)
    before = A.copy()
    kernels.determinant_of(A, det)
    np.testing.assert_allclose(det, np.linalg.det(before), rtol=1e-10, atol=1e-12)
    np.testing.assert_array_equal(A, before)
    assert det[20] == 0.0


@pytest.mark.parametrize("shape", [(6, 7), (3, 4), (2, 3), (1, 2), (5, 6)])
def test_the_size_of_what_is_not_square(shape):
    A = np.random.default_rng(0).normal(size=(30, *shape))
    det = np.empty(30)
    kernels.determinant_of(A, det)
    np.testing.assert_allclose(det, np.linalg.svd(A, compute_uv=False).prod(axis=1), rtol=1e-10)
    A[:, -1] = A[:, 0] if len(A[0]) > 1 else 0.0
    kernels.determinant_of(A, det)
    np.testing.assert_allclose(det, 0.0, atol=1e-6)


@pytest.mark.parametrize("whole", [False, True])
def test_how_far_two_frames_are_apart(whole):
    robot = rm.load_robot("kuka_kr500")
    rng = np.random.default_rng(2)
    theta = rng.uniform(-1, 1, (200, 6))
    other = theta + rng.normal(size=(200, 6)) * 10.0 ** rng.uniform(-7, 0, 200)[:, None]
    shift, angle = np.empty(200), np.empty(200)
    wanted, found = rm.tool_pose(robot, other), rm.tool_pose(robot, theta)
    kernels.misfit_of(theta, robot.chain, wanted, whole, shift, angle)
    np.testing.assert_allclose(shift, np.linalg.norm(wanted[:, :3, 3] - found[:, :3, 3], axis=1), atol=1e-15)
    if whole:
        turned = np.swapaxes(found[:, :3, :3], 1, 2) @ wanted[:, :3, :3]
        w = np.stack(
            [turned[:, 2, 1] - turned[:, 1, 2], turned[:, 0, 2] - turned[:, 2, 0], turned[:, 1, 0] - turned[:, 0, 1]]
        )
        expected = np.arctan2(np.linalg.norm(w, axis=0), np.trace(turned, axis1=1, axis2=2) - 1)
    else:
        z, k = found[:, :3, 2], wanted[:, :3, 2]
        expected = np.arctan2(np.linalg.norm(np.cross(z, k), axis=1), (z * k).sum(axis=1))
    np.testing.assert_allclose(angle, expected, rtol=1e-9, atol=1e-14)


def test_whole_turns():
    robot = rm.load_robot("slavkovic_5r").replace(limits=np.tile([-5.0, 8.0], (5, 1)))
    rng = np.random.default_rng(4)
    near = rng.uniform(-4, 7, 5)
    theta = rng.uniform(-20, 20, (500, 5))
    turned = turn(robot, theta, near)
    np.testing.assert_allclose(np.cos(turned - theta), 1.0, atol=1e-12)
    for row, result in zip(theta, turned, strict=True):
        for j in range(5):
            everywhere = row[j] + 2 * np.pi * np.arange(-6, 7)
            nearest = everywhere[np.abs(everywhere - near[j]).argmin()]
            middle = everywhere[np.abs(everywhere - 1.5).argmin()]
            assert result[j] == pytest.approx(nearest if -5 <= nearest <= 8 else middle, abs=1e-12)
