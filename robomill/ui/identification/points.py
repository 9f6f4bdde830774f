"""Where the tests were loaded and read: the lines of pull, and the points that were fitted."""

from typing import Any

import numpy as np
import streamlit as st

from robomill.errors import RobomillError
from robomill.identification.pull.found_points import TITLES, FoundPoint
from robomill.identification.pull.lines_of_pull import LinesOfPull
from robomill.identification.pull.pull_words import pull_report
from robomill.identification.result import IdentificationResult
from robomill.robot.model import Robot
from robomill.ui import pieces
from robomill.ui.bench import Bench
from robomill.ui.entry import inputs
from robomill.ui.identification.bench import decided, lines_of, used_tests
from robomill.ui.work.job import Underway
from robomill.units import format_many, format_si, from_si, unit_label
from robomill.viz.identification import gaps_figure

ICONS = {"suspicious": "visibility", "info": "info"}


def says_something(bench: Bench, robot: Robot, result: IdentificationResult) -> bool:
    """Whether there is more to see of the points than that the tests tell nothing of them."""
    if result.points:
        return True
    tests = used_tests(bench, robot)
    if tests is None:
        return False
    try:
        lines = lines_of(bench, robot)
    except (RobomillError, Underway):
        return True  # the page says which
    if lines is None:
        return True
    return bool(len(lines.pulley)) or pull_report(lines, robot, tests, result)[0] is not None


def points(bench: Bench, robot: Robot, result: IdentificationResult, unit: str, dark: bool) -> None:
    """What the forces alone say, what the fit found, and the offer to fit points."""
    rows = [_row(f"{TITLES[p.point].capitalize()}, fitted", p, unit) for p in result.points]
    tests = used_tests(bench, robot)
    if tests is None:
        pieces.note("One joint at a time: there is no load point on the tool.")
        return
    lines = pieces.attempt(lines_of, bench, robot)
    if lines is None:
        return
    by_lines, found = pull_report(lines, robot, tests, result)
    if by_lines is not None:
        rows.append(_row("Load point, by the lines of pull", by_lines, unit))
    if rows:
        with st.container(border=True):
            st.markdown("**Points of the tool, in the flange**")
            pieces.facts(rows)
            pieces.note(f"Off the stated ones; x, y, z in {unit_label(unit)} with 95 % intervals, all else left free.")
    for finding in found:
        pieces.said("info", finding.message, ICONS.get(finding.level, ""))
    if len(lines.pulley):
        with st.container(border=True):
            _gaps(lines, unit, dark)


def offer(bench: Bench, result: IdentificationResult) -> None:
    """The button that fits the points that are worth it (its sentence is among the findings), or the way back."""
    if result.offer is not None:
        names = " and ".join(TITLES[point.point] for point in result.offer.points)
        fit = (decided("fit_points"), result.offer.fit_points)
        inputs.button(f"Fit the {names}", "identification.offer", "my_location", *fit, width="stretch")
    elif result.points:
        back = (decided("fit_points"), "none")
        inputs.button("Take the points as stated", "identification.stated", "undo", *back, width="stretch")


def bending(result: IdentificationResult) -> None:
    """The button that lets the tests say where links bend, where that is worth it."""
    if result.bends is not None:
        bend = (decided("bending_auto"), True)
        inputs.button(
            "Let the tests say where links bend", "identification.bend", "auto_fix_high", *bend, width="stretch"
        )


def _row(name: str, point: FoundPoint, unit: str) -> tuple[str, str, str]:
    half = np.ptp(point.ci95, axis=1) / 2
    place = format_many(point.in_flange, unit, 1, with_unit=False)
    sure = format_many(half, unit, 1, with_unit=False) if np.isfinite(half).all() else "not held"
    return name, f"{format_si(point.off, unit, 1)} off", f"({place}) ± ({sure})"


def _gaps(lines: LinesOfPull, unit: str, dark: bool) -> None:
    """The gap of every row, with the load point found and with the stated one."""
    st.markdown("**How far each line of pull passes its pulley**")
    gap, stated = from_si(lines.gap, unit), from_si(lines.gap_stated, unit)
    odd = np.isin(lines.row, lines.suspects)
    moved = lines.shift is not None
    pieces.figure(
        gaps_figure(lines.row, gap, stated if moved else None, odd, unit_label(unit), dark=dark),
        f"ident-gaps-{unit}",
        name="lines-of-pull",
        table=lambda: gap_columns(lines, unit),
        caption=_pulleys(lines, unit) + (" Ringed: cannot be." if odd.any() else ""),
        alt="Distance of each row's force line from its pulley, with the load point found and with the stated one.",
    )


def _pulleys(lines: LinesOfPull, unit: str) -> str:
    places = "; ".join(f"({format_many(p, unit, 0, with_unit=False)})" for p in lines.pulley)
    return f"Pulley at {places} {unit_label(unit)} in {{M}}."


def gap_columns(lines: LinesOfPull, unit: str) -> dict[str, Any]:
    """One row a test: its pulley and its gaps."""
    return {
        "row": lines.row,
        "pulley": lines.which + 1,
        f"gap_{unit}": from_si(lines.gap, unit),
        f"gap_stated_{unit}": from_si(lines.gap_stated, unit),
        "cannot_be": np.isin(lines.row, lines.suspects),
    }
