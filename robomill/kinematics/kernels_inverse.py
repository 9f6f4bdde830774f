"""Compiled closed-form inverse kinematics: the eight solutions of ``decoupled.solutions``, LANES poses at a time.

The formulas are those of ``decoupled`` and are explained there. Import only through ``compiled``.
"""

# mypy: disable-error-code="no-untyped-def, attr-defined, call-overload"
# numba types these functions by their signatures; Python's annotations would say nothing more.
from __future__ import annotations

import numpy as np
from numba import njit
from numba.types import boolean, float64, int64, void

from robomill.kinematics.kernel_math import INLINE, arc_tangent, sin_cos
from robomill.kinematics.kernels import (
    CHAIN,
    FLAGS2,
    IN1,
    IN2,
    IN3,
    IN_FLAGS,
    INDEX,
    LANES,
    OPTIONS,
    OUT2,
    OUT3,
    TOOL_ROWS,
    chain_block,
)  # fmt: skip

ROUNDING = 1e-12
TINY = 1e-300
TURN = 2.0 * np.pi
LIMIT_SLACK = 1e-10
ARM_WEIGHT = 1e6
SPIN_HALVINGS = 7
NOWHERE = 1e300
# Rows of the cost buffer: least over the eight solutions, at hand, overshoot at hand, branch; least over all spins, its
# branch, its spin, and the spin at hand.
COST_BEST, COST_BRANCH, COST_SPIN, COST_ROWS = 4, 5, 6, 8
# Rows of the target's buffer: tip 0-2, tool axis 3-5; in {S}: u 6-8, g 9-11, wrist centre 12-14; the tool's x 15-17 and
# y 18-20; cosine and sine of the spin about the tool axis 21-22.
TARGET_ROWS = 23
# Rows of the arm's buffer: c_1 s_1 x 0-2, c s of the turn 3-4, wrist direction 5-7 and normal 8-10, flags 11-13.
ARM_ROWS = 14
# Where ``decoupled.packed`` puts the constants.
P_S, P_W, P_O, P_A1, P_H, P_L2, P_L3, P_U, P_G, P_GN, P_CU, P_CG, P_CW, P_DIR = (
    0, 9, 18, 21, 22, 23, 25, 27, 30, 33, 36, 39, 42, 45,
)  # fmt: skip


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
def solve_block(target, P, n, arm, theta, possible):
    """theta (8 n, LANES), possible (8, LANES; 1 or 0) from the target buffer; arm (14, LANES) is room to work in."""
    a_1, h = P[P_A1], P[P_H]
    l2x, l2y, l3x, l3y = P[P_L2], P[P_L2 + 1], P[P_L3], P[P_L3 + 1]
    L_22, L_33 = l2x * l2x + l2y * l2y, l3x * l3x + l3y * l3y
    scale = 1.0 / np.sqrt(L_22 * L_33)
    bend_x, bend_y = (l2x * l3x + l2y * l3y) * scale, (l2y * l3x - l2x * l3y) * scale
    half = 0.5 * scale
    u0, u1, u2 = P[P_U], P[P_U + 1], P[P_U + 2]
    w0, w1, w2, w3, w4, w5, w6, w7, w8 = P[9], P[10], P[11], P[12], P[13], P[14], P[15], P[16], P[17]
    for a in range(2):
        side = 1.0 - 2.0 * a
        k = 4 * a * n
        d_1, d_2, d_3 = P[P_DIR], P[P_DIR + 1], P[P_DIR + 2]
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
            theta[k, lane] = d_1 * arc_tangent(arm[1, lane], arm[0, lane])
        for b in range(2):
            bend = side * (1.0 - 2.0 * b)
            kb = k + 2 * b * n
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
                theta[kb + 1, lane] = d_2 * arc_tangent(arm[6, lane], arm[5, lane])
            for lane in range(LANES):
                theta[kb + 2, lane] = d_3 * arc_tangent(arm[8, lane], arm[7, lane])
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
            for w in range(2):
                flip = 1.0 - 2.0 * w
                branch = 4 * a + 2 * b + w
                kw = branch * n
                d_4, d_5 = P[P_DIR + 3], P[P_DIR + 4]
                for lane in range(LANES):
                    possible[branch, lane] = arm[10, lane]
                for lane in range(LANES):
                    xw = flip * arm[13, lane]
                    vz = arm[7, lane]
                    c_5, s_5 = vz * u2 + xw * u0, xw * u2 - vz * u0
                    theta[kw + 4, lane] = d_5 * arc_tangent(s_5, c_5)
                for lane in range(LANES):
                    xw = flip * arm[13, lane]
                    vx, vy = arm[5, lane], arm[6, lane]
                    c_4, s_4 = vx * xw + vy * u1, vy * xw - vx * u1
                    theta[kw + 3, lane] = d_4 * arc_tangent(s_4, c_4)
                if n == 6:
                    last_joint(target, P, arm, flip, theta, kw + 5)
                if w == 1:
                    for lane in range(LANES):
                        theta[kw, lane] = theta[k, lane]
                        theta[kw + 1, lane] = theta[kb + 1, lane]
                        theta[kw + 2, lane] = theta[kb + 2, lane]
                elif b == 1:
                    for lane in range(LANES):
                        theta[kw, lane] = theta[k, lane]


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
        some = size > 1e-150
        inverse = 1.0 / (size if some else 1.0)
        c_4, s_4 = (c_4 * inverse if some else 1.0), s_4 * inverse
        c_5, s_5 = vz * u2 + xw * u0, xw * u2 - vz * u0
        size = np.sqrt(c_5 * c_5 + s_5 * s_5)
        some = size > 1e-150
        inverse = 1.0 / (size if some else 1.0)
        c_5, s_5 = (c_5 * inverse if some else 1.0), s_5 * inverse
        hx, hy = c_4 * gx + s_4 * gy, c_4 * gy - s_4 * gx
        hx, hz = c_5 * hx - s_5 * gz, s_5 * hx + c_5 * gz
        theta[row, lane] = d_6 * arc_tangent(hx * n0 + hy * n1 + hz * n2, hx * g0 + hy * g1 + hz * g2)


@njit(**INLINE)
def misfit(tool, target, whole, error):
    """error (2, LANES): squared distance of the tips; squared chord of the tool axes, or of the ``whole`` rotation.

    A rotation by an angle has the chord 2 sin(angle / 2): its matrix is off by the square root of twice that squared.
    """
    for lane in range(LANES):
        x, y, z = tool[9, lane] - target[0, lane], tool[10, lane] - target[1, lane], tool[11, lane] - target[2, lane]
        error[0, lane] = x * x + y * y + z * z
        x, y, z = tool[2, lane] - target[3, lane], tool[5, lane] - target[4, lane], tool[8, lane] - target[5, lane]
        error[1, lane] = x * x + y * y + z * z
    if whole:
        for lane in range(LANES):
            x, y, z = (
                tool[0, lane] - target[15, lane],
                tool[3, lane] - target[16, lane],
                tool[6, lane] - target[17, lane],
            )
            error[1, lane] += x * x + y * y + z * z
        for lane in range(LANES):
            x, y, z = (
                tool[1, lane] - target[18, lane],
                tool[4, lane] - target[19, lane],
                tool[7, lane] - target[20, lane],
            )
            error[1, lane] = 0.5 * (error[1, lane] + x * x + y * y + z * z)


@njit(**INLINE)
def choose_block(theta, possible, n, limits, goal, arm_first, wanted, last_free, trial, found, cost):
    """found (n, LANES): the solution within limits nearest ``goal`` (n, LANES), by the rule of ``choice.choose``."""
    for lane in range(LANES):
        cost[0, lane] = NOWHERE
        cost[3, lane] = -1.0
    for branch in range(8):
        if not wanted[branch]:
            continue
        order = ARM_WEIGHT * (branch // 2) if arm_first else 0.0
        for lane in range(LANES):
            cost[1, lane] = order
            cost[2, lane] = 0.0
        for j in range(n):
            low, high, middle = limits[j, 0], limits[j, 1], 0.5 * (limits[j, 0] + limits[j, 1])
            row = branch * n + j
            held = 1.0 if (last_free & (j == 5)) else 0.0
            for lane in range(LANES):
                near = goal[j, lane]
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
            cost[3, lane] = branch if cost[2, lane] > 0.5 else cost[3, lane]
        for j in range(n):
            for lane in range(LANES):
                found[j, lane] = trial[j, lane] if cost[2, lane] > 0.5 else found[j, lane]


@njit(**INLINE)
def search_block(
    target,
    P,
    n,
    limits,
    goal,
    arm_first,
    wanted,
    last_free,
    spins,
    every,
    arm,
    theta,
    possible,
    trial,
    found,
    best,
    cost,
):
    """best (n, LANES), with its cost, branch and spin in the cost buffer, over ``spins`` spins and their refinement.

    spins 0: the pose as given. The search is that of ``choice.choose_spin``. With ``every`` nothing is chosen: the
    eight solutions are left in theta and possible.
    """
    for lane in range(LANES):
        cost[COST_BEST, lane] = NOWHERE
        cost[COST_BRANCH, lane] = -1.0
        cost[COST_SPIN, lane] = 0.0
        cost[7, lane] = 0.0
    step = TURN / max(spins, 1)
    attempts = spins + 2 * SPIN_HALVINGS if spins > 0 else 1
    for attempt in range(attempts):
        if spins > 0:
            refinement = attempt - spins
            if refinement < 0:
                for lane in range(LANES):
                    cost[7, lane] = attempt * step
            else:
                if refinement % 2 == 0:
                    for lane in range(LANES):
                        cost[7, lane] = cost[COST_SPIN, lane] + step * 0.5 ** (refinement // 2 + 1)
                else:
                    # The other side of where this refinement began, which its first half may have left.
                    back = step * 0.5 ** (refinement // 2)
                    for lane in range(LANES):
                        cost[7, lane] = cost[7, lane] - back
            for lane in range(LANES):
                s, c = sin_cos(cost[7, lane])
                target[21, lane] = c
                target[22, lane] = s
        else:
            for lane in range(LANES):
                target[21, lane] = 1.0
                target[22, lane] = 0.0
        aim_block(target, P)
        solve_block(target, P, n, arm, theta, possible)
        if every:
            return
        choose_block(theta, possible, n, limits, goal, arm_first, wanted, last_free, trial, found, cost)
        for lane in range(LANES):
            better = cost[0, lane] < cost[COST_BEST, lane]
            cost[2, lane] = 1.0 if better else 0.0
            cost[COST_BEST, lane] = cost[0, lane] if better else cost[COST_BEST, lane]
            cost[COST_BRANCH, lane] = cost[3, lane] if better else cost[COST_BRANCH, lane]
            cost[COST_SPIN, lane] = cost[7, lane] if better else cost[COST_SPIN, lane]
        for j in range(n):
            for lane in range(LANES):
                best[j, lane] = found[j, lane] if cost[2, lane] > 0.5 else best[j, lane]


@njit(**INLINE)
def check_block(theta, n, T_0, E, sign, offset, prismatic, target, tool, axes, error, limit, possible):
    """Of the eight solutions those stay possible whose pose meets the target; with six axes all of it counts."""
    for branch in range(8):
        chain_block(tool, theta, branch * n, axes, n, T_0, E, sign, offset, prismatic)
        misfit(tool, target, n == 6, error)
        for lane in range(LANES):
            close = (error[0, lane] <= limit) & (error[1, lane] <= limit)
            possible[branch, lane] = possible[branch, lane] if close else 0.0


@njit(
    void(
        IN3, IN1, *CHAIN, IN2, IN2, boolean, IN_FLAGS, boolean, int64, float64, boolean,
        OUT3, FLAGS2, OUT2, INDEX, OUT2,
    ),
    **OPTIONS,
)  # fmt: skip
def solve(
    T_MT, P, T_0, E, sign, offset, prismatic, limits, goals, arm_first, wanted, last_free, spins, tolerance, every,
    theta_every, sound, theta_near, index, fit,
):  # fmt: skip
    """The solutions of poses T_MT (m, 4, 4): all of them, or of each pose the one nearest its goal.

    With ``every``: theta_every (m, 8, n) and sound (m, 8), checked by forward kinematics to ``tolerance`` (m and rad)
    if that is not negative. Otherwise theta_near (m, n), index (m,) (-1: none), see ``search_block``, and fit (m, 3):
    spin rad, residual m and residual angle rad by forward kinematics (of the whole rotation if ``tolerance`` is
    positive, else of the tool axis); goals (1 or m, n). The outputs of the other kind are not touched. One kernel for
    both, because compiling the solution is what takes the time.
    """
    m, n = len(T_MT), limits.shape[0]
    target, arm = np.empty((TARGET_ROWS, LANES)), np.empty((ARM_ROWS, LANES))
    theta, possible = np.empty((8 * n, LANES)), np.empty((8, LANES))
    trial, found, best = np.empty((n, LANES)), np.zeros((n, LANES)), np.zeros((n, LANES))
    cost, goal = np.empty((COST_ROWS, LANES)), np.empty((n, LANES))
    tool, axes, error = np.empty((TOOL_ROWS, LANES)), np.empty((6 * n, LANES)), np.empty((2, LANES))
    for start in range(0, m, LANES):
        count = min(LANES, m - start)
        load_targets(T_MT, start, count, target)
        for lane in range(LANES):
            row = start + min(lane, count - 1) if len(goals) > 1 else 0
            for j in range(n):
                goal[j, lane] = goals[row, j]
        search_block(
            target, P, n, limits, goal, arm_first, wanted, last_free, spins, every,
            arm, theta, possible, trial, found, best, cost,
        )  # fmt: skip
        if every:
            if tolerance >= 0.0:
                check_block(
                    theta, n, T_0, E, sign, offset, prismatic, target, tool, axes, error, tolerance**2, possible
                )
            for lane in range(count):
                for branch in range(8):
                    sound[start + lane, branch] = possible[branch, lane] > 0.5
                    for j in range(n):
                        theta_every[start + lane, branch, j] = theta[branch * n + j, lane]
            continue
        chain_block(tool, best, 0, axes, n, T_0, E, sign, offset, prismatic)
        misfit(tool, target, tolerance > 0.0, error)
        for lane in range(count):
            index[start + lane] = int(cost[COST_BRANCH, lane])
            fit[start + lane, 0] = cost[COST_SPIN, lane]
            fit[start + lane, 1] = np.sqrt(error[0, lane])
            fit[start + lane, 2] = 2.0 * np.arcsin(min(0.5 * np.sqrt(error[1, lane]), 1.0))
            for j in range(n):
                theta_near[start + lane, j] = best[j, lane]
