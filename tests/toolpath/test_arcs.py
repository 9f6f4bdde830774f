"""Arcs against their analytic definition: planes, forms, senses, helices, full circles; chords of second order."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.arcs import Arcs, chord_counts, turn_counts
from robomill.toolpath.gcode import interpret, read_gcode
from robomill.toolpath.gcode.chords import to_toolpath

PLANES = {
    17: ("X", "Y", "Z", "I", "J", 0, 1, 2),
    18: ("Z", "X", "Y", "K", "I", 2, 0, 1),
    19: ("Y", "Z", "X", "J", "K", 1, 2, 0),
}
CASES = list(itertools.product(PLANES, ("G2", "G3"), ("ijk", "absolute", "R"), (0.4, 1.9, 2.8, 3.6, 5.5)))


def number(value: float) -> str:
    return f"{value:.9f}"


@pytest.mark.parametrize(("plane", "code", "form", "sweep"), CASES)
def test_every_point_lies_on_the_arc(plane: int, code: str, form: str, sweep: float) -> None:
    a, b, c, i, j, first, second, third = PLANES[plane]
    radius, start_angle, climb = 7.0, 0.6, 2.0
    sign = -1.0 if code == "G2" else 1.0
    centre = np.array([3.0, -4.0])
    start = centre + radius * np.array([math.cos(start_angle), math.sin(start_angle)])
    end = centre + radius * np.array([math.cos(start_angle + sign * sweep), math.sin(start_angle + sign * sweep)])
    words = f"{code} {a}{number(end[0])} {b}{number(end[1])} {c}{climb}"
    if form == "R":
        words += f" R{radius if sweep <= math.pi else -radius}"
    else:
        middle = centre if form == "absolute" else centre - start
        words = ("G90.1 " if form == "absolute" else "") + words + f" {i}{number(middle[0])} {j}{number(middle[1])}"
    text = f"G21 G{plane} F100\nG0 {a}{number(start[0])} {b}{number(start[1])}\n{words}\nM2\n"
    program = interpret(text)
    assert program.sweep[1] == pytest.approx(sign * sweep, abs=1e-6)
    assert program.length[1] == pytest.approx(math.hypot(radius * sweep, climb) * 1e-3, rel=1e-6)
    path = to_toolpath(program, 1e-6)
    p = path.p[2:] * 1e3
    angle = np.unwrap(np.arctan2(p[:, second] - centre[1], p[:, first] - centre[0]))
    assert np.hypot(p[:, first] - centre[0], p[:, second] - centre[1]) == pytest.approx(radius, abs=1e-6)
    turned = angle - start_angle - 2 * math.pi * round((angle[0] - start_angle) / (2 * math.pi))
    assert (np.diff(turned) * sign > 0).all()
    assert p[:, third] == pytest.approx(climb * turned / (sign * sweep), abs=1e-6)


@pytest.mark.parametrize("plane", PLANES)
@pytest.mark.parametrize("turns", [1, 3])
def test_full_circles_and_helices_return(plane: int, turns: int) -> None:
    a, b, c, i, j, first, second, third = PLANES[plane]
    program = interpret(f"G21 G{plane} F100\nG3 {i}5 {j}0 {c}-2 P{turns}\nM2\n")
    assert program.sweep[0] == pytest.approx(2 * math.pi * turns)
    assert program.turns[0] == turns
    assert program.length[0] * 1e3 == pytest.approx(math.hypot(10 * math.pi * turns, 2), rel=1e-12)
    lower, upper = program.extents
    assert lower[first] == pytest.approx(0, abs=1e-15)
    assert upper[first] == pytest.approx(0.010)
    assert (lower[second], upper[second]) == pytest.approx((-0.005, 0.005))
    assert lower[third] == pytest.approx(-0.002)


def test_extents_of_an_arc_reach_its_quadrants_only_if_it_passes_them() -> None:
    quarter = interpret("G21 F100\nG0 X10\nG3 X0 Y10 I-10 J0\nM2\n").extents
    assert np.array(quarter) * 1e3 == pytest.approx(np.array([[0, 0, 0], [10, 10, 0]]), abs=1e-12)
    most = interpret("G21 F100\nG0 X10\nG2 X0 Y10 I-10 J0\nM2\n").extents
    assert np.array(most) * 1e3 == pytest.approx(np.array([[-10, -10, 0], [10, 10, 0]]), abs=1e-12)


def test_chord_error_is_kept_and_is_of_second_order() -> None:
    program = interpret("G21 F100\nG3 I50\nM2\n")
    errors, steps = [], []
    for chord_error in (1e-4, 1e-5, 1e-6):
        p = to_toolpath(program, chord_error).p - np.array([0.05, 0, 0])
        middle = np.linalg.norm((p[1:] + p[:-1]) / 2, axis=1)
        errors.append(0.05 - middle.min())
        steps.append(len(p))
        assert errors[-1] <= chord_error
    order = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert order == pytest.approx(-2.0, abs=0.05)


def test_ends_are_exact() -> None:
    path = read_gcode("G21 F100\nG1 X10\nG3 X3.3 Y7.7 R9\nG1 X1\nM2\n")
    assert tuple(path.p[path.block == 3][-1] * 1e3) == pytest.approx((3.3, 7.7, 0), abs=0)


@pytest.mark.parametrize("chord_error", [0.0, -1.0, math.nan, math.inf])
def test_chord_error_must_be_a_length(chord_error: float) -> None:
    with pytest.raises(GCodeError, match="Chord error"):
        turn_counts(np.ones(1), np.ones(1), chord_error)


def test_too_many_turns_are_refused_with_what_would_fit() -> None:
    with pytest.raises(GCodeError, match="so use .* mm or more"):
        read_gcode("G21 F100\nG3 I5000 P10000\nM2\n")


def test_tilted_axis_turns_in_small_steps() -> None:
    path = read_gcode("G21 F100\nG1 X10 A30 B-20\nM2\n")
    a, b = math.radians(30), math.radians(-20)
    assert path.k[-1] == pytest.approx((math.sin(b), -math.sin(a) * math.cos(b), math.cos(a) * math.cos(b)))
    dots = np.einsum("ij,ij->i", path.k[1:], path.k[:-1])
    assert np.degrees(np.arccos(dots)).max() < 3.0


@pytest.mark.parametrize("turns", [3.0, 40.0, 1000.0])
def test_the_chord_error_that_a_refusal_names_is_one_that_fits(turns: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robomill.toolpath.arcs.MAX_POINTS", 100_000)
    sweep, radius = np.array([2 * math.pi * turns, 1.0]), np.array([0.05, 2.0])
    with pytest.raises(GCodeError, match="at most 100000 fit") as refused:
        turn_counts(sweep, radius, 1e-14)
    named = float(str(refused.value).split("use ")[1].split(" mm")[0]) * 1e-3
    whole = turn_counts(sweep, radius, 1.06 * named)  # it is named to two digits
    assert chord_counts(np.zeros(2), sweep, whole).sum() <= 100_000
    with pytest.raises(GCodeError, match="at most 100000 fit"):
        turn_counts(sweep, radius, 0.9 * named)


def sampled(program, row: int, count: int = 200_001) -> np.ndarray:
    """(count, 3) points of an arc from its definition: radius, angle and height all run evenly from start to end."""
    first, second, third = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}[int(program.plane[row])]
    start, end, centre = program.start[row], program.end[row], program.centre[row]
    (u0, v0), (u1, v1) = ((q - centre)[[first, second]] for q in (start, end))
    f = np.linspace(0.0, 1.0, count)
    radius = math.hypot(u0, v0) + f * (math.hypot(u1, v1) - math.hypot(u0, v0))
    angle = math.atan2(v0, u0) + f * program.sweep[row]
    p = np.empty((count, 3))
    p[:, first], p[:, second] = centre[first] + radius * np.cos(angle), centre[second] + radius * np.sin(angle)
    p[:, third] = start[third] + f * (end - start)[third]
    return p


def spiral(r: np.random.Generator) -> str:
    """A program with one arc whose radii differ as far as is allowed, in any plane, somewhere, of any sweep."""
    plane = int(r.choice([17, 18, 19]))
    a, b, c, i, j, *_ = PLANES[plane]
    radius = 10.0 ** r.uniform(-1.3, 4)
    allowed = min(max(0.0282, 1e-3 * radius), 2.8)
    other = max(radius + r.uniform(-1, 1) * allowed * 0.9, 0.02)
    t0, sweep = r.uniform(0, 6.3), r.choice([1e-3, 0.3, 2.0, 4.5, 6.28]) * r.uniform(0.5, 1) * r.choice([-1, 1])
    centre = r.uniform(-500, 500, 2)
    start = centre + radius * np.array([math.cos(t0), math.sin(t0)])
    end = centre + other * np.array([math.cos(t0 + sweep), math.sin(t0 + sweep)])
    turns = f" P{r.integers(1, 4)}" if r.random() < 0.3 else ""
    code = "G2" if sweep < 0 else "G3"
    shift = f"G92 X{r.uniform(-9, 9):.3f} Y3\n" if r.random() < 0.3 else ""
    return (
        f"G21 G{plane} F100\n{shift}G0 {a}{start[0]:.9f} {b}{start[1]:.9f}\n{code} {a}{end[0]:.9f} {b}{end[1]:.9f} "
        f"{c}{r.uniform(-3, 3):.3f} {i}{centre[0] - start[0]:.9f} {j}{centre[1] - start[1]:.9f}{turns}\nM2\n"
    )


@pytest.mark.parametrize("seed", range(60))
def test_extents_length_and_chords_of_spirals_are_those_of_what_is_drawn(seed: int) -> None:
    program = interpret(spiral(np.random.default_rng(seed)))
    points = sampled(program, len(program) - 1)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    missed = steps.max() * 1e-2 + 1e-12  # what the farthest point may lie beyond the nearest sample
    lower, upper = program.extents
    assert lower == pytest.approx(points.min(axis=0), abs=missed)
    assert upper == pytest.approx(points.max(axis=0), abs=missed)
    assert program.length[-1] == pytest.approx(steps.sum(), rel=1e-5)
    chords = to_toolpath(program, 1e-6).p[len(program) - 1 :]  # one point a move before, then the arc's
    assert distance_to_polyline(sampled(program, len(program) - 1, 50_001), chords).max() < 1.02e-6


def distance_to_polyline(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(m,) from each point to the nearest straight piece, both in the order in which they are passed."""
    best = np.full(len(points), np.inf)
    share = np.linspace(0, len(corners) - 1, len(points))
    for shift in (-1, 0, 1):
        k = np.clip(share.astype(int) + shift, 0, len(corners) - 2)
        a, d = corners[k], corners[k + 1] - corners[k]
        t = np.clip(np.einsum("ij,ij->i", points - a, d) / np.einsum("ij,ij->i", d, d), 0, 1)
        best = np.minimum(best, np.linalg.norm(points - a - t[:, None] * d, axis=1))
    return best


def test_the_top_of_a_half_turn_that_grows_narrower() -> None:
    """Radii of 3001.4 and 2998.6 mm: the half turn's top lies between them, not at the start's radius."""
    program = interpret("G21 F100\nG2 X6000 I3001.4\nM2\n")
    points = sampled(program, 0)
    assert program.extents[1][1] == pytest.approx(points[:, 1].max(), abs=1e-9)
    assert program.extents[1][1] * 1e3 == pytest.approx(3000.0, abs=0.01)
    assert program.extents[0] == pytest.approx(points.min(axis=0), abs=1e-9)


@pytest.mark.parametrize("ends", [(10.0, 10.0), (10.0, 4.0), (3.0, 12.0), (1e-3, 8.0)])
@pytest.mark.parametrize("sweep", [1.3, -4.0, 11.0])
def test_the_bend_of_a_spiral_is_the_sagitta_of_a_short_chord(ends, sweep):
    """Where it is widest: eight times how far a short piece stands off its chord, over its angle squared."""
    r0, r1 = ends

    def at(t):  # the radius changes evenly with the angle
        return (r0 + (r1 - r0) * t / sweep) * np.exp(1j * t)

    start, end = (np.array([[z.real, z.imag, 0.0]]) for z in (at(0.0), at(sweep)))
    found = Arcs(start, end, np.zeros((1, 3)), np.array([17]), np.array([sweep])).bend[0]
    h = 1e-3 * np.sign(sweep)
    a = 0.0 if r0 >= r1 else sweep - h
    chord = at(a + h) - at(a)
    points = at(a + h * np.linspace(0, 1, 2001)) - at(a)
    sagitta = np.abs((points * np.conj(chord)).imag).max() / abs(chord)
    assert found == pytest.approx(8.0 * sagitta / h**2, rel=2e-3)


@pytest.mark.parametrize("plane", PLANES)
def test_an_arc_may_leave_a_box_only_where_its_circle_does(plane: int) -> None:
    """A short arc of a circle of radius 2 in the middle of a box of 5 by 5, and pushed towards each side in turn."""
    first, second, third = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}[plane]
    for way in (*np.eye(3), *-np.eye(3)):
        for push, leaves in ((0.0, False), (0.4, False), (0.6, True)):
            centre = 10.0 + push * way
            start, end = centre.copy(), centre.copy()
            start[[first, second]] += [1.2, 1.6]
            end[[first, second]] += [1.6, 1.2]
            arc = Arcs(start[None], end[None], centre[None], np.array([plane]), np.array([-0.2838]))
            expected = leaves and way[third] == 0.0
            assert arc.may_leave(np.full(3, 7.5), np.full(3, 12.5)).tolist() == [expected]


@pytest.mark.parametrize("seed", range(6))
def test_a_programs_extents_are_those_of_its_points(seed: int) -> None:
    """Whichever arc or line reaches farthest on a side."""
    r = np.random.default_rng(seed)
    lines = ["G21 F100"]
    for _ in range(12):
        u, v, w = r.uniform(-9, 9, 3)
        lines.append(f"G17 G{r.choice([0, 1])} X{u:.3f} Y{v:.3f} Z{w:.3f}")
        plane = int(r.choice([17, 18, 19]))
        i, j = PLANES[plane][3:5]
        lines.append(f"G{plane} G{r.choice([2, 3])} {i}{r.uniform(1, 9):.3f} {j}{r.uniform(-9, 9):.3f}")
    program = interpret("\n".join(lines) + "\nM2\n")
    cut = np.flatnonzero(program.kind != 0)
    points = np.concatenate(
        [
            sampled(program, row, 20_001) if program.kind[row] == 2 else [program.start[row], program.end[row]]
            for row in cut
        ]
    )
    lower, upper = program.extents
    np.testing.assert_allclose(lower, points.min(axis=0), atol=1e-9)
    np.testing.assert_allclose(upper, points.max(axis=0), atol=1e-9)


@pytest.mark.parametrize(("code", "second"), [("G2", "G2"), ("G2", "G3"), ("G3", "G3")])
@pytest.mark.parametrize("begun", [37.0, 170.0, 301.3])
def test_a_lap_begun_elsewhere_leaves_nothing_outside_the_lap_before(code: str, second: str, begun: float) -> None:
    """The distance of its corners from the polygon of the first lap: at its own end alone it is a sagitta."""
    x, y = 7.0 * math.cos(math.radians(begun)), 7.0 * math.sin(math.radians(begun))
    laps = f"{code} X7 Y0 Z-1 I-7 J0\n{code} X{x:.3f} Y{y:.3f} I-7 J0\n{second} I{-x:.3f} J{-y:.3f}\nM2\n"
    path = read_gcode(f"G21 F100\nG0 X7\n{laps}")
    first, again = (path.p[path.block == line][:, :2] for line in (3, 5))
    corners = np.vstack([[7e-3, 0.0], first])
    a, way = corners[:-1], np.diff(corners, axis=0)
    share = np.clip(np.einsum("nsi,si->ns", again[:, None] - a, way) / (way**2).sum(axis=1), 0.0, 1.0)
    off = np.linalg.norm(again[:, None] - a - share[:, :, None] * way, axis=2).min(axis=1)
    assert off[-1] < 1.6e-6  # the written end of an arc is rounded by half a micrometre
    assert off[:-1].max() < 0.6e-6
    assert len(again) in (len(first), len(first) + 1)
