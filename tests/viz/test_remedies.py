"""Pictures of remedies: what is drawn, and what is left out where it would say nothing."""

from __future__ import annotations

import numpy as np

from robomill.viz.remedies import corrected_lines, places_map, spins_map

STATION = np.linspace(0.0, 100.0, 5)
FLAT = np.array([np.full(5, 0.2), np.full(5, -0.1)])


def words(fig: object) -> list[str]:
    return [each["text"] for each in fig.layout.get("annotations", [])]  # type: ignore[attr-defined]


def test_every_line_of_a_correction_is_named_in_the_legend() -> None:
    fig = corrected_lines(STATION, FLAT, 0.0 * FLAT, 1.0, "mm", dark=False)
    assert [trace["name"] for trace in fig.traces] == [
        "across the feed, before",
        "along the axis, before",
        "across the feed, after",
        "along the axis, after",
    ]
    drawn = fig.figure.layout
    assert drawn.showlegend is not False
    assert drawn.margin.autoexpand is not False, "the legend makes its own room"


def test_the_tolerance_stands_where_a_correction_began_near_it() -> None:
    near = corrected_lines(STATION, FLAT, 0.0 * FLAT, 0.3, "mm", dark=False)
    assert words(near) == ["tolerance"]
    assert near.layout["annotations"][0]["y"] == 0.3
    assert words(corrected_lines(STATION, FLAT, 0.0 * FLAT, 1.0, "mm", dark=False)) == []
    assert words(corrected_lines(STATION, np.nan * FLAT, np.nan * FLAT, 0.3, "mm", dark=False)) == []


def test_a_course_of_the_spin_breaks_where_it_goes_round() -> None:
    angle = np.arange(0.0, 360.0, 60.0)
    course = STATION, np.array([340.0, 355.0, 5.0, 20.0, 30.0])
    fig = spins_map(STATION, angle, np.full((5, 6), 50.0), {"now": course, "best": course}, "mm", dark=True)
    line = fig.traces[-1]["y"]
    assert np.isnan(line[1]), "355 to 5 degrees is a step of 10, not one across the whole map"
    assert np.isfinite(line[[0, 2, 3, 4]]).all()
    assert words(fig) == ["<b>now</b>", "<b>best</b>"]


def test_the_limit_is_drawn_only_on_a_map_that_crosses_it() -> None:
    x, y = np.array([0.0, 1.0]), np.array([0.0, 1.0])
    for used, drawn in ((50.0, 0), (120.0, 1)):
        fig = places_map(x, y, np.array([[40.0, 45.0], [np.nan, used]]), [("now", 0.0, 0.0)], "mm", dark=False)
        assert [trace["type"] for trace in fig.traces].count("contour") == drawn
