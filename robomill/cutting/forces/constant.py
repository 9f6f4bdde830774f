"""A force that stays as it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.cutting.conditions import CutConditions
from robomill.cutting.force import ForceModel, Frame, MeanForce
from robomill.errors import CuttingError
from robomill.provenance import BY_HAND, Provenance
from robomill.quantities import quantity
from robomill.spelled import in_units


@in_units(CuttingError, "Constant force")
@dataclass(frozen=True, eq=False, repr=False)
class ConstantForce(ForceModel):
    """The paper's static force: one vector (3,) N in {M} wherever the tool cuts.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.ConstantForce((0.0, 100.0, 0.0)).vector_M.tolist()
    [0.0, 100.0, 0.0]
    """

    kind: ClassVar[str] = "constant"
    title: ClassVar[str] = "Fixed in {M} (the paper's)"
    rank: ClassVar[int] = 2

    vector_M: FloatArray = quantity("F", "N", shape=(3,), axes="XYZ", digits=1, key="vector_N")
    provenance: Provenance = BY_HAND
    notes: tuple[str, ...] = ()

    if TYPE_CHECKING:

        def __init__(
            self,
            vector_M: ArrayLike = ...,
            provenance: Provenance = ...,
            notes: tuple[str, ...] = ...,
            *,
            vector_N: ArrayLike = ...,
        ) -> None: ...

    @classmethod
    def first(cls, mean: MeanForce) -> dict[str, Any]:
        """The vector that pushed so far."""
        return {"vector_M": mean.in_M}

    @property
    def frame(self) -> Frame:
        """The robot's."""
        return "M"

    def components(self, conditions: CutConditions) -> FloatArray:
        """The vector at every step, (m, 3) N in {M}."""
        return np.tile(self.vector_M, (len(conditions), 1))
