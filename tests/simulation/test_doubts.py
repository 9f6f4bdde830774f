"""Numbers that can be meant, and hardly are, stand beside the result; those that everybody gives do not."""

from __future__ import annotations

import re
from typing import Any

import pytest

import robomill as rm
from robomill.simulation.doubts import CODE

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
    return [note.message for note in result.notes if note.code == CODE]


def test_a_plain_slot_is_not_doubted() -> None:
    assert doubted() == []
    assert doubted(source=rm.Toolpath.from_points(**SLOT, spindle_1_min=12000)) == []


@pytest.mark.parametrize("sample", ["paper_flute", "heart"])
def test_no_sample_is_doubted(sample: str) -> None:
    assert CODE not in {note.code for note in rm.simulate(rm.load_setup(sample)).notes}


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
