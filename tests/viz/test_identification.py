"""Figures of an identification: what is drawn is what was given, in both themes, also where something is not known."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from robomill.viz.along import add_band
from robomill.viz.deviation import band_figure
from robomill.viz.identification import (
    MAX_TESTS,
    Intervals,
    correlation_figure,
    gain_figure,
    intervals_figure,
    models_figure,
    residuals_figure,
)
from robomill.viz.maps import Map, MapSheet, Scale
from robomill.viz.measured_maps import level_figure
from robomill.viz.theme import figure

SHOWN = Intervals(
    labels=("Joint 1", "Joint 2", "Joint 3"),
    value=np.array([8.9, np.nan, 33.4]),
    low=np.array([8.5, 0.0, 0.0]),
    high=np.array([9.3, np.inf, 51.0]),
    words=("<b>8.90</b>", "not seen by these tests", "<b>33.40</b>"),
    unit="×10⁻⁷ rad/(N m)",
    references={"Table 2": np.array([7.1, 10.1, 12.3])},
    truth=np.array([9.0, 11.0, 28.0]),
)


@pytest.mark.parametrize("dark", [False, True])
def test_intervals_are_drawn_as_given(dark: bool) -> None:
    fig = intervals_figure(SHOWN, dark=dark)
    bars = [t for t in fig.figure.data if t.mode == "lines"]
    assert len(bars) == 2, "a joint that is not seen has no bar"
    np.testing.assert_allclose(bars[0].x, [8.5, 9.3])
    assert bars[1].x[1] == 51.0
    assert bars[1].x[0] > 0, "an interval down to zero is cut where the logarithmic axis ends"
    named = {t.name: t for t in fig.figure.data if t.name}
    np.testing.assert_allclose(named["Table 2"].x, [7.1, 10.1, 12.3])
    np.testing.assert_allclose(named["truth"].x, [9.0, 11.0, 28.0])
    assert any("not seen" in a.text for a in fig.figure.layout.annotations)
    low, high = fig.figure.layout.xaxis.range
    assert 10**low < 7.1
    assert 10**high > 51.0


def test_a_zero_is_an_arrow_at_the_end_of_a_logarithmic_axis_and_no_point_on_it() -> None:
    """A joint 4 of 0 was drawn as a point at 2.1."""
    none = dataclasses.replace(
        SHOWN,
        value=np.array([8.9, 0.0, 33.4]),
        low=np.array([8.5, 0.0, 30.0]),
        high=np.array([9.3, 4.0, 51.0]),
        references={"Table 2": np.array([7.1, 0.0, 12.3])},
        truth=np.array([9.0, 0.0, 28.0]),
    )
    fig = intervals_figure(none, dark=False).figure
    start = 10.0 ** fig.layout.xaxis.range[0]
    fitted = next(t for t in fig.data if t.name and t.name.startswith("fitted"))
    np.testing.assert_allclose(fitted.x, [8.9, 33.4])
    arrows = [t for t in fig.data if t.marker.symbol == "triangle-left"]
    assert len(arrows) == 3
    for arrow in arrows:
        np.testing.assert_allclose(arrow.x, start)
        assert [round(y) for y in arrow.y] == [1]
        assert list(arrow.text) == ["0.00"]
    assert any(a.text == "0.00 lies left of this axis" for a in fig.layout.annotations)


def test_signed_values_stand_on_a_linear_axis() -> None:
    signed = dataclasses.replace(
        SHOWN,
        value=np.array([-1.0, 0.5, 2.0]),
        low=np.array([-1.2, 0.2, 1.0]),
        high=np.array([-0.8, 0.8, 3.0]),
        references={},
        truth=None,
        logarithmic=False,
    )
    fig = intervals_figure(signed, dark=False)
    assert fig.figure.layout.xaxis.type is None
    assert min(t.x[0] for t in fig.figure.data if t.mode == "lines") == -1.2


def test_nothing_known_still_draws() -> None:
    nothing = dataclasses.replace(
        SHOWN, value=np.full(3, np.nan), low=np.full(3, np.nan), high=np.full(3, np.nan), references={}, truth=None
    )
    assert intervals_figure(nothing, dark=True).figure.layout.height > 100


def test_correlations_carry_their_numbers() -> None:
    table = np.array([[1.0, -0.99, np.nan], [-0.99, 1.0, -0.001], [np.nan, -0.001, 1.0]])
    fig = correlation_figure(["J1", "J2", "J3"], table, dark=False)
    assert list(fig.figure.data[0].text[0]) == ["1", "−0.99", ""]
    assert fig.figure.data[0].text[1][2] == "0"
    assert (fig.figure.data[0].zmin, fig.figure.data[0].zmax) == (-1, 1)


@pytest.mark.parametrize("dark", [False, True])
def test_every_correlation_can_be_read_on_its_colour(dark: bool) -> None:
    """By the contrast of WCAG 2, with the colour of a cell found on the scale by hand: at least 4.5 : 1."""

    def luminance(rgb: np.ndarray) -> float:
        part = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in rgb / 255.0]
        return float(0.2126 * part[0] + 0.7152 * part[1] + 0.0722 * part[2])

    def hexadecimal(colour: str) -> np.ndarray:
        return np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)], dtype=float)

    values = np.linspace(-0.99, 0.99, 8)
    table = np.eye(8)
    table[0, 1:] = table[1:, 0] = values[1:]
    fig = correlation_figure([f"J{k}" for k in range(8)], table, dark=dark).figure
    cells, words = fig.data
    for x, y, colour in zip(words.x, words.y, words.textfont.color, strict=True):
        share = 0.5 + 0.5 * table[int(y[1:]), int(x[1:])]
        scale = [(float(at), hexadecimal(shown)) for at, shown in cells.colorscale]
        after = next(k for k, (at, _) in enumerate(scale) if at >= share)
        (a, low), (b, high) = scale[max(after - 1, 0)], scale[after]
        ground = low if b == a else low + (high - low) * (share - a) / (b - a)
        light, shade = sorted((luminance(ground), luminance(hexadecimal(colour))), reverse=True)
        assert (light + 0.05) / (shade + 0.05) >= 4.5


def test_every_outlier_is_drawn_however_many_tests_there_are() -> None:
    m = 100_000
    row = np.arange(m) + 2
    residual = np.random.default_rng(0).normal(size=(m, 3))
    outlier = np.zeros(m, dtype=bool)
    outlier[[7, 77_777]] = True
    fig = residuals_figure(row, residual, outlier, "mm", "xyz", dark=False)
    assert len(fig.figure.data[0].x) <= MAX_TESTS + 2
    named = next(t for t in fig.figure.data if t.name == "does not fit")
    assert list(named.x) == [9, 77_779]
    np.testing.assert_allclose(named.y, [residual[k][np.argmax(np.abs(residual[k]))] for k in (7, 77_777)])


def test_single_joints_have_one_residual_each() -> None:
    fig = residuals_figure(np.arange(4), np.arange(4.0)[:, None], np.zeros(4, dtype=bool), "mrad", [""], dark=True)
    assert [t.name for t in fig.figure.data] == ["residual"]


def test_models_show_both_errors_and_name_the_chosen_one() -> None:
    fig = models_figure(["a", "b"], np.array([1.0, 20.0]), np.array([1.5, 30.0]), 0, dark=False)
    named = {t.name: t for t in fig.figure.data if t.name}
    np.testing.assert_allclose(named["on its own data"].x, [1.0, 20.0])
    np.testing.assert_allclose(named["on unseen poses"].x, [1.5, 30.0])
    assert fig.figure.layout.yaxis.ticktext == ("<b>a</b>", "b")


def test_a_joint_not_seen_before_says_so() -> None:
    fig = gain_figure(["Joint 1", "Joint 2"], np.array([5.0, np.inf]), np.array([4.0, 9.0]), dark=False)
    assert fig.figure.data[0].text == ("± 5 %", "not seen")
    assert np.isfinite(np.asarray(fig.figure.data[0].x, dtype=float)).all()


def test_a_band_lies_around_its_curve_and_stops_where_nothing_is_known() -> None:
    s = np.linspace(0, 10, 21)
    value, half = np.sin(s), np.full(21, 0.1)
    value[8:11] = np.nan
    fig = band_figure((s, value, half, value - 0.2), "y", "mm", dark=False)
    shades = [t for t in fig.figure.data if t.fill == "toself"]
    assert len(shades) == 2
    n = len(shades[0].x) // 2
    np.testing.assert_allclose(np.asarray(shades[0].y[:n]) - np.asarray(shades[0].y[n:])[::-1], 0.2)
    assert sum(bool(t.showlegend) for t in shades) == 1


def test_a_band_is_laid_under_an_existing_figure() -> None:
    fig = figure(dark=True, height=200)
    add_band(fig, np.arange(3.0), np.ones(3), np.full(3, 0.5), "", dark=True)
    assert len(fig.figure.data) == 1
    add_band(fig, np.arange(3.0), np.full(3, np.nan), np.ones(3), "x", dark=True)
    assert len(fig.figure.data) == 1, "nothing known, nothing shaded"


@pytest.mark.parametrize("signed", [False, True])
def test_a_level_keeps_its_orientation_and_mask(signed: bool) -> None:
    x, y = np.array([-1.0, 0.0, 1.0]), np.array([0.0, 1.0])
    values = np.array([[1.0, 2.0], [3.0, np.nan], [5.0, 6.0]])
    scale = Scale.signed("C, µm/N", [values]) if signed else Scale("C, µm/N", 1.0, 6.0)
    sheet = MapSheet([[Map("C", values, unit="µm/N")]], x, y, "X, mm", "Y, mm", {"main": scale})
    fig = level_figure(sheet, np.zeros((0, 2)), dark=False, revision="r")
    z = np.asarray(fig.figure.data[0].z, dtype=float)
    assert z.shape == (2, 3), "rows of a heat map are y"
    assert z[0, 2] == 5.0
    assert np.isnan(z[1, 1])
    assert fig.figure.layout.xaxis.range == (-1.5, 1.5)
