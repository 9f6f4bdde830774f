"""Maps as the browser gets them: the codes hold the values, ticks and words say them, X and Y have one scale."""

from __future__ import annotations

import base64
import dataclasses
import json

import numpy as np
import pytest

from robomill.arrays import FloatArray
from robomill.units import from_si
from robomill.viz.maps import Scale
from robomill.viz.planes import (
    CAPTION,
    FOOT,
    LEFT,
    LEGEND,
    RIGHT,
    SLIDER,
    PlaneMap,
    PlaneSheet,
    coded,
    ends,
    extremes,
    means,
    neat,
    said,
    sheet_data,
)

U, V, W = np.linspace(-600, 600, 13), np.linspace(-1600, -1000, 7), np.array([-400.0, -150.0, 100.0])


def values(seed: int = 0, reached: float = 0.8) -> FloatArray:
    rng = np.random.default_rng(seed)
    found = rng.normal(size=(3, 7, 13)) * 1e-6
    found[rng.random(found.shape) > reached] = np.nan
    return found


def read(text: str, low: float, high: float, shape: tuple[int, ...]) -> FloatArray:
    """What a browser reads, written from the description of the codes."""
    codes = np.frombuffer(base64.b64decode(text), dtype="<u2").reshape(shape).astype(float)
    return np.where(codes > 0, low + (codes - 1) / 65534 * (high - low), np.nan)


@pytest.mark.parametrize("reached", [1.0, 0.5, 0.02])
def test_codes_hold_every_value_to_half_a_step_and_tell_what_is_not_reached(reached: float) -> None:
    shown = values(1, reached)
    codes = coded(shown)
    back = read(codes.text, codes.low, codes.high, shown.shape)
    np.testing.assert_array_equal(np.isnan(back), np.isnan(shown))
    span = np.nanmax(shown) - np.nanmin(shown)
    assert np.nanmax(np.abs(back - shown)) <= span / 65534 / 2 * (1 + 1e-9)
    assert (codes.low, codes.high) == (np.nanmin(shown), np.nanmax(shown))


def test_a_map_of_one_value_and_a_map_of_none() -> None:
    one = coded(np.full((1, 2, 2), 3.0))
    np.testing.assert_array_equal(read(one.text, one.low, one.high, (1, 2, 2)), 3.0)
    none = coded(np.full((2, 2, 2), np.nan))
    assert not none.reached
    assert extremes(none, "um/N") == ["not reached"] * 2 == means(none, "um/N")
    assert len(ends([none], "um/N")) == 0


def test_the_words_of_a_plane_are_of_its_own_values() -> None:
    shown = values(2)
    shown[1] = np.nan
    codes = coded(shown)
    low, high = from_si(np.nanmin(shown[0]), "um/N"), from_si(np.nanmax(shown[0]), "um/N")
    assert extremes(codes, "um/N")[0] == f"{low:.2f} … {high:.2f}".replace("-", "−")
    assert extremes(codes, "um/N")[1] == "not reached"
    assert means(codes, "um/N")[2] == f"{from_si(np.nanmean(shown[2]), 'um/N'):.3f}".replace("-", "−")


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (-1.04, 0.6), (1.56, 3.97), (0.2461, 1.9433), (-4e-7, 9e-7)])
def test_ticks_are_round_and_inside(low: float, high: float) -> None:
    for most in (3, 5, 8):
        ticks = neat(low, high, most)
        assert 1 <= len(ticks) <= most
        assert all(low - 1e-9 * (high - low) <= tick <= high + 1e-9 * (high - low) for tick in ticks)
        if len(ticks) > 1:
            step = (ticks[1] - ticks[0]) / 10 ** np.floor(np.log10(ticks[1] - ticks[0]) + 1e-9)
            assert min(abs(step - m) for m in (1, 2, 5)) < 1e-6
            np.testing.assert_allclose(np.diff(ticks), ticks[1] - ticks[0], rtol=1e-6)


def test_words_of_ticks_tell_them_apart() -> None:
    assert said([-0.5, 0.0, 0.5]) == [(-0.5, "−0.5"), (0.0, "0.0"), (0.5, "0.5")]
    assert said([1000.0, 2000.0]) == [(1000.0, "1000"), (2000.0, "2000")]
    assert neat(2.0, 2.0, 5) == [] == neat(np.nan, np.nan, 5)


def sheet(unit: str = "mm", count: int = 1) -> PlaneSheet:
    codes = coded(values())
    scale = Scale.signed("C", [ends([codes], "um/N")])
    row: list[PlaneMap | None] = [PlaneMap("C_yy", codes, "um/N") for _ in range(count)]
    factor = 1.0 if unit == "mm" else 25.4
    return PlaneSheet([row], U / factor, V / factor, W / factor, ("X", "Y", "Z"), unit, {"main": scale}, width=700)


@pytest.mark.parametrize("unit", ["mm", "in"])
def test_what_is_drawn_is_said_in_mm_whatever_is_shown(unit: str) -> None:
    data = sheet_data(sheet(unit), dark=False)
    assert data["w"]["drawn"] == ["-400", "-150", "100"]
    assert data["w"]["said"] == (["−400", "−150", "100"] if unit == "mm" else ["−15.75", "−5.91", "3.94"])
    json.dumps(data)  # goes to the browser as it is


def test_a_box_goes_to_the_browser_once_however_many_panels_show_it() -> None:
    data = sheet_data(sheet(count=3), dark=False)
    assert len(data["codes"]) == 1
    assert [panel["codes"] for panel in data["panels"]] == [0, 0, 0]


def test_another_theme_or_another_value_is_another_board() -> None:
    revisions = {sheet_data(sheet(), dark=dark)["rev"] for dark in (False, True)} | {
        sheet_data(sheet("in"), dark=False)["rev"]
    }
    assert len(revisions) == 3
    assert sheet_data(sheet(), dark=False)["rev"] in revisions


def test_x_and_y_have_one_scale_in_the_room_there_is() -> None:
    """1300 x 700 mm with their half cells: as high as they are wide, in that ratio."""
    wide = 700 - LEFT - RIGHT
    assert sheet_data(sheet(), dark=False)["height"] == round(SLIDER + wide * 700 / 1300 + CAPTION + FOOT + LEGEND)


def test_contours_are_inside_the_range_of_their_map() -> None:
    panel = sheet_data(sheet(), dark=True)["panels"][0]
    assert 3 <= len(panel["contours"]) <= 8
    assert all(panel["low"] <= level <= panel["high"] for level, _ in panel["contours"])


def test_rounding_errors_are_no_contours() -> None:
    """A share that is zero but for 1e-20 was drawn with lines and values of its noise."""
    noise = coded(np.abs(values(3)) * 1e-14)
    row: list[PlaneMap | None] = [PlaneMap("C_zz, joint 5", noise, "um/N")]
    data = sheet_data(dataclasses.replace(sheet(), rows=[row]), dark=False)
    assert data["panels"][0]["contours"] == []
