"""Load tests given as a DataFrame say what their file says; what is wrong in one is named by its row and column."""

from __future__ import annotations

import dataclasses
import io

import numpy as np
import pandas as pd
import pytest

import robomill as rm
from robomill.identification.fit.treatment import Choices, Treatment
from robomill.io.samples import samples_dir

LOAD_TESTS = samples_dir() / "load_tests"


@pytest.fixture(scope="module")
def robot():
    return rm.load_robot("slavkovic_5r")


def table(name: str) -> pd.DataFrame:
    """A sample as pandas reads it."""
    return pd.read_csv(LOAD_TESTS / name, comment="#")


@pytest.mark.parametrize("name", ["nine_points.csv", "one_joint_at_a_time.csv", "nine_points_compliances.csv"])
def test_a_dataframe_says_what_its_file_says(robot, name):
    read = rm.identify(robot, rm.read_load_tests(LOAD_TESTS / name, robot))
    for given in (table(name), LOAD_TESTS / name, table(name).convert_dtypes(), table(name).astype(object)):
        found = rm.identify(robot, given)
        np.testing.assert_array_equal(found.C_theta, read.C_theta)
        np.testing.assert_array_equal(found.ci95, read.ci95)


def test_the_springs_are_found_that_made_the_readings(robot):
    """Displacements by J C J^T F (eqs. 13 to 16) of known compliances, written as a table of millimetres."""
    rng = np.random.default_rng(3)
    theta = rng.uniform(-0.5, 0.5, (12, 5))
    F = rng.normal(0.0, 200.0, (12, 3))
    truth = np.array([3.0, 2.0, 4.0, 9.0, 30.0]) * 1e-7
    J_v = rm.geometric_jacobian(robot, theta)[:, :3]
    delta = np.einsum("mij,j,mkj,mk->mi", J_v, truth, J_v, F)
    frame = pd.DataFrame(np.degrees(theta), columns=[f"theta{j}_deg" for j in range(1, 6)])
    frame[["Fx_kN", "Fy_kN", "Fz_kN"]] = F / 1e3
    frame[["dx_um", "dy_um", "dz_um"]] = delta * 1e6
    np.testing.assert_allclose(rm.identify(robot, frame).C_theta, truth, rtol=1e-9)


@pytest.mark.parametrize("name", ["nine_points.csv", "one_joint_at_a_time.csv", "cable_six_axis.csv", "grid_45x6.csv"])
def test_tests_go_to_a_dataframe_and_back(robot, name):
    arm = rm.load_robot("kuka_kr270") if "six" in name else robot
    tests = rm.read_load_tests(LOAD_TESTS / name, arm)
    again = rm.read_load_tests(tests.to_dataframe(), arm)
    assert again.row.tolist() == tests.row.tolist()
    assert again.provenance.kind == tests.provenance.kind
    for key in ("wrench", "displacement", "theta", "torque", "angle", "force_point", "noise"):
        if hasattr(tests, key):
            np.testing.assert_allclose(getattr(again, key), getattr(tests, key), rtol=1e-12, atol=1e-15)


def test_a_spread_that_is_stated_for_some_tests_comes_back(robot):
    tests = rm.read_load_tests(LOAD_TESTS / "nine_points.csv", robot)
    noise = np.where(np.arange(len(tests)) % 2, 5e-6, np.nan)
    stated = type(tests)(tests.wrench, tests.displacement, theta=tests.theta, noise=noise)
    np.testing.assert_allclose(rm.read_load_tests(stated.to_dataframe(), robot).noise, noise)


def with_cell(column: str, value: object, index: list[int] | None = None) -> pd.DataFrame:
    frame = table("nine_points.csv").astype(object)
    frame.iloc[3, frame.columns.get_loc(column)] = value
    return frame if index is None else frame.set_axis(index[: len(frame)])


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (np.nan, "the cell is empty, expected a number"),
        (None, "the cell is empty, expected a number"),
        ("0,3", "found '0,3', expected a number"),
        ("broken", "found 'broken', expected a number"),
        (np.inf, "found 'inf', expected a finite number"),
        (True, "found 'True', expected a number"),
    ],
)
def test_a_bad_cell_is_named_by_row_and_column(robot, value, said):
    with pytest.raises(rm.RobomillError, match=r"^Row 3, column dz_mm: ") as refused:
        rm.identify(robot, with_cell("dz_mm", value))
    assert said in str(refused.value)
    assert refused.value.where == "row 3, column dz_mm"


def test_rows_are_called_as_the_index_calls_them(robot):
    with pytest.raises(rm.RobomillError, match=r"^Row 103, column Fx_N: "):
        rm.identify(robot, with_cell("Fx_N", "x", list(range(100, 200))))
    named = table("nine_points.csv").set_axis([f"pose {k}" for k in range(len(table("nine_points.csv")))])
    assert rm.read_load_tests(named, robot).row[:2].tolist() == [0, 1]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda f: f.rename(columns={"dz_mm": "dz"}), "Columns, column 'dz': the unit is missing; write one of dz_mm"),
        (lambda f: f.rename(columns={"Fx_N": "Fx_lb"}), "unit 'lb' is not known; write one of Fx_N, Fx_kN"),
        (lambda f: f.drop(columns="dz_mm"), "column dz_mm is missing beside dx_mm"),
        (lambda f: f.assign(dz_um=f["dz_mm"]), "dz_mm and dz_um are the same quantity twice; keep one"),
        (lambda f: f.iloc[:0], "found no row in the DataFrame"),
        (lambda f: f.set_axis(range(f.shape[1]), axis=1), "expected a header that names columns and units"),
        (lambda f: f[[]], "Columns: found none; expected columns such as theta1_deg"),
    ],
)
def test_a_bad_header_is_named(robot, change, said):
    with pytest.raises(rm.RobomillError) as refused:
        rm.identify(robot, change(table("nine_points.csv")))
    assert said in str(refused.value)


def test_what_a_file_declares_in_remarks_a_dataframe_declares_in_attrs(robot):
    text = (LOAD_TESTS / "cable_six_axis.csv").read_text()
    arm, frame = rm.load_robot("kuka_kr270"), pd.read_csv(io.StringIO(text), comment="#")
    with pytest.raises(rm.RobomillError, match=r"set attrs\['(angles|frame)'\] = '\w+' of the DataFrame"):
        rm.read_load_tests(frame, arm)
    for line in text.splitlines():
        key, _, value = line.removeprefix("# ").partition(": ")
        if line.startswith("#") and key in ("frame", "angles", "provenance"):
            frame.attrs[key] = value
    np.testing.assert_array_equal(rm.read_load_tests(frame, arm).theta, rm.read_load_tests(text, arm).theta)


@pytest.mark.parametrize(
    ("choice", "said"),
    [
        ({"bending": 2}, "bending: found 2, expected joint numbers"),
        ({"bending": [2.5]}, "bending: found [2.5], expected joint numbers"),
        ({"bending": "2,3"}, "bending: found '2,3', expected joint numbers"),
        ({"exclude": 3}, "exclude: found 3, expected numbers of rows"),
        ({"robust": "yes"}, "robust: found 'yes', expected True or False"),
        ({"robst": True}, "did you mean robust?"),
    ],
)
def test_a_choice_of_another_kind_is_refused(robot, choice, said):
    with pytest.raises(rm.RobomillError) as refused:
        rm.identify(robot, "nine_points", **choice)
    assert said in str(refused.value)


def test_every_choice_is_told_in_the_help_and_to_type_checkers():
    told = {line.split(" : ")[0].strip() for line in (rm.identify.__doc__ or "").splitlines() if " : " in line}
    fields = {each.name for each in dataclasses.fields(Treatment)}
    assert fields <= told
    assert fields == set(Choices.__annotations__)
