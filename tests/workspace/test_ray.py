"""The ray to the edge of the workspace, by the triangle of the stretched arm."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.workspace.ray import ray_through

# The arm straight, the tool hanging a_5 below the wrist.
STRETCHED = np.sqrt((1.22 + 1.1) ** 2 - 0.3**2)


def test_the_ray_ends_at_a_singularity() -> None:
    way = ray_through(rm.load_robot("slavkovic_5r"), [0.0, -1.3, 0.0])
    assert way.radius[way.start] == pytest.approx(1.3)
    assert (np.diff(way.radius) > 0).all()
    assert way.det[-1] < 1e-3 * way.det.max()
    assert way.radius[-1] == pytest.approx(STRETCHED, abs=1e-6)


def test_distances_are_from_the_base_wherever_it_stands() -> None:
    robot = rm.load_robot("slavkovic_5r")
    T_base = np.array(robot.T_base)
    T_base[:3, 3] += (0.4, 0.2, 0.0)
    way = ray_through(robot.replace(T_base=T_base), [0.4, -1.1, 0.0])
    assert way.radius[way.start] == pytest.approx(1.3)
    assert way.radius[-1] == pytest.approx(STRETCHED, abs=1e-6)
    np.testing.assert_allclose(np.linalg.norm(way.p[:, :2] - [0.4, 0.2], axis=1), way.radius, atol=1e-12)


def test_the_whole_ray_is_in_reach_and_nothing_behind_its_end() -> None:
    robot = rm.load_robot("slavkovic_5r")
    way = ray_through(robot, [0.0, -1.3, 0.0])
    np.testing.assert_allclose(rm.tool_pose(robot, way.theta)[:, :3, 3], way.p, atol=1e-9)
    behind = rm.pose_from_world([0.0, -way.radius[-1] - 1e-5, 0.0, 0.0, 0.0])
    assert not rm.inverse_kinematics(robot, behind).reached


@pytest.mark.parametrize("radii", [7, 12, 121])
@pytest.mark.parametrize("z", [0.0, -0.5, 0.4])
@pytest.mark.parametrize("shift", [0.0, 0.3])
def test_both_ends_are_edges_however_coarsely_one_looks(monkeypatch, radii: int, z: float, shift: float) -> None:
    """An elbow that cannot fold keeps the tool from the base: a hundredth of a millimetre further in or out nothing is
    reached, and between them everything is. At z = 0.4 m the inner edge lies next to the first radius looked at."""
    monkeypatch.setattr("robomill.workspace.ray.RADII", radii)
    robot = rm.load_robot("slavkovic_5r")
    T_base = np.array(robot.T_base)
    T_base[0, 3] += shift
    limits = np.array(robot.limits_all)
    limits[2] *= 0.5
    robot, point = robot.replace(T_base=T_base, limits_all=limits), np.array([0.9 + shift, -1.2, z])

    def reached(radius) -> np.ndarray:
        across = (point[:2] - [shift, 0.0]) / np.linalg.norm(point[:2] - [shift, 0.0])
        places = [[*(np.array([shift, 0.0]) + r * across), z, 0.0, 0.0] for r in np.atleast_1d(radius)]
        return rm.inverse_kinematics(robot, rm.pose_from_world(places)).reached

    way = ray_through(robot, point)
    assert way.radius[way.start] == pytest.approx(np.linalg.norm(point[:2] - [shift, 0.0]), abs=1e-12)
    low, high = way.radius[[0, -1]]
    assert reached(np.linspace(low, high, 40)).all()
    assert not reached([low - 1e-5, high + 1e-5]).any()
    assert np.isfinite(way.theta).all()


def test_a_ray_through_a_point_over_the_base_goes_to_the_table() -> None:
    """Which stands in front of the arm, towards -Y of {M}."""
    robot = rm.load_robot("slavkovic_5r")
    robot = robot.replace(limits=np.tile([-np.pi, np.pi], (5, 1)))
    way = ray_through(robot, [0.0, 0.0, 1.5])
    assert (way.start, way.radius[0]) == (0, 0.0)
    np.testing.assert_allclose(way.p, np.column_stack([0 * way.radius, -way.radius, 0 * way.radius + 1.5]), atol=1e-15)
    np.testing.assert_allclose(rm.tool_pose(robot, way.theta)[:, :3, 3], way.p, atol=1e-9)
    assert way.radius[-1] > 0.5


@pytest.mark.parametrize(("name", "point", "places"), [("slavkovic_5r", 1.3, 121), ("planar_3r", 0.5, 41)])
def test_an_arm_that_is_solved_numerically_is_looked_at_in_fewer_places(name: str, point: float, places: int) -> None:
    """Evenly from two hundredths on to all links in a row and the point's own distance."""
    robot = rm.load_robot(name)
    way = ray_through(robot, [0.0, -point, 0.0])
    longest = np.abs(robot.a).sum() + np.abs(robot.d).sum() + point
    assert np.diff(way.radius).max() == pytest.approx(0.98 * longest / (places - 1), rel=1e-9)
