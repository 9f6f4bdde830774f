"""What the page says about a path: its numbers, counted once and not at every rerun, and the words made of them."""

from collections.abc import Sequence
from functools import lru_cache

from robomill.arrays import FloatArray
from robomill.provenance import Finding
from robomill.toolpath.findings import NO_UNITS, UNITS_OF_FEED
from robomill.toolpath.path import Toolpath
from robomill.toolpath.source import GCodeSource
from robomill.toolpath.summary import summary_of
from robomill.toolpath.text import is_apt
from robomill.units import format_count, format_many, format_si
from robomill.wording import listed

#: The summary of a path, kept for the last few.
path_summary = lru_cache(maxsize=6)(summary_of)


FLAT = 1e-9  # m


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
    return f"{format_many(size[along], unit, 1, ' × ')} along {listed(axes)}"


def written_in(source: GCodeSource, path: Toolpath, long: bool = False) -> str:
    """The program's units and who says so: ``mm (G21)``, ``mm, assumed (no G20 or G21)``."""
    name = {"mm": "millimetres" if long else "mm", "in": "inches" if long else "in"}.get(path.units, path.units)
    apt = is_apt(source.text[:200_000].encode())
    if any(f.code == NO_UNITS for f in path.findings):
        return f"{name}, assumed ({'no UNITS' if apt else 'no G20 or G21'})"
    if any(f.code == UNITS_OF_FEED for f in path.findings):
        return f"{name}, as its feeds are (no UNITS)"
    return f"{name} ({'UNITS' if apt else 'G20' if path.units == 'in' else 'G21'})"


def move_words(path: Toolpath) -> str:
    """``27 moves, 5 arcs``: every move of the program, an arc as one; without arcs where they are not known."""
    counts = path.counts
    if counts is None:
        return format_count(len(path) - 1, "move")
    return f"{format_count(sum(counts), 'move')}, {format_count(counts[2], 'arc') if counts[2] else 'no arcs'}"
