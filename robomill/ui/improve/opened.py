"""A remedy opened: its picture before and after, what it is made of, and what it leaves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.improve.advice import Advice
from robomill.improve.compensation import Compensation
from robomill.improve.placed import Place, Placement
from robomill.improve.remedies import Both, Stiffened, decides, error_at
from robomill.improve.turning import Turning
from robomill.provenance import Finding
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.ui import pieces
from robomill.ui.entry import inputs
from robomill.ui.improve import lab, stiffen
from robomill.ui.improve.remedies import Found, Shown, error_words, take, use
from robomill.ui.judged.verdict import WORDS
from robomill.ui.shell import dark
from robomill.units import (
    format_count,
    format_duration,
    format_many,
    format_share,
    format_short,
    format_si,
    from_si,
    in_lengths,
    to_si,
)
from robomill.viz.remedies import corrected_lines, cost_front, places_map, spins_map

LEVEL = "White line: all of the tolerance is used."
COLUMNS = (1, 1.7)  # a remedy in words, and its picture


def opened(found: Found, result: SimulationResult, unit: str) -> None:
    """The remedy's own part of the page."""
    if found.shown is not None:
        OPENED[found.remedy.code](found.made, found.shown, result, unit)


def _corrected(found: Compensation, row: Shown, result: SimulationResult, unit: str, first: str = "As it is") -> None:
    here, beside = pieces.split(COLUMNS, "remedy")
    with here, st.container(border=True):
        pieces.strong("What the corrected program leaves")
        rows = [
            (name, format_si(each.max, unit), format_share(each.share(result.setup)))
            for name, each in (
                (first, found.before),
                ("Corrected", found.after),
                ("Corrected, the arm 20 % softer or stiffer", found.softer),
                ("Corrected, the force 20 % off", found.stronger),
            )
        ]
        pieces.table(rows, " nn", ("Program", "Error", "Of tolerance"))
        words = f"Found after {format_count(found.iterations, 'iteration')}: force and engagement are those of the "
        pieces.note(words + "corrected path. Along the feed nothing is changed.")
        _told(found.findings)
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
        limit = float(from_si(result.setup.tolerance, unit))
        pieces.figure(
            corrected_lines(station, before, after, limit, unit, dark=dark()),
            "improve-corrected",
            table=lambda: columns,
            alt=f"Deviation along the cut: at most {format_si(found.before.max, unit)} before, "
            f"{format_si(found.after.max, unit)} with the corrected program.",
            caption="Measured against the path that was meant; inside the model.",
        )


def _told(findings: Sequence[Finding]) -> None:
    """What a reader of a remedy must know, each as a sentence of its own."""
    for finding in findings:
        words = finding.sentence
        pieces.note(f"{words[:1].upper()}{words[1:]}")


def _shown(column: Any, unit: str) -> FloatArray:
    """A column in mm, in the unit of the screen."""
    return np.asarray(from_si(to_si(np.asarray(column, dtype=float), "mm"), unit))


def _stiffened(found: Stiffened, row: Shown, result: SimulationResult, unit: str) -> None:
    made, joints = found.design, result.setup.robot.joint_numbers
    here, beside = pieces.split(COLUMNS, "remedy")
    with here, st.container(border=True):
        pieces.strong(
            "The least stiffening that halves the error" if found.half else "The least stiffening that does it"
        )
        if not made.feasible:
            pieces.said("warning", made.sentence, "warning")
        rows = [
            (f"joint {number}", "as it is" if ratio < 1.001 else f"{format_short(ratio, '1', 3)} times as stiff")
            for number, ratio in zip(joints, made.stiffness_ratio, strict=True)
        ]
        pieces.table(rows, "qn")
        pieces.note(
            f"Cost {format_short(made.cost, '1', 3)}, where 1 is one joint made twice as stiff. Errors are linear in "
            "the compliance of each joint, so the least is found for certain, by a convex program."
        )
        use(row, "Use these joints")
    with beside, st.container(border=True):
        front = made.front()
        share = from_si(front.share * made.setup.tolerance / result.setup.tolerance, "%")
        pieces.strong("What each error costs")
        pieces.figure(
            cost_front(share, front.cost, (float(from_si(row.left.share, "%")), made.cost), dark=dark()),
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
    one, two = pieces.split(COLUMNS, "joints")
    with one, st.container(border=True):
        pieces.strong("Each joint alone twice as stiff")
        pieces.note(stiffen.sentence(ranked, joints, unit), stiffen.together(ranked, joints))
        stiffen.remedies(ranked, joints, unit)
    with two, st.container(border=True):
        stiffen.ranking(ranked, joints, unit, dark())


def _places(places: Mapping[str, Place], setup: SimulationSetup, unit: str) -> None:
    """What full simulations say of places of a set-up, by name."""
    rows = [
        (
            name,
            error_words(error_at(place, setup), unit),
            format_share(place.share),
            format_si(place.max_deviation, unit),
        )
        for name, place in places.items()
    ]
    pieces.table(rows, " nnn", ("Place" if "worst" in places else "Spin", "Error", "Of tolerance", "Tip"))


def _placed(found: Placement, row: Shown, result: SimulationResult, unit: str) -> None:
    here, beside = pieces.split(COLUMNS, "remedy")
    with here, st.container(border=True):
        pieces.strong("Where the part lies")
        places = {"now": found.now, "best": found.best, "median": found.median, "worst": found.worst}
        _places(places, result.setup, unit)
        pieces.note(
            f"Best at X, Y, Z {format_many(found.best.zero, unit, 1)}, turned by "
            f"{format_si(found.best.yaw, 'deg', 1)}. {format_count(found.tried, 'place')} looked at, "
            f"{format_count(found.reached)} within reach, {format_count(found.allowed)} with room to limits and away "
            "from singular configurations."
        )
        _told(found.findings)
        use(row, "Move the part there")
    with beside, st.container(border=True):
        x, y = (from_si(axis, unit) for axis in found.axes[:2])
        stays = bool(np.allclose(found.now.zero[:2], found.best.zero[:2], atol=1e-6))
        marks = [
            (name, float(from_si(each.zero[0], unit)), float(from_si(each.zero[1], unit)))
            for name, each in (("now and best" if stays else "now", found.now), ("best", found.best))
        ][: 1 if stays else 2]
        used = from_si(found.plane, "%")
        pieces.strong("Tolerance used, by where part zero lies")
        pieces.figure(
            places_map(x, y, used, marks, unit, dark=dark()),
            "improve-places",
            table=found.columns,
            alt=f"Map of the tolerance used over {format_count(found.tried, 'place')}: now "
            f"{format_share(found.now.share)}, at the best place {format_share(found.best.share)}.",
            caption="At the best height and turn of each point; blank where the arm does not get, or has no room. "
            + level_words(used),
        )


def _turned(found: Turning, row: Shown, result: SimulationResult, unit: str) -> None:
    here, beside = pieces.split(COLUMNS, "remedy")
    with here, st.container(border=True):
        pieces.strong("How the tool is turned about its axis")
        was = "" if result.ik.spin is None else f", {format_si(float(result.ik.spin[0]), 'deg', 0)}"
        best = format_si(found.spin, "deg", 0)
        places = {f"now{was}": found.now, f"best, {best} all the way": found.constant, "turning": found.course}
        _places(places, result.setup, unit)
        _told(found.findings)
        use(row, "Turn it so, all the way")
    with beside, st.container(border=True):
        pieces.strong("Tolerance used, by way and spin")
        drawn = over_spin(found, result, unit)
        pieces.figure(
            spins_map(*drawn, unit, dark=dark()),
            "improve-spins",
            table=found.columns,
            alt=f"Map of the tolerance used by way and spin: now {format_share(found.now.share)}, at the best spin "
            f"{format_share(found.constant.share)}, turning {format_share(found.course.share)}.",
            caption="Only where it cuts; blank beyond limits and near singular configurations. "
            + level_words(drawn[2]),
        )


def level_words(used: FloatArray) -> str:
    """What the line on a map of shares (a, b) of the tolerance, %, is; "" where none is drawn."""
    known = used[np.isfinite(used)]
    return LEVEL if known.size and known.min() < 100.0 < known.max() else ""


def over_spin(
    found: Turning, result: SimulationResult, unit: str
) -> tuple[FloatArray, FloatArray, FloatArray, dict[str, tuple[FloatArray, FloatArray]]]:
    """Way (s,) in ``unit``, spin (a,) deg and share of the tolerance (s, a), %, where something is judged, and the
    courses by name: as it is, where a run says it, and the best. The best one does not lie at the end of the angles."""
    low = -180.0 if np.cos(found.spin) > 0.0 else 0.0

    def shown(spin: FloatArray) -> FloatArray:
        return np.asarray(np.mod(from_si(spin, "deg") - low, 360.0) + low)

    cuts = (found.share > 0.0).any(axis=1)
    angle = shown(found.angle)
    order = np.argsort(angle)
    share = np.asarray(from_si(found.share, "%"))[np.ix_(cuts, order)]
    cutting = np.asarray(result.path.cutting, dtype=bool)
    way = np.asarray(from_si(found.way, unit))[cutting]
    turns = {"now": result.ik.spin, "best": found.turn}
    courses = {name: (way, shown(turn)[cutting]) for name, turn in turns.items() if turn is not None}
    return np.asarray(from_si(found.station, unit))[cuts], angle[order], share, courses


def _cut(found: Advice, row: Shown, result: SimulationResult, unit: str) -> None:
    with st.container(border=True):
        pieces.strong("The same part, cut in other ways")
        rows = []
        for way in found.ways:
            if way.run is None:
                rows.append([way.title, "–", "–", "–", "–", way.refused])
                continue
            verdict = way.run.verdict
            used = format_share(way.share) if np.isfinite(way.share) else "–"
            rate = format_si(way.removal_rate, in_lengths("cm3/min", unit), 1) if np.isfinite(way.removal_rate) else "–"
            error = error_words(decides(way.run), unit)
            rows.append([way.title, format_duration(way.seconds), rate, error, used, WORDS[verdict.level]])
        best = list(found.ways).index(found.best)
        head = ("Way", "Time at feed", "Removed", "Error", "Of tolerance", "Verdict")
        pieces.table(rows, "wnnnnv", head, strong=best)
        pieces.note("Bold: the quickest way within tolerance; the truest where none is. Each is a run of its own.")
        lab.multiples(found, unit)
        better = {way.name: way.title for way in found.ways[1:] if way.run is not None}
        truest = found.truest.name
        name = inputs.pick("Way", "improve.way", better, truest if truest in better else None, inputs.LISTED)
        way = next(each for each in found.ways if each.name == name)
        if way.run is not None:
            inputs.button(
                "Cut it this way", "improve.way.use", "check", take, way.run.setup, help="Undo takes it back."
            )


def _both(found: Both, row: Shown, result: SimulationResult, unit: str) -> None:
    _corrected(found.program, row, result, unit, "At the best place, as it is")
    pieces.note("First move the part there; this program is corrected for that place alone.")
    use(row, "Move the part there")


OPENED: dict[str, Callable[[Any, Shown, SimulationResult, str], None]] = {
    "program": _corrected,
    "stiffen": _stiffened,
    "place": _placed,
    "both": _both,
    "turn": _turned,
    "cut": _cut,
}
