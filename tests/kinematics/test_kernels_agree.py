"""The compiled kernels and the NumPy columns are the same formulas."""

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.cartesian import pose_jacobian_compliance
from robomill.kinematics import compiled
from robomill.kinematics.inverse import all_branches
from robomill.workspace.fields import compliance_field
from robomill.workspace.grid import box_grid


@pytest.fixture(scope="module", autouse=True)
def _kernels():
    if not compiled.warm_up(wait=True):
        pytest.skip(f"no compiled kernels: {compiled.status()}")


@pytest.fixture
def numpy_only(monkeypatch):
    """A context in which no kernel is loaded."""

    class Context:
        def __enter__(self):
            for kernels in compiled._registered:
                monkeypatch.setattr(kernels, "loaded", None)

        def __exit__(self, *args):
            monkeypatch.undo()

    return Context()


NAMES = ["slavkovic_5r", "kuka_kr500", "kuka_kr270", "fanuc_r2000ic", "planar_3r"]


def _theta(robot, count=1000):
    return np.random.default_rng(0).uniform(robot.limits[:, 0], robot.limits[:, 1], (count, robot.n))


@pytest.mark.parametrize("name", NAMES)
def test_pose_jacobian_compliance(name, numpy_only):
    robot = rm.load_robot(name)
    theta = _theta(robot)
    fast = (rm.tool_pose(robot, theta), *pose_jacobian_compliance(robot, theta))
    with numpy_only:
        slow = (rm.tool_pose(robot, theta), *pose_jacobian_compliance(robot, theta))
    for a, b, tolerance in zip(fast, slow, (1e-13, 1e-13, 1e-13, 1e-18), strict=True):
        np.testing.assert_allclose(a, b, atol=tolerance, rtol=0)


def test_prismatic_joints(numpy_only):
    arm = rm.load_robot("kuka_kr500")
    robot = arm.replace(prismatic=[False, True, False, True, False, False])
    theta = _theta(robot)
    fast = rm.geometric_jacobian(robot, theta)
    with numpy_only:
        np.testing.assert_allclose(fast, rm.geometric_jacobian(robot, theta), atol=1e-13)


@pytest.mark.parametrize("name", NAMES[:4])
def test_all_branches(name, numpy_only):
    robot = rm.load_robot(name)
    T_MT = rm.tool_pose(robot, _theta(robot))
    fast, sound = all_branches(robot, T_MT)
    with numpy_only:
        slow, also = all_branches(robot, T_MT)
    np.testing.assert_array_equal(sound, also)
    apart = np.abs((fast - slow + np.pi) % (2 * np.pi) - np.pi)[sound]
    assert np.median(apart) < 1e-14
    assert apart.max() < 1e-7  # near a singular wrist


@pytest.mark.parametrize(
    ("name", "A", "B"), [("slavkovic_5r", 0, 0), ("slavkovic_5r", 0.4, -0.6), ("kuka_kr500", 0.2, 0.3)]
)
def test_fields(name, A, B, numpy_only):
    robot = rm.load_robot(name)
    grid = box_grid([-2.5, -2.5, -0.5], [2.5, 2.5, 1.0], 0.17)
    fast = compliance_field(robot, grid, A, B)
    with numpy_only:
        slow = compliance_field(robot, grid, A, B)
    assert 0.1 < fast.reached.mean() < 0.95
    np.testing.assert_array_equal(fast.reached, slow.reached)
    for key, tolerance in (("theta", 1e-9), ("J", 1e-9), ("shares", 1e-14), ("det_J", 1e-9)):
        np.testing.assert_allclose(getattr(fast, key), getattr(slow, key), atol=tolerance, rtol=0, err_msg=key)


def test_spin_search(numpy_only):
    robot = rm.load_robot("fanuc_r2000ic")
    T_MT = rm.tool_pose(robot, _theta(robot, 400))
    for options in ({}, {"near": np.full(6, 0.2)}, {"branch": "elbow down"}, {"spin": "fixed"}, {"spin": 0.4}):
        fast = rm.inverse_kinematics(robot, T_MT, **options)
        with numpy_only:
            slow = rm.inverse_kinematics(robot, T_MT, **options)
        np.testing.assert_array_equal(fast.reached, slow.reached)
        assert fast.reached.mean() > 0.3
        same = fast.reached & (fast.branch_index == slow.branch_index)
        assert same.sum() > 0.99 * fast.reached.sum()
        np.testing.assert_allclose(fast.theta[same], slow.theta[same], atol=1e-6)
        if fast.spin is not None:
            np.testing.assert_allclose(fast.spin[same], slow.spin[same], atol=1e-9)


def test_nan_configurations_stay_nan():
    robot = rm.load_robot("slavkovic_5r")
    theta = _theta(robot, 100)
    theta[7] = np.nan
    C = rm.cartesian_compliance(robot, theta)
    assert np.isnan(C[7]).all()
    assert np.isfinite(np.delete(C, 7, axis=0)).all()


def test_numpy_can_be_insisted_on(monkeypatch):
    monkeypatch.setenv("ROBOMILL_NUMPY", "1")
    assert not compiled.warm_up()
