"""Equations with numbers in them: what is printed adds up."""

from __future__ import annotations

import re

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.at_pose import PoseReport
from robomill.learn.equations import component, product, settled
from robomill.learn.lessons import lesson
from robomill.learn.push import AsidePush


@pytest.fixture(scope="module")
def found() -> PoseReport:
    """The paper's arm at a point of its box."""
    robot = rm.load_robot("slavkovic_5r")
    return rm.at_pose(robot, rm.inverse_kinematics(robot, rm.pose_from_world([0.2, -1.2, -0.1, 0.0, 0.0])).theta)


def test_the_equation_s_terms_add_up(found: PoseReport) -> None:
    """The numbers printed a joint a line, multiplied and added, are the number after the last equals sign."""
    tex = component(found, 1, 1)
    terms = re.findall(r"(-?[\d.]+)\\cdot \((-?[\d.]+)\)\^2 &&", tex)
    total = float(re.findall(r"= \{\} & (-?[\d.]+) \\end", tex)[-1])
    assert len(terms) == tex.count("joint")
    assert sum(float(c) * float(j) ** 2 for c, j in terms) == pytest.approx(total, abs=0.01)
    assert total == pytest.approx(found.C[1, 1] * 1e6, abs=1e-3)


def test_the_product_is_c_times_f(found: PoseReport) -> None:
    moved = re.findall(
        r"bmatrix\} (-?[\d.]+) \\\\ (-?[\d.]+) \\\\ (-?[\d.]+) \\end", product(found.C, AsidePush.of(found.C).force)
    )[-1]
    np.testing.assert_allclose([float(v) for v in moved], found.C[:, AsidePush.of(found.C).along] * 100e6, atol=0.06)


def test_the_product_is_for_the_push_of_the_question() -> None:
    """A matrix whose largest cross term is between X and Z, pushed along X."""
    C = 1e-6 * np.array([[1.0, 0.0, 0.9], [0.0, 2.0, 0.1], [0.9, 0.1, 4.0]])
    push = AsidePush.of(C)
    assert (push.name, push.aside) == ("X", 2)
    force, moved = re.findall(r"bmatrix\} (-?[\d.]+) \\\\ (-?[\d.]+) \\\\ (-?[\d.]+) \\end", product(C, push.force))[
        -2:
    ]
    assert force == ("100", "0", "0")
    np.testing.assert_allclose([float(v) for v in moved], [100.0, 0.0, 90.0], atol=0.06)


@pytest.mark.parametrize("seed", range(3))
def test_the_numbers_of_a_lesson_give_its_result(seed: int) -> None:
    """Lessons 3 and 7, read as a reader would: the printed numbers, put into the printed law, round to the result."""
    robot = rm.load_robot("slavkovic_5r")
    x, y = np.random.default_rng(seed).uniform([-0.4, -1.5], [0.4, -1.1])
    pose = rm.at_pose(robot, rm.inverse_kinematics(robot, rm.pose_from_world([x, y, 0.0, 0.0, 0.0])).theta)
    far, near, times = re.findall(r"\\frac\{([\d.]+)\}\{([\d.]+)\} = ([\d.]+)$", lesson(3, pose).equation)[0]
    assert f"{float(far) / float(near):.2f}" == times
    real, own, force, left = re.findall(r"\(([\d.]+) - ([\d.]+)\)\\cdot (\d+) = ([\d.]+)", lesson(7, pose).equation)[0]
    assert f"{(float(real) - float(own)) * float(force):.1f}" == left


def test_as_many_decimals_are_printed_as_the_result_needs() -> None:
    """1.0004 x 1000 is 1000.4: with three decimals it would read 1000.0."""
    assert settled(np.multiply, 1, (1.0004, 3), (1000.0, 0)) == (["1.0004"], ["1000.0"], ["1000.4"])
    assert settled(np.multiply, 1, (1.25, 2), (4.0, 0)) == (["1.25"], ["4"], ["5.0"])
