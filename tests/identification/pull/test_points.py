"""Load point, gauge point and bending found from cable tests that an independent simulator made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares, nnls

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.fit.crossvalidation import Folded
from robomill.identification.fit.folds import folds_of
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import build_system
from robomill.identification.pull.points import Factored, Normal, at_shift
from tests.identification.cables import Arm, Rig, as_csv, in_tool, make, postures

ARMS = {name: (Arm.of(name), rm.load_robot(name)) for name in ("kuka_kr500", "fanuc_r2000ic")}
OFF_FORCE = 0.150 * np.array([0.6, 0.64, -0.48])
OFF_GAUGE = 0.080 * np.array([0.0, 0.6, 0.8])


def read(name, made, rig, off_force=OFF_FORCE, off_gauge=OFF_GAUGE):
    arm, robot = ARMS[name]
    text = as_csv(arm, made, rig.load_point + off_force, rig.gauge_point + off_gauge)
    return rm.read_load_tests(text, robot)


def held(interval, truth):
    return (interval[..., 0] <= truth) & (truth <= interval[..., 1])


def test_the_simulator_stands_where_the_robot_stands():
    for arm, robot in ARMS.values():
        for q in postures(arm, 3, np.random.default_rng(0)):
            np.testing.assert_allclose(rm.tool_pose(robot, q), arm.frames(q)[-1] @ arm.T_FT, atol=1e-12)


@pytest.mark.parametrize("name", ARMS)
def test_without_noise_points_and_stiffness_are_found_to_the_last_digits(name):
    arm, robot = ARMS[name]
    rig = Rig(noise=0.0, pull=(2.0, 6.0))  # small, so that turns are as good as vectors
    tests = read(name, make(arm, rig, 20, seed=1), rig)
    result = rm.identify(robot, tests, fit_points="both")
    np.testing.assert_allclose(result.C_theta, arm.C_theta, rtol=2e-4)  # as many digits as the file has
    force, gauge = result.points
    np.testing.assert_allclose(force.in_flange, rig.load_point, atol=2e-5)
    np.testing.assert_allclose(gauge.in_flange, rig.gauge_point, atol=2e-5)
    np.testing.assert_allclose(force.in_tool, in_tool(arm, rig.load_point), atol=2e-5)
    assert (force.off, gauge.off) == (pytest.approx(0.150, abs=2e-5), pytest.approx(0.080, abs=2e-5))


@pytest.mark.parametrize(("fit", "s"), [("force", 3), ("gauge", 3), ("both", 6)])
def test_the_fit_is_the_least_squares_minimum(fit, s):
    """scipy's own search over compliances and points together, from the equations at each trial point."""
    arm, robot = ARMS["kuka_kr500"]
    rig = Rig(noise=1e-5)
    tests = read("kuka_kr500", make(arm, rig, 25, seed=2), rig).with_joints(robot)
    system = build_system(
        robot, tests, Model(), {"force": ("force",), "gauge": ("gauge",)}.get(fit, ("force", "gauge"))
    )
    found = system.fit_points()
    parts = {"force": ("force_point",), "gauge": ("measuring_point",)}.get(fit, ("force_point", "measuring_point"))

    def residual(z):
        moved = {name: getattr(tests, name) + z[6 + 3 * k : 9 + 3 * k] for k, name in enumerate(parts)}
        D = Model().terms(robot, replace(tests, **moved))[:, :, 0][:, :3]
        return ((D @ (z[:6] * 1e-6)) - tests.displacement[:, :3]).ravel() * 1e5

    best = least_squares(residual, np.concatenate([arm.C_theta * 1e6, np.zeros(s)]), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    np.testing.assert_allclose(found.fit.x[:6], best.x[:6] * 1e-6, rtol=1e-5)
    np.testing.assert_allclose(found.shift, best.x[6:], atol=1e-6)
    covariance = np.linalg.inv(best.jac.T @ best.jac) * 2 * best.cost / (75 - 6 - s)
    np.testing.assert_allclose(np.sqrt(np.diag(found.fit.covariance))[6:], np.sqrt(np.diag(covariance))[6:], rtol=1e-3)
    np.testing.assert_allclose(
        np.sqrt(np.diag(found.fit.covariance))[:6] * 1e6, np.sqrt(np.diag(covariance))[:6], rtol=1e-3
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", ARMS)
def test_points_and_stiffness_lie_within_their_intervals(name):
    """Over many data sets: 95 % intervals of points and compliances hold the truth in 95 % of the cases."""
    arm, robot = ARMS[name]
    inside_points, inside_joints, falls = [], [], []
    for seed in range(16):
        rig = Rig(bending={2: (4e-7, 4e-7)})
        tests = read(name, make(arm, rig, 43, seed), rig)
        plain = rm.identify(robot, tests)
        result = rm.identify(robot, tests, "joints+bending", bending=(2,), fit_points="both")
        inside_joints.append(held(result.ci95, arm.C_theta))
        for point, truth in zip(result.points, (rig.load_point, rig.gauge_point), strict=True):
            inside_points.append(held(point.ci95, truth))
        falls.append(result.cv_relative_error / plain.cv_relative_error)
    assert np.mean(inside_points) >= 0.9
    assert np.mean(inside_joints) >= 0.9
    assert max(falls) < 2 / 3


def test_bending_is_found_at_its_joint_by_nested_cross_validation():
    arm, robot = ARMS["kuka_kr500"]
    rig = Rig(bending={3: (6e-7, 6e-7)})
    tests = read("kuka_kr500", make(arm, rig, 43, seed=4), rig)
    plain = rm.identify(robot, tests)
    result = rm.identify(robot, tests, bending="auto", fit_points="both")
    assert result.choice.bending_joints == (3,)
    assert len(result.votes) == 10
    assert result.cv_relative_error < plain.cv_relative_error * 2 / 3
    assert held(result.points[0].ci95, rig.load_point).sum() >= 2
    stiff = rm.identify(
        robot, read("kuka_kr500", make(arm, Rig(), 43, seed=4), Rig()), bending="auto", fit_points="both"
    )
    assert stiff.model == "joints"
    assert set(stiff.votes) == {()}


def test_nothing_of_a_fold_is_seen_by_its_own_prediction():
    """Readings of the fold that is predicted may be anything: the prediction does not change."""
    arm, robot = ARMS["kuka_kr500"]
    rig = Rig()
    tests = read("kuka_kr500", make(arm, rig, 30, seed=5), rig).with_joints(robot)
    fold = folds_of("pose", tests.pose_index(), tests.theta)
    predicted = []
    for spoil in (0.0, 5e-3):
        moved = tests.displacement.copy()
        moved[fold == 3, :3] += spoil
        system = build_system(robot, replace(tests, displacement=moved), Model(), ("force", "gauge"))
        folded = Folded(system, fold[system.test])
        error, _ = folded.predict(3, frozenset({3}))
        predicted.append(error + system.b[folded.fold == 3])
    np.testing.assert_allclose(predicted[0], predicted[1], rtol=0, atol=1e-12)


# ---- hard cases ----------------------------------------------------------------------------------------------------
def test_one_pose_is_refused():
    arm, robot = ARMS["kuka_kr500"]
    q = np.repeat(postures(arm, 1, np.random.default_rng(0)), 20, axis=0)
    rig = Rig()
    with pytest.raises(LoadTestError, match="one pose"):
        rm.identify(robot, read("kuka_kr500", make(arm, rig, q=q), rig), fit_points="both")


def test_a_point_moved_along_the_pull_is_not_known_and_that_is_said():
    """Every pull along the same line of the flange: the load point slides along it without a trace."""
    arm, robot = ARMS["kuka_kr500"]
    along = np.array([0.0, 0.6, 0.8])
    rig = Rig(along=along)
    tests = read("kuka_kr500", make(arm, rig, 43, seed=6), rig, OFF_FORCE, 0 * OFF_GAUGE)
    (force,) = rm.identify(robot, tests, fit_points="force").points
    assert force.flat is not None
    assert np.ptp(force.ci95, axis=1).max() > 1.0
    across = np.eye(3) - np.outer(along, along)
    np.testing.assert_allclose(across @ (force.in_flange - rig.load_point), 0.0, atol=0.01)


def test_one_wrong_row_among_forty_three_is_named_and_weighed_down():
    arm, robot = ARMS["kuka_kr500"]
    rig = Rig()
    tests = read("kuka_kr500", make(arm, rig, 43, seed=7), rig)
    moved = tests.displacement.copy()
    moved[20, :3] *= -1.0
    wrong = replace(tests, displacement=moved)
    assert int(tests.row[20]) in [o.row for o in rm.identify(robot, wrong, fit_points="both").outliers]
    robust = rm.identify(robot, wrong, fit_points="both", robust=True)
    for point, truth in zip(robust.points, (rig.load_point, rig.gauge_point), strict=True):
        np.testing.assert_allclose(point.in_flange, truth, atol=0.012)
    out = rm.identify(robot, wrong, fit_points="both", exclude=(int(tests.row[20]),))
    assert np.mean([held(p.ci95, t) for p, t in zip(out.points, (rig.load_point, rig.gauge_point), strict=True)]) > 0.6


def test_one_gauge_a_row_is_enough():
    arm, robot = ARMS["kuka_kr500"]
    rig = Rig()
    tests = read("kuka_kr500", make(arm, rig, 90, seed=8), rig)
    moved = tests.displacement.copy()
    moved[:, :3][np.arange(3)[None] != (np.arange(90) % 3)[:, None]] = np.nan
    result = rm.identify(robot, replace(tests, displacement=moved), fit_points="both")
    np.testing.assert_allclose(result.points[0].in_flange, rig.load_point, atol=0.02)
    np.testing.assert_allclose(result.C_theta[:3], arm.C_theta[:3], rtol=0.05)


def test_weights_by_size_and_blocks_of_neighbours_are_choices():
    arm, robot = ARMS["kuka_kr500"]
    rig = Rig(pull=(50.0, 5000.0), noise=0.0)
    made = make(arm, rig, 43, seed=9)
    errors = 1 + 0.03 * np.random.default_rng(9).standard_normal(made.moved.shape)  # errors that grow with the pull
    tests = read("kuka_kr500", replace(made, moved=made.truth * errors), rig, 0 * OFF_FORCE, 0 * OFF_GAUGE)
    miss = [np.abs(rm.identify(robot, tests, weights=w).C_theta / arm.C_theta - 1).mean() for w in ("equal", "size")]
    assert miss[1] < miss[0]
    fold = folds_of("neighbours", tests.pose_index(), tests.theta)
    assert sorted(np.bincount(fold)) == sorted(np.bincount(folds_of("pose", tests.pose_index(), tests.theta)))
    theta = tests.theta / tests.theta.std(axis=0)
    spread = [np.mean([theta[f == k].std(axis=0).mean() for k in range(10)]) for f in (fold, np.arange(43) % 10)]
    assert spread[0] < 0.8 * spread[1]
    assert rm.identify(robot, tests, leave_out="neighbours").treatment.leave_out == "neighbours"
    for wrong in ({"weights": "x"}, {"leave_out": "x"}, {"fit_points": "x"}, {"bending": "x"}):
        with pytest.raises(LoadTestError, match="expected"):
            rm.identify(robot, tests, **wrong)


# ---- the offer -----------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("off_force", "off_gauge", "offered"),
    [(OFF_FORCE, 0 * OFF_GAUGE, "force"), (0 * OFF_FORCE, OFF_GAUGE, "gauge"), (OFF_FORCE, OFF_GAUGE, "both")],
)
def test_points_that_are_off_are_offered(off_force, off_gauge, offered):
    arm, robot = ARMS["kuka_kr500"]
    rig = Rig()
    result = rm.identify(robot, read("kuka_kr500", make(arm, rig, 43, seed=10), rig, off_force, off_gauge))
    assert result.offer.fit_points == offered
    for point in result.offer.points:
        assert point.off == pytest.approx({"force": 0.150, "gauge": 0.080}[point.point], abs=0.02)
    assert f"fit-{offered}" in [f.code for f in result.findings]
    taken = rm.identify(
        robot, read("kuka_kr500", make(arm, rig, 43, seed=10), rig, off_force, off_gauge), fit_points=offered
    )
    assert taken.cv_relative_error == pytest.approx(result.offer.after)
    assert taken.offer is None


@pytest.mark.parametrize(("yields", "pulled"), [(1e-3, 1.0), (1.0, 1e8)])
def test_a_stiffer_arm_is_offered_the_same_points_whether_it_yields_less_or_is_pulled_harder(yields, pulled):
    rig = Rig()
    tests = read("kuka_kr500", make(ARMS["kuka_kr500"][0], rig, 43, seed=10), rig, OFF_FORCE, 0 * OFF_GAUGE)
    harder = replace(tests, displacement=yields * tests.displacement, wrench=pulled * tests.wrench)
    stiff = rm.identify(ARMS["kuka_kr500"][1], harder)
    assert stiff.offer is not None
    assert stiff.offer.fit_points == "force"
    assert stiff.offer.points[0].off == pytest.approx(0.150, abs=0.02)


def test_right_points_are_not_offered_to_be_moved():
    arm, robot = ARMS["kuka_kr500"]
    rig = Rig()
    offers = [
        rm.identify(robot, read("kuka_kr500", make(arm, rig, 43, s), rig, 0 * OFF_FORCE, 0 * OFF_GAUGE)).offer
        for s in range(12)
    ]
    assert offers == [None] * 12


def test_an_arm_of_seven_axes_is_as_good():
    rows = np.array([[0, 0, 0.34], [-90, 0, 0], [90, 0, 0.4], [90, 0, 0], [-90, 0, 0.4], [-90, 0, 0], [90, 0, 0.126]])
    limits = np.radians(np.tile([-170.0, 170.0], (7, 1)))
    T = np.eye(4)
    T[2, 3] = 0.1
    table = np.stack([np.radians(rows[:, 0]), rows[:, 1], rows[:, 2], np.zeros(7)], axis=-1)
    arm = Arm(table, np.ones(7), T, np.linspace(1, 4, 7) * 1e-5, limits)
    robot = rm.Robot(
        name="seven",
        convention="modified",
        alpha=table[:, 0],
        a=table[:, 1],
        d=table[:, 2],
        theta_offset=table[:, 3],
        limits_all=limits,
        C_theta_all=arm.C_theta,
        T_tool=T,
    )
    rng = np.random.default_rng(11)
    q = rng.uniform(-1.5, 1.5, (43, 7))
    rig = Rig(
        np.array([0.02, 0.03, 0.15]), np.array([-0.02, 0.05, 0.12]), ((1.6, -1.2, 0.9),), (40.0, 120.0), noise=1e-5
    )
    made = make(arm, rig, q=q, seed=11)
    tests = rm.read_load_tests(
        as_csv(arm, made, rig.load_point + np.array([0.03, 0.02, 0]), rig.gauge_point + np.array([0, 0.02, 0])), robot
    )
    result = rm.identify(robot, tests, fit_points="both")
    inside = [held(p.ci95, t) for p, t in zip(result.points, (rig.load_point, rig.gauge_point), strict=True)]
    assert np.sum(inside) >= 5
    assert held(result.ci95, arm.C_theta).sum() >= 6


@pytest.mark.parametrize("freed", [("force",), ("force", "gauge")])
def test_where_nothing_moved_nothing_gives_and_no_point_is_seen(freed):
    terms = 3 * 4 ** len(freed)
    R = np.triu(np.random.default_rng(0).normal(size=(terms + 1, terms + 1)))
    R[:, -1] = 0.0  # the readings
    found = Factored(R, 100, np.zeros(3, dtype=bool), freed).fit()
    assert not found.shift.any()
    assert not found.fit.x.any()
    assert found.fit.seen.tolist() == [True] * 3 + [False] * 3 * len(freed)


@pytest.mark.parametrize("freed", [("force",), ("force", "gauge")])
def test_the_way_to_a_point_is_the_same_in_any_unit_of_the_readings(freed):
    """Terms and readings a million times as large or small: the same shift and compliances, and no step is left."""
    rng = np.random.default_rng(3)
    k, p, s = 4 ** len(freed), 3, 3 * len(freed)
    x, shift = np.array([1.0, 2.0, 0.5]), rng.uniform(-0.4, 0.4, s)
    terms = rng.normal(size=(80, k, p))
    readings = at_shift(terms, shift, freed) @ x + 0.02 * rng.normal(size=80)
    whole = np.column_stack([terms.reshape(80, -1), readings])
    found = []
    for unit in (1.0, 1e-6, 1e6):
        normal = Normal((unit * whole).T @ (unit * whole), np.zeros(p, dtype=bool), freed)
        cost, at, gives = normal.descend(np.zeros(s))
        assert cost == pytest.approx(((at_shift(terms, at, freed) @ gives - readings) ** 2).sum() * unit**2, rel=1e-6)
        for step in np.concatenate([np.eye(s), -np.eye(s)]):
            assert normal.cost(at + 1e-3 * step)[0] > cost
        found.append(np.concatenate([at, gives]))
    np.testing.assert_allclose(found[1:], found[:1] * np.ones((2, 1)), atol=1e-9)
    np.testing.assert_allclose(found[0], [*shift, *x], atol=0.05)


def test_the_cost_of_a_shift_is_the_squared_residual_there():
    """Of equations that change with the shift, by scipy's fit above zero; one of the compliances is held there."""
    rng = np.random.default_rng(2)
    T, b, shift = rng.normal(size=(40, 4, 3)), rng.normal(size=40), np.array([0.3, -0.2, 0.1])
    whole = np.column_stack([T.reshape(40, -1), b])
    cost, x = Normal(whole.T @ whole, np.zeros(3, dtype=bool), ("force",)).cost(shift)
    right, norm = nnls(T[:, 0] + np.einsum("ekp,k->ep", T[:, 1:], shift), b)
    np.testing.assert_allclose(x, right, atol=1e-9)
    assert cost == pytest.approx(norm**2, rel=1e-9)


@pytest.mark.parametrize(("eps", "rest", "near", "far"), [(0.02, 0.0, 5.0, 5.3), (1e-5, 300.0, 0.09, 0.11)])
def test_the_way_to_a_point_ends_five_metres_away_and_where_it_gains_nothing(eps, rest, near, far):
    """Two equations eps x = 0 and (0.1 + s) x = 1 are the better solved the larger s is, for ever, in steps of at most
    0.3 m: by much where no more is read, by less than 1e-12 of it where ``rest`` is read besides."""
    terms = np.array([[eps, 0, 0, 0], [0.1, 1, 0, 0], [0, 0, 0, 0]])
    whole = np.column_stack([terms, [0.0, 1.0, rest]])
    cost, shift, x = Normal(whole.T @ whole, np.ones(1, dtype=bool), ("force",)).descend(np.zeros(3))
    assert near < shift[0] <= far
    assert cost == pytest.approx(rest**2 + (eps * x[0]) ** 2 + ((0.1 + shift[0]) * x[0] - 1) ** 2, rel=1e-9, abs=1e-9)
