"""The verdict of a milled part: its walls and floors against their tolerances, as a gauge would read them."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from robomill.arrays import IntArray
from robomill.provenance import Finding, named
from robomill.simulation.assumed import far_share
from robomill.simulation.gauge import Gauge, Readings
from robomill.simulation.seen import Run
from robomill.units import format_percent, format_si

TIGHT_FROM = 0.8
Level = Literal["ok", "tight", "out", "unjudged", "unreached", "missed"]


@dataclass(frozen=True)
class Reading:
    """One quantity of the verdict: its largest value (signed, m) at sample ``worst`` (-1: the cut leaves none, value
    NaN), its ``tolerance`` (m) and the ``share`` of it that is used; ``share_out`` is the share of the length out of
    tolerance. ``stated`` is False where the tolerance is that of another quantity and it is told, not judged."""

    worst: int
    value: float
    tolerance: float
    share_out: float = 0.0
    stated: bool = True

    @property
    def share(self) -> float:
        """Of the tolerance; NaN where there is no value."""
        return abs(self.value) / self.tolerance

    @property
    def decides(self) -> bool:
        """Whether the verdict rests on it, too."""
        return self.stated and self.worst >= 0


@dataclass(frozen=True)
class Verdict:
    """``level`` ok | tight | out | unjudged | unreached | missed; ``share`` of the tolerance used by what decides; one
    sentence for a foreman.

    wall    across the feed, left of it +: walls that are on the part in the end
    floor   along the tool axis, up +: floors that are on the part in the end
    feed    along the feed, ahead +: the largest on the path. It leaves no mark on a straight groove; at corners it
            moves a wall and counts there
    end     along the feed, where a cut begins or ends in the material: how far its end wall is moved
            (``feed`` and ``end`` decide only where the feed has a tolerance of its own)
    far     the share of the tolerance used at the worse end of what is assumed of the force; NaN where nothing is
    """

    level: Level
    share: float
    sentence: str
    wall: Reading
    floor: Reading
    feed: Reading
    end: Reading
    far: float = float("nan")

    @property
    def red(self) -> bool:
        return self.level in ("out", "unjudged", "unreached", "missed")


GONE = "a wall that should stand is cut away"
RAPID = "a rapid runs through material that no cut removes"
WORDS: dict[Level, str] = {
    "ok": "within tolerance",
    "tight": "within tolerance, tight",
    "out": "out of tolerance",
}


def judge(result: Run, gauge: Gauge) -> Verdict:
    """The verdict of a run. What has no model or no answer is counted and never green."""
    readings = _readings(result, gauge)
    wall, floor, feed, end = readings
    deciding = [reading for reading in readings if reading.decides]
    share = max((r.share for r in deciding), default=float("nan"))
    if not deciding and result.worst >= 0:  # nothing is left that could be measured: the tip's own deviation decides
        share = result.max_deviation / wall.tolerance
    level: Level = "out" if share > 1.0 else "tight" if share >= TIGHT_FROM else "ok"
    far = far_share(result, gauge, (wall.tolerance, floor.tolerance, feed.tolerance if feed.stated else float("inf")))
    if far > 1.0 and level == "ok":
        level = "tight"
    said = f"{_said(result, readings, share)}: {WORDS[level]}"
    if far > 1.0 and level == "tight":
        said += f" (up to {format_percent(far)} at the ends of the share assumed of its force)"
    if len(gauge.gone):
        lines = named(result.path.block[gauge.gone].tolist())
        level, said = "out", f"{said}; {GONE} (line {lines}): {WORDS['out']}"
    unknown = unjudged_words(result)
    if result.worst < 0:
        level, said = _nothing(result)
    elif result.missed.any():
        level, said = "unreached", f"{missed_words(result)}; of the rest: {said}."
    elif result.not_judged.any() and not deciding:
        level, said = "unjudged", ""
    elif unknown and level != "out":
        level, said = "unjudged", f"{said}, where it is judged."
    else:
        said += "."
    for more in (unknown if level != "missed" else "", early_words(result)):
        said = f"{said} {more}.".strip() if more else said
    return Verdict(level, share, said, *readings, far)


def _readings(result: Run, gauge: Gauge) -> tuple[Reading, Reading, Reading, Reading]:
    setup, i = result.setup, result.judged
    wall_tolerance = setup.tolerance
    floor_tolerance, feed_tolerance = (
        wall_tolerance if own is None else own for own in (setup.floor_tolerance, setup.feed_tolerance)
    )
    stated = setup.feed_tolerance is not None
    along = np.where(i, np.abs(result.delta_in_cut[:, 0]), -np.inf)
    feed = int(np.argmax(along)) if i.any() else -1
    value = float(result.delta_in_cut[feed, 0]) if feed >= 0 else float("nan")
    return (
        _reading(gauge.walls, wall_tolerance),
        _reading(gauge.floors, floor_tolerance),
        Reading(feed, value, feed_tolerance, stated=stated),
        _reading(gauge.ends, feed_tolerance, stated),
    )


def _reading(found: Readings, tolerance: float, stated: bool = True) -> Reading:
    q = found.worst
    if q < 0:
        return Reading(-1, float("nan"), tolerance, stated=stated)
    return Reading(int(found.sample[q]), float(found.error[q]), tolerance, found.share_out(tolerance), stated)


def _said(result: Run, readings: tuple[Reading, Reading, Reading, Reading], share: float) -> str:
    """What a gauge would read, without the judgement; the larger share of its tolerance comes first."""
    wall, floor, feed, end = readings
    parts = []
    if wall.worst >= 0:
        way = "left" if wall.value > 0 else "right"
        parts.append((wall.share, f"wall {_size(wall)} to the {way} {_of(result, wall)}"))
    if floor.worst >= 0:
        way = "too high" if floor.value > 0 else "too deep"
        parts.append((floor.share, f"floor {_size(floor)} {way} {_of(result, floor)}"))
    parts.sort(key=lambda part: -part[0])
    along = [(r, name) for r, name in ((end, "end"), (feed, "tip")) if r.decides]
    if along:
        reading, name = max(along, key=lambda each: each[0].share)
        parts.append((reading.share, f"{name} {_size(reading)} along the feed {_of(result, reading)}"))
    if not parts:
        largest, allowed = (format_si(v, "mm", 2) for v in (result.max_deviation, result.setup.tolerance))
        where = f"at line {result.worst_block} ({format_percent(share)} of {allowed})"
        return f"No wall or floor is left to measure; the tip is {largest} off {where}"
    text = ", ".join(words for _, words in parts)
    return text[0].upper() + text[1:]


def _size(reading: Reading) -> str:
    return format_si(abs(reading.value), "mm", 2)


def _of(result: Run, reading: Reading) -> str:
    line = f"at line {int(result.path.block[reading.worst])}"
    return f"{line} ({format_percent(reading.share)} of {format_si(reading.tolerance, 'mm', 2)})"


def unjudged_words(result: Run) -> str:
    """How many points of the cut are not judged, on which lines, and why, and which rapids; "" where all is."""
    lost, said = result.not_judged, []
    if lost.any():
        why = result.unjudged[0].why if result.unjudged else "no number of the force is known there."
        more = f" (and {len(result.unjudged) - 1} more reasons)" if len(result.unjudged) > 1 else ""
        points = f"{int(lost.sum())} of {int(result.path.cutting.sum())} points of the cut are not judged"
        said.append(f"{points} (line {named(result.path.block[lost].tolist())}): {why.rstrip('.')}{more}")
    if result.rapids:
        said.append(f"{RAPID[0].upper()}{RAPID[1:]} (line {named(result.rapids)}): not judged")
    return ". ".join(said)


def early_words(result: Run) -> str:
    """Which rapids come before what they run through is cut; "" where none does."""
    lines = result.early_rapids
    return f"A rapid runs through material that is cut only later (line {named(lines)})" if lines else ""


def thin_wall_notes(block: IntArray) -> tuple[Finding, ...]:
    """Walls that bend under the cut, by the source lines (t,) that leave them."""
    if not len(block):
        return ()
    text = (
        f"a wall is left that is thinner than an eighth of its height (line {named(block.tolist())}); that it gives "
        "way to the cutter is not in the numbers."
    )
    return (Finding("warning", int(block.min()), text, code="thin-wall"),)


def missed_words(result: Run) -> str:
    """How many points have no answer though a model holds there, and why."""
    missed = result.missed
    why = "cannot be reached" if not result.reached.all() else "lie outside the measured map"
    return f"{int(missed.sum())} of {len(result.path)} points {why} (line {named(result.path.block[missed].tolist())})"


def _nothing(result: Run) -> tuple[Level, str]:
    """Level and sentence where not one sample counts."""
    if result.not_judged.any() or result.rapids:
        return "unjudged", ""
    if result.answered[result.path.cutting].any():
        return "missed", "The path never touches the stock: move the stock or the path."
    if result.reached.any():
        return "unreached", "No point of the cut lies inside the measured map."
    return "unreached", "No point of the cut can be reached: move the part zero."
