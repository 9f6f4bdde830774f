"""What a robot's numbers must satisfy; each refusal says which joint, what was found and what was expected."""

from typing import Any

import numpy as np

from robomill.arrays import NO_NUMBERS, BoolArray, FloatArray, brief, check_place, no_number
from robomill.errors import RobotError
from robomill.quantities import Quantity

MIN_JOINTS, MAX_JOINTS = 1, 7


def column(value: Any, declared: Quantity, rows: int | None, where: str, slides: BoolArray | None = None) -> FloatArray:
    """A table column (rows,) of finite numbers within its bounds; ``slides`` (rows,) says in which unit to refuse."""
    name = declared.label
    try:
        array = np.asarray(value, dtype=np.float64)
    except NO_NUMBERS:
        raise RobotError(f"{where}: {name}: expected numbers, found {no_number(value) or brief(value, 40)}.") from None
    if array.ndim != 1 or (rows is not None and len(array) != rows):
        want = "one number a joint" if rows is None else f"{rows} numbers, one a joint"
        raise RobotError(f"{where}: {name}: expected {want}, found shape {array.shape}.")
    for i in np.flatnonzero(~declared.allows(array))[:1]:
        if not np.isfinite(array[i]):
            found = "NaN (a missing value)" if np.isnan(array[i]) else "infinity"
            raise RobotError(f"{where}: joint {i + 1}: {name} is {found}; give a finite number.")
        one = declared.of_joint(slides is not None and bool(slides[i]))
        raise RobotError(f"{where}: joint {i + 1}: {name} is {one.short(array[i])}; expected {one.expected}.")
    return array


def flags(value: Any, rows: int, where: str) -> BoolArray:
    """(rows,) True where a joint slides; one word serves all."""
    found = np.asarray(value, dtype=object)
    if found.shape not in ((), (rows,)):
        raise RobotError(
            f"{where}: prismatic: expected True or False for each of {rows} joints, found {value!r:.60}; "
            "True where the joint slides."
        )
    for i, each in enumerate(found.ravel()):
        if not isinstance(each, bool | np.bool_) and each not in (0, 1):
            joint = f", joint {i + 1}" if found.ndim else ""
            raise RobotError(
                f"{where}: prismatic{joint}: expected True where it slides or False where it turns, found {each!r:.40}."
            )
    return np.array(np.broadcast_to(found.astype(bool), (rows,)))


def joint_count(rows: int, where: str) -> None:
    if not MIN_JOINTS <= rows <= MAX_JOINTS:
        found = "none" if rows == 0 else str(rows)
        raise RobotError(f"{where}: expected {MIN_JOINTS} to {MAX_JOINTS} joints, found {found}.")


def signs(sign: FloatArray, where: str) -> None:
    bad = np.flatnonzero(np.abs(sign) != 1.0)
    if bad.size:
        raise RobotError(f"{where}: joint {bad[0] + 1}: sign is {sign[bad[0]]:g}; it must be 1 or -1.")


def limits(value: FloatArray, declared: Quantity, slides: BoolArray, where: str) -> None:
    for i, (low, high) in enumerate(value):
        if not low < high:
            short = declared.of_joint(bool(slides[i])).short
            raise RobotError(
                f"{where}: joint {i + 1}: the lower limit {short(low)} is not below the upper limit {short(high)}; "
                "give them as [lower, upper]."
            )


def frame(value: Any, name: str, where: str) -> FloatArray:
    """A rigid transform (4, 4): rotation to 1e-9, last row 0 0 0 1."""
    try:
        T = np.asarray(value, dtype=np.float64)
    except NO_NUMBERS:
        raise RobotError(f"{where}: {name}: expected a 4 x 4 matrix of numbers, found {brief(value, 40)}.") from None
    if T.shape != (4, 4) or not np.isfinite(T).all():
        raise RobotError(f"{where}: {name}: expected a 4 x 4 matrix of finite numbers, found shape {T.shape}.")
    R = T[:3, :3]
    error = float(np.abs(R.T @ R - np.eye(3)).max())
    if error > 1e-9 or np.linalg.det(R) < 0 or not np.array_equal(T[3], [0.0, 0.0, 0.0, 1.0]):
        why = "it is a mirror image" if error <= 1e-9 and np.linalg.det(R) < 0 else f"it is off by {error:.2g}"
        raise RobotError(
            f"{where}: {name} is not a rotation and a shift ({why}); its three axes must be unit, square, right-handed."
        )
    check_place(T[:3, 3], f"{where}: {name}", RobotError)
    return T
