"""Which way the spindle turns and where the program waits, from the words to the short steps.

The truth is a walk through the words by hand: modal M3, M4, M5 as a state, G4 as seconds before the next move.
"""

from __future__ import annotations

import numpy as np
import pytest

from robomill.toolpath.gcode import read_gcode
from robomill.toolpath.path import toolpath_from_lines

WORDS = [
    *("M3 S600", "G1 X1 F600", "X2", "M5", "X3", "M4", "X4", "G4 P0.5", "G4 P0.25", "G2 X6 I1", "X8 I1"),
    *("M3", "G1 X9", "M4 S0", "X10", "S900", "G0 X11", "G4 P2", "M2"),
]


def truth() -> tuple[list[bool], list[float]]:
    """Sense and dwell of each move of WORDS."""
    sense, waited, speed = 0, 0.0, 0.0
    ccw, dwell = [], []
    for line in WORDS:
        words = line.split()
        speed = next((float(w[1:]) for w in words if w[0] == "S"), speed)
        sense = {"M3": 1, "M4": -1, "M5": 0}.get(words[0], sense)
        if words[0] == "G4":
            waited += float(words[1][1:])
        if any(w[0] == "X" for w in words):
            ccw.append(sense < 0)
            dwell.append(waited)
            waited = 0.0
    return ccw, dwell


@pytest.mark.parametrize("padding", [0, 40, 25_000], ids=["by words", "by words, longer", "compiled"])
def test_the_sense_and_the_dwell_stand_with_the_move(padding: int) -> None:
    path = read_gcode("\n".join(["G21", *WORDS[:-1], *["X11 (stays)"] * padding, "M2"]), chord_error=1e-3)
    ccw, dwell = truth()
    moves = np.unique(path.block[1:], return_index=True)[1] + 1  # the first point of each line
    assert path.ccw[moves][: len(ccw)].tolist() == ccw
    assert path.dwell[moves][: len(dwell)] == pytest.approx(dwell)
    assert path.dwell.sum() == pytest.approx(sum(dwell) + (2.0 if padding else 0.0))
    assert [bool(path.ccw[path.block == line].all()) for line in path.block[moves][: len(ccw)]] == ccw


def test_the_sense_counts_in_the_digest_and_defaults_to_clockwise() -> None:
    right, left = (read_gcode(f"{m} S600\nG1 X1 F60\nM2\n") for m in ("M3", "M4"))
    assert right.digest() != left.digest()
    assert not toolpath_from_lines([[0, 0, 0]], [[1, 0, 0]], 0.01, 10.0).ccw.any()


def test_a_cycle_waits_at_the_bottom() -> None:
    path = read_gcode("M3 S600\nG82 X1 Z-2 R1 P0.5 F60\nX2\nG80\nM2\n")
    waits = np.flatnonzero(path.dwell)
    assert path.dwell[waits].tolist() == [0.5, 0.5]
    assert path.p[waits - 1, 2] == pytest.approx(-2e-3)


HOLES = """G21 G90 M3 S600 F60
G0 X0 Y0 Z5
N5 G04 P300
G82 G99 X1 Z-2 R1 P500
X2
X3 P250 (P9000)
Y1 P1.5
G80
P40 G4
G4 X2.5
G0 Z5
G89 X4 Z-1 R1 P0100
M98 P2000 L1
G80 G0 Z9
M30
O2000
X5
M99
"""


@pytest.mark.parametrize("padding", [0, 25_000])
def test_fanuc_counts_dwells_without_a_point_in_milliseconds_and_linuxcnc_in_seconds(padding: int) -> None:
    """By hand: what each line waits."""
    text = HOLES.replace("M30", "M30" + "\n(more)" * padding)
    path = read_gcode(text, dialect="fanuc")
    waits = [0.3, 0.5, 0.5, 0.25, 1.5, 0.04, 2.5, 0.1, 0.1]
    assert path.dwell.sum() == pytest.approx(sum(waits))
    assert not any(found.code == "long-dwell" for found in path.findings)
    plain = read_gcode("M3 S600 F60\nG82 X1 Z-2 R1 P500\nX2\nX3 P250\nG80\nM2\n")
    assert plain.dwell.sum() == pytest.approx(500 + 500 + 250)
    assert [found.level for found in plain.findings if found.code == "long-dwell"] == ["suspicious"]


@pytest.mark.parametrize("padding", [0, 25_000])
def test_a_speed_that_follows_the_diameter_is_not_known(padding: int) -> None:
    """Not zero: the spindle turns. M5 stops it in that mode too, and G97 makes the speed known again."""
    lines = [
        "G96 S200 M4 F60",
        "G1 X1",
        "M5",
        "X2",
        "G97 S600 M3",
        "X3",
        "G96 S100",
        "X4",
        *["X5 (on)"] * padding,
        "M2",
    ]
    path = read_gcode("\n".join(["G21", *lines]))
    assert path.n_s[1:5] == pytest.approx([np.nan, 0.0, 10.0, np.nan], nan_ok=True)
    assert np.isnan(path.n_s[5:]).all()
    assert path.ccw[1:5].tolist() == [True, False, False, False]
    assert "surface-speed" in {f.code for f in path.findings}
