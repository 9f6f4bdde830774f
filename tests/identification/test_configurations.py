"""Where the arm stood and where cables pull, against scipy's rotations, rows one by one and every posture tried."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.configurations import LIMIT_SLACK, checked, pose_of, solved, ways, world_of
from robomill.identification.fit.models import MODELS, Model
from robomill.identification.load_test import LoadTests

FIVE, SIX = rm.load_robot("slavkovic_5r"), rm.load_robot("kuka_kr270")
RNG = np.random.default_rng(11)


def inside(robot, m, share=0.8):
    middle, half = robot.limits.mean(axis=1), np.ptp(robot.limits, axis=1) / 2
    return middle + share * half * RNG.uniform(-1, 1, (m, robot.n))


def test_six_world_coordinates_are_turns_about_x_the_new_y_and_the_new_z():
    x_M = np.concatenate([RNG.normal(size=(40, 3)), RNG.uniform(-1.4, 1.4, (40, 3)) * [2, 1, 2]], axis=1)
    T = pose_of(x_M)
    np.testing.assert_allclose(T[:, :3, :3], Rotation.from_euler("XYZ", x_M[:, 3:]).as_matrix(), atol=1e-14)
    np.testing.assert_array_equal(T[:, :3, 3], x_M[:, :3])
    np.testing.assert_array_equal(T[:, 3], np.tile([0, 0, 0, 1], (40, 1)))
    np.testing.assert_allclose(world_of(T), x_M, atol=1e-12)
    np.testing.assert_allclose(world_of(T[7]), x_M[7], atol=1e-12)
    five = np.concatenate([x_M[:, :5], np.zeros((40, 1))], axis=1)
    np.testing.assert_allclose(pose_of(x_M[:, :5]), pose_of(five), atol=1e-15)


def test_whole_poses_are_reached_as_they_are_written_and_other_postures_are_counted():
    sides = [f"{shoulder}, {elbow}" for shoulder in ("front", "back") for elbow in ("elbow up", "elbow down")]
    T = rm.tool_pose(SIX, inside(SIX, 60))
    open_ones = sum(rm.inverse_kinematics(SIX, T, spin="fixed", branch=side).reached.astype(int) for side in sides) > 1
    home = rm.inverse_kinematics(SIX, T, spin="fixed").reached
    rows = np.arange(60) + 5
    for take in (home & open_ones, home & ~open_ones, home):
        assert take.sum() > 2
        theta, said = solved(SIX, world_of(T[take]), rows[take])
        np.testing.assert_allclose(rm.tool_pose(SIX, theta), T[take], atol=1e-8)
        many = rows[take & open_ones]
        assert said.code == ("postures-open" if len(many) else "joints-solved")
        if len(many):
            assert (said.line, said.count) == (many[0], len(many))
    with pytest.raises(LoadTestError, match="no choice"):
        solved(FIVE, world_of(rm.tool_pose(FIVE, inside(FIVE, 2))), np.array([2, 3]))


def test_the_first_row_that_is_not_reached_is_named_with_the_unit_that_was_meant():
    x_M = rm.world_from_pose(rm.tool_pose(FIVE, inside(FIVE, 6, 0.4)))
    theta, _ = solved(FIVE, x_M, np.arange(2, 8))
    np.testing.assert_allclose(rm.world_from_pose(rm.tool_pose(FIVE, theta)), x_M, atol=1e-9)
    far = x_M.copy()
    far[[3, 5], 0] += 9.0
    with pytest.raises(LoadTestError, match="not reached") as refused:
        solved(FIVE, far, np.arange(2, 8))
    assert refused.value.where == "row 5"
    assert "read as" not in str(refused.value)
    for said, size in (("in", 25.4), ("m", 1e3)):
        for of_six, share in ((6, "100 %"), (4, "67 %")):  # the others stand farther off still
            lengths = x_M[:, :3] * size * np.where(np.arange(6) < of_six, 1.0, 50.0)[:, None]
            with pytest.raises(LoadTestError, match=f"read as mm under a header in {said}, {share}"):
                solved(FIVE, np.concatenate([lengths, x_M[:, 3:]], axis=1), np.arange(2, 8))


def test_limits_count_both_ends_and_the_rounding_of_what_is_written():
    row = np.array([4, 9])
    for i, (lower, upper) in enumerate(FIVE.limits):
        for edge, outward in ((lower, -1.0), (upper, 1.0)):
            theta = np.tile(FIVE.limits.mean(axis=1), (2, 1))
            theta[1, i] = edge + outward * 0.9 * LIMIT_SLACK
            checked(FIVE, theta, row)
            theta[1, i] = edge + outward * 1.1 * LIMIT_SLACK
            with pytest.raises(LoadTestError, match=f"^Row 9, theta{i + 1}: ") as refused:
                checked(FIVE, theta, row)
            assert refused.value.where == "row 9"
    with pytest.raises(LoadTestError, match="4 joint columns for a robot of 5 joints"):
        checked(FIVE, np.zeros((2, 4)), row)


def cables(m=6):
    """Tests whose even rows are pulled towards pulleys, the odd ones by a force that was measured."""
    theta = inside(SIX, m, 0.5)
    pulley = np.where(np.arange(m)[:, None] % 2 == 0, RNG.normal(size=(m, 3)) * 2, np.nan)
    wrench = RNG.normal(size=(m, 6)) * 200
    point = RNG.normal(size=(m, 3)) * 0.1
    return LoadTests(wrench, np.full((m, 6), 1e-4), theta=theta, force_point=point, pulley=pulley)


def test_cables_pull_from_their_point_to_their_pulley_as_hard_as_before():
    tests, shift = cables(), np.array([0.03, -0.02, 0.05])
    for found, moved in ((tests.with_joints(SIX), np.zeros(3)), (tests.moved(SIX, shift), shift)):
        for k, T in enumerate(rm.tool_pose(SIX, tests.theta)):
            point = tests.force_point[k] + moved
            np.testing.assert_allclose(found.force_point[k], point)
            if k % 2:
                np.testing.assert_array_equal(found.wrench[k], tests.wrench[k])
                continue
            way = tests.pulley[k] - (T @ [*point, 1.0])[:3]
            size = np.linalg.norm(tests.wrench[k, :3])
            np.testing.assert_allclose(found.wrench[k, :3], size * way / np.linalg.norm(way), rtol=1e-12)
            np.testing.assert_array_equal(found.wrench[k, 3:], tests.wrench[k, 3:])
            np.testing.assert_allclose(ways(T[None], point[None], tests.pulley[k][None])[0], way, atol=1e-14)


@pytest.mark.parametrize("name", [name for name in MODELS if name != "constant"])
@pytest.mark.parametrize("freed", [("force",), ("force", "gauge")])
def test_terms_of_a_freed_point_are_its_change_with_cables_aimed_anew(name, freed):
    """Column by column: the displacement with the point moved by a little, cables turned with it, less without."""
    model = Model(name)
    tests = cables().with_joints(SIX)
    tests = replace(tests, measuring_point=RNG.normal(size=(6, 3)) * 0.1)
    terms = model.terms(SIX, tests, freed)
    h = 3e-4
    for gauge in range(4 if "gauge" in freed else 1):
        for force in range(4):
            found = 0.0
            for way_f, way_g in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
                shift_f = h * way_f * np.eye(4)[force][1:]
                shift_g = h * way_g * np.eye(4)[gauge][1:]
                there = replace(tests.moved(SIX, shift_f), measuring_point=tests.measuring_point + shift_g)
                share = (way_f / (2 * h) if force else 0.5) * (way_g / (2 * h) if gauge else 0.5)
                found = found + share * model.terms(SIX, there)[:, :, 0]
            scale = np.abs(found).max() + 1.0
            np.testing.assert_allclose(
                terms[:, :, (4 if "gauge" in freed else 1) * force + gauge] / scale, found / scale, atol=1e-5
            )


def test_readings_along_three_gauges_give_the_displacement_where_they_can():
    moved = RNG.normal(size=(5, 3)) * 1e-4
    along = RNG.normal(size=(5, 3, 3))
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    along[2, 1] = along[2, 0]  # two gauges along one line
    read = np.einsum("mij,mj->mi", along, moved)
    read[4, 2] = np.nan
    displacement = np.concatenate([read, np.full((5, 3), np.nan)], axis=1)
    tests = LoadTests(np.ones((5, 6)), displacement, theta=inside(FIVE, 5), gauges=along)
    expected = np.where(np.isin(np.arange(5), [2, 4])[:, None], np.nan, moved)
    np.testing.assert_allclose(tests.vectors, expected, rtol=1e-9)
    np.testing.assert_array_equal(tests.directions, along)
    plain = LoadTests(np.ones((5, 6)), displacement, theta=inside(FIVE, 5))
    np.testing.assert_array_equal(plain.vectors, read)
    np.testing.assert_array_equal(plain.directions, np.tile(np.eye(3), (5, 1, 1)))
