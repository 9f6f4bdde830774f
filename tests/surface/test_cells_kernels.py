"""Cells that an edge crosses: the share of them that is covered, measured by area."""

import numpy as np
import pytest
import shapely
import shapely.affinity

from robomill.surface.cells_kernels import covered_share, note_share, union_share


def test_covered_share_is_an_area():
    rng = np.random.default_rng(11)
    u, v = (np.arange(1000) + 0.5) / 1000 - 0.5, (np.arange(1000) + 0.5) / 1000 - 0.5
    for _ in range(30):
        dx, dy, angle, d = rng.uniform(0.5, 2), rng.uniform(0.5, 2), rng.uniform(0, 7), rng.uniform(-1, 1)
        n = np.cos(angle), np.sin(angle)
        expected = (u[:, None] * dx * n[0] + v[None, :] * dy * n[1] <= d).mean()
        share = covered_share(d, *n, dx, dy)
        assert share == pytest.approx(expected, abs=2e-3)


def half_plane(d, angle, reach=5.0):
    """The inner side of an edge whose outward normal has this angle, ``d`` from the origin."""
    square = shapely.box(-reach, -reach, d, reach)
    return shapely.affinity.rotate(square, angle, origin=(0, 0), use_radians=True)


@pytest.mark.parametrize("turn", [np.pi, np.pi / 2, 0.3, 0.0])
def test_two_edges_of_a_cell_cover_their_union(turn):
    """Opposite walls add up, crossing ones overlap as if independent, and one wall cut again counts once."""
    cell, angle = shapely.box(-0.5, -0.5, 0.5, 0.5), 0.0
    for d, e in ((-0.2, -0.1), (-0.1, -0.4), (0.1, -0.3)):
        record = np.zeros(11)
        edges = ((d, angle), (e, angle + turn))
        for depth, a in edges:
            note_share(record, covered_share(depth, np.cos(a), np.sin(a), 1.0, 1.0), (np.cos(a), np.sin(a), depth))
        one, two = (half_plane(depth, a).intersection(cell) for depth, a in edges)
        both = one.union(two).area
        expected = max(one.area, two.area) if turn == 0.3 else both
        assert union_share(record) == pytest.approx(expected, abs=1e-12)
