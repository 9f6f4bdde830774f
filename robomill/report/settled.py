"""Numbers as files show them: without what double precision leaves of a difference."""

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray

RESIDUE = 1.1e-16  # of the largest number beside it: so much double precision rounds that one


def settled(values: ArrayLike) -> FloatArray:
    """``values`` (any shape); one below ``RESIDUE`` of the largest is the rounding of a difference, and 0."""
    array = np.array(values, dtype=np.float64)
    size = np.abs(array)
    largest = float(size[np.isfinite(size)].max(initial=0.0))
    array[size < RESIDUE * largest] = 0.0
    return array
