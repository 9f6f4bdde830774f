"""What the paper sets: its box has the size of Fig. 3 and holds the milling test, which lies in its middle plane."""

from __future__ import annotations

import numpy as np

from robomill.paper import BOX, BOX_SIZE, SLOT


def test_the_box_is_as_large_as_fig_3_says_and_holds_the_milling_test():
    low, high = np.array(BOX)
    np.testing.assert_allclose(high - low, BOX_SIZE)
    np.testing.assert_allclose(BOX_SIZE, [1.2, 0.6, 0.5])
    assert low[0] == -high[0]
    assert (low < SLOT.point).all()
    assert (SLOT.point < high).all()
    assert (0.5 * (low + high))[:2].tolist() == list(SLOT.point[:2])
