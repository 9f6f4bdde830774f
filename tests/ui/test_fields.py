"""What the map pages draw: the field at its cell, stiffer joints, planes of round steps."""

from __future__ import annotations

import numpy as np

import robomill as rm
from robomill.compliance.at_pose import PoseReport
from robomill.improve.sensitivity import stiffened
from robomill.ui import fields
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
