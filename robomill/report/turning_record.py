"""What turning the spindle does along a path, as a JSON-ready record in display units and as lines for a person."""

from typing import Any

from robomill.improve.turning import Turning
from robomill.report.placement_record import numbers, place_record
from robomill.report.records import of_setup, shown
from robomill.units import format_number, format_significant

OF_PLACE = ("zero_mm", "yaw_deg")


def turning_record(found: Turning) -> dict[str, Any]:
    """The cut as it is, at the best spin for all of it and along the best course; the course and the map."""
    told = {"now": found.now, "constant": found.constant, "course": found.course}
    records = {name: place_record(place) for name, place in told.items()}
    return of_setup(
        found.setup,
        found.digest(),
        compliance_set=found.setup.robot.compliance_set,
        measure=found.measure,
        spin_deg=shown(found.spin, "deg"),
        rate_deg_mm=shown(found.rate, "deg/mm"),
        **{name: {k: v for k, v in each.items() if k not in OF_PLACE} for name, each in records.items()},
        spins={name: shown(values, name.rpartition("_")[2]) for name, values in _course(found).items()},
        map={
            "way_mm": shown(found.station, "mm"),
            "spin_deg": shown(found.angle, "deg"),
            "share": found.share,
            "deviation_mm": shown(found.deviation, "mm"),
        },
        findings=[each.record() for each in found.findings],
    )


def _course(found: Turning) -> dict[str, Any]:
    return {"way_mm": found.way, "spin_deg": found.turn}


def turning_lines(record: dict[str, Any]) -> list[str]:
    """The course first, then what it is compared with."""
    spin = f"at {format_number(record['spin_deg'], 0)} deg on the whole path"
    turns = record["spins"]["spin_deg"]
    low, high = (format_number(end, 0) for end in (min(turns), max(turns)))
    ends = f"from {low} to {high} deg, at most {format_significant(record['rate_deg_mm'])} deg a mm"
    lines = [f"course    {ends}: {numbers(record['course'])}"]
    lines += [f"constant  {spin}: {numbers(record['constant'])}", f"now       {numbers(record['now'])}"]
    lines.append(f"verdict   {record['course']['verdict_sentence']}")
    return [*lines, *(f"{each['level']:9} {each['message']}" for each in record["findings"])]
