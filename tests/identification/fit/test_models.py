"""Which springs a model has, and that their law is the one of the springs that the simulation uses."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.fit.models import MODELS, Model, Parameter
from robomill.identification.load_test import LoadTests
from robomill.kinematics.forward import joint_frames

ROBOT = rm.load_robot("slavkovic_5r").with_compliance_set("table_3")
THETA = np.random.default_rng(0).uniform(ROBOT.limits[:, 0], ROBOT.limits[:, 1], (4, 5))
JOINTS = [f"joint {j}" for j in range(1, 6)]
BENDING = [f"bending {u} at joint {j}" for j in (2, 3) for u in "xy"]
TOOL = ["tool across", "tool along"]


@pytest.mark.parametrize(
    ("name", "labels"),
    [
        ("joints", JOINTS),
        ("joints+bending", JOINTS + BENDING),
        ("joints+tool", JOINTS + TOOL),
        ("joints+bending+tool", JOINTS + BENDING + TOOL),
        ("constant", ["C_xx", "C_yy", "C_zz", "C_xy", "C_xz", "C_yz"]),
    ],
)
def test_parameters(name, labels):
    parameters = Model(name).parameters(ROBOT)
    assert [p.label for p in parameters] == labels
    assert [p.joint for p in parameters] == [int(v[-1]) if v in JOINTS else None for v in labels]
    assert [p.signed for p in parameters] == [v in ("C_xy", "C_xz", "C_yz") for v in labels]
    assert [p.turns for p in parameters] == [v in JOINTS + BENDING for v in labels]
    assert set(MODELS) >= {name}
    D = Model(name).tip_regressor(ROBOT, THETA, np.ones(3))
    assert D.shape == (4, 3, len(labels))


def test_a_sliding_joint_shifts():
    assert not Parameter("joint", 2, slides=True).turns
    with pytest.raises(LoadTestError, match="expected one of joints"):
        Model("rubber")
    with pytest.raises(LoadTestError, match="Bending at joint 7: expected one of the free joints 1, 2, 3, 4, 5"):
        Model("joints+bending", (7,)).parameters(ROBOT)
    twice = Model("joints+bending", (4, 4, 1)).parameters(ROBOT)
    assert [(p.at, p.axis) for p in twice[5:]] == [(4, "x"), (4, "y"), (1, "x"), (1, "y")]


def test_each_column_is_a_small_turn_or_shift_of_everything_beyond_it():
    """Oracle: lay the spring's rotation matrix between the frames and watch the point."""
    model, offset, h = Model("joints+bending+tool"), np.array([0.02, -0.01, 0.05]), 1e-6
    for theta in THETA:
        frames = joint_frames(ROBOT, theta)
        point = frames[-1, :3, 3] + frames[-1, :3, :3] @ offset
        columns = model.columns(ROBOT, theta, offset)
        shafts = [(frames[i, :3, 3], frames[i, :3, 2]) for i in range(5)]
        shafts += [(frames[i, :3, 3], frames[i, :3, k]) for i in (1, 2) for k in (0, 1)]
        for s, (origin, axis) in enumerate(shafts):
            K = h * np.cross(axis, np.eye(3)).T
            R = np.eye(3) + K + K @ K / 2
            moved = (origin + R @ (point - origin) - point) / h
            np.testing.assert_allclose(columns[:3, s], moved, atol=1e-5)
            np.testing.assert_allclose(columns[3:, s], axis, atol=1e-12)
        np.testing.assert_allclose(columns[:3, 9:], frames[-1, :3, :3], atol=1e-12)
        assert not columns[3:, 9:].any()


def test_displacement_is_work_of_the_load_times_motion_of_the_gauge():
    model = Model("joints+bending+tool")
    rng = np.random.default_rng(1)
    wrench, force_point, gauge = rng.normal(size=(4, 6)), rng.normal(size=3) * 0.1, rng.normal(size=3) * 0.1
    tests = LoadTests(wrench, np.ones((4, 6)), theta=THETA, force_point=force_point, measuring_point=gauge)
    D = model.terms(ROBOT, tests)[:, :, 0]
    for k in range(4):
        at_force, at_gauge = (model.columns(ROBOT, THETA[k], point) for point in (force_point, gauge))
        each = at_gauge * (wrench[k] @ at_force)
        np.testing.assert_allclose(D[k, :, :9], each[:, :9], rtol=1e-12, atol=1e-15)
        np.testing.assert_allclose(D[k, :, 9], each[:, 9] + each[:, 10], rtol=1e-12, atol=1e-15)
        np.testing.assert_allclose(D[k, :, 10], each[:, 11], rtol=1e-12, atol=1e-15)
    tip = LoadTests(wrench[:, :3], np.ones((4, 3)), theta=THETA)
    at_tip = model.terms(ROBOT, tip)[:, :, 0][:, :3]
    np.testing.assert_allclose(model.tip_regressor(ROBOT, THETA, wrench[:, :3]), at_tip, atol=1e-15)


def test_the_compliance_is_what_each_force_moves():
    model = Model("joints+tool")
    values = np.linspace(1, 2, 7) * 1e-7
    C = model.compliance(ROBOT, THETA, values)
    F = np.random.default_rng(2).normal(size=(4, 3))
    np.testing.assert_allclose(np.einsum("mij,mj->mi", C, F), model.tip_regressor(ROBOT, THETA, F) @ values, rtol=1e-12)
    np.testing.assert_allclose(C[2], model.compliance(ROBOT, THETA[2], values), rtol=1e-12)


def test_one_matrix_for_every_pose():
    C = np.array([[2.0, 0.3, -0.2], [0.3, 2.2, -1.0], [-0.2, -1.0, 3.0]])
    values = np.array([2.0, 2.2, 3.0, 0.3, -0.2, -1.0])
    model = Model("constant")
    np.testing.assert_allclose(model.compliance(ROBOT, THETA, values), np.tile(C, (4, 1, 1)))
    F = np.random.default_rng(3).normal(size=(4, 3))
    np.testing.assert_allclose(model.tip_regressor(ROBOT, THETA, F) @ values, F @ C)
    D = model.terms(ROBOT, LoadTests(F, np.ones((4, 3)), theta=THETA))[:, :, 0]
    np.testing.assert_allclose(D[:, :3] @ values, F @ C)
    assert np.isnan(D[:, 3:]).all()
    world = LoadTests(F, np.ones((4, 3)), x_M=np.zeros((4, 5)))
    with pytest.raises(LoadTestError, match="with_joints"):
        model.terms(ROBOT, world)[:, :, 0]


@pytest.mark.parametrize(("readings", "names"), [(29, ["joints"]), (30, ["joints", "joints+bending"])])
def test_slips_are_sought_beside_bending_where_every_spring_has_two_readings(readings, names):
    """Five joints, each with two bendings."""
    assert [model.name for model in Model.asked_of_slips(ROBOT, readings)] == names
