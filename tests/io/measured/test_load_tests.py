"""Reading load tests: every protocol and unit, and a sentence with row and column for everything that is wrong."""

from __future__ import annotations

import re
import time

import numpy as np
import pytest

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.fit.estimate import identify
from robomill.identification.load_test import JointTests
from robomill.identification.synthesis import three_directions
from robomill.io.measured.load_test_sheets import load_tests_to_csv
from robomill.io.measured.load_tests import read_findings, read_load_tests, read_measured_map
from tests.identification.synthetic import simulated_tests

ROBOT = rm.load_robot("slavkovic_5r")
JOINTS = "theta1_deg,theta2_deg,theta3_deg,theta4_deg,theta5_deg"
LOADS = "Fx_N,Fy_N,Fz_N,dx_mm,dy_mm,dz_mm"
HEADER = f"{JOINTS},{LOADS}\n"
ROW = "10,-20,30,0,15,0,250,0,0.01,0.5,-0.2\n"
ROW_2 = "-10,-30,20,10,25,250,0,0,0.4,0.02,-0.1\n"


def test_joint_poses_in_si():
    tests = read_load_tests(HEADER + ROW)
    np.testing.assert_allclose(tests.theta, np.deg2rad([[10, -20, 30, 0, 15]]))
    np.testing.assert_allclose(tests.wrench, [[0, 250, 0, 0, 0, 0]])
    np.testing.assert_allclose(tests.displacement[:, :3], [[1e-5, 5e-4, -2e-4]])
    assert np.isnan(tests.displacement[:, 3:]).all()
    assert tests.row.tolist() == [2]
    assert any("gravity cancels" in f.message for f in tests.findings)


def test_every_unit_of_the_header_counts():
    header = "theta1_rad,theta2_rad,theta3_rad,theta4_rad,theta5_rad,Fx_kN,Fy_kN,Fz_kN,dx_um,dy_m,dz_in\n"
    tests = read_load_tests(header + "0.1,0.2,0.3,0.4,0.5,0.1,0.2,0.3,50,0.0001,0.001\n")
    np.testing.assert_allclose(tests.wrench[0, :3], [100, 200, 300])
    np.testing.assert_allclose(tests.displacement[0, :3], [5e-5, 1e-4, 2.54e-5])
    np.testing.assert_allclose(tests.theta[0], [0.1, 0.2, 0.3, 0.4, 0.5])


@pytest.mark.parametrize(
    "text",
    [
        (HEADER + ROW).replace(",", ";"),
        (HEADER + ROW).replace(",", ";").replace(".", ","),
        (HEADER + ROW).replace(",", "\t"),
        "\ufeff" + HEADER + ROW,
        (HEADER + ROW).replace("\n", "\r\n"),
        "# made by hand\n\n" + HEADER + "\n" + ROW + "\n,,,,,,,,,,\n",
        HEADER.replace("theta1_deg", '"theta1_deg"') + ROW.replace("10,", '"10",', 1),
        HEADER.lower().replace("_n", "_N") + ROW,
    ],
    ids=["semicolons", "decimal commas", "tabs", "byte-order mark", "windows", "remarks", "quotes", "lower case"],
)
def test_ways_to_write_the_same(text):
    np.testing.assert_array_equal(read_load_tests(text).wrench, read_load_tests(HEADER + ROW).wrench)
    np.testing.assert_array_equal(read_load_tests(text).theta, read_load_tests(HEADER + ROW).theta)


def test_world_poses_are_solved_with_the_robot():
    text = f"X_mm,Y_mm,Z_mm,A_deg,B_deg,{LOADS}\n100,-1300,0,5,-10,0,250,0,0.01,0.5,-0.2\n"
    tests = read_load_tests(text)
    assert tests.theta is None
    solved = read_load_tests(text, ROBOT)
    np.testing.assert_allclose(
        rm.world_from_pose(solved.tool_poses(ROBOT))[0], [0.1, -1.3, 0, np.deg2rad(5), np.deg2rad(-10)], atol=1e-9
    )
    assert any("as at home" in f.message for f in solved.findings)
    arm = rm.load_robot("kuka_kr270")
    x = rm.world_from_pose(rm.tool_pose(arm, arm.home)) * [1e3, 1e3, 1e3, *np.rad2deg([1, 1])]
    six = read_load_tests(text.replace("100,-1300,0,5,-10", ",".join(f"{v:.9f}" for v in x)), arm)
    assert any("turn about the tool axis" in f.message for f in six.findings)
    with pytest.raises(LoadTestError, match="Row 2: the pose .* is not reached"):
        read_load_tests(text.replace("-1300", "-9300"), ROBOT)
    with pytest.raises(LoadTestError, match=r"Row 2, theta2: 150.* outside joint 2's limits"):
        read_load_tests(HEADER + ROW.replace("-20", "150"), ROBOT)


def test_preload_moments_rotations_and_offsets():
    header = f"{JOINTS},{LOADS},F0x_N,F0y_N,F0z_N,d0x_mm,d0y_mm,d0z_mm,Mx_Nm,My_Nm,Mz_Nm,rx_mrad,ry_urad,rz_deg"
    header += ",FPx_mm,FPy_mm,FPz_mm,MPx_mm,MPy_mm,MPz_mm,noise_um\n"
    row = "0,0,0,0,0,0,250,0,0,0.5,0,0,50,0,0,0.1,0,1,2,3,1,5,0.1,0,0,-50,10,0,-20,4\n"
    tests = read_load_tests(header + row)
    np.testing.assert_allclose(tests.wrench[0], [0, 200, 0, 1, 2, 3])
    np.testing.assert_allclose(tests.displacement[0], [0, 4e-4, 0, 1e-3, 5e-6, np.deg2rad(0.1)])
    np.testing.assert_allclose(tests.force_point[0], [0, 0, -0.05])
    np.testing.assert_allclose(tests.measuring_point[0], [0.01, 0, -0.02])
    assert tests.noise[0] == pytest.approx(4e-6)
    assert not any("gravity" in f.message for f in tests.findings)


def test_one_joint_at_a_time():
    tests = read_load_tests("joint,torque_Nm,angle_urad\n1,300,214\n5,75,685\n")
    assert isinstance(tests, JointTests)
    np.testing.assert_allclose(tests.angle / tests.torque, [214e-6 / 300, 685e-6 / 75])


def test_measured_compliances_are_three_tests_a_row():
    names = ",".join(f"C{r}{c}_um_N" for r in "xyz" for c in "xyz")
    C = np.arange(1.0, 10.0).reshape(3, 3)
    text = f"X_mm,Y_mm,Z_mm,A_deg,B_deg,{names}\n0,-1300,0,0,0,{','.join(map(str, C.ravel()))}\n"
    tests = read_load_tests(text)
    assert len(tests) == 3
    np.testing.assert_allclose(tests.displacement[:, :3], C.T * 1e-6 * 250)  # Cxy is dx by Fy
    assert any("250 N" in f.message for f in tests.findings)
    direct = read_load_tests("X_mm,Y_mm,Z_mm,A_deg,B_deg,load_N,Cyy_um_N\n0,-1300,0,0,0,100,2.3\n")
    assert len(direct) == 1
    np.testing.assert_allclose(direct.displacement[0, :3], [np.nan, 2.3e-4, np.nan])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "cannot be opened|empty"),
        ("\n\n", "empty"),
        (HEADER, "only a header"),
        (ROW, "expected a header|cannot be opened"),
        (HEADER + ROW.replace("0.5", "half"), r"Row 2, column dy_mm: found 'half', expected a number"),
        (HEADER + ROW + ROW_2.replace("0.02", "nan"), r"Row 3, column dy_mm: found 'nan'"),
        (HEADER + ROW.replace("0.5", ""), r"Row 2, column dy_mm: the cell is empty"),
        (HEADER + ROW.replace("0.5", "inf"), r"Row 2, column dy_mm: found 'inf'"),
        (HEADER + ROW + "1,2,3\n", "Row 3, column theta4_deg: found 3 cells, expected 11"),
        (HEADER + ROW.replace("250", "0"), "Row 2: the force is zero"),
        (HEADER.replace(",dy_mm", "") + ROW.replace("0.5,", ""), "column dy_mm is missing beside dx_mm"),
        (HEADER.replace("Fz_N,", "") + ROW.replace(",250,0,", ",250,"), "column Fz_N is missing beside Fx_N"),
        ("X_mm,Z_mm,A_deg,B_deg,load_N,Cyy_um_N\n0,0,0,0,100,2.3\n", "column Y_mm is missing beside X_mm"),
        (f"{HEADER[:-1]},Mx_Nm,My_Nm\n{ROW[:-1]},1,1\n", "column Mz_Nm is missing beside Mx_Nm"),
        (f"{JOINTS},Fx_N,Fy_N,Fz_N\n0,0,0,0,0,1,0,0\n", "displacement columns are missing"),
        (f"{JOINTS},dx_mm,dy_mm,dz_mm\n0,0,0,0,0,1,0,0\n", "no force columns"),
        (f"{LOADS}\n1,0,0,1,0,0\n", "no pose columns"),
        (HEADER.replace("dy_mm", "dy_furlong") + ROW, r"column 'dy_furlong': unit 'furlong' is not known"),
        (HEADER.replace("dy_mm", "dy") + ROW, r"column 'dy': the unit is missing"),
        (HEADER.replace("dy_mm", "dx_um") + ROW, "same quantity twice"),
        (HEADER.replace("theta3_deg", "theta6_deg") + ROW, "no theta3_deg"),
        (HEADER.replace("theta1_deg", "X_mm") + ROW, "given twice"),
        ("a,b\n1,2\n", r"column 'a': the unit is missing"),
        ("what,ever\n1,2\n", "no column is known"),
        ("joint,torque_Nm,angle_mrad\n1.5,300,0.2\n", "Row 2, column joint: found 1.5"),
        ("joint,torque_Nm,angle_mrad\n1,0,0.2\n", "Row 2: the torque is zero"),
        ("joint,torque_Nm\n1,300\n", "column angle_mrad is missing"),
    ],
)
def test_refusals(text, words):
    with pytest.raises(LoadTestError, match=words) as caught:
        read_load_tests(text)
    assert str(caught.value).count(". ") == 0  # one sentence
    assert str(caught.value).endswith(".")


def test_files_that_are_none(tmp_path):
    with pytest.raises(LoadTestError, match="cannot be opened"):
        read_load_tests(tmp_path / "missing.csv")
    with pytest.raises(LoadTestError, match="cannot be opened"):
        read_load_tests(tmp_path)
    binary = tmp_path / "photo.csv"
    binary.write_bytes(b"\xff\xfe\x00\x01\n")
    with pytest.raises(LoadTestError, match="not a text file"):
        read_load_tests(binary)


def test_joint_limits_and_joint_numbers_of_single_tests():
    with pytest.raises(LoadTestError, match="Row 2, joint: found 9"):
        identify(ROBOT, read_load_tests("joint,torque_Nm,angle_mrad\n9,300,0.2\n"))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: -d, "is the sign of the displacements or of the forces turned round"),
        (lambda d: d * [1, -1, 1], "dy runs against Fy .* sign of dy"),
        (lambda d: d * 1000, "1e.03 times larger|1000 times larger|1.. times larger"),
        (lambda d: d / 1000, "times smaller"),
        (lambda d: 0 * d, "zero"),
    ],
    ids=["all signs", "one sign", "micrometres as millimetres", "metres as millimetres", "not read"],
)
def test_suspicions_are_said_aloud(change, words):
    theta = np.random.default_rng(0).uniform(-0.6, 0.6, (8, 5))
    good = simulated_tests(ROBOT, *three_directions(theta, 250.0), noise=4e-6)
    assert [f for f in read_findings(good, ROBOT) if f.level == "suspicious"] == []
    text = load_tests_to_csv(good)
    tests = read_load_tests(text)
    bad = type(tests)(tests.wrench, change(tests.displacement[:, :3]), theta=tests.theta)
    found = [f.message for f in read_findings(bad, ROBOT) if f.level == "suspicious"]
    assert len(found) == 1
    assert re.search(words, found[0]), found


def test_poses_in_the_wrong_unit_are_suspected():
    radians = read_load_tests(HEADER + ROW.replace("10,-20,30,0,15", "0.17,-0.35,0.52,0,0.26"))
    assert any("are these poses in rad" in f.message for f in radians.findings)
    assert {f.line for f in radians.findings if f.code == "pose-unit"} == {0}, "of the whole file"
    metres = read_load_tests(f"X_mm,Y_mm,Z_mm,A_deg,B_deg,{LOADS}\n0.3,-1.3,0,0,0,0,250,0,0,0.5,0\n")
    assert any("are these poses in m?" in f.message for f in metres.findings)
    assert not any(f.level == "suspicious" for f in read_load_tests(HEADER + ROW).findings)


@pytest.mark.parametrize(
    ("header", "cells", "suspected"),
    [
        (JOINTS, "6.29,-1,1,1,1", "No theta1_deg is larger than 6.29: are these poses in rad?"),
        (JOINTS, "1,-6.31,1,1,1", ""),
        (JOINTS, "0,0,0,0,0", ""),
        (JOINTS.replace("deg", "rad"), "0.5,0.5,0.5,0.5,0.5", ""),
        ("X_mm,Y_mm,Z_mm,A_deg,B_deg", "9.9,-1300,0,0,0", "No X_mm is larger than 9.9: are these poses in m?"),
        ("X_mm,Y_mm,Z_mm,A_deg,B_deg", "10.1,-1300,0,0,0", ""),
        ("X_mm,Y_mm,Z_mm,A_deg,B_deg", "0,-9.9,0,0,0", "No Y_mm is larger than 9.9: are these poses in m?"),
        ("X_m,Y_m,Z_m,A_deg,B_deg", "0.1,-1.3,0,0,0", ""),
        ("X_mm,Y_mm,Z_mm,A_deg,B_deg", "1,-2,0,0,0", "No X_mm is larger than 1: are these poses in m?"),
    ],
)
def test_where_the_suspicion_begins(header, cells, suspected):
    tests = read_load_tests(f"{header},{LOADS}\n{cells},0,250,0,0,0.5,0\n")
    assert [f.message for f in tests.findings if f.level == "suspicious"] == ([suspected] if suspected else [])


def test_loads_and_joint_numbers_at_the_edge_of_what_is_allowed():
    world = "X_mm,Y_mm,Z_mm,A_deg,B_deg"
    for load in ("0", "-1"):
        with pytest.raises(LoadTestError, match="Row 2, column load_N: expected a load above zero"):
            read_load_tests(f"{world},load_N,Cyy_um_N\n0,-1300,0,0,0,{load},2.3\n")
        rows = "".join(f"{k},-1300,0,0,0,{n},2.3\n" for k, n in enumerate((100, 200, load, 300, load)))
        with pytest.raises(LoadTestError, match="Row 4, column load_N: expected a load above zero"):
            read_load_tests(f"{world},load_N,Cyy_um_N\n{rows}")
    half = read_load_tests(f"{world},load_N,Cyy_um_N\n0,-1300,0,0,0,0.5,2\n")
    np.testing.assert_allclose((half.wrench[0, :3], half.displacement[0, :3]), [[0, 0.5, 0], [np.nan, 1e-6, np.nan]])
    single = read_load_tests("joint,torque_kNm,angle_mrad,noise_urad\n1,0.3,0.2,5\n")
    assert (single.joint[0], single.torque[0]) == (1, 300)
    assert single.noise[0] == pytest.approx(5e-6)
    with pytest.raises(LoadTestError, match="Row 3, column joint: found 0, expected a joint number from 1"):
        read_load_tests("joint,torque_Nm,angle_mrad\n1,300,0.2\n0,300,0.2\n")
    with pytest.raises(LoadTestError, match="column torque_Nm is missing; one joint at a time"):
        read_load_tests("joint,angle_mrad\n1,300\n")


def test_moments_and_rotations_alone_are_tests_too():
    tests = read_load_tests(f"{JOINTS},Mx_Nm,My_Nm,Mz_Nm,rx_mrad,ry_mrad,rz_mrad\n0,0,0,0,0,1,2,3,4,5,6\n")
    np.testing.assert_allclose(tests.wrench, [[0, 0, 0, 1, 2, 3]])
    np.testing.assert_allclose(tests.displacement, [[np.nan, np.nan, np.nan, 4e-3, 5e-3, 6e-3]])


def test_each_compliance_goes_to_its_place_and_keeps_its_row_and_noise():
    world = "X_mm,Y_mm,Z_mm,A_deg,B_deg"
    text = f"{world},load_N,noise_um,Cxz_um_N,Cyx_mm_N\n0,-1300,0,0,0,100,3,2,4\n9,-1300,0,0,0,200,7,1,5\n"
    tests = read_load_tests(text)
    assert tests.row.tolist() == [2, 2, 3, 3]
    np.testing.assert_allclose(tests.wrench[:, :3], [[100, 0, 0], [0, 0, 100], [200, 0, 0], [0, 0, 200]])
    nan = np.nan
    moved = [[nan, 0.4, nan], [2e-4, nan, nan], [nan, 1.0, nan], [2e-4, nan, nan]]
    np.testing.assert_allclose(tests.displacement[:, :3], moved)
    np.testing.assert_allclose(tests.noise, [3e-6, 3e-6, 7e-6, 7e-6])
    np.testing.assert_allclose(tests.x_M[:, 0], [0, 0, 9e-3, 9e-3])


def test_files_name_themselves_and_their_remarks(tmp_path):
    file = tmp_path / "monday.csv"
    file.write_text("# cell 4\n" + HEADER + ROW, encoding="utf-8-sig")
    assert read_load_tests(file).provenance.source == "monday.csv\ncell 4"
    assert read_load_tests(HEADER + ROW).provenance.source == "pasted cells"
    file.write_text(HEADER + ROW.replace("0.5", "half"))
    with pytest.raises(LoadTestError, match="^monday.csv, row 2, column dy_mm: found 'half'"):
        read_load_tests(file)


def test_a_measured_map_needs_poses():
    with pytest.raises(LoadTestError, match="found tests of single joints; give compliances"):
        read_measured_map("joint,torque_Nm,angle_mrad\n1,300,0.2\n", ROBOT)


def test_copies_are_named():
    tests = read_load_tests(HEADER + ROW + ROW_2 + ROW + ROW)
    found = [f for f in read_findings(tests) if f.level == "warning"]
    assert len(found) == 1
    assert found[0].message.startswith("Row 4 repeats row 2 to the last digit (and 1 more)")
    assert found[0].count == 2


def test_unknown_columns_are_passed_over_aloud():
    tests = read_load_tests(HEADER.replace("\n", ",operator\n") + ROW.replace("\n", ",Ana\n"))
    assert [f.message for f in tests.findings if f.level == "ignored"] == [
        "Column 'operator' is not one of ours and is passed over."
    ]


def test_a_hundred_thousand_rows_are_read_in_two_seconds():
    lines = [f"{k % 90},{-k % 60},20,{k % 50},25,{k % 7 + 1},0,0,0.4,0.02,-0.1" for k in range(100_000)]
    text = HEADER + "\n".join(lines)
    start = time.process_time()
    assert len(read_load_tests(text)) == 100_000
    assert time.process_time() - start < 2.0


RAIL = rm.Robot.from_dh(
    d_mm=[0, 750, 0],
    a_mm=[0, 350, 1250],
    alpha_deg=[90, -90, 0],
    prismatic=[True, False, False],
    limits_mm=[(-500, 500), None, None],
    C_theta=[4e-8, 2.6e-7, 1.5e-7],
)


def test_a_joint_that_slides_gives_by_its_force_and_one_that_turns_by_no_displacement():
    """40 nm/N: 0.02 mm under 500 N. Of a joint that turns a displacement says nothing: at which lever arm?"""
    found = rm.identify(RAIL, read_load_tests("joint,torque_N,angle_mm\n1,500,0.02\n1,-500,-0.02\n", RAIL))
    assert found.C_theta[0] == pytest.approx(0.02e-3 / 500)
    for header, column in (("torque_N,angle_mrad", "torque_N"), ("torque_Nm,angle_um", "angle_um")):
        text = f"joint,{header}\n1,500,0.2\n2,500,0.2\n"
        with pytest.raises(LoadTestError, match=f"Row 3, column {column}: joint 2 turns"):
            read_load_tests(text, RAIL)
        with pytest.raises(LoadTestError, match="read the tests with it"):
            read_load_tests(text)


@pytest.mark.parametrize(
    ("columns", "refused"),
    [
        ("theta1_mm,theta2_deg,theta3_rad", None),
        ("theta1_deg,theta2_deg,theta3_deg", "column theta1: this joint slides; give theta1_mm"),
        ("theta1_m,theta2_mm,theta3_deg", "column theta2: this joint turns; give theta2_deg"),
    ],
)
def test_a_joint_coordinate_is_a_length_where_the_joint_slides_and_an_angle_where_it_turns(columns, refused):
    """10 degrees are no 0.17 m of a rail, nor are 10 mm a hundredth of a rad; whether the arm is known on reading, or
    only when it is identified."""
    row = [0.01 if name.endswith("_m") else 0.5 if name.endswith("rad") else 10 for name in columns.split(",")]
    text = f"{columns},Fx_N,Fy_N,Fz_N,dx_mm,dy_mm,dz_mm\n" + ",".join(map(str, row)) + ",100,0,0,0.1,0.01,0.02\n"
    if refused is None:
        np.testing.assert_allclose(read_load_tests(text, RAIL).theta[0], [0.01, np.radians(10), 0.5])
        return
    with pytest.raises(LoadTestError, match=refused):
        read_load_tests(text, RAIL)
    with pytest.raises(LoadTestError, match=refused):
        identify(RAIL, read_load_tests(text))


def test_a_sheet_for_an_arm_on_a_rail_says_its_place_in_millimetres():
    theta = np.array([[0.25, 0.3, -0.4], [-0.1, 1.0, 0.2]])
    F = np.array([[100.0, 0.0, 50.0], [0.0, 200.0, -50.0]])
    text = load_tests_to_csv(simulated_tests(RAIL, theta, F).with_joints(RAIL))
    header, first = [line.split(",") for line in text.splitlines() if not line.startswith("#")][:2]
    assert float(first[header.index("theta1_mm")]) == 250.0
    assert float(first[header.index("theta2_deg")]) == pytest.approx(np.degrees(0.3), abs=1e-5)
    np.testing.assert_allclose(read_load_tests(text, RAIL).theta, theta, atol=1e-7)
