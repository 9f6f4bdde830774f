"""Rotations and poses against SciPy's rotations and NumPy's inverse."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import robomill as rm
from robomill.kinematics.transforms import (
    axis_from_tilt,
    invert,
    pose_from_world,
    rotation_about,
    rotation_from_turns,
    rotation_x,
    rotation_y,
    rotation_z,
    tilt_from_axis,
    transform,
    translation,
    turn_between,
    turns_from_rotation,
    world_from_pose,
)

RNG = np.random.default_rng(20261122)
VECTORS = np.concatenate(
    [RNG.normal(size=(40, 3)), [[0, 0, 0], [1e-9, 0, 0], [0, 2e-4, 0], [0, 0, 3.1], [0, -4.0, 1.0]]]
)


@pytest.mark.parametrize(("turn", "axis"), [(rotation_x, "x"), (rotation_y, "y"), (rotation_z, "z")])
def test_turns_about_the_axes(turn, axis):
    angles = np.linspace(-4.0, 4.0, 17)
    np.testing.assert_allclose(turn(angles), Rotation.from_euler(axis, angles[:, None]).as_matrix(), atol=1e-15)


def test_a_turn_about_a_vector_by_its_length():
    np.testing.assert_allclose(rotation_about(VECTORS), Rotation.from_rotvec(VECTORS).as_matrix(), atol=1e-14)
    np.testing.assert_array_equal(rotation_about(VECTORS[3]), rotation_about(VECTORS)[3])


def test_the_inverse_of_a_pose_undoes_it():
    T = transform(rotation_about(VECTORS), RNG.normal(size=(len(VECTORS), 3)))
    np.testing.assert_allclose(invert(T), np.linalg.inv(T), atol=1e-12)
    np.testing.assert_array_equal(translation([1.0, 2.0, 3.0]) @ [4.0, 5.0, 6.0, 1.0], [5.0, 7.0, 9.0, 1.0])


def test_the_angle_between_two_turns_and_between_their_axes():
    R, Q = Rotation.from_rotvec(VECTORS), Rotation.from_rotvec(VECTORS[::-1] * 1.1)
    whole = turn_between(R.as_matrix(), Q.as_matrix(), True)
    np.testing.assert_allclose(whole, (R.inv() * Q).magnitude(), atol=2e-8)
    z, k = R.as_matrix()[..., 2], Q.as_matrix()[..., 2]
    of_axes = np.arctan2(np.linalg.norm(np.cross(z, k), axis=1), (z * k).sum(axis=1))
    np.testing.assert_allclose(turn_between(R.as_matrix(), Q.as_matrix(), False), of_axes, atol=1e-14)
    small = Rotation.from_rotvec([0.0, 1e-9, 0.0]).as_matrix()
    assert turn_between(np.eye(3), small, True) == pytest.approx(1e-9, rel=1e-6)


def test_world_coordinates_are_a_point_and_turns_about_x_then_the_new_y():
    x_M = np.column_stack([RNG.normal(size=(50, 3)), RNG.uniform(-3.1, 3.1, 50), RNG.uniform(-1.5, 1.5, 50)])
    T = pose_from_world(x_M)
    np.testing.assert_allclose(T[..., :3, :3], Rotation.from_euler("XY", x_M[:, 3:]).as_matrix(), atol=1e-15)
    np.testing.assert_array_equal(T[..., :3, 3], x_M[:, :3])
    spun = T @ transform(rotation_z(0.7), np.zeros(3))
    np.testing.assert_allclose(world_from_pose(spun), x_M, atol=1e-14)
    np.testing.assert_allclose(axis_from_tilt(*x_M.T[3:]), T[..., :3, 2], atol=1e-15)
    along_x = tilt_from_axis([[1.0, 0.0, 0.0], [-1.0, 1e-13, 0.0]])
    np.testing.assert_allclose(along_x, [[0.0, np.pi / 2], [0.0, -np.pi / 2]], atol=1e-12)


def test_turns_about_x_the_new_y_and_the_new_z_lead_there_and_back():
    turns = np.vstack(
        [RNG.uniform(-3, 3, (200, 3)), np.pi / 2 * np.array([[0, 1, 0], [1, -1, 2], [2, 0, 1], [1, 1, 1]])]
    )
    R = rotation_from_turns(turns)
    np.testing.assert_allclose(R, Rotation.from_euler("XYZ", turns).as_matrix(), atol=1e-15)
    np.testing.assert_allclose(rotation_from_turns(turns_from_rotation(R)), R, atol=1e-14)
    for shape in ((), (2, 102), (3, 4, 17)):  # any leading axes
        some = R[: int(np.prod(shape))].reshape(*shape, 3, 3)
        found = turns_from_rotation(some)
        assert found.shape == (*shape, 3)
        np.testing.assert_allclose(rotation_from_turns(found), some, atol=1e-14)
        assert (np.abs(found[..., 1]) <= np.pi / 2 + 1e-15).all()


@pytest.mark.parametrize("T", [np.zeros((4, 4)), 2 * np.eye(4), np.diag([1.0, 1.0, -1.0, 1.0]), np.eye(4)[::-1]])
def test_a_matrix_that_is_no_pose_is_refused(T) -> None:
    for call in (rm.world_from_pose, partial(rm.inverse_kinematics, rm.load_robot("slavkovic_5r"))):
        with pytest.raises(rm.RobomillError, match="this is no pose"):
            call(T)


@pytest.mark.parametrize("place", [(r, c) for r in range(4) for c in range(4) if (r, c) != (3, 3) and not c == 3 > r])
@pytest.mark.parametrize("off", [1e-3, -1e-3])
def test_a_pose_is_refused_by_any_entry_of_its_rotation_or_last_row(place: tuple[int, int], off: float) -> None:
    """One pose of a batch, one entry; as much beside the place in a row, or a millionth of it, is none's business."""
    T = transform(Rotation.from_euler("xyz", RNG.uniform(-3, 3, (3, 3))).as_matrix(), np.ones(3))
    np.testing.assert_allclose(world_from_pose(T)[:, :3], 1.0)
    T[1][place] += 1e-4 * off
    world_from_pose(T)
    T[1][place] += off
    with pytest.raises(rm.RobomillError, match="this is no pose"):
        world_from_pose(T)


@pytest.mark.parametrize("angle", [2, -3.0, 4, 5, -6, 2.5])
def test_tilts_in_degrees_are_refused_where_nobody_means_radians(angle: float) -> None:
    """Beyond a quarter turn B has no values, and A none that anybody states in whole or half radians."""
    for x_M, name in (([0, -1.3, 0, angle, 0], "A"), ([0, -1.3, 0, 0, angle], "B")):
        with pytest.raises(rm.RobomillError, match=f"Pose, {name}: found .* give np.radians"):
            rm.pose_from_world([[0, -1.3, 0, 0, 0], x_M])
    grid = rm.plane_grid("z", 0.0, (-0.1, -1.3, 0.0), (0.1, -1.2, 0.0), 0.1)
    with pytest.raises(rm.RobomillError, match="Pose, A"):
        rm.compliance_map(rm.load_robot("slavkovic_5r"), grid, angle, 0.0)


def test_tilts_that_angles_in_degrees_lead_to_are_taken() -> None:
    """All whole degrees of B, all tenths of A: their axes by the law of the tool's axis."""
    for A in np.radians(np.arange(-3600, 3601) / 10.0).tolist():
        assert rm.pose_from_world([0, 0, 0, A, 0])[1, 2] == pytest.approx(-np.sin(A), abs=1e-15)
    for B in np.radians(np.arange(-90, 91)).tolist():
        assert rm.pose_from_world([0, 0, 0, 0, B])[0, 2] == pytest.approx(np.sin(B), abs=1e-15)


def test_a_pose_that_is_not_reached_asks_whether_round_tilts_are_degrees() -> None:
    robot = rm.load_robot("slavkovic_5r")
    robot = robot.replace(limits_deg=[(-90, 90), (-90, 90), (-90, 90), (-20, 20), (-100, 100)])

    def asked(A: float, B: float) -> rm.IKResult:
        return rm.inverse_kinematics(robot, rm.pose_from_world([0.0, -1.3, 0.0, A, B]))

    found = asked(1.5, -1.0)
    assert not found.reached
    assert asked(*np.radians([1.5, -1.0])).reached
    assert found.reason().endswith("; A and B are 85.9 and −57.3° here: were they given in degrees, not in rad?")
    told = asked(*np.radians([85.9, -57.3]))  # the same, and nobody's slip
    assert not told.reached
    assert "in rad" not in told.reason()
