"""From process data to deflection: the paper's milling test with no measured force, each part of it named."""

import numpy as np
import pytest

from robomill.compliance.cartesian import cartesian_compliance
from robomill.cutting.conditions import CutConditions
from robomill.cutting.force import feed_frame, force_on_tool
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.materials import alternatives
from robomill.cutting.tool import Cutter
from robomill.io.materials import load_material, sample_materials
from robomill.io.robot.robots import load_robot
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world

MILL = Cutter("flat", 8e-3, flutes=3)
REF190 = load_material("al7075_t6_carbide_ref190")
#: Mid-slot: feed +X, tool vertical, in the robot's frame.
CONDITIONS = CutConditions.steady(0.03, 200.0, 2e-3, cutting=[False, True])
R_MF = feed_frame([[0, 0, 0], [1.0, 0, 0]], [[0, 0, 1.0]] * 2)


def compliance(table):
    robot = load_robot("slavkovic_5r").with_compliance_set(table)
    return cartesian_compliance(robot, inverse_kinematics(robot, pose_from_world([0, -1.3, 0, 0, 0])).theta)


def deviation_in_y(model, table):
    return (compliance(table) @ force_on_tool(model, CONDITIONS, R_MF)[1])[1]


@pytest.mark.parametrize(("table", "with_pull"), [("table_2", 0.277e-3), ("table_3", 0.321e-3)])
def test_paper_slot_from_process_data(table, with_pull):
    assert deviation_in_y(MechanisticForce(MILL, REF190), table) == pytest.approx(with_pull, abs=0.5e-6)


def test_feed_normal_force_alone_and_what_the_pull_adds():
    alone = deviation_in_y(MechanisticForce(MILL, REF190, axial=False), "table_2")
    assert alone == pytest.approx(0.2535e-3, abs=0.1e-6)
    F = force_on_tool(MechanisticForce(MILL, REF190), CONDITIONS, R_MF)[1]
    assert compliance("table_2")[1, 2] * F[2] == pytest.approx(0.024e-3, abs=0.3e-6)
    pushed = deviation_in_y(MechanisticForce(MILL.replace(helix="left"), REF190), "table_2")
    assert pushed < alone


def test_band_of_the_same_alloy_holds_what_the_part_showed():
    # The part: about 0.3 mm. The paper names neither alloy nor helix, so the band of 7075 is what can honestly be said.
    rows = MechanisticForce(MILL, REF190, alternatives(REF190, sample_materials())).by_material(CONDITIONS)
    C = compliance("table_3")
    spread = [(C @ np.einsum("ij,j->i", R_MF[1], force[1]))[1] for _, force in rows]
    assert min(spread) < 0.3e-3 < max(spread)
