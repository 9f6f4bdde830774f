"""Single laws of rims: envelopes of sinking cones, distances from a nose's arc, walls that are thin, by brute force."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from robomill.arrays import FloatArray
from robomill.simulation.judging.gauge import SLENDER, Rims, _leads, _normal, _thin


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
