"""The style sheet: what it writes small can be read, in both themes (WCAG 2.1 AA: 4.5 to 1)."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from robomill.ui.serving import front
from robomill.viz.theme import palette

LEAST = 4.5
PROGRAM = Path(front.__file__).parents[1] / "toolpath" / "program_view.css"
Colour = tuple[float, ...]


def rgb(colour: str) -> Colour:
    return tuple(int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))


def mixed(over: Colour, under: Colour, share: float) -> Colour:
    return tuple(share * a + (1.0 - share) * b for a, b in zip(over, under, strict=True))


def luminance(colour: Colour) -> float:
    linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in colour]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: Colour, other: Colour) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def rule(selector: str, sheet: str = front.STYLE) -> str:
    found = re.search(rf"(?m)^{re.escape(selector)} {{([^}}]*)}}", sheet)
    assert found is not None, selector
    return found[1]


def share(text: str, of: str) -> float:
    found = re.search(rf"{re.escape(of)} (\d+)%", text)
    assert found is not None, text
    return int(found[1]) / 100.0


@pytest.mark.parametrize("dark", [False, True])
def test_badges_are_read_wherever_they_stand(dark: bool) -> None:
    p, badge = palette(dark), rule(".rm-badge")
    text, ground = rgb(p.text), rgb(p.background)
    words, fill = re.findall(r"color-mix\(in srgb, var\(--rm-hue\) (\d+)%", badge)[:2]
    hues = re.findall(r"--rm-hue: (#\w{6})", front.STYLE)
    assert len(hues) >= 5
    for hue in map(rgb, hues):
        assert contrast(mixed(hue, text, int(words) / 100), mixed(hue, ground, int(fill) / 100)) >= LEAST


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("selector", [".rm-lead", ".rm-note", ".rm-sub", ".rm-cell small"])
def test_quiet_words_are_read_and_do_not_fade_what_stands_in_them(selector: str, dark: bool) -> None:
    p, quiet = palette(dark), rule(selector)
    assert "opacity" not in quiet
    ground = rgb(p.background)
    assert contrast(mixed(rgb(p.text), ground, share(quiet, "currentColor")), ground) >= LEAST


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("selector", [".no", ".text .c"])
def test_line_numbers_and_comments_of_a_program_are_read(selector: str, dark: bool) -> None:
    p, ground = palette(dark), rgb(palette(dark).background)
    words = rule(selector, PROGRAM.read_text(encoding="utf-8"))
    assert contrast(mixed(rgb(p.text), ground, share(words, "var(--st-text-color)")), ground) >= LEAST
