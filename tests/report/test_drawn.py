"""Axes as SVG: what is drawn is read back off the picture by its own ticks."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from robomill.report.drawn import FINEST, Axes, svg, ticks

AXES = Axes(40.0, 18.0, 300.0, 190.0, (-3.0, 7.0), (-0.25, 0.45))


def elements(picture: str, name: str, look: str = "") -> list[ElementTree.Element]:
    root = ElementTree.fromstring(f"<all>{picture}</all>")
    return [each for each in root.iter(name) if not look or each.get("class") == look]


def points(path: ElementTree.Element) -> list[tuple[str, float, float]]:
    """Commands of a path with their places."""
    return [(c, float(x), float(y)) for c, x, y in re.findall(r"([ML])(\S+) (\S+)", path.get("d") or "")]


@pytest.mark.parametrize("most", [2, 3, 5, 9])
@pytest.mark.parametrize("ends", [(-0.25, 0.45), (0.0, 1.0), (-3.0, 7.0), (1234.0, 99876.0), (2.2e-4, 9.1e-4)])
def test_ticks_are_all_multiples_of_a_round_step_between_the_ends(ends: tuple[float, float], most: int) -> None:
    found = list(ticks(*ends, most))
    values = np.array([value for value, _ in found])
    assert 1 <= len(found) <= most + 1
    span = ends[1] - ends[0]
    step = values[1] - values[0] if len(found) > 1 else span
    assert (ends[0] - 1e-6 * span <= values).all()
    assert (values <= ends[1] + 1e-6 * span).all()
    np.testing.assert_allclose(np.diff(values), step, rtol=1e-9)
    if len(found) > 1:
        lead = float(f"{step:.6e}"[:8])
        assert lead in (1.0, 2.0, 5.0), "1, 2 or 5 times a power of ten"
        assert values[0] - step < ends[0], "none is left out below"
        assert values[-1] + step > ends[1], "nor above"
        assert span / step <= most * (1.0 + 1e-6), "no finer than was asked for"
        assert span / step > most / 2.6, "and no coarser than the next round step"
    for value, words in found:
        plain = words.replace("\u202f", "").replace("\u2212", "-")
        assert float(plain) == pytest.approx(value, abs=1e-6 * span)


def test_the_ends_of_the_axes_are_the_edges_of_the_rectangle() -> None:
    assert (AXES.right, AXES.bottom) == (340.0, 208.0)
    assert AXES.at(-3.0, -0.25) == (40.0, 208.0), "x to the right, y up"
    assert AXES.at(7.0, 0.45) == pytest.approx((340.0, 18.0))
    assert AXES.at(2.0, 0.1) == pytest.approx((190.0, 113.0)), "and the middle is in the middle"


def test_a_tick_stands_where_its_number_says() -> None:
    frame = AXES.frame("along", "up")
    flat = [each for look in "gz" for each in elements(frame, "line", look) if each.get("y1") == each.get("y2")]
    for words in elements(frame, "text", "e"):
        value = float((words.text or "").replace("\u2212", "-"))
        y = 18.0 + 190.0 * (0.45 - value) / 0.70
        assert any(float(line.get("y1") or "") == pytest.approx(y, abs=0.051) for line in flat)
        assert float(words.get("y") or "") == pytest.approx(y + 3.5, abs=0.051)
    assert [each.get("class") for each in flat].count("z") == 1, "zero is the strong one"
    for words in elements(frame, "text", "m")[:-1]:
        x = 40.0 + 30.0 * (float((words.text or "").replace("\u2212", "-")) + 3.0)
        assert float(words.get("x") or "") == pytest.approx(x, abs=0.051)
    titles = {each.text for each in elements(frame, "text")}
    assert {"along", "up"} <= titles
    bare = AXES.frame("along", "up", x_ticks=False)
    assert len(elements(bare, "text", "m")) == 1


def test_a_line_is_parted_where_a_number_is_missing() -> None:
    x, y = np.array([-3.0, 0.0, 2.0, 4.0, 7.0]), np.array([0.45, 0.1, np.nan, 0.1, -0.25])
    (path,) = elements(AXES.line(x, y, "left"), "path", "left")
    assert points(path) == [("M", 40.0, 18.0), ("L", 130.0, 113.0), ("M", 250.0, 113.0), ("L", 340.0, 208.0)]


def test_a_long_line_keeps_the_ends_of_every_column() -> None:
    """Against a plain look at every column: its lowest and highest place are drawn."""
    rng = np.random.default_rng(4)
    count = 20_000
    x = np.linspace(-3.0, 7.0, count)
    y = rng.uniform(-0.2, 0.4, count)
    y[7000:7400] = np.nan
    (path,) = elements(AXES.line(x, y, "left"), "path")
    drawn = points(path)
    assert len(drawn) < 5 * FINEST * 300
    assert [c for c, _, _ in drawn].count("M") == 2, "one gap"
    across, up = AXES.at(x, y)
    column, seen = np.floor(across * FINEST), np.array([(a, b) for _, a, b in drawn])
    for which in np.unique(column)[5:-5:37]:
        here = up[column == which]
        if np.isnan(here).any():
            continue
        near = seen[np.abs(seen[:, 0] - (which + 0.5) / FINEST) < 0.5 / FINEST + 0.11, 1]
        assert near.min() == pytest.approx(here.min(), abs=0.051) or near.min() < here.min()
        assert near.max() == pytest.approx(here.max(), abs=0.051) or near.max() > here.max()
    first, last = drawn[0], drawn[-1]
    assert first[1:] == (40.0, round(float(up[0]), 1))
    assert last[1:] == (340.0, round(float(up[-1]), 1))


def test_a_level_crosses_the_picture_at_its_height() -> None:
    (line,) = elements(AXES.level(0.1, "allowed", "limit"), "line", "limit")
    assert [line.get(key) for key in ("x1", "x2", "y1", "y2")] == ["40.0", "340.0", "113.0", "113.0"]


def test_stretches_reach_from_the_point_before_to_the_point_after() -> None:
    x = np.linspace(-3.0, 7.0, 11)
    which = np.zeros(11, dtype=bool)
    which[[3, 4, 10]] = True
    first, last = elements(AXES.stretches(x, which, "lost"), "rect", "lost")
    assert (first.get("x"), first.get("width")) == ("100.0", "90.0"), "from 2 to 5 of the way of ten"
    assert (last.get("x"), last.get("width")) == ("310.0", "30.0")
    assert (first.get("y"), first.get("height")) == ("18.0", "190.0")


def test_a_picture_says_what_it_shows() -> None:
    made = ElementTree.fromstring(svg(10, 20, "a < b"))
    assert made.get("viewBox") == "0 0 10 20"
    assert made[0].text == "a < b"
