"""The compiled pass over a grid: closed-form inverse kinematics, choice, check, Jacobian, joint shares, determinant.

One configuration's laws are those of ``kinematics`` and ``compliance``; here they run LANES points at a time without
going through memory in between. Import only through ``kinematics.compiled``.
"""

# mypy: disable-error-code="no-untyped-def, attr-defined, call-overload"
# numba types these functions by their signatures; Python's annotations would say nothing more.
from __future__ import annotations

import numpy as np
from numba import njit
from numba.types import boolean, void

from robomill.kinematics.kernels import (
    CHAIN,
    FLAGS,
    IN1,
    IN2,
    LANES,
    OPTIONS,
    OUT1,
    OUT2,
    OUT3,
    TOOL_ROWS,
    chain_block,
    jacobian_block,
)  # fmt: skip
from robomill.kinematics.kernels_inverse import (
    ARM_ROWS,
    P_CG,
    P_CU,
    P_CW,
    P_O,
    TARGET_ROWS,
    into_base,
    misfit,
    solve_block,
)  # fmt: skip

TURN = 2.0 * np.pi
LIMIT_SLACK = 1e-10
RESIDUAL_SQUARED = 1e-18
ARM_WEIGHT = 1e6
NOWHERE = 1e300


@njit(inline="always")
def choose_block(theta, possible, n, limits, home, last_free, trial, best, cost):
    """best (n, LANES): of the eight solutions the one within limits, shoulder and elbow first, then nearest home.

    cost (3, LANES): least cost (NOWHERE: none), cost at hand, limit overshoot at hand. trial (n, LANES) is room.
    """
    for lane in range(LANES):
        cost[0, lane] = NOWHERE
    for branch in range(8):
        order = ARM_WEIGHT * (branch // 2)
        for lane in range(LANES):
            cost[1, lane] = order
            cost[2, lane] = 0.0
        for j in range(n):
            low, high, middle, near = limits[j, 0], limits[j, 1], 0.5 * (limits[j, 0] + limits[j, 1]), home[j]
            row = branch * n + j
            held = 1.0 if (last_free & (j == 5)) else 0.0
            for lane in range(LANES):
                angle = held * near + (1.0 - held) * theta[row, lane]
                close = angle + TURN * np.rint((near - angle) / TURN)
                central = angle + TURN * np.rint((middle - angle) / TURN)
                inside = (close >= low - LIMIT_SLACK) & (close <= high + LIMIT_SLACK)
                turned = close if inside else central
                kept = min(max(turned, low), high)
                trial[j, lane] = kept
                cost[1, lane] += (turned - near) * (turned - near)
                cost[2, lane] = max(cost[2, lane], abs(turned - kept))
        for lane in range(LANES):
            fine = (possible[branch, lane] > 0.5) & (cost[2, lane] <= LIMIT_SLACK)
            cost[1, lane] = cost[1, lane] if fine else NOWHERE
            cost[2, lane] = 1.0 if cost[1, lane] < cost[0, lane] else 0.0
            cost[0, lane] = min(cost[0, lane], cost[1, lane])
        for j in range(n):
            for lane in range(LANES):
                best[j, lane] = trial[j, lane] if cost[2, lane] > 0.5 else best[j, lane]


@njit(inline="always")
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


@njit(inline="always")
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


@njit(inline="always")
def load_points(points, R, start, count, P, target):
    """Points start .. start + count (m, 3), all at the orientation R (3, 3), into the target buffer."""
    for r in range(3):
        u = R[r, 0] * P[P_CU] + R[r, 1] * P[P_CU + 1] + R[r, 2] * P[P_CU + 2]
        g = R[r, 0] * P[P_CG] + R[r, 1] * P[P_CG + 1] + R[r, 2] * P[P_CG + 2]
        w = R[r, 0] * P[P_CW] + R[r, 1] * P[P_CW + 1] + R[r, 2] * P[P_CW + 2] + P[P_O + r]
        for lane in range(LANES):
            p = points[start + min(lane, count - 1), r]
            target[r, lane] = p
            target[3 + r, lane] = R[r, 2]
            target[6 + r, lane] = u
            target[9 + r, lane] = g
            target[12 + r, lane] = p - w
    into_base(P, target)


@njit(
    void(IN2, IN2, IN1, *CHAIN, IN2, IN1, boolean, IN1, IN2, OUT2, FLAGS, OUT3, OUT3, OUT1),
    **OPTIONS,
)
def solve_points(
    points, R, P, T_0, E, sign, offset, prismatic, limits, home, last_free, weight, tilt,
    theta_out, reached, J_out, shares_out, det_out,
):  # fmt: skip
    """theta (m, n), reached (m,), J (m, 6, n), shares (m, n, 6), det (m,) at points (m, 3), all oriented as R (3, 3).

    P: ``Decoupled.packed``; limits (n, 2), home (n,); last_free: joint 6 only spins the tool and stays at home; weight
    (n,) joint compliances; tilt (2, 3) the axes x', y'. NaN where not reached.
    """
    m, n = len(points), theta_out.shape[1]
    target, arm = np.empty((TARGET_ROWS, LANES)), np.empty((ARM_ROWS, LANES))
    theta, possible = np.empty((8 * n, LANES)), np.empty((8, LANES))
    trial, best, cost = np.empty((n, LANES)), np.zeros((n, LANES)), np.empty((3, LANES))
    tool, axes, error = np.empty((TOOL_ROWS, LANES)), np.empty((6 * n, LANES)), np.empty((2, LANES))
    J, shares, det = np.empty((6 * n, LANES)), np.empty((6 * n, LANES)), np.empty(LANES)
    for start in range(0, m, LANES):
        count = min(LANES, m - start)
        load_points(points, R, start, count, P, target)
        solve_block(target, P, n, arm, theta, possible)
        choose_block(theta, possible, n, limits, home, last_free, trial, best, cost)
        chain_block(tool, best, 0, axes, n, T_0, E, sign, offset, prismatic)
        misfit(tool, target, error)
        jacobian_block(tool, axes, n, sign, prismatic, J)
        shares_block(J, n, weight, shares)
        determinant_block(J, n, tilt, det)
        for lane in range(count):
            row = start + lane
            fine = (
                (cost[0, lane] < NOWHERE) & (error[0, lane] <= RESIDUAL_SQUARED) & (error[1, lane] <= RESIDUAL_SQUARED)
            )
            reached[row] = fine
            if fine:
                det_out[row] = det[lane]
                for j in range(n):
                    theta_out[row, j] = best[j, lane]
                    for r in range(6):
                        shares_out[row, j, r] = shares[6 * j + r, lane]
                for r in range(6):
                    for j in range(n):
                        J_out[row, r, j] = J[6 * j + r, lane]
            else:
                det_out[row] = np.nan
                theta_out[row] = np.nan
                shares_out[row] = np.nan
                J_out[row] = np.nan
