"""Thin ribs between earlier passes, met by mills of every kind, upright and leaning: the force against brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robomill.arrays import FloatArray
from robomill.cutting.profile_kernels import stretch_ends
from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.surface.contact.engagement import engage
from robomill.surface.contact.march import March
from robomill.surface.contact.material_kernels import World
from robomill.surface.contact.rib_kernels import (
    COLUMNS,
    HEIGHT,
    PITCH,
    RADIUS,
    SEEN,
    UNASKED,
    WHOLE,
    Walk,
    fine_pitch,
    first_change,
    look_about,
    pace,
    walk_on,
)
from robomill.surface.contact.step_kernels import Step, step_at
from robomill.surface.contact.turn_kernels import ANGLES, PHI
from robomill.surface.stock import Stock
from tests.cutting.brute_force import UPRIGHT, Cut, Floats, Move, axis, box, in_tool_axes
from tests.simulation.cuts import AL7075, BALL, BULL, CHAMFER, FEED, FLAT, MM

LOW, HIGH = np.array([-30.0, -30.0, -8.0]) * MM, np.array([30.0, 30.0, 0.0]) * MM
UP = np.array([0.0, 0.0, 1.0])


def past(width: float, aside: float, angle: float) -> list[np.ndarray]:
    """Ends (2, 3) m of two slots 8 mm wide that leave a rib so wide (mm) between them; its middle goes through
    (0, aside) mm, turned so many degrees from X."""
    way = np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle)), 0.0])
    middle, left = np.array([0.0, aside, -2.0]), np.array([-way[1], way[0], 0.0])
    far = 4.0 + 0.5 * width
    return [np.array([middle + q * left - 60 * way, middle + q * left + 60 * way]) * MM for q in (far, -far)]


def off(cutter: Cutter, width: float, aside: float, angle: float) -> float:
    """The largest error of the force on some steps along X through the rib, as a share of the largest one."""
    x = np.arange(-40.0, 6.0, 0.5) if angle == 0.0 else np.arange(-12.0, 6.0, 0.37)
    steps = np.column_stack([x, np.zeros_like(x), np.full_like(x, -2.0)]) * MM
    slots = past(width, aside, angle)
    p = np.concatenate([*slots, steps])
    cutting = np.ones(len(p), dtype=bool)
    cutting[[0, 2, 4]] = False
    tool = np.array([0, 0, 0, 0, *np.ones(len(steps), dtype=int)])
    part = engage(March(Stock(LOW, HIGH), 1e-4, Tooling((FLAT, cutter), tool), p, None, cutting)).part
    found = part.force(AL7075, cutter, np.full(len(p), FEED))[4:]
    asked = np.flatnonzero((x > -6.0) & (x < 4.0))[::2]
    moves = tuple(Move(FLAT, *slot, UP) for slot in slots)
    ahead = np.array([1.0, 0.0, 0.0])
    truth = []
    for i in asked:
        cut = Cut(box(LOW, HIGH), (*moves, Move(cutter, steps[0], steps[i - 1], UP)), 5 * MM, 20_000)
        truth.append(cut.mean_force(cutter, AL7075, steps[i] - 1e-6 * ahead, FEED * ahead, UP))
    size = max(1.0, float(np.linalg.norm(truth, axis=1).max()))
    return float(np.linalg.norm(found[asked] - np.array(truth), axis=1).max() / size)


RIBS = {"from its end": (0.0, 0.0), "from its end, aside": (2.3, 0.0), "from the side": (0.0, 90.0)}
RIBS |= {"at 30 degrees": (0.0, 30.0), "at 70 degrees": (0.5, 70.0)}


@pytest.mark.parametrize("place", RIBS)
@pytest.mark.parametrize("width", [0.1, 0.3, 0.5])
def test_force_of_a_rib(width: float, place: str) -> None:
    assert off(FLAT, width, *RIBS[place]) < 0.05


ROUND = {"ball": (BALL, UPRIGHT), "bull": (BULL, UPRIGHT), "chamfer": (CHAMFER, UPRIGHT)}
LEANING = {"flat, A 10": (FLAT, axis(A=10)), "ball, A 10": (BALL, axis(A=10)), "flat, B 10": (FLAT, axis(B=10))}
PLACES = {"along, aside": (-2.3, 0.0), "along, less aside": (0.9, 0.0), "oblique": (0.4, 28.6), "across": (-1.6, 90.0)}


def once(mill: tuple[Cutter, Floats], width: float, place: tuple[float, float], cell: float) -> float:
    """The error of the force 3 mm deep in one rib, as a share of that force."""
    cutter, k = mill
    aside, angle = place
    slots = [slot - np.array([0.0, 0.0, 2.0]) * MM for slot in past(width, aside if angle < 90.0 else 0.0, angle)]
    end = np.array([0.0 if angle < 90.0 else aside, 0.0, -3.0]) * MM  # an upright rib stands so far ahead
    start = end - np.array([40.0 if angle < 90.0 else 6.0, 0.0, 0.0]) * MM
    p, cutting = np.array([*slots[0], *slots[1], start, end]), np.tile([False, True], 3)
    tooling, axes = Tooling((FLAT, cutter), np.array([0, 0, 0, 0, 1, 1])), np.array([UP] * 4 + [k, k])
    part = engage(March(Stock(LOW, HIGH), cell * MM, tooling, p, axes, cutting)).part
    found = part.force(AL7075, cutter, np.full(len(p), FEED))[-1]
    moves = tuple(Move(FLAT, *slot, UP) for slot in slots)
    ahead = np.array([1.0, 0.0, 0.0])
    cut = Cut(box(LOW, HIGH), (*moves, Move(cutter, start, end - 1e-8 * ahead, k)), 7 * MM, 200_000)
    truth = in_tool_axes(cut.mean_force(cutter, AL7075, end, FEED * ahead, k), ahead, k)
    return float(np.linalg.norm(found - truth) / max(1.0, float(np.linalg.norm(truth))))


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("width", [0.1, 0.25, 0.5])
@pytest.mark.parametrize("mill", ROUND | LEANING)
def test_force_of_a_rib_on_a_nose_or_a_leaning_flank(mill: str, width: float, place: str) -> None:
    assert once((ROUND | LEANING)[mill], width, PLACES[place], 0.1) < 0.06  # brute force is known to 1 %


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("mill", {"flat": (FLAT, UPRIGHT)} | ROUND | LEANING)
def test_force_of_a_rib_that_is_thinner_than_a_cell(mill: str, place: str) -> None:
    assert once(({"flat": (FLAT, UPRIGHT)} | ROUND | LEANING)[mill], 0.1, PLACES[place], 0.5) < 0.06


def looking(k: Floats, v: Floats, tip: Floats) -> tuple[World, Step, FloatArray]:
    """An uncut block, a step in it and the rows of both half turns."""
    p = np.array([[-50.0, 0.0, 0.0], [50.0, 0.0, 0.0]]) * MM
    world, room = March(Stock(LOW, HIGH), 0.5 * MM, FLAT, p, k)._stepwise
    return world, step_at(tip, k, v, np.zeros(3), (0.0, 1), np.zeros(3)), room.rows


def walking(world: World, circle: tuple[float, float], plain: bool) -> Walk:
    """A walk along one circle (radius, height) m."""
    circles = np.zeros((1, COLUMNS))
    circles[0, RADIUS], circles[0, HEIGHT] = circle
    angle = PITCH * min(world.dexels.dx, world.dexels.dy) / circle[0]
    return Walk(circles, 1, pace(angle), pace(fine_pitch(world) / circle[0]), plain, math.inf, circle[0])


@pytest.mark.parametrize(("sense", "level"), [(1.0, 0.0), (-1.0, 0.0), (-1.0, -8.0)])
def test_what_is_told_of_a_whole_gap_holds_at_every_angle_in_it(sense: float, level: float) -> None:
    """A circle of a leaning tool whose highest or lowest point just passes the top or the bottom of a block."""
    rng, told, share = np.random.default_rng(5), 0, np.linspace(0.0, 1.0, 101)
    for _ in range(60):
        k = axis(A=rng.uniform(-40, 40), B=rng.uniform(-40, 40))
        v = np.cross(k, rng.normal(size=3))
        world, step, rows = looking(k, v / np.linalg.norm(v), np.zeros(3))
        r, t = rng.uniform(1.0, 4.0) * MM, rng.uniform(0.0, 1.0) * MM
        furthest = sense * r * math.hypot(k[0], k[1]) + t * k[2]
        step = step._replace(z=level * MM - furthest + sense * rng.uniform(-1.0, 4.0) * 5e-6)
        walk = walking(world, (r, t), False)
        look_about(world, step, walk, rows, 2)
        for row in (n for n in range(1, 2 * ANGLES) if n != ANGLES and walk.circles[0, WHOLE + n] != UNASKED):
            phi = rows[row - 1, PHI] + share * (rows[row, PHI] - rows[row - 1, PHI])
            z = step.z + t * step.kz + r * (np.sin(phi) * step.fz + np.cos(phi) * step.lz)
            assert ((z > LOW[2]) & (z < 0.0) == (walk.circles[0, WHOLE + row] > 0.5)).all()
            told += 1
    assert told > 1000


def test_circles_are_walked_wherever_one_of_them_dips_below_the_top_of_the_stock() -> None:
    """Tools that lean, their tips a little over the top or under it; the circles are laid out point by point."""
    rng, phi, seen = np.random.default_rng(3), np.linspace(0.0, 2 * math.pi, 721), {True: 0, False: 0}
    shapes = [cutter.solid for cutter in (FLAT, BALL, BULL, CHAMFER)]
    for n in range(200):
        shape, k = shapes[n % 4], axis(A=rng.uniform(-40, 40), B=rng.uniform(-40, 40))
        v = np.cross(k, rng.normal(size=3))
        world, step, _ = looking(k, v / np.linalg.norm(v), np.array([0.0, 0.0, rng.uniform(-1.0, 1.3) * shape.R]))
        stretches = np.array([stretch_ends(shape, stretch, 5 * MM) for stretch in range(3)])
        walk = walk_on(world, shape, step, stretches, np.zeros((12, COLUMNS)))
        across = np.array([step.fz, step.lz]) @ [np.sin(phi), np.cos(phi)]
        lowest = min(step.z + t * k[2] + r * across.min() for r, t in walk.circles[:, [RADIUS, HEIGHT]])
        if lowest < -1e-9:
            assert walk.used > 0
        if step.z > shape.R:
            assert walk.used == 0
        seen[walk.used > 0] += step.z > 0.0  # the heel is in the stock, the tip is not
    assert min(seen.values()) > 20


@pytest.mark.parametrize("leans", [0.0, 20.0])
def test_the_circles_that_are_walked_lie_on_the_cutter_up_to_the_height_that_cuts(leans: float) -> None:
    """A ball's on its sphere and above it on the flank, a flat mill's on its flank and its end, both to 5 mm."""
    k = axis(A=leans)
    for cutter in (BALL, FLAT):
        R = cutter.radius
        world, step, _ = looking(k, np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -0.5 * R]))
        stretches = np.array([stretch_ends(cutter.solid, stretch, 5 * MM) for stretch in range(3)])
        walk = walk_on(world, cutter.solid, step, stretches, np.zeros((12, COLUMNS)))
        assert walk.used > (2 if leans else 0)
        for r, t in walk.circles[: walk.used, [RADIUS, HEIGHT]]:
            assert 0.0 <= t <= 5 * MM
            if cutter is BALL:
                assert math.hypot(r, min(t - R, 0.0)) == pytest.approx(R)
            else:
                assert r == pytest.approx(R) or (t == 0.0 and 0.0 <= r < R)


@pytest.mark.parametrize("seed", range(8))
def test_where_no_side_passes_a_change_is_looked_for_from_cell_to_cell(seed: int) -> None:
    """Single columns that stand higher, somewhere under a circle: met at the first of the places a pitch apart."""
    rng, circle = np.random.default_rng(seed), (3.7 * MM, 0.0)
    world, step, _ = looking(UP, np.array([0.6, 0.8, 0.0]), np.array([1.1, -2.3, -3.0]) * MM)
    tops = world.dexels.heights[..., 0]
    tops[:] = np.where(rng.random(tops.shape) < 0.1, -1.0 * MM, -2.0 * MM)
    walk = walking(world, circle, True)

    def length(phi: float) -> float:
        x, y, z = (step[n] + circle[0] * (math.sin(phi) * step[3 + n] + math.cos(phi) * step[6 + n]) for n in range(3))
        i, j = (round((at - low) / 0.5e-3 - 0.5) for at, low in zip((x, y), LOW[:2]))
        return float(tops[i, j]) - z

    met = 0
    for begin in np.arange(0.1, 6.0, 0.4):
        rows = np.array([[phi, math.sin(phi), math.cos(phi)] for phi in (begin, begin + 1.3)])
        ends = length(begin), length(begin + 1.3)
        walk.circles[0, [SEEN, SEEN + 1]] = ends
        places = np.arange(begin + walk.coarse[0], begin + 1.3, walk.coarse[0])
        truth = [phi for phi in places if min(abs(length(phi) - end) for end in ends) > 0.5 * MM]
        found = first_change(world, step, walk, 0, (rows[0], 0, 1, begin + 1.3, begin + 1.3))
        assert found == pytest.approx(truth[0] if truth else begin + 1.3, abs=1e-9)
        met += len(truth) > 0
    assert met > 2
