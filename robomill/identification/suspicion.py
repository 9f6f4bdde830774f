"""What looks wrong in the measurements before anything is fitted: signs, units, copies. Said aloud, never mended."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robomill.arrays import FloatArray
from robomill.compliance.cartesian import cartesian_compliance
from robomill.compliance.deflection import displacement
from robomill.identification.load_test import JointTests, LoadTests
from robomill.provenance import Finding
from robomill.robot.model import Robot

PLAUSIBLE = (1e-10, 1e-4)  # m/N: from a rigid machine tool to a robot one can push about by hand
PLAUSIBLE_JOINT = (1e-10, 1e-2)  # rad/(N m)


def suspicions(tests: LoadTests | JointTests, robot: Robot | None = None) -> tuple[Finding, ...]:
    """Findings on sign, unit and repeated rows.

    A compliance is positive definite, so a displacement *along* its own force is positive; against the force at most
    tests means a flipped sign. A factor of 1000 against the plausible range, or against the robot's own values
    where it has some, means a wrong unit.
    """
    if tests.single:
        return _joint_suspicions(tests)
    return (*_signs(tests), *_sizes(tests, robot), *_repeats(tests))


def _signs(tests: LoadTests) -> list[Finding]:
    F, read, moved = tests.wrench[:, :3], tests.displacement[:, :3], tests.vectors
    size = np.linalg.norm(F, axis=1)
    along = np.einsum("mgi,mi->mg", tests.directions, F)
    names = [(name, "the force", "it") for name in tests.components]
    if tests.gauges is None:
        names = [(f"d{axis}", f"F{axis}", axis) for axis in tests.components]
    loaded = np.isfinite(moved).all(axis=1) & (size > 0)
    against = loaded & (np.einsum("mi,mi->m", F, np.nan_to_num(moved)) < 0)  # negative work: no spring gives that
    found = []
    flipped = []
    for i, (name, force, main_axis) in enumerate(names):
        main = (np.abs(along[:, i]) > 0.9 * size) & np.isfinite(read[:, i]) & (size > 0)
        wrong = main & (along[:, i] * read[:, i] < 0)
        if main.sum() >= 2 and wrong.sum() > 0.5 * main.sum():
            flipped.append(name)
            found.append(
                f"{name} runs against {force} in {int(wrong.sum())} of the {int(main.sum())} tests loaded along "
                f"{main_axis}"
            )
    if against.sum() > (0.9 if flipped else 0.5) * loaded.sum():
        found.insert(0, f"The tool moves against its force in {int(against.sum())} of {int(loaded.sum())} tests")
        flipped = list(tests.components)
    if flipped:
        what = "the sign of the displacements" if len(flipped) == 3 else f"the sign of {flipped[0]}"
        return [Finding("suspicious", 0, f"{'; '.join(found)}: is {what} or of the forces turned round?", code="sign")]
    return []


def _sizes(tests: LoadTests, robot: Robot | None) -> list[Finding]:
    F, moved = tests.wrench[:, :3], tests.displacement[:, :3]
    size = np.linalg.norm(F, axis=1)
    loaded = size > 0
    if not loaded.any():
        return []
    given = float(np.median(np.sqrt(np.nansum(moved[loaded] ** 2, axis=1)) / size[loaded]))
    if given == 0.0:
        return [
            Finding(
                "suspicious",
                0,
                "Most displacements are zero: was the gauge read, and to enough digits?",
                code="no-displacement",
            )
        ]
    expected = _expected(tests, robot)
    if expected is not None and not 1 / 100 < given / expected < 100:
        times, word = (given / expected, "larger") if given > expected else (expected / given, "smaller")
        against = "than this robot's own compliances would give"
    elif not PLAUSIBLE[0] < given < PLAUSIBLE[1]:
        times, word = (given / 1e-6, "larger") if given > 1e-6 else (1e-6 / given, "smaller")
        against = "than the 1 µm/N of a usual robot"
    else:
        return []
    text = f"The displacements are about {times:.3g} times {word} {against}: is their unit, or the forces', right?"
    return [Finding("suspicious", 0, text, code="unit")]


def _expected(tests: LoadTests, robot: Robot | None) -> float | None:
    """Typical m/N of the tests by the robot's own joint compliances, where it has any."""
    if robot is None or tests.theta is None or not np.any(robot.C_theta > 0):
        return None
    chosen = np.linspace(0, len(tests) - 1, min(len(tests), 200)).astype(int)
    F = tests.wrench[chosen, :3]
    moved = displacement(cartesian_compliance(robot, tests.theta[chosen]), F)
    size = np.linalg.norm(F, axis=1)
    ratio = np.linalg.norm(moved, axis=1)[size > 0] / size[size > 0]
    return float(np.median(ratio)) if len(ratio) and np.median(ratio) > 0 else None


def _repeats(tests: LoadTests) -> list[Finding]:
    poses = tests.theta if tests.theta is not None else tests.x_M
    assert poses is not None
    table = np.concatenate([poses, tests.wrench, np.nan_to_num(tests.displacement)], axis=1)
    first, again = _first_repeat(table)
    if again is None or first is None:
        return []
    copies = len(table) - len(np.unique(_bytes(table)))
    others = f" (and {copies - 1} more)" if copies > 1 else ""
    text = (
        f"Row {tests.row[again]} repeats row {tests.row[first]} to the last digit{others}; both are used: "
        "delete the copy unless it was measured twice."
    )
    return [Finding("warning", int(tests.row[again]), text, copies, code="repeat")]


def _first_repeat(table: FloatArray) -> tuple[int | None, int | None]:
    keys = _bytes(table)
    _, index, inverse = np.unique(keys, return_index=True, return_inverse=True)
    original = index[inverse]
    copies = np.flatnonzero(original != np.arange(len(table)))
    return (None, None) if len(copies) == 0 else (int(original[copies[0]]), int(copies[0]))


def _bytes(table: FloatArray) -> NDArray[np.void]:
    """Each row as one value, its bytes: equal where every number is equal."""
    whole = np.ascontiguousarray(table + 0.0)  # no minus zeros
    return whole.view(np.dtype((np.void, whole.strides[0]))).ravel()


def _joint_suspicions(tests: JointTests) -> tuple[Finding, ...]:
    found = []
    against = tests.angle * tests.torque < 0
    if against.mean() > 0.5:
        text = (
            f"The angle runs against the torque in {int(against.sum())} of {len(tests)} tests: is a sign turned round?"
        )
        found.append(Finding("suspicious", 0, text, code="sign"))
    typical = float(np.median(np.abs(tests.angle / tests.torque)))
    if not PLAUSIBLE_JOINT[0] < typical < PLAUSIBLE_JOINT[1]:
        text = f"A typical joint gives {typical:.2g} rad/(N m), far from the 1e-7 to 1e-5 of robots: is the unit right?"
        found.append(Finding("suspicious", 0, text, code="unit"))
    return tuple(found)
