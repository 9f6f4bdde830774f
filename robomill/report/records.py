"""Results as JSON-ready records in display units: what the command line prints and files carry."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport
from robomill.kinematics.inverse import IKResult
from robomill.report.paper_lengths import TRIED, over_lengths
from robomill.robot.model import Robot
from robomill.simulation.result import SimulationResult
from robomill.simulation.spread import alloy_spread, peak_force
from robomill.simulation.stations import nearest_feed
from robomill.simulation.tooth import LEFT_OUT, tooth
from robomill.surface.groove import GrooveSection
from robomill.toolpath.path import Toolpath
from robomill.units import from_si
from robomill.workspace.fields import Field

COMPONENTS = ("feed", "feed_normal", "axial")


def jsonable(value: Any) -> Any:
    """Arrays as lists, NaN and infinity as null: JSON has no word for them."""
    if isinstance(value, dict):
        return {str(k): jsonable(v) for k, v in value.items()}
    if isinstance(value, np.ndarray):
        return jsonable(value.tolist())
    if isinstance(value, list | tuple):
        return [jsonable(v) for v in value]
    if isinstance(value, np.generic):
        return jsonable(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def shown(value: ArrayLike, unit: str) -> Any:
    """SI array in ``unit``, as plain floats."""
    return np.asarray(from_si(np.asarray(value, dtype=float), unit)).tolist()


def shown_theta(robot: Robot, theta: FloatArray) -> FloatArray:
    """(..., n) joint coordinates in degrees, millimetres for prismatic joints."""
    shown = [from_si(theta[..., i], unit) for i, unit in enumerate(robot.joint_units)]
    return np.stack(shown, axis=-1)


def robots_record(robots: Sequence[Robot]) -> dict[str, Any]:
    """A list of robots."""
    return {
        "robots": [
            {
                "name": robot.name,
                "title": robot.title,
                "joints": robot.n,
                "compliance_sets": sorted(robot.compliance_sets),
                "compliance_set": robot.compliance_set,
                "provenance": said_of(robot),
            }
            for robot in robots
        ]
    }


def said_of(robot: Robot) -> dict[str, dict[str, str]]:
    """What is said of each block of the robot's numbers: kind and source; of its compliance sets the one in force."""
    in_force = f"compliance.{robot.compliance_set}"
    return {
        block: {"kind": said.kind, "source": said.source}
        for block, said in robot.provenance.items()
        if block == in_force or not block.startswith("compliance.")
    }


def pose_record(pose: PoseReport) -> dict[str, Any]:
    """One configuration: pose, Jacobian, det(J), compliance and its joint shares. T_MT and J in SI."""
    robot = pose.robot
    return {
        "robot": robot.name,
        "compliance_set": robot.compliance_set,
        "theta_deg": shown_theta(robot, pose.theta).tolist(),
        "T_MT": pose.T_MT.tolist(),
        "J": pose.J.tolist(),
        "det_J": pose.det_J if robot.n == 5 else None,
        "C_um_per_N": shown(pose.C, "um/N"),
        "joint_share_um_per_N": shown(pose.C_joint, "um/N"),
        "provenance": said_of(robot),
    }


def ik_record(robot: Robot, ik: IKResult) -> dict[str, Any]:
    """The answer for one pose."""
    return {
        "robot": robot.name,
        "theta_deg": shown_theta(robot, ik.theta).tolist(),
        "reached": bool(ik.reached),
        "residual_m": float(ik.residual),
        "reason": ik.reason(),
        "provenance": said_of(robot),
    }


def groove_record(result: SimulationResult, section: GrooveSection) -> dict[str, Any]:
    """A section's dimensions, and the deviation and force at the path's sample nearest to it."""
    i = nearest_feed(result, section.station)
    return {
        "station_mm": float(from_si(section.station, "mm")),
        "width_mm": float(from_si(section.width, "mm")),
        "depth_mm": float(from_si(section.depth, "mm")),
        "centre_offset_mm": float(from_si(section.centre_offset, "mm")),
        "floor_error_mm": float(from_si(section.floor_error, "mm")),
        "block": section.block,
        "deviation_mm": shown(result.delta[i], "mm"),
        "force_N": shown(result.F[i], "N"),
        "force_share_mm": {name: shown(result.delta_component[i, c], "mm") for c, name in enumerate(COMPONENTS)},
        "note": section.note,
    }


def simulation_record(result: SimulationResult) -> dict[str, Any]:
    """One run. ``deviation_mm``, ``joint_share_mm`` and ``force_N`` are those of the worst point, in {M}."""
    i, nan3 = result.worst, np.full(3, np.nan)
    n = result.setup.robot.n
    verdict, noticed = result.verdict, (*result.notes, *result.surface_notes)
    missed = sorted(set(result.path.block[~result.reached].tolist()))
    return {
        "name": result.setup.name,
        "robot": result.setup.robot.name,
        "compliance_set": result.setup.robot.compliance_set,
        "max_deviation_mm": float(from_si(result.max_deviation, "mm")),
        "rms_deviation_mm": float(from_si(result.rms_deviation, "mm")),
        "deviation_mm": shown(result.delta[i] if i >= 0 else nan3, "mm"),
        "joint_share_mm": shown(result.delta_joint[i] if i >= 0 else np.full((n, 3), np.nan), "mm"),
        "spring_share_mm": {
            spring.name: shown(result.delta_spring[i, k] if i >= 0 else nan3, "mm")
            for k, spring in enumerate(result.setup.springs)
        },
        "force_N": shown(result.F[i] if i >= 0 else nan3, "N"),
        "force_component_N": dict(zip(COMPONENTS, shown(result.force_components[i] if i >= 0 else nan3, "N"))),
        "force_share_mm": {
            name: shown(result.delta_component[i, c] if i >= 0 else nan3, "mm") for c, name in enumerate(COMPONENTS)
        },
        "joint_shares_add_up": result.setup.measured_map is None,
        **_uncertain(result, i),
        "over_lengths": lengths_record(result, i),
        "station_mm": float(from_si(result.path.s[i], "mm")) if i >= 0 else None,
        "worst_block": result.worst_block,
        "reached": {
            "count": int(result.reached.sum()),
            "of": len(result.reached),
            "unreached_blocks": missed,
            "reason": _first_reason(result),
        },
        "groove": [groove_record(result, section) for section in result.sections],
        "surface": surface_record(result),
        "verdict": verdict.level,
        "verdict_sentence": verdict.sentence,
        **judged_record(result),
        "tolerance_mm": float(from_si(result.setup.tolerance, "mm")),
        "notes": [note.sentence for note in noticed],
        "findings": [finding.record() for finding in (*result.setup.toolpath.findings, *noticed)],
        "digest": result.setup.digest(),
    }


def lengths_record(result: SimulationResult, i: int) -> dict[str, Any] | None:
    """Least and largest deflection at the worst point with all lengths that the paper allows; None for other arms."""
    found = over_lengths(result, i) if i >= 0 else None
    if found is None:
        return None
    ends = [shown(found.min(axis=0), "mm"), shown(found.max(axis=0), "mm")]
    named = {f"{name}_mm": [low, high] for name, low, high in zip(COMPONENTS, *ends, strict=True)}
    return {"geometries": len(found), "tried": TRIED, **named}


def judged_record(result: SimulationResult) -> dict[str, Any]:
    """What a gauge would read, each quantity against its tolerance, and what is not judged and why."""
    verdict, path = result.verdict, result.path
    readings = {"wall": verdict.wall, "floor": verdict.floor, "feed": verdict.feed, "end": verdict.end}
    lost = result.not_judged
    return {
        **{
            name: {
                "value_mm": float(from_si(reading.value, "mm")),
                "tolerance_mm": float(from_si(reading.tolerance, "mm")),
                "share": reading.share,
                "length_out_of_tolerance_share": reading.share_out,
                "judged": name in ("wall", "floor") or (name == "end" and result.setup.feed_tolerance is not None),
                "line": int(path.block[reading.worst]) if reading.worst >= 0 else None,
                "station_mm": float(from_si(path.s[reading.worst], "mm")) if reading.worst >= 0 else None,
            }
            for name, reading in readings.items()
        },
        "tooth": _tooth(result),
        "left_out": list(LEFT_OUT),
        "not_judged": {
            "count": int(lost.sum()),
            "of": int(path.cutting.sum()),
            "blocks": sorted(set(path.block[lost].tolist())),
            "rapids": list(result.rapids),
            "reasons": [
                {"code": each.code, "why": each.why, "count": int((each.where & lost).sum())}
                for each in result.unjudged
            ],
        },
    }


def _tooth(result: SimulationResult) -> dict[str, Any] | None:
    """At the worst wall and floor: the deviation by the mean force, and its extremes as teeth come by."""
    turn, verdict = tooth(result), result.verdict
    if turn is None:
        return None
    places = {"wall": (verdict.wall.worst, 1), "floor": (verdict.floor.worst, 2)}
    return {
        name: {end: float(from_si(getattr(turn, end)[i, axis], "mm")) for end in ("mean", "low", "high")}
        | {"unit": "mm"}
        for name, (i, axis) in places.items()
        if i >= 0
    }


def _uncertain(result: SimulationResult, i: int) -> dict[str, Any]:
    """Peak of a revolution and the range of the alloy's coefficient sets, where the force comes from a material."""
    peak, spread = peak_force(result), alloy_spread(result)
    if peak is None or spread is None or i < 0:
        return {}
    largest = np.where(result.judged, spread.deviation, -np.inf).max(axis=1)
    return {
        "force_peak_N": {"low": shown(peak.low[i], "N"), "high": shown(peak.high[i], "N"), "frame": list(COMPONENTS)},
        "alloy_spread": [
            {
                "material": title,
                "max_deviation_mm": float(from_si(float(value), "mm")),
                "force_N": shown(F[i], "N"),
                "deviation_mm": shown(delta[i], "mm"),
                "axial_known": known,
            }
            for title, known, value, F, delta in zip(spread.titles, spread.axial, largest, spread.F, spread.delta)
        ],
    }


def map_record(fields: Sequence[Field]) -> dict[str, Any]:
    """Maps over one grid: the axes in mm, each quantity's values (nx, ny, nz) in its unit, null where not reached."""
    grid = fields[0].grid
    return {
        "robot": fields[0].robot.name,
        **{f"{axis}_mm": shown(getattr(grid, axis), "mm") for axis in "xyz"},
        "a_deg": float(from_si(fields[0].A, "deg")),
        "b_deg": float(from_si(fields[0].B, "deg")),
        "reached": {"count": fields[0].reached, "of": int(fields[0].values.size)},
        "quantities": [
            {
                "name": field.quantity.name,
                "title": field.quantity.title,
                "unit": field.quantity.unit,
                "min": _extreme(field, np.fmin),
                "max": _extreme(field, np.fmax),
                "values": shown(field.values, field.quantity.unit),
            }
            for field in fields
        ],
    }


def _extreme(field: Field, which: Any) -> float:
    return float(from_si(which.reduce(field.values, axis=None), field.quantity.unit))


def surface_record(result: SimulationResult) -> dict[str, Any]:
    """Both surfaces in numbers: volumes, and the share of the cut area out of tolerance: seen from above, and walls by
    their length and height."""
    error, walls, verdict = result.error, result.gauge.walls, result.verdict
    out, wall = error.area_out(verdict.floor.tolerance)[0] + walls.area(verdict.wall.tolerance), walls.area()
    return {
        "removed_volume_mm3": float(from_si(result.machined.removed_volume, "mm3")),
        "ideal_volume_mm3": float(from_si(result.ideal.removed_volume, "mm3")),
        "excess_volume_mm3": float(from_si(error.excess_volume, "mm3")),
        "gouge_volume_mm3": float(from_si(error.gouge_volume, "mm3")),
        "area_out_of_tolerance_share": out / (error.cut_area + wall) if error.cut_area + wall else 0.0,
        "cells": int(result.machined.z.size),
    }


def path_record(path: Toolpath) -> dict[str, Any]:
    """A toolpath without canonical moves (APT-CL) in the shape of ``gcode_report``."""
    moved = path.step_length > 0
    kinds = {"traverse": moved & ~path.cutting, "feed": moved & path.cutting, "arc": np.zeros(len(path), dtype=bool)}
    low, high = path.extents
    return {
        "moves": {kind: int(chosen.sum()) for kind, chosen in kinds.items()},
        "length_mm": {kind: float(from_si(path.step_length[chosen].sum(), "mm")) for kind, chosen in kinds.items()},
        "extents_mm": [shown(low, "mm"), shown(high, "mm")],
        "units": path.units,
        "findings": [finding.record() for finding in path.findings],
        "ok": all(finding.level != "error" for finding in path.findings),
    }


def _first_reason(result: SimulationResult) -> str:
    missed = np.flatnonzero(~result.reached)
    return result.ik.reason(int(missed[0])) if len(missed) else ""
