"""What the lines of pull say, in sentences with codes."""

import numpy as np

from robomill.arrays import frozen
from robomill.identification.load_test import LoadTests
from robomill.identification.pull.found_points import FoundPoint, beyond_chance
from robomill.identification.pull.lines_of_pull import LinesOfPull, Says
from robomill.identification.result import IdentificationResult
from robomill.provenance import Finding, Level
from robomill.robot.model import Robot
from robomill.units import format_si

NOTHING: dict[Says, str] = {
    "aimed": "The cables' directions were calculated from the pulley and the load point, so their lines meet there by "
    "construction and say nothing of the load point; the fit may still find it.",
    "parallel": "The forces are parallel (dead weights, or pushes along axes): their lines meet in no pulley, so they "
    "say nothing of the load point.",
    "too-few": "Too few loaded poses for their lines of pull to say anything of the load point.",
    "held-loosely": "The lines of pull are parallel within their gaps: they hold neither a pulley nor the load point.",
    "apart": "The lines of pull do not meet anywhere: look at the directions of the forces, the frame they are given "
    "in, and the joint angles; or there was no cable over a pulley that stands still.",
}


def load_point(found: LinesOfPull, robot: Robot, tests: LoadTests) -> FoundPoint | None:
    """The load point with which the lines meet best; None where these poses do not hold it."""
    if found.shift is None or found.covariance is None:
        return None
    stated = frozen(tests.force_point.mean(axis=0))
    return FoundPoint("force", found.shift, found.covariance, stated, robot.T_tool, found.dof)


def pull_report(
    found: LinesOfPull, robot: Robot, tests: LoadTests, result: IdentificationResult
) -> tuple[FoundPoint | None, list[Finding]]:
    """The load point by the lines of pull, and all that they say, of the points of the fit too."""
    point = load_point(found, robot, tests)
    offered = () if result.offer is None else result.offer.points
    return point, [*disagreement(point, (*result.points, *offered)), *pull_findings(found, robot, tests)]


def pull_findings(found: LinesOfPull, robot: Robot, tests: LoadTests) -> list[Finding]:
    """Findings on where the lines meet, the load point, and the rows that cannot be."""
    if found.says != "met":
        level: Level = "suspicious" if found.says == "apart" else "info"
        return [Finding(level, NOTHING[found.says], code=f"pull-{found.says}")]
    point = load_point(found, robot, tests)
    many = len(found.pulley)
    where = "one pulley" if many == 1 else f"{many} pulleys"
    stated = format_si(float(np.median(found.gap_stated)), "mm", 1)
    said = []
    if point is None:
        text = (
            f"The lines of pull meet in {where} with a gap of {stated} (median); the tool stands too alike to tell the "
            "load point."
        )
        said.append(Finding("info", text, count=many, code="pull-met"))
    elif point.is_off:
        gap = format_si(float(np.median(found.gap)), "mm", 1)
        text = (
            f"{point.sentence()} That is by the lines of pull alone: with it they pass {where} by {gap} (median), with "
            f"the stated one by {stated}."
        )
        said.append(Finding("suspicious", text, count=many, code="pull-load-point"))
    else:
        text = f"The lines of pull meet in {where} with the stated load point: gap {stated} (median)."
        said.append(Finding("info", text, count=many, code="pull-met"))
    if found.pushes:
        all_of = len(found.pushes) > 0.8 * len(found.row)
        rows = "every row" if all_of else f"row {_listed(found.pushes)}"
        text = f"In {rows} the force points away from its pulley, and a cable only pulls: is its sign turned?"
        said.append(Finding("suspicious", text, count=len(found.pushes), code="pull-sign"))
    if found.suspects:
        text = f"Row {_listed(found.suspects)}: the line of the force cannot be, it passes by the pulley of the others."
        first = found.suspects[0]
        said.append(Finding("suspicious", text, first, count=len(found.suspects), code="pull-suspect", place=""))
    return said


def disagreement(by_lines: FoundPoint | None, fitted: tuple[FoundPoint, ...]) -> list[Finding]:
    """Said where the fitted load point is not that of the lines of pull, beyond both their intervals."""
    for point in fitted:
        if by_lines is None or point.point != "force" or np.isnan(point.covariance).any():
            continue
        apart = point.shift - by_lines.shift
        if beyond_chance(apart, point.covariance + by_lines.covariance, point.dof, 0.99):
            size = format_si(float(np.linalg.norm(apart)), "mm", 0)
            text = (
                f"The load point of the fit and that of the lines of pull are {size} apart, more than chance allows: "
                "the fit makes up for something that is not in its model (links that bend, the gauge point), so "
                "believe the lines of pull."
            )
            return [Finding("suspicious", text, code="points-disagree")]
    return []


def _listed(rows: tuple[int, ...]) -> str:
    shown = ", ".join(map(str, rows[:8]))
    return shown + (f" and {len(rows) - 8} more" if len(rows) > 8 else "")
