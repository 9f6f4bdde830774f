"""A run: what is computed along a path, and which of its samples count. Gauge and verdict know this of it.

Readings come from samples that cut. Where part of a cut has no number, a tool that goes once more along what that part
should have left meets nothing, is not pushed and reads 0.00: that is no reading, since what is left there is not known.
What few samples say is a place and not the cut, so below ``FEW`` nothing is read at all. That a cut keeps its tolerance
is said of all of it: with a part unknown it may be said of the rest ("where it is judged") only where that is ``MOST``
of it. That it does not keep its tolerance is said wherever there is a number: one place is enough.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.cutting.conditions import CutConditions
from robomill.cutting.tooling import Tooling
from robomill.cutting.unjudged import Unjudged
from robomill.kinematics.inverse import IKResult
from robomill.lazy import cached_property
from robomill.provenance import Finding
from robomill.simulation.coupling import Coupling
from robomill.simulation.cut import moved_points, over_stock
from robomill.simulation.posture import unreached_notes
from robomill.simulation.rapids import Crashes, crashes
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.tools import tooling
from robomill.toolpath.path import Toolpath
from robomill.toolpath.sampling import drawn_back
from robomill.values import Tabled

WHOLE = 1.0 + 1e-9  # of a tolerance: what is out by less is on the limit, and rounding
LEAST = 1e-4  # share of the length that a single place stands for
FEW = 0.1
"""Of the length that cuts: where less is judged, no number stands for the cut (stated, not derived)."""
MOST = 0.5
"""Of the length that cuts: where less is judged, nobody says that the cut is within its tolerance."""


@dataclass(frozen=True, eq=False, repr=False)
class Run(Tabled):
    """Arrays over the m samples of ``path``, as ``SimulationResult`` explains them."""

    setup: SimulationSetup
    path: Toolpath
    ik: IKResult
    C_joint: FloatArray
    C_spring: FloatArray
    C: FloatArray
    conditions: CutConditions
    R_MF: FloatArray
    F: FloatArray
    delta_joint: FloatArray
    delta_spring: FloatArray
    delta: FloatArray
    sag: FloatArray | None = None
    coupling: Coupling | None = None
    unjudged: tuple[Unjudged, ...] = ()
    ahead: FloatArray | None = None
    untold: BoolArray | None = None

    @cached_property
    def force_components(self) -> FloatArray:
        """(m, 3) N: feed, feed-normal, axial components of the force on the tool."""
        return np.einsum("mij,mi->mj", self.R_MF, self.F)

    @cached_property
    def force_size(self) -> FloatArray:
        """(m,) N: size of the force on the tool; NaN where it is not known."""
        return np.asarray(np.linalg.norm(self.F, axis=1))

    @cached_property
    def delta_in_cut(self) -> FloatArray:
        """(m, 3) m: the deviation along the feed, to its left and along the tool axis."""
        return np.einsum("mij,mi->mj", self.R_MF, self.delta)

    @cached_property
    def tooling(self) -> Tooling:
        """Which cutter makes which step."""
        return tooling(self.setup, self.path)

    @cached_property
    def answered(self) -> BoolArray:
        """(m,) points with an answer: reached and, where a measured map is used, inside it."""
        return np.asarray(self.reached & np.isfinite(self.delta).all(axis=1))

    @cached_property
    def not_judged(self) -> BoolArray:
        """(m,) points of the cut that are reached and have no number: no model holds there."""
        lost = np.zeros(len(self.path), dtype=bool)
        for each in self.unjudged:
            lost |= each.where
        lost |= ~np.isfinite(self.F).all(axis=1)
        return np.asarray(lost & self.path.cutting & self.reached)

    @cached_property
    def missed(self) -> BoolArray:
        """(m,) points that are not reached, or at feed outside the measured map."""
        return np.asarray((self.path.cutting & ~self.answered & ~self.not_judged) | ~self.reached)

    @property
    def theta(self) -> FloatArray:
        """(m, n) rad (m where a joint slides): the configurations, NaN where the pose is not reached."""
        return self.ik.theta

    @property
    def reached(self) -> BoolArray:
        """(m,) points that the arm reaches."""
        return self.ik.reached

    @cached_property
    def judged(self) -> BoolArray:
        """(m,) samples that count for the verdict: at feed, with an answer, the cutter within the stock's block; of a
        corrected program, which goes beside its path in the air, too, those that cut. Where some of the cut has no
        number, those of the rest that cut, and none where they are less than ``FEW`` of it."""
        cuts = self.path.cutting & self.answered & self.over_stock
        if self.ahead is None and not self.not_judged.any():
            return np.asarray(cuts)
        cuts &= self.conditions.engaged
        few = self.not_judged.any() and self._of_the_cut(cuts) < FEW
        return np.zeros_like(cuts) if few else np.asarray(cuts)

    @cached_property
    def judged_along(self) -> BoolArray:
        """(m,) samples that count along the feed, too: where it is known how far along the path they were meant to
        be."""
        return self.judged if self.untold is None else np.asarray(self.judged & ~self.untold)

    @property
    def mostly_judged(self) -> bool:
        """Whether what is judged is ``MOST`` of what cuts."""
        return not self.not_judged.any() or self._of_the_cut(self.judged & self.conditions.engaged) >= MOST

    def _of_the_cut(self, cuts: BoolArray) -> float:
        """``cuts`` (m,) of the length that cuts, or would: by samples where none has a length, as when a cut is one
        plunge."""
        every = cuts | (self.not_judged & self.conditions.engaged & self.over_stock)
        length = np.where(every, self.path.step_length, 0.0)
        weight = length if length.sum() > 0.0 else every.astype(float)
        return float(weight[cuts].sum() / weight.sum()) if every.any() else 0.0

    @cached_property
    def over_stock(self) -> BoolArray:
        """(m,) samples where the cutter reaches into the block of the stock: what is further off cuts air."""
        return over_stock(self.setup, self.path)

    @cached_property
    def deviation(self) -> FloatArray:
        """(m,) m: size of the path deviation, deflected minus commanded; NaN where not reached."""
        return np.asarray(np.linalg.norm(self.delta, axis=1))

    @cached_property
    def worst(self) -> int:
        """Index of the largest deviation at feed; -1 where nothing was reached."""
        if not self.judged.any():
            return -1
        return int(np.argmax(np.where(self.judged, self.deviation, -np.inf)))

    @property
    def max_deviation(self) -> float:
        """m: the largest deviation at feed, NaN where nothing was reached."""
        return float(self.deviation[self.worst]) if self.worst >= 0 else float("nan")

    @property
    def worst_block(self) -> int:
        """Line (or what ``path.block_name`` says) of the largest deviation, 0 where nothing was reached."""
        return int(self.path.block[self.worst]) if self.worst >= 0 else 0

    @cached_property
    def p_machined(self) -> FloatArray:
        """(m, 3) m in {W}: where the tip really goes. A rapid arrives where the cut that follows it begins."""
        return moved_points(self.setup.T_MW, self.path, self.answered, self.delta)

    @cached_property
    def why_unreached(self) -> tuple[Finding, ...]:
        """Why the cut, of which nothing is reached, is not: its spin, or a tool frame that is turned round."""
        at_feed = np.flatnonzero(self.path.cutting)
        if self.reached[at_feed].any():
            return ()
        return unreached_notes(self.setup.robot, self.ik.T_MT[at_feed[len(at_feed) // 2]])

    @cached_property
    def removes(self) -> BoolArray:
        """(m,) steps that cut: at feed, with an answer at both ends, but not on a way straight back out of a plunge: as
        a tool is drawn out the push lets go of it, and until then its tip stays at the bottom."""
        at_feed = self.path.cutting & self.answered & np.append(False, self.answered[:-1])
        return np.asarray(at_feed & ~drawn_back(self.path))

    def _placed(self, findings: Iterable[Finding]) -> tuple[Finding, ...]:
        """With what their lines count on this path."""
        return tuple(replace(each, place=self.path.block_name) for each in findings)

    @cached_property
    def _crashes(self) -> Crashes:
        return crashes(self.setup, self.setup.toolpath)

    @property
    def rapids(self) -> tuple[int, ...]:
        """Source lines of rapids through material that no cut removes: what they leave is not judged."""
        return self._crashes.never

    @property
    def early_rapids(self) -> tuple[int, ...]:
        """Source lines of rapids through material that is cut only later."""
        return self._crashes.early


def share_out(error: FloatArray, length: FloatArray, tolerance: float) -> float:
    """Share of the ``length`` (q,) m at whose places the ``error`` (q,) m is out of ``tolerance`` (m): 0 where nothing
    is, and never 0 where something is, however short."""
    out, total = np.abs(error) > WHOLE * tolerance, float(length.sum())
    if not out.any():
        return 0.0
    return max(float(length[out].sum()) / total if total > 0.0 else 1.0, LEAST)
