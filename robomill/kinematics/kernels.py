"""Forward kinematics, the Jacobian and what is made of it, one configuration at a time, compiled.

``@part`` functions are the laws at one configuration; ``@kernel`` functions run them over a batch.
"""

# mypy: disable-error-code="no-untyped-def"
# Parts are typed by whoever calls them.
from __future__ import annotations

import numpy as np

from robomill.compiled import FEW, In1, In2, In3, InBool1, Out1, Out2, Out3, Out4, kernel, part
from robomill.kinematics.trig_kernels import sin_cos
from robomill.robot.dh import Chain


@part
def copy(T, to):
    """The frame T (4, 4) into another."""
    for r in range(4):
        for k in range(4):
            to[r, k] = T[r, k]


@part
def upper(T):
    """The rows of a transform T above its last, 0 0 0 1."""
    return (
        (T[0, 0], T[0, 1], T[0, 2], T[0, 3]),
        (T[1, 0], T[1, 1], T[1, 2], T[1, 3]),
        (T[2, 0], T[2, 1], T[2, 2], T[2, 3]),
    )


@part
def carried(row, motion, E):
    """A row (x, y, z, p) of a frame past a joint and its link: motion is the joint's (sine, cosine, slide)."""
    x, y, z, p = row
    s, c, slide = motion
    x, y, p = c * x + s * y, c * y - s * x, p + slide * z
    X, Y, Z = E
    return (
        x * X[0] + y * Y[0] + z * Z[0],
        x * X[1] + y * Y[1] + z * Z[1],
        x * X[2] + y * Y[2] + z * Z[2],
        x * X[3] + y * Y[3] + z * Z[3] + p,
    )


@part
def forward(theta, chain, turns, frames):
    """Frames (n + 1, 4, 4) in {M} at theta (n,): the frame each joint moves about, then {T}. Eqs. (4), (5), (7).

    turns (n, 3) is room for each joint's sine, cosine and slide.
    """
    copy(chain.T_0, frames[0])
    for i in range(len(theta)):
        q = chain.sign[i] * theta[i] + chain.offset[i]
        turns[i, 0], turns[i, 1] = sin_cos(0.0 if chain.prismatic[i] else q)
        turns[i, 2] = q if chain.prismatic[i] else 0.0
    for i in range(len(theta)):
        motion, E = (turns[i, 0], turns[i, 1], turns[i, 2]), upper(chain.E[i])
        T, after = frames[i], frames[i + 1]
        for r in range(3):
            row = (T[r, 0], T[r, 1], T[r, 2], T[r, 3])
            after[r, 0], after[r, 1], after[r, 2], after[r, 3] = carried(row, motion, E)
        after[3, 0], after[3, 1], after[3, 2], after[3, 3] = 0.0, 0.0, 0.0, 1.0


@part
def forward_side_by_side(theta, chain, turns, T):
    """Tool frames T (3, 4, w) of w configurations of turning joints, theta (n w,) joint by joint; turns (2, n w)."""
    n, w = len(chain.sign), T.shape[2]
    for i in range(n):
        sign, zero = chain.sign[i], chain.offset[i]
        for k in range(w):
            turns[0, i * w + k], turns[1, i * w + k] = sin_cos(sign * theta[i * w + k] + zero)
    for r in range(3):
        T[r, 0], T[r, 1], T[r, 2], T[r, 3] = upper(chain.T_0)[r]
    for i in range(n):
        E = upper(chain.E[i])
        for r in range(3):
            for k in range(w):
                row = (T[r, 0, k], T[r, 1, k], T[r, 2, k], T[r, 3, k])
                motion = (turns[0, i * w + k], turns[1, i * w + k], 0.0)
                T[r, 0, k], T[r, 1, k], T[r, 2, k], T[r, 3, k] = carried(row, motion, E)


@part
def twist(z, r, slides):
    """(v, omega) of a point at r from an axis z by a unit of its joint: z x r and z where it turns, z where it slides.

    Eqs. (8), (9).
    """
    if slides:
        return z[0], z[1], z[2], 0.0, 0.0, 0.0
    return (
        z[1] * r[2] - z[2] * r[1],
        z[2] * r[0] - z[0] * r[2],
        z[0] * r[1] - z[1] * r[0],
        z[0],
        z[1],
        z[2],
    )


@part
def jacobian(frames, chain, J):
    """J (6, n) from the frames: the twists of the tip. Eqs. (8), (9)."""
    n = len(chain.sign)
    for i in range(n):
        F, s = frames[i], chain.sign[i]
        z = (s * F[0, 2], s * F[1, 2], s * F[2, 2])
        r = (frames[n, 0, 3] - F[0, 3], frames[n, 1, 3] - F[1, 3], frames[n, 2, 3] - F[2, 3])
        J[0, i], J[1, i], J[2, i], J[3, i], J[4, i], J[5, i] = twist(z, r, chain.prismatic[i])


@part
def share(c, J, i, r, k):
    """What joint i of compliance c gives of C_rk: c J_ri J_ki. Eqs. (13), (14)."""
    return c * J[r, i] * J[k, i]


@part
def elimination(A):
    """det of A (n, n) by elimination with the largest pivot; A is used up."""
    det, n = 1.0, len(A)
    for k in range(n):
        pivot = k
        for r in range(k + 1, n):
            if abs(A[r, k]) > abs(A[pivot, k]):
                pivot = r
        if A[pivot, k] == 0.0:
            return 0.0
        if pivot != k:
            det = -det
            for c in range(k, n):
                A[k, c], A[pivot, c] = A[pivot, c], A[k, c]
        det *= A[k, k]
        for r in range(k + 1, n):
            factor = A[r, k] / A[k, k]
            for c in range(k + 1, n):
                A[r, c] -= factor * A[k, c]
    return det


@part
def determinant(A, AAt):
    """det of A (k, n), which is used up; where it is not square its size, sqrt(det(A A^T)). AAt (k, k) is room."""
    k, n = A.shape
    if k == n:
        return elimination(A)
    for r in range(k):
        for c in range(k):
            AAt[r, c] = 0.0
            for j in range(n):
                AAt[r, c] += A[r, j] * A[c, j]
    return np.sqrt(max(elimination(AAt), 0.0))


@part
def gap(T, wanted, whole):
    """(m, chord) how far the upper rows of a frame T are from the wanted ones: tips, and tool axes or ``whole`` turns.

    Two directions an angle apart have the chord 2 sin(angle / 2); a matrix turned by it is off by the square root of
    twice that squared.
    """
    shift, chord = 0.0, 0.0
    for r in range(3):
        shift += (T[r][3] - wanted[r][3]) ** 2
        chord += (T[r][2] - wanted[r][2]) ** 2
    if whole:
        for r in range(3):
            chord += (T[r][0] - wanted[r][0]) ** 2 + (T[r][1] - wanted[r][1]) ** 2
        chord *= 0.5
    return np.sqrt(shift), np.sqrt(chord)


@part
def misfit(T, wanted, whole):
    """(m, rad) how far the frame T (4, 4) is from the wanted one: tips, and tool axes or the ``whole`` rotation."""
    shift, chord = gap(upper(T), upper(wanted), whole)
    return shift, 2.0 * np.arcsin(min(0.5 * chord, 1.0))


@part
def off_rigid(T):
    """How far T (4, 4) is from a rigid transform: R^T R from 1, det(R) from 1, the last row from 0 0 0 1, at most."""
    most = max(abs(T[3, 0]), abs(T[3, 1]), abs(T[3, 2]), abs(T[3, 3] - 1.0))
    for a in range(3):
        for b in range(a, 3):
            product = T[0, a] * T[0, b] + T[1, a] * T[1, b] + T[2, a] * T[2, b]
            most = max(most, abs(product - (1.0 if a == b else 0.0)))
    x = T[1, 1] * T[2, 2] - T[1, 2] * T[2, 1]
    y = T[1, 2] * T[2, 0] - T[1, 0] * T[2, 2]
    z = T[1, 0] * T[2, 1] - T[1, 1] * T[2, 0]
    return max(most, abs(T[0, 0] * x + T[0, 1] * y + T[0, 2] * z - 1.0))


@kernel(few=FEW)
def off_rigid_of(T: In3, off: Out1) -> None:
    """off (m,) of transforms T (m, 4, 4)."""
    for i in range(len(T)):
        off[i] = off_rigid(T[i])


@kernel(few=FEW)
def frames_of(theta: In2, chain: Chain, frames: Out4) -> None:
    """frames (m, n + 1, 4, 4) of theta (m, n)."""
    turns = np.empty((theta.shape[1], 3))
    for i in range(len(theta)):
        forward(theta[i], chain, turns, frames[i])


@kernel(few=FEW)
def pose_of(theta: In2, chain: Chain, T_MT: Out3) -> None:
    """T_MT (m, 4, 4) of theta (m, n)."""
    n = theta.shape[1]
    turns, frames = np.empty((n, 3)), np.empty((n + 1, 4, 4))
    for i in range(len(theta)):
        forward(theta[i], chain, turns, frames)
        copy(frames[n], T_MT[i])


@kernel(few=FEW)
def jacobian_of(theta: In2, chain: Chain, T_MT: Out3, J: Out3) -> None:
    """T_MT (m, 4, 4) and J (m, 6, n) of theta (m, n)."""
    n = theta.shape[1]
    turns, frames = np.empty((n, 3)), np.empty((n + 1, 4, 4))
    for i in range(len(theta)):
        forward(theta[i], chain, turns, frames)
        jacobian(frames, chain, J[i])
        copy(frames[n], T_MT[i])


@kernel(few=FEW)
def twists_of(axis: In2, reach: In2, slides: InBool1, twists: Out2) -> None:
    """twists (m, 6) of points at reach (m, 3) from axes (m, 3)."""
    for i in range(len(axis)):
        z, r = (axis[i, 0], axis[i, 1], axis[i, 2]), (reach[i, 0], reach[i, 1], reach[i, 2])
        v = twist(z, r, slides[i])
        for c in range(6):
            twists[i, c] = v[c]


@kernel(few=FEW)
def shares_of(J: In3, C_theta: In2, C_joint: Out4) -> None:
    """C_joint (m, n, r, r) of J (m, r, n) and C_theta (1 or m, n). Eqs. (13), (14)."""
    m, rows, n = J.shape
    for i in range(m):
        c = C_theta[i if len(C_theta) > 1 else 0]
        for j in range(n):
            for r in range(rows):
                for k in range(rows):
                    C_joint[i, j, r, k] = share(c[j], J[i], j, r, k)


@kernel(few=FEW)
def compliance_of(J: In3, C_theta: In1, C: Out3) -> None:
    """C (m, 3, 3), the sum of the joints' shares, of the rows v of J (m, 6, n). Eqs. (11), (12)."""
    for i in range(len(J)):
        for r in range(3):
            for k in range(3):
                total = 0.0
                for j in range(len(C_theta)):
                    total += share(C_theta[j], J[i], j, r, k)
                C[i, r, k] = total


@kernel(few=FEW)
def misfit_of(theta: In2, chain: Chain, wanted: In3, whole: bool, shift: Out1, angle: Out1) -> None:
    """shift (m,) m and angle (m,) rad of theta (m, n) from the poses wanted (m, 4, 4)."""
    n = theta.shape[1]
    turns, frames = np.empty((n, 3)), np.empty((n + 1, 4, 4))
    for i in range(len(theta)):
        forward(theta[i], chain, turns, frames)
        shift[i], angle[i] = misfit(frames[n], wanted[i], whole)


@kernel(few=FEW)
def determinant_of(A: In3, det: Out1) -> None:
    """det (m,) of A (m, k, n)."""
    k = A.shape[1]
    AAt = np.empty((k, k))
    for i in range(len(A)):
        det[i] = determinant(A[i].copy(), AAt)
