"""Words can be read in both themes: at least 4.5 to 1 against what they stand on (WCAG 2, level AA)."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from robomill.viz.theme import palette

CONFIG = Path(__file__).resolve().parents[2] / ".streamlit" / "config.toml"
LEAST = 4.5


def luminance(colour: str) -> float:
    """Relative luminance of ``#RRGGBB`` as WCAG 2 defines it."""
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def mixed(colour: str, ground: str, share: float) -> str:
    """``colour`` laid over ``ground`` with an opacity of ``share``."""
    parts = [round(share * int(colour[i : i + 2], 16) + (1 - share) * int(ground[i : i + 2], 16)) for i in (1, 3, 5)]
    return "#" + "".join(f"{part:02X}" for part in parts)


def test_the_measure_itself() -> None:
    assert contrast("#000000", "#FFFFFF") == pytest.approx(21.0)
    assert contrast("#777777", "#FFFFFF") == pytest.approx(4.48, abs=0.01)  # the grey that just fails


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("name", ["text", "muted", "accent", "good", "bad"])
def test_words_of_figures_and_pages(dark: bool, name: str) -> None:
    colours = palette(dark)
    assert contrast(getattr(colours, name), colours.background) >= LEAST


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_words_of_the_app(theme: str) -> None:
    said = tomllib.loads(CONFIG.read_text(encoding="utf-8"))["theme"][theme]
    grounds = (said["backgroundColor"], said["secondaryBackgroundColor"], said["sidebar"]["backgroundColor"])
    for ground in grounds:
        assert contrast(said["textColor"], ground) >= LEAST
        assert contrast(said["linkColor"], ground) >= LEAST
        # quiet lines, labels of tiles and of the bar: the text at 0.74 of its strength
        assert contrast(mixed(said["textColor"], ground, 0.74), ground) >= LEAST
        assert contrast(mixed(said["textColor"], ground, 0.66), ground) >= LEAST  # the line above the sentence
    assert contrast(said["backgroundColor"], said["primaryColor"]) >= LEAST  # words on the main button
