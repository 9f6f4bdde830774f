"""What a picture of a toolpath needs, and how much of a long path is drawn: thinned by shape, and said in words."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.lazy import cached_property
from robomill.units import format_short_count

BUDGET = 20_000


@dataclass(frozen=True, eq=False)
class PathPicture:
    """A path in {W} and display units: points (m, 3), move i ends at point i; cutting, reached (m,) bool; block (m,).

    value (m,) colours the cuts (None: reached or not), on 0 to ``limit`` where one is given; above it is marked.
    ``tools`` (m,) colours them by their tool instead, whose words are in ``tool_names``.
    ``selected`` is the source line (``noun``) that is pointed at (0: none), ``worst`` the index of the largest value
    (-1: none).
    """

    points: FloatArray
    cutting: BoolArray
    reached: BoolArray
    block: IntArray
    value: FloatArray | None = None
    title: str = ""
    unit: str = ""
    digits: int = 3
    limit: float | None = None
    length_unit: str = "mm"
    stock: tuple[FloatArray, FloatArray] | None = None
    selected: int = 0
    noun: str = "line"
    worst: int = -1
    total: int = 0
    indices: IntArray | None = None
    tools: IntArray | None = None
    tool_names: Mapping[int, str] = field(default_factory=dict)

    @cached_property
    def kept(self) -> IntArray:
        """Indices of the points that are drawn: those given, or as many as the budget allows."""
        if self.indices is not None:
            return self.indices
        must = [self.worst] if self.worst >= 0 else []
        return decimate(self.points, self.cutting, self.reached, BUDGET, must)

    @property
    def unknown(self) -> BoolArray:
        """(m,) points of the cuts that are reached and have no value, where the cuts are coloured by one."""
        lost = np.zeros(len(self.points), dtype=bool) if self.value is None else ~np.isfinite(self.value)
        return np.asarray(lost & self.cutting & self.reached)

    @property
    def caption(self) -> str:
        """How much of the path is drawn, in words; "" where it is all of it."""
        segments = max(self.total, len(self.points) - 1)
        drawn = len(self.kept) - 1
        if drawn >= len(self.points) - 1:
            return ""
        return (
            f"Showing {format_short_count(drawn)} of {format_short_count(segments)} segments; results use all of them."
        )


def decimate(
    points: FloatArray, cutting: BoolArray, reached: BoolArray, budget: int, must: Sequence[int] = ()
) -> IntArray:
    """Indices of at most about ``budget`` points (m, 3) that look like all of them.

    A point is left out only while the path stays inside one cell of a grid that is as fine as the budget allows;
    where cutting or reach changes both ends are kept, and so are the indices in ``must``.
    """
    m = len(points)
    if m <= budget:
        return np.arange(m)
    corner = np.zeros(m, dtype=bool)
    corner[[0, m - 1, *must]] = True
    for flag in (cutting, reached):
        change = np.flatnonzero(flag[1:] != flag[:-1])
        # A path that changes all the time has no ends worth keeping before its shape.
        if len(change) < budget // 4:
            corner[change] = corner[change + 1] = True
    low, high = points.min(axis=0), points.max(axis=0)
    cell = max(float((high - low).max()), 1e-12) / 4000.0
    while True:
        where = np.floor((points - low) / cell).astype(np.int64)
        moved = np.ones(m, dtype=bool)
        moved[1:] = (where[1:] != where[:-1]).any(axis=1)
        kept = moved | corner
        if int(kept.sum()) <= budget:
            return np.flatnonzero(kept)
        cell *= 1.5
