"""How far walls, floors and the tip may be off instead: over what is assumed or known to a band only."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache

import numpy as np

from robomill.arrays import FloatArray
from robomill.identification.fit.confidence import LEVEL
from robomill.identification.knowledge import Knowledge
from robomill.provenance import Kind
from robomill.report.paper_lengths import over_lengths
from robomill.simulation.band import deviation_band, size_band
from robomill.simulation.judging.verdict_words import Reading, Verdict
from robomill.simulation.origin.spread import alloy_spread
from robomill.simulation.result import SimulationResult
from robomill.simulation.tooth import tooth
from robomill.units import format_percent

Ends = tuple[float, float]
NONE: Ends = (float("nan"), float("nan"))


@dataclass(frozen=True)
class Range:
    """Ends (low, high) of what the verdict says, with the sample where each is worst: ``wall``, ``floor`` (signed, m),
    ``tip`` (m) and ``share`` of the tolerance; NaN where the cut leaves none. ``over`` is what varies, in words, and
    ``kind`` the provenance of that."""

    over: str
    kind: Kind
    wall: Ends
    floor: Ends
    tip: Ends
    share: Ends


def ranges(result: SimulationResult, known: Knowledge | None) -> tuple[Range, ...]:
    """Over the assumed lengths, the alloy's rows, a turn of the cutter and the band of identified compliances."""
    if result.worst < 0:
        return ()
    spread = alloy_spread(result)
    found = []
    lengths = cache(lambda i: over_lengths(result, i))  # wall, floor and tip are often worst at one place
    if lengths(result.worst) is not None:
        found.append(_range(result, "assumed lengths", "assumed", lengths))
    if spread is not None and len(spread.titles) > 1:
        found.append(_range(result, "published coefficients", "assumed", lambda i: spread.delta[:, i] @ result.R_MF[i]))
    if (turn := tooth(result)) is not None:
        at = np.stack([turn.mean, turn.low, turn.high])
        found.append(_range(result, "as teeth come by", "computed", lambda i: at[:, i]))
    if known is not None:
        found.append(_range(result, f"{format_percent(LEVEL)} band, {known.source}", "measured", *_band(result, known)))
    return tuple(found)


def out_over(verdict: Verdict, found: Iterable[Range]) -> tuple[Range, ...]:
    """Of a cut within tolerance those ranges at whose end it would be out of it."""
    return tuple(each for each in found if verdict.level in ("ok", "tight") and each.share[1] > 1.0)


def _band(result: SimulationResult, known: Knowledge) -> tuple[Callable[[int], FloatArray], Ends]:
    """Deviations at the ends of the band of each axis of the cut, and the ends of the largest one's size."""

    def ends(i: int) -> FloatArray:
        band = deviation_band(result, known, i)
        half = np.array([float(band.half_along(axis, LEVEL)) for axis in result.R_MF[i].T])
        return np.asarray(result.delta_in_cut[i] + half * [[-1.0], [1.0]])

    half = float(size_band(result, deviation_band(result, known, result.worst), result.worst))
    return ends, (max(result.max_deviation - half, 0.0), result.max_deviation + half)


def _range(
    result: SimulationResult, over: str, kind: Kind, at: Callable[[int], FloatArray | None], tip: Ends | None = None
) -> Range:
    """``at(i)``: deviations (g, 3) m at sample i along feed, feed-normal and axial, one a case."""
    verdict = result.verdict
    wall, floor = _ends(result, verdict.wall, 1, at), _ends(result, verdict.floor, 2, at)
    if tip is None:
        cases = at(result.worst)
        size = np.linalg.norm(result.delta_in_cut[result.worst] if cases is None else cases, axis=-1)
        tip = float(np.min(size)), float(np.max(size))
    shares = [
        _share(ends, reading) for ends, reading in ((wall, verdict.wall), (floor, verdict.floor)) if reading.worst >= 0
    ]
    share = (max(low for low, _ in shares), max(high for _, high in shares)) if shares else NONE
    return Range(over, kind, wall, floor, tip, share)


def _ends(result: SimulationResult, reading: Reading, axis: int, at: Callable[[int], FloatArray | None]) -> Ends:
    """The reading moved as the tip moves along ``axis`` of the cut."""
    i = reading.worst
    cases = at(i) if i >= 0 else None
    if cases is None:
        return NONE
    every = reading.value + cases[:, axis] - result.delta_in_cut[i, axis]
    return float(np.min(every)), float(np.max(every))


def _share(ends: Ends, reading: Reading) -> Ends:
    """Least and largest share of its tolerance between signed ends."""
    low, high = ends
    least = 0.0 if low < 0.0 < high else min(abs(low), abs(high))
    return least / reading.tolerance, max(abs(low), abs(high)) / reading.tolerance
