"""A run as a JSON-ready record in display units: what the command line prints and files carry."""

from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.force import COMPONENTS
from robomill.identification.knowledge import Knowledge
from robomill.report.lines_record import lines_record
from robomill.report.paper_lengths import TRIED, over_lengths
from robomill.report.ranges import Range, out_over, ranges
from robomill.report.records import shown
from robomill.simulation.judging.verdict_words import FLOOR, KINDS, WALL
from robomill.simulation.origin.assumptions import assumed_of_setup
from robomill.simulation.origin.origins import sources
from robomill.simulation.origin.spread import alloy_spread, peak_force
from robomill.simulation.result import SimulationResult
from robomill.simulation.stations import largest_deviations, nearest_feed, section_at
from robomill.simulation.tooth import LEFT_OUT, tooth
from robomill.surface.sections.groove import GrooveSection
from robomill.surface.sections.measures import MEASURED
from robomill.toolpath.source import wanted_of
from robomill.version import __version__


def simulation_record(result: SimulationResult, known: Knowledge | None = None) -> dict[str, Any]:
    """One run. ``deviation_mm``, ``joint_share_mm`` and ``force_N`` are those of the worst point, in {M}; ``known`` is
    how sure the compliances are, for the ``ranges``: left out, what the set-up knows."""
    i, wanted = result.worst, wanted_of(result.setup.source)
    section = section_at(result, result.decided.sample)

    def there(values: FloatArray, unit: str) -> Any:
        return shown(values[i] if i >= 0 else np.full(values.shape[1:], np.nan), unit)

    verdict, noticed = result.verdict, (*result.notes, *result.surface_notes)
    missed = sorted(set(result.path.block[~result.reached].tolist()))
    return {
        "robomill": __version__,
        "name": result.setup.name,
        "program": getattr(result.setup.source, "name", None),
        "robot": result.setup.robot.name,
        "compliance_set": result.setup.robot.compliance_set,
        "max_deviation_mm": shown(result.max_deviation, "mm"),
        "rms_deviation_mm": shown(result.rms_deviation, "mm"),
        "deviation_mm": there(result.delta, "mm"),
        "joints": list(result.setup.robot.joint_numbers),
        "joint_share_mm": there(result.delta_joint, "mm"),
        "spring_share_mm": {
            spring.name: there(result.delta_spring[:, k], "mm") for k, spring in enumerate(result.setup.springs)
        },
        "sag_mm": None if result.sag is None else there(result.sag.sum(axis=-2), "mm"),
        "sag_added": result.setup.add_sag,
        "wanted": None if wanted is None else wanted.name,
        "ahead_mm": None if result.ahead is None else there(result.ahead, "mm"),
        "force_N": there(result.F, "N"),
        "force_size_N": there(result.force_size, "N"),
        "force_component_N": dict(zip(COMPONENTS, there(result.force_components, "N"))),
        "force_share_mm": {name: there(result.delta_component[:, c], "mm") for c, name in enumerate(COMPONENTS)},
        "joint_shares_add_up": result.setup.measured_map is None,
        **_uncertain(result, i),
        "over_lengths": lengths_record(result, i),
        **_between(result, known or result.setup.known),
        "station_mm": shown(result.path.s[i], "mm") if i >= 0 else None,
        "worst_block": result.worst_block,
        "reached": {
            "count": int(result.reached.sum()),
            "of": len(result.reached),
            "unreached_blocks": missed,
            "reason": _first_reason(result),
        },
        "groove": [groove_record(result, section) for section in result.sections],
        "worst_section": None if section is None else groove_record(result, section),
        "lines": lines_record(result),
        "surface": surface_record(result),
        "verdict": verdict.level,
        "verdict_sentence": verdict.sentence,
        **judged_record(result),
        "tolerance_mm": shown(result.setup.tolerance, "mm"),
        "notes": [note.sentence for note in noticed],
        "findings": [finding.record() for finding in (*result.setup.toolpath.findings, *noticed)],
        "rests_on": [
            {"what": each.what, "value": each.value, "kind": each.provenance.kind, "source": each.provenance.source}
            for each in sources(result.setup)
        ],
        "assumed": [each.record() for each in assumed_of_setup(result.setup)],
        "digest": result.setup.digest(),
    }


def groove_record(result: SimulationResult, section: GrooveSection) -> dict[str, Any]:
    """What a section is and what is measured there (null where its kind has no such measure, with a reason under
    ``not_measured`` where it has one), and the deviation and force at the path's sample nearest to it."""
    i = nearest_feed(result, section.station)
    return {
        "kind": section.kind,
        **{f"{name}_{of.unit}": shown(getattr(section, name), of.unit) for name, of in MEASURED.items()},
        "near_wall": section.near or None,
        "not_measured": dict(section.why),
        "block": section.block,
        "deviation_mm": shown(result.delta[i], "mm"),
        "force_N": shown(result.F[i], "N"),
        "force_share_mm": {name: shown(result.delta_component[i, c], "mm") for c, name in enumerate(COMPONENTS)},
        "note": section.note,
    }


def _between(result: SimulationResult, known: Knowledge | None) -> dict[str, Any]:
    """Between which ends the numbers lie, and over which of these ranges the part could be out of tolerance."""
    found = ranges(result, known)
    return {
        "ranges": [range_record(each) for each in found],
        "could_be_out_over": [each.over for each in out_over(result.verdict, found)],
    }


def range_record(found: Range) -> dict[str, Any]:
    """Between which ends walls, floors, the tip and the share of the tolerance lie, over what."""
    ends = {f"{name}_mm": shown(getattr(found, name), "mm") for name in ("wall", "floor", "tip")}
    return {"over": found.over, "kind": found.kind, **ends, "share": list(found.share)}


def lengths_record(result: SimulationResult, i: int) -> dict[str, Any] | None:
    """Least and largest deflection at the worst point with all lengths that the paper allows; None for other arms."""
    found = over_lengths(result, i) if i >= 0 else None
    if found is None:
        return None
    ends = [shown(found.min(axis=0), "mm"), shown(found.max(axis=0), "mm")]
    named = {f"{name}_mm": [low, high] for name, low, high in zip(COMPONENTS, *ends, strict=True)}
    return {"geometries": len(found), "tried": TRIED, **named}


def judged_record(result: SimulationResult) -> dict[str, Any]:
    """What a gauge would read, each quantity against its tolerance, and what is not judged and why."""
    verdict, path = result.verdict, result.path
    readings = {name: getattr(verdict, name) for name in KINDS}
    lost = result.not_judged
    return {
        **{
            name: {
                "value_mm": shown(reading.value, "mm"),
                "tolerance_mm": shown(reading.tolerance, "mm"),
                "share": reading.share,
                "length_out_of_tolerance_share": reading.share_out,
                "judged": reading.stated,
                "line": int(path.block[reading.worst]) if reading.worst >= 0 else None,
                "station_mm": shown(path.s[reading.worst], "mm") if reading.worst >= 0 else None,
            }
            for name, reading in readings.items()
        },
        "share": verdict.share,
        "decided_by": result.decided.kind.code,
        "share_at_assumed_ends": verdict.far,
        "tip": _tip(result),
        "gone": sorted(set(path.block[result.gauge.gone].tolist())),
        "thin_wall": sorted(set(path.block[result.gauge.thin].tolist())),
        "tooth": _tooth(result),
        "left_out": list(LEFT_OUT),
        "not_judged": {
            "count": int(lost.sum()),
            "of": int(path.cutting.sum()),
            "blocks": sorted(set(path.block[lost].tolist())),
            "rapids": list(result.rapids),
            "reasons": [
                {
                    "code": each.code,
                    "why": each.why,
                    "names": list(each.names),
                    "count": int((each.where & lost).sum()),
                }
                for each in result.unjudged
            ],
        },
    }


def _tip(result: SimulationResult) -> dict[str, Any] | None:
    """Where the tip is off its path most, and what becomes of it on the part."""
    found = result.stray
    if found is None:
        return None
    return {
        "value_mm": shown(found.size, "mm"),
        "line": int(result.path.block[found.sample]),
        "station_mm": shown(result.path.s[found.sample], "mm"),
        "mark": found.mark,
        "fate": found.fate,
        "left_on_part_mm": shown(found.left, "mm"),
    }


def _tooth(result: SimulationResult) -> dict[str, Any] | None:
    """At the worst wall and floor: the deviation by the mean force, and its extremes as teeth come by."""
    turn, places = tooth(result), {WALL: result.verdict.wall.worst, FLOOR: result.verdict.floor.worst}
    if turn is None:
        return None
    return {
        kind.code: {end: shown(getattr(turn, end)[i, kind.axis], "mm") for end in ("mean", "low", "high")}
        | {"unit": "mm"}
        for kind, i in places.items()
        if i >= 0
    }


def _uncertain(result: SimulationResult, i: int) -> dict[str, Any]:
    """Peak of a revolution and the range of the alloy's coefficient sets, where the force comes from a material."""
    peak, spread = peak_force(result), alloy_spread(result)
    if peak is None or spread is None or i < 0:
        return {}
    largest = largest_deviations(result, spread)
    return {
        "force_peak_N": {"low": shown(peak.low[i], "N"), "high": shown(peak.high[i], "N"), "frame": list(COMPONENTS)},
        "alloy_spread": [
            {
                "material": title,
                "max_deviation_mm": shown(value, "mm"),
                "force_N": shown(F[i], "N"),
                "deviation_mm": shown(delta[i], "mm"),
                "axial_known": known,
            }
            for title, known, value, F, delta in zip(spread.titles, spread.axial, largest, spread.F, spread.delta)
        ],
    }


def surface_record(result: SimulationResult) -> dict[str, Any]:
    """Both surfaces in numbers: volumes, and the share of them that is out of tolerance."""
    error, (out, all_of_it) = result.error, result.area_out
    return {
        "removed_volume_mm3": shown(result.machined.removed_volume, "mm3"),
        "ideal_volume_mm3": shown(result.ideal.removed_volume, "mm3"),
        "excess_volume_mm3": shown(error.excess_volume, "mm3"),
        "gouge_volume_mm3": shown(error.gouge_volume, "mm3"),
        "area_out_of_tolerance_share": out / all_of_it if all_of_it else 0.0,
        "cells": int(result.machined.z.size),
    }


def _first_reason(result: SimulationResult) -> str:
    missed = np.flatnonzero(~result.reached)
    return result.ik.reason(int(missed[0])) if len(missed) else ""
