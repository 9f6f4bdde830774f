"""A corrected program as a JSON-ready record in display units, and as lines for a person."""

from typing import Any

from robomill.improve.compensation import Compensation, reversals
from robomill.improve.errors import Errors, level_of
from robomill.report.records import of_setup, shown
from robomill.units import format_count, format_significant, format_value


def compensation_record(found: Compensation) -> dict[str, Any]:
    """What was corrected, what is left, and how the program changed."""
    return of_setup(
        found.setup,
        found.digest(),
        program=getattr(found.setup.source, "name", None),
        components=list(found.components),
        bound_um=shown(found.bound, "um"),
        before_mm=errors_record(found.before),
        after_mm=errors_record(found.after),
        after_if_compliance_20_percent_wrong_mm=shown(found.softer.max, "mm"),
        after_if_force_20_percent_wrong_mm=shown(found.stronger.max, "mm"),
        half_band_mm=shown(found.half, "mm"),
        iterations=found.iterations,
        change_um=shown(found.change, "um"),
        lines_in=found.lines_in,
        lines_out=found.lines_out,
        unrolled=list(found.unrolled),
        reversals={"before": reversals(found.wanted), "after": reversals(found.led)},
        verdict={"before": level_of(found.wanted), "after": level_of(found.led)},
        springs=[
            {"kind": each.kind, "count": each.count, "lines": list(each.lines), "max_mm": shown(each.size, "mm")}
            for each in found.sprung
        ],
        findings=[finding.record() for finding in found.findings],
    )


def errors_record(errors: Errors) -> dict[str, Any]:
    """Largest and root mean square of what is judged (the larger of wall and floor), and its parts."""
    return {
        "max": shown(errors.max, "mm"),
        "rms": shown(errors.rms, "mm"),
        "wall_mm": shown(errors.wall[0], "mm"),
        "floor_mm": shown(errors.floor[0], "mm"),
        "max_deviation_mm": shown(errors.vector[0], "mm"),
        "rms_deviation_mm": shown(errors.vector[1], "mm"),
    }


def compensation_lines(record: dict[str, Any]) -> list[str]:
    """The record for a person at a terminal."""
    lines = [f"{record['name']}: {record['program']} on {record['robot']}"]
    lines.append(f"corrected {', '.join(record['components'])}; within {format_significant(record['bound_um'])} um")
    for when, key in (("before", "before_mm"), ("after", "after_mm")):
        each = record[key]
        parts = [f"{name} {_mm(each[f'{name}_mm'])}" for name in ("wall", "floor") if _known(each[f"{name}_mm"])]
        parts.append(f"the tip {_mm(each['max_deviation_mm'])}")
        lines.append(f"{when:9} {_mm(each['max'])} at most, {_mm(each['rms'])} rms ({', '.join(parts)})")
    wrong = [
        f"{_mm(record[f'after_if_{name}_20_percent_wrong_mm'])} if the {words} 20 % wrong"
        for name, words in (("compliance", "compliances are"), ("force", "force is"))
    ]
    lines.append(f"{'':9} {', '.join(wrong)}")
    if _known(record["half_band_mm"]):
        lines.append(f"{'':9} +/- {_mm(record['half_band_mm'])} by how sure the compliances are (95 %)")
    steps = ", ".join(format_significant(change, 3) for change in record["change_um"])
    lines.append(f"settled   after {format_count(record['iterations'], 'iteration')}: changes of {steps} um")
    lines.append(f"lines     {record['lines_in']} in, {record['lines_out']} out")
    return [*lines, *(f"note      {_said(each)}" for each in record["findings"])]


def _said(finding: dict[str, Any]) -> str:
    return f"line {finding['line']}: {finding['message']}" if finding["line"] else str(finding["message"])


def _known(value: float | None) -> bool:
    return value is not None and value == value


def _mm(value: float) -> str:
    return format_value(value, "mm", 4)
