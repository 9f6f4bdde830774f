"""Joints whose angles count the other way than the robot's file has it: told by what they would explain.

Pendants, D-H tables and descriptions of one arm often differ in the sense of a joint. The fit then takes its error for
another load point or for springs, and every interval is too sure of itself.
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np

from robomill.arrays import FloatArray
from robomill.identification.configurations import SOLVED
from robomill.identification.fit.least_squares import bounded_solution, triangle
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import measured_terms
from robomill.identification.length_units import BETTER
from robomill.identification.load_test import LoadTests
from robomill.progress import checkpoint
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.units import format_percent
from robomill.wording import listed

AMISS = 0.05  # of the displacements left over: less may be noise or any small thing
WELL = 0.25  # of the displacements left over: what leaves more explains nothing
MOST = 60  # tests that are looked at; more are thinned evenly
FEWEST = 4  # tests from which anything can be said
EVERY = 7  # joints of which all together are turned round; of more, one or two
CODE = "sense"


def sense_suspicions(robot: Robot, tests: LoadTests) -> tuple[Finding, ...]:
    """Joints whose stated angles explain far more with the opposite sign, of the joints' springs or beside bending."""
    solved = any(finding.code in SOLVED for finding in tests.findings)
    if tests.theta is None or solved or len(tests) < FEWEST:
        return ()
    tests = tests.thinned(MOST)
    readings = int(np.isfinite(tests.displacement[:, :3]).sum())
    for model in Model.asked_of_slips(robot, readings):
        found = _suspected(robot, tests, model)
        if found:
            return found
    return ()


def _suspected(robot: Robot, tests: LoadTests, model: Model) -> tuple[Finding, ...]:
    """The joints that explain most with the opposite sign, by the springs of ``model``."""
    which: tuple[int, ...] = ()
    stated, least = _left_over(robot, tests, model), np.inf
    for turned in _turned(robot.n) if stated > AMISS else ():
        checkpoint()
        now = _left_over(robot, _with_turned(robot, tests, turned), model)
        if now < 0.999 * least:
            which, least = turned, now
    if not least * BETTER < stated or least > WELL:
        return ()
    names = listed([f"theta{i + 1}" for i in which])
    was, now_left = format_percent(stated), format_percent(least)
    joints = "this joint" if len(which) == 1 else "these joints"
    fit = "a fit with bending links" if model.has("bending") else "the fit"
    text = (
        f"With the opposite sign of {names}, the poses would take what {fit} leaves over from {was} to {now_left} of "
        f"the displacements: do the angles of {joints} count the other way than in the robot's file?"
    )
    return (Finding("suspicious", text, count=len(which), code=CODE),)


def _turned(n: int) -> Iterator[tuple[int, ...]]:
    """Joints (from 0) that may all count the other way, the fewest first."""
    for size in range(1, (n if n <= EVERY else 2) + 1):
        yield from combinations(range(n), size)


def _with_turned(robot: Robot, tests: LoadTests, which: tuple[int, ...]) -> LoadTests:
    sign: FloatArray = np.ones(robot.n)
    sign[list(which)] = -1.0
    assert tests.theta is not None
    turned = replace(tests, theta=tests.theta * sign)
    return turned.moved(robot, np.zeros(3)) if turned.aimed.any() else turned


def _left_over(robot: Robot, tests: LoadTests, model: Model) -> float:
    """Share of the displacements that the springs of ``model`` do not explain."""
    terms, measured = measured_terms(robot, tests, model)
    linear = np.nonzero(measured)[1] < 3
    A, b = terms[linear, 0], tests.displacement[measured][linear]
    if not b.any():
        return 0.0
    R = triangle(A, b)
    x = bounded_solution(R[:, :-1], R[:, -1], np.zeros(A.shape[1], dtype=bool))
    return float(np.linalg.norm(A @ x - b) / np.linalg.norm(b))
