"""Between which heights the material ends: told of every place as the swept bodies leave it, by their definition."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.surface.contact.march import March
from robomill.surface.contact.material_kernels import cells_around, has_side
from robomill.surface.contact.relief_kernels import AIR, MATERIAL, UNKNOWN, square_about, told, tops_about, tops_between
from robomill.surface.stock import Stock

MM = 1e-3
MILLS = (
    Cutter("flat", 8 * MM),
    Cutter("ball", 8 * MM),
    Cutter("bull", 8 * MM, corner_radius=1.5 * MM),
    Cutter("chamfer", 8 * MM, tip_angle=1.5),
    Cutter("flat", 3 * MM),
)
LOW, HIGH = np.array([-15.0, -12.0, -8.0]) * MM, np.array([15.0, 12.0, 0.0]) * MM


def cut_moves(seed, leaning):
    """Chains of moves, some that bend, some that rise or fall: tips (m, 3) m, tools (m,), axes and which cut."""
    rng = np.random.default_rng(seed)
    p, tool, k, cutting = [], [], [], []
    for chain in range(9):
        corners = np.column_stack(
            [rng.uniform(-17, 17, (4, 2)), rng.choice([-1.0, -2.0, -3.5]) + rng.uniform(-1, 1, 4)]
        )
        if chain % 3 == 0:
            corners[:, 2] = corners[0, 2]
        p += list(corners * MM)
        tool += [rng.integers(len(MILLS))] * 4
        k += [(0.2, -0.1, np.sqrt(1.0 - 0.05)) if leaning and chain == 8 else (0.0, 0.0, 1.0)] * 4
        cutting += [False, True, True, True]
    return np.array(p), np.array(tool), np.array(k), np.array(cutting)


def solid(p, tool, k, cutting, points):
    """Which points (n, 3) m no stamp of a cutter holds, and which hardly any: (left, near) (n,) bool."""
    deep = np.full(len(points), -np.inf)
    for n in np.flatnonzero(cutting):
        cutter = MILLS[tool[n]]
        for share in np.linspace(0.0, 1.0, 400):
            away = points - (p[n - 1] + share * (p[n] - p[n - 1]))
            up = away @ k[n]
            radius = np.linalg.norm(away - up[:, None] * k[n], axis=1)
            inside = radius <= cutter.radius
            height = np.where(inside, up - cutter.profile(np.minimum(radius, cutter.radius)), -np.inf)
            deep = np.maximum(deep, np.minimum(height, cutter.radius - radius))
    return deep < 0.0, np.abs(deep) < 0.1 * MM


@pytest.mark.parametrize("leaning", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_what_is_told_of_places_is_so(seed, leaning):
    p, tool, k, cutting = cut_moves(seed, leaning)
    march = March(Stock(LOW, HIGH), 0.25 * MM, Tooling(MILLS, tool), p, k, cutting)
    state = march._state(march._begins, march._reached)
    for i in march.steps:
        march.cut(i, p[i - 1], p[i])
    relief = march._stepwise[0].relief
    assert relief.tops.shape == state[0].relief.tops.shape
    points = np.random.default_rng(seed).uniform(LOW, HIGH, (1500, 3))
    left, near = solid(p, tool, k, cutting, points)
    said = np.array([told(relief, tops_about(relief, x, y), z, z) for x, y, z in points])
    assert not (said[~near] == np.where(left, AIR, MATERIAL)[~near]).any()
    dexels = march._stepwise[0].dexels
    near = np.array([has_side(dexels, cells_around(dexels, x, y)) for x, y, _ in points])
    about = np.array([square_about(relief, x, y)[2] for x, y, _ in points])
    assert about[near].all()
    assert near.any()
    assert (said == AIR).sum() > 20
    assert leaning or (said == MATERIAL).sum() > 200


def test_about_a_way_no_longer_than_the_margin_allows():
    march = March(Stock(LOW, HIGH), 0.25 * MM, MILLS[0], np.array([[-20.0, 0, -2], [20, 0, -2]]) * MM)
    march.cut(1, march.points[0], march.points[1])
    relief = march._stepwise[0].relief
    assert relief.margin == pytest.approx(0.12 * 4 * MM)
    middle = tops_between(relief, (0.0, -0.4 * MM, 0.0), (0.0, 0.4 * MM, 0.0))
    assert middle == pytest.approx((-2 * MM, -2 * MM))
    assert tops_between(relief, (0.0, -0.5 * MM, 0.0), (0.0, 0.5 * MM, 0.0)) == (-np.inf, np.inf)
    assert told(relief, middle, -1.9 * MM, -1.0 * MM) == AIR
    assert told(relief, middle, -7 * MM, -2.1 * MM) == MATERIAL
    assert told(relief, middle, -3 * MM, -1.0 * MM) == UNKNOWN
    assert told(relief, middle, -8.1 * MM, -7 * MM) == UNKNOWN
    assert tops_about(relief, 16 * MM, 0.0) == (-np.inf, np.inf)
    assert tops_about(relief, 0.0, 10 * MM) == pytest.approx((0.0, 0.0), abs=1e-15)


def test_so_near_to_a_bound_that_rounding_decides_nothing_is_told():
    """Heights of the same plane come out some 1e-16 m apart by different ways; what is 10 nm off is told."""
    relief = (
        March(Stock(LOW, HIGH), 0.25 * MM, MILLS[0], np.array([[-20.0, 0, -2], [20, 0, -2]]) * MM)._stepwise[0].relief
    )
    tops = -2.0 * MM, -1.0 * MM
    for rounding in (-1e-15, 0.0, 1e-15):
        assert told(relief, tops, tops[1] + rounding, 0.0) == UNKNOWN
        assert told(relief, tops, -7 * MM, tops[0] + rounding) == UNKNOWN
    assert told(relief, tops, tops[1] + 1e-8, 0.0) == AIR
    assert told(relief, tops, -7 * MM, tops[0] - 1e-8) == MATERIAL


@pytest.mark.parametrize("turn", [0.0, 0.7, 2.5])
@pytest.mark.parametrize("ends", [(-7.0, -1.0), (-1.0, -7.0), (-4.0, -4.0)])
@pytest.mark.parametrize("cutter", MILLS[:2])
def test_on_a_ramp_the_bounds_hold_where_the_floor_is_the_lowest_of_all_places_of_the_tool(cutter, ends, turn):
    """Along the ramp and up to the radius beside it, by looking at 20 001 places of the tool one by one."""
    way = np.array([np.cos(turn), np.sin(turn)])
    p = np.array([[*(-10 * way), ends[0]], [*(10 * way), ends[1]]]) * MM
    march = March(Stock(LOW, HIGH), 0.25 * MM, cutter, p)
    march.cut(1, p[0], p[1])
    relief = march._stepwise[0].relief
    at = np.linspace(0.0, 1.0, 20_001)[:, None]
    tips = p[0] + at * (p[1] - p[0])
    bounds = []
    for along, aside in np.random.default_rng(3).uniform((-5, -3), (5, 3), (150, 2)) * MM:
        x, y = along * way + aside * np.array([-way[1], way[0]])
        away = np.hypot(x - tips[:, 0], y - tips[:, 1])
        over = away <= cutter.radius
        floor = (tips[over, 2] + cutter.profile(away[over])).min()
        low, high = tops_about(relief, x, y)
        assert low <= floor + 1e-7 <= high + 1e-6
        bounds.append(high - low)
    assert np.median(bounds) < 3 * MM
