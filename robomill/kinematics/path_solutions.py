"""A path as its solutions, and the ways through them, as the kernels take them that join."""

from typing import Annotated, NamedTuple

from robomill.arrays import IntArray
from robomill.compiled import Axes, In1, In2, In3, InBool2, Out1, Out2, Out3, OutInt1

FROM_HOME = 1e-3  # of the first configuration's squared distance from home, and of its posture's order


class PathSolutions(NamedTuple):
    """All that may be stood in along a path: solutions theta (m, 8, n) in (-pi, pi], whether they are possible (m, 8),
    the turn (m,) a joint may easily make in the step to each pose, limits (n, 2), and what the first pose is near to:
    start (n,), at the extra cost of its branch (8,)."""

    theta: In3
    possible: InBool2
    easy: In1
    limits: In2
    start: In1
    first: In1


class Way(NamedTuple):
    """The shortest ways to the nodes of the poses so far: nodes (2, most, n) of the last two poses that have any, the
    branches (most,) of the last, the costs (2, most) of the ways, which node each came from (m, most), where they
    stand (``BEFORE``, ``KNOWN``, ``NEW``), and the easy turn (1,) since."""

    node: Out3
    branch: OutInt1
    total: Out2
    came: Annotated[IntArray, Axes("int16", 2, written=True)]
    at: OutInt1
    easy: Out1


BEFORE, KNOWN, NEW = range(3)  # of a way: the last pose with nodes, how many it has, and which half the next ones take
