"""Every word has a use or is told: which lines use which letter, written down from the reference of RS274/NGC."""

from __future__ import annotations

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import codes as modal
from robomill.toolpath.gcode import interpret
from robomill.toolpath.gcode.check import check_words
from robomill.toolpath.gcode.expressions import Reader
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
