"""Integrals of powers of the sine."""

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray


def sine_integral(q: float, angle: ArrayLike) -> FloatArray:
    """Integral of sin^q from 0 to ``angle`` (...,) in 0..pi rad, for q > -1 (a beta integral)."""
    phi = np.asarray(angle, dtype=np.float64)
    if q == 0.0:
        return phi
    if q == 1.0:
        return 2.0 * np.sin(0.5 * phi) ** 2
    if q == 2.0:
        return 0.5 * (phi - np.sin(phi) * np.cos(phi))
    from scipy.special import beta, betainc

    a = 0.5 * (q + 1.0)
    quarter = 0.5 * beta(a, 0.5)
    sine2, cosine2 = np.sin(phi) ** 2, np.cos(phi) ** 2
    # From whichever end is near, so that neither loses digits beside pi/2.
    rising = quarter * np.where(sine2 < 0.5, betainc(a, 0.5, sine2), 1.0 - betainc(0.5, a, cosine2))
    return np.where(phi <= 0.5 * np.pi, rising, 2.0 * quarter - rising)
