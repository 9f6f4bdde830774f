"""Joint angles written in the other sense are suspected by name, and nothing else is offered for them.

The readings are those of ``cables.py``: springs turned one by one by rotation matrices, nothing of the product.
"""

from __future__ import annotations

from dataclasses import replace
from math import comb

import numpy as np
import pytest
from scipy.optimize import nnls

import robomill as rm
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import build_system
from robomill.identification.other_senses import EVERY, _left_over, _turned, sense_suspicions
from tests.identification.cables import Arm, Rig, make

ARM = Arm.of("kuka_kr270")
ROBOT = rm.load_robot("kuka_kr270")
WIDE = ROBOT.replace(limits=np.tile([-7.0, 7.0], (6, 1)))  # else a turned angle beyond a limit is refused by its row
TIP = ARM.T_FT[:3, 3]
RIG = Rig(load_point=TIP, gauge_point=TIP, pulleys=((3.4, -2.2, 1.6), (-1.0, 3.0, 0.2), (2.0, 1.0, 4.0)))


def found(which, rig=RIG, count=30, noise=5e-6, seed=2):
    """The identification with the angles of joints ``which`` (from 0) written with the opposite sign."""
    made = make(ARM, replace(rig, noise=noise), count, seed)
    sign = np.ones(6)
    sign[list(which)] = -1.0
    return rm.identify(WIDE, rm.LoadTests(made.F, made.moved, theta=made.q * sign))


def said(result):
    return {finding.code: finding.message for finding in result.findings}


@pytest.mark.parametrize("which", [(0,), (1,), (3,), (3, 4), (2, 3, 4)])
def test_joints_that_count_the_other_way_are_named(which):
    """It was said that a link bends, that the tool gives, or that x and z are turned."""
    result = found(which)
    text = said(result)["sense"]
    names = [f"theta{i + 1}" for i in range(6) if f"theta{i + 1}" in text]
    assert names == [f"theta{i + 1}" for i in which]
    assert not {"model-misses", "fit-force", "fit-gauge", "fit-both", "bending-pays"} & set(said(result))
    assert result.offer is None
    assert result.bends is None


@pytest.mark.parametrize("off", [np.zeros(3), np.array([0.09, -0.09, 0.08])])
def test_right_angles_are_not_suspected_whatever_else_is_wrong(off):
    for seed in range(4):
        assert "sense" not in said(found((), replace(RIG, load_point=TIP + off), seed=seed))
        assert "sense" not in said(found((), noise=3e-4, seed=seed))


def test_a_load_point_that_is_off_besides_hides_no_joint():
    text = said(found((3,), replace(RIG, load_point=TIP + np.array([0.09, -0.09, 0.08]))))["sense"]
    assert "theta4" in text
    assert not any(f"theta{i}" in text for i in (1, 2, 3, 5, 6))


BENT = replace(RIG, bending={2: (2e-6, 1e-6), 3: (1e-6, 2e-6)})  # as soft as the wrist


@pytest.mark.parametrize("which", [(0,), (1,), (4,), (1, 2), (0, 3)])
def test_strong_bending_hides_no_joint_that_counts_the_other_way(which):
    """The joints' springs alone left half of the displacements over at right angles, too, and nothing was said."""
    text = said(found(which, BENT, noise=20e-6))["sense"]
    assert [i for i in range(6) if f"theta{i + 1}" in text] == list(which)


@pytest.mark.parametrize("count", [8, 13, 30])
@pytest.mark.parametrize("off", [np.zeros(3), np.array([0.09, -0.09, 0.08])])
def test_right_angles_are_not_suspected_beside_strong_bending(count, off):
    for seed in range(3):
        made = make(ARM, replace(BENT, load_point=TIP + off, noise=1e-4), count, seed)
        assert sense_suspicions(WIDE, rm.LoadTests(made.F, made.moved, theta=made.q)) == ()


def test_joints_that_were_solved_from_poses_are_not_asked():
    made = make(ARM, RIG, 30, 2)
    tests = rm.LoadTests(made.F, made.moved, theta=made.q * [1, 1, 1, -1, 1, 1])
    assert sense_suspicions(WIDE, tests)
    solved = rm.LoadTests(made.F, made.moved, x_M=rm.world_from_pose(rm.tool_pose(ROBOT, made.q)))
    assert sense_suspicions(ROBOT, solved.with_joints(ROBOT)) == ()


@pytest.mark.parametrize(("count", "suspected"), [(3, False), (4, True), (70, True)])
def test_so_few_tests_say_nothing_of_senses(count, suspected):
    """As with other axes: six compliances take up most of what three tests read."""
    made = make(ARM, RIG, count, 2)
    tests = rm.LoadTests(made.F, made.moved, theta=made.q * [1, -1, 1, 1, 1, 1])
    assert ["theta2" in each.message for each in sense_suspicions(WIDE, tests)] == [True] * suspected


def test_every_set_of_joints_is_asked_or_every_pair_where_they_are_many():
    for n, sizes in ((3, (1, 2, 3)), (EVERY, range(1, EVERY + 1)), (EVERY + 1, (1, 2))):
        asked = list(_turned(n))
        assert [len(each) for each in asked] == sorted(len(each) for each in asked), "the fewest first"
        assert len(set(asked)) == len(asked) == sum(comb(n, size) for size in sizes)
        assert {j for each in asked for j in each} == set(range(n))


def test_what_the_joints_do_not_explain_is_a_share_of_the_displacements_alone():
    """By scipy's fit above zero; rotations that are read too are not asked."""
    made = make(ARM, replace(RIG, noise=3e-4), 8, 2)
    tests = rm.LoadTests(made.F, np.hstack([made.moved, np.ones((8, 3))]), theta=made.q)
    A = build_system(ROBOT, rm.LoadTests(made.F, made.moved, theta=made.q), Model("joints")).A[:, :5]
    b, size = made.moved.ravel(), np.linalg.norm(A, axis=0)  # joint 6 turns the tip about itself
    assert _left_over(ROBOT, tests, Model()) == pytest.approx(nnls(A / size, b)[1] / np.linalg.norm(b), rel=1e-6)
    still = rm.LoadTests(made.F, np.hstack([np.zeros((8, 3)), np.ones((8, 3))]), theta=made.q)
    assert _left_over(ROBOT, still, Model()) == 0.0
