"""Points that stand under another unit than they were meant in: told by what the right one would explain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import build_system
from robomill.identification.length_units import BETTER, WELL, _left_over, _lengths_of, length_suspicions
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


def test_lengths_that_a_robot_does_not_have_are_not_asked():
    """An arm in the plane without a tool has its lengths a alone; each is scaled by itself."""
    n = np.zeros(3)
    flat = rm.Robot.from_dh(alpha=n, a=np.array([0.6, 0.5, 0.3]), d=n, C_theta=np.full(3, 1e-6))
    assert list(_lengths_of(flat)) == ["the robot's lengths a"]
    whole = _lengths_of(ROBOT)
    assert list(whole) == ["the robot's lengths a", "the robot's lengths d", "the tool's place on the flange"]
    for scale, (a, d, tool) in zip(whole.values(), np.eye(3) + 1.0, strict=True):
        scaled = scale(2.0)
        np.testing.assert_allclose(scaled.a, a * ROBOT.a)
        np.testing.assert_allclose(scaled.d, d * ROBOT.d)
        np.testing.assert_allclose(scaled.T_tool[:3, 3], tool * ROBOT.T_tool[:3, 3])
        np.testing.assert_allclose(scaled.T_tool[:3, :3], ROBOT.T_tool[:3, :3])


def test_nothing_is_left_over_where_nothing_moved_and_everything_where_nothing_can_be_fitted():
    tests = read().with_joints(ROBOT)
    assert _left_over(ROBOT, replace(tests, displacement=np.zeros((30, 3)))) == 0.0
    assert _left_over(ROBOT, tests.select([0])) == np.inf
    aside = replace(tests, displacement=tests.displacement[:, :3] + [1e-3, 0.0, 0.0])
    assert _left_over(ROBOT, aside) == pytest.approx(left_over(aside), rel=0.02)
