"""One linear row a measured number: against the rows written out by hand, and weights found by their definition."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import build_system
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.synthesis import three_directions
from tests.identification.synthetic import simulated_tests

ROBOT = rm.load_robot("slavkovic_5r").with_compliance_set("table_3")
RNG = np.random.default_rng(3)
THETA = RNG.uniform(ROBOT.limits[:, 0], ROBOT.limits[:, 1], (6, 5))


def test_rows_are_lever_by_lever():
    """A = J_v,ci (J_v^T F)_i, number by number; what was not measured has no row."""
    theta, F = three_directions(THETA, 200.0)
    moved = RNG.normal(size=(18, 3)) * 1e-3
    moved[4, 1] = moved[7, 0] = np.nan
    system = build_system(ROBOT, LoadTests(F, moved, theta=theta), Model())
    rows = []
    for k, c in np.argwhere(np.isfinite(moved)):
        J_v = rm.geometric_jacobian(ROBOT, theta[k])[:3]
        rows.append((J_v[c] * (J_v.T @ F[k]), moved[k, c], k, c, k // 3))
    A, b, test, component, pose = (np.array(v) for v in zip(*rows, strict=True))
    np.testing.assert_allclose(system.A, A, rtol=1e-12, atol=1e-18)
    np.testing.assert_array_equal(system.b, b)
    np.testing.assert_array_equal(system.test, test)
    np.testing.assert_array_equal(system.component, component)
    groups = {p: set(system.pose[pose == p]) for p in range(6)}
    assert all(len(group) == 1 for group in groups.values())
    assert len(np.unique(system.pose)) == 6
    assert system.linear.all()
    assert not system.signed.any()
    assert (system.noise == 1).all()
    assert system.given is None


def test_a_gauge_reads_what_moves_along_it_and_turns_are_read_beside_it():
    """Rows g . J_v,ci (J_v^T F)_i for three gauges a test, each along its own way, and J_w,ci for the turns."""
    theta, F = three_directions(THETA, 200.0)
    along = RNG.normal(size=(18, 3, 3))
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    moved = RNG.normal(size=(18, 6)) * 1e-3
    moved[2, 1] = moved[5, 0] = moved[9, 4] = np.nan
    for freed in ((), ("force",)):
        system = build_system(ROBOT, LoadTests(F, moved, theta=theta, gauges=along), Model(), freed)
        rows = []
        for k, c in np.argwhere(np.isfinite(moved)):
            J = rm.geometric_jacobian(ROBOT, theta[k])
            rows.append((along[k, c] @ J[:3] if c < 3 else J[c]) * (J[:3].T @ F[k]))
        np.testing.assert_allclose(system.A, rows, rtol=1e-12, atol=1e-18)
        np.testing.assert_array_equal(system.b, moved[np.isfinite(moved)])


def test_weights_noise_and_choices_are_those_of_weighted_least_squares():
    theta, F = three_directions(THETA, 200.0)
    sigma = RNG.uniform(1e-6, 9e-6, 18)
    tests = simulated_tests(ROBOT, theta, F, noise=5e-6, seed=2)
    system = build_system(ROBOT, LoadTests(F, tests.displacement, theta=theta, noise=sigma), Model())
    np.testing.assert_allclose(system.noise, np.repeat(sigma, 3))
    assert system.given == 1.0
    weights = RNG.uniform(0.1, 1.0, 54)
    weights[5], weights[6], weights[7] = 0.0, 0.9e-3, 1.1e-3
    chosen = RNG.random(54) < 0.8
    chosen[5:8] = True
    for w, c in ((None, None), (weights, None), (None, chosen), (weights, chosen)):
        use = np.ones(54, dtype=bool) if c is None else c
        root = np.sqrt(np.ones(54) if w is None else w) / system.noise
        x = np.linalg.lstsq((system.A * root[:, None])[use], (system.b * root)[use], rcond=None)[0]
        factored = system.factored(system.factor(w, c), system.count(w, c))
        np.testing.assert_allclose(factored.fit().fit.free, x, rtol=1e-8)
        assert system.count(w, c) == use.sum() - (0 if w is None else 2)
        R = system.factor(w, c)
        B = np.column_stack([system.A, system.b])[use] * root[use, None]
        size = np.linalg.norm(B, axis=0)
        np.testing.assert_allclose(R.T @ R / np.outer(size, size), B.T @ B / np.outer(size, size), atol=1e-12)


def test_noise_that_is_stated_for_some_tests_only_is_the_median_for_the_rest():
    theta, F = three_directions(THETA, 200.0)
    sigma = np.full(18, np.nan)
    sigma[:3] = 1e-6, 2e-6, 9e-6
    tests = simulated_tests(ROBOT, theta, F)
    system = build_system(ROBOT, replace(tests, noise=sigma), Model())
    np.testing.assert_allclose(system.noise, np.repeat([1e-6, 2e-6, 9e-6, *[2e-6] * 15], 3))
    assert system.given is None
    for bad in (0.0, -1e-6):
        sigma[1] = bad
        with pytest.raises(LoadTestError, match="above zero"):
            build_system(ROBOT, replace(tests, noise=sigma), Model())


@pytest.mark.parametrize("stated", [False, True])
def test_displacements_and_rotations_are_weighed_by_what_is_left_of_each(stated):
    rng = np.random.default_rng(1)
    theta = rng.uniform(ROBOT.limits[:, 0], ROBOT.limits[:, 1], (40, 5))
    wrench = np.concatenate([rng.normal(size=(40, 3)) * 100, rng.normal(size=(40, 3)) * 20], axis=1)
    exact = Model().terms(ROBOT, LoadTests(wrench, np.ones((40, 6)), theta=theta))[:, :, 0] @ ROBOT.C_theta
    noisy = exact + rng.standard_normal(exact.shape) * np.array([20e-6] * 3 + [1e-6] * 3)
    noise = 5e-6 if stated else None
    system = build_system(ROBOT, LoadTests(wrench, noisy, theta=theta, noise=noise), Model())
    assert system.given is None
    assert not system.linear.all()
    np.testing.assert_array_equal(system.linear, system.component < 3)
    residual = system.A @ system.fit().x - system.b
    for kind in (system.linear, ~system.linear):
        rms = np.sqrt(np.mean(residual[kind] ** 2))
        np.testing.assert_allclose(system.noise[kind], rms, rtol=1e-3)
    assert system.noise[0] / system.noise[3] == pytest.approx(20, rel=0.3)
    exactly = build_system(ROBOT, LoadTests(wrench, exact, theta=theta), Model())
    np.testing.assert_allclose(exactly.fit().x, ROBOT.C_theta, rtol=1e-9)


def test_joint_tests_are_one_unknown_a_row():
    joint, torque = np.array([1, 2, 2, 5]), np.array([100.0, -50.0, 80.0, 20.0])
    tests = JointTests(joint, torque, 1e-6 * torque, noise=np.array([1e-6, 2e-6, 3e-6, 4e-6]))
    system = build_system(ROBOT, tests, Model())
    expected = np.zeros((4, 5))
    expected[range(4), joint - 1] = torque
    np.testing.assert_array_equal(system.A, expected)
    np.testing.assert_array_equal(system.b, 1e-6 * torque)
    np.testing.assert_array_equal(system.pose, range(4))
    np.testing.assert_array_equal(system.test, range(4))
    assert system.linear.all()
    assert system.given == 1.0
    with pytest.raises(LoadTestError, match=r"Row 2, joint: found 9"):
        build_system(ROBOT, JointTests(np.array([1, 9]), np.ones(2), np.ones(2)), Model())
    with pytest.raises(LoadTestError, match="joints"):
        build_system(ROBOT, tests, Model("joints+tool"))


def test_as_many_numbers_as_unknowns_are_enough_and_one_less_is_not():
    theta = THETA[:2]
    F = np.array([[100.0, 20, 30], [10.0, 90, 40]])
    moved = np.full((2, 3), 1e-4)
    moved[1, 2] = np.nan
    assert len(build_system(ROBOT, LoadTests(F, moved, theta=theta), Model()).b) == 5
    moved[1, 1] = np.nan
    with pytest.raises(LoadTestError, match="4 measured numbers for 5 unknown"):
        build_system(ROBOT, LoadTests(F, moved, theta=theta), Model())
    one = LoadTests(np.eye(3) * 100, np.ones((3, 3)) * 1e-4, theta=np.repeat(THETA[:1], 3, axis=0))
    with pytest.raises(LoadTestError, match="one pose"):
        build_system(ROBOT, one, Model())
    assert build_system(ROBOT, one, Model("constant")).signed.sum() == 3
    turned = LoadTests(np.eye(3) * 100, np.column_stack([np.full((3, 3), np.nan), np.ones((3, 3))]), theta=THETA[:3])
    with pytest.raises(LoadTestError, match="nothing measured"):
        build_system(ROBOT, turned, Model("constant"))


def test_by_size_a_test_counts_by_what_it_moved_but_what_hardly_moved_by_a_tenth_of_the_median():
    """Root mean square of what was read, over the median of all tests; where nothing moved all count alike."""
    theta, F = three_directions(THETA, 200.0)
    moved = RNG.normal(size=(18, 3)) * 1e-3 * RNG.uniform(0.3, 3.0, (18, 1))
    moved[4, 1] = moved[7, 0] = np.nan
    moved[10] *= 1e-4
    size = [float(np.sqrt(np.mean([v * v for v in row if v == v]))) for row in moved]
    middle = sorted(size)[8:10]
    counts = [max(each / (0.5 * sum(middle)), 0.1) for each in size]
    assert 0.1 in counts
    found = build_system(ROBOT, LoadTests(F, moved, theta=theta), Model(), by_size=True)
    plain = build_system(ROBOT, LoadTests(F, moved, theta=theta), Model())
    np.testing.assert_allclose(found.noise / plain.noise, np.array(counts)[found.test], rtol=1e-12)
    still = build_system(ROBOT, LoadTests(F, 0.0 * moved, theta=theta), Model(), by_size=True)
    np.testing.assert_array_equal(still.noise, plain.noise)


def test_where_nothing_moved_every_test_counts_alike_by_its_size():
    theta, F = three_directions(THETA, 200.0)
    still = build_system(ROBOT, LoadTests(F, np.zeros((18, 3)), theta=theta), Model(), by_size=True)
    np.testing.assert_array_equal(still.noise, 1.0)
