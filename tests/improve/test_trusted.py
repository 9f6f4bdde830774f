"""Where a correction is good enough to be given out, by the length of the cut that it does for."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import CompensationError
from robomill.improve.correction import Correction
from robomill.improve.trusted import check_found

RUN = rm.simulate(rm.load_setup("paper_flute").replace(step_mm=1))


@pytest.mark.parametrize(("mm", "given_out"), [(0, True), (4, True), (6, False), (50, False)])
def test_no_more_than_a_twentieth_of_the_cut_is_without_a_correction_that_settled(mm: int, given_out: bool) -> None:
    """The slot is 100 mm long, in samples of a millimetre."""
    x = RUN.path.p[:, 0] * 1e3
    held = RUN.path.cutting & (x > 0.5) & (x < mm + 0.5)
    assert held.sum() == mm
    found = Correction(RUN, np.zeros_like(RUN.path.p), RUN, (1e-9,), held)
    if given_out:
        check_found(found, RUN)
        return
    with pytest.raises(CompensationError, match="line 7"):
        check_found(found, RUN)
