"""An identification as ``robomill identify --json`` gives it: points in mm, the rest in SI, null: not known."""

from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.identification.fit.suspects import Suspect
from robomill.identification.fit.treatment import AUTO
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.pull.found_points import FoundPoint
from robomill.identification.pull.lines_of_pull import LinesOfPull, lines_of_pull
from robomill.identification.pull.pull_words import load_point, pull_findings, pull_report
from robomill.identification.result import IdentificationResult
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.units import SI_NAMES, from_si

NAMES = {"force": "load_point", "gauge": "gauge_point"}


def identification_record(
    robot: Robot, tests: LoadTests | JointTests, result: IdentificationResult
) -> tuple[dict[str, Any], list[Finding]]:
    """All that the command says of the result and its tests, and the findings on both."""
    record, found = identification_report(result), list(result.findings)
    record["explanations"] = list(result.explanations)
    record["lines_of_pull"] = None
    if not tests.single:
        tests = tests.without(result.excluded).with_joints(robot)
        lines = lines_of_pull(robot, tests)
        record["lines_of_pull"] = lines_of_pull_record(lines, robot, tests)
        found += pull_report(lines, robot, tests, result)[1]
    return record, found


def identification_report(result: IdentificationResult) -> dict[str, Any]:
    """The result: SI but for names that end in a unit."""
    band = result.band
    return {
        "joints": [p.joint for p in result.labels if p.joint is not None],
        "C_theta": plain(result.C_theta),
        "C_theta_units": [SI_NAMES[p.unit] for p in result.labels if p.joint is not None],
        "stderr": plain(result.stderr),
        "ci95": plain(result.ci95),
        "correlation": plain(result.correlation),
        "parameters": [p.label for p in result.labels],
        "parameter_values": plain(np.where(np.isfinite(result.parameter_stderr), result.parameters, np.nan)),
        "parameter_ci95": plain(result.parameter_ci95),
        "condition": plain(result.condition.after),
        "condition_before_scaling": plain(result.condition.before),
        "residual_rms_mm": None if result.single else plain(from_si(result.residual_rms, "mm")),
        "cv_relative_error": plain(result.cv_relative_error),
        "cv_leaves_out": result.treatment.leave_out,
        "outliers": [outlier.row for outlier in result.outliers],
        "outlier_slips": [
            {"row": outlier.row, "times": outlier.times, "slips": [vars(slip) for slip in outlier.slips]}
            for outlier in result.outliers
        ],
        "suspects": [suspect_record(suspect) for suspect in result.inquest.suspects],
        "unseen_joints": [unseen.joint for unseen in result.unseen_joints],
        "model": result.model,
        "bending_joints": list(result.choice.bending_joints) if result.choice.has("bending") else [],
        "bending_axes": ("link after" if result.choice.turned else "link before")
        if result.choice.has("bending")
        else None,
        "bending_by_fold": [list(joints) for joints in result.votes],
        "fit_points": result.treatment.fit_points,
        "points": {NAMES[point.point]: point_record(point) for point in result.points},
        "offer": None
        if result.offer is None
        else {
            "fit_points": result.offer.fit_points,
            "cv_relative_error_before": plain(result.offer.before),
            "cv_relative_error": plain(result.offer.after),
            "points": {NAMES[point.point]: point_record(point) for point in result.offer.points},
        },
        "bending_offer": None
        if result.bends is None
        else {
            "bending": AUTO,
            "bending_joints": list(result.bends.joints),
            "cv_relative_error_before": plain(result.bends.before),
            "cv_relative_error": plain(result.bends.after),
        },
        "band": None
        if band is None
        else {
            "made_of": band.error.beside_noise(),
            "model_error_share": band.error.share,
            "model_error_per_N_mm": from_si(band.error.per_newton, "mm"),
            "model_error_floor_mm": from_si(band.error.floor, "mm"),
            "held": plain(band.held),
            "components": band.components,
        },
    }


def suspect_record(suspect: Suspect) -> dict[str, object]:
    """A cause that the readings call for: how likely by chance, and the error on poses left out with it."""
    cause = suspect.cause
    return {
        "cause": cause.kind,
        "joint": cause.at or None,
        "axes": ("link after" if cause.turned else "link before") if cause.kind == "bending" else None,
        "points": cause.points or None,
        "chance": suspect.chance,
        "cv_relative_error": plain(suspect.error),
        "off": plain(suspect.off),
        "off_half95": plain(suspect.half),
    }


def point_record(point: FoundPoint) -> dict[str, object]:
    """A fitted point: in the flange with its interval, and from the tip in {T} as a file states it."""
    return {
        "flange_mm": _mm(point.in_flange),
        "ci95_mm": _mm(point.ci95),
        "tool_mm": _mm(point.in_tool),
        "shift_mm": _mm(point.shift),
        "off_mm": _mm(point.off),
        "off_half95_mm": _mm(point.off_half),
    }


def lines_of_pull_record(found: LinesOfPull, robot: Robot, tests: LoadTests) -> dict[str, object]:
    """What the lines of pull say. ``pulley_mm`` is that of most rows; ``says`` tells why a field is null."""
    pulleys, row = found.pulley, found.row
    most = int(np.bincount(found.which[found.which >= 0]).argmax()) if len(pulleys) else 0
    point = load_point(found, robot, tests)
    return {
        "says": found.says,
        "sentences": [finding.message for finding in pull_findings(found, robot, tests)],
        "pulley_mm": _mm(pulleys[most]) if len(pulleys) else None,
        "pulleys_mm": _mm(pulleys) if len(pulleys) else [],
        "rows_by_pulley": [row[found.which == k].tolist() for k in range(len(pulleys))],
        "gap_mm": _mm(found.gap),
        "gap_stated_mm": _mm(found.gap_stated),
        "load_point_mm": None if point is None else _mm(point.in_flange),
        "load_point_ci95_mm": None if point is None else _mm(point.ci95),
        "load_point_tool_mm": None if point is None else _mm(point.in_tool),
        "load_point_off_mm": None if point is None else _mm(point.off),
        "suspects": list(found.suspects),
        "pushes": list(found.pushes),
    }


def _mm(value: FloatArray | float) -> object:
    return plain(from_si(np.asarray(value, dtype=np.float64), "mm"))


def plain(value: Any) -> object:
    """Lists and floats for JSON, with None for what is not finite."""
    array = np.asarray(value, dtype=np.float64)
    if array.ndim:
        return [plain(part) for part in array]
    return float(array) if np.isfinite(array) else None
