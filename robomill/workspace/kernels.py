"""The compiled pass over configurations of a map: pose, Jacobian, joint shares, determinant.

One configuration's laws are those of ``kinematics`` and ``compliance``; here they run LANES points at a time without
going through memory in between. Import only through ``kinematics.compiled``.
"""

# mypy: disable-error-code="no-untyped-def, attr-defined, call-overload"
# numba types these functions by their signatures; Python's annotations would say nothing more.
from __future__ import annotations

import numpy as np
from numba import njit
from numba.types import void

from robomill.kinematics.kernel_math import INLINE
from robomill.kinematics.kernels import (
    CHAIN,
    IN1,
    IN2,
    LANES,
    OPTIONS,
    OUT1,
    OUT3,
    TOOL_ROWS,
    chain_block,
    jacobian_block,
    load_rows,
    store_pose,
)


@njit(**INLINE)
def determinant_block(J, n, tilt, det):
    """det (LANES): of the 5 x 5 task Jacobian (omega rows on tilt (2, 3)) or of the 6 x 6 Jacobian, by 3 x 3 minors."""
    for lane in range(LANES):
        det[lane] = 0.0
    if n == 5:
        t00, t01, t02, t10, t11, t12 = tilt[0, 0], tilt[0, 1], tilt[0, 2], tilt[1, 0], tilt[1, 1], tilt[1, 2]
        for i in range(5):
            for k in range(i + 1, 5):
                # The three columns left over, in order.
                a = 0 if i > 0 else (1 if k > 1 else 2)
                c = 4 if k < 4 else (3 if i < 3 else 2)
                b = 10 - i - k - a - c
                sign = 1.0 if (i + k) % 2 == 1 else -1.0
                A, B, C, D, E = 6 * a, 6 * b, 6 * c, 6 * i, 6 * k
                for lane in range(LANES):
                    minor = (
                        J[A, lane] * (J[B + 1, lane] * J[C + 2, lane] - J[B + 2, lane] * J[C + 1, lane])
                        - J[B, lane] * (J[A + 1, lane] * J[C + 2, lane] - J[A + 2, lane] * J[C + 1, lane])
                        + J[C, lane] * (J[A + 1, lane] * J[B + 2, lane] - J[A + 2, lane] * J[B + 1, lane])
                    )
                    xi = t00 * J[D + 3, lane] + t01 * J[D + 4, lane] + t02 * J[D + 5, lane]
                    yi = t10 * J[D + 3, lane] + t11 * J[D + 4, lane] + t12 * J[D + 5, lane]
                    xk = t00 * J[E + 3, lane] + t01 * J[E + 4, lane] + t02 * J[E + 5, lane]
                    yk = t10 * J[E + 3, lane] + t11 * J[E + 4, lane] + t12 * J[E + 5, lane]
                    det[lane] += sign * minor * (xi * yk - xk * yi)
        return
    for i in range(6):
        for j in range(i + 1, 6):
            for k in range(j + 1, 6):
                a = 0 if i > 0 else (1 if j > 1 else (2 if k > 2 else 3))
                c = 5 if k < 5 else (4 if j < 4 else (3 if i < 3 else 2))
                b = 15 - i - j - k - a - c
                sign = 1.0 if (i + j + k) % 2 == 1 else -1.0
                A, B, C, D, E, F = 6 * i, 6 * j, 6 * k, 6 * a + 3, 6 * b + 3, 6 * c + 3
                for lane in range(LANES):
                    upper = (
                        J[A, lane] * (J[B + 1, lane] * J[C + 2, lane] - J[B + 2, lane] * J[C + 1, lane])
                        - J[B, lane] * (J[A + 1, lane] * J[C + 2, lane] - J[A + 2, lane] * J[C + 1, lane])
                        + J[C, lane] * (J[A + 1, lane] * J[B + 2, lane] - J[A + 2, lane] * J[B + 1, lane])
                    )
                    lower = (
                        J[D, lane] * (J[E + 1, lane] * J[F + 2, lane] - J[E + 2, lane] * J[F + 1, lane])
                        - J[E, lane] * (J[D + 1, lane] * J[F + 2, lane] - J[D + 2, lane] * J[F + 1, lane])
                        + J[F, lane] * (J[D + 1, lane] * J[E + 2, lane] - J[D + 2, lane] * J[E + 1, lane])
                    )
                    det[lane] += sign * upper * lower


@njit(**INLINE)
def shares_block(J, n, weight, shares):
    """shares (6 n, LANES): each joint's part of C_xx, C_yy, C_zz, C_xy, C_xz, C_yz."""
    for i in range(n):
        k, w = 6 * i, weight[i]
        for lane in range(LANES):
            a, b, c = J[k, lane], J[k + 1, lane], J[k + 2, lane]
            shares[k, lane] = w * a * a
            shares[k + 1, lane] = w * b * b
            shares[k + 2, lane] = w * c * c
            shares[k + 3, lane] = w * a * b
            shares[k + 4, lane] = w * a * c
            shares[k + 5, lane] = w * b * c


@njit(void(IN2, *CHAIN, IN1, IN2, OUT3, OUT3, OUT3, OUT1), **OPTIONS)
def evaluate(theta, T_0, E, sign, offset, prismatic, weight, tilt, T_MT, J_out, shares_out, det_out):
    """T_MT (m, 4, 4), J (m, 6, n), shares (m, n, 6) and det (m,) at theta (m, n), five or six joints; NaN in, NaN out.

    weight (n,) joint compliances; tilt (2, 3) the axes x', y' of the tool's tilt, the same for all.
    """
    m, n = theta.shape
    block, tool, axes = np.empty((n, LANES)), np.empty((TOOL_ROWS, LANES)), np.empty((6 * n, LANES))
    J, shares, det = np.empty((6 * n, LANES)), np.empty((6 * n, LANES)), np.empty(LANES)
    for start in range(0, m, LANES):
        count = min(LANES, m - start)
        load_rows(theta, start, count, block)
        chain_block(tool, block, 0, axes, n, T_0, E, sign, offset, prismatic)
        jacobian_block(tool, axes, n, sign, prismatic, J)
        shares_block(J, n, weight, shares)
        determinant_block(J, n, tilt, det)
        store_pose(tool, start, count, T_MT)
        for lane in range(count):
            row = start + lane
            missing = np.nan if np.isnan(block[0, lane]) else 0.0
            det_out[row] = det[lane] + missing
            for j in range(n):
                for r in range(6):
                    shares_out[row, j, r] = shares[6 * j + r, lane] + missing
            for r in range(6):
                for j in range(n):
                    J_out[row, r, j] = J[6 * j + r, lane] + missing
