"""The closed form of a decoupled arm, one pose at a time, compiled: shoulder, elbow, wrist, and which to take.

Everything is found in the arm's own frame {S}: z along axis 1, y along axis 2, origin on axis 1 at the height of axis
2. There a turn by phi about z turns the complex number x + i y by exp(i phi), one about y turns x - i z; ``e_1`` ...
``e_5`` are these factors. Where the geometry has no solution the nearest attempt is given.
"""

# mypy: disable-error-code="no-untyped-def"
# Parts are typed by whoever calls them.
from __future__ import annotations

import numpy as np

from robomill.compiled import FEW, In1, In2, In3, Out2, Out3, OutBool2, kernel, part
from robomill.kinematics.decoupled import LIMIT_SLACK, RESIDUAL, ROUNDING, Answer, Decoupled, Rules
from robomill.kinematics.kernels import forward, forward_from, misfit
from robomill.kinematics.trig_kernels import arc_tangent, sin_cos
from robomill.robot.dh import Chain

TURN = 2.0 * np.pi
TINY = 1e-150
ARM_WEIGHT = 1e6  # rad^2: far above any joint motion
SPIN_HALVINGS = 7
WRIST = 3  # joints of the arm before those of the wrist


@part
def unit(z):
    """z / |z|, 1 for zero."""
    size = np.sqrt(z.real * z.real + z.imag * z.imag)
    return complex(z.real / size, z.imag / size) if size > TINY else complex(1.0, 0.0)


@part
def aim(T, spin, arm, goal):
    """Columns of goal (3, 3) in {S}: wrist centre (m), the direction u and its normal g, of T (4, 4) spun about z_T."""
    s, c = sin_cos(spin)
    for r in range(3):
        goal[r, 0] = goal[r, 1] = goal[r, 2] = 0.0
    for k in range(3):
        x, y, z = c * T[k, 0] + s * T[k, 1], c * T[k, 1] - s * T[k, 0], T[k, 2]
        p = T[k, 3] - (x * arm.c_w[0] + y * arm.c_w[1] + z * arm.c_w[2]) - arm.origin[k]
        u = x * arm.c_u[0] + y * arm.c_u[1] + z * arm.c_u[2]
        g = x * arm.c_g[0] + y * arm.c_g[1] + z * arm.c_g[2]
        for r in range(3):
            goal[r, 0] += arm.S[r, k] * p
            goal[r, 1] += arm.S[r, k] * u
            goal[r, 2] += arm.S[r, k] * g


@part
def shoulder(goal, arm, side):
    """(e_1, x of the wrist centre in the plane of the arm, whether it is real); side 1 is front, -1 is back."""
    p = complex(goal[0, 0], goal[1, 0])
    under = p.real * p.real + p.imag * p.imag - arm.h * arm.h
    x = side * np.sqrt(max(under, 0.0))
    return unit(p * complex(x, -arm.h)), x, under >= -ROUNDING


@part
def elbow(r, arm, bend):
    """(e_2, e_3, whether they are real) of two links that reach r = x - i z from axis 2; bend 1 or -1."""
    L_22 = arm.l_2.real * arm.l_2.real + arm.l_2.imag * arm.l_2.imag
    L_33 = arm.l_3.real * arm.l_3.real + arm.l_3.imag * arm.l_3.imag
    scale = 1.0 / np.sqrt(L_22 * L_33)
    cos_g = 0.5 * scale * (r.real * r.real + r.imag * r.imag - L_22 - L_33)
    real = abs(cos_g) <= 1.0 + ROUNDING
    cos_g = min(max(cos_g, -1.0), 1.0)
    sin_g = bend * np.sqrt((1.0 - cos_g) * (1.0 + cos_g))
    e_3 = scale * (arm.l_2 * arm.l_3.conjugate()) * complex(cos_g, sin_g)
    return unit(r * (arm.l_2 + arm.l_3 * e_3).conjugate()), e_3, real


@part
def into_wrist(d_x, d_y, d_z, arm, e_1, e_23):
    """A direction in {S} seen from the wrist before it turns."""
    xy = complex(d_x, d_y) * e_1.conjugate()
    xz = complex(xy.real, -d_z) * e_23.conjugate()
    x, y, z = xz.real, xy.imag, -xz.imag
    W = arm.W
    return (
        W[0, 0] * x + W[0, 1] * y + W[0, 2] * z,
        W[1, 0] * x + W[1, 1] * y + W[1, 2] * z,
        W[2, 0] * x + W[2, 1] * y + W[2, 2] * z,
    )


@part
def last_joint(g_x, g_y, g_z, arm, e_4, e_5):
    """e_6 from the normal g, given in wrist axes before axes 4 and 5 turn."""
    xy = complex(g_x, g_y) * unit(e_4).conjugate()
    xz = complex(xy.real, -g_z) * unit(e_5).conjugate()
    x, y, z = xz.real, xy.imag, -xz.imag
    g, n = arm.g, arm.gn
    return complex(x * g[0] + y * g[1] + z * g[2], x * n[0] + y * n[1] + z * n[2])


@part
def solve(goal, arm, posture, factors, theta):
    """theta (2, n): both wrists, + and -, of a posture 0-3 (front or back x elbow up or down). True where real.

    factors (3, 2 n) is room for the real and imaginary parts of e_1 ... e_n and their angles, which are taken at once.
    """
    n = len(arm.direction)
    side, sense = 1.0 - 2.0 * (posture // 2), 1.0 - 2.0 * (posture % 2)
    e_1, x, placed = shoulder(goal, arm, side)
    e_2, e_3, bent = elbow(complex(x - arm.a_1, -goal[2, 0]), arm, side * sense)
    e_23 = e_2 * e_3
    v_x, v_y, v_z = into_wrist(goal[0, 1], goal[1, 1], goal[2, 1], arm, e_1, e_23)
    g_x, g_y, g_z = into_wrist(goal[0, 2], goal[1, 2], goal[2, 2], arm, e_1, e_23)
    u = arm.u
    under = v_x * v_x + v_y * v_y - u[1] * u[1]
    across = np.sqrt(max(under, 0.0))
    for w in range(2):
        x_w = across if w == 0 else -across
        e_4 = complex(v_x, v_y) * complex(x_w, -u[1])
        e_5 = complex(v_z, x_w) * complex(u[2], -u[0])
        first = w * n
        put(e_1, factors, first)
        put(e_2, factors, first + 1)
        put(e_3, factors, first + 2)
        put(e_4, factors, first + 3)
        put(e_5, factors, first + 4)
        if n == 6:
            put(last_joint(g_x, g_y, g_z, arm, e_4, e_5), factors, first + 5)
    for k in range(2 * n):
        factors[2, k] = arc_tangent(factors[1, k], factors[0, k])
    for w in range(2):
        for j in range(n):
            theta[w, j] = arm.direction[j] * factors[2, w * n + j]
    return placed and bent and under >= -ROUNDING


@part
def put(e, factors, k):
    factors[0, k], factors[1, k] = e.real, e.imag


@part
def turned(theta, low, high, near):
    """An angle moved by whole turns: to the turn nearest ``near`` if that is within limits, else nearest mid-range."""
    close = theta + TURN * np.rint((near - theta) / TURN)
    if low - LIMIT_SLACK <= close <= high + LIMIT_SLACK:
        return close
    return theta + TURN * np.rint((0.5 * (low + high) - theta) / TURN)


@part
def settle(theta, limits, goal):
    """theta (n,) turned towards goal and put inside limits it is past by rounding; its squared motion from there.

    Infinite where it is outside the limits.
    """
    motion = 0.0
    for j in range(len(theta)):
        near = turned(theta[j], limits[j, 0], limits[j, 1], goal[j])
        theta[j] = min(max(near, limits[j, 0]), limits[j, 1])
        motion += (near - goal[j]) ** 2 if abs(near - theta[j]) <= LIMIT_SLACK else np.inf
    return motion


@part
def take_nearest(target, arm, rules, goal, least, factors, trial, best):
    """(cost, branch) of the solution nearest to goal, put into best (n,), where it costs less than ``least``.

    Else (least, -1). With ``arm_first`` the order of the postures goes before all motion.
    """
    branch = -1
    for posture in range(4):
        order = ARM_WEIGHT * posture if rules.arm_first else 0.0
        if order >= least:
            break
        if not solve(target, arm, posture, factors, trial):
            continue
        for w in range(2):
            if rules.held:
                trial[w, 5] = goal[5]
            cost = order + settle(trial[w], rules.limits, goal)
            if cost < least and rules.wanted[2 * posture + w]:
                least, branch = cost, 2 * posture + w
                for j in range(len(best)):
                    best[j] = trial[w, j]
    return least, branch


@part
def choose(T, arm, rules, goal, room, best):
    """(branch, spin): of all spins about the tool axis the one with the least motion, its configuration into best.

    ``rules.spins`` steps round the axis, then halved; 0: the pose as given. branch -1, and an attempt in best, where
    none is within limits.
    """
    target, factors, trial = room
    least, branch, spin = np.inf, -1, 0.0
    step = TURN / max(rules.spins, 1)
    for i in range(max(rules.spins, 1)):
        aim(T, i * step, arm, target)
        least, found = take_nearest(target, arm, rules, goal, least, factors, trial, best)
        if found >= 0:
            branch, spin = found, i * step
    for _ in range(SPIN_HALVINGS if rules.spins > 0 else 0):
        step *= 0.5
        centre = spin
        for way in range(2):
            at = centre + (step if way == 0 else -step)
            aim(T, at, arm, target)
            least, found = take_nearest(target, arm, rules, goal, least, factors, trial, best)
            if found >= 0:
                branch, spin = found, at
    if branch < 0:
        aim(T, 0.0, arm, target)
        solve(target, arm, 0, factors, trial)
        for j in range(len(best)):
            best[j] = trial[0, j]
    return branch, spin


@kernel(few=FEW)
def nearest_of(T_MT: In3, arm: Decoupled, chain: Chain, rules: Rules, goals: In2, answer: Answer) -> None:
    """The answer for poses T_MT (m, 4, 4), nearest to goals (1 or m, n)."""
    n = len(chain.sign)
    room = (np.empty((3, 3)), np.empty((3, 2 * n)), np.empty((2, n)))
    best, turns, frames = np.empty(n), np.empty((n, 3)), np.empty((n + 1, 4, 4))
    for i in range(len(T_MT)):
        goal = goals[i if len(goals) > 1 else 0]
        answer.branch[i], answer.fit[i, 0] = choose(T_MT[i], arm, rules, goal, room, best)
        forward(best, chain, turns, frames)
        answer.fit[i, 1], answer.fit[i, 2] = misfit(frames[n], T_MT[i], rules.whole)
        for j in range(n):
            answer.theta[i, j] = best[j]


@part
def solve_all(T, arm, chain, room, theta, sound):
    """All solutions theta (8, n) of T (4, 4), and whether they meet it by forward kinematics, (8,)."""
    target, factors, turns, frames = room
    n = len(chain.sign)
    aim(T, 0.0, arm, target)
    for posture in range(4):
        branch = 2 * posture
        real = solve(target, arm, posture, factors, theta[branch : branch + 2])
        sound[branch], sound[branch + 1] = False, False
        if not real:
            continue
        for w in range(2):
            if w == 0:
                forward(theta[branch], chain, turns, frames)
            else:  # both wrists stand on the same arm
                forward_from(WRIST, theta[branch + 1], chain, turns, frames)
            shift, angle = misfit(frames[n], T, n == 6)
            sound[branch + w] = shift <= RESIDUAL and angle <= RESIDUAL


@kernel(few=FEW)
def every_of(T_MT: In3, arm: Decoupled, chain: Chain, theta: Out3, sound: OutBool2) -> None:
    """All solutions theta (m, 8, n) in (-pi, pi] of poses T_MT (m, 4, 4), and whether they meet them, (m, 8)."""
    n = len(chain.sign)
    room = (np.empty((3, 3)), np.empty((3, 2 * n)), np.empty((n, 3)), np.empty((n + 1, 4, 4)))
    for i in range(len(T_MT)):
        solve_all(T_MT[i], arm, chain, room, theta[i], sound[i])


@kernel(few=FEW)
def turned_of(theta: In2, limits: In2, near: In1, result: Out2) -> None:
    """theta (m, n) turned by whole turns towards near (n,)."""
    for i in range(len(theta)):
        for j in range(len(near)):
            result[i, j] = turned(theta[i, j], limits[j, 0], limits[j, 1], near[j])
