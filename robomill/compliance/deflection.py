"""Tip displacement under a force on the tool, joint by joint, eqs. (15), (16)."""

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, as_floats
from robomill.errors import KinematicsError


def deflection(C_joint: ArrayLike, F: ArrayLike) -> FloatArray:
    """delta_joint (..., n, 3) m in {M}: each joint's share of the tip displacement; their sum is delta = C F.

    C_joint (..., n, 3, 3) m/N, F (..., 3) N the force ON the tool in {M}; leading axes broadcast.
    """
    C_joint = as_floats(C_joint, "C_joint", (None, 3, 3), error=KinematicsError, finite=False)
    F = as_floats(F, "F", (3,), error=KinematicsError, finite=False)
    return displacement(C_joint, F[..., None, :])


def displacement(C: FloatArray, F: ArrayLike) -> FloatArray:
    """delta (..., 3) m = C F: how far a force F (..., 3) N moves a tip of compliance C (..., 3, 3) m/N. Eq. (16)."""
    return np.einsum("...ij,...j->...i", C, np.asarray(F, dtype=np.float64))


def soft_direction(C: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """(values (..., 3) m/N ascending, axes (..., 3, 3) as columns): the principal compliances of C (..., 3, 3).

    The last column is the direction in which a force moves the tip most.
    """
    C = as_floats(C, "C", (3, 3), error=KinematicsError)
    values, axes = np.linalg.eigh(0.5 * (C + np.swapaxes(C, -1, -2)))
    return values, axes
