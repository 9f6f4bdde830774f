"""Answers as JSON-ready records in display units: what the command line prints; a run's is ``simulation_record``."""

import math
from collections.abc import Sequence
from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport
from robomill.compliance.posture import posture_notes
from robomill.csv_text import settled
from robomill.kinematics.inverse import IKResult
from robomill.kinematics.result import beyond_limits
from robomill.robot.model import Robot
from robomill.robot.sources import block_in_force
from robomill.simulation.origin.assumptions import assumed_of_program, assumed_of_robot, assumed_of_setup
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.units import from_si, rounded
from robomill.workspace.fields import Field


def jsonable(value: Any) -> Any:
    """Arrays as lists, numbers to 12 significant digits, NaN and infinity as null: JSON has no word for them."""
    if isinstance(value, dict):
        return {str(k): jsonable(v) for k, v in value.items()}
    if isinstance(value, np.ndarray):
        return jsonable((settled(value) if value.dtype.kind == "f" else value).tolist())
    if isinstance(value, list | tuple):
        return [jsonable(v) for v in value]
    if isinstance(value, np.generic):
        return jsonable(value.item())
    if isinstance(value, float | Decimal):
        return rounded(float(value)) if math.isfinite(value) else None
    return value


def shown(value: ArrayLike, unit: str) -> Any:
    """SI array in ``unit``, ``settled``, as plain floats."""
    return settled(from_si(np.asarray(value, dtype=float), unit)).tolist()


def shown_theta(robot: Robot, theta: FloatArray) -> FloatArray:
    """(..., n) joint coordinates in degrees, millimetres for prismatic joints."""
    shown = [from_si(theta[..., i], unit) for i, unit in enumerate(robot.joint_units)]
    return np.stack(shown, axis=-1)


def of_setup(setup: SimulationSetup, digest: str, **told: Any) -> dict[str, Any]:
    """A record of what was asked of a set-up: whose it is, what is ``told``, what it rests on, and its ``digest``."""
    assumed = [each.record() for each in assumed_of_setup(setup)]
    return {"name": setup.name, "robot": setup.robot.name, **told, "assumed": assumed, "digest": digest}


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
                "assumed": [each.record() for each in assumed_of_robot(robot)],
            }
            for robot in robots
        ]
    }


def said_of(robot: Robot) -> dict[str, dict[str, str]]:
    """What is said of each block of the robot's numbers: kind and source; of its compliance sets the one in force."""
    in_force = block_in_force(robot)
    return {
        block: {"kind": said.kind, "source": said.source}
        for block, said in robot.provenance.items()
        if block == in_force or not block.startswith("compliance.")
    }


def pose_record(pose: PoseReport) -> dict[str, Any]:
    """One configuration: pose, Jacobian, det(J), compliance and its joint shares. T_MT and J in SI; not reached is one
    with a joint beyond its limits, which ``reason`` names."""
    robot = pose.robot
    beyond = beyond_limits(robot, pose.theta)
    return {
        "robot": robot.name,
        "compliance_set": robot.compliance_set,
        "joints": list(robot.joint_numbers),
        "theta_deg": shown_theta(robot, pose.theta).tolist(),
        "reached": not beyond,
        "reason": "; ".join(beyond),
        "T_MT": pose.T_MT.tolist(),
        "J": pose.J.tolist(),
        "det_J": pose.det_J if pose.has_det_J else None,
        "det_J_unit": pose.det_J_unit if pose.has_det_J else None,
        "C_um_per_N": shown(pose.C, "um/N"),
        "joint_share_um_per_N": shown(pose.C_joint, "um/N"),
        "provenance": said_of(robot),
        "assumed": [each.record() for each in assumed_of_robot(robot)],
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
        "assumed": [each.record() for each in assumed_of_robot(robot, compliances=False)],
    }


def map_record(fields: Sequence[Field]) -> dict[str, Any]:
    """Maps over one grid: the axes in mm, each quantity's values (nx, ny, nz) in its unit, null where not reached."""
    grid, robot = fields[0].grid, fields[0].robot
    return {
        "robot": robot.name,
        "compliance_set": robot.compliance_set,
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
        "findings": [note.record() for note in posture_notes(robot)],
        "provenance": said_of(robot),
        "assumed": [each.record() for each in assumed_of_robot(robot)],
    }


def _extreme(field: Field, which: Any) -> float:
    return float(from_si(which.reduce(field.values, axis=None), field.quantity.unit))


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
        "assumed": [each.record() for each in assumed_of_program(path.findings)],
    }
