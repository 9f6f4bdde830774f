"""What looks wrong before anything is fitted: data spoilt in a known way are told, sound data are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.suspicion import FACTOR, _off, suspicions
from robomill.identification.synthesis import three_directions
from tests.identification.synthetic import simulated_tests

ROBOT = rm.load_robot("slavkovic_5r").with_compliance_set("table_3")
PLAUSIBLE = (5e-8, 1e-4)  # m/N
PLAUSIBLE_JOINT = (1e-8, 1e-3)  # rad/(N m)
THETA = np.random.default_rng(0).uniform(ROBOT.limits[:, 0], ROBOT.limits[:, 1], (8, 5))
SOUND = simulated_tests(ROBOT, *three_directions(THETA, 250.0), noise=4e-6)


def codes(tests, robot=ROBOT):
    return [finding.code for finding in suspicions(tests, robot)]


def moved(tests, displacement):
    return replace(tests, displacement=displacement)


def test_pure_moments_say_nothing_of_sizes_and_world_poses_nothing_of_the_robot():
    wrench = SOUND.wrench.copy()
    wrench[:20] = [0, 0, 0, 5.0, 0, 0]
    assert codes(replace(SOUND, wrench=wrench)) == []
    wrench[:] = [0, 0, 0, 5.0, 0, 0]
    assert codes(replace(SOUND, wrench=wrench).select([0])) == []
    x_M = np.tile([0, -1.3, 0, 0, 0], (24, 1)) + np.arange(24)[:, None] * 1e-3
    world = replace(SOUND, theta=None, x_M=x_M, displacement=SOUND.displacement)
    assert codes(world, ROBOT.replace(C_theta=ROBOT.C_theta * 1e-3)) == []


def test_sound_data_rouse_no_suspicion():
    assert codes(SOUND) == []
    assert codes(SOUND, None) == []


@pytest.mark.parametrize("axis", range(3))
def test_one_flipped_axis_is_named_with_its_count(axis):
    sign = np.ones(6)
    sign[axis] = -1
    (finding,) = suspicions(moved(SOUND, SOUND.displacement * sign), ROBOT)
    assert (finding.code, finding.line, finding.level) == ("sign", 0, "suspicious")
    name = "xyz"[axis]
    assert f"d{name} runs against F{name} in 8 of the 8 tests" in finding.message
    assert f"sign of d{name}" in finding.message


def test_all_flipped_is_the_sign_of_the_displacements():
    (finding,) = suspicions(moved(SOUND, -SOUND.displacement), ROBOT)
    assert "the sign of the displacements" in finding.message


MOSTLY = [(1, 1, False), (1, 2, False), (2, 2, True), (2, 3, True), (2, 4, False), (3, 5, True)]


@pytest.mark.parametrize(("against", "loaded", "told"), MOSTLY)
def test_most_of_at_least_two_tests_along_an_axis_must_run_against(against, loaded, told):
    F = np.zeros((loaded, 3))
    F[:, 0] = 100.0
    F[:, 1] = np.arange(loaded)
    d = np.column_stack([np.full(loaded, 1e-4), np.zeros(loaded), np.zeros(loaded)])
    d[:against, 0] *= -1
    tests = LoadTests(F, d, theta=THETA[:loaded])
    said = codes(tests, None)
    assert ("sign" in said) == (told or against > loaded / 2)
    message = " ".join(finding.message for finding in suspicions(tests))
    assert ("tests loaded along x" in message) == told


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(("against", "told"), [(1, False), (3, True)])
def test_what_did_not_move_does_not_run_against(against, told, way):
    F = way * np.column_stack([[100.0, 110, 120, 130, 140], np.zeros(5), np.zeros(5)])
    d = np.tile([0.0, 1e-4, 1e-5], (5, 1))  # most gauges along x read nothing
    d[:against, 0] = -1e-4 * way
    assert codes(LoadTests(F, d, theta=THETA[:5]), None) == (["sign"] if told else [])


@pytest.mark.parametrize(("share", "along"), [(0.88, False), (0.92, True)])
def test_loaded_along_an_axis_is_nine_tenths_of_the_force(share, along):
    F = np.tile([share, np.sqrt(1 - share**2), 0.0], (4, 1)) * 100
    d = np.tile([-1e-4, 1e-3, 0.0], (4, 1))
    said = codes(LoadTests(F, d, theta=THETA[:4]), None)
    assert (said == ["sign"]) == along


@pytest.mark.parametrize(("against", "told"), [(2, False), (3, True)])
def test_oblique_forces_are_judged_by_their_work(against, told):
    F = np.tile([100.0, 100.0, 0.0], (4, 1)) + np.arange(4)[:, None]
    d = np.tile([1e-4, 1e-4, 0.0], (4, 1))
    d[:against] *= -1
    found = suspicions(LoadTests(F, d, theta=THETA[:4]))
    assert [f.code for f in found] == (["sign"] if told else [])
    if told:
        assert "in 3 of 4 tests" in found[0].message
    d[:, 2] = np.nan
    assert suspicions(LoadTests(F, d, theta=THETA[:4])) == ()  # work of half a displacement says nothing


@pytest.mark.parametrize(("size", "slip"), [(0.0254, "inches"), (9.80665e-3, "kilogram"), (4.44822e-3, "pound")])
def test_a_slip_of_the_unit_is_told_by_its_size(size, slip):
    """An inch in mm, a kilogram-force and a pound-force in N, each in thousandths: no other slip is as large."""
    (finding,) = suspicions(moved(SOUND, 1e3 * size * SOUND.displacement), ROBOT)
    assert (finding.code, slip in finding.message) == ("unit", True)


@pytest.mark.parametrize("factor", [1 / 1000, 1 / 25.4, 1 / 9, 1 / 7, 7, 9, 25.4, 1000])
def test_a_wrong_unit_is_a_factor_against_the_robots_own(factor):
    told = not 1 / 8 < factor < 8
    stiff = ROBOT.replace(C_theta=0.1 * ROBOT.C_theta)
    found = suspicions(moved(SOUND, 0.1 * factor * SOUND.displacement), stiff)
    assert [f.code for f in found] == (["unit"] if told else [])
    if told:
        assert found[0].line == 0
        times = max(factor, 1 / factor)
        said = float(found[0].message.split("about ")[1].split(" ")[0])
        assert said == pytest.approx(times, rel=0.15)
        assert ("larger" in found[0].message) == (factor > 1)
        assert "this robot's own" in found[0].message


@pytest.mark.parametrize("edge", PLAUSIBLE)
def test_without_compliances_it_is_a_factor_against_what_any_robot_has(edge):
    stiff = ROBOT.replace(C_theta=np.zeros(5))
    F = np.eye(3) * 200.0
    for factor, told in ((0.9, edge == PLAUSIBLE[0]), (1.1, edge == PLAUSIBLE[1])):
        tests = LoadTests(F, np.eye(3) * 200.0 * edge * factor, theta=THETA[:3])
        for robot in (stiff, None):
            found = suspicions(tests, robot)
            assert [f.code for f in found] == (["unit"] if told else [])
            if told:
                assert ("larger" in found[0].message) == (edge > 1e-6)


def test_zeros_are_a_gauge_that_was_not_read():
    tests = LoadTests(np.eye(3) * 100, np.zeros((3, 3)), theta=THETA[:3])
    assert codes(tests) == ["no-displacement"]
    assert suspicions(tests)[0].line == 0


def test_repeats_are_named_with_their_rows():
    row = np.arange(len(SOUND)) + 5
    tests = replace(SOUND, row=row)
    again = tests.select([0, 1, 2, 3, 1, 5, 1, 0])
    (finding,) = suspicions(again, ROBOT)
    assert finding.code == "repeat"
    assert (finding.line, finding.count) == (6, 3)
    assert "Row 6 repeats row 6" in finding.message
    assert "(and 2 more)" in finding.message
    one = replace(tests.select([0, 1, 2, 1]), row=np.array([2, 3, 4, 9]))
    (finding,) = suspicions(one, ROBOT)
    assert "Row 9 repeats row 3 to the last digit;" in finding.message
    nearly = SOUND.displacement.copy()
    nearly[1] = nearly[0]
    assert codes(moved(SOUND, nearly)) == [], "another force"


@pytest.mark.parametrize(("against", "told"), [(2, False), (3, True)])
def test_angles_against_their_torque(against, told):
    torque = np.array([100.0, -100, 100, -100])
    angle = 1e-6 * torque
    angle[:against] *= -1
    found = suspicions(JointTests(np.array([1, 2, 3, 4]), torque, angle))
    assert [(f.code, f.line) for f in found] == ([("sign", 0)] if told else [])


@pytest.mark.parametrize("edge", PLAUSIBLE_JOINT)
def test_a_joint_beyond_all_robots(edge):
    for factor, told in ((0.9, edge == PLAUSIBLE_JOINT[0]), (1.1, edge == PLAUSIBLE_JOINT[1])):
        tests = JointTests(np.array([1, 2, 3]), np.array([100.0, -50, 20]), np.array([100.0, -50, 20]) * edge * factor)
        assert [(f.code, f.line) for f in suspicions(tests)] == ([("unit", 0)] if told else [])


@pytest.mark.parametrize(("factor", "told"), [(0.001, True), (0.2, False), (5.0, False), (1000.0, True)])
def test_a_joint_against_the_robots_own(factor, told):
    joint, torque = np.array([1, 2, 3]), np.array([100.0, -50, 20])
    tests = JointTests(joint, torque, factor * ROBOT.C_theta[:3] * torque)
    assert codes(tests) == (["unit"] if told else [])


@pytest.mark.parametrize("times", [4.4482, 1 / 4.4482, 9.80665])
@pytest.mark.parametrize(("off", "told"), [(0.91, True), (1.09, True), (0.88, False), (1.12, False)])
def test_a_slip_below_the_factor_is_told_within_a_tenth_where_one_number_explains_all(times, off, told):
    """A pound-force is no factor of eight; ten kilograms of it are, and a tenth more is another arm."""
    odd = moved(SOUND, times * off * SOUND.displacement)
    found = [each.message for each in suspicions(odd, ROBOT)]
    if times > 8.0:
        assert len(found) == (times * off > 8.0)
        return
    assert len(found) == told
    assert all(("larger" if times > 1 else "smaller") in each and "pound-force as N?" in each for each in found)


@pytest.mark.parametrize("noise", [0.15, 0.25])
def test_one_number_explains_all_where_a_fifth_is_left_over(noise):
    """A component across the readings themselves, so that their own size stays: what is left over is its share."""
    read = SOUND.displacement[:, :3] * 4.4482
    across = np.random.default_rng(3).normal(size=read.shape)
    clean = simulated_tests(ROBOT, *three_directions(THETA, 250.0)).displacement[:, :3]
    across -= clean * (across * clean).sum() / (clean**2).sum()
    share = noise / np.sqrt(1.0 - noise**2)  # of the whole, then
    odd = read + across * share * np.linalg.norm(read) / np.linalg.norm(across)
    found = suspicions(LoadTests(SOUND.wrench, odd, theta=SOUND.theta), ROBOT)
    assert ("unit" in [each.code for each in found]) == (noise < 0.2)


@pytest.mark.parametrize(("count", "told"), [(3, False), (4, True), (24, True)])
def test_a_component_that_is_zero_in_every_one_of_four_tests_was_not_read(count, told):
    read = SOUND.displacement[:count, :3] * [1, 0, 1]
    tests = LoadTests(SOUND.wrench[:count], read, theta=SOUND.theta[:count])
    assert ("unread" in codes(tests)) == told


def test_a_component_that_no_joint_moves_may_be_zero():
    """An arm in the plane: nothing of it moves along Z."""
    n = np.zeros(3)
    flat = rm.Robot.from_dh(alpha=n, a=np.array([0.6, 0.5, 0.3]), d=n, C_theta=np.full(3, 1e-6))
    theta = np.random.default_rng(1).uniform(-1.0, 1.0, (8, 3))
    F = np.random.default_rng(2).normal(size=(8, 3)) * [100, 100, 0]
    read = np.einsum("mij,mj->mi", rm.cartesian_compliance(flat, theta), F)
    assert not read[:, 2].any()
    assert "unread" not in codes(LoadTests(F, read, theta=theta), flat)
    assert "unread" in codes(LoadTests(F, read * [0, 1, 1], theta=theta), flat)


def test_components_that_were_not_read_are_named():
    for axes in ([2], [0, 1], [1]):
        read = SOUND.displacement[:, :3].copy()
        read[:, axes] = 0.0
        (text,) = (each.message for each in suspicions(moved(SOUND, read), ROBOT) if each.code == "unread")
        assert text.split(" is zero")[0] == " and ".join(f"d{'xyz'[axis]}" for axis in axes)


def test_a_compliance_at_the_limit_is_off_to_its_own_side():
    """As many times larger or smaller as is allowed at most is told as such, a hair less is not."""
    for times, word in ((FACTOR, "larger"), (1.0 / FACTOR, "smaller")):
        assert f"{FACTOR:g} times {word} than" in _off(times, 1.0, PLAUSIBLE)
        assert _off(times ** (1 - 1e-9), 1.0, PLAUSIBLE) is None
