"""Where the project cuts, as the maps see it: its middle in {M}, and whether the arm brings its tool there."""

import numpy as np

from robomill.errors import RobomillError
from robomill.paper import Point
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.toolpath.summary import middle_of_cut as mean_of_cut
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
    middle = mean_of_cut(path)
    if middle is None:
        return None
    x, y, z = np.round(setup.in_base(middle), 3) + 0.0
    return float(x), float(y), float(z)
