"""What is summed up of a gauge's readings, against integrals written out."""

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.improve.errors import errors_of
from robomill.improve.judged import judged

RUN = rm.simulate(rm.load_setup("paper_flute").replace(step_mm=20))


@pytest.mark.parametrize("length", [3.0, 0.0])
def test_a_root_mean_square_is_over_the_length_and_over_the_readings_where_none_has_any(length: float) -> None:
    """The squared error, a step function along the path, by a sum over millimetres."""
    walls = RUN.gauge.walls
    error = np.arange(1.0, len(walls.error) + 1.0) * 1e-5
    each = length * np.arange(1, len(error) + 1)
    steps = np.repeat(error, np.maximum(each, length == 0.0).astype(int))
    gauge = replace(RUN.gauge, walls=replace(walls, error=error, length=each * 1e-3))
    np.testing.assert_allclose(errors_of(RUN, gauge).wall, [error.max(), np.sqrt((steps**2).sum() / len(steps))])


def test_the_feeds_error_is_along_the_way_the_tool_goes_or_of_an_end_whichever_is_more() -> None:
    """The slot is straight: along x of the part."""
    along = np.abs(RUN.delta[RUN.judged] @ RUN.setup.T_MW[:3, 0]).max()
    for ends in (0.0, 2.0 * along):
        error = np.full(len(RUN.gauge.ends.error), -ends)
        gauge = replace(RUN.gauge, ends=replace(RUN.gauge.ends, error=error))
        assert errors_of(RUN, gauge).feed == pytest.approx(max(along, ends), rel=1e-12)


def test_of_what_has_no_reading_there_is_no_error() -> None:
    """A block narrower than the mill has a floor and no wall."""
    narrow = rm.Stock(lower_mm=(-60, -3, -20), upper_mm=(60, 3, 0))
    run = rm.simulate(RUN.setup.replace(stock=narrow))
    found = errors_of(run)
    np.testing.assert_array_equal(found.wall, [np.nan, np.nan])
    floor = (run.delta @ run.setup.T_MW[:3, 2])[run.path.cutting & (np.abs(run.path.p[:, 0]) < 50e-3)]
    assert np.abs(floor).min() - 1e-6 <= found.floor[1] <= found.floor[0] <= np.abs(floor).max() + 1e-6
    assert not len(judged(run, "wall").sample)
    assert len(judged(run, "floor").sample) == len(judged(run).sample) > 0
