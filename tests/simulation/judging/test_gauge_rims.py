"""Single laws of rims: envelopes of sinking cones, distances from a nose's arc, walls that are thin, by brute force."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from robomill.arrays import FloatArray
from robomill.simulation.judging.gauge import SLENDER, Rims, _leads, _normal, _roots, _thin


@dataclass
class Path:
    """As many samples as it has steps."""

    step_length: FloatArray

    def __len__(self) -> int:
        return len(self.step_length)


def rims(q: list[int], height: float, radius: float, deep: float = 2e-3) -> Rims:
    n = len(q)
    u = np.tile([0.0, 1.0, 0.0], (n, 1))
    ones = np.ones(n)
    return Rims(np.array(q), u, ones, 1e-3 * ones, height * ones, radius * ones, deep * ones)


@pytest.mark.parametrize("angle", [60.0, 90.0, 120.0])
@pytest.mark.parametrize("rise", [0.0, 0.1, 0.4])
def test_the_wall_of_a_cone_that_sinks_stands_as_far_out_as_its_widest_circle(angle: float, rise: float) -> None:
    """At a height over the tip the tool behind it is wider: all circles on the way, and the next place beside them."""
    T, height, step = np.tan(np.radians(0.5 * angle)), 2e-3, 0.4e-3
    behind = np.linspace(0.0, 4.0 * height, 40001)
    circle = (T * (height + rise * behind)) ** 2 - behind**2
    widest = np.sqrt(np.maximum(circle, 0.0).max())
    at = SimpleNamespace(
        wider=lambda q, h: np.full(len(q), rise * T),
        i=np.array([3, 5]),
        result=SimpleNamespace(path=SimpleNamespace(step_length=np.where(np.arange(6) == 5, step, 0.0))),
    )
    found = _leads(at, rims([0, 1], height, T * height))  # type: ignore[arg-type]
    np.testing.assert_allclose(found, [widest - T * height, widest - T * height + rise * T * step], atol=1e-9)


@pytest.mark.parametrize("height", [0.2e-3, 1.0e-3, 1.4e-3, 1.6e-3])
@pytest.mark.parametrize("error", [0.1e-3, -0.05e-3])
def test_what_stands_further_out_is_off_a_noses_arc_by_its_distance_from_it(height: float, error: float) -> None:
    """A corner of 1.5 mm on a flat of 2.5 mm; above it the wall is upright, or a cone's that leans."""
    corner, flat = 1.5e-3, 2.5e-3
    radius = flat + np.sqrt(corner**2 - max(corner - height, 0.0) ** 2)
    number = {"conical": 0.0, "nose_height": corner, "flat_radius": flat}
    at = SimpleNamespace(number=lambda name: np.array([number[name]]))
    (found,) = _normal(at, rims([0], height, radius), np.array([error]), np.array([0.9]))  # type: ignore[arg-type]
    if height > corner:
        assert found == pytest.approx(0.9 * error)
        return
    centre, scale = shapely.Point(flat * 1e6, corner * 1e6), 1e6
    arc = shapely.boundary(centre.buffer(corner * scale, quad_segs=4000))
    place = shapely.Point((radius + error) * scale, height * scale)
    outside = place.distance(centre) > corner * scale
    assert found * scale == pytest.approx((1.0 if outside else -1.0) * place.distance(arc), abs=1e-2)


@pytest.mark.parametrize(
    ("cut", "deep", "thin"),
    [
        ([3, 4, 5], 1.9e-3, [3, 4, 5]),  # two steps of 1 mm, as long as it is high
        ([3, 4, 5], 2.1e-3, []),  # a tip
        ([3, 5, 7], 0.5e-3, []),  # single ones
        ([1, 2, 5, 6, 7], 1.5e-3, [5, 6, 7]),
        ([], 1e-3, []),
    ],
)
def test_a_wall_is_thin_where_another_pass_comes_by_over_at_least_its_height(
    cut: list[int], deep: float, thin: list[int]
) -> None:
    m = 9
    asked: dict[str, np.ndarray] = {}

    def walls(lines: np.ndarray, height: np.ndarray, radius: np.ndarray) -> SimpleNamespace:
        asked["behind"], asked["radius"] = lines[:, :3], radius
        return SimpleNamespace(told=np.where(np.isin(np.arange(m), cut), 0.1e-3, np.nan))

    at = SimpleNamespace(
        c=np.column_stack([np.arange(m) * 1e-3, np.zeros(m), np.zeros(m)]),
        axial=np.tile([0.0, 0.0, 1.0], (m, 1)),
        i=np.arange(m),
        outline=SimpleNamespace(walls=walls),
        stands=lambda q, points, height: np.ones(len(q), dtype=bool),
        result=SimpleNamespace(path=Path(np.full(m, 1e-3))),
    )
    found = _thin(at, rims(list(range(m)), 1e-3, 4e-3, deep))  # type: ignore[arg-type]
    assert np.flatnonzero(found).tolist() == thin
    np.testing.assert_allclose(asked["behind"][:, 1], 4e-3 + SLENDER * deep)
    assert not asked["radius"].any()


ASIDE = 0.2e-3


def groove(
    told: Callable[[FloatArray, FloatArray], FloatArray], wider: float = 0.0, left: float = 0.0, up: float = 0.0
) -> object:
    """One place in the groove of a cone of 90 degrees that has gone aside: ``told`` says how high the floors are told
    to be across it and ahead, and ``left`` (m) how high the floor is that is left where its tip really went."""
    rows = np.zeros((1, 3))
    x, y, z = np.eye(3)[:, None]

    def floors(lines: FloatArray, offset: FloatArray, slack: FloatArray) -> tuple[FloatArray]:
        return (told(offset, lines[:, 0]),)

    return SimpleNamespace(
        number=lambda name: np.array([{"conical": 4e-3, "flat_radius": 0.0}[name]]),
        steep=np.array([False]),
        wider=lambda q, height: np.full(len(q), wider),
        profile=lambda q, offset: offset,
        incline=np.zeros(1),
        slope=np.zeros(1),
        i=np.zeros(1, dtype=np.int64),
        c=rows,
        d=np.array([[0.0, ASIDE, up]]),
        feed=x,
        left_of=y,
        axial=z,
        result=SimpleNamespace(path=Path(np.array([1e-3]))),
        outline=SimpleNamespace(floors=floors, left_over=lambda lines: np.array([left])),
    )


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("begin", [0.95, 1.0, 1.1, 1.3, 1.6, 1.74, 2.1])
def test_a_root_is_none_where_somebody_cuts_below_it_up_to_twice_as_far_as_it_has_gone(
    begin: float, side: float
) -> None:
    """A strip on one side, a quarter as wide as that, where both sides are lower than the groove's own."""

    def told(y: FloatArray, x: FloatArray) -> FloatArray:
        strip = (side * y > (begin - 1e-9) * ASIDE) & (side * y < (begin + 0.26) * ASIDE)
        return np.where(strip, -20e-6, 0.5 * np.abs(y))

    roots, lost = _roots(groove(told), np.array([ASIDE]))  # type: ignore[arg-type]
    assert (roots[0], lost[0]) == (begin > 2.0, False)


@pytest.mark.parametrize("wider", [0.0, 0.3, 0.6])
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("over", [8e-6, -8e-6])
def test_a_root_is_one_where_nobody_cuts_below_one_of_its_sides(wider: float, side: float, over: float) -> None:
    """Of a cone that sinks: its groove is an ellipse's across, flatter than itself; the other side is cut away."""
    own = ASIDE * np.sqrt(1.0 - wider**2)

    def told(y: FloatArray, x: FloatArray) -> FloatArray:
        return np.where(side * y > 0.0, own + over, -50e-6)

    roots, _ = _roots(groove(told, wider), np.array([ASIDE]))  # type: ignore[arg-type]
    assert roots[0] == (over > 0.0)


@pytest.mark.parametrize(("left", "lost"), [(-0.12e-3, True), (-0.1e-3, False), (-0.05e-3, False)])
def test_a_root_is_lost_where_another_pass_has_cut_below_where_its_tip_went(left: float, lost: bool) -> None:
    roots, gone = _roots(groove(lambda y, x: np.abs(y), left=left, up=-0.1e-3), np.array([ASIDE]))  # type: ignore[arg-type]
    assert (roots[0], gone[0]) == (True, lost)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("far", "lost"), [(0.6, True), (-0.6, True), (0.2, True), (1.3, False), (-1.3, False)])
def test_a_root_between_others_is_lost_where_they_are_not_alike_as_far_ahead_as_it_has_gone(
    far: float, side: float, lost: bool
) -> None:
    """On one side somebody cuts below it, by more from a place on ahead of it, or behind it."""

    def told(y: FloatArray, x: FloatArray) -> FloatArray:
        beyond = (side * y < 0.0) & (x * np.sign(far) > abs(far) * ASIDE)
        return np.where(beyond, -60e-6, np.where(side * y > 0.0, 0.5 * ASIDE, -40e-6))

    roots, gone = _roots(groove(told), np.array([ASIDE]))  # type: ignore[arg-type]
    assert (roots[0], gone[0]) == (False, lost)
