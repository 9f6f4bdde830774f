"""The distribution of a cut's deviation as a value: draws, the probability of keeping the tolerance, the tornado."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import betaincinv

from robomill.arguments import made_by
from robomill.arrays import BoolArray, FloatArray, digest
from robomill.errors import SetupError
from robomill.frames import Columns
from robomill.identification.fit.confidence import LEVEL
from robomill.improve.judged import Measure
from robomill.improve.unsure import Input
from robomill.lazy import cached_property
from robomill.provenance import Finding
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.units import format_beside, format_count, format_percent, format_si, from_si
from robomill.values import Tabled


@made_by("rm.uncertainty(setup)")
@dataclass(frozen=True, eq=False, repr=False)
class Tornado(Tabled):
    """What each input alone does to the share of the tolerance that is used, the largest part of the variance first.

    inputs      as in ``Uncertainty``, in this order
    low, high   (p,) the share with the input at the ends of its own 95 % interval
    part        (p,) its part of the variance, 1 is all of it: what would be gone if it were known. Inputs that are
                correlated move along, so that their parts may be more than 1 together

    Examples
    --------
    >>> import robomill as rm
    >>> found = rm.uncertainty(rm.load_setup("paper_flute"), samples=2000)
    >>> found.tornado
    <Tornado Force, feed-normal 0.64, Compliance of joint 3 0.26, ...>
    """

    inputs: tuple[Input, ...]
    low: FloatArray
    high: FloatArray
    part: FloatArray

    def columns(self) -> Columns:
        """One row an input."""
        return {
            "input": np.array([each.key for each in self.inputs]),
            "label": np.array([each.label for each in self.inputs]),
            "unit": np.array([each.unit for each in self.inputs]),
            "value": np.array([float(from_si(each.value, each.unit)) for each in self.inputs]),
            "std": np.array([float(from_si(each.std, each.unit)) for each in self.inputs]),
            "kind": np.array([each.provenance.kind for each in self.inputs]),
            "share_low": self.low,
            "share_high": self.high,
            "variance_part": self.part,
        }

    def _said(self) -> str:
        some = [f"{each.label} {part:.2f}" for each, part in zip(self.inputs[:2], self.part, strict=False)]
        return ", ".join([*some, "..."] if len(self.inputs) > 2 else some)


@made_by("rm.uncertainty(setup)")
@dataclass(frozen=True, eq=False, repr=False)
class Uncertainty(Tabled):
    """The distribution of a cut's deviation over what is not known exactly.

    run        the cut as it is
    measure    what is judged: "verdict", "wall", "floor" or "tip"
    inputs     (p,) the numbers that are not known exactly, each with its standard deviation and who says so
    change     (N, p) SI: the draws, as changes of the inputs
    share      (N,) of the tolerance that is used; NaN where the path is not reached
    wall, floor, tip   (N,) m: the largest error of walls and of floors, NaN where there are none, and of the tip
    tornado    what each input does alone
    checked    how many draws were run in full, too, and by how much of its tolerance an error of wall, floor or tip
               differed at most; 0 and 0 where every draw is such a run
    findings   what a reader of the numbers must know

    Examples
    --------
    >>> import robomill as rm
    >>> found = rm.uncertainty(rm.load_setup("paper_flute"), samples=2000)
    >>> round(found.probability, 2)
    0.99
    >>> found.to_dataframe().columns[:3].tolist()
    ['C_theta_1', 'C_theta_2', 'C_theta_3']
    """

    run: SimulationResult
    measure: Measure
    inputs: tuple[Input, ...]
    change: FloatArray
    share: FloatArray
    wall: FloatArray
    floor: FloatArray
    tip: FloatArray
    tornado: Tornado
    checked: tuple[int, float]
    seed: int
    findings: tuple[Finding, ...] = ()

    @property
    def setup(self) -> SimulationSetup:
        """The cut."""
        return self.run.setup

    @property
    def samples(self) -> int:
        """How many draws."""
        return len(self.share)

    @cached_property
    def meets(self) -> BoolArray:
        """(N,) whether the tolerance is kept; a draw that is not reached does not keep it."""
        return np.asarray(np.nan_to_num(self.share, nan=np.inf) <= 1.0)

    @property
    def probability(self) -> float:
        """That the tolerance is kept."""
        return float(self.meets.mean())

    @cached_property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval of ``probability`` (Clopper and Pearson): what so many draws can tell, no more."""
        kept, n, out = int(self.meets.sum()), self.samples, 0.5 * (1.0 - LEVEL)
        low = float(betaincinv(kept, n - kept + 1, out)) if kept else 0.0
        return low, float(betaincinv(kept + 1, n - kept, 1.0 - out)) if kept < n else 1.0

    @cached_property
    def error(self) -> FloatArray:
        """(N,) m: the larger of wall and floor, or what ``measure`` names; the tip's where no surface is left."""
        if self.measure != "verdict":
            return np.asarray(getattr(self, self.measure))
        larger = np.fmax(self.wall, self.floor)
        return np.where(np.isnan(larger), self.tip, larger)

    def quantile(self, level: float, of: str = "error") -> float:
        """What is exceeded by a share 1 - ``level`` of the draws: of "error" (m), "wall", "floor", "tip" or "share".

        Raises SetupError for another name or level. Infinite where draws beyond it are not reached.
        """
        if of not in ("error", "wall", "floor", "tip", "share"):
            raise SetupError(f"Quantile: found {of!r:.40}, expected error, wall, floor, tip or share.", where="of")
        if not 0.0 <= level <= 1.0:
            raise SetupError(f"Quantile: found {level!r:.40}, expected a number from 0 to 1.", where="level")
        values = np.asarray(getattr(self, of))
        if np.isnan(values).all():
            return float("nan")
        return float(np.quantile(np.nan_to_num(values, nan=np.inf), level, method="higher"))

    @property
    def mean(self) -> float:
        """m, of ``error`` over the draws that are reached."""
        return float(np.nanmean(self.error))

    @property
    def std(self) -> float:
        """m, of ``error`` over the draws that are reached."""
        return float(np.nanstd(self.error, ddof=1))

    def columns(self) -> Columns:
        """One row a draw: the inputs in their units, the errors, the share of the tolerance, whether it is kept."""
        found: Columns = {
            each.key: from_si(each.value + self.change[:, i], each.unit) for i, each in enumerate(self.inputs)
        }
        found |= {f"{name}_mm": from_si(getattr(self, name), "mm") for name in ("wall", "floor", "tip")}
        return found | {"share": self.share, "meets": self.meets}

    @cached_property
    def _digest(self) -> str:
        return digest((self.setup.digest(), self.measure, self.seed, self.change, self.share))

    def _said(self) -> str:
        words = f"{format_si(self.quantile(LEVEL), 'mm', 3, missing='not reached')} in 95 % of the draws"
        return f"{self.setup.name}: {words}, tolerance kept in {format_beside(self.probability, 1.0, '%', 1)}"

    def _facts(self) -> list[tuple[str, str]]:
        low, kept, high = (format_beside(each, 1.0, "%", 1) for each in np.insert(self.interval, 1, self.probability))
        first, part = self.tornado.inputs[0], float(self.tornado.part[0])
        return [
            ("As it is", format_si(self.run.max_deviation, "mm", 3)),
            ("Mean and standard deviation", f"{format_si(self.mean, 'mm', 3)}, {format_si(self.std, 'mm', 3)}"),
            ("95 % of the draws keep", format_si(self.quantile(LEVEL), "mm", 3, missing="not reached")),
            ("Tolerance kept", f"{kept} ({low} to {high})"),
            ("Most of it", f"{first.label}, {format_percent(part)} of the variance"),
            ("Draws", format_count(self.samples)),
        ]
