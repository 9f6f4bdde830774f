"""Engagement of side cuts is arccos at any cell: where material ends is found on the moves and the stock themselves."""

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.surface.contact.engagement import engage
from robomill.surface.contact.march import March
from robomill.surface.stock import Stock

R = 0.004
X = np.linspace(-0.02, 0.02, 81)
PATH = np.column_stack([X, 0 * X, 0 * X - 0.002])


@pytest.mark.parametrize("cell", [1e-3, 4e-4, 1e-4, 5e-5])
def test_side_cut(cell):
    """Material on the right of y = a_e - R only: phi_st = arccos((a_e - R) / R), phi_ex = 180 degrees."""
    for a_e in (0.00005, 0.0013, 0.0021, 0.0037, 0.0052, 0.0066):
        stock = Stock((-0.03, -0.03, -0.01), (0.03, a_e - R, 0.0))
        found = engage(March(stock, cell, Cutter("flat", 2 * R), PATH))
        exact = np.arccos((a_e - R) / R)
        assert abs(found.phi_st[40] - exact) < 1e-3
        assert found.phi_ex[40] == pytest.approx(np.pi)
        assert found.a_p[40] == pytest.approx(0.002)
        assert found.a_e[40] == pytest.approx(a_e, rel=5e-3)
