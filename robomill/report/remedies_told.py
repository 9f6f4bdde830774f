"""What remedies were tried for a cut and what each leaves, as rows that a report shows."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from robomill.errors import RobomillError
from robomill.improve.advice import Advice
from robomill.improve.compensation import Compensation
from robomill.improve.design import Design
from robomill.improve.placed import Placement
from robomill.improve.turning import Turning
from robomill.provenance import Finding
from robomill.report.advice_record import advice_record
from robomill.report.compensation_record import compensation_record
from robomill.report.design_record import design_record
from robomill.report.placement_record import placement_record
from robomill.report.turning_record import turning_record
from robomill.simulation.judging.verdict_words import TITLES
from robomill.units import format_value

Remedy = Advice | Compensation | Design | Placement | Turning


@dataclass(frozen=True)
class Told:
    """A remedy: what is done, what it leaves in a sentence, and the verdict then ("" where there is none)."""

    title: str
    what: str
    leaves: str
    verdict: str = ""


def refused(title: str, why: RobomillError) -> Told:
    """A remedy that does not apply."""
    return Told(title, "does not apply", str(why))


def _advice(found: Advice) -> list[Told]:
    rows = []
    for way in advice_record(found)["ways"][1:]:  # the first is the cut as it is
        if way["refused"]:
            rows.append(Told(way["title"], "does not apply", way["refused"]))
        else:
            time = f"{format_value(way['minutes'], 'min')} at feed"
            rows.append(Told(way["title"], time, way["verdict_sentence"], TITLES[way["verdict"]]))
    return rows


def _design(found: Design) -> list[Told]:
    record = design_record(found)
    stiffer = [
        f"joint {number} × {ratio:.2f}"
        for number, ratio in zip(record["joints"], record["stiffness_ratio"], strict=True)
        if ratio > 1.005
    ]
    what = ", ".join(stiffer) or "no joint need be stiffer"
    leaves = record["verdict_sentence"] if record["feasible"] else record["sentence"]
    return [Told("Stiffer joints", what, leaves, TITLES[record["verdict"]])]


def _placement(found: Placement) -> list[Told]:
    best = placement_record(found)["best"]
    zero = ", ".join(format_value(each, "mm", 1, with_unit=False) for each in best["zero_mm"])
    what = f"part zero at ({zero}) mm, yaw {format_value(best['yaw_deg'], 'deg', 1)}"
    return [Told("Another place of the part", what, best["reason"] or best["verdict_sentence"], _title(best))]


def _turning(found: Turning) -> list[Told]:
    record = turning_record(found)
    spin = f"at {format_value(record['spin_deg'], 'deg', 0)} on the whole path"
    rows = (("constant", spin), ("course", "turning along the path"))
    return [
        Told("Spindle turned about its axis", what, each["reason"] or each["verdict_sentence"], _title(each))
        for each, what in ((record[name], what) for name, what in rows)
    ]


def _compensation(found: Compensation) -> list[Told]:
    record = compensation_record(found)
    left = format_value(record["after_mm"]["max"], "mm", 4)
    wrong = max(record[f"after_if_{name}_20_percent_wrong_mm"] for name in ("compliance", "force"))
    leaves = f"{left} at most; {format_value(wrong, 'mm')} if stiffness or force is 20 % off."
    leaves = " ".join([leaves, *(Finding("info", each["message"]).sentence for each in record["findings"])])
    what = f"a new program, {record['lines_in']} lines become {record['lines_out']}"
    return [Told("Corrected program", what, leaves, TITLES[record["verdict"]["after"]])]


def _title(place: dict[str, Any]) -> str:
    return TITLES.get(place["verdict"], "")


TOLD: dict[type, Callable[[Any], list[Told]]] = {
    Advice: _advice,
    Compensation: _compensation,
    Design: _design,
    Placement: _placement,
    Turning: _turning,
}


def told(found: Remedy) -> list[Told]:
    """The rows of a remedy that was computed. Raises RobomillError for what is none."""
    if type(found) not in TOLD:
        raise RobomillError(
            f"remedies: found {type(found).__name__}; expected what rm.advise, rm.compensate, rm.design, rm.place or "
            "rm.turn return."
        )
    return TOLD[type(found)](found)
