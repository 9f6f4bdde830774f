"""A stock in another unit than its program is suspected; one that fits, or that nothing would make fit, is not."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.surface.stock import Stock
from robomill.surface.stock_unit import unit_doubt

#: 90 x 60 mm of pocket in a block of 101.6 x 76.2 x 25.4 mm
POCKET = np.array([[0.005, 0.008, -2e-3], [0.095, 0.008, -2e-3], [0.095, 0.068, -2e-3], [0.005, 0.068, -2e-3]])
CUTTING = np.array([False, True, True, True])
TRUE = np.array([0.1016, 0.0762, 0.0254])


def block(times: float) -> Stock:
    return Stock((0.0, 0.0, -TRUE[2] * times), (TRUE[0] * times, TRUE[1] * times, 0.0))


@pytest.mark.parametrize(
    ("times", "said"),
    [
        (1.0, ""),
        (1 / 25.4, "inches read as millimetres"),
        (0.1, "centimetres read as millimetres"),
        (1e-3, "metres read as millimetres"),
        (25.4, "millimetres read as inches"),
        (1000.0, "millimetres read as"),
    ],
)
def test_the_unit_that_would_fit_is_named_with_both_extents(times: float, said: str) -> None:
    doubt = "".join(finding.message for finding in unit_doubt(block(times), POCKET, CUTTING))
    assert said in doubt
    assert bool(doubt) == bool(said)
    if said and times != 1000.0:
        assert "101.6 x 76.2 x 25.4 mm" in doubt


def test_a_path_that_overruns_the_block_is_enough_where_hardly_any_of_it_meets_the_block_as_it_is() -> None:
    """A slot from -200 to 200 mm through 300 x 200 x 40 mm, said in inches: three quarters of it would be held."""
    size = np.array([0.3, 0.2, 0.04])
    across = np.array([[-0.2, 0.0, -2e-3], [0.2, 0.0, -2e-3]])
    for times, said in ((1 / 25.4, "inches read as millimetres"), (1.0, "")):
        half = 0.5 * times * size
        found = unit_doubt(Stock((-half[0], -half[1], -2 * half[2]), (half[0], half[1], 0.0)), across, CUTTING[:2])
        assert said in "".join(finding.message for finding in found)
        assert bool(found) == bool(said)


def test_a_block_beside_the_path_is_not_a_matter_of_units() -> None:
    away = Stock((-0.3, -0.3, -0.01), (-0.2, -0.2, 0.0))
    assert unit_doubt(away, POCKET, CUTTING) == ()
    assert unit_doubt(block(0.7), POCKET, CUTTING) == ()
    assert unit_doubt(block(1 / 25.4), POCKET, np.zeros(4, bool)) == ()
