"""Where the project cuts, as the maps see it: its middle in {M}, and whether the arm brings its tool there."""

import numpy as np

from robomill.errors import RobomillError
from robomill.paper import Point
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.ui.work import running
from robomill.ui.work.job import Underway


def path_there(setup: SimulationSetup) -> Toolpath | None:
    """The path, where it is read and not refused: a map neither waits for it nor says again why it is not there."""
    try:
        return running.path_of(setup)
    except (RobomillError, Underway):
        return None


def middle_of_cut(setup: SimulationSetup) -> Point | None:
    """The mean over the length that is cut, m in {M}, to a millimetre; None where nothing is."""
    path = path_there(setup)
    if path is None:
        return None
    ends = setup.in_base(path.p)
    length = np.linalg.norm(np.diff(ends, axis=0), axis=1) * path.cutting[1:]
    if not length.sum() > 0:
        return None
    mean = (0.5 * (ends[1:] + ends[:-1]) * length[:, None]).sum(axis=0) / length.sum()
    x, y, z = np.round(mean, 3) + 0.0
    return float(x), float(y), float(z)
