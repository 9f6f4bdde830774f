"""Charts as PNG files."""

from __future__ import annotations

import io
import sys

import numpy as np
import pytest
from PIL import Image

from robomill.errors import MissingExtraError
from robomill.viz.chart import Chart
from robomill.viz.plotted import DOT, LEFT, ROW, UNDER, WIDTH, png
from robomill.viz.theme import axis, figure, rgba, say

INNER = 300  # px: the height of the axes


def chart(**y: object) -> Chart:
    fig = figure(dark=False, height=INNER)
    return fig.lay_out(xaxis=axis("x", dark=False, showgrid=False), yaxis=axis("y", dark=False, showgrid=False, **y))


def pixels(fig: Chart, captions: tuple[str, ...] = ()) -> np.ndarray:
    with Image.open(io.BytesIO(png(fig, captions))) as picture:
        return np.asarray(picture.convert("RGB")).astype(int)


def where(picture: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    """(k, 2) columns and rows of a colour."""
    rows, columns = np.nonzero(np.abs(picture - colour).max(axis=2) < 12)
    return np.column_stack([columns, rows])


def in_axes(x: float, y: float, over: int = 12) -> tuple[float, float]:
    """Dots of a place in the axes, by shares of them, from above."""
    return DOT * (LEFT + x * (WIDTH - LEFT - 20)), DOT * (over + (1.0 - y) * INNER)


def test_a_line_runs_where_its_numbers_say() -> None:
    fig = chart(range=[0.0, 10.0])
    fig.lines([0.0, 100.0], [2.5, 7.5], {"color": "#FF0000", "width": 2})
    found = where(pixels(fig), (255, 0, 0))
    for x, y in ((0.0, 0.25), (1.0, 0.75)):
        assert np.hypot(*(found - in_axes(x, y)).T).min() < 3.0


def test_a_line_ends_where_a_value_is_missing() -> None:
    fig = chart(range=[0.0, 10.0])
    fig.lines(np.arange(5.0), [5.0, 5.0, np.nan, 5.0, 5.0], {"color": "#FF0000", "width": 2})
    columns = where(pixels(fig), (255, 0, 0))[:, 0]
    gap = in_axes(0.5, 0.5)[0]
    assert np.abs(columns - gap).min() > 0.2 * DOT * (WIDTH - LEFT)


def test_limits_are_in_the_picture_though_no_line_reaches_them() -> None:
    fig = chart()
    fig.lines([0.0, 1.0], [0.0, 1.0], {"color": "#000000"})
    fig.across(5.0, {"color": "#00AA00", "width": 2})
    found = where(pixels(fig), (0, 170, 0))
    assert len(found)
    assert DOT * 12 < found[:, 1].mean() < DOT * (12 + 0.2 * INNER)


def test_one_scale_for_both_axes_where_they_are_tied() -> None:
    fig = chart(scaleanchor="x", scaleratio=1)
    fig.area([0.0, 2.0, 2.0, 0.0], [0.0, 0.0, 2.0, 2.0], "#0000FF")
    found = where(pixels(fig), (0, 0, 255))
    across, upwards = np.ptp(found, axis=0)
    assert across == pytest.approx(upwards, abs=3)


def test_an_axis_may_run_backwards() -> None:
    fig = chart(range=[0.0, 1.0]).lay_out(xaxis={"range": [1.0, 0.0]})
    fig.lines([0.9, 1.0], [0.5, 0.5], {"color": "#FF0000", "width": 4})
    assert where(pixels(fig), (255, 0, 0))[:, 0].max() < DOT * (LEFT + 0.12 * WIDTH)


def test_dimension_lines_keep_their_distance_in_pixels() -> None:
    fig = chart(range=[0.0, 10.0]).lay_out(xaxis={"range": [0.0, 10.0]})
    line = {"color": "#FF0000", "width": 2}
    fig.shape(type="line", x0=2.0, x1=8.0, y0=40, y1=40, ysizemode="pixel", yanchor=5.0, line=line)
    found = where(pixels(fig), (255, 0, 0))
    assert found[:, 1].mean() == pytest.approx(in_axes(0.0, 0.5)[1] - 40 * DOT, abs=2)
    assert found[:, 0].min() == pytest.approx(in_axes(0.2, 0.0)[0], abs=3)
    assert found[:, 0].max() == pytest.approx(in_axes(0.8, 0.0)[0], abs=3)


def test_words_arrows_and_captions_take_their_room() -> None:
    fig = chart(range=[0.0, 1.0]).lay_out(xaxis={"range": [0.0, 1.0]})
    fig.lines([0.0, 1.0], [0.1, 0.1], {"color": "#000000"}, name="δ<sub>X</sub>", showlegend=True)
    say(fig, "price $5 &lt; 6", 0.5, 0.5, "#FF0000", bgcolor=rgba("#FFFFFF", 0.9))
    fig.annotate(x=0.2, y=0.8, ax=30, ay=0, showarrow=True, arrowcolor="#0000FF", text="")
    picture = pixels(fig, ("A caption", "and another"))
    over = 12 + 3 * ROW
    assert picture.shape[0] == round(DOT * (over + INNER + UNDER))
    words = where(picture, (255, 0, 0)).mean(axis=0)
    assert np.hypot(*(words - in_axes(0.5, 0.5, over))) < 8
    tip = where(picture, (0, 0, 255))[:, 0].min()
    assert tip == pytest.approx(in_axes(0.2, 0.8)[0], abs=3)


def test_what_is_not_drawn_is_not_left_out_in_silence() -> None:
    fig = chart()
    fig.dots([0.0], [0.0], {"size": 3})
    with pytest.raises(ValueError, match="markers"):
        png(fig)


def test_without_matplotlib_its_extra_is_named(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(MissingExtraError, match=r"robomill\[plot\]"):
        png(chart())


def test_a_name_in_letters_that_the_font_lacks_is_drawn_without_a_word_on_standard_error(
    recwarn: pytest.WarningsRecorder,
) -> None:
    assert (pixels(chart(), ("测试 Größe",)) < 128).any()
    assert not recwarn.list
