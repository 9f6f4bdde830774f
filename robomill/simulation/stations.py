"""What holds at a station of the cut (m, length travelled at feed), and what the alloy's other rows make of it."""

from __future__ import annotations

import numpy as np

from robomill.arrays import FloatArray
from robomill.simulation.result import SimulationResult
from robomill.simulation.spread import AlloySpread
from robomill.surface.metrology import GrooveProfile
from robomill.toolpath.path import Toolpath


def place_at(path: Toolpath, station: float) -> tuple[FloatArray, FloatArray]:
    """Point and unit direction (3,), (3,) in {W} of the commanded path at ``station``."""
    i = int(np.clip(np.searchsorted(path.s, station - 1e-12), 1, len(path) - 1))
    while i < len(path) - 1 and not path.cutting[i]:
        i += 1
    step = path.p[i] - path.p[i - 1]
    length = float(np.linalg.norm(step))
    share = 1.0 - (float(path.s[i]) - station) / length if length > 0 else 1.0
    return path.p[i - 1] + np.clip(share, 0.0, 1.0) * step, step / length if length > 0 else np.array([1.0, 0.0, 0.0])


def nearest_judged(result: SimulationResult, station: float) -> int:
    """Index of the sample nearest to ``station`` among those judged; the worst one, -1, where none is."""
    judged = np.flatnonzero(result.judged)
    if len(judged) == 0:
        return result.worst
    return int(judged[np.argmin(np.abs(result.path.s[judged] - station))])


def is_straight(path: Toolpath) -> bool:
    """Whether every cut goes the same way, so that the groove is one straight line."""
    step = np.diff(path.p, axis=0)[path.cutting[1:]]
    length = np.linalg.norm(step, axis=1)
    along = step[length > 0] / length[length > 0, None]
    return bool(len(along) and np.abs(np.cross(along, along[0])).max() < 1e-6)


def force_components(result: SimulationResult, spread: AlloySpread) -> FloatArray:
    """(r, m, 3) N: the force of each row of the alloy along feed, feed-normal and axial."""
    return np.einsum("mij,rmi->rmj", result.R_MF, spread.F)


def largest_deviations(result: SimulationResult, spread: AlloySpread) -> FloatArray:
    """(r,) m: the largest judged deviation of each row of the alloy."""
    return np.asarray(np.where(result.judged, spread.deviation, -np.inf).max(axis=1))


def offset_band(result: SimulationResult, spread: AlloySpread, profile: GrooveProfile) -> FloatArray:
    """(2, q) m: lowest and highest centre offset over the alloy's rows at the profile's stations."""
    i = np.array([result.sample_at(float(s)) for s in profile.station])
    normal = result.R_MF[i][:, :, 1]
    every = profile.centre_offset + np.einsum("rqc,qc->rq", spread.delta[:, i] - result.delta[i], normal)
    return np.stack([every.min(axis=0), every.max(axis=0)])
