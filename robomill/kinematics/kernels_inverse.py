"""Compiled closed-form inverse kinematics: which of the eight solutions to take, and how well it fits.

The rules are those of ``choice``. Import only through ``compiled``.
"""

# mypy: disable-error-code="no-untyped-def, attr-defined, call-overload"
# numba types these functions by their signatures; Python's annotations would say nothing more.
from __future__ import annotations

import numpy as np
from numba import njit
from numba.types import boolean, float64, int64, void

from robomill.kinematics.kernel_math import INLINE, sin_cos
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
)
from robomill.kinematics.kernels_solutions import ARM_ROWS, TARGET_ROWS, aim_block, load_targets, solve_block

TURN = 2.0 * np.pi
LIMIT_SLACK = 1e-10
ARM_WEIGHT = 1e6
SPIN_HALVINGS = 7
NOWHERE = 1e300
# Rows of the cost buffer: least over the eight solutions, at hand, overshoot at hand, branch; least over all spins, its
# branch, its spin, and the spin at hand.
COST_BEST, COST_BRANCH, COST_SPIN, COST_ROWS = 4, 5, 6, 8


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
        IN3,
        IN1,
        *CHAIN,
        IN2,
        IN2,
        boolean,
        IN_FLAGS,
        boolean,
        int64,
        float64,
        boolean,
        OUT3,
        FLAGS2,
        OUT2,
        INDEX,
        OUT2,
    ),
    **OPTIONS,
)
def solve(
    T_MT,
    P,
    T_0,
    E,
    sign,
    offset,
    prismatic,
    limits,
    goals,
    arm_first,
    wanted,
    last_free,
    spins,
    tolerance,
    every,
    theta_every,
    sound,
    theta_near,
    index,
    fit,
):
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
        )
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
