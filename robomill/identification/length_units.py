"""Lengths under another unit than their header's, of the tests or of the robot: told by what they would explain."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np

from robomill.errors import LoadTestError, RobotError
from robomill.identification.configurations import OTHER_UNITS
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import build_system
from robomill.identification.load_test import LoadTests
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.units import format_percent

LENGTHS = {  # fields of the tests that are lengths, one or several of which a slip takes together
    "the load point": ("force_point",),
    "the gauge point": ("measuring_point",),
    "the load point and the gauge point": ("force_point", "measuring_point"),
    "the pulleys": ("pulley",),
    "the load point and the pulleys": ("force_point", "pulley"),
    "all points and pulleys": ("force_point", "measuring_point", "pulley"),
}
WELL = 0.03  # of the displacements left over: nothing to explain
BETTER = 2.5  # by which what is left over must fall
MOST = 100  # tests that are looked at; more are thinned evenly


def length_suspicions(robot: Robot, tests: LoadTests) -> tuple[Finding, ...]:
    """Points, pulleys or lengths of the robot that explain the readings far better in another unit."""
    tests = tests.thinned(MOST)
    stated = _left_over(robot, tests)
    if stated < WELL:
        return ()
    found: dict[tuple[str, str], float] = {}
    flange = -robot.T_tool[:3, :3].T @ robot.T_tool[:3, 3]  # seen from the tip: points are stated from either
    for origin in (np.zeros(3), flange) if flange.any() else (flange,):
        for what, fields in LENGTHS.items():
            stated_from = {key: np.zeros(3) if key == "pulley" else origin for key in fields}
            far = {key: getattr(tests, key) - start for key, start in stated_from.items()}
            if not all(np.nan_to_num(each).any() for each in far.values()):
                continue
            for slip, times in OTHER_UNITS.items():
                scaled = replace(tests, **{key: start + far[key] * times for key, start in stated_from.items()})
                found[what, slip] = min(_left_over(robot, scaled), found.get((what, slip), np.inf))
    for what, scaled_by in _lengths_of(robot).items():
        for slip, times in OTHER_UNITS.items():
            with suppress(RobotError):  # no robot has lengths like that
                found[what, slip] = _left_over(scaled_by(times), tests)
    # Of two that explain the readings alike (lengths a a thousand times longer, d as much shorter) the larger is meant.
    (what, slip), least = min(
        found.items(), key=lambda each: (round(each[1], 6), -OTHER_UNITS[each[0][1]]), default=(("", ""), np.inf)
    )
    if not np.isfinite(stated) or least * BETTER > stated:
        return ()
    was, now = format_percent(stated), format_percent(least)
    text = (
        f"Read as {slip}, {what} would take what the fit leaves over from {was} to {now} of the displacements: is the "
        "unit right?"
    )
    return (Finding("suspicious", text, code="length-unit"),)


def _lengths_of(robot: Robot) -> dict[str, Callable[[float], Robot]]:
    """The robot with some of its lengths times a factor, where it has any."""

    def tool(times: float) -> Robot:
        T = np.array(robot.T_tool)
        T[:3, 3] *= times
        return robot.replace(T_tool=T)

    every: dict[str, tuple[bool, Callable[[float], Robot]]] = {
        "the robot's lengths a": (bool(robot.a.any()), lambda times: robot.replace(a=robot.a * times)),
        "the robot's lengths d": (bool(robot.d.any()), lambda times: robot.replace(d=robot.d * times)),
        "the tool's place on the flange": (bool(robot.T_tool[:3, 3].any()), tool),
    }
    return {what: scaled for what, (there, scaled) in every.items() if there}


def _left_over(robot: Robot, tests: LoadTests) -> float:
    """Share of the readings that the joints do not explain; infinite where they cannot be fitted."""
    try:
        system = build_system(robot, tests, Model("joints"))
    except LoadTestError:
        return float("inf")
    missed = system.A @ system.fit().x - system.b
    return float(np.linalg.norm(missed) / np.linalg.norm(system.b)) if system.b.any() else 0.0
