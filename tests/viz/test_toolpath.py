"""Pictures of toolpaths: what is thinned still looks like all of it, peaks stay, the caption is honest."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.units import format_short_count
from robomill.viz.path_picture import BUDGET, PathPicture, decimate
from robomill.viz.theme import CIVIDIS
from robomill.viz.toolpath import plan_picture, turnable_picture


def long_path(m: int = 120_000) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    t = np.linspace(0, 60 * np.pi, m)
    points = np.column_stack([100 * np.cos(t) * t / t[-1], 60 * np.sin(t) * t / t[-1], -t / t[-1]])
    cutting = np.ones(m, dtype=bool)
    cutting[0] = False
    cutting[m // 3 : m // 3 + 40] = False
    return points, cutting, np.ones(m, dtype=bool)


def test_short_paths_are_drawn_as_they_are() -> None:
    p, c, r = long_path(500)
    assert decimate(p, c, r, 20_000).tolist() == list(range(500))
    assert PathPicture(p, c, r, np.arange(500)).caption == ""


def test_a_thinned_path_stays_within_a_pixel_of_the_whole() -> None:
    """No point is farther from the drawn segment it belongs to than a thousandth of the picture (brute force)."""
    p, c, r = long_path()
    kept = decimate(p, c, r, BUDGET)
    assert 0.4 * BUDGET < len(kept) <= BUDGET
    at = np.clip(np.searchsorted(kept, np.arange(len(p)), side="right") - 1, 0, len(kept) - 2)
    a, b = p[kept[at]], p[kept[at + 1]]
    u = b - a
    share = np.clip(np.einsum("ij,ij->i", p - a, u) / np.maximum(np.einsum("ij,ij->i", u, u), 1e-300), 0, 1)
    assert np.linalg.norm(p - a - share[:, None] * u, axis=1).max() < 1e-3 * np.ptp(p, axis=0).max()
    assert {0, len(p) - 1} <= set(kept.tolist())


def test_ends_of_rapids_and_what_must_be_seen_stay() -> None:
    p, c, r = long_path()
    kept = set(decimate(p, c, r, BUDGET, [777]).tolist())
    change = np.flatnonzero(c[1:] != c[:-1])
    assert set(change.tolist()) | set((change + 1).tolist()) | {777} <= kept


def test_a_path_that_changes_all_the_time_still_fits() -> None:
    p, _, r = long_path()
    c = np.arange(len(p)) % 2 == 0
    assert len(decimate(p, c, r, BUDGET)) <= BUDGET


def test_a_path_on_one_spot_has_its_ends() -> None:
    p = np.zeros((50_000, 3))
    kept = decimate(p, np.ones(50_000, dtype=bool), np.ones(50_000, dtype=bool), 1000)
    assert {0, 49_999} <= set(kept.tolist())


def test_the_caption_counts_segments() -> None:
    p, c, r = long_path()
    picture = PathPicture(p, c, r, np.arange(len(p)), total=812_000)
    assert (
        picture.caption
        == f"Showing {format_short_count(len(picture.kept) - 1)} of 812k segments; results use all of them."
    )
    assert [format_short_count(n) for n in (12, 9_999, 20_000, 812_345, 999_500, 1_234_567)] == [
        "12",
        "9999",
        "20k",
        "812k",
        "1.0M",
        "1.2M",
    ]


def test_a_peak_between_drawn_points_keeps_its_colour() -> None:
    """One sample above the limit, not drawn itself: its segment is still marked as above the limit."""
    p, c, r = long_path()
    kept = decimate(p, c, r, BUDGET)
    hidden = int(np.setdiff1d(np.arange(len(p)), kept)[5000])
    value = np.full(len(p), 0.1)
    value[hidden] = 0.9
    fig = plan_picture(PathPicture(p, c, r, np.arange(len(p)), value=value, limit=0.5, unit="mm"), dark=False)
    above = [t for t in fig.figure.data if t.name == "above 0.5 mm"]
    assert len(above) == 1
    assert np.isfinite(np.asarray(above[0].x, dtype=float)).sum() == 2


@pytest.mark.parametrize("dark", [False, True])
def test_lines_have_gaps_where_the_tool_is_lifted(dark: bool) -> None:
    p = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 0], [3, 3, 0]], dtype=float)
    cutting = np.array([False, True, True, False, True])
    picture = PathPicture(p, cutting, np.ones(5, dtype=bool), np.arange(5), selected=2, length_unit="mm")
    fig = plan_picture(picture, dark=dark)
    line = next(t for t in fig.figure.data if t.name == "in reach")
    np.testing.assert_array_equal(np.isnan(np.asarray(line.x, dtype=float)), [False, False, False, True, False, False])
    assert [t.name for t in fig.figure.data if t.name == "line 2"] == ["line 2"]
    solid, times = turnable_picture(picture, dark=dark)
    assert times >= 1
    assert any(t.name == "in reach" for t in solid.figure.data)


def test_what_is_out_of_reach_is_counted_in_the_legend() -> None:
    p, c, r = long_path(3000)
    r[100:140] = False
    fig = plan_picture(PathPicture(p, c, r, np.arange(3000)), dark=False)
    assert any(t.name == "out of reach (40 points)" for t in fig.figure.data)


@pytest.mark.parametrize("dark", [False, True])
def test_what_has_no_value_is_broken_and_named_and_has_no_colour_of_the_scale(dark: bool) -> None:
    """A square of which one side has no value, from above and turnable; a hole without one is a ring."""
    p = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 0], [3, 3, 1], [3, 3, 0]], dtype=float)
    cutting = np.array([False, True, True, True, True, False, True])
    value = np.array([0.0, 0.1, np.nan, 0.1, 0.15, np.nan, np.nan])
    picture = PathPicture(p, cutting, np.ones(7, dtype=bool), np.arange(7), value=value, limit=0.3, unit="mm")
    pictures = plan_picture(picture, dark=dark), turnable_picture(picture, dark=dark)[0]
    for chart in pictures:
        (line,) = [t for t in chart.figure.data if t.name == "not judged (2 points)"]
        assert line.showlegend
        assert line.line.dash == "dash"
        x = np.asarray(line.x, dtype=float)
        np.testing.assert_array_equal(x[np.isfinite(x)], [1, 1, 3, 3])
        red, green, blue = (int(line.line.color[i : i + 2], 16) for i in (1, 3, 5))
        for colour in CIVIDIS:
            other = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
            assert np.linalg.norm(np.subtract(other, (red, green, blue))) > 60.0
        for other in (t for t in chart.figure.data if t.mode == "lines" and t.name not in (line.name, "rapid")):
            assert other.line.dash in (None, "solid")
    (ring,) = [
        t for t in pictures[0].figure.data if t.mode == "markers" and t.marker.symbol == "circle-open" and not t.name
    ]
    np.testing.assert_array_equal(ring.x, [3])
    hovered = next(t for t in pictures[0].figure.data if t.name == "points").text
    assert [("not judged" in words) for words in hovered] == [False, False, True, False, False, False, True]
    known = PathPicture(p, cutting, np.ones(7, dtype=bool), np.arange(7), value=np.ones(7), limit=0.3)
    assert not [t for t in plan_picture(known, dark=dark).figure.data if (t.name or "").startswith("not judged")]
