"""Slavkovic et al., FME Transactions 41 (2013): claims 1 to 4 of the analysis, each quoted and checked."""

import numpy as np
import pytest

import robomill as rm
from robomill.kinematics.dexterity import determinant
from robomill.workspace.fields import compliance_field
from robomill.workspace.grid import PAPER_BOX, box_grid, plane_grid

# The milling test stands at (0, -1300, 0) mm with the tool vertical.
MILLING_POINT = (0.0, -1.3, 0.0, 0.0, 0.0)
# With the assumed lengths C_yy grows with Y_M as far out as this.
C_YY_GROWS_UP_TO_X = 0.4
LEAST_SHARE_OF_JOINTS_1_3_5 = 0.90
# "Only from": what other joints may add, as a part of the largest value on the plane.
ROUNDING = 1e-12
SMALLEST_DET, LARGEST_DET = 0.25, 1.96
# "Mostly from": the part of the sizes of all shares.
MOSTLY = 0.90


@pytest.fixture(scope="module")
def robot():
    return rm.load_robot("slavkovic_5r")


@pytest.fixture(scope="module")
def plane(robot):
    """The plane Z_M = 0 of Figs. 5 to 7, 50 mm apart; axes 0 and 1 are X_M and Y_M."""
    return compliance_field(robot, plane_grid("z", 0.0, *PAPER_BOX, 0.05))


def test_c_yy_and_det_at_the_milling_test(robot):
    found = rm.inverse_kinematics(robot, rm.pose_from_world(MILLING_POINT))
    assert rm.cartesian_compliance(robot, found.theta)[1, 1] == pytest.approx(2.295e-6, abs=0.0005e-6)
    assert abs(determinant(robot, found.theta)) == pytest.approx(1.134, abs=0.0005)


def test_c_yy_at_the_milling_test_in_closed_form(robot):
    """At X = 0, Z_M = 0 with a vertical tool only joints 3 and 5 act in Y: C_yy = C_3 h^2 + C_5 a_5^2."""
    a_2, d_4, a_5 = 1.22, 1.1, 0.3
    # Elbow height above the tip, from the triangle of shoulder, elbow and wrist centre (at y = -1.3, z = a_5).
    reach_2 = 1.3**2 + a_5**2
    elevation = np.arctan2(a_5, 1.3) + np.arccos((a_2**2 + reach_2 - d_4**2) / (2 * a_2 * np.sqrt(reach_2)))
    h = a_2 * np.sin(elevation)
    found = rm.inverse_kinematics(robot, rm.pose_from_world(MILLING_POINT))
    C_yy = rm.cartesian_compliance(robot, found.theta)[1, 1]
    assert C_yy == pytest.approx(12.30e-7 * h**2 + 91.35e-7 * a_5**2, rel=1e-12)


def test_claim_1_c_xx_and_c_zz(plane):
    """Fig. 5: "C_xx and C_zz decrease with growing Y_M and grow with |X_M|"."""
    for component in ("C_xx", "C_zz"):
        values = plane.values(component)[:, :, 0]
        assert (np.diff(values, axis=1) < 0).all(), component
        right = values[plane.grid.x >= -1e-9]
        assert (np.diff(right, axis=0) > 0).all(), component
        np.testing.assert_allclose(values, values[::-1], rtol=1e-12)


def test_claim_1_c_yy(plane):
    """Fig. 5: "C_yy grows with Y_M (with our lengths for |X_M| <= 0.4 m) and falls with |X_M|"."""
    values = plane.values("C_yy")[:, :, 0]
    inner = np.abs(plane.grid.x) <= C_YY_GROWS_UP_TO_X + 1e-9
    assert (np.diff(values[inner], axis=1) > 0).all()
    right = values[plane.grid.x >= -1e-9]
    assert (np.diff(right, axis=0) < 0).all()
    np.testing.assert_allclose(values, values[::-1], rtol=1e-12)


@pytest.mark.parametrize("component", ["xx", "yy"])
def test_claim_2_joints_1_3_5(plane, component):
    """Fig. 6: "C_xx and C_yy come mostly from joints 1, 3, 5 (together at least 90 % of the mean over the plane)"."""
    total = plane.values(f"C_{component}").mean()
    part = sum(plane.values(f"C_{component}_{joint}").mean() for joint in (1, 3, 5))
    assert part / total >= LEAST_SHARE_OF_JOINTS_1_3_5


def test_claim_2_c_zz_only_from_joints_2_and_3(plane):
    """Fig. 6: "C_zz only from joints 2 and 3"."""
    largest = plane.values("C_zz").max()
    for joint in (1, 4, 5):
        assert np.abs(plane.values(f"C_zz_{joint}")).max() <= ROUNDING * largest
    assert all(plane.values(f"C_zz_{joint}").min() > 1e-3 * largest for joint in (2, 3))


def test_claim_3_c_xy_mostly_from_joints_1_3_5(plane):
    """Fig. 7: "C_xy comes mostly from joints 1, 3, 5"."""
    size = {joint: np.abs(plane.values(f"C_xy_{joint}")).mean() for joint in range(1, 6)}
    assert (size[1] + size[3] + size[5]) / sum(size.values()) >= MOSTLY


@pytest.mark.parametrize("component", ["xz", "yz"])
def test_claim_3_cross_terms_with_z_only_from_joint_3(plane, component):
    """Fig. 7: "C_xz and C_zy only from joint 3" (at Z_M = 0)."""
    largest = np.abs(plane.values(f"C_{component}")).max()
    for joint in (1, 2, 4, 5):
        assert np.abs(plane.values(f"C_{component}_{joint}")).max() <= ROUNDING * largest
    np.testing.assert_allclose(
        plane.values(f"C_{component}_3"), plane.values(f"C_{component}"), atol=ROUNDING * largest
    )


def test_claim_4_no_singularity_in_the_adopted_box(robot):
    """Fig. 4: "det(J) shows no singularity anywhere in the adopted box" (here |det J| from about 0.25 to 1.96 m^3)."""
    field = compliance_field(robot, box_grid(*PAPER_BOX, 0.05))
    assert field.reached.all()
    det = field.det_J
    assert (np.sign(det) == np.sign(det[0, 0, 0])).all()
    assert np.abs(det).min() == pytest.approx(SMALLEST_DET, abs=0.01)
    assert np.abs(det).max() == pytest.approx(LARGEST_DET, abs=0.01)


@pytest.mark.parametrize(("table", "y_mm", "z_mm"), [("table_2", 0.2295, -0.1024), ("table_3", 0.2644, -0.1227)])
def test_deviation_of_100_n_feed_normal_at_the_milling_test(robot, table, y_mm, z_mm):
    """Sec. 5.2: about 0.23 mm from Table 2, and the cross-compliance lowers the tip."""
    arm = robot.with_compliance_set(table)
    theta = rm.inverse_kinematics(arm, rm.pose_from_world(MILLING_POINT)).theta
    C_joint = rm.joint_contributions(rm.geometric_jacobian(arm, theta)[:3], arm.C_theta)
    delta_joint = rm.deflection(C_joint, [0.0, 100.0, 0.0])
    np.testing.assert_allclose(delta_joint.sum(axis=0) * 1e3, [0.0, y_mm, z_mm], atol=0.0001)
    if table == "table_2":
        np.testing.assert_allclose(delta_joint[[2, 4], 1] * 1e3, [0.1473, 0.0822], atol=0.0001)
        assert np.abs(delta_joint[[0, 1, 3], 1]).max() < 1e-6
