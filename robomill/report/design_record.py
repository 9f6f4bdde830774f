"""A design of stiffer joints as a JSON-ready record in display units, and as lines for a person."""

from typing import Any

from robomill.improve.box_design import BoxDesign
from robomill.improve.design import Design
from robomill.report.records import of_setup, shown
from robomill.simulation.result import SimulationResult
from robomill.units import SI_NAMES, format_number, format_significant, format_value


def design_record(found: Design) -> dict[str, Any]:
    """Joints and what the cut is like before and with them."""
    robot = found.setup.robot
    return of_setup(
        found.before.setup,
        found.digest(),
        compliance_set=found.before.setup.robot.compliance_set,
        joints=list(robot.joint_numbers),
        measure=found.measure,
        tolerance_mm=shown(found.setup.tolerance, "mm"),
        feasible=found.feasible,
        reason=found.reason or None,
        sentence=found.sentence,
        stiffness_ratio=shown(found.stiffness_ratio, "1"),
        C_theta=shown(found.C_theta, "1"),
        C_theta_units=[SI_NAMES[unit] for unit in robot.compliance_units],
        cost=shown(found.cost, "1"),
        share=shown(found.share, "1"),
        residual=shown(found.residual, "1"),
        before=deviations(found.before),
        **deviations(found.after),
        verdict=found.after.verdict.level,
        verdict_sentence=found.after.verdict.sentence,
    )


def deviations(result: SimulationResult) -> dict[str, Any]:
    """The largest of a run: of the tip, and of walls and floors as a gauge reads them (null where there are none)."""
    return {
        "max_deviation_mm": shown(result.max_deviation, "mm"),
        "wall_mm": shown(abs(result.verdict.wall.value), "mm"),
        "floor_mm": shown(abs(result.verdict.floor.value), "mm"),
    }


def design_lines(record: dict[str, Any]) -> list[str]:
    """The answer first, then joint by joint."""
    lines = joint_lines(record)
    for name, values in (("before", record["before"]), ("then", record)):
        lines.append(f"{name:9} {deviation_words(values)}")
    lines.append(f"verdict   {record['verdict_sentence']}")
    return lines


def joint_lines(record: dict[str, Any]) -> list[str]:
    """The answer of a design in a sentence, then joint by joint, and what it costs."""
    lines = [record["sentence"]]
    columns = (record[name] for name in ("joints", "stiffness_ratio", "C_theta", "C_theta_units"))
    for number, ratio, C, unit in zip(*columns, strict=True):
        times, left = format_number(ratio, 3), format_significant(C, 4)
        lines.append(f"joint {number}   {times:>8} times as stiff   {left} {unit}")
    return [*lines, f"cost      {format_number(record['cost'], 3)} (1 is one joint made twice as stiff)"]


def box_record(found: BoxDesign) -> dict[str, Any]:
    """Joints, and how far a stated force pushes the tip at the points of a box before and with them."""
    robot, worst = found.setup.robot, found.worst
    return {
        "name": found.setup.name,
        "robot": robot.name,
        "joints": list(robot.joint_numbers),
        "force_N": shown(found.force, "N"),
        "tolerance_mm": shown(found.tolerance, "mm"),
        "points": found.cells,
        "reached": len(found.points),
        "feasible": found.feasible,
        "reason": found.reason or None,
        "sentence": found.sentence,
        "stiffness_ratio": shown(found.stiffness_ratio, "1"),
        "C_theta": shown(found.C_theta, "1"),
        "C_theta_units": [SI_NAMES[unit] for unit in robot.compliance_units],
        "cost": shown(found.cost, "1"),
        "residual": shown(found.residual, "1"),
        "before": {"max_deviation_mm": shown(float(found.before.max()), "mm")},
        "max_deviation_mm": shown(float(found.after.max()), "mm"),
        "worst_at_mm": shown(found.points[worst], "mm"),
        "digest": found.digest(),
    }


def box_lines(record: dict[str, Any]) -> list[str]:
    """The answer first, then joint by joint."""
    at = ", ".join(format_number(each, 0) for each in record["worst_at_mm"])
    return [
        *joint_lines(record),
        f"before    {_mm(record['before']['max_deviation_mm'])} at most",
        f"then      {_mm(record['max_deviation_mm'])} at most, at ({at}) mm",
        f"points    {record['reached']} of {record['points']} are reached by the upright tool",
    ]


def deviation_words(record: dict[str, Any]) -> str:
    """The deviations of a record: of the tip, and of walls and floors where there are any."""
    named = (("tip", "max_deviation_mm"), ("wall", "wall_mm"), ("floor", "floor_mm"))
    return ", ".join(f"{name} {_mm(record[key])}" for name, key in named)


def _mm(value: float) -> str:
    return format_value(value, "mm", 4, missing="none")
