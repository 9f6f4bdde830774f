"""A force stated along the path: what it says of a plunge, and what it does not."""

import numpy as np

from robomill.cutting.conditions import STRAIGHT, CutConditions
from robomill.cutting.forces.along_path import PathForce
from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling

FORCE = PathForce(feed=-1.0, feed_normal=100.0, axial=-20.0)


def test_a_plunge_has_only_the_axial_part_and_is_not_judged():
    across = np.array([0.0, STRAIGHT, 1.5 * STRAIGHT, 1.0])
    conditions = CutConditions.steady(0.03, 200.0, 2e-3, across=across, along=-1.0)
    np.testing.assert_array_equal(
        FORCE.components(conditions), [[0, 0, -20], [0, 0, -20], [-1, 100, -20], [-1, 100, -20]]
    )
    (found,) = FORCE.unjudged(conditions)
    assert found.code == "plunge_stated"
    np.testing.assert_array_equal(found.where, [True, True, False, False])


def test_a_plunge_in_air_is_nothing_to_judge():
    assert FORCE.unjudged(CutConditions.steady(0.03, 200.0, 0.0, across=0.0, along=-1.0)) == ()


def test_a_spindle_against_the_hand_is_not_judged_beside_it():
    mill = Cutter("flat", 8e-3, hand="left")
    conditions = CutConditions.steady(
        0.03, [200.0, 200.0, 0.0, 200.0], 2e-3, across=[1.0, 0.0, 1.0, 1.0], along=-1.0, ccw=[True, False, False, False]
    )
    conditions = CutConditions(**{**vars(conditions), "tooling": Tooling.single(mill, 4)})
    found = {each.code: each.where.tolist() for each in FORCE.unjudged(conditions)}
    assert found == {"spindle_sense": [False, True, False, True], "plunge_stated": [False, True, False, False]}
