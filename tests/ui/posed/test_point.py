"""The point in hand: which one it is when nobody clicked, and what stands there."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import robomill as rm
from robomill.ui.posed.point import default_point, in_hand, middle
from robomill.ui.project import MapView
from robomill.workspace.fields import ComplianceMap, compliance_map
from robomill.workspace.grid import box_grid
from robomill.workspace.reach import ReachBox

ROBOT = rm.load_robot("slavkovic_5r")
OWN = MapView(ROBOT.name, "own")


def over(lower: tuple[float, ...], upper: tuple[float, ...], step: float = 0.2) -> tuple[ReachBox, ComplianceMap]:
    return ReachBox(np.array(lower), np.array(upper)), compliance_map(ROBOT, box_grid(lower, upper, step))


def test_the_tool_stands_where_it_is_said_to_stand() -> None:
    A, B = np.radians([4.0, -7.0])
    found = in_hand(ROBOT, (0.2, -1.2, -0.1), A, B)
    T_MT = rm.tool_pose(ROBOT, found.pose.theta)
    np.testing.assert_allclose(T_MT[:3, 3], found.point, atol=1e-9)
    np.testing.assert_allclose(T_MT[:3, 2], [np.sin(B), -np.sin(A) * np.cos(B), np.cos(A) * np.cos(B)], atol=1e-9)
    assert found.pose.reached


def test_what_is_out_of_reach_says_why_and_has_no_numbers() -> None:
    far = in_hand(ROBOT, (0.0, -9.0, 0.0), 0.0, 0.0)
    assert not far.pose.reached
    assert far.reason
    assert np.isnan(far.pose.C).all()
    assert np.isnan(far.pose.frames).all()


def test_what_was_clicked_stays() -> None:
    box, known = over((-0.4, -1.4, 0.0), (0.4, -1.0, 0.0))
    assert default_point(dataclasses.replace(OWN, point=(1.0, 2.0, 3.0)), box, known) == (1.0, 2.0, 3.0)


def test_the_papers_box_starts_at_its_milling_test() -> None:
    box, known = over((-0.4, -1.4, 0.0), (0.4, -1.0, 0.0))
    view = MapView(ROBOT.name, "paper")
    assert default_point(view, box, known) == (0.0, -1.3, 0.0)
    assert default_point(dataclasses.replace(view, A=0.05), box, known) == (0.0, -1.2, 0.0)


def test_else_the_middle_to_a_centimetre() -> None:
    box, known = over((-0.396, -1.41, -0.1), (0.404, -1.0, 0.1))
    assert middle(box) == pytest.approx((0.004, -1.205, 0.0))
    x, y, z = default_point(OWN, box, known)
    assert (x, z) == (0.0, 0.0)
    assert y in (-1.2, -1.21)


def test_else_the_cell_in_reach_that_is_nearest_to_the_middle() -> None:
    box, known = over((-0.4, -5.0, 0.0), (0.4, -1.0, 0.0))
    point = np.array(default_point(OWN, box, known))
    cells = known.grid.points().reshape(-1, 3)
    apart = [float(np.linalg.norm(p - [0.0, -3.0, 0.0])) for p in cells if in_hand(ROBOT, tuple(p), 0, 0).pose.reached]
    assert np.linalg.norm(point - [0.0, -3.0, 0.0]) == pytest.approx(min(apart))
    assert in_hand(ROBOT, tuple(point), 0, 0).pose.reached


def test_where_nothing_is_reached_the_middle() -> None:
    box, known = over((5.0, 5.0, 5.0), (6.004, 6.0, 6.0), 0.5)
    assert default_point(OWN, box, known) == pytest.approx((5.502, 5.5, 5.5))
