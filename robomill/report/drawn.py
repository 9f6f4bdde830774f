"""Axes of a picture as SVG: from quantities to places on paper, with ticks, bands and lines of many points."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray, stretches
from robomill.report.tags import Html, joined, tag
from robomill.units import format_number

FINEST = 2.0  # columns of a picture's unit of length in which a long line is drawn, each by its ends


@dataclass(frozen=True)
class Axes:
    """A rectangle of a picture (left, top, width, height) that shows ``x`` and ``y``, each (low, high)."""

    left: float
    top: float
    width: float
    height: float
    x: tuple[float, float]
    y: tuple[float, float]

    @property
    def right(self) -> float:
        return self.left + self.width

    @property
    def bottom(self) -> float:
        return self.top + self.height

    def at(self, x: FloatArray | float, y: FloatArray | float) -> tuple[FloatArray, FloatArray]:
        """Places of points on paper."""
        (x_0, x_1), (y_0, y_1) = self.x, self.y
        across = self.left + (np.asarray(x) - x_0) / (x_1 - x_0) * self.width
        return across, self.bottom - (np.asarray(y) - y_0) / (y_1 - y_0) * self.height

    def frame(self, x_title: str, y_title: str, x_ticks: bool = True) -> Html:
        """Grid, numbers and titles."""
        parts = [tag("rect", x=_n(self.left), y=_n(self.top), width=_n(self.width), height=_n(self.height), class_="f")]
        for value, words in ticks(*self.y, max(2, int(self.height // 34))):
            _, y = self.at(self.x[0], value)
            look = "z" if value == 0.0 else "g"
            parts.append(tag("line", x1=_n(self.left), x2=_n(self.right), y1=_n(y), y2=_n(y), class_=look))
            parts.append(tag("text", words, x=_n(self.left - 5), y=_n(float(y) + 3.5), class_="e"))
        low, high = sorted(self.x)
        for value, words in ticks(low, high, max(2, int(self.width // 80))) if x_ticks else ():
            x, _ = self.at(value, self.y[0])
            parts.append(tag("line", x1=_n(x), x2=_n(x), y1=_n(self.top), y2=_n(self.bottom), class_="g"))
            parts.append(tag("text", words, x=_n(x), y=_n(self.bottom + 13), class_="m"))
        middle = self.left + 0.5 * self.width
        parts.append(tag("text", x_title, x=_n(middle), y=_n(self.bottom + (27 if x_ticks else 13)), class_="m"))
        parts.append(tag("text", y_title, x=_n(self.left), y=_n(self.top - 6), class_="b"))
        return joined(parts)

    def line(self, x: FloatArray, y: FloatArray, class_: str) -> Html:
        """A line through points (q,); NaN parts it, and what is finer than the paper is drawn by its ends."""
        across, up = self.at(x, y)
        return tag("path", d=" ".join(_strokes(*_thinned(across, up))), class_=class_)

    def level(self, y: float, words: str, class_: str) -> Html:
        """A level across the picture, with words at its right end."""
        _, at = self.at(self.x[0], y)
        line = tag("line", x1=_n(self.left), x2=_n(self.right), y1=_n(at), y2=_n(at), class_=class_)
        return joined([line, tag("text", words, x=_n(self.right - 3), y=_n(float(at) - 3), class_="e")])

    def stretches(self, x: FloatArray, which: BoolArray, class_: str) -> Html:
        """The parts of ``x`` (q,) where ``which`` (q,) holds, over the whole height."""
        parts = []
        for first, after in stretches(which)[:200]:
            left, _ = self.at(x[max(first - 1, 0)], 0.0)
            right, _ = self.at(x[min(after, len(x) - 1)], 0.0)
            wide = max(float(right - left), 1.0)
            parts.append(tag("rect", x=_n(left), y=_n(self.top), width=_n(wide), height=_n(self.height), class_=class_))
        return joined(parts)


def ticks(low: float, high: float, most: int) -> Iterator[tuple[float, str]]:
    """Round numbers between two ends, with their words."""
    rough = (high - low) / most
    power = 10.0 ** np.floor(np.log10(rough))
    step = next(power * nice for nice in (1.0, 2.0, 5.0, 10.0) if power * nice >= rough * (1 - 1e-9))
    digits = max(0, -int(np.floor(np.log10(step) + 1e-9)))
    for n in range(int(np.ceil(low / step - 1e-9)), int(np.floor(high / step + 1e-9)) + 1):
        yield n * step, format_number(n * step, digits)


def svg(width: int, height: int, said: str, *parts: object) -> Html:
    """A picture; ``said`` is what it says to who cannot see it."""
    return tag("svg", tag("title", said), *parts, viewBox=f"0 0 {width} {height}", role="img", class_="pic")


def _thinned(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Of many points that share a column of the paper the first, the lowest, the highest and the last."""
    if len(x) < 4 * FINEST * 800:
        return x, y
    column = np.floor(x * FINEST)
    starts = np.flatnonzero(np.concatenate([[True], (np.diff(column) != 0) | (np.diff(np.isnan(y)) != 0)]))
    keep = set(starts.tolist()) | {len(x) - 1}
    for first, after in zip(starts, np.append(starts[1:], len(x)), strict=True):
        part = y[first:after]
        if not np.isnan(part[0]):
            keep |= {int(first + np.argmin(part)), int(first + np.argmax(part)), int(after - 1)}
    chosen = np.array(sorted(keep))
    return x[chosen], y[chosen]


def _strokes(x: FloatArray, y: FloatArray) -> Iterator[str]:
    """Commands of a path; a new one begins after each NaN."""
    down = False
    for a, b in zip(x.tolist(), y.tolist(), strict=True):
        known = a == a and b == b
        if known:
            yield f"{'L' if down else 'M'}{a:.1f} {b:.1f}"
        down = known


def _n(value: FloatArray | float) -> str:
    return f"{float(value):.1f}"
