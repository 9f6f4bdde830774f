"""Colours and layout shared by every picture, one set for light and one for dark.

All figures take ``dark: bool``; none asks the screen. Joints keep one colour everywhere (Tol's muted set), axes have
theirs, and neither is a colour of what is within tolerance or out of it; signed errors are blue (below the ideal) to
orange (material left), sizes run through cividis: each is readable with any colour vision, and words stand beside
the colours.
"""

import html
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import cycle
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.viz.chart import Chart

HOVERED = 4  # decimals, in mm as in inches, where one points at a curve of errors
FONT = '"Source Sans", "Source Sans 3", "Source Sans Pro", sans-serif'

JOINT_COLOURS = ("#332288", "#C9B44A", "#117733", "#AA4499", "#6DBDE3", "#999933", "#44AA99")
JOINT_COLOURS_DARK = ("#8F86E0", "#E3D791", "#4FB86F", "#D07CC4", "#9ED8F2", "#BDBD5A", "#6CC7B8")

AXIS_COLOURS = {"x": "#882255", "y": "#6E6E1A", "z": "#4C6A85"}
AXIS_COLOURS_DARK = {"x": "#D983AE", "y": "#C6C65E", "z": "#9DBBD6"}

DIVERGING = [[0.0, "#08457E"], [0.25, "#4E93C8"], [0.5, "#ECECE8"], [0.75, "#E8954A"], [1.0, "#A33E00"]]
DIVERGING_DARK = [[0.0, "#6FC1FF"], [0.25, "#2F7DB5"], [0.5, "#3A444B"], [0.75, "#D07A2C"], [1.0, "#FFB368"]]
CIVIDIS = ["#00224E", "#123570", "#3B496C", "#575D6D", "#707173", "#8A8678", "#A59C74", "#C3B369", "#E1CC55", "#FEE838"]
# What is able is dark, as what is stiff is in cividis: bright is where care is needed. A single hue of its own.
ABLE = [[0.0, "#EEF6F4"], [0.25, "#B5D9D2"], [0.5, "#6DB0A8"], [0.75, "#2B7F7C"], [1.0, "#0B4A4E"]]
SEQUENTIAL = [[k / (len(CIVIDIS) - 1), colour] for k, colour in enumerate(CIVIDIS)]

Point = tuple[float, float]
ABOVE = {"xref": "paper", "yref": "paper", "xanchor": "left", "yanchor": "bottom"}


@dataclass(frozen=True)
class Palette:
    """The colours of one theme; hex strings."""

    background: str
    panel: str
    text: str
    muted: str
    grid: str
    line: str
    accent: str
    warm: str
    metal: str
    metal_edge: str
    link: str
    joint: str
    good: str
    caution: str
    bad: str
    unjudged: str


# Each colour in light, and in dark.
_COLOURS = {
    "background": ("#FFFFFF", "#11181D"),
    "panel": ("#F5F7F8", "#1A242B"),
    "text": ("#17222B", "#E4EAEE"),
    "muted": ("#5A6872", "#9BA9B3"),
    "grid": ("#E6EAED", "#26323A"),
    "line": ("#B8C2C9", "#4A5963"),
    "accent": ("#0B6285", "#5CB6DA"),
    "warm": ("#B85C00", "#F0A04B"),
    "metal": ("#D3D9DD", "#5B6871"),
    "metal_edge": ("#7D8A93", "#A9B5BD"),
    "link": ("#C9D2D8", "#6C7B86"),
    "joint": ("#3D4E5A", "#C9D4DB"),
    "good": ("#0072B2", "#5CB6DA"),
    "caution": ("#B07400", "#E9B949"),
    "bad": ("#B3400A", "#F0803C"),
    "unjudged": ("#7A4FB5", "#C3A6F0"),
}
LIGHT, DARK = (Palette(**{name: both[k] for name, both in _COLOURS.items()}) for k in range(2))


def palette(dark: bool) -> Palette:
    """The colours of the theme in force."""
    return DARK if dark else LIGHT


def joint_colours(n: int, dark: bool) -> tuple[str, ...]:
    """One colour per joint, the same in every figure; n <= 7."""
    return (JOINT_COLOURS_DARK if dark else JOINT_COLOURS)[:n]


def tool_colours(numbers: Iterable[int], dark: bool) -> dict[int, str]:
    """One colour per tool, in the order of ``numbers``; they come again where there are many."""
    return dict(zip(numbers, cycle(joint_colours(7, dark)), strict=False))


def axis_colours(dark: bool) -> dict[str, str]:
    """Colours of the x, y and z components."""
    return AXIS_COLOURS_DARK if dark else AXIS_COLOURS


def diverging(dark: bool) -> list[list[Any]]:
    """Colour scale for signed quantities; use it with a range symmetric about zero."""
    return DIVERGING_DARK if dark else DIVERGING


def words_on(scale: list[list[Any]], at: FloatArray) -> list[str]:
    """The colour, dark or white, in which words can be read on a colour scale at shares ``at`` (k,) of its length."""
    colours = np.array([[int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)] for _, colour in scale])
    shown = np.stack([np.interp(at, [share for share, _ in scale], channel) for channel in colours.T], axis=-1)
    linear = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    luminance = linear @ np.array([0.2126, 0.7152, 0.0722])  # as WCAG 2 has it: at 0.179 both have the same contrast
    return ["#FFFFFF" if each < 0.179 else "#000000" for each in luminance]


def rgba(colour: str, alpha: float) -> str:
    """A hex colour with opacity, as plotly reads it."""
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return f"rgba({red},{green},{blue},{alpha:g})"


def figure(*, dark: bool, height: int, revision: str = "keep", **layout: Any) -> Chart:
    """An empty figure in the house style; ``revision`` keeps zoom and camera while it stays the same."""
    p = palette(dark)
    base: dict[str, Any] = {
        "height": height,
        "uirevision": revision,
        "template": {"data": {"scatter": [{"type": "scatter"}]}},  # plotly's "none"
        "font": {"family": FONT, "size": 13, "color": p.text},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "margin": {"l": 8, "r": 8, "t": 8, "b": 8},
        "hoverlabel": {
            "bgcolor": p.panel,
            "bordercolor": p.line,
            "font": {"family": FONT, "size": 13, "color": p.text},
        },
        "legend": {
            "orientation": "h",
            "x": 0,
            "xanchor": "left",
            "y": 1.02,
            "yanchor": "bottom",
            "font": {"size": 12.5, "color": p.text},
            "bgcolor": "rgba(0,0,0,0)",
        },
        "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": p.muted, "activecolor": p.accent},
    }
    base.update(layout)
    return Chart(base)


def plain(text: str) -> str:
    """Words that came from a file, which plotly shall show and not read as its markup."""
    return html.escape(text, quote=False)


def hover(unit: str, sign: bool = True, axis: str = "y") -> str:
    """What the pointer reads off a curve of errors: its number, to a decimal more than tables show, in ``unit``."""
    return f"%{{{axis}:{'+' if sign else ''}.{HOVERED}f}} {unit}"


def say(fig: Chart, text: str, x: float, y: float | str, colour: str, **more: Any) -> None:
    """Words in a plane figure, without an arrow; ``more``: size, what x and y refer to, where they are anchored."""
    font = {"size": more.pop("size", 12), "color": colour}
    fig.annotate(x=x, y=y, text=text, showarrow=False, font=font, **more)


def arrow(fig: Chart, tail: Point, head: Point, colour: str, width: float = 1.2, **more: Any) -> None:
    """An arrow in the axes of a plane figure; ``more`` says how its head looks."""
    drawn = {"arrowhead": 2, **more, "arrowwidth": width, "arrowcolor": colour, "showarrow": True, "text": ""}
    axes = {"xref": "x", "yref": "y", "axref": "x", "ayref": "y"}
    fig.annotate(x=head[0], y=head[1], ax=tail[0], ay=tail[1], **axes, **drawn)


# Small and large numbers as they are, not "200µ" of the unit beside it.
PLAIN = {"exponentformat": "power", "minexponent": 5}


def axis(title: str, *, dark: bool, **more: Any) -> dict[str, Any]:
    """A plane axis with its title (quantity and unit) and quiet grid lines."""
    p = palette(dark)
    return {
        "title": {"text": title, "standoff": 8, "font": {"size": 13, "color": p.muted}},
        "gridcolor": p.grid,
        "linecolor": p.line,
        "showline": True,
        "zeroline": False,
        "ticks": "outside",
        "ticklen": 4,
        "tickcolor": p.line,
        "tickfont": {"size": 12, "color": p.muted},
        "automargin": True,
        **PLAIN,
        **more,
    }


def axis3d(title: str, *, dark: bool, **more: Any) -> dict[str, Any]:
    """A scene axis with its title (quantity and unit)."""
    p = palette(dark)
    return {
        "title": {"text": title, "font": {"size": 12, "color": p.muted}},
        "gridcolor": p.grid,
        "linecolor": p.line,
        "zeroline": False,
        "showbackground": False,
        "tickfont": {"size": 11, "color": p.muted},
        "nticks": 5,
        **PLAIN,
        **more,
    }


def colour_bar(title: str, *, dark: bool, **more: Any) -> dict[str, Any]:
    """A slim colour bar with its quantity and unit."""
    p = palette(dark)
    return {
        "title": {"text": title, "side": "right", "font": {"size": 12, "color": p.muted}},
        "thickness": 10,
        "outlinewidth": 0,
        "tickfont": {"size": 11, "color": p.muted},
        "ticklen": 3,
        "tickcolor": p.line,
        "x": 1.01,
        "xpad": 4,
        **PLAIN,
        **more,
    }
