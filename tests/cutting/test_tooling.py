"""Which cutter makes which step: indices that have a cutter, numbers step by step."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.cutting.tooling import Tooling
from robomill.errors import CuttingError

CUTTERS = (Cutter("flat", 8e-3), Cutter("ball", 6e-3), Cutter("flat", 2e-3))


def test_every_step_has_the_numbers_of_its_cutter():
    of_step = [0, 2, 1, 1, 0]
    tooling = Tooling(CUTTERS, of_step)
    np.testing.assert_array_equal(tooling.each("diameter"), [8e-3, 2e-3, 6e-3, 6e-3, 8e-3])
    found = list(tooling.steps_of_each())
    assert [cutter for cutter, _ in found] == list(CUTTERS)
    np.testing.assert_array_equal(
        [steps for _, steps in found], [[k == n for k in of_step] for n in range(len(CUTTERS))]
    )


@pytest.mark.parametrize(("of_step", "wrong"), [([0, 3, 1], 3), ([0, 1, -1], -1), ([7], 7)])
def test_an_index_without_a_cutter_is_refused(of_step, wrong):
    with pytest.raises(CuttingError, match=f"cutter {wrong}; expected 0 to 2"):
        Tooling(CUTTERS, of_step)
    assert len(Tooling(CUTTERS, [0, 2]).of_step) == 2


def test_one_cutter_serves_every_step():
    one = Tooling.of(CUTTERS[1], 4)
    np.testing.assert_array_equal(one.each("radius"), [3e-3] * 4)
    assert Tooling.of(one, 4) is one
    for m in (3, 5):
        with pytest.raises(CuttingError, match=f"for 4 moves; the path has {m} points"):
            Tooling.of(one, m)
