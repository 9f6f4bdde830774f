"""Where the lines of pull meet: against pulleys and load points of an independent simulator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.identification.pull.lines_of_pull import _Lines, _loose, lines_of_pull
from robomill.identification.pull.pull_words import load_point, pull_findings
from robomill.identification.record import identification_record, lines_of_pull_record
from robomill.io.samples import samples_dir
from tests.identification.cables import Arm, Rig, as_csv, make, postures

ARM, ROBOT = Arm.of("kuka_kr500"), rm.load_robot("kuka_kr500")
OFF = 0.150 * np.array([0.6, 0.64, -0.48])
PULLEYS = ((3.4, -2.2, 1.6), (2.5, 3.0, 0.2), (1.8, 0.0, 4.5))


def read(made, rig, off=OFF):
    return rm.read_load_tests(as_csv(ARM, made, rig.load_point + off, rig.gauge_point), ROBOT)


def changed(tests, rows, how):
    wrench = tests.wrench.copy()
    wrench[rows] = how(wrench[rows])
    return replace(tests, wrench=wrench)


def sideways(wrench):
    return np.concatenate([np.roll(wrench[:, :3], 1, axis=1), wrench[:, 3:]], axis=1)


def codes(found, tests):
    return {f.code for f in pull_findings(found, ROBOT, tests)}


@pytest.mark.parametrize("count", [1, 2, 3])
def test_pulleys_and_load_point_are_found_from_exact_lines(count):
    rig = Rig(pulleys=PULLEYS[:count])
    made = make(ARM, rig, 60, seed=1)
    tests = read(made, rig)
    found = lines_of_pull(ROBOT, tests)
    assert found.says == "met"
    order = [int(np.argmin(np.linalg.norm(np.array(PULLEYS) - p, axis=1))) for p in found.pulley]
    assert sorted(order) == list(range(count))
    np.testing.assert_allclose(found.pulley, np.array(PULLEYS)[order], atol=1e-5)
    np.testing.assert_array_equal(np.array(order)[found.which], made.pulley)
    point = load_point(found, ROBOT, tests)
    np.testing.assert_allclose(point.in_flange, rig.load_point, atol=1e-5)
    assert point.off == pytest.approx(0.150, abs=1e-5)
    assert found.gap.max() < 1e-6
    assert np.median(found.gap_stated) > 0.05
    assert found.suspects == found.pushes == ()


def test_the_way_to_a_pulley_is_the_cable_from_where_it_really_pulls():
    rig = Rig()
    tests = read(make(ARM, rig, 12, seed=1), rig)
    pulley, shift = np.array(rig.pulleys), -ARM.T_FT[:3, :3].T @ OFF
    point = np.array([flange[:3, :3] @ rig.load_point + flange[:3, 3] for *_, flange in map(ARM.frames, tests.theta)])
    for k in range(len(pulley)):
        to, u = pulley[k] - point, tests.wrench[:, :3] / np.linalg.norm(tests.wrench[:, :3], axis=1)[:, None]
        along = np.linalg.norm(to, axis=1) * np.cos(
            np.arctan2(np.linalg.norm(np.cross(u, to), axis=1), (u * to).sum(1))
        )
        np.testing.assert_allclose(_Lines(ROBOT, tests).ways(shift, pulley, np.full(12, k)), along, atol=1e-6)


@pytest.mark.slow
def test_the_interval_of_the_load_point_holds_it():
    inside = []
    for seed in range(20):
        rig = Rig(force_noise=2.0, pull=(400.0, 400.0))
        tests = read(make(ARM, rig, 40, seed), rig)
        point = load_point(lines_of_pull(ROBOT, tests), ROBOT, tests)
        inside.append((point.ci95[:, 0] <= rig.load_point) & (rig.load_point <= point.ci95[:, 1]))
    assert 0.88 <= np.mean(inside)


@pytest.mark.parametrize("rows", [[20], [3, 9, 20, 25, 30, 38]])
def test_rows_that_cannot_be_are_named_and_do_no_harm(rows):
    rig = Rig(force_noise=1.0)
    tests = changed(read(make(ARM, rig, 43, seed=2), rig), rows, sideways)
    found = lines_of_pull(ROBOT, tests)
    assert set(tests.row[rows]) <= set(found.suspects)
    assert len(found.suspects) <= len(rows) + 1
    np.testing.assert_allclose(load_point(found, ROBOT, tests).in_flange, rig.load_point, atol=0.01)
    assert {"pull-suspect", "pull-load-point"} <= codes(found, tests)


def aimed_at(tests, rows, places):
    """The pulls of some rows turned towards places (k, 3) m in {M}, from the stated load point."""
    T = tests.tool_poses(ROBOT)[rows]
    way = places - T[:, :3, 3] - np.einsum("mij,mj->mi", T[:, :3, :3], tests.force_point[rows])
    return changed(
        tests,
        rows,
        lambda w: (
            np.linalg.norm(w, axis=1)[:, None] * np.pad(way / np.linalg.norm(way, axis=1)[:, None], ((0, 0), (0, 3)))
        ),
    )


def test_a_line_that_misses_by_more_than_chance_is_named_whichever_row_it_is():
    """By 55 mm, where 1 N of noise on 400 N and a cable of 4 m make 10 mm: 4.1 times that is one chance in a hundred
    for any of 43 rows."""
    rig = Rig(force_noise=1.0, pull=(400.0, 400.0))
    tests = read(make(ARM, rig, 43, seed=2), rig, 0 * OFF)
    pulley = np.array(rig.pulleys[0])
    for row in range(0, 43, 5):
        u = tests.wrench[row, :3] / 400.0
        beside = np.cross(u, [0.0, 0.0, 1.0])
        missed = aimed_at(tests, [row], (pulley + 0.055 * beside / np.linalg.norm(beside))[None])
        assert tests.row[row] in lines_of_pull(ROBOT, missed).suspects


def test_rows_that_hardly_meet_make_no_pulley_of_their_own():
    """Five of 43 rows aim within some 80 mm at another place; what the others know to 10 mm they do not share."""
    rig, rows = Rig(force_noise=1.0, pull=(400.0, 400.0)), np.arange(3, 43, 8)
    tests = read(make(ARM, rig, 43, seed=2), rig, 0 * OFF)
    around = np.array(PULLEYS[1]) + 0.08 * np.random.default_rng(1).standard_normal((len(rows), 3))
    found = lines_of_pull(ROBOT, aimed_at(tests, rows, around))
    np.testing.assert_allclose(found.pulley, rig.pulleys, atol=0.02)
    assert set(tests.row[rows]) <= set(found.suspects)


@pytest.mark.slow
def test_good_rows_are_rarely_called_suspect():
    alarms = 0
    for seed in range(15):
        rig = Rig(force_noise=3.0, pull=(200.0, 800.0))
        alarms += bool(lines_of_pull(ROBOT, read(make(ARM, rig, 43, seed), rig)).suspects)
    assert alarms <= 2


def test_a_right_load_point_is_not_called_wrong():
    rig = Rig(force_noise=2.0)
    tests = read(make(ARM, rig, 43, seed=3), rig, 0 * OFF)
    found = lines_of_pull(ROBOT, tests)
    assert codes(found, tests) == {"pull-met"}
    assert load_point(found, ROBOT, tests).off < 0.02


def test_a_force_of_turned_sign_pushes():
    rig = Rig()
    tests = changed(read(make(ARM, rig, 43, seed=4), rig), np.arange(43), np.negative)
    found = lines_of_pull(ROBOT, tests)
    assert found.pushes == tuple(tests.row)
    assert "pull-sign" in codes(found, tests)


def test_newtons_and_kilonewtons_meet_alike():
    rig = Rig()
    tests = read(make(ARM, rig, 43, seed=5), rig)
    large = changed(tests, np.arange(43), lambda w: w * 1e3)
    np.testing.assert_allclose(lines_of_pull(ROBOT, large).pulley, lines_of_pull(ROBOT, tests).pulley, atol=1e-7)


@pytest.mark.parametrize("noise", [0.0, 2.0])
def test_dead_weights_say_nothing_and_say_so(noise):
    rig = Rig(dead_weight=True, force_noise=noise)
    tests = read(make(ARM, rig, 43, seed=6), rig)
    found = lines_of_pull(ROBOT, tests)
    assert found.says in ("parallel", "held-loosely")
    assert (found.which == -1).all(), "no pulley"
    assert found.pulley.shape == (0, 3)
    assert np.isnan([found.gap, found.gap_stated]).all()
    assert found.shift is None
    record = lines_of_pull_record(found, ROBOT, tests)
    assert record["pulley_mm"] is record["load_point_mm"] is None
    assert record["suspects"] == []
    assert len(record["sentences"]) == 1


@pytest.mark.parametrize(("away", "says"), [(20.0, "met"), (150.0, "held-loosely")])
def test_a_pulley_so_far_that_scatter_hides_it_is_held_loosely(away, says):
    """Postures some 2 m apart turn the lines to it by 100 or by 13 mrad; each of the twelve scatters by 5 mrad."""
    rig = Rig(pulleys=((0.0, 0.0, -away),), force_noise=2.0, pull=(400.0, 400.0))
    found = [lines_of_pull(ROBOT, read(make(ARM, rig, 12, seed), rig, 0 * OFF)).says for seed in range(4)]
    assert found == [says] * 4


def test_pushes_along_axes_say_nothing():
    five = rm.load_robot("slavkovic_5r")
    tests = rm.read_load_tests(samples_dir() / "load_tests" / "nine_points.csv", five)
    assert lines_of_pull(five, tests).says == "parallel"


def test_one_pose_few_rows_and_forces_anyhow_are_told_apart():
    q = np.repeat(postures(ARM, 1, np.random.default_rng(7)), 20, axis=0)
    rig = Rig()
    assert lines_of_pull(ROBOT, read(make(ARM, rig, q=q), rig)).says == "too-few"
    assert lines_of_pull(ROBOT, read(make(ARM, rig, 5, seed=7), rig)).says == "too-few"
    rng = np.random.default_rng(7)
    wild = changed(read(make(ARM, rig, 43, seed=7), rig), np.arange(43), lambda w: rng.normal(size=w.shape) * 500)
    found = lines_of_pull(ROBOT, wild)
    assert found.says == "apart"
    assert codes(found, wild) == {"pull-apart"}
    assert found.suspects == found.pushes == ()
    assert found.shift is found.covariance is None, "where lines do not meet there is no load point either"


@pytest.mark.parametrize(("poses", "each", "enough"), [(3, 3, False), (4, 2, True)])
def test_eight_rows_at_four_poses_are_enough(poses, each, enough):
    """Four lines through one pulley have eight numbers; pulley and load point have six."""
    rig = Rig()
    q = np.repeat(postures(ARM, poses, np.random.default_rng(7)), each, axis=0)
    found = lines_of_pull(ROBOT, read(make(ARM, rig, q=q), rig))
    assert (found.says != "too-few") == enough
    if enough:
        np.testing.assert_allclose(found.pulley, rig.pulleys, atol=1e-5)


@pytest.mark.parametrize("turn", [0.0, 1e-4])
def test_a_tool_that_hardly_turns_cannot_tell_its_load_point(turn):
    """Poses that differ by place alone: the pulley moves with the load point, so the stated one is kept. Turned by a
    tenth of a mrad, a gap of 1 mm would still move the point by metres."""
    robot = rm.load_robot("slavkovic_5r")
    rng = np.random.default_rng(8)
    x_M = np.concatenate(
        [rng.uniform([-0.5, -1.6, -0.3], [0.5, -1.1, 0.1], (20, 3)), rng.uniform(-turn, turn, (20, 2))], axis=1
    )
    T = rm.pose_from_world(x_M)
    point, pulley = np.array([0.05, 0.02, 0.1]), np.array([1.5, -3.0, 0.5])
    F = pulley - T[:, :3, 3] - T[:, :3, :3] @ point
    F *= 250 / np.linalg.norm(F, axis=1)[:, None]
    tests = rm.read_load_tests(
        "X_mm,Y_mm,Z_mm,A_deg,B_deg,Fx_N,Fy_N,Fz_N,dx_mm,dy_mm,dz_mm\n"
        + "\n".join(
            ",".join(map(repr, [*(x[:3] * 1e3).tolist(), *np.degrees(x[3:]).tolist(), *f.tolist(), 0.1, 0.1, 0.1]))
            for x, f in zip(x_M, F, strict=True)
        ),
        robot,
    )
    found = lines_of_pull(robot, tests)
    assert found.says == "met"
    assert found.shift is None
    np.testing.assert_allclose(found.gap, found.gap_stated, atol=1e-9)
    np.testing.assert_allclose(found.pulley[0], pulley - point, atol=1e-6 + turn)


def test_a_moment_beside_the_force_moves_the_line():
    """A wrench given at another point than the load point is the same wrench: the same pulley."""
    rig = Rig()
    tests = read(make(ARM, rig, 43, seed=9), rig, 0 * OFF)
    R = tests.tool_poses(ROBOT)[:, :3, :3]
    away = np.array([0.1, -0.05, 0.2])
    F = tests.wrench[:, :3]
    moment = np.cross(-R @ away, F)
    moved = replace(tests, force_point=tests.force_point + away, wrench=np.concatenate([F, moment], axis=1))
    np.testing.assert_allclose(lines_of_pull(ROBOT, moved).pulley[0], PULLEYS[0], atol=1e-5)


def test_the_record_is_what_a_reader_of_json_needs():
    rig = Rig(force_noise=1.0, pulleys=PULLEYS[:2])
    tests = changed(read(make(ARM, rig, 43, seed=10), rig), [12], sideways)
    record, findings = identification_record(ROBOT, tests, rm.identify(ROBOT, tests))
    lines = record["lines_of_pull"]
    assert len(lines["gap_mm"]) == 43
    assert int(tests.row[12]) in lines["suspects"]
    assert len(lines["pulleys_mm"]) == 2
    assert lines["pulley_mm"] in lines["pulleys_mm"]
    assert sorted(row for rows in lines["rows_by_pulley"] for row in rows) == tests.row.tolist()
    np.testing.assert_allclose(lines["load_point_mm"], rig.load_point * 1e3, atol=8)
    assert {"pull-load-point", "pull-suspect"} <= {f.code for f in findings}
    single = rm.read_load_tests("joint,torque_Nm,angle_mrad\n1,100,0.1\n1,200,0.2\n2,100,0.2\n", ROBOT)
    assert identification_record(ROBOT, single, rm.identify(ROBOT, single))[0]["lines_of_pull"] is None


def test_a_fit_that_makes_up_for_what_its_model_lacks_is_told_by_the_lines_of_pull():
    rig = Rig(bending={2: (4e-7, 4e-7)}, force_noise=1.0)
    gauge = rig.gauge_point + np.array([0.0, 0.048, 0.064])
    tests = rm.read_load_tests(as_csv(ARM, make(ARM, rig, 43, seed=0), rig.load_point + OFF, gauge), ROBOT)
    lacking = rm.identify(ROBOT, tests, fit_points="force")
    assert "points-disagree" in {f.code for f in identification_record(ROBOT, tests, lacking)[1]}
    whole = rm.identify(ROBOT, tests, "joints+bending", bending="auto", fit_points="both")
    assert whole.choice.bending_joints == (2,)
    assert "points-disagree" not in {f.code for f in identification_record(ROBOT, tests, whole)[1]}


@pytest.mark.parametrize("first", [12, 28])
def test_the_pulley_that_is_recorded_is_that_of_most_rows(first):
    rig = Rig(pulleys=PULLEYS[:2])
    tests = read(make(ARM, rig, 60, seed=1), rig)
    tests = tests.select(np.sort(np.concatenate([2 * np.arange(first), 2 * np.arange(40 - first) + 1])))
    record = lines_of_pull_record(lines_of_pull(ROBOT, tests), ROBOT, tests)
    np.testing.assert_allclose(record["pulley_mm"], 1e3 * np.array(PULLEYS[first < 20]), atol=1e-2)


@pytest.mark.parametrize("turns", [False, True])
def test_a_tool_that_turns_from_pulley_to_pulley_alone_cannot_tell_its_load_point(turns):
    """Each pulley moves with the load point then, as turned as the tool is; taken for one pulley they would hold it."""
    robot, rng = rm.load_robot("slavkovic_5r"), np.random.default_rng(8)
    place = rng.uniform([-0.5, -1.6, -0.3], [0.5, -1.1, 0.1], (40, 3))
    second = np.arange(40) >= 20
    lean = np.where(second[:, None], [0.2, -0.15], [-0.1, 0.1]) + turns * rng.uniform(-0.2, 0.2, (40, 2))
    tests = rm.LoadTests(np.ones((40, 3)), np.full((40, 3), 1e-4), x_M=np.concatenate([place, lean], axis=1))
    T = tests.with_joints(robot).tool_poses(robot)  # five joints turn it about its own axis as they must
    point, pulleys = np.array([0.0, 0.0, 0.1]), np.array([[1.5, -3.0, 0.5], [-1.8, -2.5, 1.2]])
    F = pulleys[second.astype(int)] - T[:, :3, 3] - T[:, :3, :3] @ point
    found = lines_of_pull(robot, replace(tests, wrench=np.pad(F, ((0, 0), (0, 3)))).with_joints(robot))
    assert found.says == "met"
    assert (found.shift is None) == (not turns)
    if turns:
        np.testing.assert_allclose(found.shift, point, atol=1e-5)
    moved = 0.0 if turns else T[[0, 20], :3, :3] @ point
    order = [0, 1] if found.which[0] == 0 else [1, 0]
    np.testing.assert_allclose(found.pulley[order], pulleys - moved, atol=1e-5)


@pytest.mark.parametrize(("std", "loose"), [(0.99, False), (1.01, True), (np.inf, True)])
@pytest.mark.parametrize("at", [0, 1])
def test_a_pulley_is_held_loosely_where_two_standard_errors_are_half_the_way_to_it(std, loose, at):
    """Four metres away, along whatever direction it is known least; the other pulley is 40 m away and known as well."""
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    covariance = np.diag(np.repeat([1e-6, 1.0, 1.0], 3))
    own = slice(3 + 3 * at, 6 + 3 * at)
    covariance[own, own] = turn @ np.diag([1e-4, std**2, 1e-2]) @ turn.T if np.isfinite(std) else np.inf
    which = np.repeat([at, 1 - at], 8)
    way = np.where(which == at, -4.0, 40.0) * np.linspace(0.9, 1.1, 16)
    way[:8] = [-3.0, -3.5, -4.0, -4.0, -4.0, -4.0, -4.5, -9.0]
    assert _loose(np.zeros((2, 3)), covariance, way, which) == loose
