"""What the verdict of a milled part says: its readings, and the one sentence that every screen and report shows."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

import numpy as np

from robomill.arguments import made_by
from robomill.arrays import with_article
from robomill.provenance import named
from robomill.simulation.judging.seen import WHOLE, Run
from robomill.simulation.posture import OTHER_SPIN, TURNED
from robomill.units import format_beside, format_count, format_percent, format_share
from robomill.values import Value

TIGHT_FROM = 0.8
ENDS_AT, MOST = 1.25, 6.0  # of the tolerance: where a gauge of the share used ends, and where at most
Level = Literal["ok", "tight", "out", "unjudged", "unreached", "missed"]
LEVELS: tuple[Level, ...] = get_args(Level)  # each graver than the one before
NO_NUMBER: tuple[Level, ...] = ("unjudged", "unreached", "missed")
RED: tuple[Level, ...] = ("out", *NO_NUMBER)
WORDS: dict[Level, str] = {
    "ok": "within tolerance",
    "tight": "within tolerance, tight",
    "out": "out of tolerance",
}
TITLES: dict[Level, str] = {
    **{level: words.capitalize() for level, words in WORDS.items()},
    "unjudged": "Not judged",
    "unreached": "Out of reach",
    "missed": "Misses the stock",
}
NOTHING: dict[Level, str] = {
    "missed": "The path never touches the stock: move the stock or the path.",
    "unreached": "No point of the cut can be reached: move the part zero.",
}
UNREACHED = {
    OTHER_SPIN: "No point of the cut can be reached at this spin: choose another, or that of least motion.",
    TURNED: "No point of the cut can be reached: turn the tool frame, whose z_T points into the part.",
}
RAPID = "a rapid runs through material that no cut removes"


def level_of_share(share: float) -> Level:
    """ok | tight | out: what a share of the tolerance is; unjudged where nobody knows it."""
    if math.isnan(share):
        return "unjudged"
    return "out" if share > WHOLE else "tight" if share >= TIGHT_FROM else "ok"


def gauge_end(share: float) -> float:
    """The share of the tolerance up to which a gauge is drawn that shows ``share``."""
    return min(max(ENDS_AT, 1.05 * share), MOST)


@dataclass(frozen=True)
class ReadingKind:
    """A quantity of the verdict, declared once.

    code    its name in a verdict and in files
    label   its heading; ``error``: what it is in a sentence ("the wall error at line 3"); ``what`` is off then
    axis    of the cut, along which it is: 0 feed, 1 feed-normal, 2 axial; None: whichever way the tip goes
    ways    to which side it is off where it is more than zero, and where it is less
    """

    code: str
    label: str
    error: str
    what: str
    axis: int | None
    ways: tuple[str, str] = ("along the feed", "along the feed")

    @property
    def an_error(self) -> str:
        """With its article: "a wall error"."""
        return with_article(self.error)


WALL = ReadingKind("wall", "Wall error", "wall error", "wall", 1, ("to the left", "to the right"))
FLOOR = ReadingKind("floor", "Floor error", "floor error", "floor", 2, ("too high", "too deep"))
FEED = ReadingKind("feed", "Along the feed", "error along the feed", "tip along the feed", 0)
END = ReadingKind("end", "End of the cut", "error of an end wall", "end of the cut", 0)
TIP = ReadingKind("tip", "Tip off its path", "deviation of the tip", "tip", None, ("", ""))
KINDS = {kind.code: kind for kind in (WALL, FLOOR, FEED, END)}  # of which a verdict has readings


class Deciding(NamedTuple):
    """What a verdict rests on: the ``kind`` of reading, its ``size`` (m), and the ``sample`` of the path (-1: none).
    Where no reading decides, that is the tip's largest deviation."""

    kind: ReadingKind
    size: float
    sample: int


@dataclass(frozen=True)
class Reading:
    """One quantity of the verdict: its largest value (signed, m) at sample ``worst`` (-1: the cut leaves none, value
    NaN), its ``tolerance`` (m) and the ``share`` of it that is used; ``share_out`` is the share of the length out of
    tolerance. ``stated`` is False where the tolerance is that of another quantity and it is told, not judged."""

    worst: int
    value: float
    tolerance: float
    share_out: float
    stated: bool = True

    @property
    def share(self) -> float:
        """Of the tolerance; NaN where there is no value."""
        return abs(self.value) / self.tolerance

    @property
    def decides(self) -> bool:
        """Whether the verdict rests on it, too."""
        return self.stated and self.worst >= 0


@made_by("rm.simulate(setup)")
@dataclass(frozen=True, eq=False, repr=False)
class Verdict(Value):
    """``level`` ok | tight | out | unjudged | unreached | missed; ``share`` of the tolerance used by what decides; one
    sentence for a foreman.

    wall    across the feed, left of it +: walls that are on the part in the end
    floor   along the tool axis, up +: floors that are on the part in the end
    feed    along the feed, ahead +: the largest on the path. It leaves no mark on a straight groove; at corners it
            moves a wall and counts there
    end     along the feed, where a cut begins or ends in the material: how far its end wall is moved
            (``feed`` and ``end`` decide only where the feed has a tolerance of its own)
    gone    source lines that cut away a wall that should stand
    premise what the readings rest on where nobody has said what is cut, or with how many flutes: ``"if the tool is
            pushed with 100 N"``; else "". ``asked`` is the sentence that says so
    far     the share of the tolerance used at the worse end of what is assumed of the force; NaN where nothing is

    Examples
    --------
    >>> import robomill as rm
    >>> verdict = rm.simulate(rm.load_setup("paper_flute")).verdict
    >>> verdict.level, verdict.sentence
    ('ok', 'The groove is 0.23 mm off in Y and 0.10 mm too deep: within tolerance (77 % of it used).')
    """

    level: Level
    share: float
    sentence: str
    wall: Reading
    floor: Reading
    feed: Reading
    end: Reading
    far: float = float("nan")
    gone: tuple[int, ...] = ()
    premise: str = ""
    asked: str = ""

    @property
    def grade(self) -> Level:
        """ok | tight | out: by what is measured alone."""
        if self.gone:
            return "out"
        found = level_of_share(self.share)
        return "tight" if found == "ok" and self.far > 1.0 else found

    @property
    def red(self) -> bool:
        """Whether the part is out of tolerance, or nothing or not all of it can be judged."""
        return self.level in RED

    def _said(self) -> str:
        return f"{self.level}: {self.sentence}"

    @property
    def deciding(self) -> tuple[str, Reading] | None:
        """What uses the largest share of its tolerance, by name; None where nothing decides."""
        named = [(name, getattr(self, name)) for name in KINDS]
        return max((each for each in named if each[1].decides), key=lambda each: each[1].share, default=None)

    @property
    def decides(self) -> bool:
        """Whether anything that was measured decides."""
        return self.deciding is not None


def said(result: Run, verdict: Verdict, unit: str = "mm") -> tuple[str, str]:
    """What a gauge would read on the part and what follows from it; and beside it how much of the cut is not judged and
    which rapids run through material. Either may be ""."""
    level = verdict.level
    nothing = result.worst < 0 and level == "unjudged" and bool(result.not_judged.any())
    told = (_unjudged(result, why=not nothing), _early(result))
    beside = " ".join(_sentence(words) for words in told if words)
    if nothing:
        return f"Cannot be judged: {_why(result)}.", beside
    if result.worst < 0:
        if level == "unreached" and result.reached[result.path.cutting].any():
            return "No point of the cut lies inside the measured map.", beside
        why = next((UNREACHED[each.code] for each in result.why_unreached), "") if level == "unreached" else ""
        return why or NOTHING.get(level, ""), beside
    if level == "unjudged" and result.not_judged.any() and not verdict.decides:
        return "", beside
    judged = _measured(result, verdict, unit)
    if verdict.grade == "out" or result.mostly_judged:
        judged += f": {WORDS[verdict.grade]} ({_used(verdict)})"
    if verdict.premise:  # a grade by the force of another cut would be none
        judged, beside = f"{_measured(result, verdict, unit)}, {verdict.premise}", f"{verdict.asked} {beside}".rstrip()
    if level == "unreached":
        judged = f"{_missed(result)}; of the rest: {judged}"
    where = ", where it is judged" if level == "unjudged" and not verdict.premise else ""
    return _sentence(f"{judged}{where}"), beside


def way(name: str, reading: Reading) -> str:
    """To which side a wall, floor or end is off."""
    return KINDS[name].ways[0 if reading.value > 0 else 1]


def _at(result: Run, blocks: Iterable[int]) -> str:
    """Where on the path: ``"(line 3, 5)"``."""
    return f"({result.path.block_name} {named(blocks)})"


def _sentence(words: str) -> str:
    return f"{words[0].upper()}{words[1:].rstrip('.')}."


def _used(verdict: Verdict) -> str:
    used = f"{format_share(verdict.share)} of it used"
    if verdict.far > 1.0 and verdict.grade == "tight":
        used += f", up to {format_percent(verdict.far)} at the ends of the share assumed of its force"
    return used


def _measured(result: Run, verdict: Verdict, unit: str) -> str:
    """What a gauge would read, without the judgement."""

    def size(found: Reading) -> str:
        return format_beside(abs(found.value), found.tolerance, unit, 2)

    def line(reading: Reading) -> str:
        return _at(result, [int(result.path.block[reading.worst])])

    wall, floor = verdict.wall, verdict.floor
    # What a nose or a cone leaves is off normal to itself, which is not how far its groove has gone aside.
    upright = all(cutter.nose_height == 0.0 for cutter in result.tooling.cutters)
    if upright and result.path.on_one_line and wall.worst >= 0 and floor.worst >= 0:
        parts = [f"the groove is {size(wall)} off {_aside(result, wall)} and {size(floor)} {way('floor', floor)}"]
    else:
        parts = [
            f"{name}s are up to {size(found)} {way(name, found)} {line(found)}"
            for name, found in (("wall", wall), ("floor", floor))
            if found.worst >= 0
        ]
    along = [
        (found.share, name, found) for found, name in ((verdict.end, "end"), (verdict.feed, "tip")) if found.decides
    ]
    if along:
        _, name, found = max(along)
        parts.append(f"the {name} is {size(found)} off along the feed {line(found)}")
    if not parts:
        off = format_beside(result.max_deviation, verdict.wall.tolerance, unit, 2)
        parts = [f"no wall or floor is left to measure; the tip is {off} off {_at(result, [result.worst_block])}"]
    gone = f"; a wall that should stand is cut away {_at(result, verdict.gone)}" if verdict.gone else ""
    return ", ".join(parts) + gone


def _aside(result: Run, wall: Reading) -> str:
    """Where a straight groove goes: along an axis of the part where its cuts, all on one line, follow the other one."""
    low, high = result.path.extents
    x, y = (high - low)[:2]
    axis = "Y" if x > 0.999 * np.hypot(x, y) else "X" if y > 0.999 * np.hypot(x, y) else ""
    return f"in {axis}" if axis else way("wall", wall)


def _unjudged(result: Run, *, why: bool) -> str:
    """How many points of the cut are not judged, on which lines, ``why`` too, and which rapids; "" where all is."""
    lost, told = result.not_judged, []
    if lost.any():
        lost_points, every = format_count(int(lost.sum())), format_count(int(result.path.cutting.sum()))
        points = f"{lost_points} of {every} points of the cut are not judged"
        reason = f": {_why(result)}" if why else ""
        told.append(f"{points} {_at(result, result.path.block[lost].tolist())}{reason}")
    if result.rapids:
        told.append(f"{RAPID[0].upper()}{RAPID[1:]} {_at(result, result.rapids)}: not judged")
    return ". ".join(told)


def _why(result: Run) -> str:
    """The first reason why points are not judged, and how many more there are."""
    reasons = result.unjudged
    why = reasons[0].why if reasons else "no number of the force is known there"
    more = f" (and {format_count(len(reasons) - 1, 'more reason')})" if len(reasons) > 1 else ""
    return f"{why.rstrip('.')}{more}"


def _early(result: Run) -> str:
    """Which rapids come before what they run through is cut; "" where none does."""
    lines = result.early_rapids
    return f"a rapid runs through material that is cut only later {_at(result, lines)}" if lines else ""


def _missed(result: Run) -> str:
    """How many points have no answer though a model holds there, and why."""
    missed = result.missed
    why = "cannot be reached" if not result.reached.all() else "lie outside the measured map"
    of = f"{format_count(int(missed.sum()))} of {format_count(len(result.path))}"
    return f"{of} points {why} {_at(result, result.path.block[missed].tolist())}"
