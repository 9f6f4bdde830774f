"""Rows that were written down wrong are named with what went wrong; readings of ``cables.py``, one row spoilt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.record import identification_report
from tests.identification.cables import Arm, Rig, as_csv, make

ARM, ROBOT = Arm.of("kuka_kr270"), rm.load_robot("kuka_kr270")
TIP = ARM.T_FT[:3, 3]
RIG = Rig(load_point=TIP, gauge_point=TIP, pulleys=((3.4, -2.2, 1.6), (-1.0, 3.0, 0.2), (2.0, 1.0, 4.0)))
MADE = make(ARM, RIG, 40, seed=4)


def spoilt(*slips):
    """The tests with (index, field, change) of some rows."""
    F, moved = MADE.F.copy(), MADE.moved.copy()
    for row, field, change in slips:
        values = {"F": F, "moved": moved}[field]
        values[row] = change(values[row])
    return rm.read_load_tests(as_csv(ARM, replace(MADE, F=F, moved=moved), TIP, TIP), ROBOT)


@pytest.mark.parametrize(
    ("field", "change", "kind", "says"),
    [
        ("moved", lambda d: -d, "sign", "the sign of the reading or the force is turned"),
        ("moved", lambda d: d * [1, -1, 1], "sign", "the sign of dy is turned"),
        ("F", lambda F: F * [1, 1, -1], "sign", "the sign of Fz is turned"),
        ("moved", lambda d: 1000 * d, "unit", "1000 times too large"),
        ("moved", lambda d: d / 25.4, "unit", "25.4 times too small (inches?)"),
        ("F", lambda F: F / 9.80665, "unit", "9.81 times too large (kilogram-force?)"),
        ("moved", lambda d: 10 * d, "unit", "10 times too large (a decimal point?)"),
        ("moved", lambda d: d[[1, 0, 2]], "swapped", "dx and dy are swapped"),
        ("F", lambda F: F[[0, 2, 1]], "swapped", "Fy and Fz are swapped"),
        ("moved", lambda d: MADE.moved[13], "neighbour", "the reading is that of row 15"),
    ],
)
def test_the_slip_is_named(field, change, kind, says):
    result = rm.identify(ROBOT, spoilt((12, field, change)))
    assert [o.row for o in result.outliers] == [14]  # line 1 is the header
    assert result.outliers[0].slips[0].kind == kind
    said = next(f for f in result.findings if f.code == "outliers")
    assert "row 14" in said.message
    assert says in said.message
    assert identification_report(result)["outlier_slips"][0]["slips"][0]["kind"] == kind


@pytest.mark.parametrize("k", [0, 11, 38])
def test_forces_of_two_rows_that_changed_places_are_named(k):
    """In the middle of the file, at its head and at its end."""
    result = rm.identify(ROBOT, spoilt((k, "F", lambda F: MADE.F[k + 1]), (k + 1, "F", lambda F: MADE.F[k])))
    found = {o.row: [slip.says for slip in o.slips] for o in result.outliers}
    assert found == {
        k + 2: [f"the force of row {k + 3} belongs here"],
        k + 3: [f"the force of row {k + 2} belongs here"],
    }


def test_what_no_slip_explains_is_said_without_one():
    result = rm.identify(ROBOT, spoilt((12, "moved", lambda d: d + np.array([3e-4, -2e-4, 1e-4]))))
    assert result.outliers[0].slips == ()
    assert "row 14 (" in next(f.message for f in result.findings if f.code == "outliers")


def test_good_rows_are_not_named():
    assert "outliers" not in [f.code for f in rm.identify(ROBOT, spoilt()).findings]


@pytest.mark.parametrize("seed", range(4))
def test_gross_rows_do_not_spoil_the_error_on_poses_left_out(seed):
    """A reading a thousand times too small has a component that fits by chance; its share of nothing was counted."""
    rows = np.random.default_rng(seed).choice(40, 4, replace=False)
    factors = (1000.0, 0.001, 9.81, 1 / 25.4)
    bad = spoilt(*((row, "moved", lambda d, f=f: d * f) for row, f in zip(rows, factors, strict=True)))
    robust = rm.identify(ROBOT, bad, robust=True)
    clean = rm.identify(ROBOT, spoilt().without((rows + 2).tolist()))
    assert robust.cv_relative_error == pytest.approx(clean.cv_relative_error, rel=0.2)


def test_readings_that_are_all_needed_give_no_robot_its_compliances():
    few = rm.read_load_tests("nine_points")
    robot = rm.load_robot("slavkovic_5r")
    few = few.select(np.flatnonzero(few.pose_index() < 2)[[0, 4]])
    moved = few.displacement.copy()
    moved[1, 2] = np.nan
    result = rm.identify(robot, replace(few, displacement=moved))
    assert result.dof == 0
    assert np.isinf(result.stderr).all()
    with pytest.raises(LoadTestError, match="nothing is left to say how sure"):
        result.applied_to(robot)
