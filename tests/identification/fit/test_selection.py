"""Where links may bend, and which spring more is worth it: counted out."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.identification.fit.models import Model
from robomill.identification.fit.selection import Candidates, pays
from robomill.identification.fit.treatment import STANDARD

ROBOT = rm.load_robot("slavkovic_5r")


@pytest.mark.parametrize(
    ("after", "before", "worth"),
    [
        (0.94, 1.0, True),
        (0.96, 1.0, False),
        (1.1, 1.0, False),
        (1e-3, 1.0, True),
        (0.0, 1e-10, False),
        (0.0, 1e-8, True),
    ],
)
def test_a_spring_pays_where_it_saves_a_twentieth_of_what_is_no_rounding(after, before, worth):
    assert pays(after, before) == worth


@pytest.mark.parametrize(
    ("bend", "expected"),
    [
        (((), False), [((j,), False) for j in range(1, 6)] + [((j,), True) for j in range(1, 5)]),
        (((3,), False), [((1, 3), False), ((2, 3), False), ((3, 4), False), ((3, 5), False)]),
        (((3,), True), [((1, 3), True), ((2, 3), True), ((3, 4), True)]),
        (((1, 2, 3, 4), True), []),
    ],
)
def test_one_joint_more_bends_on_the_same_side_as_the_others_and_none_behind_the_last(bend, expected):
    tests = rm.LoadTests(np.ones((4, 3)), np.ones((4, 3)) * 1e-4, theta=np.zeros((4, 5)))
    candidates = Candidates(ROBOT, tests, Model("joints+bending"), STANDARD, np.arange(4))
    assert candidates._next(bend) == expected
