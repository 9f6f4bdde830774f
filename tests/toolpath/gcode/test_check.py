"""Every word has a use or is told: which lines use which letter, written down from the reference of RS274/NGC."""

from __future__ import annotations

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import codes as modal, interpret
from robomill.toolpath.gcode.check import check_words, choose_motion
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.parameters import Parameters
from robomill.toolpath.gcode.words import read_words

# Each line without the letters that are tried, and the letters that may stand on it.
LINES = {
    "g0x1": "",
    "g1x1f1": "",
    "g2x1": "ijkrp",
    "g3x1": "ijkrp",
    "g4p1": "p",
    "g5x1": "ijpq",
    "g5.1x1": "ij",
    "g5.2x1": "pl",
    "g10x1": "pijqlr",
    "g33z-1k1": "k",
    "g33.1z-1k1": "k",
    "g40": "",
    "g41": "dl",
    "g42": "dl",
    "g41.1": "dlr",
    "g42.1": "dlr",
    "g43": "h",
    "g43.2": "h",
    "g43.1x1": "",
    "g53g0x1": "",
    "g64": "pq",
    "g73z-1": "qlr",
    "g74z-1": "plr",
    "g76z-1": "pijkqrhle",
    "g81z-1": "lr",
    "g82z-1": "plr",
    "g83z-1": "qlr",
    "g84z-1": "plr",
    "g85z-1": "lr",
    "g86z-1": "plr",
    "g87z-1": "lrijk",
    "g88z-1": "plr",
    "g89z-1": "plr",
    "g92x1": "",
    "g96s1": "d",
    "m3s1": "",
    "m6": "",
    "m19": "pqr",
    "m48": "p",
    "m50": "p",
    "m53": "p",
    "m61": "q",
    "m62": "p",
    "m63": "p",
    "m64": "p",
    "m65": "p",
    "m66": "pelq",
    "m67": "eq",
    "m68": "eq",
    "m100": "pq",
}


@pytest.mark.parametrize("line", LINES)
def test_letters_that_a_line_uses(line):
    for letter in "dehijklpqr":
        text = line if letter in line else f"{line}{letter}1"
        block = read_words(Reader(text, 1, Parameters()))
        block.motion = block.g.get(modal.MOTION, -1)
        unused = [name for name, _ in check_words(block)]
        assert unused == ([] if letter in LINES[line] else [letter]), letter


def test_a_dwell_cannot_be_negative():
    with pytest.raises(GCodeError, match="Line 2: G4 has P-2; a dwell cannot be negative."):
        interpret("G21\nG4 P-2\nM2\n")


REFUSED = None
NO_MOTION = -1
# What a line does after: nothing yet, G1, G3, G80. Axis words have one user: a motion, or a code that takes them.
MOTIONS = {
    "x1": (REFUSED, 10, 30, REFUSED),
    "a1": (REFUSED, 10, 30, REFUSED),
    "@5": (REFUSED, 10, 30, REFUSED),
    "^30": (REFUSED, 10, 30, REFUSED),
    "@5^30": (REFUSED, 10, 30, REFUSED),
    "i1": (NO_MOTION, NO_MOTION, 30, NO_MOTION),  # an arc alone may do without an end
    "f1": (NO_MOTION, NO_MOTION, NO_MOTION, NO_MOTION),
    "g0": (0, 0, 0, 0),
    "g3": (30, 30, 30, 30),
    "g1x1": (10, 10, 10, 10),
    "g2^30": (20, 20, 20, 20),
    "g80": (800, 800, 800, 800),
    "g80x1": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g80@1": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g80g92x1": (800, 800, 800, 800),
    "g81": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g81z-1": (810, 810, 810, 810),
    "g81@3": (810, 810, 810, 810),
    "g5.2": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g5.2p1": (52, 52, 52, 52),
    "g33": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g92x1": (NO_MOTION, NO_MOTION, NO_MOTION, NO_MOTION),
    "g92": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g52": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g52b1": (NO_MOTION, NO_MOTION, NO_MOTION, NO_MOTION),
    "g28": (NO_MOTION, NO_MOTION, NO_MOTION, NO_MOTION),
    "g28x1": (NO_MOTION, NO_MOTION, NO_MOTION, NO_MOTION),
    "g28@1": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g10^1": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g28g0x1": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g92.1x1": (REFUSED, 10, 30, REFUSED),
    "g43.1z1": (NO_MOTION, NO_MOTION, NO_MOTION, NO_MOTION),
    "g43z1": (REFUSED, 10, 30, REFUSED),
    "@5x1": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g0^5y1": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g0^5z1": (0, 0, 0, 0),
    "g0u1": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g0x1w1": (REFUSED, REFUSED, REFUSED, REFUSED),
    "g53g0x1": (0, 0, 0, 0),
    "g53g91g0x1": (REFUSED, REFUSED, REFUSED, REFUSED),
}


def chosen(line: str, before: int, *, plane: int = 17, absolute: bool = True) -> int | None:
    machine = Machine(None)
    machine.motion, machine.plane, machine.absolute = before, plane, absolute
    block = read_words(Reader(line, 1, Parameters()))
    try:
        choose_motion(machine, block)
    except GCodeError:
        return REFUSED
    return block.motion


@pytest.mark.parametrize("line", MOTIONS)
def test_axis_words_have_one_use(line: str) -> None:
    assert tuple(chosen(line, before) for before in (-1, 10, 30, 800)) == MOTIONS[line]


def test_polar_words_need_their_plane_and_g53_its_distance() -> None:
    for plane in (18, 19):
        assert chosen("g0@5", 0, plane=plane) is REFUSED
        assert chosen("g0z5", 0, plane=plane) == 0
    for words, absolute, expected in (("", True, 0), ("", False, REFUSED), ("g90", False, 0), ("g91", True, REFUSED)):
        assert chosen(f"g53{words}g0x1", 0, absolute=absolute) == expected


# Lines that no machine may run, each beside one that it may.
SENSELESS = {
    "g4": "g4p0",
    "g4p-0.1": "g4p.1",
    "g4p1g2x1i1": "g4p1g1x1",
    "g53g1x1g2": "g53g1x1",
    "g53g81z1": "g53g0x1",
    "g81z-1a1": "g81z-1",
    "g73z-1c1": "g1z-1c1",
    "g2x1i1p0": "g2x1i1p1",
    "g2x1i1p1.01": "g2x1i1p1.0005",
    "g3x1i1p-2": "g3x1i1p3",
    "g3x1i1p10001": "g3x1i1p10000",
    "g33z1": "g33z1k1",
    "g33.1z1k1f1": "g33.1z1k1",
    "g96": "g96s1",
}


@pytest.mark.parametrize("line", SENSELESS)
def test_senseless_words(line: str) -> None:
    for text, good in ((line, False), (SENSELESS[line], True)):
        try:
            block = read_words(Reader(text, 1, Parameters()))
            block.motion = block.g.get(modal.MOTION, -1)
            assert check_words(block) == []
        except GCodeError:
            assert not good, text
        else:
            assert good, text
