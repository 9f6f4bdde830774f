"""What the page says about a path: its numbers, counted once and not at every rerun, and the words made of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.provenance import Finding
from robomill.simulation.reach import PathReach
from robomill.toolpath.apt import is_apt
from robomill.toolpath.gcode.findings import NO_UNITS
from robomill.toolpath.path import Toolpath
from robomill.toolpath.source import GCodeSource
from robomill.units import format_count, format_many, format_si, from_si


@dataclass(frozen=True, eq=False)
class PathSummary:
    """Counts, extents and ranges of a path; SI units.

    blocks cutting source lines; low, high (3,) m corners of feed moves; rapids m; feeds, spindles (lowest, highest).
    """

    moves: int
    cuts: int
    blocks: int
    low: FloatArray
    high: FloatArray
    rapids: float
    feeds: tuple[float, float] | None
    spindles: tuple[float, float] | None
    tools: tuple[int, ...]


@lru_cache(maxsize=6)
def path_summary(path: Toolpath) -> PathSummary:
    """The summary of a path (kept for the last few)."""
    low, high = path.extents
    feeds = path.v_f[path.cutting & (path.step_length > 0)]
    spindles = path.n_s[path.cutting & np.isfinite(path.n_s)] if path.n_s.any() else np.empty(0)
    return PathSummary(
        moves=len(path) - 1,
        cuts=int(path.cutting.sum()),
        blocks=len(distinct(path.block[path.cutting])),
        low=low,
        high=high,
        rapids=float(path.step_length[~path.cutting].sum()),
        feeds=_range(feeds),
        spindles=_range(spindles),
        tools=tuple(int(t) for t in distinct(path.tool) if t > 0),
    )


@lru_cache(maxsize=6)
def missed_blocks(reach: PathReach) -> tuple[int, float, IntArray]:
    """How many samples at feed are out of reach, the length (m) they stand for, and their source lines."""
    lost = reach.missed
    if not lost.any():
        return 0, 0.0, np.empty(0, dtype=np.int64)
    return int(lost.sum()), float(reach.path.step_length[lost].sum()), distinct(reach.path.block[lost])


def distinct(values: IntArray) -> IntArray:
    """Sorted distinct values of whole numbers (m,); by counting where they are small, which beats sorting."""
    if len(values) == 0:
        return np.empty(0, dtype=np.int64)
    low, high = int(values.min()), int(values.max())
    if low < 0 or high > 50_000_000:
        return np.asarray(np.unique(values), dtype=np.int64)
    return np.flatnonzero(np.bincount(values, minlength=1))


def _range(values: FloatArray) -> tuple[float, float] | None:
    return (float(values.min()), float(values.max())) if len(values) else None


FLAT = 1e-9  # m
LONGEST_S = 1e8  # what takes longer is no time that a machine has


def duration(seconds: float) -> str:
    """A time as people say it."""
    if seconds < 120:
        return format_si(seconds, "s", 1)
    if not seconds < LONGEST_S:
        return "more than three years"
    minutes = round(from_si(seconds, "min"))
    return f"{minutes} min" if minutes < 120 else f"{minutes // 60} h {minutes % 60:02d} min"


def worst_first(findings: Sequence[Finding]) -> list[Finding]:
    """Findings in the order of the list: by level, then by line."""
    return sorted(findings, key=lambda f: f.order)


def finding_words(finding: Finding, most: int = 64) -> str:
    """A finding in one line of about ``most`` characters, cut between words."""
    said = (f"line {finding.line}: " if finding.line else "") + finding.message
    return said if len(said) <= most else said[:most].rpartition(" ")[0].rstrip(",;:") + " …"


def size_words(size: FloatArray, unit: str) -> str:
    """How large a path of ``size`` (3,) m is, without the axes along which it has none: ``100.0 mm along X``."""
    along = [i for i in range(3) if size[i] > FLAT]
    axes = ["XYZ"[i] for i in along]
    if not along:
        return "in one place"
    if len(along) == 1:
        return f"{format_si(float(size[along[0]]), unit, 1)} along {axes[0]}"
    return f"{format_many(size[along], unit, 1, ' × ')} along {', '.join(axes[:-1])} and {axes[-1]}"


def written_in(source: GCodeSource, path: Toolpath, long: bool = False) -> str:
    """The program's units and who says so: ``mm (G21)``, ``mm, assumed (no G20 or G21)``."""
    name = {"mm": "millimetres" if long else "mm", "in": "inches" if long else "in"}.get(path.units, path.units)
    apt = is_apt(source.text[:200_000].encode())
    if any(f.code == NO_UNITS for f in path.findings):
        return f"{name}, assumed ({'no UNITS' if apt else 'no G20 or G21'})"
    return f"{name} ({'UNITS' if apt else 'G20' if path.units == 'in' else 'G21'})"


def move_words(path: Toolpath) -> str:
    """``27 moves, 5 arcs``: every move of the program, an arc as one; without arcs where they are not known."""
    counts = path.counts
    if counts is None:
        return format_count(len(path) - 1, "move")
    return f"{format_count(sum(counts), 'move')}, {format_count(counts[2], 'arc') if counts[2] else 'no arcs'}"
