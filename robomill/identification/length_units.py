"""Lengths under another unit than their header's: inches as mm, a wrong prefix. Told by what they would explain."""

from dataclasses import replace

import numpy as np

from robomill.errors import LoadTestError
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
    """Points or pulleys that explain the readings far better in another unit."""
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
    (what, slip), least = min(found.items(), key=lambda each: each[1], default=(("", ""), np.inf))
    if not np.isfinite(stated) or least * BETTER > stated:
        return ()
    was, now = format_percent(stated), format_percent(least)
    text = (
        f"Read as {slip}, {what} would take what the fit leaves over from {was} to {now} of the displacements: is the "
        "unit right?"
    )
    return (Finding("suspicious", text, code="length-unit"),)


def _left_over(robot: Robot, tests: LoadTests) -> float:
    """Share of the readings that the joints do not explain; infinite where they cannot be fitted."""
    try:
        system = build_system(robot, tests, Model("joints"))
    except LoadTestError:
        return float("inf")
    missed = system.A @ system.fit().x - system.b
    return float(np.linalg.norm(missed) / np.linalg.norm(system.b)) if system.b.any() else 0.0
