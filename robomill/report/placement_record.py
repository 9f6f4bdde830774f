"""A placement as a JSON-ready record in display units, and as lines for a person."""

from typing import Any

from robomill.improve.placed import WHY, Place, Placement
from robomill.report.design_record import deviation_words
from robomill.report.records import of_setup, shown
from robomill.units import format_number

NAMES = ("best", "now", "median", "worst")


def placement_record(found: Placement) -> dict[str, Any]:
    """The best place, what it is compared with, and the map over the plane."""
    counts = {WHY[code]: int((found.why == code).sum()) for code in WHY if code}
    return of_setup(
        found.setup,
        found.digest(),
        compliance_set=found.setup.robot.compliance_set,
        measure=found.measure,
        **{name: place_record(getattr(found, name)) for name in NAMES},
        candidates={
            "tried": found.tried,
            "reached": found.reached,
            "allowed": found.allowed,
            "refused": {why: count for why, count in counts.items() if count},
        },
        map={
            **{f"{axis}_mm": shown(found.axes[i], "mm") for i, axis in enumerate("xyz")},
            "yaw_deg": shown(found.axes[3], "deg"),
            "share": found.plane,
            "samples": found.screened[0],
            "of": found.screened[1],
        },
        findings=[each.record() for each in found.findings],
    )


def place_record(place: Place) -> dict[str, Any]:
    """One place by a full simulation; null where the path is not reached there."""
    return {
        "zero_mm": shown(place.zero, "mm"),
        "yaw_deg": shown(place.yaw, "deg"),
        "share": place.share,
        "max_deviation_mm": shown(place.max_deviation, "mm"),
        "wall_mm": shown(abs(place.wall), "mm"),
        "floor_mm": shown(abs(place.floor), "mm"),
        "verdict": place.level,
        "verdict_sentence": place.sentence,
        "room": place.room,
        "det_J_share": abs(place.det),
        "reason": place.reason or None,
    }


def placement_lines(record: dict[str, Any]) -> list[str]:
    """The best place first, then what it is compared with."""
    lines = []
    for name in NAMES:
        place = record[name]
        at = ", ".join(format_number(value, 1) for value in place["zero_mm"])
        lines.append(f"{name:9} {at} mm, yaw {format_number(place['yaw_deg'], 2)} deg: {numbers(place)}")
    lines.append(f"verdict   {record['best']['verdict_sentence']}")
    counts = record["candidates"]
    refused = "".join(f", {count} {why}" for why, count in counts["refused"].items())
    lines.append(f"places    {counts['tried']} tried, {counts['reached']} reached{refused}")
    return [*lines, *(f"{each['level']:9} {each['message']}" for each in record["findings"])]


def numbers(place: dict[str, Any]) -> str:
    """The errors of one place in words."""
    if place["reason"]:
        return f"not reached ({place['reason']})"
    return deviation_words(place)
