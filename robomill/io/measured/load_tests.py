"""Load tests from CSV (or pasted cells) and back. Units stand in the header; a bad cell is named by row and column.

Rows are numbered as an editor or spreadsheet shows them: the first line of the file is row 1. Lines that start with
``#`` are remarks, of which ``# provenance: synthetic`` (or measured ...) and two others declare what they say. Commas,
semicolons or tabs separate; with the latter two, decimal commas are understood.

Protocols, told apart by their columns (angles deg or rad; lengths mm, um, m, in; forces N, kN; moments Nm, kNm):

displacements            a pose, Fx_N,Fy_N,Fz_N,dx_mm,dy_mm,dz_mm; the pose as theta1_deg ... thetaN_deg or
                         X_mm,Y_mm,Z_mm with A_deg,B_deg, or A,B,C or W,P,R or rx,ry,rz (``load_test_poses``)
  optional               Mx_Nm.. rx_mrad..           moment on the tool and measured rotation
                         F0x_N.. d0x_mm..            force and reading at the preload; differences are used
                         FPx_mm.. MPx_mm..           force and measuring point from the tool tip, in {T}
                         load_point_x_mm.. gauge_point_x_mm..  the same points in the frame of the flange
                         noise_um                    standard deviation of one reading
  a cable for Fx..       load_N with cable_x.. (unit vector), or pulley_x_mm.., also with hook_x_mm.., all in {M}
  gauges for dx..        gauge1_x.. (unit vector in {M}) and reading1_mm, up to three; a reading may be left empty
one joint at a time      joint,torque_Nm,angle_mrad
measured compliances     a pose, and any of Cxx_um_N ... Czz_um_N, eq. (17): Cxy is dx by Fy; optional load_N
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from robomill.arguments import asked
from robomill.arrays import IntArray
from robomill.errors import LoadTestError
from robomill.frames import is_frame
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.measured_field import MeasuredField
from robomill.identification.suspicion import suspicions
from robomill.io.columns import Columns, frame_columns, read_columns
from robomill.io.measured.load_test_columns import LAYOUT, POSTURE, SLIDING, XYZ, axes, group, head_of, kind_of
from robomill.io.measured.load_test_poses import ABC, WPR, force_and_points, gauges, poses, rotation_vector
from robomill.io.samples import sample_or_file
from robomill.provenance import Finding, Provenance
from robomill.robot.model import Robot
from robomill.units import from_si

if TYPE_CHECKING:
    from robomill.frames import DataFrame

NOMINAL_LOAD = 250.0  # N, the paper's dead weight: residuals of measured compliances are stated for it
JOINTS = tuple(f"theta{joint}" for joint in range(1, 10))
COMPLIANCES = tuple(f"c{row}{column}" for row in XYZ for column in XYZ)


@asked
def read_load_tests(path_or_text: str | Path | bytes | DataFrame, robot: Robot | None = None) -> LoadTests | JointTests:
    """Read load tests of any protocol: poses, loads and displacements, with their units in the header.

    Parameters
    ----------
    path_or_text : str, Path, bytes or pandas.DataFrame
        A CSV file, a sample's name, the text of such a file, or the same table as a DataFrame, whose ``attrs`` stand
        for the remarks ``# key: value`` of a file and whose index (where it holds whole numbers) numbers the rows.
    robot : Robot, optional
        The arm that was loaded. With it, poses are checked against its limits and those given in the world are solved.

    Returns
    -------
    LoadTests or JointTests
        In SI and in {M}; ``JointTests`` where one joint was loaded at a time. What only looks odd is in ``.findings``.

    Raises
    ------
    LoadTestError
        Naming file, row and column of what cannot be read, or the row of a pose that the robot cannot take.

    Notes
    -----
    The columns of each protocol are listed in the module ``robomill.io.measured.load_tests``. Forces and displacements
    are differences between loaded and preloaded readings, so that gravity cancels (paper, Sec. 5.1).

    Examples
    --------
    >>> import robomill as rm
    >>> tests = rm.read_load_tests("X_mm,Y_mm,Z_mm,A_deg,B_deg,Fx_N,Fy_N,Fz_N,dx_mm,dy_mm,dz_mm\\n"
    ...                            "0,-1300,0,0,0,0,250,0,0.012,0.574,-0.256")
    >>> tests
    <LoadTests 1 test at 1 pose, up to 250 N and 0.629 mm, measured>
    >>> tests.wrench[0, 1], float(tests.displacement[0, 1])
    (np.float64(250.0), 0.000574)
    """
    tests = _read(path_or_text, robot)
    return tests if tests.single or robot is None else tests.with_joints(robot)


def _read(given: str | Path | bytes | DataFrame, robot: Robot | None, name: str = "") -> LoadTests | JointTests:
    if isinstance(given, str | Path):
        is_table = isinstance(given, str) and any(mark in given for mark in "\n,;\t")  # and not the name of one
        given = given if is_table else sample_or_file("load tests", given, LoadTestError)
    table, name = frame_columns(given, LAYOUT) if is_frame(given) else read_columns(given, LAYOUT, name)
    if any(key in table for key in COMPLIANCES):
        tests: LoadTests | JointTests = _compliances(table, robot)
    elif "torque" in table or "joint" in table:
        tests = _joints(table, robot)
    else:
        tests = _displacements(table, robot)
    head = table.place.head
    postures = [column for column in table.passed_over if column.lower() in POSTURE and "x" in table]
    ignored = tuple(
        Finding("ignored", f"Column {column!r} is not one of ours and is passed over.", head, code="passed-over")
        for column in table.passed_over
        if column not in postures
    )
    if postures:
        text = f"How the arm stood, said by {' and '.join(postures)}, is not read; give joints where it matters."
        ignored += (Finding("warning", text, head, count=len(postures), code="posture-not-read"),)
    made = Provenance(
        kind_of(head_of(table)), f"{name or ('pasted cells' if head else 'DataFrame')}\n{table.remarks}".strip()
    )
    return replace(tests, provenance=made, findings=ignored + tests.findings + _pose_suspicions(table))


def read_findings(tests: LoadTests | JointTests, robot: Robot | None = None) -> tuple[Finding, ...]:
    """Everything worth saying about the tests before a fit: from reading them, and suspicions of sign, unit, copies."""
    return (*tests.findings, *suspicions(tests, robot))


def _pose_suspicions(table: Columns) -> tuple[Finding, ...]:
    """Angles that look like radians under deg or the reverse, places that look like metres under mm."""
    vector = rotation_vector(table) or ()
    for names, unit, least, most, other in (
        (JOINTS, "deg", 6.3, np.inf, "rad"),
        (("x",), "mm", 10.0, np.inf, "m"),
        (("y",), "mm", 10.0, np.inf, "m"),
        (vector, "deg", 6.3, np.inf, "rad"),
        ((*vector, *ABC, *WPR), "rad", 0.0, 6.3, "deg"),
        ((*ABC, *WPR), "deg", 1.6, np.inf, "rad"),
    ):
        columns = [c for key, c in table.known.items() if key in names and c.unit == unit]
        largest = max((float(np.abs(from_si(table.values[c.quantity], unit)).max()) for c in columns), default=0.0)
        if largest > 0.0 and not least <= largest <= most:
            beyond = f"No {columns[0].written} is larger than" if largest < least else f"{columns[0].written} reaches"
            text = f"{beyond} {largest:.3g}: are these poses in {other}?"
            return (Finding("suspicious", text, code="pose-unit"),)
    return ()


# ---- the three protocols -------------------------------------------------------------------------------------------
def _displacements(table: Columns, robot: Robot | None) -> LoadTests:
    where = poses(table, robot)
    found: tuple[Finding, ...] = where.pop("findings", ())
    points = force_and_points(table, robot, where)
    found += points.pop("findings", ())
    cable = points.pop("F", None)
    F, moment = group(table, axes("f")), group(table, axes("m"))
    if F is not None and cable is not None:
        raise table.place.refuse("the force is given twice, by Fx and by a cable; keep one.")
    F = cable if F is None else F
    if F is None and moment is None:
        raise table.place.refuse("no force columns; give Fx_N,Fy_N,Fz_N, or load_N with a cable's direction.")
    read, dials = group(table, axes("d")), gauges(table)
    turned = None if rotation_vector(table) == axes("r") else group(table, axes("r"))
    if read is not None and dials is not None:
        raise table.place.refuse("displacements are given twice, by dx and by gauges; keep one.")
    moved, along = (read, None) if dials is None else dials
    if moved is None and turned is None:
        raise table.place.refuse(
            "the displacement columns are missing; give dx_mm,dy_mm,dz_mm, or gauge_x, _y, _z with reading_mm."
        )
    F0, d0 = group(table, axes("f0")), group(table, axes("d0"))
    if F0 is None and d0 is None:
        text = "Displacements are taken as differences between loaded and unloaded readings; gravity cancels in them."
        found += (Finding("info", text, code="differences"),)
    nothing, unknown = np.zeros((len(table.row), 3)), np.full((len(table.row), 3), np.nan)
    F, moved = (nothing if F is None else F), (unknown if moved is None else moved)
    return LoadTests(
        wrench=np.concatenate([F - (0.0 if F0 is None else F0), nothing if moment is None else moment], axis=1),
        displacement=np.concatenate(
            [moved - (0.0 if d0 is None else d0), unknown if turned is None else turned], axis=1
        ),
        gauges=along,
        noise=table.values.get("noise"),  # type: ignore[arg-type]
        row=table.row,
        findings=found,
        **points,
        **where,
    )


def _joints(table: Columns, robot: Robot | None) -> JointTests:
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
    _check_sliding(table, joint.astype(np.int64), robot)
    return JointTests(
        joint=joint.astype(np.int64),
        torque=table.values["torque"],
        angle=table.values["angle"],
        noise=table.values.get("noise"),  # type: ignore[arg-type]
        row=table.row,
    )


def _check_sliding(table: Columns, joint: IntArray, robot: Robot | None) -> None:
    """Forces and displacements are of joints that slide: of one that turns nobody knows at which lever arm."""
    for key, meant in (("torque", "its torque in Nm"), ("angle", "its angle in mrad")):
        if table.known[key].unit not in SLIDING[key]:
            continue
        if robot is None:
            raise table.place.refuse(
                f"column {table.written(key)} is of joints that slide, which need the robot; read the tests with it."
            )
        turns = (joint <= robot.n) & ~robot.chain.prismatic[np.minimum(joint, robot.n) - 1]
        if turns.any():
            k = int(np.argmax(turns))
            raise table.refuse(
                k, key, f"joint {joint[k]} turns; give {meant} (of a dial gauge: its reading over its distance)."
            )


def _compliances(table: Columns, robot: Robot | None) -> LoadTests:
    m = len(table.row)
    load = table.values.get("load")
    where = poses(table, robot)
    found: tuple[Finding, ...] = where.pop("findings", ())
    sliding = where.pop("sliding", None)
    if load is None:
        text = f"No load_N column: residuals are stated for the paper's dead weight of {NOMINAL_LOAD:g} N."
        found, load = (*found, Finding("info", text, code="nominal-load")), np.full(m, NOMINAL_LOAD)
    if (load <= 0).any():
        k = int(np.argmax(load <= 0))
        raise table.refuse(k, "load", "expected a load above zero.")
    C = np.full((m, 3, 3), np.nan)
    for i, j in np.ndindex(3, 3):
        C[:, i, j] = table.values.get(f"c{XYZ[i]}{XYZ[j]}", np.nan)
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
        sliding=sliding,
        **{key: value[each] for key, value in where.items()},
    )


def read_measured_map(given: str | Path | bytes, robot: Robot, name: str = "") -> MeasuredField:
    """The paper's second method: a grid of measured compliances (or displacements in three directions) as a map."""
    tests = _read(given, robot, name)
    if tests.single:
        raise LoadTestError("Measured map: found tests of single joints; give compliances Cxx_um_N ... at poses.")
    return MeasuredField.from_tests(robot, tests)
