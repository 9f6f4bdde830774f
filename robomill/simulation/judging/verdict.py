"""The verdict of a milled part: its walls and floors against their tolerances, as a gauge would read them."""

from dataclasses import replace

import numpy as np

from robomill.arrays import IntArray
from robomill.provenance import Finding, named
from robomill.simulation.judging.gauge import Gauge, Readings
from robomill.simulation.judging.premise import Premise, premise
from robomill.simulation.judging.seen import Run, share_out
from robomill.simulation.judging.verdict_words import KINDS, TIP, Deciding, Level, Reading, Verdict, said
from robomill.simulation.origin.assumed import far_share


def judge(result: Run, gauge: Gauge) -> Verdict:
    """The verdict of a run. What has no model or no answer is counted and never green."""
    readings = _readings(result, gauge)
    wall, floor, feed, _ = readings
    deciding = [reading.share for reading in readings if reading.decides]
    share = max(deciding, default=float("nan"))
    if not deciding and result.worst >= 0:  # nothing is left that could be measured: the tip's own deviation decides
        share = result.max_deviation / wall.tolerance
    far = far_share(result, gauge, (wall.tolerance, floor.tolerance, feed.tolerance if feed.stated else float("inf")))
    gone = tuple(result.path.block[gauge.gone].tolist())
    return _spoken(result, Verdict("ok", share, "", *readings, far, gone, *premise(result, bool(deciding))))


def resting_on(result: Run, verdict: Verdict, premise: Premise) -> Verdict:
    """The ``verdict`` of a run that rests on the ``premise``, too, where it rests on none."""
    if verdict.premise or not premise.words:
        return verdict
    return _spoken(result, replace(verdict, premise=premise.words, asked=premise.asked))


def _spoken(result: Run, found: Verdict) -> Verdict:
    """What was found, with its level and its sentence."""
    found = replace(found, level=_level(result, found))
    return replace(found, sentence=" ".join(words for words in said(result, found) if words))


def decided(result: Run, verdict: Verdict) -> Deciding:
    """What decides, of which size, and where."""
    rests = verdict.deciding
    if rests is None:
        return Deciding(TIP, result.max_deviation, result.worst)
    name, reading = rests
    return Deciding(KINDS[name], abs(reading.value), reading.worst)


def _level(result: Run, verdict: Verdict) -> Level:
    """What the judgement is: what was measured counts where all of the cut has a number."""
    unknown = bool(result.not_judged.any())
    if result.worst < 0:
        if unknown or result.rapids:
            return "unjudged"
        return "missed" if result.answered[result.path.cutting].any() else "unreached"
    if result.missed.any():
        return "unreached"
    if verdict.premise or (unknown and not verdict.decides):
        return "unjudged"
    if (unknown or result.rapids) and verdict.grade != "out":
        return "unjudged"
    return verdict.grade


def _readings(result: Run, gauge: Gauge) -> tuple[Reading, Reading, Reading, Reading]:
    setup, i = result.setup, result.judged_along
    limits, stated = setup.limits, setup.feed_tolerance is not None
    along = np.where(i, np.abs(result.delta_in_cut[:, 0]), -np.inf)
    feed = int(np.argmax(along)) if i.any() else -1
    value = float(result.delta_in_cut[feed, 0]) if feed >= 0 else float("nan")
    out = share_out(result.delta_in_cut[i, 0], result.path.step_length[i], limits["feed"])
    return (
        _reading(gauge.walls, limits["wall"]),
        _reading(gauge.floors, limits["floor"]),
        Reading(feed, value, limits["feed"], out, stated),
        _reading(gauge.ends, limits["end"], stated),
    )


def _reading(found: Readings, tolerance: float, stated: bool = True) -> Reading:
    q = found.worst
    if q < 0:
        return Reading(-1, float("nan"), tolerance, 0.0, stated)
    return Reading(int(found.sample[q]), float(found.error[q]), tolerance, found.share_out(tolerance), stated)


def thin_wall_notes(block: IntArray) -> tuple[Finding, ...]:
    """Walls that bend under the cut, by the source lines (t,) that leave them."""
    if not len(block):
        return ()
    text = (
        f"a wall is left that is thinner than an eighth of its height (line {named(block.tolist())}); that it gives "
        "way to the cutter is not in the numbers."
    )
    return (Finding("warning", text, int(block.min()), code="thin-wall"),)
