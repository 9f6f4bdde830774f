"""Tables of results in pandas and xarray: the columns that files hold, against the arrays times plain factors."""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

import robomill as rm
from robomill.csv_text import csv_text
from robomill.identification.measured_field import MeasuredField
from robomill.io.maps import map_csv
from robomill.io.samples import samples_dir
from robomill.units import UNITS, si_unit
from robomill.workspace.fields import compliance_map
from robomill.workspace.grid import Grid
from robomill.workspace.quantities import map_quantities

DEG = 180.0 / math.pi
LOAD_TESTS = samples_dir() / "load_tests"


@pytest.fixture(scope="module")
def robot():
    return rm.load_robot("slavkovic_5r")


@pytest.fixture(scope="module")
def result():
    return rm.simulate(rm.load_setup(samples_dir() / "paper_flute" / "setup.toml"))


@pytest.fixture(scope="module")
def field(robot):
    return compliance_map(robot, Grid([-0.3, 0.1, 9.0], [-1.5, -1.3], [0.0, 0.2]), A=0.1)


def test_a_run_has_a_row_a_sample(result):
    frame = result.to_dataframe()
    assert len(frame) == len(result.path)
    np.testing.assert_allclose(frame["station_mm"], result.path.s * 1000.0)
    np.testing.assert_allclose(frame[["F_x_N", "F_y_N", "F_z_N"]], result.F)
    np.testing.assert_allclose(frame[[f"delta_{a}_mm" for a in "xyz"]], result.delta * 1000.0)
    for j in range(5):
        shares = frame[[f"joint{j + 1}_{a}_mm" for a in "xyz"]]
        np.testing.assert_allclose(shares, result.delta_joint[:, j] * 1000.0)
    assert frame["reached"].dtype == bool
    assert frame["line"].tolist() == result.path.block.tolist()
    assert list(frame) == csv_text(result.columns()).splitlines()[0].split(",")  # the table that the command writes


def test_a_frame_is_free_to_be_changed(result):
    frame = result.to_dataframe()
    frame.loc[0, "F_x_N"] = 1.0
    frame["more"] = 0.0
    assert result.to_dataframe().loc[0, "F_x_N"] == result.F[0, 0]


def test_sections_have_a_row_each_and_one_its_profile(result):
    frame = result.sections.to_dataframe()
    np.testing.assert_allclose(frame["width_mm"], [section.width * 1e3 for section in result.sections])
    np.testing.assert_allclose(frame["wall_left_angle_deg"], [s.wall_left_angle * DEG for s in result.sections])
    assert set(frame["kind"]) == {"groove"}
    profile = result.sections[0].to_dataframe()
    np.testing.assert_allclose(profile, 1e3 * np.column_stack([getattr(result.sections[0], n) for n in PROFILE]))
    assert list(profile) == [f"{name}_mm" for name in PROFILE]
    assert len(result.grooves([0.02, 0.03]).to_dataframe()) == 2


PROFILE = ("w", "z_ideal", "z_machined")


def test_a_path_has_a_row_a_point(result):
    path = result.setup.toolpath
    frame = path.to_dataframe()
    np.testing.assert_allclose(frame[["X_mm", "Y_mm", "Z_mm"]], path.p * 1e3)
    np.testing.assert_allclose(frame["feed_mm_min"], path.v_f * 60e3)
    np.testing.assert_allclose(frame["spindle_1_min"], path.n_s * 60.0)
    np.testing.assert_array_equal(frame[["k_x", "k_y", "k_z"]], path.k)


def test_solved_poses_say_the_joints_as_load_tests_do(robot):
    x_M = np.array([[0.1, -1.2, 0.1, 0.1, -0.2], [9.0, 0.0, 0.0, 0.0, 0.0]])
    ik = rm.inverse_kinematics(robot, rm.pose_from_world(x_M))
    frame = ik.to_dataframe()
    np.testing.assert_allclose(frame[["X_mm", "Y_mm", "Z_mm"]], x_M[:, :3] * 1e3)
    np.testing.assert_allclose(frame[["A_deg", "B_deg"]], x_M[:, 3:] * DEG, atol=1e-12)
    np.testing.assert_allclose(frame.filter(like="theta"), ik.theta * DEG)
    assert frame["reached"].tolist() == [True, False]
    assert frame["branch"].tolist() == [ik.branch[0], ""]
    batch = rm.inverse_kinematics(robot, rm.pose_from_world(x_M)[:, None]).to_dataframe()
    pd.testing.assert_frame_equal(batch, frame)


def test_a_sliding_joint_is_in_millimetres():
    nothing = np.zeros(2)
    arm = rm.Robot("arm", "standard", nothing, nothing + 0.3, nothing, nothing, [[-1, 1], [0, 1]], nothing)
    sliding = arm.replace(prismatic=[False, True], alpha=[np.pi / 2, 0.0])
    ik = rm.inverse_kinematics(sliding, rm.tool_pose(sliding, [0.3, 0.05]))
    assert list(ik.to_dataframe().filter(like="theta")) == ["theta1_deg", "theta2_mm"]


def test_a_map_is_the_table_that_files_hold(field, robot):
    names = ["C_yy", "share_C_xx_2", "det_J", "reach"]
    frame = field.to_dataframe()
    assert list(frame)[:3] == ["X_mm", "Y_mm", "Z_mm"]
    points = [(x, y, z) for x in (-300, 100, 9000) for y in (-1500, -1300) for z in (0, 200)]
    np.testing.assert_allclose(frame[["X_mm", "Y_mm", "Z_mm"]], points)
    np.testing.assert_allclose(frame["C_yy_um/N"], field.values("C_yy").ravel() * 1e6)
    np.testing.assert_allclose(frame["share_C_xx_2_percent"], field.values("share_C_xx_2").ravel() * 100.0)
    header = map_csv([field.field(name) for name in names]).splitlines()[0].split(",")
    assert header == [*list(frame)[:3], *(field.field(name).quantity.column for name in names)]
    assert list(field.field("C_yy").to_dataframe()) == ["X_mm", "Y_mm", "Z_mm", "C_yy_um/N"]


def test_a_map_in_xarray_is_the_compliance_at_the_pose_that_is_selected(field, robot):
    data = field.to_xarray(["C_yy", "C_xz", "reach"])
    assert dict(data.sizes) == {"x": 3, "y": 2, "z": 2}
    one = data.sel(x=0.1, y=-1.3, z=0.2)
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0.1, -1.3, 0.2, 0.1, 0.0])).theta
    J_v = rm.geometric_jacobian(robot, theta)[:3]
    C = J_v @ np.diag(robot.C_theta) @ J_v.T  # eq. (13)
    assert float(one.C_yy) == pytest.approx(C[1, 1], rel=1e-9)
    assert float(one.C_xz) == pytest.approx(C[0, 2], rel=1e-9)
    assert np.isnan(data.C_yy.sel(x=9.0)).all()
    assert (data.reach.sel(x=9.0) == 0).all()
    assert data.C_yy.attrs["units"] == "m/N"
    assert data.x.attrs["units"] == "m"
    assert (float(data.A), float(data.B)) == (0.1, 0.0)
    assert data.attrs["robot"] == "slavkovic_5r"
    alone = field.field("C_yy").to_xarray()
    assert alone.name == "C_yy"
    np.testing.assert_array_equal(alone, field.values("C_yy"))
    alone[0, 0, 0] = 7.0
    assert field.values("C_yy")[0, 0, 0] != 7.0


def test_every_quantity_of_a_map_is_in_the_dataset_with_its_unit(field, robot):
    data = field.to_xarray()
    assert set(data.data_vars) == set(map_quantities(robot))
    for name, what in map_quantities(robot).items():
        unit = data[name].attrs["units"]
        assert UNITS[unit].factor == 1.0, name
        assert data[name].attrs["long_name"] == what.title
    with pytest.raises(rm.RobomillError, match="Quantity 'C_ww': expected reach"):
        field.to_xarray(["C_ww"])


@pytest.mark.parametrize(
    "unit",
    sorted(
        {
            q.unit
            for name in ("slavkovic_5r", "planar_2r", "kuka_kr270")
            for q in map_quantities(rm.load_robot(name)).values()
        }
    ),
)
def test_the_unit_inside_is_a_unit_of_the_same_kind_without_a_factor(unit):
    assert UNITS[si_unit(unit)].factor == 1.0


def test_load_tests_are_the_columns_of_their_file(robot):
    tests = rm.read_load_tests(LOAD_TESTS / "nine_points.csv", robot)
    frame = tests.to_dataframe()
    np.testing.assert_allclose(frame[["Fx_N", "Fy_N", "Fz_N"]], tests.wrench[:, :3])
    np.testing.assert_allclose(frame[["dx_mm", "dy_mm", "dz_mm"]], tests.displacement[:, :3] * 1e3)
    np.testing.assert_allclose(frame.filter(like="theta"), tests.theta * DEG)
    assert frame.index.tolist() == tests.row.tolist()
    assert frame.index.name == "row"
    joints = rm.read_load_tests(LOAD_TESTS / "one_joint_at_a_time.csv").to_dataframe()
    assert list(joints)[:3] == ["joint", "torque_Nm", "angle_mrad"]


def test_an_identification_has_a_row_a_parameter(robot):
    found = rm.identify(robot, rm.read_load_tests(LOAD_TESTS / "nine_points.csv", robot))
    frame = found.to_dataframe()
    assert frame["parameter"].tolist() == [f"joint {j}" for j in range(1, 6)]
    assert set(frame["unit"]) == {"1e-7 rad/(N m)"}
    np.testing.assert_allclose(frame["value"], found.C_theta * 1e7)
    np.testing.assert_allclose(frame["stderr"], found.stderr * 1e7)
    np.testing.assert_allclose(frame[["ci95_low", "ci95_high"]], found.ci95 * 1e7)


def test_a_measured_map_is_the_table_that_it_is_read_from():
    C = np.array([[[2.0, 0.1, 0.0], [0.1, 1.5, 0.0], [0.0, 0.0, 1.0]]]) * 1e-6
    frame = MeasuredField(np.array([[0.0, -1.3, 0.2]]), C, np.array([[0.1, 0.0]])).to_dataframe()
    assert frame.iloc[0][["X_mm", "Y_mm", "Z_mm"]].tolist() == [0.0, -1300.0, 200.0]
    np.testing.assert_allclose(frame.iloc[0][["Cxx_um_N", "Cxy_um_N", "Czz_um_N"]], [2.0, 0.1, 1.0])
    assert frame["A_deg"][0] == pytest.approx(0.1 * DEG)


def test_a_robot_has_a_row_a_joint(robot):
    frame = robot.to_dataframe()
    np.testing.assert_allclose(frame["alpha_deg"], robot.alpha * DEG)
    np.testing.assert_allclose(frame["a_mm"], robot.a * 1e3)
    np.testing.assert_allclose(frame["compliance"], robot.C_theta * 1e7)
    np.testing.assert_allclose(frame[["lower", "upper"]], robot.limits * DEG)


@pytest.mark.parametrize(
    ("library", "call"),
    [("pandas", "robot.to_dataframe()"), ("xarray", "compliance_map(robot, grid).field('reach').to_xarray()")],
)
def test_what_is_missing_is_named_with_its_extra(library, call):
    code = (
        f"import sys; sys.modules[{library!r}] = None\n"
        "import robomill as rm\n"
        "from robomill.workspace.fields import compliance_map\n"
        "from robomill.workspace.grid import Grid\n"
        "robot, grid = rm.load_robot('slavkovic_5r'), Grid([0.0], [-1.3], [0.0])\n"
        f"try: {call}\n"
        "except rm.RobomillError as exc: print(exc)\n"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert f"needs {library}" in said
    assert 'pip install "robomill[data]"' in said
