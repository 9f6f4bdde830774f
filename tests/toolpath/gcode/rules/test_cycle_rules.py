"""Canned cycles, written down as the handbook of RS274/NGC describes them and compared move by move."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.toolpath.gcode import interpret, stretches
from robomill.toolpath.gcode.program import FEED, TRAVERSE

AXES = {17: "XYZ", 18: "ZXY", 19: "YZX"}
CODES = ("73 Q1.3", "81", "82 P0.5", "83 Q1.3", "85", "86 P0.5", "89 P0.5")
HOLE_DEPTH = 4.0


def below(code, r, bottom, clear):
    """[kind, height, dwell before] from the clearance plane down and back to where the next hole begins."""
    number = int(code[:2])
    moves = []
    if number in (73, 83):
        depth = r - 1.3
        while depth > bottom:
            moves.append((FEED, depth, 0))
            if number == 83:
                moves.append((TRAVERSE, r, 0))
            moves.append((TRAVERSE, depth + 0.254, 0))
            depth -= 1.3
    moves.append((FEED, bottom, 0))
    wait = 0.5 if "P" in code else 0.0
    if number == 85:
        moves += [(FEED, r, 0), (TRAVERSE, clear, 0)]
    else:
        moves.append((FEED if number == 89 else TRAVERSE, clear, wait))
    return moves


def handbook(code, start, words, *, step, retract_r, repeats):
    """(kind, a, b, c, dwell) of all moves: above the hole, down to R, the hole, and to where the next one begins."""
    a, b, c = start
    pa, pb, r, bottom = words
    if step:
        r += c
        bottom += r
    moves, level = [], c
    if c < r:
        moves.append((TRAVERSE, a, b, r, 0))
        c = level = r
    clear = r if retract_r else level
    for k in range(repeats):
        a, b = (a + pa, b + pb) if step else (pa, pb)
        moves += [(TRAVERSE, a, b, c if k == 0 else clear, 0), (TRAVERSE, a, b, r, 0)]
        moves += [(kind, a, b, height, wait) for kind, height, wait in below(code, r, bottom, clear)]
    return moves


def different(moves, at):
    """Without moves that lead nowhere."""
    kept = []
    for kind, *p, wait in moves:
        if np.linalg.norm(np.subtract(p, at)) > 1e-9:
            kept.append((kind, *p, wait))
        at = p
    return np.array(kept)


@pytest.mark.parametrize("code", CODES)
@pytest.mark.parametrize("plane", AXES)
@pytest.mark.parametrize(
    ("step", "retract_r", "repeats", "height"),
    [(0, 0, 1, 9), (0, 1, 1, 9), (1, 0, 3, 9), (1, 1, 3, 9), (0, 0, 2, 1), (1, 0, 2, -6)],
)
def test_a_cycle_is_what_the_handbook_says(code, plane, step, retract_r, repeats, height):
    start, place = (3.0, -2.0, float(height)), (1.5, 2.5)
    r, bottom = (2.0, 2.0 - HOLE_DEPTH) if not step else (2.0, -HOLE_DEPTH)
    letters = AXES[plane]
    told = " ".join(f"{letter}{value}" for letter, value in zip(letters, start))
    words = f"{letters[0]}{place[0]} {letters[1]}{place[1]} {letters[2]}{bottom} R{r} L{repeats}"
    number, _, more = code.partition(" ")
    program = interpret(
        f"G21 G90 G{plane} S1000 M3 F100\nG0 {told}\nG{91 if step else 90} G{99 if retract_r else 98}\n"
        f"G{number} {words} {more}\nM2\n"
    )
    wanted = handbook(code, start, (*place, r, bottom), step=step, retract_r=retract_r, repeats=repeats)
    columns = ["XYZ".index(letter) for letter in letters]
    here = program.line == 4
    ends, starts = program.end[here][:, columns] * 1e3, program.start[here][:, columns] * 1e3
    moved = np.linalg.norm(ends - starts, axis=1) > 1e-9
    found = np.column_stack([program.kind[here], ends, program.dwell[here]])[moved]
    np.testing.assert_allclose(found, different(wanted, start), atol=1e-9)


@pytest.mark.parametrize("code", ["G84", "G74"])
def test_a_tap_goes_in_and_out_at_feed_and_waits_at_the_bottom(code):
    program = interpret(f"G21 G90 S1000 M{3 if code == 'G84' else 4} F100\nG0 Z5\nG98 {code} X1 Y2 Z-3 R1 P0.25\nM2\n")
    np.testing.assert_allclose(program.end[-3:, 2] * 1e3, [1, -3, 5])
    assert program.kind[-2:].tolist() == [FEED, FEED]
    assert program.dwell[-1] == 0.25


@pytest.mark.parametrize(("plane", "tapped"), [(17, (1, 2, -3)), (18, (-3, 1, 2)), (19, (2, -3, 1))])
def test_outside_of_g17_a_tap_runs_along_the_axes_that_the_reference_taps_along(plane, tapped):
    """LinuxCNC's tap swaps the planes G18 and G19: x, y, z where it ends, at the place (1, 2) and the depth -3 of its
    own plane. It comes down at its place, is there again after it, and the next hole is one."""
    letters = AXES[plane]
    words = " ".join(f"{letter}{value}" for letter, value in zip(letters, (1, 2, -3)))
    text = f"G21 G90 G{plane} S1000 M3 F100\nG0 {letters[2]}5\nG99 G84 {words} R1.5\n{letters[1]}4\nG80\nM2\n"
    program = interpret(text)
    columns = ["XYZ".index(letter) for letter in letters]
    for line, second in ((3, 2.0), (4, 4.0)):
        here = np.flatnonzero(program.line == line)
        *_, down, tap, up = here
        np.testing.assert_allclose(program.end[down, columns] * 1e3, [1, second, 1.5], atol=1e-9)
        swapped = np.where(np.array(tapped) == 2.0, second, tapped)
        np.testing.assert_allclose(program.end[tap] * 1e3, swapped, atol=1e-9)
        assert program.kind[[tap, up]].tolist() == [FEED, FEED]
        np.testing.assert_allclose(program.end[up] * 1e3, np.where(swapped == -3.0, 1.5, swapped), atol=1e-9)


@pytest.mark.parametrize(("plane", "aside"), [(17, (0.4, -0.7, 0)), (18, (0, 0.4, -0.7)), (19, (-0.7, 0, 0.4))])
def test_back_boring_goes_through_aside_and_cuts_upwards(plane, aside):
    """In G17: I, J aside, K the height up to which is bored. ``aside`` in x, y, z; the third axis has K 1.5."""
    letters = AXES[plane]
    columns = ["XYZ".index(letter) for letter in letters]
    offsets = {"IJK"[columns[0]]: 0.4, "IJK"[columns[1]]: -0.7, "IJK"[columns[2]]: 1.5}
    words = " ".join(f"{letter}{value}" for letter, value in offsets.items())
    text = f"{letters[0]}1 {letters[1]}2 {letters[2]}-3 R2 {words}"
    program = interpret(f"G21 G90 G{plane} S1000 M3 F100\nG0 {letters[2]}5\nG98 G87 {text}\nM2\n")
    here = program.line == 3
    found = np.column_stack([program.kind[here], program.end[here][:, columns] * 1e3])
    kinds = [TRAVERSE] * 5 + [FEED, FEED] + [TRAVERSE] * 3
    path = [
        (1, 2, 5),
        (1, 2, 2),
        (1.4, 1.3, 2),
        (1.4, 1.3, -3),
        (1, 2, -3),
        (1, 2, 1.5),
        (1, 2, -3),
        (1.4, 1.3, -3),
        (1.4, 1.3, 5),
        (1, 2, 5),
    ]
    np.testing.assert_allclose(found, np.column_stack([kinds, path]), atol=1e-9)


def test_back_boring_in_steps_is_that_at_the_places_they_lead_to():
    """In G91 R counts from where the tool is, Z from R, and K, up to which is bored, from the bottom."""
    head = "G21 G90 S1000 M3 F100\nG0 X0 Y0 Z5\n"
    places = interpret(f"{head}G98 G87 X1 Y2 Z-3 R2 I0.4 J-0.7 K1.5\nM2\n")
    steps = interpret(f"{head}G91 G98 G87 X1 Y2 Z-5 R-3 I0.4 J-0.7 K4.5\nM2\n")
    np.testing.assert_allclose(steps.end, places.end, atol=1e-12)
    assert steps.kind.tolist() == places.kind.tolist()


def test_the_words_of_a_cycle_stay_in_force_until_it_ends():
    program = interpret("G21 G90 F100\nG0 Z5\nG99 G81 X1 Y1 Z-2 R1\nX2\nY3 Z-1\nG80\nG81 X4 Z-3 R2\nM2\n")
    cut = program.kind == FEED
    np.testing.assert_allclose(program.end[cut] * 1e3, [[1, 1, -2], [2, 1, -2], [2, 3, -1], [4, 3, -3]], atol=1e-9)


@pytest.mark.parametrize("mode", ["G90", "G91"])
def test_holes_on_a_circle_by_polar_words(mode):
    """@ and ^ from the origin of the system; in steps they add to radius and angle."""
    words = {"G90": "G81 @10 ^30 Z-1 R2", "G91": "G81 @3 ^25 Z-3 R-3 L3"}[mode]
    program = interpret(f"G21 G90 F100\nG0 X5 Y0 Z5\n{mode} G99 {words}\nM2\n")
    holes = program.end[program.kind == FEED] * 1e3
    place = (
        [10 * np.exp(1j * np.pi / 6)]
        if mode == "G90"
        else [(5 + 3 * k) * np.exp(1j * np.radians(25 * k)) for k in (1, 2, 3)]
    )
    np.testing.assert_allclose(holes, [[z.real, z.imag, -1] for z in place], atol=1e-9)


@pytest.mark.parametrize("code", [*CODES, "74 P0.5", "84", "87 I0.4 J-0.7 K1", "88 P1"])
def test_compiled_code_drills_the_same(code, monkeypatch):
    """Rows of holes longer than the rows that compiled code is given at once, refused in the end."""
    spindle = 4 if code.startswith("74") else 3
    holes = [f"X{k} Y{-k % 7} Z-{3 + k % 3} L{1 + k % 2}" for k in range(4000)]
    first = [f"G21 G90 S900 M{spindle} F100 G98", "G0 Z9", f"G{code} X0 Z-2 R1"]
    text = "\n".join([*first, *holes, "G91", "X1 L3", "R-99"])
    read = []
    for many in (10**9, 0):
        monkeypatch.setattr(stretches, "LONG", many)
        monkeypatch.setattr(stretches, "LOADED_LONG", many)
        read.append(interpret(text + "\nM2\n", partial=True))
    plain, compiled = read
    assert len(plain) > 12_000
    assert plain.findings == compiled.findings
    for name in ("line", "kind", "start", "end", "v_f", "dwell"):
        np.testing.assert_array_equal(getattr(plain, name), getattr(compiled, name))
    assert plain.dwell_time == compiled.dwell_time


def test_a_fanuc_rises_to_a_higher_r_before_it_feeds() -> None:
    """G99 left the tool at R2; over a step with R6 it goes to R6 at rapid, and from there at feed."""
    text = "O1\nG21 G90 S100 M3 F100\nG0 X0 Y0 Z10.\nG99 G81 X5. Z-5. R2.\nX9. Z1. R6.\nG80\nM30\n"
    program = interpret(text, dialect="fanuc")
    rows = [("RF"[k], *(np.round(p[[0, 2]] * 1e3, 9)).tolist()) for k, p in zip(program.kind, program.end)]
    assert rows[5:] == [("R", 9, 2), ("R", 9, 6), ("F", 9, 1), ("R", 9, 6)]
