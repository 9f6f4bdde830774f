"""Numbers that can be meant, and hardly are, stand beside the result; those that everybody gives do not."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import robomill as rm
from robomill.simulation.origin.doubts import CODE, FRAME, SLIP, _of_robot, _of_sizes, frame_notes

SLOT = {"p_mm": [[-20, 0, -2], [20, 0, -2]], "feed_mm_min": 1800}


def doubted(**changes: Any) -> list[str]:
    """What a straight slot of 40 mm is doubted for, with these changes."""
    given: dict[str, Any] = {
        "robot": rm.load_robot("slavkovic_5r"),
        "source": rm.Toolpath.from_points(**SLOT),
        "cutter": rm.Cutter("flat", diameter_mm=6, flutes=2),
        "force": rm.ConstantForce([0, 100, 0]),
        "part_zero_mm": [0, -1300, 0],
    }
    result = rm.simulate(rm.SimulationSetup(**{**given, **changes}))
    slips = [note.message for note in result.notes if note.code == SLIP]
    assert (result.verdict.level == "unjudged") == bool(slips)
    assert all(words in result.verdict.sentence for words in slips)
    return [*slips, *(note.message for note in result.notes if note.code == CODE)]


def test_a_plain_slot_is_not_doubted() -> None:
    assert doubted() == []
    assert doubted(source=rm.Toolpath.from_points(**SLOT, spindle_1_min=12000)) == []


@pytest.mark.parametrize("sample", ["paper_flute", "heart"])
def test_no_sample_is_doubted(sample: str) -> None:
    assert not {CODE, SLIP} & {note.code for note in rm.simulate(rm.load_setup(sample)).notes}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"force": rm.PathForce(feed_normal=0.1)}, "never exceeds 0.1 N, .* in kN?"),
        ({"force": rm.PathForce(feed_normal=50e3)}, "more than any robot mills with"),
        ({"part_zero_mm": [0, -30, 10]}, "lies in the foot of the robot, 30.0 mm from its first axis"),
        ({"part_zero_mm": None, "part_zero": [0, -0.0013, 0]}, "was it given in m?"),
        ({"cutter": rm.Cutter("flat", diameter_mm=0.32)}, "The cutter is 0.32 mm wide"),
        # 30 mm/min / (12000 1/min * 2) = 1.25 um; 1800 / (200 * 2) = 4.5 mm
        ({"source": rm.Toolpath.from_points(**{**SLOT, "feed_mm_min": 30}, spindle_1_min=12000)}, "takes 0.00125 mm"),
        ({"source": rm.Toolpath.from_points(**SLOT, spindle_1_min=200)}, "takes 4.5 mm .* speed in 1/s?"),
        ({"source": rm.Toolpath.from_points(p_mm=[[0, 0, -2], [0.8, 0, -2]], feed_mm_min=1800)}, "The whole path lies"),
        ({"robot": rm.load_robot("slavkovic_5r").replace(tool_xyz=[1.6e-4, 0, 0])}, "The tool ends 0.16 mm from"),
        ({"source": rm.Toolpath.from_points(p=[[-4, 0, -2], [4, 0, -2]], v_f=0.03)}, "more than the arm reaches"),
    ],
)
def test_what_looks_like_another_unit_is_said(changes: dict[str, Any], words: str) -> None:
    (said,) = doubted(**changes)
    assert re.search(words.replace("?", "\\?"), said), said


@pytest.mark.parametrize("times", [1e-3, 1e3])
def test_by_joints_that_no_arm_has_nothing_is_judged(times: float) -> None:
    """Their numbers are told, and no colour: a thousand times as stiff is N m/rad taken for kN m/rad."""
    robot = rm.load_robot("slavkovic_5r")
    (said,) = doubted(robot=robot.replace(C_theta=times * robot.C_theta))
    assert said.startswith("The joints: no arm")
    assert doubted(robot=robot.replace(C_theta=np.zeros(5))) == []  # rigid joints are a wish, and a force of none
    assert doubted(force=rm.ConstantForce([0, 0, 0])) == []


def test_a_short_plunge_by_itself_is_no_slip() -> None:
    assert doubted(source=rm.Toolpath.from_points(p_mm=[[0, 0, 0], [0, 0, -1.5]], feed_mm_min=300)) == []


def six(**more: Any) -> rm.Robot:
    """A plain arm of six joints, whose flange points its z out at the tool."""
    return rm.Robot.from_dh(
        a_mm=[300, 1000, 50, 0, 0, 0],
        alpha_deg=[-90, 0, -90, 90, -90, 0],
        d_mm=[600, 0, 0, 1000, 0, 200],
        k_theta_kNm_per_rad=3000,
        **more,
    )


def test_a_flange_frame_taken_as_the_tool_frame_is_told() -> None:
    """By the arm's own pose: with z_T along the tool's way out the flange ends up 160 mm below the tip."""
    robot = six(tool_xyz_mm=[0, 0, 160])
    setup = rm.SimulationSetup(
        robot=robot,
        source=rm.Toolpath.from_points(**SLOT),
        cutter=rm.Cutter("flat", diameter_mm=6, flutes=2),
        force=rm.ConstantForce([0, 100, 0]),
        part_zero_mm=[1200, 0, 700],
    )
    found = rm.simulate(setup)
    T_MT = rm.tool_pose(robot, found.theta[found.reached][0])
    flange = T_MT @ np.linalg.inv(robot.T_tool)
    assert flange[2, 3] - T_MT[2, 3] == pytest.approx(-0.160, abs=1e-9)
    (told,) = [note for note in found.notes if note.code == FRAME]
    assert "160 mm from the tip on the side of the part" in told.message


def test_tools_that_stand_off_or_beside_their_flange_are_not_doubted() -> None:
    turned = np.diag([1.0, -1.0, -1.0, 1.0])
    turned[:3, 3] = [0.0, 0.0, 0.16]
    beside = np.array([[0.0, 0, 1, 0.2], [0, 1, 0, 0], [-1, 0, 0, 0.1], [0, 0, 0, 1]])
    assert frame_notes(six()) == frame_notes(six(T_tool=turned)) == ()
    along = -float(beside[:3, 2] @ beside[:3, 3])  # -0.2: {T}'s z runs further out along x
    assert along < 0.0
    assert len(frame_notes(six(T_tool=beside))) == 1
    for name in ("slavkovic_5r", "kuka_kr270", "kuka_kr500", "fanuc_r2000ic", "planar_2r", "planar_3r"):
        assert frame_notes(rm.load_robot(name)) == ()


def test_a_cutter_that_sticks_out_far_and_is_taken_as_rigid_is_told() -> None:
    """A cantilever, F L^3 / (3 E I): 40 mm of 4 mm carbide at the slot's force; not with its spring, not if short."""
    setup, told = rm.load_setup("paper_flute/setup_process").replace(step_mm=10, cell_mm=1.0), {}
    for length, springs in ((40, ()), (8, ()), (None, ()), (40, (rm.ToolBending(diameter_mm=4, stick_out_mm=40),))):
        cutter = rm.Cutter("flat", diameter_mm=4, flutes=3, stick_out_mm=length)
        force = rm.process_force("al7075_t6_carbide_ref190", cutter)
        run = rm.simulate(setup.replace(cutter=cutter, force=force, springs=springs))
        told[length, bool(springs)] = [each.message for each in run.notes if each.code == "rigid-tool"]
        if length == 40 and not springs:
            F = run.F[run.worst]
            bent = np.hypot(F[0], F[1]) * 0.04**3 / (3 * 600e9 * np.pi * 0.0032**4 / 64)
            assert f"{bent * 1e3:.2f}" in told[length, False][0]
    assert [len(each) for each in told.values()] == [1, 0, 0, 0]


@pytest.mark.parametrize(
    ("zero_mm", "told"),
    [((0, -49, 10), True), ((0, -51, 10), False), ((30, 38, -49), True), ((30, 41, 0), False), ((0, -30, 51), False)],
)
def test_a_part_lies_in_the_foot_of_an_arm_within_five_centimetres_of_its_axis_and_of_its_plane(
    zero_mm: tuple[float, float, float], told: bool
) -> None:
    words = [*_of_robot(rm.load_robot("slavkovic_5r"), 1e-3 * np.array(zero_mm))]
    assert ["lies in the foot of the robot" in each for each in words] == [True] * told


@pytest.mark.parametrize(("long_mm", "told"), [(1.9, True), (2.1, False)])
def test_a_path_is_a_speck_within_two_millimetres(long_mm: float, told: bool) -> None:
    path = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [long_mm, 0, -2]], feed_mm_min=1800)
    assert ["The whole path lies" in each for each in doubted(source=path)] == [True] * told


@pytest.mark.parametrize(("long_mm", "short"), [(1.9, True), (2.1, False)])
def test_a_tool_is_short_within_two_millimetres(long_mm: float, short: bool) -> None:
    """Whatever way it points; and only one that is not short shows by its z_T on which side its flange stands."""
    robot = rm.load_robot("slavkovic_5r").replace(tool_xyz=[0.6e-3 * long_mm, 0.0, 0.8e-3 * long_mm])
    told = ["The tool ends" in each for each in _of_robot(robot, np.array([1.0, 0.0, 0.0]))]
    assert told == [True] * short
    assert bool(frame_notes(six(tool_xyz_mm=[0, 0, long_mm]))) != short


@pytest.mark.parametrize(("times", "told"), [(1.95, False), (2.05, True)])
def test_a_path_is_long_beyond_what_an_arm_reaches_to_both_sides(times: float, told: bool) -> None:
    """All links of a plain arm in one line, there and back."""
    reach = np.hypot(0.3, 0.6) + 1.0 + 0.05 + 1.0 + 0.2
    path = rm.Toolpath.from_points(p=[[0, 0, -2e-3], [times * reach, 0, -2e-3]], v_f=0.03)
    setup = SimpleNamespace(robot=six(), cutter=rm.Cutter("flat", diameter_mm=6))
    assert ["more than the arm reaches" in each for each in _of_sizes(setup, path)] == [True] * told  # type: ignore[arg-type]
