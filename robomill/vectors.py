"""The angle between two directions."""

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray


def angle_between(a: ArrayLike, b: ArrayLike) -> FloatArray:
    """(...,) rad, 0 to pi, between directions a and b (..., 3) of any length; exact near 0, where cosines are not."""
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    return np.asarray(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(axis=-1)))
