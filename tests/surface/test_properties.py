"""Properties that hold for any path: material only goes, order and mirror do not matter."""

from itertools import pairwise

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robomill.cutting.tool import Cutter
from robomill.surface.passes import Passes, joined
from robomill.surface.stock import Stock
from robomill.surface.zmap import cut

STOCK = Stock((-0.012, -0.009, -0.01), (0.012, 0.009, 0.0))
CELL = 5e-4
CUTTERS = (
    Cutter("flat", 0.006),
    Cutter("ball", 0.006),
    Cutter("bull", 0.006, corner_radius=0.001),
    Cutter("chamfer", 0.006, tip_angle=1.2, tip_diameter=0.001),
)

steps = st.integers(-6, 6).map(lambda n: n * 1.7e-3)
points = st.tuples(steps, steps, st.integers(-8, -1).map(lambda n: n * 4e-4))
paths = st.lists(points, min_size=2, max_size=6, unique=True).map(np.array)
few = settings(max_examples=25, deadline=None)


@few
@given(paths, st.sampled_from(CUTTERS))
def test_more_cutting_never_adds_material(p, cutter):
    less = cut(STOCK, CELL, cutter, p[:2], must_touch=False)
    more = cut(STOCK, CELL, cutter, p, must_touch=False)
    assert (more.z <= less.z + 1e-15).all()
    assert more.removed_volume >= less.removed_volume - 1e-13
    assert 0.0 <= more.removed_volume <= np.prod(STOCK.size)


@few
@given(paths, st.sampled_from(CUTTERS))
def test_a_mirrored_path_cuts_a_mirrored_part(p, cutter):
    there = cut(STOCK, CELL, cutter, p, must_touch=False)
    back = cut(STOCK, CELL, cutter, p * [1, -1, 1], must_touch=False)
    np.testing.assert_allclose(back.z, there.z[:, ::-1], atol=1e-9)


@few
@given(paths, st.integers(2, 9))
def test_joined_moves_are_the_undivided_path(p, pieces):
    t = np.arange(pieces) / pieces
    divided = np.vstack([*(a + t[:, None] * (b - a) for a, b in pairwise(p)), p[-1:]])
    ends = np.hstack([divided[:-1], divided[1:]])
    whole, _ = joined(Passes(ends, np.tile([0.0, 0.0, 1.0], (len(ends), 2))))
    assert len(whole) <= len(p) - 1
    np.testing.assert_array_equal(whole[0, :3], p[0])
    np.testing.assert_array_equal(whole[-1, 3:], p[-1])
    turning = np.tile([0.0, 0.0, 1.0], (len(ends), 2))
    turning[:, 3] = np.arange(len(ends)) * 1e-3
    assert len(joined(Passes(ends, turning)).ends) == len(ends)
