"""The closed form of a decoupled arm, one pose at a time, compiled: shoulder, elbow, wrist, and which to take.

Everything is found in the arm's own frame {S}: z along axis 1, y along axis 2, origin on axis 1 at the height of axis
2. There a turn by phi about z turns the complex number x + i y by exp(i phi), one about y turns x - i z; ``e_1`` ...
``e_6`` are these factors. Where the geometry has no solution the nearest attempt is given.

The eight solutions stand side by side in one array of room, and inner loops run over them: the compiler takes all
eight at once where such a loop writes to that array only and reads everything else before it begins.
"""

# mypy: disable-error-code="no-untyped-def"
# Parts are typed by whoever calls them.
from __future__ import annotations

import numpy as np

from robomill.compiled import FEW, In2, In3, Out2, Out3, OutBool2, kernel, part
from robomill.kinematics.decoupled import LIMIT_SLACK, RESIDUAL, ROUNDING, Answer, Decoupled, Rules
from robomill.kinematics.kernels import forward_side_by_side, gap, misfit, upper
from robomill.kinematics.trig_kernels import arc_tangent, sin_cos
from robomill.robot.dh import Chain

TURN = 2.0 * np.pi
TINY = 1e-150
ARM_WEIGHT = 1e6  # rad^2: far above any joint motion
SPIN_HALVINGS = 7
AXES = 6  # at most
RE, IM, ANGLE, REAL = 0, 1, 2, 3  # rows of the room of the eight solutions


@part
def unit(z):
    """z / |z|, 1 for zero."""
    size = np.sqrt(z.real * z.real + z.imag * z.imag)
    return complex(z.real / size, z.imag / size) if size > TINY else complex(1.0, 0.0)


@part
def aim(T, spin, arm):
    """(p, u, g) in {S}: wrist centre (m), the direction u and its normal g, of T (4, 4) spun about z_T."""
    s, c = sin_cos(spin)
    x = (c * T[0, 0] + s * T[0, 1], c * T[1, 0] + s * T[1, 1], c * T[2, 0] + s * T[2, 1])
    y = (c * T[0, 1] - s * T[0, 0], c * T[1, 1] - s * T[1, 0], c * T[2, 1] - s * T[2, 0])
    z = (T[0, 2], T[1, 2], T[2, 2])
    w, o = blend(arm.c_w, x, y, z), arm.origin
    p = (T[0, 3] - w[0] - o[0], T[1, 3] - w[1] - o[1], T[2, 3] - w[2] - o[2])
    return along(arm.S, p), along(arm.S, blend(arm.c_u, x, y, z)), along(arm.S, blend(arm.c_g, x, y, z))


@part
def blend(c, x, y, z):
    """The vector of components c on the axes x, y, z."""
    return (
        c[0] * x[0] + c[1] * y[0] + c[2] * z[0],
        c[0] * x[1] + c[1] * y[1] + c[2] * z[1],
        c[0] * x[2] + c[1] * y[2] + c[2] * z[2],
    )


@part
def along(R, v):
    """The components of v along the rows of R."""
    return dot(R[0], v), dot(R[1], v), dot(R[2], v)


@part
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@part
def shoulder(p, arm, side):
    """(e_1, x of the wrist centre p in the plane of the arm, whether it is real); side 1 is front, -1 is back."""
    xy = complex(p[0], p[1])
    under = p[0] * p[0] + p[1] * p[1] - arm.h * arm.h
    x = side * np.sqrt(max(under, 0.0))
    return unit(xy * complex(x, -arm.h)), x, under >= -ROUNDING


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
def past(d, e_z, e_y):
    """A direction d seen from behind a turn about z and then one about y."""
    xy = complex(d[0], d[1]) * e_z.conjugate()
    xz = complex(xy.real, -d[2]) * e_y.conjugate()
    return xz.real, xy.imag, -xz.imag


@part
def wrist(v, arm, flip):
    """(e_4, e_5, whether they are real) that bring u to the direction v, in wrist axes; flip 1 or -1."""
    u = arm.u
    under = v[0] * v[0] + v[1] * v[1] - u[1] * u[1]
    x = flip * np.sqrt(max(under, 0.0))
    return complex(v[0], v[1]) * complex(x, -u[1]), complex(v[2], x) * complex(u[2], -u[0]), under >= -ROUNDING


@part
def solve(goal, arm, room):
    """The eight solutions side by side into room (4, 8 AXES), joint by joint: entry 8 j + k of joint j, solution k.

    Its rows: real and imaginary parts of e_1 ... e_6, the angles, and whether a solution is real (its first eight).
    """
    p, u, g = goal
    for k in range(8):
        side = 1.0 if k < 4 else -1.0  # front, back
        sense = 1.0 if k % 4 < 2 else -1.0  # elbow up, down
        flip = 1.0 if k % 2 == 0 else -1.0  # wrist +, -
        e_1, x, placed = shoulder(p, arm, side)
        e_2, e_3, bent = elbow(complex(x - arm.a_1, -p[2]), arm, side * sense)
        e_4, e_5, aimed = wrist(along(arm.W, past(u, e_1, e_2 * e_3)), arm, flip)
        normal = past(along(arm.W, past(g, e_1, e_2 * e_3)), unit(e_4), unit(e_5))
        put(e_1, room, k)
        put(e_2, room, 8 + k)
        put(e_3, room, 16 + k)
        put(e_4, room, 24 + k)
        put(e_5, room, 32 + k)
        put(complex(dot(normal, arm.g), dot(normal, arm.gn)), room, 40 + k)
        room[REAL, k] = 1.0 if placed and bent and aimed else 0.0
    n = len(arm.direction)
    for k in range(8 * n):
        room[ANGLE, k] = arc_tangent(room[IM, k], room[RE, k])
    for j in range(n):
        direction = arm.direction[j]
        for k in range(8):
            room[ANGLE, 8 * j + k] *= direction


@part
def put(e, room, k):
    room[RE, k], room[IM, k] = e.real, e.imag


@part
def turned(theta, low, high, near):
    """An angle moved by whole turns: to the one nearest ``near`` within limits, nearest mid-range where none is."""
    close = theta + TURN * np.rint((near - theta) / TURN)
    if low - LIMIT_SLACK <= close <= high + LIMIT_SLACK:
        return close
    least, most = np.ceil((low - LIMIT_SLACK - theta) / TURN), np.floor((high + LIMIT_SLACK - theta) / TURN)
    if least > most:
        return theta + TURN * np.rint((0.5 * (low + high) - theta) / TURN)
    return theta + TURN * (most if close > high else least)


@part
def put_within(theta, limits, goal, least):
    """theta (n,) turned towards goal and put inside limits it is past by rounding; its squared motion from there.

    Infinite where it is outside the limits; left off where it comes to ``least``.
    """
    motion = 0.0
    for j in range(len(theta)):
        near = turned(theta[j], limits[j, 0], limits[j, 1], goal[j])
        theta[j] = min(max(near, limits[j, 0]), limits[j, 1])
        motion += (near - goal[j]) ** 2 if abs(near - theta[j]) <= LIMIT_SLACK else np.inf
        if motion >= least:
            break
    return motion


@part
def take_nearest(target, arm, rules, goal, least, room, best):
    """(cost, branch) of the solution nearest to goal, put into best (n,), where it costs less than ``least``.

    Else (least, -1). With ``arm_first`` the order of the postures goes before all motion.
    """
    solve(target, arm, room)
    branch = -1
    for k in range(8):
        order = ARM_WEIGHT * (k // 2) if rules.arm_first else 0.0
        if order >= least or not (rules.wanted[k] and room[REAL, k]):
            continue
        theta = room[ANGLE, k : 8 * len(best) : 8]
        if rules.held:
            theta[5] = goal[5]
        cost = order + put_within(theta, rules.limits, goal, least - order)
        if cost < least:
            least, branch = cost, k
            for j in range(len(best)):
                best[j] = theta[j]
    return least, branch


@part
def choose(T, arm, rules, goal, room, best):
    """(branch, spin): of all spins about the tool axis the one with the least motion, its configuration into best.

    ``rules.spins`` steps round the axis, then halved; 0: the pose as given. branch -1, and an attempt in best, where
    none is within limits.
    """
    least, branch, spin = np.inf, -1, 0.0
    step = TURN / max(rules.spins, 1)
    for i in range(max(rules.spins, 1)):
        least, found = take_nearest(aim(T, i * step, arm), arm, rules, goal, least, room, best)
        if found >= 0:
            branch, spin = found, i * step
    for _ in range(SPIN_HALVINGS if rules.spins > 0 else 0):
        step *= 0.5
        centre = spin
        for way in range(2):
            at = centre + (step if way == 0 else -step)
            least, found = take_nearest(aim(T, at, arm), arm, rules, goal, least, room, best)
            if found >= 0:
                branch, spin = found, at
    if branch < 0:
        solve(aim(T, 0.0, arm), arm, room)
        for j in range(len(best)):
            best[j] = room[ANGLE, 8 * j]
    return branch, spin


@kernel(few=FEW)
def nearest_of(T_MT: In3, arm: Decoupled, chain: Chain, rules: Rules, goals: In2, answer: Answer) -> None:
    """The answer for poses T_MT (m, 4, 4), nearest to goals (1 or m, n); eight at a time are checked side by side."""
    n, m = len(chain.sign), len(T_MT)
    room, best = np.empty((4, 8 * AXES)), np.empty(n)
    found, turns, tips = np.zeros(8 * n), np.empty((2, 8 * n)), np.empty((3, 4, 8))
    for start in range(0, m, 8):
        for i in range(start, min(start + 8, m)):
            goal = goals[i if len(goals) > 1 else 0]
            answer.branch[i], answer.fit[i, 0] = choose(T_MT[i], arm, rules, goal, room, best)
            for j in range(n):
                answer.theta[i, j] = found[8 * j + i - start] = best[j]
        forward_side_by_side(found, chain, turns, tips)
        for i in range(start, min(start + 8, m)):
            answer.fit[i, 1], answer.fit[i, 2] = misfit(tips[:, :, i - start], T_MT[i], rules.whole)


@kernel(few=FEW)
def every_of(T_MT: In3, arm: Decoupled, chain: Chain, theta: Out3, sound: OutBool2) -> None:
    """All solutions theta (m, 8, n) in (-pi, pi] of poses T_MT (m, 4, 4), and whether they meet them, (m, 8)."""
    n = len(chain.sign)
    room, turns, tips = np.empty((4, 8 * AXES)), np.empty((2, 8 * AXES)), np.empty((3, 4, 8))
    for i in range(len(T_MT)):
        wanted = upper(T_MT[i])
        solve(aim(T_MT[i], 0.0, arm), arm, room)
        forward_side_by_side(room[ANGLE], chain, turns, tips)
        for k in range(8):
            shift, chord = gap(upper(tips[:, :, k]), wanted, n == 6)
            room[REAL, k] = 1.0 if room[REAL, k] and shift <= RESIDUAL and chord <= RESIDUAL else 0.0
        for k in range(8):
            sound[i, k] = room[REAL, k]
            for j in range(n):
                theta[i, k, j] = room[ANGLE, 8 * j + k]


@kernel(few=FEW)
def turned_of(theta: In2, limits: In2, goals: In2, result: Out2) -> None:
    """theta (m, n) turned by whole turns towards goals (1 or m, n)."""
    for i in range(len(theta)):
        near = goals[i if len(goals) > 1 else 0]
        for j in range(len(near)):
            result[i, j] = turned(theta[i, j], limits[j, 0], limits[j, 1], near[j])
