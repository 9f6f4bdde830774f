"""What remedies were tried for a cut and what each leaves, as rows that a report shows."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from robomill.errors import RobomillError
from robomill.improve.advice import Advice
from robomill.improve.compensation import Compensation
from robomill.improve.design import Design
from robomill.improve.placed import Place, Placement
from robomill.improve.remedies import Both, Remedy, Stiffened, remedy_of
from robomill.improve.turning import Turning
from robomill.provenance import Finding
from robomill.simulation.judging.verdict_words import TITLES
from robomill.simulation.run import simulate
from robomill.simulation.setup import SimulationSetup
from robomill.units import (
    format_count,
    format_duration,
    format_many,
    format_number,
    format_plain,
    format_si,
    from_si,
)

Made = Advice | Both | Compensation | Design | Placement | Stiffened | Turning
NOTED = 1.005  # times as stiff: what is less is not told with two decimals


@dataclass(frozen=True)
class Told:
    """A remedy: what is done, what it leaves in a sentence, and the verdict then ("" where there is none)."""

    title: str
    what: str
    leaves: str
    verdict: str = ""


def refused(remedy: Remedy, why: RobomillError) -> Told:
    """A remedy that does not apply."""
    return Told(remedy.title, "does not apply", str(why))


def _cut(found: Advice, title: str) -> list[Told]:
    rows = []
    for way in found.ways[1:]:  # the first is the cut as it is
        if way.run is None:
            rows.append(Told(way.title, "does not apply", way.refused))
        else:
            verdict = way.run.verdict
            rows.append(
                Told(way.title, f"{format_duration(way.seconds)} at feed", verdict.sentence, TITLES[verdict.level])
            )
    return rows


def _stiffened(found: Stiffened, title: str) -> list[Told]:
    made, verdict = found.design, found.run.verdict
    ratios = zip(made.setup.robot.joint_numbers, made.stiffness_ratio, strict=True)
    stiffer = [f"joint {number} × {format_number(ratio, 2)}" for number, ratio in ratios if ratio > NOTED]
    what = ", ".join(stiffer) or "no joint need be stiffer"
    what += ", which halves what is used of the tolerance" if found.half and made.feasible else ""
    if not found.half and made.after.setup.tolerance != found.run.setup.tolerance:
        what += f", to keep {format_plain(from_si(made.after.setup.tolerance, 'mm'), 4)} mm"
    return [Told(title, what, verdict.sentence if made.feasible else made.sentence, TITLES[verdict.level])]


def _zero(place: Place) -> str:
    return (
        f"part zero at ({format_many(place.zero, 'mm', 1, with_unit=False)}) mm, yaw {format_si(place.yaw, 'deg', 1)}"
    )


def _placed(found: Placement, title: str) -> list[Told]:
    return [_at(found.best, title, _zero(found.best))]


def _turned(found: Turning, title: str) -> list[Told]:
    spin = f"at {format_si(found.spin, 'deg', 0)} on the whole path"
    return [_at(found.constant, title, spin), _at(found.course, title, "turning along the path")]


def _at(place: Place, title: str, what: str) -> Told:
    return Told(title, what, place.reason or place.sentence, TITLES[place.level])


def _program(found: Compensation, title: str) -> list[Told]:
    left, wrong = format_si(found.after.max, "mm", 4), format_si(found.doubted.max, "mm")
    leaves = [f"{left} at most; {wrong} if stiffness or force is 20 % off."]
    leaves += [Finding("info", each.message).sentence for each in found.findings]
    what = f"a new program, {format_count(found.lines_in, 'line')} become {format_count(found.lines_out)}"
    return [Told(title, what, " ".join(leaves), TITLES[found.level])]


def _both(found: Both, title: str) -> list[Told]:
    return [replace(row, what=f"{_zero(found.place.best)}; {row.what}") for row in _program(found.program, title)]


ROWS: dict[str, Callable[[Any, str], list[Told]]] = {
    "program": _program,
    "stiffen": _stiffened,
    "place": _placed,
    "both": _both,
    "turn": _turned,
    "cut": _cut,
}
"""What is said of a remedy that was computed, by its code."""


def told(found: Made) -> list[Told]:
    """The rows of a remedy that was computed. Raises RobomillError for what is none."""
    made = Stiffened(found, found.after) if isinstance(found, Design) else found
    remedy = remedy_of(made)
    if remedy is None:
        raise RobomillError(
            f"remedies: found {type(found).__name__}; expected what rm.advise, rm.compensate, rm.design, rm.place or "
            "rm.turn return."
        )
    return ROWS[remedy.code](made, remedy.title)


def told_of(setup: SimulationSetup, found: Made | Sequence[Made]) -> list[Told]:
    """The rows of what was computed for a cut, one remedy or several. Raises RobomillError for what is none, and for
    one of another cut; stiffer joints may have been sought for another tolerance, and are judged by that of the cut."""
    rows: list[Told] = []
    for each in found if isinstance(found, Sequence) else (found,):
        own, design = _sought_for(each), each.design if isinstance(each, Stiffened) else each
        if own is not None and (own.replace(**setup.tolerances) if isinstance(design, Design) else own) != setup:
            raise RobomillError(
                f"remedies: this {type(each).__name__} was computed for another set-up than the one that is reported; "
                "compute it for that one."
            )
        if isinstance(each, Design) and own != setup:
            rows += told(Stiffened(each, simulate(setup.replace(robot=each.setup.robot))))
        else:
            rows += told(each)
    return rows


def _sought_for(found: Made) -> SimulationSetup | None:
    """The cut that a remedy was sought for; None of what is no remedy."""
    made = found.place if isinstance(found, Both) else found.design if isinstance(found, Stiffened) else found
    before = made.before if isinstance(made, Design) else made
    return getattr(before, "setup", None) if remedy_of(found) or isinstance(found, Design) else None
