"""Poses, cables and gauges of load tests from the columns of a table (``load_test_columns``).

Poses are joints, or X, Y, Z of the tool tip with A, B, or X, Y, Z with three angles as a controller shows them. What
these mean differs from maker to maker, so the file says it (``# angles:``, ``# frame:``) and nothing is guessed:

kuka        A, B, C: R = R_z(A) R_y(B) R_x(C) (KUKA System Software: A about Z, then B about Y', then C about X'')
robomill    A, B, C: R = R_x(A) R_y(B) R_z(C), the A and B of X, Y, Z, A, B and the turn about the tool axis
ur          rx, ry, rz: a rotation vector, about itself by its own length; rotvec_x, _y, _z are one unsaid
W, P, R     as on FANUC: about the fixed X by W, Y by P, Z by R, so R = R_z(R) R_y(P) R_x(W)
frame       whose pose it is: the ``flange``'s, or that of the ``tool`` {T} in the robot's file (z_T out of the part)

A cable is a size (load_N) with its direction cable_x, _y, _z in {M}, or the pulley's place in {M} besides the hook's or
the stated load point.
"""

from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.identification.configurations import pose_of, world_of
from robomill.identification.load_test import LoadTests
from robomill.io.columns import Columns
from robomill.io.measured.load_test_columns import ANGLE, GAUGES, ROTVEC, WORLD, axes, directions, group, head_of
from robomill.kinematics.transforms import invert, rotation_about, rotation_x, rotation_y, rotation_z, transform
from robomill.provenance import UNSTATED, Finding
from robomill.robot.model import Robot
from robomill.units import format_si

ABC, WPR = ("a", "b", "c"), ("w", "p", "r")
SCATTER = 5e-3  # m: how far hooks may lie apart in the tool before it is said


def poses(table: Columns, robot: Robot | None) -> dict[str, Any]:
    """theta (m, n) or x_M (m, 5 or 6), whichever the columns give, and what is to be said of it as findings."""
    joints = sorted((int(key[5:]), key) for key in table.values if key.startswith("theta"))
    world = [key for key in (*WORLD[:3], *ABC, *WPR, *ROTVEC) if key in table]
    if joints and world:
        raise table.place.refuse(
            f"poses are given twice, as {table.written(joints[0][1])} and {table.written(world[0])}; keep one."
        )
    if joints:
        for k, (number, key) in enumerate(joints, 1):
            if number != k:
                raise table.place.refuse(f"found {table.written(key)} but no theta{k}_deg; number the joints from 1.")
        theta = np.stack([table.values[key] for _, key in joints], axis=-1)
        sliding = tuple(number for number, key in joints if table.known[key].unit not in ANGLE)
        return {"theta": theta, "sliding": sliding, "findings": _unused(table)}
    turned = _turned(table)
    if turned is None:
        x_M = group(table, WORLD)
        if x_M is None:
            raise table.place.refuse("no pose columns; give theta1_deg to thetaN_deg, or X_mm,Y_mm,Z_mm,A_deg,B_deg.")
        return {"x_M": x_M, "findings": _unused(table)}
    (p, R), how = turned
    return _of_frame(table, robot, transform(R, p), how)


def _unused(table: Columns) -> tuple[Finding, ...]:
    """Remarks on what poses with three angles mean, where there are none."""
    head = head_of(table)
    said = [f"'{key}: {head[key]}'" for key in ("frame", "angles") if key in head]
    if not said:
        return ()
    text = (
        f"{' and '.join(said)} is said of poses with three angles, of which there are none here, and is not used: "
        "forces, displacements and pulleys are read along the axes of {M}; turn them there if they were taken in the "
        "tool's or flange's frame."
    )
    return (Finding("suspicious", text, table.place.head, code="frame-unused"),)


def _turned(table: Columns) -> tuple[tuple[FloatArray, FloatArray], str] | None:
    """Places (m, 3) and rotations (m, 3, 3) of poses by three angles, and how these are read; None without them."""
    vector = rotation_vector(table)
    if vector is not None:
        given = _six(table, vector)
        return (given[:, :3], rotation_about(given[:, 3:])), "a rotation vector"
    if any(key in table for key in WPR):
        given = _six(table, WPR)
        return (given[:, :3], _about_fixed(given[:, 3:])), "R = Rz(R) Ry(P) Rx(W)"
    if "c" not in table:
        return None
    given = _six(table, ABC)
    meant = head_of(table).get("angles")
    if meant == "kuka":
        return (given[:, :3], _about_fixed(given[:, :2:-1])), "R = Rz(A) Ry(B) Rx(C)"
    if meant == "robomill":
        return (given[:, :3], pose_of(given)[:, :3, :3]), "R = Rx(A) Ry(B) Rz(C)"
    declared = table.place.declared
    raise table.place.refuse(
        f"A, B, C mean one thing on a KUKA and another beside X, Y, Z, A, B here; {declared('angles: kuka')} for R = "
        "Rz(A) Ry(B) Rx(C), or robomill instead of kuka for R = Rx(A) Ry(B) Rz(C)."
    )


def rotation_vector(table: Columns) -> tuple[str, str, str] | None:
    """The columns that hold the rotation vector of poses; None where these are given another way.

    Raises LoadTestError where rx, ry, rz may as well be a rotation that was measured.
    """
    if any(key in table for key in ROTVEC):
        return ROTVEC
    if head_of(table).get("angles") == "ur":
        return axes("r")
    if "x" in table and "rx" in table and not any(key in table for key in (*ABC, *WPR)):
        raise table.place.refuse(
            "X, Y, Z stand beside rx, ry, rz alone; if these are the pose's rotation vector, as on a UR, "
            f"{table.place.declared('angles: ur')}; if they are rotations that were measured, add the pose's A_deg, "
            "B_deg."
        )
    return None


def _six(table: Columns, names: tuple[str, str, str]) -> FloatArray:
    """(m, 6) X, Y, Z and three angles, none of them missing."""
    given = group(table, (*WORLD[:3], *names))
    assert given is not None
    return given


def _about_fixed(turns: FloatArray) -> FloatArray:
    """R = R_z R_y R_x (m, 3, 3) of the turns (m, 3) rad about x, y and z: FANUC's W, P, R, KUKA's C, B, A."""
    x, y, z = turns.T
    return np.asarray(rotation_z(z) @ rotation_y(y) @ rotation_x(x))


def _of_frame(table: Columns, robot: Robot | None, T: FloatArray, how: str) -> dict[str, Any]:
    """Tool poses of the frame that the head declares."""
    frame = head_of(table).get("frame")
    if frame is None:
        raise table.place.refuse(
            f"poses with three angles are of the flange or of the tool; {table.place.declared('frame: flange')}, or "
            "tool instead of flange for the frame {T} of the robot's file, z_T out of the part."
        )
    if frame == "flange":
        T = T @ _needed(table, robot, "poses of the flange").T_tool
    stated = None if robot is None else robot.provenance.get("base")
    base = "" if stated in (None, UNSTATED) else f"; {stated.source}"
    text = f"Poses are of the {frame} with {how}{base}."
    return {"x_M": world_of(T), "findings": (Finding("info", text, table.place.head, code="pose-frame"),)}


def force_and_points(table: Columns, robot: Robot | None, where: dict[str, Any]) -> dict[str, Any]:
    """Force F (m, 3) N where a cable gives it, force_point, measuring_point and pulley (m, 3), findings on them."""
    hook, pulley, cable = group(table, axes("hook_")), group(table, axes("pulley_")), directions(table, "cable_")
    found: dict[str, Any] = {
        "force_point": _point(table, robot, "fp", "load_point_"),
        "measuring_point": _point(table, robot, "mp", "gauge_point_"),
    }
    if cable is None and pulley is None:
        if hook is not None:
            raise table.place.refuse("the hook's place alone gives no direction; give the pulley's or cable_x, _y, _z.")
        return found
    if cable is not None and pulley is not None:
        raise table.place.refuse("the cable's direction is given twice, by cable_x and by pulley_x; keep one.")
    load = table.values.get("load")
    if load is None:
        raise table.place.refuse("the cable's pull is missing; give load_N, its size.")
    if (load <= 0).any():
        raise table.refuse(int(np.argmax(load <= 0)), "load", "expected a pull above zero.")
    if cable is not None:
        return {**found, "F": load[:, None] * cable}
    assert pulley is not None
    robot = _needed(table, robot, "pulleys")
    if hook is not None and found["force_point"] is not None:  # the direction is measured apart from the load point
        return {**found, "F": load[:, None] * _unit(table, pulley - hook)}
    if hook is not None:
        found["force_point"], found["findings"] = _hooks(table, robot, hook, where)
    return {**found, "F": load[:, None] * np.eye(3)[0], "pulley": pulley}


def gauges(table: Columns) -> tuple[FloatArray, FloatArray] | None:
    """Readings (m, 3) m, NaN where none, and the unit vectors (m, 3, 3) they are taken along; None without gauges."""
    read, along = [], []
    for k in GAUGES:
        u, reading = directions(table, f"gauge{k}_"), table.values.get(f"reading{k}")
        if (u is None) != (reading is None):
            there, missing = ("reading", f"gauge{k}_x, _y, _z") if u is None else ("gauge", f"reading{k}_mm")
            raise table.place.refuse(f"the {there} number {k} needs {missing} beside it.")
        m = len(table.row)
        read.append(np.full(m, np.nan) if reading is None else reading)
        along.append(np.broadcast_to(np.eye(3)[int(k) - 1], (m, 3)) if u is None else u)
    readings = np.stack(read, axis=1)
    return (readings, np.stack(along, axis=1)) if np.isfinite(readings).any() else None


def _point(table: Columns, robot: Robot | None, tip: str, flange: str) -> FloatArray | None:
    """(m, 3) m in {T} from the tip, as stated there or in the flange."""
    in_tool, in_flange = group(table, axes(tip)), group(table, axes(flange))
    if in_flange is None:
        return in_tool
    if in_tool is not None:
        raise table.place.refuse(f"a point is given twice, by {tip.upper()}x and by {flange}x; keep one.")
    T = _needed(table, robot, f"{flange}x ... (in the flange)").T_tool
    return np.asarray((in_flange - T[:3, 3]) @ T[:3, :3])


def _hooks(
    table: Columns, robot: Robot, hook: FloatArray, where: dict[str, Any]
) -> tuple[FloatArray, tuple[Finding, ...]]:
    """(m, 3) m the hooks in {T}, and whether they are one point of the tool."""
    size = np.ones((len(hook), 3))
    tests = LoadTests(size, size, row=table.row, **{k: where[k] for k in ("theta", "x_M", "sliding") if k in where})
    back = invert(tests.with_joints(robot).tool_poses(robot))
    point = np.einsum("mij,mj->mi", back[:, :3, :3], hook) + back[:, :3, 3]
    off = np.linalg.norm(point - np.median(point, axis=0), axis=1)
    if off.max() <= SCATTER:
        return point, ()
    far, row = format_si(float(off.max()), "mm", 0), int(table.row[int(np.argmax(off))])
    text = (
        f"The hook stands up to {far} (row {row}) from where most rows have it in the tool: is it one hook, measured "
        "in {M}, and are the poses right?"
    )
    return point, (Finding("suspicious", text, row, code="hook-scatter", place=""),)


def _unit(table: Columns, way: FloatArray) -> FloatArray:
    size = np.linalg.norm(way, axis=1)
    if (size < 1e-3).any():
        raise table.refuse(int(np.argmin(size)), "pulley_x", "the pulley is where the hook is.")
    return np.asarray(way / size[:, None])


def _needed(table: Columns, robot: Robot | None, what: str) -> Robot:
    if robot is None:
        raise table.place.refuse(f"{what} need the robot they are measured on; read the tests with it.")
    return robot
