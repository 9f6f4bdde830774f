"""The chart along the cut and the histogram: what is drawn, in which colour and unit."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.viz.metrology import ProfileCurves, beyond_chart, histogram_figure, profile_figure
from robomill.viz.theme import palette

STATION = np.linspace(0.0, 100.0, 5)


def curves(offset, floor, **more):
    return ProfileCurves(STATION, np.array(offset), np.array(floor), "mm", 0.3, 0.2, **more)


def chart(made, dark=False):
    return profile_figure(made, np.arange(5), 50.0, dark=dark)


@pytest.mark.parametrize("dark", [False, True])
def test_the_tolerance_is_grey_and_curves_are_solid(dark):
    p = palette(dark)
    fig = chart(curves([0.2] * 5, [-0.1] * 5), dark)
    by_name = {trace["name"]: trace["line"] for trace in fig.traces}
    assert by_name["centre offset"]["color"] == p.accent
    assert by_name["floor"]["color"] == p.text
    assert not any("dash" in by_name[name] for name in ("centre offset", "floor"))
    levels = {shape["y0"]: shape["line"]["color"] for shape in fig.layout["shapes"] if shape["type"] == "line"}
    assert {levels[place] for place in (0.3, -0.3, 0.2, -0.2)} == {p.muted}
    words = {each["text"] for each in fig.layout["annotations"]}
    assert {"+ walls", "− walls", "+ floors", "− floors"} <= words
    assert not {p.warm, p.bad, p.caution} & {str(line["color"]) for line in by_name.values()}


def test_what_is_further_out_than_twice_the_tolerance_is_counted_not_drawn():
    made = curves([0.1, 0.1, 3.0, 0.1, np.nan], [0.0, -0.7, 0.0, 0.0, np.nan])
    fig = chart(made)
    assert beyond_chart(made) == 2
    assert fig.layout["yaxis"]["range"] == pytest.approx([-0.6, 0.6])
    assert "2 beyond" in {each["text"] for each in fig.layout["annotations"]}
    assert not any("beyond" in each["text"] for each in chart(curves([0.1] * 5, [0.0] * 5)).layout["annotations"])


def test_a_curve_without_a_number_is_left_out():
    fig = chart(curves([np.nan] * 5, [-0.1] * 5))
    assert [trace["name"] for trace in fig.traces] == ["floor"]
    assert fig.layout["showlegend"], "plotly leaves out the key of a single curve"
    assert fig.layout["yaxis"]["title"]["text"] == "Floor error, mm"
    limits = {each["text"]: each["y"] for each in fig.layout["annotations"] if "tolerance" in each["text"]}
    assert limits == {"+ tolerance": 0.2, "− tolerance": -0.2}, "the floor's own"
    both = chart(curves([0.1] * 5, [-0.1] * 5)).layout
    assert both["yaxis"]["title"]["text"] == "Error across the cut, mm"


def test_the_histogram_counts_in_the_unit_of_the_view():
    edges, limits = np.linspace(-0.012, 0.012, 9), np.array([0.0118, 0.0118])
    share = {"walls": np.full(8, 10.0), "floors": np.full(8, 2.5)}
    fig = histogram_figure(edges, share, limits, "in", dark=False)
    assert [trace["name"] for trace in fig.traces] == ["walls", "floors"]
    assert fig.layout["xaxis"]["title"]["text"] == "Error, in"
    assert " in<br>" in fig.traces[0]["hovertemplate"]
    assert "mm" not in str(fig.layout) + fig.traces[0]["hovertemplate"]


def test_between_the_places_of_a_path_that_turns_nothing_is_drawn() -> None:
    """Straight lines between 21 of them over 5 m of path read as a floor that climbs."""
    made = chart(curves([0.1] * 5, [-0.1] * 5, joined=False))
    drawn = [trace for trace in made.traces if trace.get("name") in ("centre offset", "floor")]
    assert [trace["mode"] for trace in drawn] == ["markers", "markers"]
