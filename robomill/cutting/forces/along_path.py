"""A force that turns with the path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.conditions import STRAIGHT, CutConditions
from robomill.cutting.force import COMPONENTS, ForceModel, MeanForce
from robomill.cutting.unjudged import Unjudged
from robomill.errors import CuttingError
from robomill.provenance import BY_HAND, Provenance
from robomill.quantities import quantity
from robomill.spelled import in_units
from robomill.units import format_short


@in_units(CuttingError, "Path force")
@dataclass(frozen=True, repr=False)
class PathForce(ForceModel):
    """Constant components that follow the path: feed, feed_normal (left of the feed), axial (+ out of the part), N.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.PathForce(feed=-40.0, feed_normal=90.0, axial=-20.0).feed_normal
    90.0
    """

    kind: ClassVar[str] = "path"
    title: ClassVar[str] = "Follows the path"
    hint: ClassVar[str | None] = "Feed-normal is to the left of the feed; axial is positive out of the part."
    rank: ClassVar[int] = 1

    feed: float = quantity("Feed", "N", default=0.0, digits=1)
    feed_normal: float = quantity("Feed-normal", "N", default=0.0, digits=1)
    axial: float = quantity("Axial", "N", default=0.0, digits=1)
    provenance: Provenance = BY_HAND
    notes: tuple[str, ...] = ()

    if TYPE_CHECKING:

        def __init__(
            self,
            feed: float = ...,
            feed_normal: float = ...,
            axial: float = ...,
            provenance: Provenance = ...,
            notes: tuple[str, ...] = ...,
            *,
            feed_N: float = ...,
            feed_normal_N: float = ...,
            axial_N: float = ...,
        ) -> None: ...

    @classmethod
    def first(cls, mean: MeanForce) -> dict[str, Any]:
        """The components that pushed so far."""
        return dict(zip(COMPONENTS, map(float, mean.along_path), strict=True))

    @property
    def numbers(self) -> str:
        """The components that push, each with its direction, e.g. ``"100 N left of the feed"``."""
        ways = ("along the feed", "left of the feed", "axial")
        said = [f"{format_short(v, 'N')} {way}" for v, way in zip(self._vector, ways, strict=True) if v]
        return ", ".join(said) or format_short(0.0, "N")

    @property
    def _vector(self) -> tuple[float, float, float]:
        return (self.feed, self.feed_normal, self.axial)

    def unjudged(self, conditions: CutConditions) -> tuple[Unjudged, ...]:
        """Plunges beside what holds for every force: stated along a path, it says nothing of a way straight down."""
        where = conditions.engaged & (conditions.across <= STRAIGHT)
        why = "a force stated along the path says nothing of a plunge"
        return super().unjudged(conditions) + Unjudged.at("plunge_stated", where, why)

    def components(self, conditions: CutConditions) -> FloatArray:
        """(m, 3) N, the same at every step; a plunge has no feed across the tool, so only the axial part there."""
        force = np.tile(self._vector, (len(conditions), 1))
        force[conditions.across <= STRAIGHT, :2] = 0.0
        return force
