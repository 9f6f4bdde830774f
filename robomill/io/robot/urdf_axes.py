"""Joint axes as a modified D-H table."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.rigid import transform

PARALLEL = 1e-9


def dh_from_axes(k: FloatArray, p: FloatArray, T_MT: FloatArray) -> dict[str, FloatArray]:
    """Columns of a modified D-H table, T_base and T_tool, from the joint axes at zero: k (n, 3) unit, p (n, 3) m.

    Frame i has its z along axis i and its x along the common perpendicular from axis i to axis i + 1 (any where they
    cross, as before where they are parallel); the last one stands as near {T} as its axis allows. The base frame takes
    up where the first one stands.
    """
    n = len(k)
    frames = []
    x = _any_square(k[0])
    for i in range(n):
        last = i + 1 == n
        along = k[i] * (k[i] @ (T_MT[:3, 3] - p[i]))
        x, origin = (_square_part(T_MT[:3, 0], k[i]), p[i] + along) if last else _common_perpendicular(k, p, i, x)
        frames.append(transform(np.column_stack([x, np.cross(k[i], x), k[i]]), origin))
    alpha, a, d, theta = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    for i in range(1, n):
        # Rx(alpha) Tx(a) Rz(theta) Tz(d) between neighbouring frames.
        E = np.linalg.inv(frames[i - 1]) @ frames[i]
        alpha[i] = np.arctan2(-E[1, 2], E[2, 2])
        a[i] = E[0, 3]
        theta[i] = np.arctan2(-E[0, 1], E[0, 0])
        d[i] = -E[1, 3] * np.sin(alpha[i]) + E[2, 3] * np.cos(alpha[i])
    return {
        "alpha": alpha,
        "a": a,
        "d": d,
        "theta_offset": theta,
        "T_base": _rigid(frames[0]),
        "T_tool": _rigid(np.linalg.inv(frames[-1]) @ T_MT),
    }


def _common_perpendicular(k: FloatArray, p: FloatArray, i: int, before: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(x, origin) of the frame on axis i: x from axis i to axis i + 1, origin where the perpendicular leaves axis i."""
    across = np.cross(k[i], k[i + 1])
    size = float(np.linalg.norm(across))
    gap = p[i + 1] - p[i]
    if size > PARALLEL:
        origin = p[i] + k[i] * (np.cross(gap, k[i + 1]) @ across) / size**2
        return across * (-1.0 if gap @ across < 0 else 1.0) / size, origin
    between = gap - k[i] * (gap @ k[i])
    size = float(np.linalg.norm(between))
    return (between / size if size > PARALLEL else _square_part(before, k[i])), p[i]


def _any_square(k: FloatArray) -> FloatArray:
    return _square_part(np.eye(3)[np.argmin(np.abs(k))], k)


def _square_part(x: FloatArray, k: FloatArray) -> FloatArray:
    part = x - k * (x @ k)
    size = np.linalg.norm(part)
    return part / size if size > 1e-9 else _any_square(k)


def _rigid(T: FloatArray) -> FloatArray:
    """T with its rotation made exactly orthonormal and its last row exact."""
    u, _, vt = np.linalg.svd(T[:3, :3])
    return transform(u @ vt, T[:3, 3])
