"""Propagated bands against Monte Carlo, against the closed form at the milling test, and source by source."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.identification.fit.confidence import quantile
from robomill.identification.fit.estimate import identify
from robomill.identification.fit.models import Model
from robomill.identification.knowledge import Knowledge
from robomill.identification.measured_field import MeasuredField
from robomill.identification.propagation import length_derivative, uncertain_by_map, uncertain_deflection
from robomill.io.samples import samples_dir
from tests.identification.oracles import guessed, monte_carlo
from tests.identification.synthetic import simulated_tests

ROBOT = rm.load_robot("slavkovic_5r")
PATH = np.stack([np.linspace(-0.12, 0.12, 5), np.full(5, -1.3), *np.zeros((3, 5))], axis=-1)
THETA = rm.inverse_kinematics(ROBOT, rm.pose_from_world(PATH)).theta
F = np.tile([0.0, 100.0, -20.0], (5, 1))
RESULT = identify(ROBOT, rm.read_load_tests(samples_dir() / "load_tests" / "nine_points.csv"))


def close(found, drawn, within):
    """Within ``within`` of Monte Carlo wherever the band is more than a thousandth of the widest one."""
    spread = drawn.std(axis=0, ddof=1)
    big = spread > 1e-3 * spread.max()
    np.testing.assert_allclose(found[big], spread[big], rtol=within)


@pytest.mark.parametrize(
    "known",
    [
        guessed(ROBOT, compliance=0.1),
        guessed(ROBOT, force=[5.0, 10.0, 3.0]),
        guessed(ROBOT, compliance=[0.05, 0.1, 0.02, 0.3, 0.08], force=[5.0, 10.0, 3.0]),
        Knowledge.of(RESULT, ROBOT).noise_only(),
    ],
    ids=["compliance", "force", "both", "identified"],
)
def test_bands_agree_with_monte_carlo(known):
    """5 % is the bar; 8000 draws leave 0.8 % of sampling error on a standard deviation."""
    arm = RESULT.applied_to(ROBOT)
    found = uncertain_deflection(arm, THETA, F, known)
    close(found.std, monte_carlo(arm, THETA, F, known, draws=8000, seed=1), 0.05)


def test_bands_from_lengths_agree_with_monte_carlo():
    known = guessed(ROBOT, compliance=0.08, force=[5.0, 8.0, 3.0], length=5e-3)
    found = uncertain_deflection(ROBOT, THETA[:2], F[:2], known)
    close(found.std, monte_carlo(ROBOT, THETA[:2], F[:2], known, draws=3000, seed=2), 0.05)


def test_identification_repeated_scatters_as_the_band_says():
    """The whole chain: measure again and again, identify, predict the slot; its scatter is the propagated band."""
    arm = ROBOT.with_compliance_set("table_3")
    tests = rm.read_load_tests(samples_dir() / "load_tests" / "nine_points.csv")
    D = Model().tip_regressor(arm, THETA, F)
    predicted = []
    for seed in range(200):
        again = simulated_tests(arm, tests.theta, tests.wrench[:, :3], noise=1e-6, seed=seed)
        predicted.append(D @ identify(arm, again).parameters)
    once = identify(arm, simulated_tests(arm, tests.theta, tests.wrench[:, :3], noise=1e-6, seed=0))
    band = uncertain_deflection(arm, THETA, F, Knowledge.of(once, arm).noise_only()).std * (1e-6 / once.noise)
    scatter = np.std(predicted, axis=0, ddof=1)
    np.testing.assert_allclose(
        band, scatter, rtol=0.2, atol=1e-9
    )  # 200 repetitions leave 5 % of sampling error, the one band 8 %


def test_closed_form_at_the_milling_test():
    """At X = 0, tool vertical: C_yy = C_3 h^2 + C_5 a_5^2, so 10 % of each joint gives 10 % of each share."""
    theta = rm.inverse_kinematics(ROBOT, rm.pose_from_world([0, -1.3, 0, 0, 0])).theta
    found = uncertain_deflection(ROBOT, theta, [0, 100.0, 0], guessed(ROBOT, compliance=0.1))
    J_v = rm.geometric_jacobian(ROBOT, theta)[:3]
    shares = ROBOT.C_theta * J_v[1] ** 2 * 100.0
    assert found.delta[1] == pytest.approx(shares.sum())
    assert found.delta[1] == pytest.approx(0.2295e-3, abs=1e-7)
    assert found.std[1] == pytest.approx(0.1 * np.linalg.norm(shares))
    assert found.half_along([0, 1.0, 0]) == pytest.approx(1.959964 * 0.1 * np.linalg.norm(shares))


def test_sources_add_in_squares_and_batch_is_loop():
    known = guessed(ROBOT, compliance=0.1, force=[5.0, 10.0, 3.0], length=2e-3)
    found = uncertain_deflection(ROBOT, THETA, F, known)
    total = sum(found.by(source) ** 2 for source in ("compliances", "force", "lengths"))
    np.testing.assert_allclose(found.std**2, total, rtol=1e-12)
    assert (found.by("model") == 0.0).all()
    assert found.parts.shape == (5, 4, 3, 3), "compliances, model, force and lengths"
    u = F / np.linalg.norm(F, axis=-1, keepdims=True)
    along = sum(found.by_along(source, u) ** 2 for source in ("compliances", "force", "lengths"))
    np.testing.assert_allclose(found.half_along(u), 1.959964 * np.sqrt(along), rtol=1e-6)
    for k in range(5):
        one = uncertain_deflection(ROBOT, THETA[k], F[k], known)
        np.testing.assert_allclose(one.covariance, found.covariance[k], rtol=1e-9, atol=1e-20)
    nothing = uncertain_deflection(ROBOT, THETA, F, Knowledge(Model(), ROBOT.C_theta, np.zeros((5, 5))))
    assert (nothing.std == 0).all()


def test_length_derivative_is_of_second_order():
    L = length_derivative(ROBOT, THETA, F, guessed(ROBOT))
    assert L.shape == (5, 3, 10)
    delta = Model().tip_regressor(ROBOT, THETA, F) @ ROBOT.C_theta
    errors = []
    for step in (4e-3, 2e-3):
        longer = ROBOT.replace(a=ROBOT.a + step * np.array([0, 1, 0, 0, 0]))
        moved = Model().tip_regressor(longer, THETA, F) @ ROBOT.C_theta
        errors.append(np.abs(moved - delta - step * L[..., 1]).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("name", ["a", "d"])
def test_one_length_alone_widens_the_band_by_what_it_moves(name):
    """The arm made a millimetre longer and shorter in its second link, all else being known exactly."""
    lengths = np.zeros(10)
    lengths[1 if name == "a" else 6] = 2e-3
    longer, shorter = (
        ROBOT.replace(**{name: getattr(ROBOT, name) + step * np.array([0, 1, 0, 0, 0])}) for step in (1e-3, -1e-3)
    )
    moved = [np.einsum("mij,mj->mi", rm.cartesian_compliance(arm, THETA), F) for arm in (longer, shorter)]
    found = uncertain_deflection(ROBOT, THETA, F, replace(guessed(ROBOT), lengths=lengths))
    np.testing.assert_allclose(found.std, np.abs(moved[0] - moved[1]), rtol=1e-3, atol=1e-12)


def test_unseen_joints_widen_the_band_rather_than_narrow_it():
    theta = rm.read_load_tests(samples_dir() / "load_tests" / "nine_points.csv").theta[::3]
    blind = identify(ROBOT, simulated_tests(ROBOT, theta, np.tile([0.0, 0.0, -250.0], (9, 1)), noise=1e-6))
    known = Knowledge.of(blind, ROBOT)
    assert known.covariance[0, 0] == pytest.approx(ROBOT.C_theta[0] ** 2)
    push = uncertain_deflection(blind.applied_to(ROBOT), THETA, [100.0, 0, 0], known)
    assert (push.std[:, 0] > 0.3 * push.delta[:, 0]).all()


def test_what_was_identified_is_predicted_with_its_extra_springs():
    tests = rm.read_load_tests(samples_dir() / "load_tests" / "tilted_bending_tool.csv")
    result = identify(ROBOT, tests, "joints+bending+tool")
    theta, load = tests.theta[::3], tests.wrench[::3, :3]
    found = uncertain_deflection(ROBOT, theta, load, Knowledge.of(result, ROBOT).widened(ROBOT, force=2.0))
    gap = np.abs(found.delta - tests.displacement[::3, :3])
    assert gap.max() < 4 * result.noise
    assert (found.by("compliances") < result.noise).all()
    assert (found.by("force") > 0).all()
    assert found.dof == result.dof


def test_unreached_points_are_nan():
    theta = THETA.copy()
    theta[2] = np.nan
    found = uncertain_deflection(ROBOT, theta, F, guessed(ROBOT, compliance=0.1))
    assert np.isnan(found.std[2]).all()
    assert np.isfinite(found.std[[0, 1, 3, 4]]).all()


def test_quantiles():
    assert quantile(None) == pytest.approx(1.959964, abs=1e-6)
    assert quantile(76) == pytest.approx(1.9917, abs=1e-4)
    found = uncertain_deflection(ROBOT, THETA, F, Knowledge.of(RESULT, ROBOT))
    np.testing.assert_allclose(found.half_width(), quantile(RESULT.dof) * found.std)


def test_a_map_carries_the_forces_spread_through_its_own_matrices():
    """Linear in the force: drawn forces, displaced by the map one by one, scatter as said; both parts add up."""
    C = rm.cartesian_compliance(ROBOT, THETA)
    field = MeasuredField(PATH[:, :3], C, PATH[:, 3:], 0.1, stderr=np.abs(C) * 0.02)
    A = np.array([[5.0, 0.0, 0.0], [3.0, 8.0, 0.0], [-2.0, 1.0, 4.0]])
    p = PATH[:, :3]
    alone, both = uncertain_by_map(field, p, F), uncertain_by_map(field, p, F, A @ A.T)
    assert both.parts.shape == (*np.shape(both.delta)[:-1], 4, 3, 3)
    drawn = np.random.default_rng(8).normal(size=(40_000, 3)) @ A.T
    for k in range(5):
        expected = np.cov(C[k] @ drawn.T)
        got = both.covariance[k] - alone.covariance[k]
        np.testing.assert_allclose(got, expected, atol=0.03 * np.abs(expected).max())
        np.testing.assert_allclose(both.by("force")[k], np.sqrt(np.diag(C[k] @ A @ A.T @ C[k].T)), rtol=1e-9)
    np.testing.assert_array_equal(alone.by("force"), np.zeros((5, 3)))
    np.testing.assert_allclose(both.delta, np.einsum("mij,mj->mi", C, F), rtol=1e-9)
