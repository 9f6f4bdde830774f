"""The angle between directions, what of one lies across another, and the place on a straight way that is nearest."""

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray


def angle_between(a: ArrayLike, b: ArrayLike) -> FloatArray:
    """(...,) rad, 0 to pi, between directions a and b (..., 3) of any length; exact near 0, where cosines are not."""
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    return np.asarray(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(axis=-1)))


def across(d: FloatArray, k: FloatArray) -> FloatArray:
    """(n, 3): what of vectors d (n, 3) lies across unit vectors k (n, 3)."""
    return np.asarray(d - np.sum(d * k, axis=1, keepdims=True) * k)


def nearest_on(q: FloatArray, a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(n,) share of the way from a to b at which it is nearest to q, all (n, k), 0 of a way of no length; and how far
    that is, (n,)."""
    way = b - a
    square = np.einsum("ni,ni->n", way, way)
    along = np.einsum("ni,ni->n", q - a, way)
    share = np.clip(np.divide(along, square, out=np.zeros(len(way)), where=square > 0.0), 0.0, 1.0)
    return share, np.asarray(np.linalg.norm(q - a - share[:, None] * way, axis=1))
