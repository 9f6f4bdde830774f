"""What the map pages draw: the field at its cell, stiffer joints, planes of round steps."""

from __future__ import annotations

import numpy as np

import robomill as rm
from robomill.compliance.at_pose import PoseReport
from robomill.improve.sensitivity import stiffened
from robomill.ui.posed import fields
from robomill.ui.project import MapView
from robomill.workspace.fields import compliance_map
from robomill.workspace.grid import PAPER_BOX, box_grid

POINT = (0.2, -1.2, -0.1)


def test_the_report_is_the_field_at_its_cell(found: PoseReport) -> None:
    """Click and map agree: one pose solved alone gives what the plane shows."""
    field = compliance_map(found.robot, box_grid(POINT, POINT, 1.0))
    np.testing.assert_allclose(found.C, field.C()[0, 0, 0], rtol=1e-12)


def test_stiffer_fields_are_those_of_the_stiffer_robot(found: PoseReport) -> None:
    factors = np.array([1.0, 2.0, 0.5, 1.0, 3.0])
    grid = box_grid(*PAPER_BOX, 0.3)
    quick = fields.stiffer(compliance_map(found.robot, grid), factors)
    slow = compliance_map(stiffened(found.robot, factors), grid)
    np.testing.assert_allclose(quick.total, slow.total, rtol=1e-12, atol=1e-22)


def test_the_step_of_a_plane_is_a_round_number() -> None:
    robot = rm.load_robot("slavkovic_5r")
    view = MapView("r", "paper")
    box = fields.region(robot, view)
    assert fields.plane_step(robot, view, box, "z") == 0.02
    assert fields.plane(robot, view, box, "z", 0.0).shape == (61, 31, 1)


def test_a_difference_of_maps_is_that_of_two_arms_each_by_itself() -> None:
    """Cell by cell: inverse kinematics and C of either arm alone; none where either does not reach."""
    one = rm.load_robot("slavkovic_5r")
    limits = one.limits.copy()
    limits[0] = [-0.2, 0.2]  # it does not turn aside as far
    other = stiffened(one, [1.0, 0.5, 1.0, 1.0, 2.0]).replace(limits=limits)
    grid = box_grid(*PAPER_BOX, 0.3)
    names = ("C_yy", "C_yz")
    found = fields.coded_differences(one, other, grid, "z", (0.0, 0.0), names)
    for name in names:
        a, b = ("xyz".index(axis) for axis in name[2:])
        low, high, mean = [], [], []
        for z in grid.z:
            apart = []
            for x in grid.x:
                for y in grid.y:
                    T = rm.pose_from_world([x, y, z, 0.0, 0.0])
                    both = [rm.inverse_kinematics(arm, T) for arm in (one, other)]
                    if all(each.reached for each in both):
                        C = [rm.cartesian_compliance(arm, ik.theta) for arm, ik in zip((one, other), both, strict=True)]
                        apart.append(float(C[1][a, b] - C[0][a, b]))
            assert 0 < len(apart) < len(grid.x) * len(grid.y), "some cells are reached by one arm only"
            low.append(min(apart))
            high.append(max(apart))
            mean.append(float(np.mean(apart)))
        np.testing.assert_allclose(found[name].least, low, rtol=1e-4, atol=1e-12)
        np.testing.assert_allclose(found[name].most, high, rtol=1e-4, atol=1e-12)
        np.testing.assert_allclose(found[name].mean, mean, rtol=1e-4, atol=1e-12)
