"""How wide an interval is at which level, and Tukey's weights of readings that stray."""

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray

LEVEL = 0.95
BISQUARE = 4.685  # Tukey's constant: 95 % efficient on normal noise
MAD = 0.6744897501960817  # median |x| of the standard normal


def quantile(dof: int | None, level: float = LEVEL) -> float:
    """How many standard deviations a two-sided interval takes: Student's t with ``dof``, normal where that is None.

    Infinite where nothing was left to judge the noise by.
    """
    return float(half_width(1.0, dof, level))


def half_width(std: ArrayLike, dof: int | FloatArray | None, level: float = LEVEL) -> FloatArray:
    """(...) half a two-sided interval for standard deviations (...) that were found with ``dof``, one for all or (...);
    infinite where nothing was left to judge by."""
    from scipy.special import ndtri, stdtrit

    std = np.asarray(std, dtype=np.float64)
    if dof is None:
        return np.asarray(ndtri(0.5 + 0.5 * level) * std)
    spare = np.broadcast_to(np.asarray(dof, dtype=np.float64), std.shape)
    t = stdtrit(np.where(spare > 0.0, spare, 1.0), 0.5 + 0.5 * level)
    return np.where(spare > 0.0, t * std, np.inf)


def bisquare(u: FloatArray) -> FloatArray:
    """(e,) Tukey's weights of residuals (e,) in standard deviations: none from ``BISQUARE`` on."""
    return np.asarray(np.clip(1.0 - (u / BISQUARE) ** 2, 0.0, None) ** 2)
