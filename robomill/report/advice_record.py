"""Ways to cut a part as a JSON-ready record in display units, and as lines for a person."""

from typing import Any

from robomill.improve.advice import Advice, Way
from robomill.report.design_record import deviations
from robomill.report.records import of_setup
from robomill.units import format_value, from_si


def advice_record(found: Advice) -> dict[str, Any]:
    """Every way with its time and what it leaves, the one there is first."""
    setup = found.setup
    return of_setup(
        setup,
        found.digest(),
        tolerance_mm=float(from_si(setup.tolerance, "mm")),
        best=found.best.name,
        ways=[_way(way) for way in found.ways],
    )


def _way(way: Way) -> dict[str, Any]:
    none = {"max_deviation_mm": None, "wall_mm": None, "floor_mm": None}
    return {
        "name": way.name,
        "title": way.title,
        "feed_factor": way.factor,
        "minutes": float(from_si(way.seconds, "min")),
        "removal_cm3_min": float(from_si(way.removal_rate, "cm3/min")),
        "share": way.share,
        **(deviations(way.run) if way.run else none),
        "verdict": way.run.verdict.level if way.run else None,
        "verdict_sentence": way.run.verdict.sentence if way.run else None,
        "refused": way.refused or None,
    }


def advice_lines(record: dict[str, Any]) -> list[str]:
    """A line a way."""
    lines = []
    for way in record["ways"]:
        if way["refused"]:
            lines.append(f"{way['title']}: does not apply. {way['refused']}")
            continue
        lines.append(f"{way['title']}, {format_value(way['minutes'], 'min')}: {way['verdict_sentence']}")
    best = next(way["title"] for way in record["ways"] if way["name"] == record["best"])
    return [*lines, f"best      {best}"]
