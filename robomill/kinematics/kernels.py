"""Forward kinematics, the Jacobian and what is made of it, one configuration at a time, compiled.

``@part`` functions are the laws at one configuration; ``@kernel`` functions run them over a batch.
"""

# mypy: disable-error-code="no-untyped-def"
# Parts are typed by whoever calls them.
from __future__ import annotations

import numpy as np

from robomill.compiled import FEW, In1, In2, In3, Out1, Out3, Out4, kernel, part
from robomill.kinematics.trig_kernels import sin_cos
from robomill.robot.dh import Chain


@part
def copy(T, to):
    """The frame T (4, 4) into another."""
    for r in range(4):
        for k in range(4):
            to[r, k] = T[r, k]


@part
def forward(theta, chain, turns, frames):
    """Frames (n + 1, 4, 4) in {M} at theta (n,): the frame each joint moves about, then {T}. Eqs. (4), (5), (7).

    turns (n, 3) is room for each joint's sine, cosine and shift.
    """
    copy(chain.T_0, frames[0])
    forward_from(0, theta, chain, turns, frames)


@part
def forward_from(first, theta, chain, turns, frames):
    """As ``forward``, where the frames up to that of joint ``first`` (counted from 0) stand already."""
    E = chain.E
    for i in range(first, len(theta)):
        q = chain.sign[i] * theta[i] + chain.offset[i]
        turns[i, 0], turns[i, 1] = sin_cos(0.0 if chain.prismatic[i] else q)
        turns[i, 2] = q if chain.prismatic[i] else 0.0
    for i in range(first, len(theta)):
        s, c, slide = turns[i, 0], turns[i, 1], turns[i, 2]
        for r in range(3):
            x, y, z, p = frames[i, r, 0], frames[i, r, 1], frames[i, r, 2], frames[i, r, 3]
            x, y, p = c * x + s * y, c * y - s * x, p + slide * z
            for k in range(4):
                frames[i + 1, r, k] = x * E[i, 0, k] + y * E[i, 1, k] + z * E[i, 2, k]
            frames[i + 1, r, 3] += p
        frames[i + 1, 3, 0], frames[i + 1, 3, 1], frames[i + 1, 3, 2], frames[i + 1, 3, 3] = 0.0, 0.0, 0.0, 1.0


@part
def jacobian(frames, chain, J):
    """J (6, n) from the frames: a turning joint moves the tip by z x r, a sliding one by z. Eqs. (8), (9)."""
    n = len(chain.sign)
    for i in range(n):
        s = chain.sign[i]
        z_x, z_y, z_z = s * frames[i, 0, 2], s * frames[i, 1, 2], s * frames[i, 2, 2]
        r_x = frames[n, 0, 3] - frames[i, 0, 3]
        r_y = frames[n, 1, 3] - frames[i, 1, 3]
        r_z = frames[n, 2, 3] - frames[i, 2, 3]
        if chain.prismatic[i]:
            J[0, i], J[1, i], J[2, i] = z_x, z_y, z_z
            J[3, i], J[4, i], J[5, i] = 0.0, 0.0, 0.0
        else:
            J[0, i], J[1, i], J[2, i] = z_y * r_z - z_z * r_y, z_z * r_x - z_x * r_z, z_x * r_y - z_y * r_x
            J[3, i], J[4, i], J[5, i] = z_x, z_y, z_z


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
def misfit(T, wanted, whole):
    """(m, rad) how far the frame T (4, 4) is from the wanted one: tips, and tool axes or the ``whole`` rotation.

    Two directions an angle apart have the chord 2 sin(angle / 2); a matrix turned by it is off by the square root of
    twice that squared.
    """
    shift, chord = 0.0, 0.0
    for r in range(3):
        shift += (T[r, 3] - wanted[r, 3]) ** 2
        chord += (T[r, 2] - wanted[r, 2]) ** 2
    if whole:
        for r in range(3):
            chord += (T[r, 0] - wanted[r, 0]) ** 2 + (T[r, 1] - wanted[r, 1]) ** 2
        chord *= 0.5
    return np.sqrt(shift), 2.0 * np.arcsin(min(0.5 * np.sqrt(chord), 1.0))


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
def compliance_of(J: In3, C_theta: In1, C: Out3) -> None:
    """C (m, 3, 3) = J_v diag(C_theta) J_v^T, the rows v of J (m, 6, n). Eqs. (11), (12)."""
    for i in range(len(J)):
        for r in range(3):
            for k in range(3):
                total = 0.0
                for j in range(len(C_theta)):
                    total += C_theta[j] * J[i, r, j] * J[i, k, j]
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
