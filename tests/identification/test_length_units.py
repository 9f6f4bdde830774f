"""Points that stand under another unit than they were meant in: told by what the right one would explain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import build_system
from robomill.identification.length_units import BETTER, WELL, length_suspicions
from tests.identification.cables import Arm, Rig, as_csv, make

ARM, ROBOT = Arm.of("kuka_kr500"), rm.load_robot("kuka_kr500")
FAR = Rig(load_point=np.array([0.35, 0.4, 0.9]), gauge_point=np.array([-0.3, 0.5, 0.8]))
FLANGE = -ROBOT.T_tool[:3, :3].T @ ROBOT.T_tool[:3, 3]


def read():
    return rm.read_load_tests(as_csv(ARM, make(ARM, FAR, 30, seed=4), FAR.load_point, FAR.gauge_point), ROBOT)


def left_over(tests):
    """The share that no compliances of the joints explain, by NumPy's least squares."""
    system = build_system(ROBOT, tests.with_joints(ROBOT), Model("joints"))
    x = np.linalg.lstsq(system.A, system.b, rcond=None)[0]
    return np.linalg.norm(system.A @ x - system.b) / np.linalg.norm(system.b)


def test_points_in_their_own_unit_leave_nothing_to_explain():
    tests = read()
    assert left_over(tests) < WELL
    assert length_suspicions(ROBOT, tests.with_joints(ROBOT)) == ()


@pytest.mark.parametrize("origin", [np.zeros(3), FLANGE], ids=["from the tip", "from the flange"])
@pytest.mark.parametrize(("times", "slip"), [(25.4, "in under a header in mm"), (1e3, "m under a header in mm")])
@pytest.mark.parametrize(
    ("fields", "what"),
    [
        (("force_point",), "the load point would"),
        (("measuring_point",), "the gauge point would"),
        (("force_point", "measuring_point"), "the load point and the gauge point would"),
    ],
)
def test_points_meant_in_another_unit_are_named_with_it(origin, times, slip, fields, what):
    tests = read().with_joints(ROBOT)
    wrong = replace(tests, **{key: origin + (getattr(tests, key) - origin) / times for key in fields})
    assert left_over(wrong) > max(WELL, BETTER * left_over(tests))
    (found,) = length_suspicions(ROBOT, wrong)
    assert found.code == "length-unit"
    assert slip in found.message
    assert what in found.message
