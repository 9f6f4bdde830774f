"""The four tiles and the one sentence that start, robot and milling page share."""

from __future__ import annotations

import numpy as np

from robomill.arrays import digest
from robomill.errors import RobomillError
from robomill.simulation.result import SimulationResult
from robomill.simulation.stations import groove_error, one_groove, place_at
from robomill.ui import cached, session, uncertainty
from robomill.ui.pieces import Tile
from robomill.units import format_percent, format_si

WORDS = {
    "ok": "In tolerance",
    "tight": "Tight",
    "out": "Out of tolerance",
    "unjudged": "Not judged",
    "unreached": "Out of reach",
    "missed": "Misses the stock",
}
TONES = {"ok": "ok", "tight": "tight", "out": "out", "unjudged": "out", "unreached": "out", "missed": "out"}


def verdict_tiles(result: SimulationResult, unit: str = "mm") -> list[Tile]:
    """Max, RMS, worst line and verdict, each beside its value before the last change."""
    old = previous(result)
    digits = 4 if unit == "in" else 3
    verdict = result.verdict
    i = result.worst

    def shown(value: float) -> str:
        return format_si(value, unit, digits)

    def was(name: str) -> tuple[str, str]:
        if old is None:
            return "", ""
        before = float(getattr(old, name))
        return shown(before), format_si(float(getattr(result, name)) - before, unit, digits, sign=True)

    parts = ""
    if i >= 0:
        parts = " · ".join(
            f"{a} {format_si(v, unit, digits, sign=True).rpartition(' ')[0]}" for a, v in zip("XYZ", result.delta[i])
        )
    share = f"{format_percent(verdict.share)} of {format_si(result.setup.tolerance, unit, 2 if unit == 'mm' else 4)}"
    largest = uncertainty.tile_text(result, unit) or shown(result.max_deviation)
    return [
        Tile("Max deviation", largest, parts, *was("max_deviation"), kind="computed"),
        Tile("RMS along the cut", shown(result.rms_deviation), "over the length cut", *was("rms_deviation")),
        Tile("Worst line", f"Line {result.worst_block}" if i >= 0 else "none reached", _where(result, unit)),
        Tile(
            "Verdict",
            WORDS[verdict.level],
            share if np.isfinite(verdict.share) else "nothing reached",
            tone=TONES[verdict.level],
        ),
    ]


def verdict_sentence(result: SimulationResult, unit: str = "mm") -> str:
    """What the cut will be like, for a foreman: sideways and depth error where it is worst."""
    i = result.worst
    if i < 0:
        return result.verdict.sentence
    digits = 3 if unit == "in" else 2
    aside, depth = groove_error(result, i)
    if np.isnan(aside):
        return result.verdict.sentence
    words = "too deep" if depth < 0 else "too shallow"
    if not one_groove(result.path):
        worst, sideways, down = (format_si(abs(v), unit, digits) for v in (result.max_deviation, aside, depth))
        return f"At worst {worst} off, at line {result.worst_block}: {sideways} aside and {down} {words}."
    feed = np.abs(place_at(result.path, float(result.path.s[i]))[1][:2])
    axis = "Y" if feed[0] > 0.999 * np.hypot(*feed) else "X" if feed[1] > 0.999 * np.hypot(*feed) else ""
    name = f"in {axis}" if axis else ("to the left" if aside > 0 else "to the right")
    sideways, down = (format_si(abs(v), unit, digits) for v in (aside, depth))
    return f"The groove is {sideways} off {name} and {down} {words}."


def previous(result: SimulationResult) -> SimulationResult | None:
    """The result before the last change of the project, if it is a different one of the same path."""
    old = session.before()
    if old is None or old.setup.digest() == result.setup.digest():
        return None
    if digest(old.setup.source) != digest(result.setup.source):
        return None  # two different parts are not before and after
    try:
        return cached.result(old.setup)
    except RobomillError:
        return None


def _where(result: SimulationResult, unit: str) -> str:
    if result.worst < 0:
        return ""
    return f"after {format_si(float(result.path.s[result.worst]), unit, 1 if unit == 'mm' else 3)} of cut"
