"""The verdict as start, robot, toolpath and milling show it: its tiles, its one sentence and what it leaves out."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import streamlit as st

from robomill.arrays import digest
from robomill.errors import RobomillError
from robomill.identification.knowledge import Knowledge
from robomill.report.ranges import Range, out_over, ranges
from robomill.simulation.judging.verdict_words import FLOOR, TIP, TITLES, WALL, Reading, ReadingKind, Verdict, said, way
from robomill.simulation.result import SimulationResult
from robomill.simulation.tooth import LEFT_OUT
from robomill.ui import pieces, session
from robomill.ui.comparing import other
from robomill.ui.judged import uncertainty
from robomill.ui.pieces import Tile
from robomill.ui.posed.push import by_axis
from robomill.ui.project import Project
from robomill.ui.serving.menu import file_of
from robomill.ui.work import cached
from robomill.ui.work.job import Underway
from robomill.units import format_beside, format_count, format_limit, format_many, format_share, format_si

WORDS = TITLES
TONES = {"unreached": "out", "missed": "out"}  # the others are their own
OPEN = "open"  # hatched: nobody has said yet what is cut
NOTHING = {"unreached": "nothing reached", "unjudged": "not judged"}
SEARCHED = "between which ends: being worked out"  # about as long as what comes
NOT_COUNTED = f"Left out: {', '.join(LEFT_OUT)}."


def verdict_row(result: SimulationResult, unit: str = "mm", dressed: Callable[[list[Tile]], list[Tile]] = list) -> None:
    """The tiles, ``dressed`` as the page likes, with those of B; beneath them how far the search for the ends is, which
    stands and goes without moving them."""
    row = st.container()
    with st.container():
        made = verdict_tiles(result, unit)
    with row:
        other.tiles(dressed(made), tiles_of_b)


def verdict_tiles(result: SimulationResult, unit: str = "mm") -> list[Tile]:
    """What a gauge would read of walls and floors, the tip's deviation as detail, and the verdict."""
    made, searched = plain_tiles(result, unit), ranges_of(result)
    if searched is None:
        return [replace(tile, ranges=[SEARCHED]) if tile.value != "–" else tile for tile in made.values()]
    found = widest_first(searched)
    words = {name: [range_words(each, name, unit) for each in found[:1]] for name in made}
    if out_over(result.verdict, found):
        words["share"].append("so it could be out of tolerance")
    words["share"] += [range_words(each, "share", unit) for each in found[1:]]
    return [replace(tile, ranges=[ends for ends in words[name] if ends]) for name, tile in made.items()]


def plain_tiles(result: SimulationResult, unit: str = "mm") -> dict[str, Tile]:
    """The tiles "wall", "floor", "tip" and "share", without the ends between which their numbers may lie."""
    old = previous(result)
    verdict, before = result.verdict, None if old is None else old.verdict
    share = share_words(verdict)
    if verdict.level == "unjudged" and not verdict.premise:
        lost, total = int(result.not_judged.sum()), int(result.path.cutting.sum())
        share = f"{format_count(lost)} of {format_count(total, 'point')} of the cut are not judged"
        share += " and a rapid through material" if result.rapids else ""
    made = {
        **{kind.code: reading_tile(kind, verdict, before, unit) for kind in (WALL, FLOOR)},
        "tip": tip_tile(result, unit),
        "share": Tile("Verdict", WORDS[verdict.level], share, tone=tone(verdict)),
    }
    if verdict.premise:  # what was stated for another path is not shown as if it were known
        made = {name: replace(tile, tone=tone(verdict)) for name, tile in made.items()}
    return made


def tiles_of_b(project: Project) -> list[Tile]:
    """The same of the project that the one in force is held against. Raises its refusal, and ``Underway``."""
    return list(plain_tiles(other.result(project.setup), project.view.length).values())


def ranges_of(result: SimulationResult) -> tuple[Range, ...] | None:
    """Between which ends the verdict's numbers may lie instead, from the cache; None while that is being found."""
    try:
        return pieces.underway(_ranges, result, session.known(result.setup))
    except RobomillError as exc:
        pieces.error(exc)
        return ()


@cached.shared(
    lambda result, known: (cached.by_result(result), cached.by_knowledge(known)),
    "Between which ends the verdict lies",
)
def _ranges(result: SimulationResult, known: Knowledge | None) -> tuple[Range, ...]:
    return ranges(result, known)


def widest_first(found: Sequence[Range]) -> list[Range]:
    """The range that leads, at whose end most of the tolerance is used, and then those that say less."""
    return sorted(found, key=lambda each: -each.share[1] if np.isfinite(each.share[1]) else np.inf)


def range_words(found: Range, name: str, unit: str) -> str:
    """The ends of ``name`` ("wall", "floor", "tip" or "share") in words; "" where there are none."""
    low, high = getattr(found, name)
    if not np.isfinite([low, high]).all() or (format_si(low, unit), low) == (format_si(high, unit), high):
        return ""
    if name == "share":
        return f"{format_share(low)} to {format_share(high)}: {found.over}"
    ends = format_many((low, high), unit, between=" to ", sign=name != "tip", with_unit=False)
    return f"{ends}: {found.over}"


def share_words(verdict: Verdict) -> str:
    """How much of the tolerance is used, or why nobody knows."""
    if np.isfinite(verdict.share):
        return f"{format_share(verdict.share)} of the tolerance used {verdict.premise}".rstrip()
    return NOTHING.get(verdict.level, "nothing cut")


def tone(verdict: Verdict) -> str:
    """The coloured edge of a tile that says the verdict."""
    return OPEN if verdict.premise else TONES.get(verdict.level, verdict.level)


def reading_tile(kind: ReadingKind, verdict: Verdict, before: Verdict | None, unit: str) -> Tile:
    """One quantity of the verdict, that of walls or of floors, against its tolerance."""
    label, name = kind.label, kind.code
    reading: Reading = getattr(verdict, name)
    if reading.worst < 0:
        return Tile(label, "–", NOTHING.get(verdict.level, f"the cut leaves no {name}"))
    allowed = format_limit(reading.tolerance, unit)
    was = change = ""
    if before is not None and getattr(before, name).worst >= 0:
        was = format_si(getattr(before, name).value, unit, sign=True)
        change = format_si(reading.value - getattr(before, name).value, unit, sign=True)
    value = format_beside(reading.value, reading.tolerance, unit, sign=True)
    return Tile(
        label,
        value,
        f"{way(name, reading)} · {format_share(reading.share)} of {allowed}",
        was,
        change,
        kind="computed",
    )


def tip_tile(result: SimulationResult, unit: str) -> Tile:
    """How far the tip is off its path where that is most: the vector behind what is judged."""
    old = previous(result)
    i = result.worst
    if i < 0:
        return Tile(TIP.label, "–", NOTHING.get(result.verdict.level, "nothing cut"))
    shown = partial(format_si, unit=unit)
    was = change = ""
    if old is not None:
        was = shown(old.max_deviation)
        change = format_si(result.max_deviation - old.max_deviation, unit, sign=True)
    parts = ", ".join(map(" ".join, by_axis(result.delta[i], unit)))
    stray = result.stray
    fate = f": {stray.words}" if stray is not None and stray.fate != "stays" else ""
    note = f"{parts} · most at line {result.worst_block}{fate}"
    value = uncertainty.tile_text(result, unit) or shown(result.max_deviation)
    return Tile(TIP.label, value, note, was, change)


def verdict_sentence(result: SimulationResult, unit: str = "mm") -> str:
    """What a gauge would read on the part, for a foreman, and how much of the cut is not judged."""
    return " ".join(said(result, result.verdict, unit)).strip()


def headline(result: SimulationResult, unit: str = "mm") -> str:
    """What a gauge would read on the part, and over what a cut within tolerance may be out of it, where that is known
    by now."""
    words = next(filter(None, said(result, result.verdict, unit)), "")
    try:
        found = widest_first(out_over(result.verdict, _ranges(result, session.known(result.setup))))
    except (RobomillError, Underway):
        return words
    return f"{words} It could be out (up to {format_share(found[0].share[1])}: {found[0].over})." if found else words


def beside(result: SimulationResult, unit: str = "mm") -> str:
    """What stands beneath the headline: how much of the cut is not judged, and what runs through material."""
    told, more = said(result, result.verdict, unit)
    return more if told else ""


def open_question(result: SimulationResult, on: str = "") -> None:
    """The way to where that is said for want of which nothing is judged: what the project's program cuts, with how many
    flutes, or a force of the material that its source does not give. None where that is the page one is ``on``."""
    if result.setup.carried_from:
        page, label = "Toolpath", "Say what it cuts"
    elif result.verdict.premise:
        page, label = "Milling", "Say it on the Milling page"
    elif any(each.names for each in result.unjudged):
        page, label = "Milling", "Give an assumed share or take another material, on the Milling page"
    else:
        return
    if page != on:
        st.page_link(file_of(page), label=label, icon=":material/help:")


def previous(result: SimulationResult) -> SimulationResult | None:
    """The result before the last change of the project, if it is a different one of the same path."""
    old = session.before()
    if old is None or old.setup.digest() == result.setup.digest():
        return None
    if digest(old.setup.source) != digest(result.setup.source):
        return None  # two different parts are not before and after
    held = cached.held(old.setup)
    return None if held is None or held.verdict.premise else held  # what rested on another cut was no answer
