"""Compiled building blocks of the closed form: the eight solutions of ``decoupled``, LANES poses at a time.

The formulas are those of ``decoupled.solution_columns`` and are explained there. Import only through ``compiled``.
"""

# mypy: disable-error-code="no-untyped-def, attr-defined, call-overload"
# numba types these functions by their signatures; Python's annotations would say nothing more.
from __future__ import annotations

import numpy as np
from numba import njit

from robomill.kinematics.kernel_math import INLINE, arc_tangent
from robomill.kinematics.kernels import LANES

ROUNDING = 1e-12
TINY = 1e-150
# Rows of the target's buffer: tip 0-2, tool axis 3-5; in {S}: u 6-8, g 9-11, wrist centre 12-14; the tool's x 15-17 and
# y 18-20; cosine and sine of the spin about the tool axis 21-22.
TARGET_ROWS = 23
# Rows of the arm's buffer: axis 1 as (c, s) 0-1, x of the wrist centre from the shoulder 2, the turn of axes 2 and 3
# together as (c, s) 3-4, direction in the wrist 5-7 (axes 2 and 3 as (c, s) before that), room 8-9, whether the wrist
# can reach 10 and the arm can reach 11, cosine of the bend 12, the wrist's x 13.
ARM_ROWS = 14
# Where ``decoupled.packed`` puts the constants.
P_S, P_W, P_O, P_A1, P_H, P_L2, P_L3, P_U, P_G, P_GN, P_CU, P_CG, P_CW, P_DIR = (
    0,
    9,
    18,
    21,
    22,
    23,
    25,
    27,
    30,
    33,
    36,
    39,
    42,
    45,
)


@njit(**INLINE)
def load_targets(T_MT, start, count, target):
    """Tip and axes of poses start .. start + count of T_MT (m, 4, 4) into the target buffer."""
    for lane in range(LANES):
        row = start + min(lane, count - 1)
        for r in range(3):
            target[r, lane] = T_MT[row, r, 3]
            target[3 + r, lane] = T_MT[row, r, 2]
            target[15 + r, lane] = T_MT[row, r, 0]
            target[18 + r, lane] = T_MT[row, r, 1]
    for lane in range(LANES):
        target[21, lane] = 1.0
        target[22, lane] = 0.0


@njit(**INLINE)
def aim_block(target, P):
    """Rows 6 .. 14 in the arm's frame {S} from tip, axes and the spin (its cosine and sine) about the tool axis."""
    u0, u1, u2 = P[P_CU], P[P_CU + 1], P[P_CU + 2]
    g0, g1, g2 = P[P_CG], P[P_CG + 1], P[P_CG + 2]
    w0, w1, w2 = P[P_CW], P[P_CW + 1], P[P_CW + 2]
    for r in range(3):
        o = P[P_O + r]
        for lane in range(LANES):
            c, s = target[21, lane], target[22, lane]
            x, y, z = target[15 + r, lane], target[18 + r, lane], target[3 + r, lane]
            x, y = c * x + s * y, c * y - s * x
            target[6 + r, lane] = u0 * x + u1 * y + u2 * z
            target[9 + r, lane] = g0 * x + g1 * y + g2 * z
            target[12 + r, lane] = target[r, lane] - (w0 * x + w1 * y + w2 * z) - o
    s0, s1, s2, s3, s4, s5, s6, s7, s8 = P[0], P[1], P[2], P[3], P[4], P[5], P[6], P[7], P[8]
    for first in range(6, 15, 3):
        for lane in range(LANES):
            x, y, z = target[first, lane], target[first + 1, lane], target[first + 2, lane]
            target[first, lane] = s0 * x + s1 * y + s2 * z
            target[first + 1, lane] = s3 * x + s4 * y + s5 * z
            target[first + 2, lane] = s6 * x + s7 * y + s8 * z


@njit(**INLINE)
def shoulder_block(target, P, side, arm, theta, row):
    """theta_1 into ``row`` of theta for the wrist centre in front (side 1) or behind (-1)."""
    a_1, h, d_1 = P[P_A1], P[P_H], P[P_DIR]
    l2x, l2y, l3x, l3y = P[P_L2], P[P_L2 + 1], P[P_L3], P[P_L3 + 1]
    L_22, L_33 = l2x * l2x + l2y * l2y, l3x * l3x + l3y * l3y
    half = 0.5 / np.sqrt(L_22 * L_33)
    for lane in range(LANES):
        px, py, pz = target[12, lane], target[13, lane], target[14, lane]
        under = px * px + py * py - h * h
        x = side * np.sqrt(max(under, 0.0))
        cx, sx = px * x + py * h, py * x - px * h
        size = np.sqrt(cx * cx + sx * sx)
        some = size > TINY
        inverse = 1.0 / (size if some else 1.0)
        arm[0, lane] = cx * inverse if some else 1.0
        arm[1, lane] = sx * inverse
        rx = x - a_1
        cos_g = (rx * rx + pz * pz - L_22 - L_33) * half
        arm[2, lane] = rx
        arm[11, lane] = 1.0 if (under >= -ROUNDING) & (abs(cos_g) <= 1.0 + ROUNDING) else 0.0
        arm[12, lane] = min(max(cos_g, -1.0), 1.0)
    for lane in range(LANES):
        theta[row, lane] = d_1 * arc_tangent(arm[1, lane], arm[0, lane])


@njit(**INLINE)
def elbow_block(target, P, bend, arm, theta, row):
    """theta_2, theta_3 into ``row`` and the next of theta; bend 1 or -1 is the sense of the elbow's angle."""
    d_2, d_3 = P[P_DIR + 1], P[P_DIR + 2]
    l2x, l2y, l3x, l3y = P[P_L2], P[P_L2 + 1], P[P_L3], P[P_L3 + 1]
    scale = 1.0 / np.sqrt((l2x * l2x + l2y * l2y) * (l3x * l3x + l3y * l3y))
    bend_x, bend_y = (l2x * l3x + l2y * l3y) * scale, (l2y * l3x - l2x * l3y) * scale
    for lane in range(LANES):
        cos_g, rx, pz = arm[12, lane], arm[2, lane], target[14, lane]
        sin_g = bend * np.sqrt((1.0 - cos_g) * (1.0 + cos_g))
        c_3, s_3 = bend_x * cos_g - bend_y * sin_g, bend_x * sin_g + bend_y * cos_g
        mx, my = l2x + l3x * c_3 - l3y * s_3, l2y + l3x * s_3 + l3y * c_3
        cx, sx = rx * mx - pz * my, -pz * mx - rx * my
        size = np.sqrt(cx * cx + sx * sx)
        some = size > TINY
        inverse = 1.0 / (size if some else 1.0)
        c_2, s_2 = (cx * inverse if some else 1.0), sx * inverse
        arm[3, lane] = c_2 * c_3 - s_2 * s_3
        arm[4, lane] = s_2 * c_3 + c_2 * s_3
        arm[5, lane] = c_2
        arm[6, lane] = s_2
        arm[7, lane] = c_3
        arm[8, lane] = s_3
    for lane in range(LANES):
        theta[row, lane] = d_2 * arc_tangent(arm[6, lane], arm[5, lane])
    for lane in range(LANES):
        theta[row + 1, lane] = d_3 * arc_tangent(arm[8, lane], arm[7, lane])


@njit(**INLINE)
def direction_block(target, P, arm):
    """The commanded direction seen from the wrist before it turns, and whether the wrist can take it."""
    u1 = P[P_U + 1]
    w0, w1, w2, w3, w4, w5, w6, w7, w8 = P[9], P[10], P[11], P[12], P[13], P[14], P[15], P[16], P[17]
    for lane in range(LANES):
        c_1, s_1, c, s = arm[0, lane], arm[1, lane], arm[3, lane], arm[4, lane]
        x, y, z = target[6, lane], target[7, lane], target[8, lane]
        x, y = c_1 * x + s_1 * y, c_1 * y - s_1 * x
        x, z = c * x - s * z, s * x + c * z
        vx, vy = w0 * x + w1 * y + w2 * z, w3 * x + w4 * y + w5 * z
        arm[5, lane] = vx
        arm[6, lane] = vy
        arm[7, lane] = w6 * x + w7 * y + w8 * z
        under = vx * vx + vy * vy - u1 * u1
        arm[13, lane] = np.sqrt(max(under, 0.0))
        arm[10, lane] = arm[11, lane] if under >= -ROUNDING else 0.0


@njit(**INLINE)
def wrist_block(P, flip, arm, theta, row):
    """theta_4, theta_5 into ``row`` and the next of theta; flip 1 or -1 chooses between the wrist's two solutions."""
    u0, u1, u2 = P[P_U], P[P_U + 1], P[P_U + 2]
    d_4, d_5 = P[P_DIR + 3], P[P_DIR + 4]
    for lane in range(LANES):
        xw, vz = flip * arm[13, lane], arm[7, lane]
        theta[row + 1, lane] = d_5 * arc_tangent(xw * u2 - vz * u0, vz * u2 + xw * u0)
    for lane in range(LANES):
        xw, vx, vy = flip * arm[13, lane], arm[5, lane], arm[6, lane]
        theta[row, lane] = d_4 * arc_tangent(vy * xw - vx * u1, vx * xw + vy * u1)


@njit(**INLINE)
def last_joint(target, P, arm, flip, theta, row):
    """theta_6 of the wrist whose direction is in the arm buffer, into ``row`` of theta."""
    u0, u1, u2 = P[P_U], P[P_U + 1], P[P_U + 2]
    g0, g1, g2 = P[P_G], P[P_G + 1], P[P_G + 2]
    n0, n1, n2 = P[P_GN], P[P_GN + 1], P[P_GN + 2]
    w0, w1, w2, w3, w4, w5, w6, w7, w8 = P[9], P[10], P[11], P[12], P[13], P[14], P[15], P[16], P[17]
    d_6 = P[P_DIR + 5]
    for lane in range(LANES):
        c_1, s_1, c, s = arm[0, lane], arm[1, lane], arm[3, lane], arm[4, lane]
        x, y, z = target[9, lane], target[10, lane], target[11, lane]
        x, y = c_1 * x + s_1 * y, c_1 * y - s_1 * x
        x, z = c * x - s * z, s * x + c * z
        gx, gy, gz = w0 * x + w1 * y + w2 * z, w3 * x + w4 * y + w5 * z, w6 * x + w7 * y + w8 * z
        xw = flip * arm[13, lane]
        vx, vy, vz = arm[5, lane], arm[6, lane], arm[7, lane]
        c_4, s_4 = vx * xw + vy * u1, vy * xw - vx * u1
        size = np.sqrt(c_4 * c_4 + s_4 * s_4)
        some = size > TINY
        inverse = 1.0 / (size if some else 1.0)
        c_4, s_4 = (c_4 * inverse if some else 1.0), s_4 * inverse
        c_5, s_5 = vz * u2 + xw * u0, xw * u2 - vz * u0
        size = np.sqrt(c_5 * c_5 + s_5 * s_5)
        some = size > TINY
        inverse = 1.0 / (size if some else 1.0)
        c_5, s_5 = (c_5 * inverse if some else 1.0), s_5 * inverse
        hx, hy = c_4 * gx + s_4 * gy, c_4 * gy - s_4 * gx
        hx, hz = c_5 * hx - s_5 * gz, s_5 * hx + c_5 * gz
        theta[row, lane] = d_6 * arc_tangent(hx * n0 + hy * n1 + hz * n2, hx * g0 + hy * g1 + hz * g2)


@njit(**INLINE)
def solve_block(target, P, n, arm, theta, possible):
    """theta (8 n, LANES), possible (8, LANES; 1 or 0) from the target buffer; arm (14, LANES) is room to work in."""
    for a in range(2):
        side = 1.0 - 2.0 * a
        first = 4 * a * n
        shoulder_block(target, P, side, arm, theta, first)
        for b in range(2):
            second = first + 2 * b * n
            elbow_block(target, P, side * (1.0 - 2.0 * b), arm, theta, second + 1)
            direction_block(target, P, arm)
            for w in range(2):
                flip = 1.0 - 2.0 * w
                branch = 4 * a + 2 * b + w
                row = branch * n
                wrist_block(P, flip, arm, theta, row + 3)
                if n == 6:
                    last_joint(target, P, arm, flip, theta, row + 5)
                for lane in range(LANES):
                    possible[branch, lane] = arm[10, lane]
                if row != first:
                    for lane in range(LANES):
                        theta[row, lane] = theta[first, lane]
                if row != second:
                    for lane in range(LANES):
                        theta[row + 1, lane] = theta[second + 1, lane]
                        theta[row + 2, lane] = theta[second + 2, lane]
