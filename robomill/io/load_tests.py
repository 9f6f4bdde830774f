"""Load tests from CSV (or pasted cells) and back. Units stand in the header; a bad cell is named by row and column.

Rows are numbered as an editor or spreadsheet shows them: the first line of the file is row 1. Lines that start with
``#`` are remarks. Commas, semicolons or tabs separate; with the latter two, decimal commas are understood.

Protocols, told apart by their columns (angles deg or rad; lengths mm, um, m, in; forces N, kN; moments Nm, kNm):

displacements            theta1_deg ... thetaN_deg  or  X_mm,Y_mm,Z_mm,A_deg,B_deg;  Fx_N,Fy_N,Fz_N,dx_mm,dy_mm,dz_mm
  optional               Mx_Nm.. rx_mrad..           moment on the tool and measured rotation
                         F0x_N.. d0x_mm..            force and reading at the preload; differences are used
                         FPx_mm.. MPx_mm..           force and measuring point from the tool tip, in {T}
                         noise_um                    standard deviation of one reading
one joint at a time      joint,torque_Nm,angle_mrad
measured compliances     a pose, and any of Cxx_um_N ... Czz_um_N, eq. (17): Cxy is dx by Fy; optional load_N
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import LoadTestError
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.measured_field import MeasuredField
from robomill.identification.suspicion import suspicions
from robomill.io.columns import Columns, Layout, read_columns, spelled
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.units import from_si

NOMINAL_LOAD = 250.0  # N, the paper's dead weight: residuals of measured compliances are stated for it

_ANGLE, _LENGTH, _FORCE, _MOMENT = ("deg", "rad"), ("mm", "um", "m", "in"), ("N", "kN"), ("N m", "kN m")
_ROTATION, _COMPLIANCE = ("mrad", "urad", "rad", "deg"), ("um/N", "mm/N", "m/N")
_XYZ = "xyz"
_WORLD = ("x", "y", "z", "a", "b")
_UNITS: dict[str, tuple[str, ...]] = {
    **{f"theta{joint}": (*_ANGLE, "mm", "m") for joint in range(1, 10)},
    **dict.fromkeys(("x", "y", "z"), _LENGTH),
    **dict.fromkeys(("a", "b"), _ANGLE),
    **{f"{name}{axis}": _FORCE for name in ("f", "f0") for axis in _XYZ},
    **{f"{name}{axis}": _LENGTH for name in ("d", "d0", "fp", "mp") for axis in _XYZ},
    **{f"m{axis}": _MOMENT for axis in _XYZ},
    **{f"r{axis}": _ROTATION for axis in _XYZ},
    **{f"c{row}{column}": _COMPLIANCE for row in _XYZ for column in _XYZ},
    "joint": ("1",),
    "torque": (*_MOMENT, *_FORCE),
    "angle": (*_ROTATION, "mm", "um"),
    "load": _FORCE,
    "noise": (*_LENGTH, "mrad", "urad"),
}
LAYOUT = Layout("Load tests", LoadTestError, _UNITS, "theta1_deg,...,Fx_N,...,dz_mm")


def read_load_tests(path_or_text: str | Path, robot: Robot | None = None) -> LoadTests | JointTests:
    """Read load tests of any protocol (see the module). With a robot, poses and sizes are checked against it too.

    Raises LoadTestError naming file, row and column. What only looks odd is in ``.findings``.
    """
    table, name = read_columns(path_or_text, LAYOUT)
    if any(key.startswith("c") for key in table.values):
        tests: LoadTests | JointTests = _compliances(table)
    elif "torque" in table or "joint" in table:
        tests = _joints(table)
    else:
        tests = _displacements(table)
    if not tests.single and robot is not None:
        tests = tests.with_joints(robot)
    head = table.place.head
    ignored = tuple(
        Finding("ignored", head, f"Column {column!r} is not one of ours and is passed over.", code="passed-over")
        for column in table.passed_over
    )
    source = f"{name or 'pasted cells'}\n{table.remarks}".strip()
    made = "synthetic" in table.remarks.lower()
    return replace(tests, source=source, synthetic=made, findings=ignored + tests.findings + _pose_suspicions(table))


def read_findings(tests: LoadTests | JointTests, robot: Robot | None = None) -> tuple[Finding, ...]:
    """Everything worth saying about the tests before a fit: from reading them, and suspicions of sign, unit, copies."""
    return (*tests.findings, *suspicions(tests, robot))


def _pose_suspicions(table: Columns) -> tuple[Finding, ...]:
    """Angles that look like radians under deg, places that look like metres under mm."""
    for start, unit, most, other in (("theta", "deg", 6.3, "rad"), ("x", "mm", 10.0, "m"), ("y", "mm", 10.0, "m")):
        columns = [c for key, c in table.known.items() if key.startswith(start) and c.unit == unit]
        largest = max((float(np.abs(from_si(table.values[c.quantity], unit)).max()) for c in columns), default=0.0)
        if 0.0 < largest < most:
            text = f"No {columns[0].written} is larger than {largest:.3g}: are these poses in {other}?"
            return (Finding("suspicious", 0, text, code="pose-unit"),)
    return ()


# ---- the three protocols -------------------------------------------------------------------------------------------
def _poses(table: Columns) -> dict[str, Any]:
    joints = sorted((int(key[5:]), key) for key in table.values if key.startswith("theta"))
    world = [key for key in _WORLD if key in table]
    if joints and world:
        raise table.place.refuse(
            f"poses are given twice, as {table.written(joints[0][1])} and {table.written(world[0])}; keep one."
        )
    if joints:
        for k, (number, key) in enumerate(joints, 1):
            if number != k:
                raise table.place.refuse(f"found {table.written(key)} but no theta{k}_deg; number the joints from 1.")
        return {"theta": np.stack([table.values[key] for _, key in joints], axis=-1)}
    x_M = _group(table, _WORLD)
    if x_M is None:
        raise table.place.refuse("no pose columns; give theta1_deg to thetaN_deg, or X_mm,Y_mm,Z_mm,A_deg,B_deg.")
    return {"x_M": x_M}


def _displacements(table: Columns) -> LoadTests:
    F, moved = _group(table, _axes("f")), _group(table, _axes("d"))
    moment, turned = _group(table, _axes("m")), _group(table, _axes("r"))
    poses = _poses(table)
    if F is None and moment is None:
        raise table.place.refuse("no force columns; give Fx_N,Fy_N,Fz_N.")
    if moved is None and turned is None:
        raise table.place.refuse("the displacement columns are missing; give dx_mm,dy_mm,dz_mm.")
    m = len(table.row)
    F0, d0 = _group(table, _axes("f0")), _group(table, _axes("d0"))
    nothing, unknown = np.zeros((m, 3)), np.full((m, 3), np.nan)
    F, moved = (nothing if F is None else F), (unknown if moved is None else moved)
    found: tuple[Finding, ...] = ()
    if F0 is None and d0 is None:
        text = "Displacements are taken as differences between loaded and unloaded readings; gravity cancels in them."
        found = (Finding("info", 0, text, code="differences"),)
    return LoadTests(
        wrench=np.concatenate([F - (0.0 if F0 is None else F0), nothing if moment is None else moment], axis=1),
        displacement=np.concatenate(
            [moved - (0.0 if d0 is None else d0), unknown if turned is None else turned], axis=1
        ),
        force_point=_group(table, _axes("fp")),  # type: ignore[arg-type]
        measuring_point=_group(table, _axes("mp")),  # type: ignore[arg-type]
        noise=table.values.get("noise"),  # type: ignore[arg-type]
        row=table.row,
        findings=found,
        **poses,
    )


def _joints(table: Columns) -> JointTests:
    for key, example in (("joint", "joint"), ("torque", "torque_Nm"), ("angle", "angle_mrad")):
        if key not in table:
            raise table.place.refuse(
                f"column {example} is missing; one joint at a time needs joint,torque_Nm,angle_mrad."
            )
    joint = table.values["joint"]
    odd = (joint != np.round(joint)) | (joint < 1)
    if odd.any():
        k = int(np.argmax(odd))
        raise table.refuse(k, "joint", f"found {joint[k]:g}, expected a joint number from 1.")
    return JointTests(
        joint=joint.astype(np.int64),
        torque=table.values["torque"],
        angle=table.values["angle"],
        noise=table.values.get("noise"),  # type: ignore[arg-type]
        row=table.row,
    )


def _compliances(table: Columns) -> LoadTests:
    m = len(table.row)
    load = table.values.get("load")
    found: tuple[Finding, ...] = ()
    if load is None:
        text = f"No load_N column: residuals are stated for the paper's dead weight of {NOMINAL_LOAD:g} N."
        found, load = (Finding("info", 0, text, code="nominal-load"),), np.full(m, NOMINAL_LOAD)
    if (load <= 0).any():
        k = int(np.argmax(load <= 0))
        raise table.refuse(k, "load", "expected a load above zero.")
    C = np.full((m, 3, 3), np.nan)
    for i, j in np.ndindex(3, 3):
        C[:, i, j] = table.values.get(f"c{_XYZ[i]}{_XYZ[j]}", np.nan)
    F = np.broadcast_to(np.eye(3), (m, 3, 3)) * load[:, None, None]
    measured = np.isfinite(C).any(axis=1)  # by force direction
    each = np.repeat(np.arange(m), 3)[measured.ravel()]
    noise = table.values.get("noise")
    return LoadTests(
        wrench=F.reshape(-1, 3)[measured.ravel()],
        displacement=(np.swapaxes(C, 1, 2) * load[:, None, None]).reshape(-1, 3)[measured.ravel()],
        row=table.row[each],
        noise=None if noise is None else noise[each],  # type: ignore[arg-type]
        findings=found,
        protocol="measured compliances",
        **{key: value[each] for key, value in _poses(table).items()},
    )


def _axes(name: str) -> tuple[str, str, str]:
    return (f"{name}x", f"{name}y", f"{name}z")


def _group(table: Columns, names: Sequence[str]) -> FloatArray | None:
    """The named columns side by side, None if there is none of them; a part of them is refused."""
    present = [name for name in names if name in table]
    if not present:
        return None
    for name in names:
        if name not in table:
            needed = ", ".join(_written(n) for n in names)
            raise table.place.refuse(
                f"column {_written(name)} is missing beside {table.written(present[0])}; all of {needed} are needed."
            )
    return np.stack([table.values[name] for name in names], axis=-1)


def _written(name: str) -> str:
    """A quantity as the header would write it: forces, moments, points and world coordinates start with a capital."""
    capitals = name.upper() if name in _WORLD else (name[:-1].upper() + name[-1] if name[0] in "fm" else name)
    return f"{capitals}_{spelled(_UNITS[name][0])}"


def read_measured_map(path_or_text: str | Path, robot: Robot) -> MeasuredField:
    """The paper's second method: a grid of measured compliances (or displacements in three directions) as a map."""
    tests = read_load_tests(path_or_text)
    if tests.single:
        raise LoadTestError("Measured map: found tests of single joints; give compliances Cxx_um_N ... at poses.")
    return MeasuredField.from_tests(robot, tests)
