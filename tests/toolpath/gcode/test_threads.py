"""G76 by what a thread is: depths of constant area or less, flanks at their angle, entries and exits at their slope."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret
from robomill.toolpath.gcode.program import FEED

START, END = 4.0, -20.0


def read(words, start=START, end=END):
    program = interpret(f"G21 G90 G18 F100 S600 M3\nG0 X30 Z{start}\nG76 P1.5 Z{end} {words}\nM2\n")
    here = program.line == 3
    return [
        np.asarray(getattr(program, name)[here]) * f
        for name, f in (("start", 1e3), ("end", 1e3), ("kind", 1), ("v_f", 1))
    ]


@pytest.mark.parametrize("outside", [True, False])
@pytest.mark.parametrize("degression", [1.0, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("springs", [0, 2])
def test_depths_of_the_passes(outside, degression, springs):
    """The n-th pass is J n^(1/R) deep, the last K; H more at full depth. I is the way from the line to the peaks."""
    start, end, kind, v_f = read(f"I{-1.2 if outside else 1.2} J0.1 K0.55 R{degression} H{springs}")
    cut = kind == FEED
    depths, n = [], 1
    while 0.1 * n ** (1 / degression) < 0.55:
        depths.append(0.1 * n ** (1 / degression))
        n += 1
    depths += [0.55] * (1 + springs)
    side = -1.0 if outside else 1.0
    np.testing.assert_allclose(end[cut, 0], 30 + side * (1.2 + np.array(depths)), atol=1e-9)
    np.testing.assert_allclose(start[cut, 0], end[cut, 0], atol=1e-9)
    np.testing.assert_allclose(end[cut, 2] - start[cut, 2], END - START, atol=1e-9)
    np.testing.assert_allclose(v_f[cut], 1.5e-3 * 600 / 60)
    back = end[np.flatnonzero(cut) + 1]  # out of the work before it goes back
    assert (side * (back[:, 0] - 30) <= 0.0 + 1e-9).all()
    np.testing.assert_allclose(end[-1], [30, 0, END], atol=1e-9)


@pytest.mark.parametrize(("start", "end"), [(START, END), (END, START)])
def test_a_slid_tool_cuts_one_flank(start, end):
    """Each pass begins and ends tan(Q) of its depth nearer to the chuck; the last one ends where the line says."""
    first, last, kind, _ = read("I-1 J0.2 K0.8 R2 Q29.5", start, end)
    cut = kind == FEED
    depth, begin = 30 - 1 - last[cut, 0], first[cut, 2]
    way = math.copysign(1.0, end - start)
    np.testing.assert_allclose(np.diff(begin), way * math.tan(math.radians(29.5)) * np.diff(depth), atol=1e-9)
    np.testing.assert_allclose(last[cut, 2] - begin, last[cut, 2][-1] - begin[-1], atol=1e-9)
    assert last[cut, 2][-1] == pytest.approx(end)


@pytest.mark.parametrize("ends", [0, 1, 2, 3])
def test_tapers(ends):
    """E is the length of an entry (L1), an exit (L2) or both (L3), over the height of the thread."""
    start, end, kind, v_f = read(f"I-1 J0.2 K0.8 E2 L{ends}")
    moved = np.abs(end - start) > 1e-9
    rising = (kind == FEED) & moved[:, 0] & moved[:, 2]
    passes, ramps = 4, (ends & 1) + (ends >> 1)
    assert rising.sum() == passes * ramps
    rise = np.abs(end[rising] - start[rising])
    np.testing.assert_allclose(rise[:, 0], 0.8, atol=1e-9)
    np.testing.assert_allclose(rise[:, 2], 2.0, atol=1e-9)
    inward = end[rising, 0] < start[rising, 0]
    assert inward.sum() == passes * (ends in (1, 3))
    level = (kind == FEED) & ~moved[:, 0]
    np.testing.assert_allclose(np.abs(end[level, 2] - start[level, 2]), 24.0 - 2.0 * ramps, atol=1e-9)


@pytest.mark.parametrize("length", [0.5, 1.0, 2.0])
def test_a_taper_keeps_the_pitch_along_the_axis(length):
    """1.5 mm a turn at ten turns a second, on the slant the longer way of it."""
    start, end, kind, v_f = read(f"I-1 J0.2 K0.8 E{length} L3")
    moved = np.abs(end - start) > 1e-9
    along = (kind == FEED) & moved[:, 2]
    way = np.linalg.norm(end - start, axis=1)
    seconds = way[along] * 1e-3 / v_f[along]
    np.testing.assert_allclose(np.abs(end - start)[along, 2] * 1e-3 / seconds, 15e-3)


def test_diameters_halve_the_depths():
    """On a lathe that counts diameters (G7), I J K are twice as large for the same thread."""
    _, plain, kind, _ = read("I-1 J0.2 K0.8 R2 Q20")
    program = interpret(f"G21 G90 G18 G7 F100 S600 M3\nG0 X60 Z{START}\nG76 P1.5 Z{END} I-2 J0.4 K1.6 R2 Q20\nM2\n")
    here = program.line == 3
    np.testing.assert_allclose(program.end[here] * 1e3, plain, atol=1e-9)
    assert program.kind[here].tolist() == kind.tolist()


@pytest.mark.parametrize(("most", "fits"), [(3, False), (4, True)])
def test_a_thread_of_more_passes_than_anybody_waits_for_is_refused(most, fits, monkeypatch):
    """J0.25 of K1 are four passes."""
    monkeypatch.setattr("robomill.toolpath.gcode.threads.MAX_PASSES", most)
    if fits:
        assert (read("I-1 J0.25 K1")[2] == FEED).sum() == 4
        assert (read("I-1 J0.25 K1 H9")[2] == FEED).sum() == 4 + most, "springs are held to the same bound"
    else:
        with pytest.raises(GCodeError, match=r"^Line 3: G76 would need more than 3 passes; give a larger J\.$"):
            read("I-1 J0.25 K1")


@pytest.mark.parametrize(
    ("words", "says"),
    [
        *((f"I-1 J{j} K0.5", "I other than 0, J above 0 and K above J") for j in (0.5, 0.6, 0, -0.1)),
        ("I0 J0.1 K0.5", "I other than 0, J above 0 and K above J"),
        ("I-1 J0.000001 K0.5", "more than 3 passes"),
        *((words, "") for words in ("I-1 J0.5 K0.500001", "I0.001 J0.3 K0.5", "I-0.001 J0.3 K0.5")),
    ],
)
def test_the_depths_of_a_thread_are_some_and_the_first_is_less_than_all(words, says, monkeypatch):
    monkeypatch.setattr("robomill.toolpath.gcode.threads.MAX_PASSES", 3)
    if says:
        with pytest.raises(GCodeError, match=f"^Line 3: G76 .*{says}"):
            read(words)
    else:
        assert (read(words)[2] == FEED).sum() == 2
