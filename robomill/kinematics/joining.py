"""Which solutions join along a path: the shortest way through all branches and all whole turns within the limits.

A way is smooth where no joint turns faster than the tool's own motion asks for (``easy_turn``). What is turned beyond
that is least first, all motion second: the branch is left where, as at a singular wrist, going on in another one turns
the joints less.
"""

from typing import NamedTuple

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray, frozen
from robomill.kinematics.path_solutions import FROM_HOME, PathSolutions, Way
from robomill.kinematics.transforms import turn_between
from robomill.progress import checkpoint, slices
from robomill.robot.model import Robot
from robomill.units import to_si

# A joint turns easily by so much for a length of path and for a turn of the tool. Away from singular configurations
# a millimetre takes some tenths of a degree: 1 mm at the end of 0.3 m is 0.2 degrees.
EASY_PER_LENGTH = to_si(2.0, "deg/mm")
EASY_PER_TURN = 2.0
# Order in which shoulder and elbow are tried: as at home, other elbow, other shoulder, both.
ARM_ORDER = np.array([0, 0, 1, 1, 2, 2, 3, 3])


class Joined(NamedTuple):
    """theta (m, n) and the branch index (m,), -1 where none is within limits; poses missed; the way's cost."""

    theta: FloatArray
    branch: IntArray
    missed: int
    cost: float


def easy_turn(T_MT: FloatArray, whole: bool) -> FloatArray:
    """(m,) rad: how far a joint may turn in the step to each pose (m, 4, 4) without standing out; 0 for the first.

    By the tip's way and the turn of the tool axis, or of the ``whole`` tool where its spin is commanded, too.
    """
    way = np.linalg.norm(np.diff(T_MT[:, :3, 3], axis=0), axis=1)
    checkpoint()
    turn = turn_between(T_MT[:-1, :3, :3], T_MT[1:, :3, :3], whole)
    return np.append(0.0, EASY_PER_LENGTH * way + EASY_PER_TURN * turn)[: len(T_MT)]


def join(robot: Robot, theta: FloatArray, possible: BoolArray, T_MT: FloatArray, whole: bool) -> Joined:
    """One solution a pose of those theta (m, 8, n) that are possible (m, 8), by the shortest way from near home."""
    from robomill.kinematics import joining_kernels

    m, _, n = theta.shape
    for array in (theta, possible):
        array.setflags(write=False)
    course = PathSolutions(
        theta,
        possible,
        frozen(easy_turn(T_MT, whole)),
        robot.limits,
        robot.home,
        frozen(FROM_HOME * ARM_ORDER),
    )
    joined, index = theta[:, 0].copy(), np.empty(m, dtype=np.int64)  # where nothing is possible: an attempt
    most = joining_kernels.most_nodes(course)
    way = Way(
        np.empty((2, most, n)),
        np.empty(most, dtype=np.int64),
        np.zeros((2, most)),
        np.zeros((m, most), dtype=np.int16),
        np.array([-1, 0, 0]),
        np.zeros(1),
    )
    for some in slices(m, "Trying arm positions"):
        joining_kernels.go_on(course, some.start, some.stop, way, index)
    cost = joining_kernels.come_back(course, way, joined, index)
    return Joined(joined, index, int((index < 0).sum()), cost)
