"""What the pictures of an uncertainty draw, against numbers whose distribution is known."""

import numpy as np
import pytest

from robomill.viz.unsure import distribution, tornado_bars


def test_the_bars_of_a_distribution_are_shares_of_all_draws() -> None:
    used = np.random.default_rng(1).normal(80.0, 10.0, 20_000)
    used[:1000] = np.nan  # a twentieth is not reached
    fig = distribution(used, 80.0, 96.4, dark=False)
    bars = next(trace for trace in fig.traces if trace["type"] == "bar")
    assert float(np.sum(bars["y"])) == pytest.approx(95.0, abs=0.2)
    peak = float(np.asarray(bars["x"])[np.argmax(bars["y"])])
    assert peak == pytest.approx(80.0, abs=4.0)
    lines = [trace for trace in fig.traces if trace["type"] == "scatter"]
    assert [trace["x"][0] for trace in lines] == [80.0, 96.4, 100.0]


def test_the_whole_tolerance_is_not_drawn_where_it_lies_far_beyond() -> None:
    fig = distribution(np.linspace(5.0, 10.0, 100), 7.0, 9.5, dark=True)
    assert [trace["x"][0] for trace in fig.traces if trace["type"] == "scatter"] == [7.0, 9.5]


@pytest.mark.parametrize("now", [50.0, 99.0])
def test_the_names_of_lines_stand_within_the_picture(now: float) -> None:
    """A name beside a line in the right third stands to its left: there is no room on the other side."""
    fig = distribution(np.linspace(40.0, 108.0, 1000), now, 104.0, dark=False).figure
    sides = {note.text: note.xanchor for note in fig.layout.annotations}
    assert sides == {
        "<b>predicted</b>": "left" if now < 80.0 else "right",
        "<b>95 %</b>": "right",
        "<b>tolerance</b>": "right",
    }


def test_a_tornados_bars_reach_from_the_smaller_end_to_the_larger() -> None:
    low, high = np.array([90.0, 70.0]), np.array([60.0, 85.0])
    bars = tornado_bars(["one", "two"], low, high, 76.0, dark=False).traces[0]
    np.testing.assert_allclose(bars["base"], [60.0, 70.0])
    np.testing.assert_allclose(bars["x"], [30.0, 15.0])
    assert list(bars["y"]) == ["one", "two"]
