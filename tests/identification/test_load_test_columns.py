"""Columns of load tests that are given in part, joints that slide, and the line that says what tests are."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.identification.load_test import JointTests, LoadTests

F = np.array([[0.0, 30.0, 40.0], [0.0, 0.0, -120.0], [50.0, 0.0, 0.0]])
MOVED = np.array([[1e-4, 0.0, 0.0], [0.0, 3e-4, 4e-4], [0.0, 1e-4, 0.0]])
THETA = np.array([[0.1, 0.2, -0.3], [0.1, 0.2, -0.3], [0.4, 0.5, 0.6]])


def test_coordinates_of_joints_that_slide_are_in_mm():
    table = LoadTests(F, MOVED, theta=THETA, sliding=(2,)).columns()
    assert list(table)[:3] == ["theta1_deg", "theta2_mm", "theta3_deg"]
    np.testing.assert_allclose(table["theta2_mm"], [200.0, 200.0, 500.0])
    np.testing.assert_allclose(table["theta3_deg"], np.rad2deg(THETA[:, 2]))


def test_what_is_stated_of_some_tests_has_its_columns():
    """A moment about one axis, a rotation of one test, points beside the tip along z, the noise of one test."""
    wrench = np.column_stack([F, np.zeros((3, 2)), [0.0, 2.0, 0.0]])
    read = np.column_stack([MOVED, np.full((3, 3), np.nan)])
    read[1, 4] = 2e-3
    table = LoadTests(
        wrench,
        read,
        theta=THETA,
        force_point=[0.0, 0.0, 0.1],
        measuring_point=[[0.0, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.0]],
        noise=[np.nan, 2e-6, np.nan],
    ).columns()
    for name, values in (
        ("Mz_Nm", [0.0, 2.0, 0.0]),
        ("Mx_Nm", [0.0] * 3),
        ("ry_mrad", [np.nan, 2.0, np.nan]),
        ("rx_mrad", [np.nan] * 3),
        ("FPz_mm", [100.0] * 3),
        ("MPy_mm", [0.0, 20.0, 0.0]),
        ("noise_um", [np.nan, 2.0, np.nan]),
    ):
        np.testing.assert_allclose(table[name], values, err_msg=name)
    plain = LoadTests(F, MOVED, theta=THETA).columns()
    assert not [name for name in plain if name[0] in "MrFn" and name not in ("Fx_N", "Fy_N", "Fz_N")]


def test_a_cable_with_a_moment_beside_it_has_both():
    table = LoadTests(np.hstack([F, F]), MOVED, theta=THETA, pulley=np.ones((3, 3))).columns()
    assert "Fx_N" not in table
    np.testing.assert_allclose(table["load_N"], [50.0, 120.0, 50.0])
    np.testing.assert_allclose(np.transpose([table[f"M{axis}_Nm"] for axis in "xyz"]), F)


def test_tests_say_how_many_they_are_at_how_many_poses_and_how_far_they_go():
    tests = LoadTests(F, MOVED, theta=THETA)
    assert repr(tests) == "<LoadTests 3 tests at 2 poses, up to 120 N and 0.500 mm, measured>"
    read = np.where(np.arange(3) == 2, np.nan, MOVED)
    six = LoadTests(np.hstack([F, 1e3 * F]), np.hstack([read, 10 * MOVED]), theta=THETA)
    assert repr(six) == "<LoadTests 3 tests at 2 poses, up to 120 N and 0.300 mm, measured>"
    assert repr(JointTests([3, 1, 3], [1.0, 2.0, 3.0], [1e-6] * 3)) == (
        "<JointTests 3 tests of single joints (1, 3), measured>"
    )


def test_joined_tests_tell_the_findings_of_both_and_count_anew():
    one = LoadTests(F, MOVED, theta=THETA, row=[4, 5, 9])
    both = one.joined(one.without([5]))
    np.testing.assert_array_equal(both.row, [1, 2, 3, 4, 5])
    np.testing.assert_array_equal(both.theta, THETA[[0, 1, 2, 0, 2]])


@pytest.mark.parametrize("volume", [0.9e-3, 1.1e-3])
def test_three_gauges_in_a_plane_read_no_vector(volume):
    """The third one leans out of the plane of the others by a thousandth of a radian, less or more."""
    gauges = np.tile(np.eye(3), (3, 1, 1))
    gauges[1, 2] = [np.cos(volume), 0.0, np.sin(volume)]
    read = np.einsum("mgi,mi->mg", gauges, MOVED)
    found = LoadTests(F, read, theta=THETA, gauges=gauges).vectors
    np.testing.assert_allclose(found[[0, 2]], MOVED[[0, 2]], atol=1e-15)
    assert np.isnan(found[1]).all() == (volume < 1e-3)
    turned = gauges[:, ::-1].copy()  # of the other hand
    found = LoadTests(F, read[:, ::-1], theta=THETA, gauges=turned).vectors
    np.testing.assert_allclose(found[[0, 2]], MOVED[[0, 2]], atol=1e-15)


def test_equal_to_nine_digits_is_one_pose():
    theta = np.tile(THETA[:1], (4, 1))
    theta[1, 2] += 0.4e-9
    theta[2, 2] += 1.6e-9
    theta[3, 0] -= 1.6e-9
    np.testing.assert_array_equal(LoadTests(F[[0] * 4], MOVED[[0] * 4], theta=theta).pose_index(), [1, 1, 2, 0])
