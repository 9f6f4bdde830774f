"""Sine, cosine and arc tangent as straight-line arithmetic, compiled: several at once where a loop takes many.

Coefficients: fdlibm's kernels for sine and cosine (Sun Microsystems, 1993) after reduction by pi/2 in two parts, good
to about 1e-16 for |x| < 1e5; Cephes' rational approximation for the arc tangent (Moshier, 1989).
"""

from __future__ import annotations

import numpy as np

from robomill.compiled import part

TWO_OVER_PI = 0.63661977236758134308
PI_2_HIGH = 1.57079632673412561417  # 33 bits, so that a small multiple of it is exact
PI_2_LOW = 6.07710050650619224932e-11


@part
def sin_cos(x: float) -> tuple[float, float]:
    """(sin x, cos x)."""
    k = np.floor(x * TWO_OVER_PI + 0.5)
    r = (x - k * PI_2_HIGH) - k * PI_2_LOW
    z = r * r
    s = 1.58969099521155010221e-10
    s = s * z - 2.50507602534068634195e-08
    s = s * z + 2.75573137070700676789e-06
    s = s * z - 1.98412698298579493134e-04
    s = s * z + 8.33333333332248946124e-03
    s = s * z - 1.66666666666666324348e-01
    s = r + r * z * s
    c = -1.13596475577881948265e-11
    c = c * z + 2.08757232129817482790e-09
    c = c * z - 2.75573143513906633035e-07
    c = c * z + 2.48015872894767294178e-05
    c = c * z - 1.38888888888741095749e-03
    c = c * z + 4.16666666666666019037e-02
    c = 1.0 - 0.5 * z + z * z * c
    quadrant = k - 4.0 * np.floor(0.25 * k)
    odd = (quadrant == 1.0) | (quadrant == 3.0)
    sine = c if odd else s
    cosine = s if odd else c
    sine = -sine if quadrant >= 2.0 else sine
    cosine = -cosine if (quadrant == 1.0) | (quadrant == 2.0) else cosine
    return sine, cosine


@part
def arc_tangent(y: float, x: float) -> float:
    """atan2(y, x); 0 at the origin."""
    ax, ay = abs(x), abs(y)
    big = ax if ax > ay else ay
    small = ay if ax > ay else ax
    upper = small > 0.41421356237309503 * big
    numerator = small - big if upper else small
    denominator = small + big if upper else big
    t = numerator / (denominator if denominator != 0.0 else 1.0)
    z = t * t
    p = -8.750608600031904122785e-1
    p = p * z - 1.615753718733365076637e1
    p = p * z - 7.500855792314704667340e1
    p = p * z - 1.228866684490136173410e2
    p = p * z - 6.485021904942025371773e1
    q = z + 2.485846490142306297962e1
    q = q * z + 1.650270098316988542046e2
    q = q * z + 4.328810604912902668951e2
    q = q * z + 4.853903996359136964868e2
    q = q * z + 1.945506571482613964425e2
    r = t + t * z * p / q
    r = r + 0.78539816339744830962 if upper else r
    r = 1.57079632679489661923 - r if ay > ax else r
    r = 3.14159265358979323846 - r if x < 0.0 else r
    return -r if y < 0.0 else r
