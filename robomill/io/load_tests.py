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

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.errors import LoadTestError
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.measured_field import MeasuredField
from robomill.identification.suspicion import suspicions
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.units import UNITS, from_si, to_si

NOMINAL_LOAD = 250.0  # N, the paper's dead weight: residuals of measured compliances are stated for it

_SPELLING = {"Nm": "N m", "kNm": "kN m", "um_N": "um/N", "mm_N": "mm/N", "m_N": "m/N", "": "1"}
_ANGLE, _LENGTH, _FORCE, _MOMENT = ("deg", "rad"), ("mm", "um", "m", "in"), ("N", "kN"), ("Nm", "kNm")
_ROTATION, _COMPLIANCE = ("mrad", "urad", "rad", "deg"), ("um_N", "mm_N", "m_N")
_XYZ = "xyz"
_QUANTITIES: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("x", "y", "z"), _LENGTH),
    **dict.fromkeys(("a", "b"), _ANGLE),
    **{f"{name}{axis}": _FORCE for name in ("f", "f0") for axis in _XYZ},
    **{f"{name}{axis}": _LENGTH for name in ("d", "d0", "fp", "mp") for axis in _XYZ},
    **{f"m{axis}": _MOMENT for axis in _XYZ},
    **{f"r{axis}": _ROTATION for axis in _XYZ},
    **{f"c{row}{column}": _COMPLIANCE for row in _XYZ for column in _XYZ},
    "joint": ("",),
    "torque": (*_MOMENT, *_FORCE),
    "angle": (*_ROTATION, "mm", "um"),
    "load": _FORCE,
    "noise": (*_LENGTH, "mrad", "urad"),
}
_WORLD = ("x", "y", "z", "a", "b")
assert all(_SPELLING.get(unit, unit) in UNITS for allowed in _QUANTITIES.values() for unit in allowed)


@dataclass(frozen=True)
class _Table:
    """Columns in SI by lower-case quantity, the row number of each line, the remarks, and the header as written."""

    columns: dict[str, FloatArray]
    header: dict[str, str]
    row: IntArray
    remarks: str
    findings: tuple[Finding, ...]

    def group(self, names: Sequence[str]) -> FloatArray | None:
        """The named columns side by side, None if there is none of them; a part of them is refused."""
        present = [name for name in names if name in self.columns]
        if not present:
            return None
        for name in names:
            if name not in self.columns:
                raise LoadTestError(
                    f"Header: column {_written(name)} is missing beside {self.header[present[0]]}; all of "
                    f"{', '.join(_written(n) for n in names)} are needed."
                )
        return np.stack([self.columns[name] for name in names], axis=-1)


def read_load_tests(path_or_text: str | Path, robot: Robot | None = None) -> LoadTests | JointTests:
    """Read load tests of any protocol (see the module). With a robot, poses and sizes are checked against it too.

    Raises LoadTestError naming row and column. What only looks odd is in ``.findings``.
    """
    text, name = _text(path_or_text)
    table = _table(text)
    if any(key.startswith("c") for key in table.columns):
        tests: LoadTests | JointTests = _compliances(table, name)
    elif "torque" in table.columns or "joint" in table.columns:
        tests = _joints(table, name)
    else:
        tests = _displacements(table, name)
    if isinstance(tests, LoadTests) and robot is not None:
        tests = tests.with_joints(robot)
    return replace(tests, findings=table.findings + tests.findings + _pose_suspicions(table))


def read_findings(tests: LoadTests | JointTests, robot: Robot | None = None) -> tuple[Finding, ...]:
    """Everything worth saying about the tests before a fit: from reading them, and suspicions of sign, unit, copies."""
    return (*tests.findings, *suspicions(tests, robot))


def _pose_suspicions(table: _Table) -> tuple[Finding, ...]:
    """Angles that look like radians under deg, places that look like metres under mm."""
    found: list[Finding] = []
    for start, unit, most, other in (("theta", "deg", 6.3, "rad"), ("x", "mm", 10.0, "m"), ("y", "mm", 10.0, "m")):
        columns = [key for key in table.columns if key.startswith(start) and table.header[key].endswith(f"_{unit}")]
        largest = max((float(np.abs(from_si(table.columns[key], unit)).max()) for key in columns), default=0.0)
        if 0.0 < largest < most and not found:
            text = f"No {table.header[columns[0]]} is larger than {largest:.3g}: are these poses in {other}?"
            found.append(Finding("suspicious", 0, text))
    return tuple(found)


# ---- the three protocols -------------------------------------------------------------------------------------------
def _poses(table: _Table) -> dict[str, Any]:
    joints = sorted((int(key[5:]), key) for key in table.columns if key.startswith("theta"))
    world = [key for key in _WORLD if key in table.columns]
    if joints and world:
        raise LoadTestError(
            f"Header: poses are given twice, as {table.header[joints[0][1]]} and {table.header[world[0]]}; keep one."
        )
    if joints:
        for k, (number, key) in enumerate(joints, 1):
            if number != k:
                raise LoadTestError(f"Header: found {table.header[key]} but no theta{k}_deg; number the joints from 1.")
        return {"theta": np.stack([table.columns[key] for _, key in joints], axis=-1)}
    x_M = table.group(_WORLD)
    if x_M is None:
        raise LoadTestError("Header: no pose columns; give theta1_deg to thetaN_deg, or X_mm,Y_mm,Z_mm,A_deg,B_deg.")
    return {"x_M": x_M}


def _displacements(table: _Table, name: str) -> LoadTests:
    F, moved = table.group(_axes("f")), table.group(_axes("d"))
    moment, turned = table.group(_axes("m")), table.group(_axes("r"))
    poses = _poses(table)
    if F is None and moment is None:
        raise LoadTestError("Header: no force columns; give Fx_N,Fy_N,Fz_N.")
    if moved is None and turned is None:
        raise LoadTestError("Header: the displacement columns are missing; give dx_mm,dy_mm,dz_mm.")
    m = len(table.row)
    F0, d0 = table.group(_axes("f0")), table.group(_axes("d0"))
    nothing, unknown = np.zeros((m, 3)), np.full((m, 3), np.nan)
    F, moved = (nothing if F is None else F), (unknown if moved is None else moved)
    found: tuple[Finding, ...] = ()
    if F0 is None and d0 is None:
        text = "Displacements are taken as differences between loaded and unloaded readings; gravity cancels in them."
        found = (Finding("info", 0, text),)
    return LoadTests(
        wrench=np.concatenate([F - (0.0 if F0 is None else F0), nothing if moment is None else moment], axis=1),
        displacement=np.concatenate(
            [moved - (0.0 if d0 is None else d0), unknown if turned is None else turned], axis=1
        ),
        force_point=table.group(_axes("fp")),  # type: ignore[arg-type]
        measuring_point=table.group(_axes("mp")),  # type: ignore[arg-type]
        noise=table.columns.get("noise"),  # type: ignore[arg-type]
        row=table.row,
        findings=found,
        source=_source(name, table),
        **poses,
    )


def _joints(table: _Table, name: str) -> JointTests:
    for key, example in (("joint", "joint"), ("torque", "torque_Nm"), ("angle", "angle_mrad")):
        if key not in table.columns:
            raise LoadTestError(
                f"Header: column {example} is missing; one joint at a time needs joint,torque_Nm,angle_mrad."
            )
    joint = table.columns["joint"]
    odd = (joint != np.round(joint)) | (joint < 1)
    if odd.any():
        k = int(np.argmax(odd))
        raise LoadTestError(f"Row {table.row[k]}, column joint: found {joint[k]:g}, expected a joint number from 1.")
    return JointTests(
        joint=joint.astype(np.int64),
        torque=table.columns["torque"],
        angle=table.columns["angle"],
        noise=table.columns.get("noise"),  # type: ignore[arg-type]
        row=table.row,
        source=_source(name, table),
    )


def _compliances(table: _Table, name: str) -> LoadTests:
    m = len(table.row)
    load = table.columns.get("load")
    found: tuple[Finding, ...] = ()
    if load is None:
        text = f"No load_N column: residuals are stated for the paper's dead weight of {NOMINAL_LOAD:g} N."
        found, load = (Finding("info", 0, text),), np.full(m, NOMINAL_LOAD)
    if (load <= 0).any():
        k = int(np.argmax(load <= 0))
        raise LoadTestError(f"Row {table.row[k]}, column {table.header['load']}: expected a load above zero.")
    C = np.full((m, 3, 3), np.nan)
    for i, j in np.ndindex(3, 3):
        C[:, i, j] = table.columns.get(f"c{_XYZ[i]}{_XYZ[j]}", np.nan)
    F = np.broadcast_to(np.eye(3), (m, 3, 3)) * load[:, None, None]
    measured = np.isfinite(C).any(axis=1)  # by force direction
    each = np.repeat(np.arange(m), 3)[measured.ravel()]
    noise = table.columns.get("noise")
    return LoadTests(
        wrench=F.reshape(-1, 3)[measured.ravel()],
        displacement=(np.swapaxes(C, 1, 2) * load[:, None, None]).reshape(-1, 3)[measured.ravel()],
        row=table.row[each],
        noise=None if noise is None else noise[each],  # type: ignore[arg-type]
        findings=found,
        source=_source(name, table),
        protocol="measured compliances",
        **{key: value[each] for key, value in _poses(table).items()},
    )


# ---- cells ---------------------------------------------------------------------------------------------------------
def _text(path_or_text: str | Path) -> tuple[str, str]:
    if isinstance(path_or_text, str) and ("\n" in path_or_text or "\r" in path_or_text):
        return path_or_text.removeprefix("\ufeff"), "pasted cells"
    path = Path(path_or_text)
    try:
        return path.read_bytes().decode("utf-8-sig"), path.name
    except OSError as exc:
        raise LoadTestError(f"{path}: cannot be opened ({exc.strerror}); give the path of a CSV file.") from exc
    except UnicodeDecodeError as exc:
        raise LoadTestError(f"{path.name}: not a text file; save the table as CSV (UTF-8).") from exc
    except ValueError as exc:
        raise LoadTestError(f"{str(path_or_text)[:40]!r} is neither a file nor a table with a header.") from exc


def _table(text: str) -> _Table:
    lines = text.splitlines()
    remarks = "\n".join(line.lstrip("# ").rstrip() for line in lines if line.startswith("#"))
    kept = [(k, line) for k, line in enumerate(lines, 1) if line.strip(" \t,;") and not line.startswith("#")]
    if not kept:
        raise LoadTestError("Load tests: the file is empty; give a header (theta1_deg,...,dz_mm) and one row a test.")
    (number, head), body = kept[0], kept[1:]
    separator = next((mark for mark in "\t;" if mark in head), ",")
    names = [cell.strip().strip('"') for cell in head.split(separator)]
    if all(_is_number(cell) for cell in names):
        raise LoadTestError(
            f"Row {number}: found numbers, expected a header that names columns and units, such as Fx_N."
        )
    if not body:
        raise LoadTestError(f"Load tests: only a header (row {number}) and no test below it; add one row a test.")
    known, header, findings = _header(names, number)
    row = np.array([k for k, _ in body])
    values = _numbers([line for _, line in body], row, names, [at for at, _, _ in known], separator)
    columns = {key: to_si(values[:, k], unit) for k, (_, key, unit) in enumerate(known)}
    return _Table(columns, header, row, remarks, findings)


def _header(names: list[str], number: int) -> tuple[list[tuple[int, str, str]], dict[str, str], tuple[Finding, ...]]:
    """Known columns as (position, quantity, unit), how each was written, and findings on the ones passed over."""
    known: list[tuple[int, str, str]] = []
    header: dict[str, str] = {}
    findings = []
    for at, name in enumerate(names):
        quantity, _, suffix = name.partition("_")
        key = quantity.lower()
        allowed = (*_ANGLE, "mm", "m") if re.fullmatch(r"theta[1-9]", key) else _QUANTITIES.get(key)
        if allowed is None:
            findings.append(Finding("ignored", number, f"Column {name!r} is not one of ours and is passed over."))
            continue
        if suffix not in allowed:
            spelled = ", ".join(f"{quantity}_{unit}" for unit in allowed if unit)
            what = f"unit {suffix!r} is not known" if suffix else "the unit is missing"
            raise LoadTestError(f"Row {number}, column {name!r}: {what}; write one of {spelled or quantity}.")
        if key in header:
            raise LoadTestError(f"Row {number}: {header[key]} and {name} are the same quantity twice; keep one.")
        header[key] = name
        known.append((at, key, _SPELLING.get(suffix, suffix)))
    if not known:
        raise LoadTestError(f"Row {number}: no column is known; expected a header such as theta1_deg,...,dz_mm.")
    return known, header, tuple(findings)


def _numbers(lines: list[str], row: IntArray, names: list[str], wanted: list[int], separator: str) -> FloatArray:
    """(m, columns) the wanted cells. The quick reader first; only when it fails is the bad cell looked for."""
    commas = separator != ","
    lines = [line.replace('"', "").replace(",", ".") if commas else line.replace('"', "") for line in lines]
    for k, line in enumerate(lines):
        if line.count(separator) != len(names) - 1:
            found = line.count(separator) + 1
            raise LoadTestError(f"Row {row[k]}: found {found} cells, expected {len(names)} as in the header.")
    try:
        values = np.loadtxt(lines, delimiter=separator, usecols=wanted, ndmin=2, comments=None)
    except ValueError:
        values = _slowly(lines, row, names, wanted, separator)
    if not np.isfinite(values).all():
        k, c = (int(v) for v in np.argwhere(~np.isfinite(values))[0])
        _refuse_cell(row[k], names[wanted[c]], f"{values[k, c]}")
    return values


def _slowly(lines: list[str], row: IntArray, names: list[str], wanted: list[int], separator: str) -> FloatArray:
    values = np.empty((len(lines), len(wanted)))
    for k, line in enumerate(lines):
        cells = line.split(separator)
        for c, at in enumerate(wanted):
            if not _is_number(cells[at]):
                _refuse_cell(row[k], names[at], cells[at].strip())
            values[k, c] = float(cells[at])
    return values


def _refuse_cell(row: int, column: str, found: str) -> None:
    what = f"found {found!r}" if found else "the cell is empty"
    cure = "measure it again or delete the row" if found in ("", "nan") else "enter a plain number such as 0.125"
    raise LoadTestError(f"Row {row}, column {column}: {what}, expected a number; {cure}.", where=f"row {row}, {column}")


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell


def _axes(name: str) -> tuple[str, str, str]:
    return (f"{name}x", f"{name}y", f"{name}z")


def _written(name: str) -> str:
    """A quantity as the header would write it."""
    unit = _QUANTITIES[name][0]
    spelled = name.upper() if name in _WORLD else (name[:-1].upper() + name[-1] if name[0] in "fm" else name)
    return f"{spelled}_{unit}" if unit else spelled


def _source(name: str, table: _Table) -> str:
    return f"{name}\n{table.remarks}".strip()


def read_measured_map(path_or_text: str | Path, robot: Robot) -> MeasuredField:
    """The paper's second method: a grid of measured compliances (or displacements in three directions) as a map."""
    tests = read_load_tests(path_or_text)
    if isinstance(tests, JointTests):
        raise LoadTestError("Measured map: found tests of single joints; give compliances Cxx_um_N ... at poses.")
    return MeasuredField.from_tests(robot, tests)
