"""Tip displacement under a force on the tool, joint by joint, eqs. (15), (16)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked
from robomill.arrays import FloatArray, as_floats
from robomill.errors import KinematicsError


@asked
def deflection(C_joint: ArrayLike, F: ArrayLike) -> FloatArray:
    """How far each joint lets the tip move under a force, eq. (16).

    Parameters
    ----------
    C_joint : array_like, (..., n, 3, 3)
        Joint contributions to the compliance, m/N, in {M}.
    F : array_like, (..., 3)
        Force ON the tool, N, in {M}.

    Returns
    -------
    ndarray, (..., n, 3)
        delta_joint, m, in {M}: the joints' shares; their sum is delta = C F. Leading axes broadcast.

    Raises
    ------
    KinematicsError
        Where the shapes do not match.

    Examples
    --------
    >>> import numpy as np
    >>> import robomill as rm
    >>> delta_joint = rm.deflection(np.eye(3)[None] * 1e-6, [0.0, 100.0, 0.0])
    >>> (delta_joint * 1e3).round(6).tolist()
    [[0.0, 0.1, 0.0]]
    """
    C_joint = as_floats(C_joint, "C_joint", (None, 3, 3), error=KinematicsError, finite=False)
    F = as_floats(F, "F", (3,), error=KinematicsError, finite=False)
    return displacement(C_joint, F[..., None, :])


def displacement(C: FloatArray, F: ArrayLike) -> FloatArray:
    """delta (..., 3) m = C F: how far a force F (..., 3) N moves a tip of compliance C (..., 3, 3) m/N. Eq. (16)."""
    return np.einsum("...ij,...j->...i", C, np.asarray(F, dtype=np.float64))


def shares_along(delta_joint: FloatArray, delta: FloatArray) -> FloatArray:
    """(..., n) share of each part delta_joint (..., n, 3) in the displacement delta (..., 3): its component along it,
    over its size.

    They sum to 1 where the parts are all that gives; zero where nothing is displaced.
    """
    square = np.einsum("...k,...k->...", delta, delta)
    return np.asarray(
        np.einsum("...nk,...k->...n", delta_joint, delta) / np.where(square > 0.0, square, 1.0)[..., None]
    )


def soft_direction(C: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """(values (..., 3) m/N ascending, axes (..., 3, 3) as columns): the principal compliances of C (..., 3, 3).

    The last column is the direction in which a force moves the tip most.
    """
    C = as_floats(C, "C", (3, 3), error=KinematicsError)
    values, axes = np.linalg.eigh(0.5 * (C + np.swapaxes(C, -1, -2)))
    return values, axes
