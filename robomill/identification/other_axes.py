"""Forces and displacements along other axes than {M}'s: the tool's, a turned part's, or columns in another order.

Told by what they would explain, as lengths in another unit are (``length_units``).
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations, product

import numpy as np

from robomill.arrays import FloatArray
from robomill.identification.fit.least_squares import bounded_solution, triangle
from robomill.identification.fit.models import Model
from robomill.identification.length_units import BETTER
from robomill.identification.load_test import LoadTests
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.units import format_percent
from robomill.wording import listed

AMISS = 0.2  # of the displacements left over: less than other axes would leave
MOST = 60  # tests that are looked at; more are thinned evenly
FEWEST = 4  # tests from which anything can be said
XYZ = "xyz"


def axes_suspicions(robot: Robot, tests: LoadTests) -> tuple[Finding, ...]:
    """Forces or displacements that explain far more along other axes; of tests read along x, y and z in full."""
    whole = np.isfinite(tests.displacement[:, :3]).all(axis=1)
    if tests.gauges is not None or tests.aimed.any() or tests.wrench[:, 3:].any() or whole.sum() < FEWEST:
        return ()
    tests = tests.select(whole).thinned(MOST)
    for model in Model.asked_of_slips(robot, 3 * len(tests)):
        found = _suspected(robot, tests, model)
        if found:
            return found
    return ()


def _suspected(robot: Robot, tests: LoadTests, model: Model) -> tuple[Finding, ...]:
    """The axes along which the springs of ``model`` explain most."""
    F, moved = tests.wrench[:, :3], tests.displacement[:, :3]
    D = np.stack([_yield(robot, tests, axis, model) for axis in np.eye(3)], axis=-1)

    def left_over(force: FloatArray, read: FloatArray) -> float:
        A = np.einsum("mcpf,mf->mcp", D, force).reshape(-1, D.shape[2])
        R = triangle(A, read.ravel())
        x = bounded_solution(R[:, :-1], R[:, -1], np.zeros(A.shape[1], dtype=bool))
        return float(np.linalg.norm(A @ x - read.ravel()) / np.linalg.norm(read)) if read.any() else 0.0

    stated, what, least = left_over(F, moved), "", np.inf
    for said, force, read in _readings(robot, tests) if stated > AMISS else ():
        now = left_over(force, read)
        if now < 0.999 * least:
            what, least = said, now
    if not least * BETTER < stated:
        return ()
    was, now_left = format_percent(stated), format_percent(least)
    fit = "a fit with bending links" if model.has("bending") else "the fit"
    text = (
        f"{what}, they would take what {fit} leaves over from {was} to {now_left} of the displacements; all are read "
        "along the axes of {M}: is that the frame they were taken in?"
    )
    return (Finding("suspicious", text, code="axes"),)


def _yield(robot: Robot, tests: LoadTests, axis: FloatArray, model: Model) -> FloatArray:
    """(m, 3, p) displacements for each compliance under a unit force along an axis of {M}."""
    wrench = np.broadcast_to(np.concatenate([axis, np.zeros(3)]), (len(tests), 6))
    return model.terms(robot, replace(tests, wrench=wrench))[:, :3, 0]


def _readings(robot: Robot, tests: LoadTests) -> Iterator[tuple[str, FloatArray, FloatArray]]:
    """Ways in which the same forces and displacements (m, 3) may have been meant, the plainer first."""
    F, moved = tests.wrench[:, :3], tests.displacement[:, :3]
    tool = tests.tool_poses(robot)[:, :3, :3]
    for name, R in (("tool", tool), ("flange", tool @ robot.T_tool[:3, :3].T)):
        G, read = (np.einsum("mij,mj->mi", R, v) for v in (F, moved))
        yield f"Read in the frame of the {name} for forces and displacements", G, read
        yield f"Read in the frame of the {name} for forces alone", G, moved
        yield f"Read in the frame of the {name} for displacements alone", F, read
    for said, P in _signed_orders():
        if not np.array_equal(np.abs(P), np.eye(3)):  # what has its sign turned alone is found by ``suspicion``
            yield f"Read {said} for displacements", F, moved @ P.T
            yield f"Read {said} for forces", F @ P.T, moved
        if np.linalg.det(P) > 0:
            yield f"Read {said} for forces and displacements", F @ P.T, moved @ P.T


def _signed_orders() -> Iterator[tuple[str, FloatArray]]:
    """Orders of x, y, z with signs, in words, but for the one that is written and its opposite."""
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            P = np.eye(3)[list(order)] * np.array(signs)[:, None]
            if np.array_equal(np.abs(P), np.eye(3)) and abs(np.trace(P)) == 3.0:
                continue
            named = [f"{'' if sign > 0 else '-'}{XYZ[k]}" for k, sign in zip(order, signs, strict=True)]
            yield f"as {listed(named)}", P
