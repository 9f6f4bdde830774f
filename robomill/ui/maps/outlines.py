"""What the project cuts, as it is seen on a map: the outline of its part and the path of its cut in {M}."""

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from robomill.arrays import FloatArray
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.ui.posed.cut import path_there
from robomill.units import from_si

DRAWN = 300  # points of a path


def seen_along(setup: SimulationSetup, normal: str, unit: str) -> list[tuple[str, FloatArray]]:
    """("part" or "cut", points (k, 2) in ``unit``) on the planes normal to an axis of {M}; none while there is no
    path."""
    keep = ["xyz".index(axis) for axis in "xyz" if axis != normal]
    path = path_there(setup)
    if path is None:
        return []
    low, high = setup.stock_block.lower, setup.stock_block.upper
    corners = np.stack(np.meshgrid(*zip(low, high, strict=True), indexing="ij"), axis=-1).reshape(-1, 3)
    lines = [("part", _rim(setup.in_base(corners)[:, keep]))]
    lines += [("cut", setup.in_base(each)[:, keep]) for each in _cuts(path)]
    return [(kind, from_si(points, unit)) for kind, points in lines if len(points) > 1]


def _cuts(path: Toolpath) -> list[FloatArray]:
    """What is cut without a rapid between, points (k, 3) m; of a long program some of it."""
    ends = np.flatnonzero(path.cutting)
    runs = np.split(ends, np.flatnonzero(np.diff(ends) > 1) + 1) if len(ends) else []
    runs = runs[:: len(runs) // DRAWN + 1]
    every = sum(map(len, runs)) // DRAWN + 1
    return [path.p[np.unique([run[0] - 1, *run[::every], run[-1]])] for run in runs]


def _rim(points: FloatArray) -> FloatArray:
    """The closed outline around points (k, 2)."""
    try:
        hull = points[ConvexHull(points).vertices]
    except QhullError:
        return points[:0]
    return np.concatenate([hull, hull[:1]])
