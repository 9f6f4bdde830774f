"""Load tests written as CSV: templates, measuring sheets, and tests that read back."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.fit.estimate import identify
from robomill.identification.load_test import LoadTests
from robomill.identification.plan import box_candidates, next_best
from robomill.identification.synthesis import three_directions
from robomill.io.measured.load_test_sheets import load_test_template, load_tests_to_csv, measuring_sheet
from robomill.io.measured.load_tests import read_load_tests
from tests.identification.synthetic import simulated_tests

ROBOT = rm.load_robot("slavkovic_5r")


@pytest.mark.parametrize("protocol", ["joints", "world", "joint by joint", "compliances"])
def test_templates_can_be_read(protocol):
    assert len(read_load_tests(load_test_template(protocol)))


def test_template_refuses_what_it_does_not_know():
    with pytest.raises(LoadTestError, match="expected one of"):
        load_test_template("gossip")


def test_written_tests_read_back():
    rng = np.random.default_rng(2)
    wrench, moved = rng.normal(size=(2, 9, 6)) * [[[100] * 3 + [10] * 3], [[1e-4] * 3 + [1e-5] * 3]]
    tests = LoadTests(wrench, moved, theta=rng.normal(size=(9, 5)), force_point=[0, 0, -0.05])
    back = read_load_tests(load_tests_to_csv(tests, "two\nremarks", digits=9))
    np.testing.assert_allclose(back.theta, tests.theta, atol=1e-8)
    np.testing.assert_allclose(back.wrench, tests.wrench, atol=6e-4)
    np.testing.assert_allclose(back.displacement, tests.displacement, atol=1e-12)
    np.testing.assert_allclose(back.force_point, tests.force_point)
    assert "two\nremarks" in back.provenance.source


def table(text: str) -> tuple[list[str], list[list[str]]]:
    lines = [line.split(",") for line in text.splitlines() if not line.startswith("#")]
    return lines[0], lines[1:]


def test_a_template_has_a_column_for_each_joint_and_one_example_row() -> None:
    for n in (2, 5, 7):
        header, rows = table(load_test_template("joints", n))
        assert header[: n + 1] == [*(f"theta{i}_deg" for i in range(1, n + 1)), "Fx_N"]
        assert [len(row) for row in rows] == [len(header)]
        assert rows[0][:n] == ["0"] * n
    header, rows = table(load_test_template("compliances"))
    C = dict(zip(header, rows[0], strict=True))
    assert C["Cyz_um_N"] == C["Czy_um_N"] == "-1.0", "the example is symmetric, as a compliance is"


def test_each_quantity_is_written_in_its_unit_with_its_decimals() -> None:
    tests = LoadTests(
        wrench=[[1.23456, -0.0004, 250, 0.5, 0, 0]],
        displacement=[[1.23456789e-3, -1e-9, np.nan, 1e-3, 0, 0]],
        x_M=[[0.1, -1.3, 0.05, np.pi / 6, -np.pi / 4]],
        force_point=[[0, 0, -0.0503]],
        measuring_point=[[0, 0, 0]],
    )
    header, rows = table(load_tests_to_csv(tests))
    expected = {
        **{"X_mm": "100", "Y_mm": "-1300", "Z_mm": "50", "A_deg": "30", "B_deg": "-45"},
        **{"Fx_N": "1.235", "Fy_N": "0", "Fz_N": "250", "Mx_Nm": "0.5", "My_Nm": "0", "Mz_Nm": "0"},
        **{"dx_mm": "1.2346", "dy_mm": "0", "dz_mm": "", "rx_mrad": "1", "ry_mrad": "0", "rz_mrad": "0"},
        **{"FPx_mm": "0", "FPy_mm": "0", "FPz_mm": "-50.3"},
    }
    assert dict(zip(header, rows[0], strict=True)) == expected
    assert header == list(expected)
    header, rows = table(load_tests_to_csv(tests, digits=0))
    assert dict(zip(header, rows[0], strict=True))["dx_mm"] == "1"


def test_joint_angles_have_six_decimals() -> None:
    tests = LoadTests([[0, 0, 1.0, 0, 0, 0]], [[0, 0, 1e-3]], theta=[[1 / 3, -1 / 3]])
    header, rows = table(load_tests_to_csv(tests))
    assert (header[:2], rows[0][:2]) == (["theta1_deg", "theta2_deg"], ["19.098593", "-19.098593"])
    assert "Mx_Nm" not in header
    assert "rx_mrad" not in header


def test_a_measuring_sheet_leaves_the_readings_open_and_says_where_to_go() -> None:
    theta = np.random.default_rng(3).uniform(-0.5, 0.5, (3, 5))
    tests = simulated_tests(ROBOT, *three_directions(theta, 250.0), noise=4e-6)
    plan = next_best(ROBOT, tests, identify(ROBOT, tests), box_candidates(ROBOT, [-0.2, -1.4, -0.1], [0.2, -1.2, 0.1]))
    sheet = measuring_sheet(plan)
    header, rows = table(sheet)
    remarks = [line for line in sheet.splitlines() if line.startswith("# Test ")]
    assert len(rows) == len(remarks) == len(plan.x_M)
    for row in rows:
        cells = dict(zip(header, row, strict=True))
        assert [cells[f"d{axis}_mm"] for axis in "xyz"] == ["", "", ""]
        assert all(cells[name] for name in header if not name.startswith("d"))
    x, y, z, a, b = plan.x_M[0]
    said = remarks[0].replace("−", "-")
    assert said.startswith(f"# Test 1: X, Y, Z = {x * 1e3:.0f}, {y * 1e3:.0f}, {z * 1e3:.0f} mm; A, B = ")
    assert f"{np.rad2deg(a):.1f}, {np.rad2deg(b):.1f}°" in said


@pytest.mark.parametrize("width", [5, 6])
def test_world_poses_read_back_with_the_turn_about_the_tool_where_there_is_one(width):
    rng = np.random.default_rng(4)
    x_M = rng.uniform(-1, 1, (7, width))
    tests = LoadTests(rng.normal(size=(7, 6)) * 100, rng.normal(size=(7, 6)) * 1e-4, x_M=x_M)
    back = read_load_tests(load_tests_to_csv(tests, "a remark", digits=9))
    assert back.x_M.shape == (7, width)
    np.testing.assert_allclose(back.x_M, x_M, atol=1e-7)
