"""The force at every sample of level paths: corners, arcs, chords, re-cuts, thin ribs; 5 % of its size is the bar."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

import robomill as rm
from tests.simulation.level_paths import Arc, LevelCut, Line


def ahead(a: tuple[float, float], angle: float, length: float) -> Line:
    turn = math.radians(angle)
    return Line(a, (a[0] + length * math.cos(turn), a[1] + length * math.sin(turn)))


def around(radius: float, angle: float, count: int) -> tuple[Line, ...]:
    turn = np.radians(angle * np.arange(count) - 90.0)
    ends = [(radius * float(c), radius * float(s)) for c, s in zip(np.cos(turn), np.sin(turn), strict=True)]
    return tuple(Line(a, b) for a, b in pairwise(ends))


def walk(seed: int) -> tuple[Line, ...]:
    ends = [(-12.0, -12.0), *(tuple(end) for end in np.random.default_rng(seed).uniform(-14, 14, (7, 2)))]
    return tuple(Line(a, b) for a, b in pairwise(ends))


def along(y: float, end: float = 5.0) -> Line:
    return Line((-30, y), (end, y))


ABOVE = -10 + math.sqrt(96)
CASES = (
    *(LevelCut(f"corner {a}", ((along(-5, 0), ahead((0, -5), a, 12)),)) for a in (20, 45, 90, 120, 150)),
    *(
        LevelCut(
            f"corner {a} of a wall",
            ((along(-5, 0), ahead((0, -5), a, 12)), (along(-4.5, -0.2), ahead((-0.2, -4.5), a, 11))),
        )
        for a in (20, 45, 90, 120, 150)
    ),
    LevelCut(
        "an arc off a slot at 45 degrees",
        ((Line((-30, -10), (-10, -10)), Arc((-10, -10), (10, -10), (0, ABOVE)), Line((10, -10), (30, -10))),),
    ),
    *(LevelCut(f"arc of radius {r}", ((along(0, 0), Arc((0, 0), (0, 2 * r), (0, r))),)) for r in (2, 5, 10)),
    *(
        LevelCut(
            f"0.1 mm off a circle of radius {r}, {name}",
            tuple((way(q), Arc((0, -q), (0, -q), (0, 0))) for q in (r + far, r)),
        )
        for r in (6, 10)
        for name, far, way in (
            ("outside", 0.1, lambda q: along(-q, 0)),
            ("inside", -0.1, lambda q: Line((0, 0), (0, -q))),
        )
    ),
    *(LevelCut(f"chords of {a} degrees", ((along(-r, 0), *around(r, a, 12)),)) for r, a in ((2, 28.6), (10, 5.73))),
    *(
        LevelCut(
            f"0.3 mm off chords of {a} degrees",
            ((along(-r - 0.3, 0), *around(r + 0.3, a, 12)), (along(-r, 0), *around(r, a, 12))),
        )
        for r, a in ((2, 28.6), (4, 14.3), (10, 2))
    ),
    LevelCut("a bend of 8 degrees", ((along(0, 0), ahead((0, 0), 8, 15)),)),
    LevelCut("its own slot, 0.3 mm beside", ((along(0),), (along(0.3),))),
    LevelCut("there and back, 2 mm apart", ((along(0), Line((5, 0), (5, 2)), Line((5, 2), (-15, 2))),)),
    *(LevelCut(f"walk {seed}", (walk(seed),)) for seed in (3, 4)),
)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_force_at_every_sample(case: LevelCut) -> None:
    assert max(case.off(step) for step in (1.0, 0.25)) < 0.05


@pytest.mark.parametrize("case", [CASES[2], CASES[7], CASES[10]], ids=lambda case: case.name)
@pytest.mark.parametrize("step", [2.0, 0.1])
def test_force_at_every_sample_whatever_the_step(case: LevelCut, step: float) -> None:
    assert case.off(step) < 0.05


def test_its_own_slot_again_is_air() -> None:
    """To the very end of it, where its rim stands on the wall that it left."""
    run = rm.simulate(LevelCut("again", ((along(0),), (along(0),))).setup(1.0))
    again = run.path.cutting & (run.path.block == run.path.block[run.path.cutting].max())
    assert again.sum() > 30
    assert not run.F[again].any()


@pytest.mark.parametrize("radius", [0.5, 2.0, 12.0])
def test_a_lap_of_one_circle_begun_elsewhere_is_air(radius: float) -> None:
    """But for its seam, where it stands on the circle and the chords of the lap before do not."""
    q = (radius * math.cos(0.65), radius * math.sin(0.65))
    begin, centre = (0.0, -radius), (0.0, 0.0)
    first = (Line(centre, begin), Arc(begin, begin, centre))
    run = rm.simulate(LevelCut("laps", (first, (Arc(begin, q, centre), Arc(q, q, centre)))).setup(1.0))
    again = run.path.cutting & (run.path.block == run.path.block[run.path.cutting].max())
    force = np.linalg.norm(run.F, axis=1)
    assert again.sum() > 50
    assert (force[again] > 0.0).sum() <= 4
    assert force[again].max() < 0.02 * force[run.path.cutting].max()
