"""The writer: modal economy, refusals, tilted axes."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import ToolpathError
from robomill.io.gcode_out import toolpath_to_gcode
from robomill.toolpath.gcode import read_gcode
from robomill.toolpath.path import Toolpath, toolpath_from_lines


def unnumbered(path: Toolpath) -> list[str]:
    """The lines of the program without their N."""
    return [line.partition(" ")[2] for line in toolpath_to_gcode(path).splitlines()]


def test_words_are_written_where_something_changes() -> None:
    path = read_gcode("G21 S600 M3\nG0 Z5\nG1 Z-1 F300\nX10\nY10\nG0 Z5\nM2\n")
    assert unnumbered(path) == [
        "G21 G90 G94 G17",
        "S600 M3",
        "G0 X0 Y0 Z5",
        "G1 Z-1 F300",
        "X10",
        "Y10",
        "G0 Z5",
        "M5",
        "M2",
    ]
    assert toolpath_to_gcode(path).splitlines()[1].startswith("N20 ")


def test_a_start_away_from_zero_becomes_a_rapid() -> None:
    path = toolpath_from_lines([[0.01, 0, 0]], [[0.02, 0, 0]], [0.01])
    again = read_gcode(toolpath_to_gcode(path))
    assert again.p[1:] == pytest.approx(path.p)
    assert not again.cutting[1]


def test_tilted_axes_come_back() -> None:
    t = np.linspace(0, 1, 200)
    a, b = 6 * t, np.sin(9 * t)
    k = np.stack([np.sin(b), -np.sin(a) * np.cos(b), np.cos(a) * np.cos(b)], axis=1)
    p = np.stack([t, t * 0, t * 0], axis=1) * 0.1
    path = Toolpath(p=p, k=k, v_f=np.full(200, 0.01), cutting=t > 0, block=np.arange(200), n_s=np.zeros(200), tool=0)  # type: ignore[arg-type]
    again = read_gcode(toolpath_to_gcode(path))
    index = np.searchsorted(again.p[:, 0], p[1:, 0] - 1e-9)
    assert abs(again.k[index] - k[1:]).max() < 1e-6


def test_refusals() -> None:
    path = toolpath_from_lines([[0, 0, 0]], [[1, 0, 0]], [0.01])
    with pytest.raises(ToolpathError, match="expected 'mm' or 'in'"):
        toolpath_to_gcode(path, units="furlong")
    stuck = Toolpath(
        p=path.p, k=path.k, v_f=np.zeros(2), cutting=path.cutting, block=path.block, n_s=path.n_s, tool=path.tool
    )
    with pytest.raises(ToolpathError, match="feed of 0"):
        toolpath_to_gcode(stuck)


WORDS = [
    *("M3 S600", "G1 X1 F600", "X2", "M5", "X3", "M4", "X4", "G4 P0.5", "G4 P0.25", "G2 X6 I1", "X8 I1"),
    *("M3", "G1 X9", "M4 S0", "X10", "S900", "G0 X11", "G4 P2", "M2"),
]


def test_written_and_read_again() -> None:
    path = read_gcode("\n".join(word.replace("S0", "S1") for word in WORDS))
    again = read_gcode(toolpath_to_gcode(path))
    assert again.ccw.tolist() == path.ccw.tolist()
    assert again.dwell == pytest.approx(path.dwell)


def test_titles_hold_no_brackets_and_unknown_speeds_are_refused() -> None:
    path = read_gcode("G21 S600 M3\nG0 Z5\nG1 Z-1 F300\nM2\n")
    assert toolpath_to_gcode(path, title="a (b) ; c\td").splitlines()[0] == "(a b  cd)"
    assert toolpath_to_gcode(path).splitlines()[0].startswith("N10 ")
    turning = read_gcode("G21 G96 S100 D2000 M3\nG0 X5\nG1 Z-1 F300\nM2\n")
    with pytest.raises(ToolpathError, match="the spindle speed of point"):
        toolpath_to_gcode(turning)


def test_an_axis_along_x_keeps_the_turn_it_had() -> None:
    """With B at a right angle A says nothing: it stays, and the axis comes back."""
    b = np.radians([0, 30, 60, 90, 90, 60])
    k = np.stack([np.sin(b), -np.sin(0.4) * np.cos(b), np.cos(0.4) * np.cos(b)], axis=1)
    k[0] = [0, 0, 1]
    m = len(b)
    p = np.outer(np.arange(m), [0.01, 0, 0])
    path = Toolpath(
        p=p, k=k, v_f=np.full(m, 0.01), cutting=np.arange(m) > 0, block=np.arange(m), n_s=np.zeros(m), tool=0
    )  # type: ignore[arg-type]
    again = read_gcode(toolpath_to_gcode(path))
    index = np.searchsorted(again.p[:, 0], p[1:, 0] - 1e-9)
    assert abs(again.k[index] - k[1:]).max() < 1e-6


def test_the_first_point_has_its_own_tool_and_speed() -> None:
    p = np.outer([0.0, 0.01, 0.02], [1, 0, 0])
    cutting = np.array([False, True, True])
    made = {"k": [0.0, 0, 1], "v_f": np.array([0, 0.01, 0.01]), "block": np.arange(3)}
    path = Toolpath(p=p, cutting=cutting, n_s=np.array([10.0, 20, 20]), tool=np.array([1, 2, 2]), **made)  # type: ignore[arg-type]
    assert unnumbered(path)[1:7] == [
        "T1 M6",
        "S600 M3",
        "G0 X0 Y0 Z0",
        "T2 M6",
        "S1200 M3",
        "G1 X10 F600",
    ]
