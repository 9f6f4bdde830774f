"""What is said of the lines of pull: of made ones, whose numbers are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.identification.pull.found_points import FoundPoint
from robomill.identification.pull.lines_of_pull import LinesOfPull
from robomill.identification.pull.pull_words import disagreement, pull_findings

ROBOT = rm.load_robot("slavkovic_5r")
TESTS = rm.LoadTests(np.ones((20, 3)), np.full((20, 3), 1e-4), theta=np.zeros((20, 5)))
MET = LinesOfPull(
    "met",
    np.arange(1, 21),
    np.array([[1.0, 2.0, 3.0]]),
    np.zeros(20, dtype=int),
    np.where(np.arange(20) == 3, 0.5, 1.2e-3),
    np.where(np.arange(20) == 3, 0.5, 52e-3),
)


def said(**fields):
    return {each.code: (each.message, each.count) for each in pull_findings(replace(MET, **fields), ROBOT, TESTS)}


def test_gaps_are_medians_and_the_load_point_is_told_where_it_is_held():
    assert "in one pulley with a gap of 52.0 mm (median); the tool stands too alike" in said()["pull-met"][0]
    two = said(pulley=np.zeros((2, 3)))["pull-met"]
    assert ("in 2 pulleys" in two[0], two[1]) == (True, 2)
    small = {"covariance": np.eye(3) * 1e-6, "dof": 30}
    right = said(shift=np.array([1e-4, 0.0, 0.0]), **small)["pull-met"][0]
    assert "with the stated load point: gap 52.0 mm (median)" in right
    wrong = said(shift=np.array([0.05, 0.0, 0.0]), **small)["pull-load-point"][0]
    assert "with it they pass one pulley by 1.2 mm (median), with the stated one by 52.0 mm" in wrong


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ((4,), "In row 4 the force"),
        (tuple(range(1, 9)), "In row 1, 2, 3, 4, 5, 6, 7, 8 the force"),
        (tuple(range(1, 10)), "In row 1, 2, 3, 4, 5, 6, 7, 8 and 1 more the force"),
        (tuple(range(1, 17)), "and 8 more the force"),
        (tuple(range(1, 18)), "In every row the force"),
    ],
)
def test_rows_that_push_are_listed_or_are_all(rows, words):
    """Of twenty: four fifths are not yet every one."""
    text, count = said(pushes=rows)["pull-sign"]
    assert words in text
    assert count == len(rows)


def test_rows_that_cannot_be_are_told_by_the_first():
    (_, found) = pull_findings(replace(MET, suspects=(7, 9)), ROBOT, TESTS)
    assert (found.code, found.line, found.count) == ("pull-suspect", 7, 2)
    assert found.message.startswith("Row 7, 9: the line of the force cannot be")


def point(shift, size, name="force"):
    return FoundPoint(name, np.array(shift), np.eye(3) * size**2, np.zeros(3), np.eye(4), 1000)


@pytest.mark.parametrize(("apart", "told"), [(4.6e-3, False), (4.9e-3, True)])
def test_points_disagree_beyond_both_their_intervals_in_99_of_100_fits(apart, told):
    """Standard errors of 0.8 and 1.12 mm make 1.38 mm together; 3.37 times that is the 99th of 100 in three dimensions
    (the root of chi-squared 11.34)."""
    lines, fit = point([0.0, 0.0, 0.0], 0.8e-3), point([0.0, apart, 0.0], 1.12e-3)
    found = disagreement(lines, (point([9.0, 0.0, 0.0], 1e-6, "gauge"), fit))
    assert [each.code for each in found] == ["points-disagree"] * told
    assert disagreement(None, (fit,)) == []
    unknown = replace(fit, shift=np.ones(3), covariance=np.full((3, 3), np.nan))
    assert disagreement(lines, (unknown,)) == []
