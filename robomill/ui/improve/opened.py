"""A remedy opened: its picture before and after, what it is made of, and what it leaves."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.improve.advice import Advice
from robomill.improve.compensation import Compensation
from robomill.improve.placed import Place, Placement
from robomill.improve.turning import Turning
from robomill.simulation.result import SimulationResult
from robomill.ui import inputs, pieces
from robomill.ui.improve import stiffen
from robomill.ui.improve.remedies import Found, Left, Stiffened, error_words, take, use
from robomill.ui.shell import dark
from robomill.ui.verdict import WORDS
from robomill.units import (
    format_count,
    format_many,
    format_percent,
    format_short,
    format_si,
    from_si,
    in_lengths,
    to_si,
)
from robomill.viz.remedies import corrected_lines, cost_front, places_map, spins_map


def opened(found: Found, result: SimulationResult, unit: str) -> None:
    """The remedy's own part of the page."""
    if found.left is not None:
        OPENED[found.remedy.name](found.made, found.left, result, unit)


def _corrected(found: Compensation, left: Left, result: SimulationResult, unit: str) -> None:
    here, beside = pieces.split([1, 1.7], "page", gap="large")
    with here, st.container(border=True):
        pieces.strong("What the corrected program leaves")
        rows = [
            (name, format_si(each.max, unit), f"{format_percent(each.max / result.setup.tolerance)} of the tolerance")
            for name, each in (
                ("as it is", found.before),
                ("corrected", found.after),
                ("if the arm is 20 % softer or stiffer", found.softer),
                ("if the force is 20 % off", found.stronger),
            )
        ]
        pieces.facts(rows)
        words = f"Found after {format_count(found.iterations, 'iteration')}: force and engagement are those of the "
        pieces.note(words + "corrected path. Along the feed nothing is changed.")
        for why in found.unrolled:
            pieces.note(f"Written out: {why}.")
        for finding in found.findings:
            pieces.note(finding.sentence)
        pieces.download(
            "Corrected program", found.text, pieces.named("corrected.nc"), "improve.program", type="primary"
        )
        pieces.note("Run it on the machine in place of the other; here the project keeps the program that was meant.")
    with beside, st.container(border=True):
        columns = found.columns()
        cuts = np.asarray(columns["cutting"], dtype=bool)
        names = ("normal", "axial")
        before, after = (
            np.array([np.where(cuts, _shown(columns[f"{time}_{name}_mm"], unit), np.nan) for name in names])
            for time in ("before", "after")
        )
        station = _shown(columns["station_mm"], unit)
        pieces.strong("Off the path, before and after")
        pieces.figure(
            corrected_lines(station, before, after, ("across the feed", "along the axis"), unit, dark=dark()),
            "improve-corrected",
            table=lambda: columns,
            alt=f"Deviation along the cut: at most {format_si(found.before.max, unit)} before, "
            f"{format_si(found.after.max, unit)} with the corrected program.",
            caption="Measured against the path that was meant; inside the model.",
        )


def _shown(column: Any, unit: str) -> FloatArray:
    """A column in mm, in the unit of the screen."""
    return np.asarray(from_si(to_si(np.asarray(column, dtype=float), "mm"), unit))


def _stiffened(found: Stiffened, left: Left, result: SimulationResult, unit: str) -> None:
    made, joints = found.design, result.setup.robot.joint_numbers
    here, beside = pieces.split([1, 1.7], "page", gap="large")
    with here, st.container(border=True):
        pieces.strong(
            "The least stiffening that halves the error" if found.half else "The least stiffening that does it"
        )
        if not made.feasible:
            pieces.said("warning", made.sentence, "warning")
        rows = [
            (f"joint {number}", f"{format_short(ratio, '1', 3)} times as stiff", "as it is" if ratio < 1.001 else "")
            for number, ratio in zip(joints, made.stiffness_ratio, strict=True)
        ]
        pieces.facts(rows)
        pieces.note(
            f"Cost {format_short(made.cost, '1', 3)}, where 1 is one joint made twice as stiff. Errors are linear in "
            "the compliance of each joint, so the least is found for certain, by a convex program."
        )
        use(left, "Use these joints")
    with beside, st.container(border=True):
        front = made.front()
        share = from_si(front.share * made.setup.tolerance / result.setup.tolerance, "%")
        pieces.strong("What each error costs")
        pieces.figure(
            cost_front(share, front.cost, (float(from_si(left.share, "%")), made.cost), dark=dark()),
            "improve-front",
            table=lambda: {
                "used_%": share.tolist(),
                "cost": front.cost.tolist(),
                **{f"joint_{n}_times": front.stiffness_ratio[:, k].tolist() for k, n in enumerate(joints)},
            },
            alt=f"Cost of stiffer joints, from {format_short(front.cost[0], '1', 3)} where the least of the tolerance "
            f"is used ({format_short(share[0], '1', 3)} %) to 0 where the joints stay.",
            caption="From the joints as they are to ten times as stiff; errors as they go about the cut as it is.",
        )
    ranked = pieces.attempt(stiffen.found, result.setup)
    if ranked is None:
        return
    one, two = pieces.split([1, 1.7], "joints", gap="large")
    with one, st.container(border=True):
        pieces.strong("Each joint alone twice as stiff")
        pieces.note(stiffen.sentence(ranked, joints, unit), stiffen.together(ranked, joints))
        stiffen.remedies(ranked, joints, unit)
    with two, st.container(border=True):
        stiffen.ranking(ranked, joints, unit, dark())


def _places(places: Mapping[str, Place], unit: str) -> None:
    """What full simulations say of places, by name."""
    pieces.facts(
        [
            (
                name,
                f"{format_si(place.max_deviation, unit)} at the tip",
                f"{format_percent(place.share)} of the tolerance",
            )
            for name, place in places.items()
        ]
    )


def _placed(found: Placement, left: Left, result: SimulationResult, unit: str) -> None:
    here, beside = pieces.split([1, 1.7], "page", gap="large")
    with here, st.container(border=True):
        pieces.strong("Where the part lies")
        _places({"now": found.now, "best": found.best, "median": found.median, "worst": found.worst}, unit)
        pieces.note(
            f"Best at X, Y, Z {format_many(found.best.zero, unit, 1 if unit == 'mm' else 3)}, turned by "
            f"{format_si(found.best.yaw, 'deg', 1)}. {format_count(found.tried, 'place')} looked at, "
            f"{format_count(found.reached)} within reach, {format_count(found.allowed)} with room to limits and away "
            "from singular configurations."
        )
        for finding in found.findings:
            pieces.note(finding.sentence)
        use(left, "Move the part there")
    with beside, st.container(border=True):
        x, y = (from_si(axis, unit) for axis in found.axes[:2])
        marks = [
            (name, float(from_si(each.zero[0], unit)), float(from_si(each.zero[1], unit)))
            for name, each in (("now", found.now), ("best", found.best))
        ]
        used = from_si(found.plane, "%")
        pieces.strong("Tolerance used, by where part zero lies")
        pieces.figure(
            places_map(x, y, used, marks, unit, dark=dark()),
            "improve-places",
            table=found.columns,
            alt=f"Map of the tolerance used over {format_count(found.tried, 'place')}: now "
            f"{format_percent(found.now.share)}, at the best place {format_percent(found.best.share)}.",
            caption="At the best height and turn of each point; blank where the arm does not get, or has no room.",
        )


def _turned(found: Turning, left: Left, result: SimulationResult, unit: str) -> None:
    here, beside = pieces.split([1, 1.7], "page", gap="large")
    with here, st.container(border=True):
        pieces.strong("How the tool is turned about its axis")
        _places({"now": found.now, "best, all the way": found.constant, "turning": found.course}, unit)
        for finding in found.findings:
            pieces.note(finding.sentence)
        use(left, "Turn it so, all the way")
    with beside, st.container(border=True):
        pieces.strong("Tolerance used, by way and spin")
        course = np.asarray(from_si(found.way, unit)), np.asarray(from_si(found.turn, "deg"))
        station, angle = from_si(found.station, unit), from_si(found.angle, "deg")
        pieces.figure(
            spins_map(station, angle, from_si(found.share, "%"), course, unit, dark=dark()),
            "improve-spins",
            table=found.columns,
            alt=f"Map of the tolerance used by way and spin: now {format_percent(found.now.share)}, at the best spin "
            f"{format_percent(found.constant.share)}, turning {format_percent(found.course.share)}.",
            caption="White: the best course; blank beyond limits and near singular configurations.",
        )


def _cut(found: Advice, left: Left, result: SimulationResult, unit: str) -> None:
    with st.container(border=True):
        pieces.strong("The same part, cut in other ways")
        rows = []
        for way in found.ways:
            if way.run is None:
                rows.append([way.title, "–", "–", "–", way.refused])
                continue
            verdict = way.run.verdict
            used = format_percent(way.share) if np.isfinite(way.share) else "–"
            rate = format_si(way.removal_rate, in_lengths("cm3/min", unit), 1) if np.isfinite(way.removal_rate) else "–"
            rows.append(
                [way.title, f"{way.seconds:.1f} s", rate, f"{error_words(way.run, unit)}, {used}", WORDS[verdict.level]]
            )
        best = list(found.ways).index(found.best)
        head = ("Way", "Time at feed", "Removed", "Error, of tolerance", "Verdict")
        pieces.table(rows, "wnnnv", head, strong=best)
        pieces.note("Bold: the quickest way within tolerance; the truest where none is. Each is a run of its own.")
        better = {way.name: way.title for way in found.ways[1:] if way.run is not None}
        name = inputs.pick("Way", "improve.way", better, look=inputs.LISTED)
        way = next(each for each in found.ways if each.name == name)
        if way.run is not None:
            inputs.button(
                "Cut it this way", "improve.way.use", "check", take, way.run.setup, help="Undo takes it back."
            )


OPENED: dict[str, Callable[[Any, Left, SimulationResult, str], None]] = {
    "program": _corrected,
    "stiffen": _stiffened,
    "place": _placed,
    "turn": _turned,
    "cut": _cut,
}
