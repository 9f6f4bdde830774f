"""What nobody has said of a run, by which nothing is judged: numbers in another unit, as no arm has them."""

from __future__ import annotations

import pytest

import robomill as rm
from robomill.simulation.judging.premise import NONE, premise
from tests.simulation.judging.pushed_runs import SETUP

SLOW = SETUP.replace(step=10e-3)


@pytest.mark.parametrize(("times", "doubted"), [(1.0, False), (1e-5, True), (1e3, True)])
def test_joints_as_no_arm_has_them_are_asked_for_their_unit(times: float, doubted: bool) -> None:
    run = rm.simulate(SLOW.replace(robot=SLOW.robot.replace(C_theta=times * SLOW.robot.C_theta)))
    found = premise(run, True)
    if not doubted:
        assert found == NONE
        return
    assert found.words == "if its numbers are in their units"
    assert found.asked.startswith("The joints: ")
    assert found.asked.endswith("Not judged.")
    assert run.verdict.premise == found.words
    assert run.verdict.level == "unjudged"
