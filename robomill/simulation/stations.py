"""What holds at a station of a run (m of length cut) and of the whole cut: samples, places, straightness."""

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, IntArray
from robomill.compliance.deflection import shares_along
from robomill.simulation.origin.spread import AlloySpread, alloy_spread
from robomill.simulation.result import SimulationResult
from robomill.surface.sections.groove import GrooveSection
from robomill.surface.sections.metrology import GrooveProfile
from robomill.surface.swept import station_at
from robomill.toolpath.path import Toolpath

MET = 1e-9  # m: a sample that a station comes so close to is reached


def nearest_feed(result: SimulationResult, station: float) -> int:
    """Index of the sample at feed nearest to ``station``."""
    return _nearest(result, np.flatnonzero(result.path.cutting), station)


def nearest_judged(result: SimulationResult, station: float) -> int:
    """Index of the sample nearest to ``station`` among those that count for the verdict; -1 where none does."""
    judged = np.flatnonzero(result.judged)
    return _nearest(result, judged, station) if len(judged) else -1


def move_at(result: SimulationResult, station: float) -> int:
    """Index of the sample whose move is being made at ``station``, whether it counts for the verdict or not."""
    path = result.path
    shown = np.flatnonzero(path.cutting | np.append(path.cutting[1:], False))
    passed = max(int(np.searchsorted(path.s[shown], station + MET, side="right")) - 1, 0)
    here, after = int(shown[passed]), int(shown[min(passed + 1, len(shown) - 1)])
    on_its_way = path.cutting[after] and path.s[here] + MET < station
    return after if on_its_way else here


def section_at(result: SimulationResult, i: int) -> GrooveSection | None:
    """The section at sample i, or the first of ``result.sections`` that shows anything; None where none does."""
    here = [result.groove(float(result.path.s[i]))] if i >= 0 else []
    return next((each for each in (*here, *result.sections) if len(each.w) and each.kind != "unknown"), None)


def _nearest(result: SimulationResult, among: IntArray, station: float) -> int:
    return int(among[np.argmin(np.abs(result.path.s[among] - station))])


def place_at(path: Toolpath, station: float) -> tuple[FloatArray, FloatArray]:
    """Point (3,) m and unit direction (3,) in {W} of the commanded path at ``station``, held within the cut."""
    found = station_at(path.p, path.cutting, min(max(station, 0.0), float(path.s[-1])))
    step = path.p[found.entry] - path.p[found.entry - 1]
    return found.centre, step / np.linalg.norm(step)


def joint_shares(result: SimulationResult, i: int, axis: int | None = None) -> FloatArray:
    """(n,) share of each joint in the deviation at sample i, or in what of it lies along an axis of the cut (0 feed, 1
    feed-normal, 2 axial); they sum to 1 where nothing beside the joints gives."""
    off = result.delta[i]
    if axis is not None:
        along = result.R_MF[i, :, axis]
        off = (off @ along) * along
    return shares_along(result.delta_joint[i], off)


def force_components(result: SimulationResult, spread: AlloySpread) -> FloatArray:
    """(r, m, 3) N: the force of each row of the alloy along feed, feed-normal and axial."""
    return np.asarray(np.einsum("mij,rmi->rmj", result.R_MF, spread.F))


def largest_deviations(result: SimulationResult, spread: AlloySpread) -> FloatArray:
    """(r,) m: the largest judged deviation of each row of the alloy; -inf where no sample is judged."""
    return np.asarray(np.where(result.judged, spread.deviation, -np.inf).max(axis=1))


def offset_by_row(result: SimulationResult, spread: AlloySpread, station: ArrayLike, offset: ArrayLike) -> FloatArray:
    """(r, q) m: the groove's centre offset (q,) at stations (q,) m for each row of the alloy.

    The tip moves aside as far as the row's deflection differs from that of the row in force.
    """
    i = np.array([nearest_feed(result, float(s)) for s in np.atleast_1d(station)])
    moved = spread.delta[:, i] - result.delta[i]
    return np.asarray(offset) + np.einsum("rqc,qc->rq", moved, result.R_MF[i, :, 1])


def offset_band(result: SimulationResult, spread: AlloySpread, profile: GrooveProfile) -> FloatArray:
    """(2, q) m: lowest and highest centre offset over the alloy's rows at the profile's stations."""
    every = offset_by_row(result, spread, profile.station, profile.centre_offset)
    return np.stack([every.min(axis=0), every.max(axis=0)])


def sideways(result: SimulationResult) -> tuple[float, float, float]:
    """The groove's centre offset (m, left of the feed +) at mid-cut; its range over the alloy's rows (NaN without)."""
    middle = 0.5 * float(result.path.s[-1])
    offset = result.groove(middle).centre_offset
    spread = alloy_spread(result)
    if spread is None or len(spread.titles) < 2:
        return offset, float("nan"), float("nan")
    every = offset_by_row(result, spread, middle, offset)
    return offset, float(np.min(every)), float(np.max(every))
