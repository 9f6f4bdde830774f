"""A path as its solutions, as the kernel takes it that joins them."""

from __future__ import annotations

from typing import NamedTuple

from robomill.compiled import In1, In2, In3, InBool2

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
