"""What the measuring room would say: section, profile along the groove, best fit, areas, a measured profile beside."""

from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import IntArray
from robomill.errors import RobomillError
from robomill.io.measured.profiles import MeasuredProfile, read_profile
from robomill.simulation.judging.finished import Finished
from robomill.simulation.judging.verdict_words import way
from robomill.simulation.origin.spread import AlloySpread
from robomill.simulation.result import SimulationResult
from robomill.simulation.stations import offset_band
from robomill.surface.deviation import Deviation
from robomill.surface.sections.groove import GrooveSection
from robomill.surface.sections.measures import MEASURED
from robomill.surface.sections.metrology import GrooveProfile, compare_profile, fit_groove, groove_profile
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.milling.scrubber import station_m
from robomill.ui.work.cached import by_result, shared
from robomill.units import format_beside, format_limit, format_many, format_percent, format_si, from_si
from robomill.viz.metrology import ProfileCurves, histogram_figure, profile_figure

STATIONS, FEW_STATIONS = 21, 13
MANY_SAMPLES = 20_000  # a section takes every move into account, so long programs are measured at fewer places
PROFILE = "milling.profile"
MAX_PROFILE_MB = 10
BINS = 48  # of the histogram of errors
WHAT = {
    "groove": "Groove: two walls that one pass leaves.",
    "step": "Step: one wall; on the other side the cut is open.",
    "pocket": "Pocket: several passes made the floor; measured are the floor and the nearer wall.",
    "free": "Free surface: no wall here; measured is its error along the normal.",
    "nothing": "",
}


@shared(by_result, "Error of the surface")
def error_of(result: SimulationResult) -> Deviation:
    """The machined surface against the ideal one."""
    return result.error


@shared(by_result, "Walls and floors that are left")
def finished_of(result: SimulationResult) -> Finished:
    """Errors of walls and floors by the area that is left of them."""
    return result.finished


@shared(by_result, "Measuring the groove along its length")
def profile(result: SimulationResult) -> tuple[GrooveProfile, IntArray]:
    """The groove at its stations (fewer on a very long program) and the line of each, from the cache."""
    count = STATIONS if len(result.path) <= MANY_SAMPLES else FEW_STATIONS
    sections = result.grooves(np.linspace(0.02, 0.98, count) * float(result.path.s[-1]))
    return groove_profile(sections), np.array([s.block for s in sections])


def section_facts(section: GrooveSection | None) -> None:
    """What is cut at the station and its dimensions, as a measuring report lists them; a reason for what has none."""
    if section is None or not len(section.w):
        return
    if section.kind in WHAT:
        pieces.note(WHAT[section.kind] + (f" {section.note[0].upper()}{section.note[1:]}." if section.note else ""))
    rows = [(MEASURED[name].label, *_measured(section, name)) for name in _listed(section)]
    if rows:
        pieces.facts(rows)


def _listed(section: GrooveSection) -> list[str]:
    """Its measures in the order of a report: both walls' lean in one table with their form beside it."""
    beside = [MEASURED[name].form for name in section.measures]
    return [name for name in section.measures if name not in beside]


def _measured(section: GrooveSection, name: str) -> tuple[str, str]:
    """A measure and what one must know of it."""
    value, unit, of = float(getattr(section, name)), session.project().view.length, MEASURED[name]
    if not np.isfinite(value):
        return "not measured", section.why.get(name, "")
    form = f"straight within {format_si(getattr(section, of.form), unit)}" if of.form else ""
    return of.shown(value, unit), form or of.hint


def profile_panel(result: SimulationResult, spread: AlloySpread | None, dark: bool) -> None:
    """Centre offset and floor along the groove, best fit, and a measured profile over it."""
    unit = session.project().view.length
    along = pieces.attempt(profile, result)
    if along is None:
        return
    found, block = along
    if not np.isfinite([found.centre_offset, found.floor_error]).any():
        pieces.note("No chart along this cut: at none of its stations a groove or a floor can be measured.")
        return
    measured = session.kept(PROFILE)
    fit = None
    both = np.isfinite(found.centre_offset) & np.isfinite(found.floor_error)
    if result.path.goes_one_way and both.sum() >= 3:
        fit = fit_groove(found)
    limits = [float(from_si(each.tolerance, unit)) for each in (result.verdict.wall, result.verdict.floor)]
    curves = ProfileCurves(
        from_si(found.station, unit),
        from_si(found.centre_offset, unit),
        from_si(found.floor_error, unit),
        unit,
        limits[0],
        limits[1],
        band=None if spread is None or len(spread.titles) < 2 else from_si(offset_band(result, spread, found), unit),
        fit=None if fit is None else from_si(found.centre_offset - fit.side.residual, unit),
        measured=None if measured is None else (from_si(measured.station, unit), from_si(measured.offset, unit)),
        joined=result.path.goes_one_way,
    )
    pieces.figure(
        profile_figure(curves, block, float(from_si(station_m(result), unit)), dark=dark),
        "profile",
        name="groove-profile",
        table=lambda: profile_columns(found, block),
        caption=_of_the_chart(found),
        alt=_along_in_words(found, unit),
    )
    if fit is not None:
        side, floor = fit.side, fit.floor
        pieces.facts(
            [
                (
                    "Shift",
                    f"{format_si(side.offset, unit, sign=True)}",
                    "on average: zeroing the part again would take it out",
                ),
                ("Turn", f"{format_si(side.rotation, 'urad', sign=True)}", "of the middle line"),
                (
                    "Form error",
                    format_si(side.form_error, unit),
                    f"left after both; the floor keeps {format_si(floor.form_error, unit)}",
                ),
            ]
        )
    else:
        pieces.note(
            "Best fit (shift and turn against form) needs one straight groove with a floor; here there is none."
        )
    _overlay(found, measured, unit)


def _of_the_chart(found: GrooveProfile) -> str:
    """What the chart shows, and where it has no middle line."""
    if found.missing == len(found.station):
        return (
            "Floor of the cut against the ideal one; grey: the tolerance. No groove with two walls lies along the cut, "
            "so there is no middle line."
        )
    told = "Middle line of the groove and floor of the cut against the ideal ones; grey: the tolerance."
    if found.missing:
        told += f" At {found.missing} of {len(found.station)} places no groove has two walls: no middle there."
    return told


def _along_in_words(found: GrooveProfile, unit: str) -> str:
    """The chart in words, with the ends of its curves."""
    told = []
    for name, values in (("centre offset", found.centre_offset), ("floor error", found.floor_error)):
        known = values[np.isfinite(values)]
        if len(known):
            ends = format_many((float(known.min()), float(known.max())), unit, between=" to ", sign=True)
            told.append(f"{name} {ends}")
    return f"Along the cut: {', '.join(told)}."


def profile_columns(found: GrooveProfile, block: IntArray) -> dict[str, Any]:
    """The profile as a table; its first two columns are what a measured profile looks like, too."""
    names = {
        "station_mm": found.station,
        "offset_mm": found.centre_offset,
        "floor_mm": found.floor_error,
        "width_mm": found.width,
        "depth_mm": found.depth,
    }
    return {**{k: from_si(v, "mm") for k, v in names.items()}, "line": block}


def _overlay(found: GrooveProfile, measured: MeasuredProfile | None, unit: str) -> None:
    with st.popover("Lay a measured profile over it", icon=":material/straighten:", type="secondary"):
        inputs.upload(
            "Measured profile (.csv): station_mm, offset_mm", "milling.profile.file", _take, most_MB=MAX_PROFILE_MB
        )
        pieces.note(
            "Station along the groove, offset of its middle, left of the feed positive; their heads name the unit."
        )
        if measured is not None:
            inputs.button("Remove the profile", "milling.profile.clear", "close", session.drop, PROFILE)
    if measured is None:
        return
    for words in measured.findings:
        pieces.said("warning", words, "straighten")
    try:
        against = compare_profile(found, measured.station, measured.offset)
    except RobomillError as exc:
        pieces.error(exc)
        return
    outside = f"; {against.outside} measured stations lie outside" if against.outside else ""
    pieces.facts(
        [
            (
                measured.name,
                f"{format_si(against.mean, unit, sign=True)}",
                "mean of prediction minus measurement; it gives "
                f"{format_percent(against.explained)} of what was measured",
            ),
            (
                "Largest miss",
                format_si(against.largest, unit, sign=True),
                f"RMS {format_si(against.rms, unit)} over {len(against.station)} stations{outside}",
            ),
        ]
    )


def _take(data: bytes, name: str) -> None:
    session.keep(PROFILE, read_profile(data, name=name))


def spread_panel(result: SimulationResult, dark: bool) -> None:
    """How the error is spread over walls and floors: the verdict's own readings, volumes, share out of tolerance."""
    walls, floors = (each.tolerance for each in (result.verdict.wall, result.verdict.floor))
    try:
        error = pieces.underway(error_of, result)
    except RobomillError:
        pieces.note("There is no surface to measure: the reason stands beside the picture.")
        return
    if error is None:
        return
    unit = session.project().view.length
    if not len(result.gauge.walls.error) + len(result.gauge.floors.error):
        pieces.note("No wall and no floor of this cut is judged, so there is no error to spread.")
        return
    left = pieces.underway(finished_of, result)
    if left is None:
        return
    edges = left.edges(max(walls, floors), BINS)
    area = {"walls": left.walls.histogram(edges), "floors": left.floors.histogram(edges)}
    total = max(float(sum(each.sum() for each in area.values())), 1e-300)
    share = {name: 100.0 * each / total for name, each in area.items()}
    drawn, told = pieces.split([1.4, 1], "surface")
    with drawn:
        pieces.figure(
            histogram_figure(from_si(edges, unit), share, from_si(np.array([walls, floors]), unit), unit, dark=dark),
            "histogram",
            name="error-histogram",
            table=lambda: {
                "from_mm": from_si(edges[:-1], "mm"),
                "to_mm": from_si(edges[1:], "mm"),
                **{f"{name}_mm2": from_si(each, "mm2") for name, each in area.items()},
            },
            caption="Walls and floors as a gauge reads them, by the area that is left in the end: what the verdict "
            "rests on. Walls: + to the left of the feed. Floors: + material left.",
            alt="Histogram of the errors of walls and floors by their area; "
            + "; ".join(remark for _, _, remark in _out_of_tolerance(result))
            + ".",
        )
    with told:
        pieces.facts([*_out_of_tolerance(result), *_volumes(error), _rms(left)])
    for finding in result.surface_notes:
        pieces.said("warning", finding.sentence, "layers")


def _out_of_tolerance(result: SimulationResult) -> list[tuple[str, str, str]]:
    """How much of the walls and of the floors the verdict finds out of tolerance: its own readings, each apart."""
    verdict, unit, rows = result.verdict, session.project().view.length, []
    for name, reading in (("wall", verdict.wall), ("floor", verdict.floor)):
        if reading.worst < 0:
            unknown = verdict.level == "unjudged"
            rows.append((f"{name.capitalize()}s", "–", "not judged" if unknown else f"the cut leaves no {name}"))
            continue
        size = format_beside(abs(reading.value), reading.tolerance, unit)
        remark = f"at most {size} {way(name, reading)}, {format_limit(reading.tolerance, unit)} allowed"
        rows.append((f"{name.capitalize()}s out of tolerance", share_out_words(reading.share_out), remark))
    return rows


def share_out_words(share: float) -> str:
    """A share of what is out of tolerance; never "0" where something is."""
    return "none" if share == 0.0 else "under 0.1 %" if share < 1e-3 else format_percent(share, 1)


def _volumes(error: Deviation) -> list[tuple[str, str, str]]:
    view = session.project().view
    return [
        ("Material left", format_si(error.excess_volume, view.of("mm3")), "on walls and floors together"),
        ("Cut too deep", format_si(error.gouge_volume, view.of("mm3")), "into walls and floors together"),
    ]


def _rms(left: Finished) -> tuple[str, str, str]:
    """Of the walls and floors drawn above."""
    told = format_si(left.rms, session.project().view.length, missing="–")
    return "RMS error", told, "of walls and floors, each by the area that is left of it"
