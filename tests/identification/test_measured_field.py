"""The measured map: exact at its points, linear between them, silent outside, and checked for what it must be."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.measured_field import MeasuredField
from robomill.identification.synthesis import simulated_tests, three_directions
from robomill.io.load_tests import read_measured_map
from robomill.io.samples import samples_dir

ROBOT = rm.load_robot("slavkovic_5r").with_compliance_set("table_3")
FILES = samples_dir() / "load_tests"


def grid_points(nx=5, ny=4, nz=3):
    axes = np.linspace(-0.6, 0.6, nx), np.linspace(-1.6, -1.0, ny), np.linspace(-0.4, 0.1, nz)
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def linear_field(p):
    """A compliance that is linear in the place, symmetric and positive in the box."""
    C = np.array([[3.0, 0.2, -0.3], [0.2, 2.5, -1.0], [-0.3, -1.0, 4.0]])
    slope = np.array([[0.5, 0.1, 0], [0.1, -0.3, 0.2], [0, 0.2, 0.1]])
    return (C + p[..., :1, None] * slope + p[..., 1:2, None] * 0.2 * np.eye(3) - p[..., 2:, None] * 0.1 * slope) * 1e-6


def theta_at(p):
    x_M = np.concatenate([p, np.zeros((len(p), 2))], axis=1)
    return rm.inverse_kinematics(ROBOT, rm.pose_from_world(x_M)).theta


@pytest.mark.parametrize("scattered", [False, True])
def test_a_linear_field_is_met_exactly(scattered):
    p = grid_points()
    if scattered:
        p = np.concatenate([p, [[0.01, -1.31, -0.11]]])  # no grid any more
    field = MeasuredField(np.random.default_rng(0).permutation(p), np.zeros((len(p), 3, 3)))
    field = MeasuredField(field.p, linear_field(field.p))
    assert (field.lines is None) == scattered
    inside = np.random.default_rng(1).uniform([-0.6, -1.6, -0.4], [0.6, -1.0, 0.1], (200, 3))
    np.testing.assert_allclose(field.compliance(inside), linear_field(inside), rtol=1e-9, atol=1e-18)
    np.testing.assert_allclose(field.compliance(field.p), field.C, rtol=1e-9, atol=1e-18)
    batch = field.compliance(inside.reshape(10, 20, 3))
    np.testing.assert_array_equal(batch.reshape(-1, 3, 3), field.compliance(inside))


def test_outside_is_nan_with_its_distance():
    p = grid_points()
    field = MeasuredField(p, linear_field(p))
    out = np.array([[0.0, -0.9, 0.0], [0.9, -1.3, 0.0], [0, -1.3, 1.0], [np.nan, 0, 0]])
    assert not field.inside(out).any()
    assert np.isnan(field.deflection(out, [0, 100.0, 0])).all()
    assert field.distance(out)[2] == pytest.approx(0.9, abs=0.2)
    assert field.inside(p).all()
    assert (field.distance(p) < 1e-12).all()


def test_interpolation_keeps_symmetry_and_positivity():
    rng = np.random.default_rng(4)
    p = grid_points()
    roots = rng.normal(size=(len(p), 3, 3)) * 1e-3
    field = MeasuredField(p, roots @ np.swapaxes(roots, 1, 2) + 1e-9 * np.eye(3))
    C = field.compliance(rng.uniform([-0.6, -1.6, -0.4], [0.6, -1.0, 0.1], (500, 3)))
    np.testing.assert_allclose(C, np.swapaxes(C, 1, 2), rtol=1e-9)
    assert (np.linalg.eigvalsh(C)[:, 0] > 0).all()
    assert field.findings == ()


def test_the_map_of_a_joint_model_is_that_model_between_the_points():
    """Second order in the spacing: with a third of the spacing the error falls to about a ninth."""
    rng = np.random.default_rng(2)
    inside = rng.uniform([-0.6, -1.6, -0.4], [0.6, -1.0, 0.1], (300, 3))
    truth = rm.cartesian_compliance(ROBOT, theta_at(inside))
    errors = []
    for n in (4, 10):
        p = grid_points(n, n, n)
        field = MeasuredField(p, rm.cartesian_compliance(ROBOT, theta_at(p)))
        errors.append(np.abs(field.compliance(inside) - truth).max())
    assert np.log(errors[0] / errors[1]) / np.log(3.0) == pytest.approx(2.0, abs=0.35)


def test_one_level_holds_near_its_plane_only():
    p = grid_points(5, 4, 1) * [1, 1, 0]
    field = MeasuredField(p, linear_field(p), reach=0.2)
    assert field.inside([0.01, -1.3, 0.002])
    assert not field.inside([0.01, -1.3, 0.3])
    line = MeasuredField(p[::4], linear_field(p[::4]))
    np.testing.assert_allclose(
        line.compliance([0.15, p[0, 1], 0]), linear_field(np.array([0.15, p[0, 1], 0])), rtol=1e-9
    )


def test_matrices_come_back_from_tests_in_any_directions():
    rng = np.random.default_rng(6)
    theta = np.repeat(theta_at(grid_points(3, 2, 1)), 4, axis=0)
    tests = simulated_tests(ROBOT, theta, rng.normal(size=(len(theta), 3)) * 100)
    field = MeasuredField.from_tests(ROBOT, tests)
    np.testing.assert_allclose(field.C, rm.cartesian_compliance(ROBOT, theta_at(field.p)), rtol=1e-6, atol=1e-13)


def test_the_sample_grid_is_read_as_a_map():
    field = read_measured_map(FILES / "grid_45x6.csv", ROBOT)
    assert [len(line) for line in field.lines] == [9, 5, 6]
    truth = rm.cartesian_compliance(ROBOT, theta_at(field.p))
    assert np.abs(field.C - truth).max() < 6 * 4e-6 / 250.0  # noise, and a stiff tool spring
    np.testing.assert_allclose(field.modelled(ROBOT), truth, rtol=1e-12)
    assert field.findings == ()
    assert field.asymmetry.max() < 0.05
    np.testing.assert_allclose(field.symmetric().C, np.swapaxes(field.symmetric().C, 1, 2))
    delta = field.deflection([0.0, -1.3, 0.0], [0.0, 100.0, 0.0])
    assert delta[1] == pytest.approx(0.264e-3, abs=4e-6)


def test_what_no_elastic_arm_can_be_is_said():
    p = grid_points(3, 3, 2)
    C = linear_field(p).copy()
    C[4, 0, 1] += 3e-6
    C[7] = -C[7]
    levels = [f.message for f in MeasuredField(p, C).findings]
    assert any("1 of 18 matrices are not symmetric" in text for text in levels)
    assert any("1 of 18 matrices are not positive" in text for text in levels)
    AB = np.zeros((18, 2))
    AB[3] = 0.2
    assert any("orientations" in f.message for f in MeasuredField(p, linear_field(p), AB).findings)


def test_refusals():
    theta, F = three_directions(theta_at(grid_points(2, 2, 1)), 250.0)
    tests = simulated_tests(ROBOT, theta, F)
    with pytest.raises(LoadTestError, match="Row 1: this pose is not fully measured"):
        MeasuredField.from_tests(ROBOT, tests.without([2]))
    with pytest.raises(LoadTestError, match="twice"):
        MeasuredField(np.zeros((2, 3)), np.ones((2, 3, 3)))
    with pytest.raises(LoadTestError, match="single joints"):
        read_measured_map(FILES / "one_joint_at_a_time.csv", ROBOT)
    diagonal = np.array([[0, 0, 0], [0.1, 0.1, 0], [0.3, 0.3, 0.0]])
    with pytest.raises(LoadTestError, match="one line"):
        MeasuredField(diagonal, np.ones((3, 3, 3))).compliance([0.05, 0.05, 0])
