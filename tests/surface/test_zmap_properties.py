"""Properties that hold for any path: material only goes, order and mirror do not matter."""

import numpy as np
from hypothesis import given, settings, strategies as st

from robomill.cutting.tool import Cutter
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
