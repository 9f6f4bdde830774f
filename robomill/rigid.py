"""Poses: a rotation and a place as one (4, 4), and the axis of a tool that tilts. Nothing is checked here."""

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray


def transform(R: ArrayLike, p: ArrayLike) -> FloatArray:
    """(..., 4, 4) from rotations R (..., 3, 3) and places p (..., 3); leading axes broadcast."""
    R, p = np.asarray(R, dtype=np.float64), np.asarray(p, dtype=np.float64)
    T = np.zeros((*np.broadcast_shapes(R.shape[:-2], p.shape[:-1]), 4, 4))
    T[..., :3, :3] = R
    T[..., :3, 3] = p
    T[..., 3, 3] = 1.0
    return T


def axis_from_tilt(A: ArrayLike, B: ArrayLike) -> FloatArray:
    """Unit tool axes k_T (..., 3) = (sin B, -sin A cos B, cos A cos B) of the tilts A, B (rad)."""
    A, B = np.broadcast_arrays(np.asarray(A, dtype=np.float64), np.asarray(B, dtype=np.float64))
    return np.stack([np.sin(B), -np.sin(A) * np.cos(B), np.cos(A) * np.cos(B)], axis=-1)
