"""What the toolpath page says first: one sentence, and the tiles."""

import dataclasses

import numpy as np

from robomill.provenance import Finding
from robomill.simulation.edges import edge_notes
from robomill.simulation.judging.verdict_words import FLOOR, WALL, said
from robomill.simulation.reach import PathReach
from robomill.simulation.result import SimulationResult
from robomill.simulation.tools import feed_notes
from robomill.toolpath.path import Toolpath
from robomill.toolpath.source import PathSource
from robomill.ui import pieces
from robomill.ui.comparing import other
from robomill.ui.judged.verdict import reading_tile, tip_tile, tone
from robomill.ui.project import Project
from robomill.ui.toolpath.reach import path_reach
from robomill.ui.toolpath.summary import (
    finding_words,
    move_words,
    path_summary,
    size_words,
    worst_first,
    written_in,
)
from robomill.units import (
    format_count,
    format_duration,
    format_si,
    format_value,
)

NOUNS = {"program": "cut", "lines": "cut", "sketch": "shape", "points": "move"}


def headline(
    source: PathSource, path: Toolpath | None, reach: PathReach | None, result: SimulationResult | None, unit: str
) -> None:
    """Whether the path can be reached and how far off it is; beneath, what was read.

    Always two lines, so that the board beneath does not move while one draws.
    """
    if path is None:
        pieces.headline(f"Toolpath · {source.name}", "There is no path yet.", "Draw one, or take a ready-made sketch.")
        return
    summary = path_summary(path)
    lead = f"{format_count(summary.blocks, NOUNS[source.kind])}, {size_words(summary.high - summary.low, unit)}."
    if source.kind == "program":
        lead = f"{written_in(source, path)} · {lead}"
    if reach is not None and result is not None and not reach.missed.any():
        lead = f"{lead} {said(result, result.verdict, unit)[1]}".rstrip()
    pieces.headline(f"Toolpath · {source.name}", verdict(reach, result, unit), lead)


def verdict(reach: PathReach | None, result: SimulationResult | None, unit: str) -> str:
    """The page's one sentence."""
    if reach is None:
        return "The path was read; the arm was not asked."
    if reach.missed.any():
        return f"{format_si(reach.missed_length, unit, 1)} of the cut cannot be reached."
    if result is None:
        return "The arm reaches all of the path."
    words = said(result, result.verdict, unit)[0] or "the cut is not judged."
    return f"All in reach; {words[0].lower()}{words[1:]}"


def tiles(
    source: PathSource, path: Toolpath | None, reach: PathReach | None, result: SimulationResult | None, unit: str
) -> list[pieces.Tile]:
    """The error that decides the verdict, reach, length and time, findings."""
    if path is None:
        return [pieces.Tile(label, "–") for label in (WALL.label, "Reach", "Length of the cut", "Shapes")]
    summary = path_summary(path)
    rapids = summary.moves - summary.cuts if path.counts is None else path.counts[0]
    found = [_error_tile(result, unit)]
    if reach is None:
        found.append(pieces.Tile("Reach", "not computed"))
    else:
        blocks = reach.missed_blocks.tolist()
        named = ", ".join(str(b) for b in blocks[:3]) + (" …" if len(blocks) > 3 else "")
        words = f"out of reach at {source.block_name} {named}" if blocks else "of the cut, within the joint limits"
        reached = format_value(np.floor(reach.share * 100), "%", 0)  # what is not all of it must not read 100 %
        found.append(pieces.Tile("Reach", reached, words, tone="out" if blocks else "ok"))
    found.append(
        pieces.Tile(
            "Length of the cut",
            format_si(float(path.s[-1]), unit, 1),
            f"{format_duration(float(path.t[-1]))} · {move_words(path)}, {format_count(rapids)} rapid",
        )
    )
    if source.kind != "program":
        words = "cut in this order" if summary.blocks > 1 else "one cut"
        found.append(
            pieces.Tile(
                {"sketch": "Shapes", "lines": "Rows", "points": "Moves"}[source.kind],
                format_count(summary.blocks),
                words,
            )
        )
        return found
    noticed = findings(path, result)
    alarming = sum(f.count for f in noticed if f.level in ("error", "warning", "suspicious"))
    words = finding_words(worst_first(noticed)[0], most=110) if noticed else "every word understood"
    crashes = () if result is None else (*result.rapids, *result.early_rapids)
    if crashes:
        alarming, words = alarming + len(crashes), f"a rapid runs through material (line {crashes[0]})"
    elif noticed and not alarming:
        words = f"{format_count(sum(f.count for f in noticed), 'note')}: {words}"
    found.append(pieces.Tile("Program warnings", format_count(alarming), words, tone="tight" if alarming else ""))
    return found


def tiles_of_b(project: Project) -> list[pieces.Tile]:
    """The same of the project that the one in force is held against. Raises its refusal, and ``Underway``."""
    result = other.result(project.setup)
    reach = path_reach(project.setup)
    return tiles(project.setup.source, project.setup.toolpath, reach, result, project.view.length)


def findings(path: Toolpath, result: SimulationResult | None) -> tuple[Finding, ...]:
    """What was noticed while the program was read; once cutter and stock are known, feeds that no cutter takes and
    sides of the stock along which no wall can stand."""
    if result is None:
        return path.findings
    return (*path.findings, *feed_notes(result.setup, result.path), *edge_notes(result.setup, result.path))


def _error_tile(result: SimulationResult | None, unit: str) -> pieces.Tile:
    """The error that decides the verdict; the tip's deviation where no wall and no floor is left to be measured."""
    if result is None:
        return pieces.Tile(WALL.label, "–", "not simulated yet")
    verdict, kind = result.verdict, result.decided.kind
    kind = WALL if result.worst < 0 else kind
    found = reading_tile(kind, verdict, None, unit) if kind in (WALL, FLOOR) else tip_tile(result, unit)
    return dataclasses.replace(found, tone=tone(verdict))
